"""A reflectance of a given colour, against colour-science's published spectra and limits."""

from __future__ import annotations

import numpy as np
import pytest

from relgloss_view.base.errors import InputError
from relgloss_view.material.cielab import lab_from_xyz, lab_to_srgb, srgb_to_lab
from relgloss_view.material.reflectance import lab_to_spectrum
from relgloss_view.material.spectra import illuminant, xyz_weights
from relgloss_view.measure.bands import RGB, WIDE_RGB, Bands
from relgloss_view.picture.model.difference import delta_e_2000

INSTRUMENT = Bands(tuple(np.arange(390.0, 731.0, 10.0)))
D50, HP5 = illuminant("D50"), illuminant("HP5")


def lab_of(spectrum, bands=INSTRUMENT, lamp=D50):
    return lab_from_xyz(spectrum @ xyz_weights(bands, lamp), lamp.white_xyz())


@pytest.mark.parametrize(
    "bands",
    [
        INSTRUMENT,
        Bands(tuple(np.arange(380.0, 781.0, 1.0))),  # more bands than knots
        Bands((400.0, 420.0, 470.0, 500.0, 560.0, 600.0, 610.0, 700.0)),
        RGB,
        WIDE_RGB,
    ],
    ids=lambda bands: bands.words,
)
def test_the_spectrum_has_the_colour_and_lies_within_0_and_1(bands):
    for lab in [(50, 30, 20), (30, 10, -20), (80, -20, 40), (100, 0, 0), (0, 0, 0), (95, 0, 3)]:
        spectrum = lab_to_spectrum(lab, bands)
        np.testing.assert_allclose(lab_of(spectrum, bands), lab, atol=1e-6)
        assert spectrum.shape == (bands.count,)
        assert np.min(spectrum) >= 0.0
        assert np.max(spectrum) <= 1.0


def test_published_spectra_keep_their_colour_under_another_lamp():
    """The 24 patches of BabelColor's average, known by Lab under D50 alone, under lamp HP5."""
    colour = pytest.importorskip("colour")
    errors, wrong = [], []
    for patch in colour.SDS_COLOURCHECKERS["BabelColor Average"].values():
        true = np.interp(INSTRUMENT.centres_nm(), patch.wavelengths, patch.values)
        lab = lab_of(true)
        made = lab_to_spectrum(lab, INSTRUMENT)
        errors.append(delta_e_2000(lab_of(true, lamp=HP5), lab_of(made, lamp=HP5)))
        # the control: linear sRGB's reflectance, which has no spectrum
        rgb = lab_to_spectrum(lab, WIDE_RGB)
        wrong.append(delta_e_2000(lab_of(true, lamp=HP5), lab_of(rgb, WIDE_RGB, HP5)))
    assert np.median(errors) < 0.3
    assert np.percentile(errors, 95) < 1.2
    assert np.median(wrong) > 2.0 * np.median(errors)


def test_the_limits_are_those_of_optimal_colours():
    """Colours just inside colour-science's optimal colours are possible, just outside are not.

    An optimal colour is 1 in one range of bands and 0 elsewhere, or the reverse (MacAdam 1935).
    """
    weights = xyz_weights(INSTRUMENT, D50)
    rng = np.random.default_rng(3)
    for _ in range(20):
        first, last = np.sort(rng.choice(np.arange(6, 28), 2, replace=False))
        optimal = np.zeros(INSTRUMENT.count)
        optimal[first : last + 1] = 1.0
        if rng.random() < 0.5:
            optimal = 1.0 - optimal
        middle = np.full(INSTRUMENT.count, 0.5)
        inside = middle + 0.99 * (optimal - middle)
        np.testing.assert_allclose(
            lab_of(lab_to_spectrum(lab_of(inside), INSTRUMENT)), lab_of(inside), atol=1e-6
        )
        outside = (middle + 1.01 * (optimal - middle)) @ weights
        if np.any(outside <= 0.0):
            continue
        lab = lab_from_xyz(outside, D50.white_xyz())
        if np.all(np.abs(lab[1:]) <= 200.0) and 0.0 <= lab[0] <= 100.0:
            with pytest.raises(InputError, match="no reflectance has this colour under D50"):
                lab_to_spectrum(lab, INSTRUMENT)


def test_the_smoothest_spectrum_is_the_smoothest():
    """Others of the same colour are rougher: the control is a metamer of it."""
    weights = xyz_weights(INSTRUMENT, D50)
    spectrum = lab_to_spectrum((50, 40, 20), INSTRUMENT)

    def roughness(values):
        return np.sum(np.diff(np.arctanh(2.0 * values - 1.0)) ** 2)

    black = np.linalg.svd(weights.T)[2][3:]  # no colour at all
    rng = np.random.default_rng(1)
    for _ in range(20):
        other = spectrum + 1e-3 * (rng.normal(size=len(black)) @ black)
        np.testing.assert_allclose(lab_of(other), lab_of(spectrum), atol=1e-9)
        assert roughness(other) > roughness(spectrum)


@pytest.mark.parametrize(
    ("lab", "message"),
    [
        ((100, 20, 0), "L can be at most 95"),
        ((50, 80, 100), "L must be at least 58"),
        ((50, 150, 0), "whatever its lightness; use a and b nearer to 0"),
        ((50, 0), "expected three numbers L, a, b"),
        ((101, 0, 0), "L from 0 to 100"),
        ((50, 0, 201), "a and b from -200 to 200"),
        ((50, 0, float("nan")), "a and b from -200 to 200"),
        ((50, 0, "x"), "a and b from -200 to 200"),
    ],
)
def test_impossible_colours_are_refused(lab, message):
    with pytest.raises(InputError, match=message):
        lab_to_spectrum(lab, INSTRUMENT)


def test_rgb_names_its_gamut():
    with pytest.raises(InputError, match=r"a material of linear sRGB can't have this colour"):
        lab_to_spectrum((55, -37, -50), RGB)  # the cyan of ISO 12647-2
    lab_to_spectrum((57, -37, -50), WIDE_RGB)


def test_srgb_is_that_of_colour_science():
    colour = pytest.importorskip("colour")
    rng = np.random.default_rng(2)
    for srgb in rng.random((20, 3)):
        xyz = colour.sRGB_to_XYZ(srgb)
        white = D50.white_xyz()
        adapted = colour.adaptation.chromatic_adaptation_VonKries(
            xyz, colour.xy_to_XYZ((0.3127, 0.3290)), white, transform="Bradford"
        )
        expected = colour.XYZ_to_Lab(adapted, colour.XYZ_to_xy(white))
        np.testing.assert_allclose(srgb_to_lab(srgb), expected, atol=0.02)
        np.testing.assert_allclose(lab_to_srgb(srgb_to_lab(srgb)), srgb, atol=1e-9)
