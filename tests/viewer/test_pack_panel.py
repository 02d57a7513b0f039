"""A pack in the window, driven by labels: artwork dropped, finishes, the hand on the artwork."""

from __future__ import annotations

import driven
import numpy as np
import pytest
from PIL import Image

SIZE_MM = (207.3, 115.0)  # around a can of 66 mm


def write_artwork(path, stripe=False):
    """A light label with a red box at its centre, which faces the eye, at 1 pixel a mm."""
    pixels = np.full((115, 207, 3), 230, np.uint8)
    pixels[40:75, 90:117] = (200, 30, 30)
    if stripe:
        pixels[:20] = (20, 20, 160)
    Image.fromarray(pixels).save(path, dpi=(25.4, 25.4))
    return path


def write_mask(path):
    """White over the red box alone."""
    pixels = np.zeros((115, 207), np.uint8)
    pixels[40:75, 90:117] = 255
    Image.fromarray(pixels).save(path)
    return path


# --- scripts, run in the window's process ---------------------------------------------------------


def settled(hand):
    hand.until(lambda: hand.app.files._job is None and not hand.app.files._waiting)
    hand.frames(6)


def middle(hand):
    """The screen place of the middle of the test picture."""
    x, y = hand.app.stage_origin
    left, top, width, height = hand.app.drawn_pane.arrangement.rects["test"]
    return x + left + 0.5 * width, y + top + 0.5 * height


def a_pack(hand, found):

    model = hand.model
    hand.do(lambda: model.set_part("shape", kind="cylinder", diameter_m=0.066, height_m=0.115))
    hand.do(lambda: hand.app.dropped([str(write_artwork(hand.folder / "art.png"))]))
    hand.until(lambda: model.pack("test") is not None)
    settled(hand)
    pack = model.pack("test")
    found["form"], found["size"] = pack.shape.kind, [pack.artwork.width_mm, pack.artwork.height_mm]
    found["front"] = next(p.in_front for p in hand.app.layout.panels if p.title == "Pack")
    found["reference"] = model.pack("reference") is None

    hand.click("//Pack/Add")
    added = model.active_finish("test")
    found["added"] = [added.name, added.kind, added.mask]
    mask = str(write_mask(hand.folder / "mask.png"))
    hand.do(lambda: hand.app.files._masks.read(mask, "test", added.name))
    hand.until(lambda: model.active_finish("test").mask == mask)
    found["masked"] = model.active_finish("test").mask == mask

    steps = len(model.history._past)
    model.choose_finish("test", pack.base.name)
    hand.frames(2)
    hand.ctx.mouse_move_to_pos(middle(hand))
    hand.ctx.mouse_click(0)
    hand.frames(3)
    found["clicked"] = model.active_finish("test").name
    found["no step by a click"] = len(model.history._past) == steps
    hand.drag((middle(hand)[0], middle(hand)[1]), (30.0, 0.0))
    found["turned"] = model.state.setup.eye.azimuth_deg

    c, k = model.state.test.look.c, added.k
    model.finish_names["test"] = added.name
    hand.app.layout.focus("Look")
    hand.frames(4)
    hand.ctx.item_click("//Look/**/##Gloss factor (k)", 0)
    hand.frames(2)
    finish = model.active_finish("test")
    found["slider"] = [finish.name, finish.k != k, model.state.test.look.c == c]
    found["same artwork"] = model.pack("test").artwork is pack.artwork
    hand.do(model.history.undo)
    found["undone"] = model.active_finish("test").k == k


