"""Pictures exported from the window, driven by labels, against the command that goes with them."""

from __future__ import annotations

import json
import os
import shlex

import driven
import numpy as np
import pytest
from pictures import assert_same_pixels

from relgloss_view import cli

ODD = "x\udcff.png"
WINDOW = "//Export"


# --- scripts, run in the window's process ---------------------------------------------------------


def export(hand, picture, chosen, name):
    """Fill in the window and press its button; returns what it said."""
    hand.app.files.export()
    hand.frames(3)
    panel = hand.app.files._export
    if panel.picture != picture:
        hand.choose(f"{WINDOW}/##Picture", picture)
    if panel.format != chosen:
        hand.choose(f"{WINDOW}/##Format", chosen)
    hand.type(f"{WINDOW}/##File", name)
    hand.click(f"{WINDOW}/Export##go")
    assert hand.until(lambda: panel._request is None)
    return panel._message


def files(hand):
    return sorted(
        file.name
        for file in hand.folder.iterdir()
        if file.suffix in (".png", ".exr") and file.is_file()
    )


def one_picture(hand, found):
    from imgui_bundle import imgui

    hand.model.set_look("test", seed=5, samples=1)
    hand.model.set_part("presentation", mirror=True)  # changes nothing in one picture
    hand.frames(3)
    found["size"] = hand.model.picture_size
    found["told"] = export(hand, "test", "PNG, 8 bits", "one")
    hand.app.files.copy_command()
    found["copied"] = imgui.get_clipboard_text()
    export(hand, "test", "PNG, 16 bits", "one-16.png")
    export(hand, "test", "OpenEXR", "one")
    export(hand, "reference", "PNG, 8 bits", "left")
    found["files"] = files(hand)
    found["said"] = hand.said()


def both_pictures(hand, found):
    hand.model.set_part("presentation", mirror=False, gap_px=10.0)
    hand.frames(3)
    found["size"] = hand.model.picture_size
    for side in ("reference", "test"):
        export(hand, side, "PNG, 8 bits", f"pair-{side}.png")
    export(hand, "both", "PNG, 8 bits", "pair.png")
    hand.model.set_part("presentation", mirror=True)
    hand.frames(3)
    export(hand, "both", "PNG, 16 bits", "mirrored.png")
    hand.model.set_part("presentation", mirror=False)
    found["told"] = export(hand, "both", "OpenEXR", "two.exr")
    found["files"] = files(hand)


def another_size(hand, found):
    hand.model.set_part("presentation", compare="flip")  # only one picture is on the screen
    hand.frames(3)
    found["shown"] = list(hand.model.frames)
    hand.app.files.export()
    hand.frames(3)
    hand.choose(f"{WINDOW}/##Size", "other")
    hand.app.files._export.size = (97, 61)
    export(hand, "both", "PNG, 8 bits", "small.png")
    hand.choose(f"{WINDOW}/##Size", "as on the screen")
    export(hand, "test", "PNG, 8 bits", "unseen.png")
    hand.model.set_part("presentation", compare="side by side")


def asks_and_tells(hand, found):
    (hand.folder / "taken.png").write_bytes(b"held before")
    panel = hand.app.files._export
    found["asked"] = export(hand, "test", "PNG, 8 bits", "taken.png")
    assert panel._replacing is not None
    hand.click(f"{WINDOW}/Keep")
    found["kept"] = (hand.folder / "taken.png").read_bytes().decode()
    hand.click(f"{WINDOW}/Export##go", f"{WINDOW}/Replace")
    assert hand.until(lambda: panel._request is None)
    found["replaced"] = (hand.folder / "taken.png").read_bytes()[1:4].decode()
    before = files(hand)
    found["nowhere"] = export(hand, "test", "PNG, 8 bits", "nowhere/x.png")
    found["empty"] = export(hand, "test", "PNG, 8 bits", "")
    found["folder"] = export(hand, "test", "PNG, 8 bits", "folder.png")
    hand.type(f"{WINDOW}/##File", "x")
    hand.choose(f"{WINDOW}/##Format", "OpenEXR")
    found["suffix"] = panel.name.text
    found["none left"] = files(hand) == before
    # The dialog asks itself; what it has asked about is not asked about again.
    hand.choose(f"{WINDOW}/##Format", "PNG, 8 bits")
    hand.click(f"{WINDOW}/Choose...")
    hand.frames(3)
    hand.type("//Export to/##name", "taken.png", enter=True)
    hand.click("//Export to/Replace")
    found["chosen"] = os.path.basename(panel.name.text)
    hand.click(f"{WINDOW}/Export##go")
    found["asked again"] = panel._replacing is not None
    assert hand.until(lambda: panel._request is None)
    hand.click(f"{WINDOW}/Close")
    found["open"] = panel._open


