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
    from relgloss_view.viewer.state import packs

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

    hand.key(0x0) if False else None
    layers = []
    model.finish_names["test"] = added.name
    hand.app.layout.focus("Look")
    hand.frames(4)
    c = model.state.test.look.c
    hand.type("//Look/**/##Gloss factor (k)", "0.5", enter=True) if False else None
    hand.do(lambda: model.set_finish("test", added.name, gesture="k", k=0.5, sigma_n_deg=1.0))
    finish = model.active_finish("test")
    found["look"] = [finish.k, finish.sigma_n_deg, model.state.test.look.c == c]
    found["same artwork"] = model.pack("test").artwork is pack.artwork
    hand.do(model.history.undo)
    found["undone"] = [model.active_finish("test").k, model.active_finish("test").sigma_n_deg]
    del layers, packs


SCRIPTS = (a_pack,)


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
    print(got)
