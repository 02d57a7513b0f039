"""Through the other's display: its light on this one's screen, in cd/m2."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest
from materials import paper

from relgloss_view.display import model as model_module
from relgloss_view.display.display import Display
from relgloss_view.display.icc_monitor import monitor_of_profile
from relgloss_view.display.model import DisplayModel
from relgloss_view.display.monitor import Curves, Monitor, with_black
from relgloss_view.display.tone_curve import ToneCurve
from relgloss_view.material.spectra import rgb_to_xyz_matrix, white_from_xy
from relgloss_view.operators.registry import OPERATORS, make_operator
from relgloss_view.picture.model import tone
from relgloss_view.picture.model.difference import delta_e_2000
from relgloss_view.picture.output.parameters import parameters, warnings
from relgloss_view.picture.output.png import digital
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.setup import Setup
from relgloss_view.picture.seen import Tally, screen_limits, seen_words

COLORD = Path("/usr/share/color/icc/colord")
D65_XY, D50_XY = (0.3127, 0.3290), (0.3457, 0.3585)
SRGB_XY = ((0.64, 0.33), (0.30, 0.60), (0.15, 0.06))
REC2020_XY = ((0.708, 0.292), (0.170, 0.797), (0.131, 0.046))
INVERSION = 1e-6  #: of a curve, by regula falsi within 1/4096


def monitor(name, cd_m2, *, primaries=SRGB_XY, white=D65_XY, black=0.0, known=True) -> Monitor:
    """A screen whose channels follow d^2.2 over a neutral black, a share of white."""
    xyz = white_from_xy(white)
    matrix, floor = with_black(rgb_to_xyz_matrix(primaries, white) * (1.0 - black), black * xyz)
    curves = (ToneCurve(lambda d: d**2.2),) * 3
    return Monitor(name, "readings", xyz, matrix, floor, Curves(curves), cd_m2, known)


@pytest.fixture
def screens(monkeypatch):
    """Monitors in place of files, by name."""
    by_name = {
        "own": monitor("own", 160.0),
        "bright": monitor("bright", 250.0),
        "wide": monitor("wide", 160.0, primaries=REC2020_XY),
        "glare": monitor("glare", 90.0, black=0.02),
        "deep": monitor("deep", 160.0, black=0.0001),
        "unknown": monitor("unknown", None, known=False),
        "warm": monitor("warm", 160.0, white=D50_XY),
    }
    monkeypatch.setattr(model_module, "monitor_of", by_name.__getitem__)
    return by_name


def emitted(space: str, digital: np.ndarray) -> np.ndarray:
    """XYZ (N, 3) of digital values, white at Y = 1, by colour-science from the standards."""
    import colour

    return np.asarray(colour.RGB_to_XYZ(digital, space, apply_cctf_decoding=True))


@pytest.mark.skipif(not COLORD.is_dir(), reason="colord's profiles are not installed")
def test_both_displays_emit_the_same_light_by_colour_science(monkeypatch):
    spaces = {"own": "sRGB", "other": "Adobe RGB (1998)"}
    files = {"own": COLORD / "sRGB.icc", "other": COLORD / "AdobeRGB1998.icc"}
    by_name = {
        name: dataclasses.replace(monitor_of_profile(file.read_bytes(), name), luminance_cd_m2=cd)
        for (name, file), cd in zip(files.items(), (160.0, 250.0), strict=True)
    }
    monkeypatch.setattr(model_module, "monitor_of", by_name.__getitem__)
    seen = DisplayModel.of(Display(profile="own", seen_on="other"))
    values = np.random.default_rng(3).uniform(0.0, 1.0, (600, 3))
    light = seen.floor + (1.0 - seen.floor) * by_name["other"].emission.light(values)
    kept = ~tone.cut_by_screen(light, seen)
    assert 60 < np.sum(kept) < 540  # both kinds of colours are among them
    wanted = 250.0 * emitted(spaces["other"], values)
    plain = tone.encode(light, DisplayModel.of(Display(profile="own")))
    got, without = (160.0 * emitted(spaces["own"], d) for d in (tone.encode(light, seen), plain))
    white = 160.0 * white_from_xy(D65_XY)

    def difference(xyz: np.ndarray) -> np.ndarray:
        return delta_e_2000(tone.lab_from_xyz(wanted, white), tone.lab_from_xyz(xyz, white))

    error = difference(got)
    assert np.mean(error[kept]) < 0.1  # issue 18's bounds of a profile against another program
    assert np.max(error[kept]) < 0.5
    assert np.mean(difference(without)[kept]) > 5.0
    assert np.median(error[~kept]) > 1.0  # what is called cut is seen to be


class TestLight:
    def test_gray_has_the_others_luminance(self, screens):
        seen = DisplayModel.of(Display(profile="own", seen_on="bright"))
        d = tone.encode(np.full((1, 3), 0.3), seen)
        assert 160.0 * d[0, 1] ** 2.2 == pytest.approx(0.3 * 250.0, rel=INVERSION)

    @pytest.mark.parametrize("other", ["bright", "glare", "warm", "unknown"])
    def test_matched_white_just_fits(self, screens, other):
        seen = DisplayModel.of(Display(profile="own", seen_on=other, seen_white="matched"))
        white = tone.on_screen(np.ones((1, 3)), seen)
        assert white.max() == pytest.approx(1.0, abs=1e-12)

    def test_unknown_luminance_is_white_to_white(self, screens):
        for own, other in (("unknown", "bright"), ("bright", "unknown")):
            seen = DisplayModel.of(Display(profile=own, seen_on=other)).seen
            assert seen is not None
            assert (seen.how, seen.scale) == ("white to white", pytest.approx(1.0))

    def test_the_others_black_is_its_glare(self, screens):
        seen = DisplayModel.of(Display(profile="own", seen_on="glare"))
        d = tone.encode(np.zeros((1, 3)), seen)
        assert 160.0 * d[0, 1] ** 2.2 == pytest.approx(0.02 * 90.0, rel=1e-6)

    def test_no_darker_than_this_ones_black(self, screens):
        seen = DisplayModel.of(Display(profile="glare", seen_on="deep"))
        assert np.all(tone.encode(np.zeros((1, 3)), seen) == 0.0)

    def test_light_of_the_room_counts_on_this_side(self, screens):
        lit = Display(profile="own", seen_on="deep", reflected_cd_m2=4.0)
        d = tone.encode(np.full((1, 3), 0.3), DisplayModel.of(lit))
        assert 160.0 * d[0, 1] ** 2.2 + 4.0 == pytest.approx(0.3 * 160.0, rel=INVERSION)


def shares(own: str, other: str, light: np.ndarray) -> tuple[float, ...]:
    tally = Tally(DisplayModel.of(Display(profile=own, seen_on=other)))
    tally.add(light)
    return dataclasses.astuple(tally.limits())


class TestLimits:
    def test_each_kind_by_itself(self, screens):
        gray = np.linspace(0.005, 1.0, 200)[:, None] * np.ones(3)
        cut, brighter, darker, saturated = shares("own", "bright", gray)
        assert (darker, saturated) == (0.0, 0.0)
        assert cut == brighter == pytest.approx(np.mean(gray[:, 0] > 0.64), abs=0.006)
        assert shares("glare", "deep", 0.5 * gray)[2] == pytest.approx(
            np.mean(0.5 * gray[:, 0] * 160.0 < 0.02 * 90.0), abs=0.01
        )
        vivid = np.array([[0.5, 0.0, 0.0], [0.0, 0.5, 0.0], [0.3, 0.3, 0.3], [0.0, 0.0, 0.2]])
        assert shares("own", "wide", vivid) == (0.75, 0.0, 0.0, 0.75)
        assert shares("wide", "own", vivid) == (0.0, 0.0, 0.0, 0.0)
        assert shares("own", "own", vivid) == (0.0, 0.0, 0.0, 0.0)

    def test_of_nothing(self, screens):
        assert shares("own", "bright", np.zeros((0, 3))) == (0.0, 0.0, 0.0, 0.0)


def frame_for(reference, **display):
    setup = Setup().with_entries("display", **display)
    return reference.render(Scene(paper("art"), setup), Look(c=0.7), (40, 32))


class TestPictures:
    def test_of_the_same_screen_nothing_changes(self, screens, reference):
        plain, seen = (
            frame_for(reference, profile="own", seen_on=on, dither="ordered") for on in ("", "own")
        )
        assert np.array_equal(plain.display, seen.display)
        other = frame_for(reference, profile="own", seen_on="bright", dither="ordered")
        assert not np.array_equal(plain.display, other.display)

    def test_light_stays_the_others(self, screens, reference):
        seen, other = (
            frame_for(reference, **d)
            for d in ({"profile": "own", "seen_on": "bright"}, {"profile": "bright"})
        )
        assert np.array_equal(seen.light, other.light)
        assert (seen.c, seen.c_max) == (other.c, other.c_max)

    def test_sixteen_bits(self, screens, reference):
        frame = frame_for(reference, profile="own", seen_on="bright")
        surround = digital(frame, None, 16)[0, 0] / 65535.0
        gray = ((50.0 + 16.0) / 116.0) ** 3  # CIE 15, L* = 50
        assert 160.0 * surround**2.2 == pytest.approx(np.full(3, 250.0 * gray), rel=1e-4)

    def test_numbers_and_words(self, screens, reference):
        frame = frame_for(reference, profile="own", seen_on="bright")
        limits = screen_limits(frame)
        numbers = parameters(frame)["seen_on"]
        assert limits is not None
        assert limits.brighter > 0.0
        assert numbers["shares"]["cut"] == limits.cut
        assert (numbers["other_cd_m2"], numbers["screen_cd_m2"]) == (250.0, 160.0)
        on_object = frame.on_object
        assert np.mean(frame.cut_by_screen[on_object]) == pytest.approx(limits.cut, abs=0.02)
        text = " ".join(warnings(frame))
        assert "the white of bright has 250 cd/m2, this display's 160" in text
        assert "--seen-white matched" in text
        dimmed = frame_for(reference, profile="own", seen_on="bright", seen_white="matched")
        assert parameters(dimmed)["seen_on"]["shares"]["brighter"] == 0.0
        assert "at 0.64 times its light" in seen_words(DisplayModel.of(dimmed.scene.display).seen)
        nobody = frame_for(reference, profile="unknown", seen_on="unknown", reflected_cd_m2=1.0)
        assert "not known of unknown and of this display" in " ".join(warnings(nobody))
        assert parameters(frame_for(reference, profile="own"))["seen_on"] is None

    def test_every_operator(self, screens, reference):
        frame = frame_for(reference, profile="own", seen_on="bright")
        for name in OPERATORS:
            displayed = make_operator(name).draw(frame)
            limits = screen_limits(frame, displayed)
            assert limits is not None
            assert limits.cut >= limits.brighter
            assert np.array_equal(displayed.digital[0, 0], frame.display[0, 0])  # the surround