def odd_names(hand, found):
    hand.app.files.export()
    hand.frames(3)
    panel = hand.app.files._export
    panel._chosen(str(hand.folder / ODD))
    hand.frames(2)
    hand.click(f"{WINDOW}/Export##go")
    assert hand.until(lambda: panel._request is None)
    found["told"] = panel._message
    hand.click(f"{WINDOW}/Close")


def waits_for_the_full_picture(hand, found):
    """While the wheel turns pictures may be small; nothing small is written."""
    hand.app.files.export()
    hand.frames(3)
    hand.type(f"{WINDOW}/##File", "full.png")
    panel = hand.app.files._export
    hand.model.hold()
    hand.app.draft_scale._step = 2  # half as wide, as after slow frames
    panel._submit()
    told, drafts = set(), []

    def done():
        told.add(panel._message)
        drafts.append(hand.model.draft)
        return panel._request is None

    assert hand.until(done)
    found["told"] = sorted(told)
    found["drafts"] = any(drafts)
    found["size"] = hand.model.picture_size


def looks_like_the_window(hand, found):
    hand.model.set_part("presentation", mirror=True, gap_px=30.0)
    hand.frames(3)
    export(hand, "both", "PNG, 8 bits", "window.png")
    hand.click(f"{WINDOW}/Close")
    hand.ctx.mouse_move_to_pos((1.0, 1.0))
    hand.frames(3)


SCRIPTS = (
    one_picture,
    both_pictures,
    another_size,
    asks_and_tells,
    odd_names,
    waits_for_the_full_picture,
    looks_like_the_window,
)


# --- tests ----------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    folder = tmp_path_factory.mktemp("export")
    (folder / "folder.png").mkdir()
    return folder


@pytest.fixture(scope="module")
def found(place):
    return driven.drive("test_export_panel", place, size=[560, 400])


def pixels(path):
    from PIL import Image

    with Image.open(path) as picture:
        return np.asarray(picture), picture.text, picture.info.get("icc_profile")


def pixels16(path):
    import mitsuba

    mitsuba.set_variant("scalar_rgb")
    got = np.array(mitsuba.Bitmap(str(path)))
    assert got.dtype == np.uint16
    return got


@pytest.fixture
def snapshot(tmp_path, monkeypatch, capsys):
    """Run a copied line in a folder of its own; returns the file that it wrote."""
    monkeypatch.chdir(tmp_path)

    def run(line, *more):
        words = shlex.split(line)
        assert words[0] == "relgloss"
        assert cli.main([*words[1:], *more]) == 0, capsys.readouterr().err
        return tmp_path / words[words.index("-o") + 1]

    return run


def test_one_picture_is_what_the_copied_command_draws(found, place, snapshot):
    got = found["one_picture"]
    exported, text, profile = pixels(place / "one.png")
    assert exported.shape == (got["size"][1], got["size"][0], 3)
    drawn, _, same_profile = pixels(snapshot(got["copied"]))
    assert_same_pixels(exported, drawn)
    assert profile is not None
    assert profile == same_profile
    again, _, _ = pixels(snapshot(text["Command"]))
    assert_same_pixels(exported, again)
    parameters = json.loads(text["Parameters"])
    assert parameters["seed"] == 5
    assert parameters["size"] == got["size"]
    # Negative control: another seed is another picture.
    other, _, _ = pixels(snapshot(got["copied"], "--seed", "6"))
    assert not np.array_equal(exported, other)


def test_sixteen_bits_are_what_their_command_draws(found, place, snapshot):
    deep = pixels16(place / "one-16.png")
    _, text, profile = pixels(place / "one-16.png")
    assert profile is not None
    assert "--bits 16" in text["Command"]
    assert_same_pixels(deep, pixels16(snapshot(text["Command"])))
    shallow, _, _ = pixels(place / "one.png")
    assert np.max(np.abs(deep / 257.0 - shallow)) < 1.01  # rounding, and dither
    # More than the 8 bits, repeated: hundreds of levels lie between theirs.
    assert len(np.unique(deep)) > 4 * len(np.unique(shallow))


