"""Pictures for a profile, a black and a lit room: every operator, every file, what is warned of."""

from __future__ import annotations

import base64
import dataclasses
import io
import json
import re
from pathlib import Path

import numpy as np
import pytest
from materials import paper
from PIL import Image
from screens import WIDE, profile_file, to_d50, xicclu

from relgloss_view import Look, Scene
from relgloss_view.display.display import Display
from relgloss_view.display.icc_writing import profile_of
from relgloss_view.display.model import DisplayModel
from relgloss_view.gloss import comparison_page
from relgloss_view.operators.multiscale import Multiscale
from relgloss_view.operators.operator import SceneLight
from relgloss_view.operators.registry import OPERATORS, make_operator
from relgloss_view.picture.displayed import cut_out
from relgloss_view.picture.model import tone
from relgloss_view.picture.output.contact_sheet import contact_sheet, thumbnail
from relgloss_view.picture.output.export import save_frame
from relgloss_view.picture.output.parameters import parameters, warnings
from relgloss_view.picture.output.png import digital, save_pair

SIZE = (56, 44)
HALF_STEP = 0.5 / 255.0 + 1e-9
SURROUND = (0, 0)  #: a pixel that the object does not cover


@pytest.fixture(scope="module")
def profile(tmp_path_factory):
    return profile_file(tmp_path_factory.mktemp("screens"))


@pytest.fixture(scope="module")
def frames(reference, profile):
    """A glossy cylinder for several displays."""
    room = Display(luminance_cd_m2=100.0, black_cd_m2=0.3, reflected_cd_m2=6.0)
    displays = {
        "sRGB": Display(),
        "profile": Display(profile=profile),
        "in a room": dataclasses.replace(room, profile=profile),
        "sRGB in a room": room,
    }
    return {
        name: reference.render(Scene(paper("art"), display=display), Look(c=1.0), SIZE)
        for name, display in displays.items()
    }


def model_of(frame):
    return DisplayModel.of(frame.scene.display)


@pytest.mark.parametrize("name", ["profile", "in a room", "sRGB in a room"])
@pytest.mark.parametrize("operator", list(OPERATORS))
def test_every_operator_shows_what_its_light_is(frames, operator, name):
    frame = frames[name]
    model, picture = model_of(frame), make_operator(operator).draw(frame)
    assert np.all(picture.light >= model.lowest - 1e-12)
    assert np.all(tone.as_shown(picture.light, model) >= model.darkest)
    # Its digital values, to half a step, show that light. Curves of the file have plateaus, so the
    # light between the digital values beside it counts.
    steps = picture.digital.reshape(-1, 3) / 255.0
    light = picture.light.reshape(-1, 3)
    assert np.all(model.light(np.clip(steps - HALF_STEP, 0.0, 1.0)) <= light + 1e-6)
    assert np.all(model.light(np.clip(steps + HALF_STEP, 0.0, 1.0)) >= light - 1e-6)
    neutral = model.xyz(picture.digital[SURROUND][None] / 255.0)[0]
    assert tone.lab_from_xyz(neutral, model.white) == pytest.approx([50.0, 0.0, 0.0], abs=0.6)
    # The negative control: three equal values are no gray on this screen.
    if name == "profile":
        equal = np.full((1, 3), picture.digital[SURROUND][1] / 255.0)
        off = tone.lab_from_xyz(model.xyz(equal), model.white)[0]
        assert np.hypot(*off[1:]) > 5.0


@pytest.mark.parametrize("operator", [name for name in OPERATORS if name != "neutral"])
def test_two_screens_show_the_same_colours_where_both_can(frames, operator):
    """Neutral alone works in the display's own RGB."""
    shows = {}
    for name in ("sRGB", "profile"):
        # The profile's own luminance would change the tones of some operators.
        kind = make_operator(operator)
        if hasattr(kind, "display_cd_m2"):
            kind = dataclasses.replace(kind, display_cd_m2=100.0)
        if hasattr(kind, "display_mean_cd_m2"):
            kind = dataclasses.replace(kind, display_mean_cd_m2=50.0)
        shows[name] = kind.draw(frames[name])
    both = frames["sRGB"].on_object
    for picture in shows.values():
        black = tone.as_shown(picture.light, picture.display) > picture.display.darkest + 1e-9
        both = both & ~picture.out_of_gamut & ~picture.clipped & np.all(black, axis=-1)
    assert np.sum(both) > 40
    apart = np.abs(shows["sRGB"].lab - shows["profile"].lab)[both]
    # Colorants in steps of 1/65536 move dark colours by some 0.01.
    assert apart.max() < 0.05
    # The negative control: the same digital values on the other screen.
    digital_ = shows["sRGB"].digital[both] / 255.0
    wrong = tone.lab_from_xyz(
        shows["profile"].display.xyz(digital_), shows["profile"].display.white
    )
    assert np.abs(wrong - shows["sRGB"].lab[both]).max() > 5.0


