"""Materials in another colour: the colour at 45/0 by colour-science, the lobes as they were."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from relgloss_view.base.errors import InputError
from relgloss_view.material.material import Diffuse, Lobe, Material
from relgloss_view.material.recolour import Colour, colour_of, recoloured
from relgloss_view.measure.bands import RGB, WIDE_RGB, Bands
from relgloss_view.picture.scene.sample import SAMPLES, Sample, load_sample

UP = np.array([0.0, 0.0, 1.0])
LAMP = np.array([np.sqrt(0.5), 0.0, np.sqrt(0.5)])
SPECTRAL = Bands(tuple(np.arange(390.0, 731.0, 10.0)))


def material_of(bands, model, sigma_deg, *, metal=False):
    count = bands.count
    lobe = Lobe((0.15,), 14.0, f0=tuple(np.linspace(0.3, 0.5, count))) if metal else None
    lobe = lobe or Lobe(tuple(np.linspace(0.8, 1.2, count)), 12.0)
    return Material("m", "by hand", bands, Diffuse(model, (0.3,) * count, sigma_deg), (lobe,))


def lab_by_colour_science(material):
    """Lab at 45/0 under D50 by colour-science, from the evaluated radiance factors."""
    colour = pytest.importorskip("colour")
    diffuse, specular = material.evaluate(LAMP, UP)
    white = colour.CCS_ILLUMINANTS["CIE 1931 2 Degree Standard Observer"]["D50"]
    values = np.pi * (diffuse + specular)
    if material.bands.is_rgb:  # relative to white, whatever the lamp
        space = "ITU-R BT.2020" if material.bands == WIDE_RGB else "sRGB"
        xyz = colour.RGB_COLOURSPACES[space].matrix_RGB_to_XYZ @ values
        ones = colour.RGB_COLOURSPACES[space].matrix_RGB_to_XYZ @ np.ones(3)
        return colour.XYZ_to_Lab(xyz / ones * colour.xy_to_XYZ(white), white)
    centres = material.bands.centres_nm()
    observer = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"]
    wide = colour.SpectralDistribution(values, centres).extrapolate(observer.shape)
    wide = wide.interpolate(observer.shape)
    lamp = colour.SDS_ILLUMINANTS["D50"].copy().align(observer.shape)
    xyz = colour.sd_to_XYZ(wide, observer, lamp, method="Integration")
    return colour.XYZ_to_Lab(xyz / 100.0, white)


@pytest.mark.parametrize(
    ("bands", "model", "sigma_deg", "metal"),
    [
        (SPECTRAL, "lambert", 0.0, False),
        (SPECTRAL, "oren-nayar", 25.0, False),
        (SPECTRAL, "eon", 40.0, False),
        (SPECTRAL, "eon", 10.0, True),
        (RGB, "oren-nayar", 20.0, False),
        (WIDE_RGB, "eon", 30.0, True),
    ],
)
def test_the_reading_at_45_0_is_the_colour(bands, model, sigma_deg, metal):
    lab = (55.0, 25.0, 15.0)
    material = material_of(bands, model, sigma_deg, metal=metal)
    made = recoloured(material, Colour(lab))
    np.testing.assert_allclose(colour_of(made), lab, atol=1e-6)
    # 5 nm beyond the outer bands and another interpolation between them
    np.testing.assert_allclose(lab_by_colour_science(made), lab, atol=0.15)
    assert np.max(np.abs(lab_by_colour_science(material) - lab)) > 5.0  # the control
    assert made.specular == material.specular
    assert made.diffuse.sigma_deg == sigma_deg
    assert made.hypothetical
    bare = dataclasses.replace(made, specular=())
    assert np.max(np.abs(colour_of(bare) - lab)) > 0.01  # the lobe's part is in the reading


@pytest.mark.parametrize("name", list(SAMPLES))
def test_papers_take_a_colour_and_give_it_back(name):
    own = Sample.built_in(name)
    made = own.in_colour(Colour((50, 60, 20)))
    np.testing.assert_allclose(colour_of(made.material), (50, 60, 20), atol=1e-6)
    assert made.material.specular == own.material.specular
    assert made.material.name == f"{name}, colour Lab 50 60 20"
    assert made.material.fit.quality == own.material.fit.quality
    assert made.in_colour(None) == own
    again = made.in_colour(Colour((30, 0, 0), "A")).in_colour(Colour((50, 60, 20)))
    assert again == made


def test_linear_srgb_widens_where_a_colour_needs_it():
    material = material_of(RGB, "lambert", 0.0)
    made = recoloured(material, Colour((60, -45, -35)))
    assert made.bands == WIDE_RGB
    np.testing.assert_allclose(colour_of(made), (60, -45, -35), atol=1e-6)
    before, after = material.evaluate(LAMP, UP)[1], made.evaluate(LAMP, UP)[1]
    black = [
        dataclasses.replace(m, diffuse=Diffuse("lambert", (0.0,) * 3)) for m in (material, made)
    ]
    np.testing.assert_allclose(colour_of(black[0]), colour_of(black[1]), atol=1e-9)
    assert not np.allclose(before, after)  # the same light in other primaries


def test_impossible_colours_name_the_nearest_lightness():
    """The limits are those that it names: just inside is possible, just outside is not."""
    shiny = material_of(SPECTRAL, "lambert", 0.0, metal=True)
    with pytest.raises(InputError, match="with the highlight's own light, L must be at least") as e:
        recoloured(shiny, Colour((0.0, 0.0, 0.0)))
    least = float(str(e.value).rpartition(" ")[2])
    recoloured(shiny, Colour((least, 0.0, 0.0)))
    with pytest.raises(InputError, match="L must be at least"):
        recoloured(shiny, Colour((least - 0.2, 0.0, 0.0)))
    paper = load_sample("uncoated")
    with pytest.raises(InputError, match="L can be at most") as e:
        recoloured(paper, Colour((100.0, 30.0, 0.0)))
    most = float(str(e.value).rpartition(" ")[2])
    recoloured(paper, Colour((most, 30.0, 0.0)))
    with pytest.raises(InputError, match="L can be at most"):
        recoloured(paper, Colour((most + 0.2, 30.0, 0.0)))
    with pytest.raises(InputError, match="whatever its lightness"):
        recoloured(paper, Colour((50.0, 180.0, 0.0)))