def test_endings_are_added_and_everything_is_said(found):
    got = found["one_picture"]
    assert got["files"] == ["left.png", "one-16.png", "one.exr", "one.png"]
    assert got["told"].startswith("exported ")
    assert [fault for _, fault in got["said"]] == [False] * len(got["said"])
    assert len(got["said"]) == 5


def test_both_are_side_by_side_with_the_gap(found, place):
    width, height = found["both_pictures"]["size"]
    pair, text, profile = pixels(place / "pair.png")
    assert pair.shape == (height, 2 * width + 10, 3)
    left, right = pixels(place / "pair-reference.png")[0], pixels(place / "pair-test.png")[0]
    assert_same_pixels(pair[:, :width], left)
    assert_same_pixels(pair[:, width + 10 :], right)
    assert np.all(pair[:, width : width + 10] == left[0, 0])  # the surround
    assert not np.array_equal(left, right)
    assert profile is not None
    told = json.loads(text["Parameters"])
    assert told["reference"]["sample"] == "cast-coated, green ink"
    assert (told["test"]["seed"], told["gap_px"], told["mirrored"]) == (5, 10, False)
    lines = text["Command"].splitlines()
    assert [("cast-coated" in line) for line in lines] == [True, False]


def test_both_are_mirrored_as_the_window_mirrors_them(found, place):
    deep = pixels16(place / "mirrored.png")
    pair, _, _ = pixels(place / "pair.png")
    assert np.max(np.abs(deep[:, ::-1] / 257.0 - pair)) < 1.01
    assert np.max(np.abs(deep / 257.0 - pair)) > 20.0  # and not as they were


def test_both_as_floats_are_two_files(found, place):
    import OpenEXR

    got = found["both_pictures"]
    assert [n for n in got["files"] if n.startswith("two")] == [
        "two-reference.exr",
        "two-test.exr",
    ]
    for side in ("reference", "test"):
        with OpenEXR.File(str(place / f"two-{side}.exr")) as picture:
            assert f"two-{side}.exr" in picture.header()["command"]


def test_another_size_and_a_side_that_is_not_shown_are_drawn_for_it(found, place, snapshot):
    assert found["another_size"]["shown"] == ["reference", "test"]  # flip holds both
    small, text, _ = pixels(place / "small.png")
    assert small.shape == (61, 2 * 97 + 10, 3)
    reference, test = text["Command"].splitlines()
    assert_same_pixels(small[:, :97], pixels(snapshot(reference))[0])
    assert_same_pixels(small[:, 107:], pixels(snapshot(test))[0])
    unseen, text, _ = pixels(place / "unseen.png")
    assert_same_pixels(unseen, pixels(snapshot(text["Command"]))[0])


def test_it_asks_before_it_replaces_and_tells_faults(found):
    got = found["asks_and_tells"]
    assert got["asked"] == ""
    assert got["kept"] == "held before"
    assert got["replaced"] == "PNG"
    assert "no such folder" in got["nowhere"]
    assert "type the name" in got["empty"]
    assert "is a folder" in got["folder"]
    assert got["suffix"] == "x.exr"
    assert got["none left"]
    assert got["chosen"] == "taken.png"
    assert not got["asked again"]
    assert not got["open"]


def test_a_name_that_no_command_can_hold_is_written_without_one(found, place):
    assert "without a command" in found["odd_names"]["told"]
    _, text, _ = pixels(place / ODD)
    assert "Parameters" in text
    assert "Command" not in text


def test_nothing_small_is_written_while_something_is_dragged(found, place):
    got = found["waits_for_the_full_picture"]
    assert got["drafts"]
    assert "waiting for the full picture" in got["told"]
    width, height = got["size"]
    assert pixels(place / "full.png")[0].shape == (height, width, 3)


def test_both_are_what_the_window_shows(found, place):
    """The lower halves, where no captions stand, somewhere below the menu."""
    window = np.load(place / "window.npy")
    pair = pixels(place / "window.png")[0]
    height, width = pair.shape[:2]
    half = pair[height // 2 :]
    tops = range(window.shape[0] - height)
    assert len(tops) > 10
    same = [np.array_equal(window[top + height // 2 : top + height, :width], half) for top in tops]
    assert sum(same) == 1
    # Negative control: without the mirror it is found nowhere.
    other = half[:, ::-1]
    assert not any(
        np.array_equal(window[top + height // 2 : top + height, :width], other) for top in tops
    )