def test_operators_take_the_luminance_that_is_known(frames):
    frame = frames["sRGB"]
    stated = dataclasses.replace(frame.scene.display, luminance_cd_m2=100.0)

    def drawn(display, **settings):
        light = dataclasses.replace(SceneLight.of(frame), display=DisplayModel.of(display))
        return Multiscale(**settings).apply(light).light

    same = drawn(frame.scene.display)
    assert np.array_equal(same, drawn(stated))
    bright = drawn(dataclasses.replace(stated, luminance_cd_m2=400.0))
    assert np.array_equal(bright, drawn(stated, display_cd_m2=400.0, display_mean_cd_m2=200.0))
    assert np.abs(bright - same).max() > 0.01  # the negative control


def test_16_bits_are_within_4_steps_of_argylls_inverse(frames):
    frame = frames["profile"]
    model, values = model_of(frame), digital(frame, None, 16).reshape(-1, 3).astype(float)
    xyz = to_d50(frame.light.reshape(-1, 3).astype(np.float64) @ model.xyz_from_rgb.T, model.white)
    theirs = 65535.0 * xicclu(frame.scene.display.profile, xyz, "-fb", "-ir", "-px")
    # Where 16 bits of the profile's curve are flat, several digital values show the same light: the
    # darkest of them are compared by light alone.
    steep = np.all(values > 0.12 * 65535.0, axis=1)
    assert np.mean(steep) > 0.5
    assert np.abs(values - theirs)[steep].max() <= 4.0
    light = model.light(values / 65535.0)
    assert np.abs(light - frame.light.reshape(-1, 3)).max() <= 2.6 * 4.0 / 65535.0
    # The negative control: sRGB's values are far off.
    srgb = digital(frames["sRGB"], None, 16).reshape(-1, 3)
    assert np.abs(srgb - theirs)[steep].max() > 1000.0


def test_files_carry_the_screen(frames, profile, tmp_path):
    frame = frames["in a room"]
    for name, bits in (("a.png", 8), ("b.png", 16)):
        save_frame(frame, tmp_path / name, bits=bits)
        with Image.open(tmp_path / name) as picture:
            assert picture.info["icc_profile"] == Path(profile).read_bytes()
            numbers = json.loads(picture.info["Parameters"])["shown_on"]
    assert numbers["name"] == "relgloss display, made up"
    assert numbers["source"] == "profile"
    assert (numbers["luminance_cd_m2"], numbers["luminance_assumed"]) == (106.0, False)
    assert numbers["black_cd_m2"] == pytest.approx(6.3, abs=1e-5)
    assert (numbers["black_assumed"], numbers["reflected_cd_m2"]) == (False, 6.0)
    plain = parameters(frames["sRGB"])["shown_on"]
    assert (plain["name"], plain["source"], plain["icc_sha256"]) == ("sRGB", "declared", None)
    assert (plain["luminance_cd_m2"], plain["luminance_assumed"]) == (100.0, True)


def test_pairs_and_sheets_have_the_surround_of_the_screen(frames, tmp_path):
    frame = frames["profile"]
    surround = np.round(255.0 * tone.surround_digital(model_of(frame))).astype(int)
    save_pair((frame, frame), tmp_path / "pair.png", ("", ""), gap_px=9)
    with Image.open(tmp_path / "pair.png") as picture:
        gap = np.asarray(picture)[:, SIZE[0] : SIZE[0] + 9]
        assert picture.info["icc_profile"] == profile_of(frame.scene.display)
    assert np.array_equal(np.unique(gap.reshape(-1, 3), axis=0), [surround])
    small = thumbnail(frame, 28)
    assert np.abs(small[SURROUND].astype(int) - surround).max() <= 1
    sheet = contact_sheet([[small]], [["a"]], display=frame.scene.display)
    assert np.abs(sheet[0, 0].astype(int) - surround).max() <= 1
    assert np.ptp(sheet[0, 0].astype(int)) > 20  # and so it is not the 119 of sRGB


