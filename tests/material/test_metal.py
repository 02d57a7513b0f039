"""A metal's lobe: coloured head on, white at grazing incidence, exact in three channels."""

from __future__ import annotations

import dataclasses
import json

import materials
import numpy as np
import pytest

from relgloss_view.base.errors import InputError
from relgloss_view.gloss.meter.meter import main_lobe, specular_gloss
from relgloss_view.material import brdf
from relgloss_view.material.albedo import directional_albedo
from relgloss_view.material.files import load_material, material_from_dict, save_material
from relgloss_view.material.material import Diffuse, Lobe, Material
from relgloss_view.material.spectra import illuminant, xyz_weights
from relgloss_view.measure.bands import RGB, Bands
from relgloss_view.measure.gonio import direction

#: Gold, about: reflectance that rises from blue to red.
BANDS = Bands(materials.WAVELENGTHS_NM)
GOLD = tuple(float(v) for v in np.linspace(0.38, 0.95, BANDS.count))
BLACK = Diffuse("lambert", (0.0,) * BANDS.count)


def foil(f0=GOLD, s_deg=3.0, strength=1.0, diffuse=BLACK):
    lobe = Lobe((strength,), s_deg, f0=f0)
    return Material("foil", "synthetic", BANDS, diffuse, (lobe,), synthetic=True)


def mirrored(material, theta_deg):
    """The specular BRDF in the mirror direction, (B,)."""
    return material.evaluate(direction(-theta_deg), direction(theta_deg))[1]


class TestColour:
    def test_head_on_it_is_f0(self):
        peak = brdf.facet_amplitude(np.radians(3.0)) / 4.0
        np.testing.assert_allclose(mirrored(foil(), 0.0), peak * np.array(GOLD), rtol=1e-12)

    @pytest.mark.parametrize("theta_deg", [0.0, 30.0, 60.0, 80.0, 89.0])
    def test_schlicks_form(self, theta_deg):
        """f = D G F / (4 cos^2) with D's peak, G = 1 and F = F0 + (1 - F0) (1 - cos)^5."""
        cosine = np.cos(np.radians(theta_deg))
        f0 = np.array(GOLD)
        expected = f0 + (1.0 - f0) * (1.0 - cosine) ** 5
        peak = brdf.facet_amplitude(np.radians(3.0)) / (4.0 * cosine**2)
        np.testing.assert_allclose(
            mirrored(foil(strength=0.5), theta_deg), 0.5 * peak * expected, rtol=1e-9
        )

    def test_it_turns_white(self):
        def saturation(values):
            return 1.0 - np.min(values) / np.max(values)

        head_on, grazing = (saturation(mirrored(foil(), a)) for a in (0.0, 88.0))
        assert head_on == pytest.approx(0.6)
        assert grazing < 0.15
        # Negative control: a dielectric whose strength has that colour keeps it.
        coloured = dataclasses.replace(foil(), specular=(Lobe(GOLD, 3.0),))
        assert saturation(mirrored(coloured, 88.0)) == pytest.approx(0.6)

    def test_three_channels_are_exact(self):
        """XYZ_s = (1 - w) XYZ(F0) + w XYZ(1), against the sum over the bands."""
        weights = xyz_weights(BANDS, illuminant("HP5"))
        rng = np.random.default_rng(3)
        theta = rng.uniform(0.0, 89.0, 50)
        i, o = direction(-theta), direction(theta + rng.uniform(-4.0, 4.0, 50) * (theta < 80))
        f = brdf.facing(np.broadcast_to([0.0, 0.0, 1.0], i.shape), i, o)
        facing, grazing = brdf.metal_torrance_sparrow(f, np.radians(3.0))
        folded = np.multiply.outer(facing, np.array(GOLD) @ weights)
        folded += np.multiply.outer(grazing, illuminant("HP5").white_xyz())
        summed = foil().evaluate(i, o)[1] @ weights
        np.testing.assert_allclose(folded, summed, rtol=1e-9)

    def test_a_foil_without_loss_is_a_dielectric_mirror(self):
        """F0 of 1 in all bands reflects all light that reaches a facet at every angle."""
        mirror = foil(f0=(1.0,))
        assert np.allclose(directional_albedo(mirror, [0.0, 30.0])[1], 1.0, atol=2e-3)


