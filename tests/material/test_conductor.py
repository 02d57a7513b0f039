"""Conductors: the exact reflectance against Mitsuba's, and a metal's lobe against the exact one."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path

import numpy as np
import pytest

from relgloss_view.base.errors import InputError
from relgloss_view.material import conductor
from relgloss_view.material.conductor import FOILS, INDICES, foil_material, fresnel_conductor
from relgloss_view.material.spectra import illuminant, xyz_weights
from relgloss_view.picture.model.tone import lab_from_xyz

MITSUBA = {"gold": "Au", "copper": "Cu", "aluminium": "Al"}


def chart():
    path = Path(__file__).parents[2] / "scripts" / "foil_chart.py"
    spec = importlib.util.spec_from_file_location("foil_chart", path)
    module = sys.modules.setdefault("foil_chart", importlib.util.module_from_spec(spec))
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("metal", list(INDICES))
def test_fresnel_is_mitsubas(metal):
    """The same equations by others: Mitsuba's fresnel_conductor."""
    mi = pytest.importorskip("mitsuba")
    mi.set_variant("scalar_rgb")
    drjit = pytest.importorskip("drjit")
    n, k = conductor.index(metal, 550.0)
    for cosine in (1.0, 0.7, 0.3, 0.1, 0.02):
        theirs = mi.fresnel_conductor(cosine, drjit.scalar.Complex2f(float(n), float(k)))
        assert float(fresnel_conductor(cosine, n, k)) == pytest.approx(theirs, abs=1e-5)


@pytest.mark.parametrize(("metal", "tolerance"), [("gold", 5), ("copper", 5), ("aluminium", 2)])
def test_the_numbers_are_near_those_of_another_table(metal, tolerance):
    """Mitsuba ships another collection of n and k: the colours head on agree within its spread."""
    mi = pytest.importorskip("mitsuba")
    mi.set_variant("scalar_spectral")
    bsdf = mi.traverse(mi.load_dict({"type": "conductor", "material": MITSUBA[metal]}))
    nm = np.asarray(conductor.FOIL_BANDS.centres_nm())
    n, k = (
        np.interp(nm, np.array(bsdf[f"{x}.wavelengths"]), np.array(bsdf[f"{x}.values"]))
        for x in ("eta", "k")
    )
    weights = xyz_weights(conductor.FOIL_BANDS, illuminant("D65"))
    white = np.sum(weights, axis=0)
    spectra = conductor.normal_reflectance(metal, nm), fresnel_conductor(1.0, n, k)
    own, theirs = (lab_from_xyz(spectrum @ weights, white) for spectrum in spectra)
    assert np.max(np.abs(own - theirs)) < tolerance
    # Negative control: the metals differ by more.
    other = conductor.normal_reflectance(_other(metal), nm)
    assert np.max(np.abs(own - lab_from_xyz(other @ weights, white))) > 2 * tolerance


def _other(metal):
    return "copper" if metal == "gold" else "gold"


class TestLobe:
    @pytest.mark.parametrize("lamp", ["HP5", "D65", "A"])
    @pytest.mark.parametrize("metal", list(INDICES))
    def test_schlicks_form_is_near_enough(self, metal, lamp):
        module = chart()
        error = module.differences(metal, lamp)
        near = module.ANGLES_DEG <= 75.0
        assert np.percentile(error[near], 95) < 1.6
        if metal != "aluminium":  # whose reflectance dips before grazing incidence
            assert np.percentile(error, 95) < 2.0

    def test_where_it_fails(self):
        """Negative control: aluminium near 84 degrees, and another metal's F0 anywhere."""
        module = chart()
        error = module.differences("aluminium", "A")
        assert 3.0 < np.max(error) < 4.5
        assert 80.0 < module.ANGLES_DEG[np.argmax(error)] < 88.0


class TestFoils:
    def test_colours(self):
        """Silver is neutral, gold is yellow, both are light."""
        weights = xyz_weights(conductor.FOIL_BANDS, illuminant("D50"))
        white = np.sum(weights, axis=0)
        labs = {
            name: lab_from_xyz(np.array(foil_material(name).specular[0].f0) @ weights, white)
            for name in FOILS
        }
        assert labs["silver"][0] > 94.0
        assert np.hypot(*labs["silver"][1:]) < 2.0
        assert 80.0 < labs["gold"][0] < 92.0
        assert 0.0 < labs["gold"][1] < 10.0
        assert 40.0 < labs["gold"][2] < 55.0

    def test_they_are_marked(self):
        for name in FOILS:
            material = foil_material(name)
            assert material.synthetic
            assert material.specular[0].is_metal
            assert material.warnings == ()

    @pytest.mark.parametrize(
        "call",
        [
            lambda: foil_material("bronze"),
            lambda: conductor.index("tin", 500.0),
            lambda: conductor.index("gold", 200.0),
            lambda: conductor.index("gold", float("nan")),
        ],
    )
    def test_others_are_refused(self, call):
        with pytest.raises(InputError):
            call()