def test_a_page_shows_pictures_with_the_profile(frames, profile):
    frame = frames["profile"]
    url = comparison_page._embedded(frame.display, frame.scene.display)
    data = base64.b64decode(re.fullmatch(r"data:image/png;base64,(.*)", url)[1])
    with Image.open(io.BytesIO(data)) as picture:
        assert picture.info["icc_profile"] == Path(profile).read_bytes()
        assert np.array_equal(np.asarray(picture), frame.display)


def test_openexr_is_what_the_screen_shows(frames, tmp_path):
    exr = pytest.importorskip("OpenEXR")
    frame = frames["in a room"]
    save_frame(frame, tmp_path / "a.exr")
    with exr.File(str(tmp_path / "a.exr"), separate_channels=True) as file:
        header = dict(file.header())
        rgba = np.stack([file.channels()[c].pixels for c in "RGBA"], axis=-1).astype(np.float64)
    model = model_of(frame)
    # Within the rounding of colorants to 1/65536.
    np.testing.assert_allclose(header["chromaticities"][:6], np.ravel(WIDE), atol=1e-3)
    np.testing.assert_allclose(header["chromaticities"][6:], (0.3127, 0.3290), atol=1e-4)
    assert header["display_cd_m2"] == pytest.approx(106.0)
    assert header["whiteLuminance"] == pytest.approx(frame.y_n_cd_m2) != pytest.approx(106.0)
    over = rgba[..., :3] + (1.0 - rgba[..., 3:]) * model.background_rgb
    shown = tone.as_shown(frame.light.astype(np.float64), model)
    np.testing.assert_allclose(over, shown, atol=1e-6)
    assert np.array_equal(np.float32(cut_out(frame, frame.light)[0]), np.float32(rgba[..., :3]))
    # The object is nowhere darker than the screen in this room, and would be elsewhere.
    black = 6.3 / 106.0
    luminance = (over @ model.xyz_from_rgb[1])[frame.on_object]
    assert luminance.min() == pytest.approx(black, abs=1e-6)
    elsewhere = frames["sRGB"].light @ model_of(frames["sRGB"]).xyz_from_rgb[1]
    assert elsewhere[frame.on_object].min() < 0.2 * black


def test_warnings_of_what_a_screen_cannot_show(frames):
    of_room = [w for w in warnings(frames["in a room"]) if "black" in w]
    assert len(of_room) == 1
    words = re.fullmatch(
        r"(\d+) % of the object is darker than the display's black, 6\.3 cd/m2, and appears as "
        r"that black\. Darken the room to see it\.",
        of_room[0],
    )
    frame = frames["in a room"]
    model = model_of(frame)
    rgb = tone.xyz_from_lab(frame.lab.astype(np.float64), model.white) @ model.rgb_from_xyz.T
    # Half a step of 8 bits is 1e-5 of light there. Edges, covered in part, are brighter.
    share = np.mean(np.all(rgb < model.lowest + 1e-5, axis=-1)[frame.on_object])
    assert int(words[1]) == pytest.approx(100.0 * share, abs=2.0)
    assert share > 0.2
    assert not [w for w in warnings(frames["sRGB"]) if "black" in w]


def test_a_luminance_that_is_assumed_is_named_where_it_matters(frames):
    frame, operator = frames["sRGB"], Multiscale()
    picture = operator.draw(frame)
    assumed = [w for w in warnings(frame, picture) if "100 cd/m2 is assumed" in w]
    assert len(assumed) == 1
    assert "the picture of multiscale depends" in assumed[0]
    assert "--set display.luminance_cd_m2=VALUE" in assumed[0]
    assert not [w for w in warnings(frame) if "assumed" in w]
    set_ = dataclasses.replace(operator, display_cd_m2=100.0).draw(frame)
    assert not [w for w in warnings(frame, set_) if "assumed" in w]
    known = frames["profile"]
    assert not [w for w in warnings(known, operator.draw(known)) if "assumed" in w]