class TestNumbers:
    def test_albedo_is_between_its_colours(self):
        _, shine = directional_albedo(foil(s_deg=1.0), [0.0, 60.0, 85.0])
        np.testing.assert_allclose(shine[0], GOLD, rtol=2e-3)
        assert np.all(np.diff(shine, axis=0) > 0.0)
        assert np.ptp(shine[2]) < np.ptp(shine[0])

    @pytest.mark.parametrize("angle", [20.0, 60.0, 85.0])
    def test_gloss_of_a_gray_foil_is_in_proportion_to_the_black_glass(self, angle):
        """Of a narrow lobe all light reaches the window: gloss is F over that of n = 1.567."""
        gray = foil(f0=(0.6,), s_deg=0.05)
        cosine = np.cos(np.radians(angle))
        expected = 0.6 + 0.4 * (1.0 - cosine) ** 5
        glass = float(brdf.fresnel_dielectric(cosine, 1.567))
        assert specular_gloss(gray, angle) == pytest.approx(100 * expected / glass, rel=2e-3)

    def test_the_foil_is_the_main_lobe_beside_a_varnish_of_its_width(self):
        varnish = Lobe((1.0,), 3.0)
        both = dataclasses.replace(foil(), specular=(varnish, foil().specular[0]))
        assert main_lobe(both) == 1
        assert both.visible_lobes() == both.specular
        dark = dataclasses.replace(foil().specular[0], strength=(0.0,))
        assert not dark.reflects


class TestFiles:
    def test_round_trip(self, tmp_path):
        varnish = Lobe((0.2,), 8.0, 1.6)
        material = dataclasses.replace(foil(strength=0.7), specular=(foil().specular[0], varnish))
        path = tmp_path / "foil.json"
        save_material(material, path)
        assert load_material(path) == material
        lobe, other = json.loads(path.read_text())["specular"]
        assert lobe == {"model": "metal", "strength": 1.0, "f0": list(GOLD), "s_deg": 3.0}
        assert other["model"] == "torrance-sparrow"
        assert "f0" not in other

    def test_strength_is_one_where_the_file_has_none(self):
        material = material_from_dict(rgb_file({"model": "metal", "f0": 0.9, "s_deg": 2.0}))
        assert material.specular == (Lobe((1.0,), 2.0, f0=(0.9,)),)

    @pytest.mark.parametrize(
        ("lobe", "words"),
        [
            ({"f0": [0.9, 0.8], "s_deg": 2.0}, "specular[0].f0: expected one number, or 3"),
            ({"f0": [0.9, 0.8, 1.2], "s_deg": 2.0}, "specular[0].f0[2]: expected a reflectance"),
            ({"f0": [0.9, 0.8, -0.1], "s_deg": 2.0}, "specular[0].f0[2]: expected a reflectance"),
            ({"s_deg": 2.0}, "specular[0].f0"),
            ({"f0": 0.5, "s_deg": 0.0}, "specular[0].s_deg"),
            ({"f0": 0.5, "strength": [1, 1, 1], "s_deg": 2.0}, "specular[0].strength"),
            ({"model": "velvet", "f0": 0.5, "s_deg": 2.0}, '"torrance-sparrow" or "metal"'),
        ],
    )
    def test_bad_lobes_are_named(self, lobe, words):
        with pytest.raises(InputError) as caught:
            material_from_dict(rgb_file({"model": "metal"} | lobe))
        assert words in str(caught.value)
        assert "\n" not in str(caught.value)

    def test_a_lobe_of_other_bands_is_refused(self):
        with pytest.raises(InputError, match=r"specular\[0\].f0: expected one number, or 3"):
            Material("x", "y", RGB, Diffuse("lambert", (0.1,) * 3), (Lobe((1.0,), 2.0, f0=GOLD),))
        with pytest.raises(InputError, match="a metal's colour is its f0"):
            Lobe((1.0, 0.5, 0.2), 2.0, f0=(0.5,))

    def test_the_notebook_shows_f0(self):
        assert "metal, F0" in foil()._repr_html_()
        assert "refractive index" not in foil()._repr_html_()


def rgb_file(lobe):
    return {
        "format": "relgloss-material", "version": 1, "name": "x", "source": "y", "basis": "rgb",
        "diffuse": {"model": "lambert", "albedo": [0.1, 0.1, 0.1]}, "specular": [lobe],
    }  # fmt: skip