def carries_the_artwork(hand, found):
    from imgui_bundle import imgui

    from relgloss_view.viewer.panels.artwork_hand import _label_place

    model = hand.model
    hand.do(lambda: hand.app.files.model.change(model.state.placed(eye=Eye_of(hand))))
    hand.app.layout.focus("Pack")
    hand.frames(4)
    hand.click("//Pack/Move artwork")
    found["on"] = model.moving_artwork
    start, steps = middle(hand), len(model.history._past)
    rect = hand.app.drawn_pane.arrangement.rects["test"]
    at = (0.5 * rect[2], 0.5 * rect[3])
    places = [
        hand.do(lambda x=x: _label_place(model, "test", (at[0] + x, at[1]), rect[2:]))
        for x in (0.0, 40.0)
    ]
    hand.drag(start, (40.0, 0.0))
    hand.until(lambda: not model.dragging)
    placement = model.pack("test").placement
    found["carried"] = [placement.offset_x_mm, placement.offset_y_mm]
    found["meant"] = places[1][0] - places[0][0]
    found["steps"] = len(model.history._past) - steps
    found["eye stays"] = model.state.setup.eye == Eye_of(hand)
    hand.turn_wheel(start, 3)
    found["turned"] = model.pack("test").placement.turn_deg
    hand.until(lambda: not model.held)
    hand.click("//Pack/Move artwork")
    hand.ctx.mouse_move_to_pos(start)
    hand.frames(2)
    hand.drag(start, (-20.0, 0.0), keys=int(imgui.Key.mod_alt))
    found["with Alt"] = model.pack("test").placement.offset_x_mm < placement.offset_x_mm - 1.0
    before = model.pack("test").placement
    hand.drag(start, (20.0, 0.0))
    found["without"] = model.pack("test").placement == before


def Eye_of(hand):
    from relgloss_view.picture.scene.setup import Eye

    return Eye()


def shows_masks_and_pixels(hand, found):
    model = hand.model
    name = model.pack("test").finishes[-1].name
    model.masked = frozenset({name})
    found["tint"] = hand.until(lambda: "test" in model.tints)
    hand.app.layout.focus("Pixel")
    hand.ctx.mouse_move_to_pos(middle(hand))
    hand.frames(4)
    model.masked = frozenset()
    hand.frames(2)
    found["no tint"] = model.tints == {}
    hand.app.layout.focus("Scene")
    hand.frames(4)
    hand.click("//Scene/Add lamp")
    found["lamps"] = len(model.state.setup.further_lamps)
    hand.do(model.history.undo)
    hand.app.layout.focus("Pack")
    hand.frames(4)
    hand.click("//Pack/Remove pack")
    found["paper"] = model.pack("test") is None


SCRIPTS = (a_pack, carries_the_artwork, shows_masks_and_pixels)


# --- what they found ------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    folder = tmp_path_factory.mktemp("pack")
    return driven.drive(__name__, folder, panels=True, size=(1280, 800))


def test_an_artwork_becomes_a_pack_of_the_present_form(found):
    got = found["a_pack"]
    assert got["form"] == "cylinder"
    assert got["size"] == pytest.approx([207.0, 115.0], rel=1e-3)
    assert got["front"]
    assert got["reference"]


def test_finishes_are_added_masked_and_clicked(found):
    got = found["a_pack"]
    assert got["added"] == ["Gloss varnish", "varnish", "artwork"]
    assert got["masked"]
    assert got["clicked"] == "Gloss varnish"
    assert got["no step by a click"]
    assert abs(got["turned"]) > 5.0  # the control: a drag turns the object and chooses nothing


def test_the_slider_of_the_look_changes_the_active_finish_alone(found):
    got = found["a_pack"]
    assert got["slider"] == ["Gloss varnish", True, True]
    assert got["same artwork"]
    assert got["undone"]


def test_the_artwork_follows_the_hand(found):
    got = found["carries_the_artwork"]
    assert got["on"]
    assert got["meant"] > 3.0
    assert got["carried"] == pytest.approx([got["meant"], 0.0], abs=0.2)
    assert got["steps"] == 1
    assert got["eye stays"]
    assert got["turned"] == pytest.approx(3.0)
    assert got["with Alt"]
    assert got["without"]


def test_masks_pixels_and_lamps_show(found):
    got = found["shows_masks_and_pixels"]
    assert got["tint"]
    assert got["no tint"]
    assert got["lamps"] == 1
    assert got["paper"]
