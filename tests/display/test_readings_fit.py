"""Fits to readings: displays behind Argyll's fakeread, simulated faults, negative controls."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from fakeread_displays import charts, needs_argyll, read, run, version_2
from simulated_displays import MATRIX, of, patches, readings, srgb

from relgloss_view.base.errors import InputError
from relgloss_view.display.candidates import gain_offset_gamma, monotone_cubic
from relgloss_view.display.fit import fit_display
from relgloss_view.display.readings import read_readings
from relgloss_view.material.cielab import lab_from_xyz
from relgloss_view.material.difference import delta_e_2000

MATRIX_PROFILES = ("sRGB", "AdobeRGB1998", "ECI-RGBv2", "Rec709", "ProPhotoRGB", "Bluish")
NOISES = (("-r", "1"), ("-R", "1"), ("-r", "1", "-u"), ("-R", "1", "-u"))


def unseen_difference(fit, unseen):
    """Mean dE2000 of a fit on patches it had not seen, relative to each white."""
    whites = np.all(unseen.rgb == 1.0, axis=1)
    white = np.median(unseen.xyz[whites], axis=0)
    model = fit.model
    shown = lab_from_xyz(model.xyz(unseen.rgb) / model.white[1], model.white / model.white[1])
    true = lab_from_xyz(unseen.xyz / white[1], white / white[1])
    return float(delta_e_2000(shown, true).mean()), float(model.white[1] / white[1])


@pytest.mark.slow
@needs_argyll
def test_a_noisy_display_is_found(tmp_path):
    charts(tmp_path)
    profile = version_2("AdobeRGB1998", tmp_path)
    noisy = read(tmp_path, profile, "chart", "noisy", "-S", "1", "-R", "1")
    fit = fit_display(read_readings(noisy))
    unseen = read_readings(read(tmp_path, profile, "unseen", "exact"))
    difference, luminance = unseen_difference(fit, unseen)
    assert fit.verdict == "good", fit.warnings
    assert difference <= 0.5
    assert abs(luminance - 1.0) <= 0.01
    # Control: another display's fit is far from these patches.
    other = read(tmp_path, version_2("sRGB", tmp_path), "unseen", "other")
    assert unseen_difference(fit, read_readings(other))[0] > 2.0


@pytest.mark.slow
@needs_argyll
@pytest.mark.parametrize("name", [*MATRIX_PROFILES, "table"])
def test_noisy_displays_are_found(name, tmp_path):
    charts(tmp_path)
    if name == "table":  # a look-up table that colprof makes of exact readings
        run(tmp_path, "targen", "-d3", "-f400", "many")
        read(tmp_path, version_2("sRGB", tmp_path), "many", "lut")
        run(tmp_path, "colprof", "-qm", "-ax", "-D", "lut", "lut")
        profile = tmp_path / "lut.icc"
    else:
        profile = version_2(name, tmp_path)
    unseen = read_readings(read(tmp_path, profile, "unseen", "exact"))
    for options in NOISES:
        for seed in (1, 2):
            noisy = read(tmp_path, profile, "chart", "noisy", "-S", seed, *options)
            fit = fit_display(read_readings(noisy))
            difference, luminance = unseen_difference(fit, unseen)
            print(name, options, seed, difference, luminance, fit.chosen, fit.verdict, fit.warnings)
            assert difference <= 0.5, (options, seed)
            assert abs(luminance - 1.0) <= 0.01, (options, seed)


def rgbw(digital):
    """A white subpixel adds a quarter to what is common to the channels."""
    light = srgb(digital)
    return 0.8 * light + 0.2 * light.min(axis=1, keepdims=True)


def limited(digital):
    """Power above 40 % of white's counts half, as an OLED's limiter has it."""
    light = srgb(digital)
    power = light.mean(axis=1, keepdims=True)
    return light * np.where(power > 0.4, (0.2 + 0.5 * power) / np.maximum(power, 1e-9), 1.0)


def clipped(digital):
    return srgb(np.minimum(digital / 0.9, 1.0))


def clipped_blue(digital):
    return srgb(np.minimum(digital / np.array([1.0, 1.0, 0.9]), 1.0))


def crushed(digital):
    return srgb(np.clip((digital - 0.1) / 0.9, 0.0, 1.0))


def reversed_channels(digital):
    return srgb(digital[:, ::-1])


FAST = [
    (readings(clipped), "Whites are clipped: above 90 % of the scale of red, green and blue"),
]
SLOW = [
    (readings(limited), "do not add: white is about 30 % darker"),
    (readings(reversed_channels), "exchanged: red shows blue and blue shows red"),
    (readings(rgbw), "channels do not add: white is about 25 % brighter"),
    (readings(srgb, white=46.7, declared=False), "as foot-lamberts it would be 160 cd/m2"),
    (readings(clipped_blue), "Whites are clipped: above 90 % of the scale of blue"),
    (readings(crushed, black=0.02), "Blacks are crushed: below 10 % of the scale of red, green"),
    (readings(lambda d: srgb(d[:, [1, 2, 0]])), "green shows red and blue shows green"),
    (readings(srgb, white=160_000.0), "White has 1.6e+05 cd/m2"),
    (readings(srgb, 0.5 * patches()), "largest digital value is 50 %"),
    (readings(srgb, patches(12)), "different colours were measured"),
    (readings(srgb, patches()[np.any(patches() > 0.1, axis=1)]), "Black was not measured"),
    (readings(srgb, 0.9 * patches()), "White was not measured"),
    (readings(srgb, noise=0.06), "readings scatter"),
]


@pytest.mark.parametrize(
    ("measured", "words"),
    [*FAST, *(pytest.param(*case, marks=pytest.mark.slow) for case in SLOW)],
    ids=[words[:24] for _, words in (*FAST, *SLOW)],
)
def test_a_fault_is_named(measured, words):
    fit = fit_display(measured)
    assert any(words in warning for warning in fit.warnings), fit.warnings
    assert fit.verdict == "poor"


def test_a_plain_display_has_no_fault():
    """The control of the faults: 1 % of noise, and no warning."""
    fit = fit_display(readings(srgb, noise=0.01))
    assert fit.warnings == ()
    assert fit.verdict == "good"
    # 100 patches of 1 %: white is known to a fraction of a percent.
    assert fit.luminance_cd_m2 == pytest.approx(160.0, rel=0.005)
    assert fit.black_cd_m2 == pytest.approx(0.2, rel=0.05)
    assert fit.gamut_share == pytest.approx(1.0, abs=0.02)


def changed(at, factor):
    plain = readings(srgb)
    xyz = plain.xyz.copy()
    xyz[at] *= factor
    return dataclasses.replace(plain, xyz=xyz)


@pytest.mark.slow
def test_one_misread_patch_is_left_out_by_name():
    bright = int(np.argsort(readings(srgb).xyz[:, 1])[60])
    fit = fit_display(changed(bright, 1.4))
    assert fit.misread == (f"line {bright + 2}",)
    assert any(f"line {bright + 2}" in warning for warning in fit.warnings)


@pytest.mark.slow
def test_repeats_and_drift_are_named():
    white = int(np.flatnonzero(np.all(patches() == 1.0, axis=1))[0])
    apart = fit_display(changed(white, 0.9))
    assert any("read 10 % apart" in warning for warning in apart.warnings)
    dimmed = fit_display(changed(slice(None), np.linspace(1.0, 0.95, 100)[:, None]))
    assert any("dimmed by 4." in w or "dimmed by 5." in w for w in dimmed.warnings)


@pytest.mark.parametrize(
    ("measured", "words"),
    [
        (of(np.linspace(0, 1, 21)[:, None].repeat(3, 1), np.ones((21, 3))), "all patches are gray"),
        (of(patches(100), readings(srgb).xyz[::-1]), "do not rise with R, G and B"),
        (of(patches(100), readings(srgb).xyz - [0, 0, 120.0]), "light is not below 0"),
        (of(patches(6), np.ones((6, 3))), "a model needs at least 8"),
        (of(patches(100), np.zeros((100, 3))), "expected the light of a display"),
    ],
)  # fmt: skip
def test_what_carries_no_model_is_refused(measured, words):
    with pytest.raises(InputError, match=words) as refused:
        fit_display(measured)
    assert "\n" not in str(refused.value)


@pytest.mark.slow
def test_folds_come_of_the_seed():
    measured = readings(srgb, patches(40), noise=0.01)
    first, again, other = (fit_display(measured, seed=seed) for seed in (0, 0, 1))
    assert first.candidates == again.candidates
    assert first.monitor.fitted == again.monitor.fitted
    assert first.candidates != other.candidates


def test_monotone_cubic_is_pchip():
    from scipy.interpolate import PchipInterpolator

    rng = np.random.default_rng(0)
    at, values = np.sort(rng.random(8)), np.cumsum(rng.random(8) ** 4)
    x = np.linspace(at[0], at[-1], 500)
    np.testing.assert_allclose(
        monotone_cubic(at, values, x), PchipInterpolator(at, values)(x), atol=1e-12
    )


def test_gain_offset_gamma_is_that_of_bt_1886():
    """BT.1886 with a black is gain, offset and gamma (ITU-R BT.1886, annex 1): a closed form that
    colour-science has."""
    from colour.models import eotf_BT1886

    digital = np.linspace(0.0, 1.0, 33)
    white, black = 100.0, 0.5
    low, high = black ** (1 / 2.4), white ** (1 / 2.4)
    shown = np.array([float(eotf_BT1886(d, L_B=black, L_W=white)) for d in digital])
    offset = low / high  # gain 1 - offset of white's root
    expected = (shown - black) / (white - black)
    np.testing.assert_allclose(gain_offset_gamma(digital, offset, 2.4), expected, atol=1e-9)
    assert np.abs(gain_offset_gamma(digital, 0.0, 2.4) - expected).max() > 0.01
    assert MATRIX.shape == (3, 3)
