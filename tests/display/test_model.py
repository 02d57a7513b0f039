"""DisplayModel: emitted light, black and reflected light add; the way back; contradictions."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from screens import BLACK, GAMMAS, profile_file, shown

from relgloss_view.base.errors import InputError
from relgloss_view.cli import main
from relgloss_view.display.display import USUAL_CD_M2, Display
from relgloss_view.display.model import DisplayModel
from relgloss_view.picture.model import tone
from relgloss_view.picture.scene.scene_file import load_scene
from relgloss_view.picture.scene.setup import Setup

FLARE = Display(transfer="gain-offset-gamma", gain=0.9, offset=0.1, gamma=2.2, flare=0.02)
PLAIN = {"sRGB": Display(), "flare": FLARE}


@pytest.fixture(scope="module")
def profile(tmp_path_factory):
    return profile_file(tmp_path_factory.mktemp("screens"))


def digital(count=200):
    values = np.random.default_rng(5).random((count, 3))
    values[0], values[1] = 0.0, 1.0
    return values


def of(display, **entries):
    return DisplayModel.of(dataclasses.replace(display, **entries))


def cd_m2(model, values):
    return model.luminance_cd_m2 * model.xyz(values)


@pytest.mark.parametrize("name", list(PLAIN))
@pytest.mark.parametrize(
    ("white", "black", "room"),
    [(200.0, 1.0, 0.0), (80.0, 0.0, 25.0), (300.0, 12.0, 7.0), (100.0, 99.0, 500.0)],
)
def test_light_adds(name, white, black, room):
    """What the pixels add is scaled so that white has what an instrument on the screen reads."""
    plain = DisplayModel.of(PLAIN[name])
    model = of(PLAIN[name], luminance_cd_m2=white, black_cd_m2=black, reflected_cd_m2=room)
    lowest, values = plain.xyz(np.zeros((1, 3))), digital()
    of_pixels = (plain.xyz(values) - lowest) / (1.0 - lowest[0, 1])
    expected = (white - black) * of_pixels + (black + room) * plain.white
    np.testing.assert_allclose(cd_m2(model, values), expected, rtol=1e-10)
    assert model.luminance_cd_m2 == white + room
    assert model.black_cd_m2 == pytest.approx(black + room, abs=1e-9)
    # The negative control: without the room's light, black and white are others.
    if room:
        dark = of(PLAIN[name], luminance_cd_m2=white, black_cd_m2=black)
        assert np.abs(cd_m2(dark, values) - expected).max() > 0.9 * room


def test_light_of_a_profile_adds(profile):
    values = digital()
    expected = 160.0 * shown(values)
    np.testing.assert_allclose(cd_m2(of(Display(profile=profile)), values), expected, atol=0.02)
    room = of(Display(profile=profile), reflected_cd_m2=9.0)
    white = room.white
    np.testing.assert_allclose(cd_m2(room, values), expected + 9.0 * white, atol=0.02)
    # A declared luminance scales all of it; a declared black is neutral and replaces the file's.
    half = of(Display(profile=profile), luminance_cd_m2=80.0)
    np.testing.assert_allclose(cd_m2(half, values), 0.5 * expected, atol=0.01)
    other = of(Display(profile=profile), black_cd_m2=4.0)
    np.testing.assert_allclose(cd_m2(other, values[:2]), [4.0 * white, 160.0 * white], atol=0.01)
    assert np.abs(cd_m2(other, values) - expected).max() > 2.0  # the negative control


@pytest.mark.parametrize(
    "entries",
    [{}, {"black_cd_m2": 2.0}, {"black_cd_m2": 0.0, "reflected_cd_m2": 30.0},
     {"luminance_cd_m2": 400.0, "reflected_cd_m2": 2.0}],
)  # fmt: skip
@pytest.mark.parametrize("kind", ["sRGB", "flare", "profile"])
def test_digital_values_come_back(kind, entries, profile):
    display = Display(profile=profile) if kind == "profile" else PLAIN[kind]
    model = of(display, **entries)
    values = digital()
    light = model.light(values)
    found = tone.encode(light, model)
    # A tenth of a step of 16 bits at the steepest, white. A profile's own steps make plateaus.
    np.testing.assert_allclose(model.light(found), light, atol=1.5e-6)
    if kind != "profile":
        np.testing.assert_allclose(found, values, atol=1e-9)
    # What is darker than the display's black is shown as that black, and never as a NaN.
    below = tone.encode(0.5 * model.darkest[None], model)
    np.testing.assert_allclose(below, 0.0, atol=1e-9)
    shown_ = tone.display_rgb(np.array([[0.0, 0.0, 0.0], [1.0, 60.0, -90.0]]), model)[0]
    assert np.all(tone.as_shown(shown_, model) >= model.darkest)


def test_nothing_new_changes_nothing():
    for display in PLAIN.values():
        plain, stated = of(display), of(display, luminance_cd_m2=USUAL_CD_M2)
        assert not np.any(plain.floor)
        assert not np.any(plain.lowest)
        assert np.array_equal(plain.xyz_from_rgb, stated.xyz_from_rgb)
        assert (plain.luminance_known, stated.luminance_known) == (False, True)


def test_the_gray_of_the_surround_has_three_digital_values(profile):
    model = DisplayModel.of(Display(profile=profile))
    neutral = float(tone.lab_f_inverse(np.array(66.0 / 116.0)))
    of_pixels = np.linalg.solve(
        model.xyz_from_rgb * (1.0 - model.floor), neutral * model.white - BLACK
    )
    expected = of_pixels ** (1.0 / np.array(GAMMAS))
    found = tone.surround_digital(model)
    # 4096 entries of 16 bits, whose steps are 0.0001 of these digital values at most.
    np.testing.assert_allclose(found, expected, atol=1e-4)
    assert np.ptp(found) > 0.1  # one value for all three would be no gray
    np.testing.assert_allclose(model.xyz(found[None])[0], neutral * model.white, atol=1e-6)
    assert tone.neutral_digital(neutral, model) == pytest.approx(tuple(found), abs=1e-9)
    # A surround below the display's black is that black.
    dark = DisplayModel.of(Display(profile=profile, background_lstar=0.0))
    np.testing.assert_allclose(tone.surround_digital(dark), 0.0, atol=1e-6)
    assert np.array_equal(dark.background_rgb, np.maximum(dark.lowest, 0.0))


@pytest.mark.parametrize(
    ("entries", "words"),
    [
        ({"luminance_cd_m2": 80.0, "black_cd_m2": 80.0}, "has 80 cd/m2, found 80"),
        ({"luminance_cd_m2": 80.0, "black_cd_m2": 81.0, "transfer": "gain-offset-gamma"}, "81"),
        ({"black_cd_m2": -1.0}, "expected 0 to 1000"),
        ({"black_cd_m2": float("nan")}, "display.black_cd_m2"),
        ({"luminance_cd_m2": 0.0}, "expected 1 to 10000"),
        ({"reflected_cd_m2": -0.1}, "expected 0 to 10000"),
        # On the line through green and blue: red would add nothing, and no RGB had an inverse.
        ({"white_xy": (0.225, 0.33)}, "the third one would be black"),
    ],
)
def test_contradictions_are_refused_in_one_line(entries, words):
    with pytest.raises(InputError) as caught:
        Display(**entries)
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_black_above_the_assumed_white_is_refused():
    """The white of a profile takes the place of the assumed one: only a setup has all of it."""
    with pytest.raises(InputError, match="is assumed to have 100 cd/m2"):
        Setup(display=Display(black_cd_m2=120.0))
    assert DisplayModel.of(Setup(display=Display(black_cd_m2=90.0)).display).floor[0] == 0.9


def test_a_black_that_contradicts_the_profile_is_refused(profile, tmp_path):
    with pytest.raises(InputError, match="has 160 cd/m2, found 170"):
        DisplayModel.of(Display(profile=profile, black_cd_m2=170.0))
    with pytest.raises(InputError, match="found 170"):  # so no window ever draws it
        Setup().with_entries("display", profile=profile, black_cd_m2=170.0)
    words = ["snapshot", "--backend", "reference", "--size", "24x20", "--display", profile, "-o"]
    words += [str(tmp_path / "a.png"), "--set"]
    assert main([*words, "display.black_cd_m2=150"]) == 0
    assert main([*words, "display.black_cd_m2=170"]) != 0
    scene = tmp_path / "s.toml"
    scene.write_text(f'[display]\nprofile = "{profile}"\nblack_cd_m2 = 170\n')
    with pytest.raises(InputError, match=r"display\.black_cd_m2"):
        load_scene(scene)
    scene.write_text(f'[display]\nprofile = "{profile}"\nblack_cd_m2 = 150\n')
    assert DisplayModel.of(load_scene(scene)[0].display).black_cd_m2 == pytest.approx(150.0)
