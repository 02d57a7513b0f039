"""The whole window, driven by its labels without a display; what it draws, and what it leaves."""

from __future__ import annotations

import ctypes
import dataclasses
import itertools
import time

import driven
import numpy as np
import pytest

from relgloss_view.display.display import Display
from relgloss_view.pack.shape import ANALYTIC as SHAPES
from relgloss_view.pack.shape import Shape
from relgloss_view.picture.gpu import constants
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.setup import Eye, Lamp
from relgloss_view.viewer.panels import display, scene
from relgloss_view.viewer.shell.widgets import label_of
from relgloss_view.viewer.state import model as state_of
from relgloss_view.viewer.state.matching import share_of_match
from relgloss_view.viewer.state.state import COMPARE_MODES, Presentation

SIZE = (1000, 760)
LOOK, SCENE, SAMPLE = "//Look", "//Scene", "//Sample"
#: Labels that the look declares, as the engine reads them: a slash parts ids.
SHARE, FOLD = "Contrast gloss", "In numbers (c, c_max)"
SIGMA_N, C, C_SHARE, SEED = (
    label_of(Look, name).replace("/", "\\/") for name in ("sigma_n_deg", "c", "c_fraction", "seed")
)


# --- scripts, run in the window's process ---------------------------------------------------------


def middle(hand, side="test"):
    """A place in the middle of a picture, on the screen."""
    staged = hand.app.drawn_pane
    left, top, width, height = staged.arrangement.rects[side]
    return left + width / 2, top + height / 2 + hand.app.stage_origin[1]


def passes(hand):
    """How often each pass was drawn so far, as 'side pass'."""
    drawn = hand.app.pair_renderer.drawn
    return {f"{s} {n}": c for s, counts in drawn.items() for n, c in counts.items() if c}


def since(before, hand):
    return {k: n - before.get(k, 0) for k, n in passes(hand).items() if n != before.get(k, 0)}


def starts_full_and_then_rests(hand, found):
    hand.frames(6)
    found["frames"] = sorted(hand.model.frames)
    before = passes(hand)
    compiled = hand.app.pair_renderer.compiled
    hand.frames(10)
    found["drawn at rest"] = since(before, hand)
    found["compiled at rest"] = hand.app.pair_renderer.compiled - compiled


def tunes_the_look(hand, found):
    model = hand.model
    hand.ctx.item_input_value(f"{LOOK}/##{SIGMA_N}", 1.25)
    hand.frames(2)
    found["typed"] = model.state.test.look.sigma_n_deg
    hand.ctx.item_input_value(f"{LOOK}/##{SIGMA_N}", 7.5)  # beyond the slider, inside the range
    hand.frames(2)
    found["beyond"] = model.state.test.look.sigma_n_deg
    hand.ctx.item_input_value(f"{LOOK}/##{SIGMA_N}", 99.0)
    hand.frames(2)
    found["held"] = model.state.test.look.sigma_n_deg
    time.sleep(0.5)  # longer than a double click takes
    hand.frames(2)
    steps = len(model.history._past)
    hand.double_click(f"{LOOK}/##{SIGMA_N}")
    found["reset"] = model.state.test.look.sigma_n_deg
    hand.ctx.item_input_value(f"{LOOK}/##{SHARE}", 0.5)
    hand.frames(2)
    found["share"] = share_of_match(model.state, "test")
    hand.click(f"{LOOK}/{FOLD}")
    hand.ctx.item_input_value(f"{LOOK}/{FOLD}/##{C}", 1.5)
    hand.frames(2)
    found["c"] = [model.state.test.look.c, model.state.test.look.c_fraction]
    found["scaled"] = [model.factor, model.frames["test"].clip_count]
    hand.click(f"{LOOK}/{label_of(Presentation, 'clip_highlights')}")
    found["warned"] = [w for w in model.frames["test"].warnings if "above" in w]
    hand.click(f"{LOOK}/{label_of(Presentation, 'clip_highlights')}")
    hand.click(f"{LOOK}/Match again")
    found["matched"] = share_of_match(model.state, "test")
    hand.click(f"{LOOK}/Reference")
    hand.ctx.item_input_value(f"{LOOK}/{FOLD}/##{C_SHARE}", 0.5)
    hand.frames(2)
    frame = model.frames["reference"]
    found["reference"] = model.state.reference.look.c / frame.c_max
    found["steps"] = len(model.history._past) - steps


def chooses_the_quality(hand, found):
    from imgui_bundle import imgui

    from relgloss_view.viewer.panels.drawing_words import quality_words

    model = hand.model
    kept, side = model.state, model.active_side

    def quality():
        hand.frames(3)
        return [model.state.side(side).look.quality, quality_words(model.frames[side])]

    found["first"] = quality()
    text = label_of(Look, "quality")
    hand.click(f"{LOOK}/exact##{text}", f"{LOOK}/auto##{text}")
    found["auto"] = quality()
    hand.click(f"{LOOK}/exact##{text}")
    found["exact"] = quality()
    hand.key(int(imgui.Key.q))
    found["by key"] = quality()
    model.change(kept)
    hand.frames(2)


def tunes_the_scene(hand, found):
    model = hand.model
    kept = model.state
    hand.app.layout.focus("Scene")
    hand.frames(3)
    sliders = {
        "lamp": (Lamp, scene._LAMP),
        "eye": (Eye, scene._EYE),
        "display": (Display, display.SURROUND),
        "presentation": (Presentation, display.PRESENTATION),
    }
    for part, (owner, names) in sliders.items():
        for name in names:
            hand.ctx.item_input_value(f"{SCENE}/##{label_of(owner, name)}", 12.5)
            hand.frames(1)
            found[f"{part}.{name}"] = getattr(model.state.part(part), name)
    sizes = [f.name for f in dataclasses.fields(Shape) if "range" in f.metadata]
    for kind in SHAPES:
        hand.choose(f"{SCENE}/##{label_of(Shape, 'kind')}", kind)
        hand.frames(2)
        there = [name for name in sizes if hand.there(f"{SCENE}/##{label_of(Shape, name)}")]
        found[kind] = [model.state.setup.shape.kind, *there]
    hand.app.layout.focus("Look")
    model.change(kept)
    hand.frames(4)


def takes_back_and_does_again(hand, found):
    from imgui_bundle import imgui

    model = hand.model
    ctrl = int(imgui.Key.mod_ctrl)
    began = model.state
    hand.ctx.item_input_value(f"{LOOK}/##{SEED}", 7)
    hand.frames(2)
    changed = model.state
    hand.key(ctrl | int(imgui.Key.z))
    found["undone"] = model.state == began
    hand.key(ctrl | int(imgui.Key.y))
    found["redone"] = model.state == changed != began
    hand.ctx.menu_click("//##MainMenuBar/Edit/Undo")
    hand.frames(2)
    found["by menu"] = model.state == began


def turns_moves_and_zooms(hand, found):
    from imgui_bundle import imgui

    model = hand.model
    model.active_side = "test"
    place = middle(hand)
    steps = len(model.history._past)
    hand.drag(place, (60.0, 24.0))
    found["turned"] = [model.state.setup.eye.azimuth_deg, model.state.setup.eye.elevation_deg]
    found["width"] = model.picture_size[0]
    hand.drag(place, (0.0, 30.0), button=1)
    found["moved"] = model.state.setup.eye.shift_up
    found["steps"] = len(model.history._past) - steps
    left = middle(hand, "reference")
    samples = [side.sample for side in (model.state.reference, model.state.test)]
    hand.drag(left, (0.0, -30.0), button=1)  # the reference is locked
    hand.drag(left, (5.0, 0.0), keys=int(imgui.Key.mod_ctrl))
    hand.drag(left, (-5.0, 0.0), keys=int(imgui.Key.mod_ctrl))
    kept = samples == [side.sample for side in (model.state.reference, model.state.test)]
    found["locked"] = [model.active_side, kept, model.state.setup.eye.shift_up]
    hand.turn_wheel(place, 3)
    hand.until(lambda: not model.held)
    found["zoomed"] = model.state.setup.eye.field_of_view_deg
    before = model.state.setup.lamp.azimuth_deg
    hand.drag(place, (40.0, 0.0), keys=int(imgui.Key.mod_ctrl))
    found["lamp"] = model.state.setup.lamp.azimuth_deg - before
    hand.ctx.mouse_move_to_pos(place)
    hand.ctx.mouse_double_click(0)
    hand.frames(2)
    found["reset"] = [model.state.setup.eye.azimuth_deg, model.state.setup.eye.field_of_view_deg]
    for at_once in (True, False):
        before, kept = model.state.setup, model.state
        hand.drag(place, (20.0, 0.0), at_once=at_once)
        hand.drag(place, (0.0, 12.0), button=1, at_once=at_once)
        hand.drag(place, (16.0, 0.0), keys=int(imgui.Key.mod_ctrl), at_once=at_once)
        found[f"at once {at_once}"] = [
            model.state.setup.eye.azimuth_deg - before.eye.azimuth_deg,
            model.state.setup.eye.shift_up - before.eye.shift_up,
            model.state.setup.lamp.azimuth_deg - before.lamp.azimuth_deg,
        ]
        model.change(kept)


def draws_only_what_changed(hand, found):
    model = hand.model
    hand.until(lambda: not model.dragging)
    kept = model.state
    for side in ("reference", "test"):  # quality auto may draw other stages after any change
        model.set_look(side, quality="exact")
    hand.frames(8)
    hand.until(
        lambda: not hand.app.hold.rest_awaited
    )  # the hand has rested: programs are warmed up
    hand.frames(20)
    compiled = hand.app.pair_renderer.compiled
    for name, change in (
        ("c", {"c_fraction": 0.41, "c": None}),
        ("sigma_n", {"sigma_n_deg": 1.7}),
        ("no sigma_n", {"sigma_n_deg": 0.0}),
        ("sigma_n again", {"sigma_n_deg": 0.4}),
    ):
        before = passes(hand)
        model.set_look("test", **change)
        hand.frames(1)
        drawn = since(before, hand)
        found[name] = {k: n for k, n in drawn.items() if "counts" not in k}
        hand.frames(3)
    before = passes(hand)
    model.set_part("lamp", azimuth_deg=61.0)
    hand.frames(3)
    fetched = ("counts", "light", "geometry")  # by panels that show numbers
    found["lamp"] = sorted(k for k in since(before, hand) if not k.endswith(fetched))
    found["compiled"] = hand.app.pair_renderer.compiled - compiled
    model.change(kept)
    hand.frames(4)


def draws_no_more_than_needed(hand, found):
    model = hand.model
    kept = model.state

    def methods():
        return {side: frame.method.differences() for side, frame in model.frames.items()}

    model.set_look("reference", quality="exact")
    model.set_look("test", quality="auto", sigma_n_deg=1.0)
    hand.frames(6)
    found["auto"] = methods()
    hand.until(lambda: not hand.app.hold.rest_awaited)  # programs are warmed up before a drag
    hand.frames(20)
    compiled = hand.app.pair_renderer.compiled
    found["moved"] = []
    usual, state_of.HOLD_S = state_of.HOLD_S, driven.NEVER_S  # a busy machine pauses in the drag
    for k in range(12):
        model.hold()
        model.set_part("lamp", azimuth_deg=50.0 + 5.0 * k)
        hand.frames(2)
        found["moved"].append(methods()["test"])
        time.sleep(0.03)
    found["compiled in the drag"] = hand.app.pair_renderer.compiled - compiled
    state_of.HOLD_S = usual
    model.hold()
    hand.until(lambda: not model.dragging)
    hand.frames(6)
    found["rested"] = methods()["test"]
    model.change(kept)
    hand.frames(4)


def compares(hand, found):
    from imgui_bundle import imgui

    model = hand.model
    keys = imgui.Key
    for k, mode in enumerate(COMPARE_MODES):
        hand.key((keys._1, keys._2, keys._3, keys._4)[k])
        found[mode] = [
            model.state.presentation.compare,
            sorted(hand.app.drawn_pane.arrangement.rects),
        ]
    hand.key(keys._3)
    hand.ctx.key_down(keys.space)
    hand.frames(2)
    found["flipped"] = sorted(hand.app.drawn_pane.arrangement.rects)
    hand.ctx.key_up(keys.space)
    hand.frames(2)
    found["back"] = sorted(hand.app.drawn_pane.arrangement.rects)
    hand.key(keys._2)
    edge = model.state.presentation.wipe * sum(
        r[2] for r in [hand.app.drawn_pane.arrangement.rects["test"]]
    )
    top = hand.app.stage_origin[1]
    hand.drag((edge, top + 200.0), (80.0, 0.0))
    found["wipe"] = model.state.presentation.wipe
    hand.key(keys._1)
    for _ in range(len(constants.OVERLAYS)):
        hand.key(keys.o)
        found.setdefault("overlays", []).append(model.state.presentation.overlay)
    hand.key(keys.o)
    found["none"] = model.state.presentation.overlay


def hides_panels_and_brings_them_back(hand, found):
    from imgui_bundle import imgui

    def places():
        return {
            p.title: [*imgui.internal.find_window_by_name(p.title).pos,
                      *imgui.internal.find_window_by_name(p.title).size]
            for p in hand.app.layout.panels
        }  # fmt: skip

    hand.frames(2)
    before, pane = places(), hand.model.picture_size
    hand.key(imgui.Key.f9)
    hand.frames(3)
    found["larger"] = [*hand.model.picture_size, *pane]
    hand.key(imgui.Key.f9)
    hand.frames(3)
    found["as before"] = places() == before and hand.model.picture_size == pane
    hand.key(imgui.Key.p)
    hand.frames(2)
    found["haploscopic"] = hand.model.picture_size[1]
    hand.key(imgui.Key.escape)
    hand.frames(2)
    found["left"] = hand.model.picture_size == pane


def shows_the_pictures_themselves(hand, found):
    """Every mode, mirrored or not: below the captions, the pane is the frames' own pixels."""
    import dataclasses

    model = hand.model
    before = model.state
    hand.ctx.mouse_teleport_to_pos((5.0, 5.0))  # the engine draws the mouse
    eye = dataclasses.replace(
        before.setup.eye, azimuth_deg=20.0, elevation_deg=12.0, shift_right=0.02
    )
    model.change(before.placed(eye=eye))
    model.set_look("test", sigma_n_deg=1.0)
    model.set_part("display", background_lstar=37.0)

    def pane():
        screen = hand.app._window._screen._framebuffer
        data = np.frombuffer(screen.read(components=3), dtype=np.uint8)
        pixels = data.reshape(screen.height, screen.width, 3)[::-1]
        left, top = (int(v) for v in hand.app.stage_origin)
        width = max(r[0] + r[2] for r in hand.app.drawn_pane.arrangement.rects.values())
        height = next(iter(hand.app.drawn_pane.arrangement.rects.values()))[3]
        return pixels[top : top + height, left : left + width].copy()

    def expected(mirror):
        arrangement = hand.app.drawn_pane.arrangement
        frames = {s: f.display for s, f in model.frames.items()}
        if mirror:
            frames = {s: d[:, ::-1] for s, d in frames.items()}
        width = max(r[0] + r[2] for r in arrangement.rects.values())
        wanted = np.full((arrangement.size[1], width, 3), frames["test"][0, 0], dtype=np.uint8)
        for side, (left, _, wide, _) in arrangement.rects.items():
            wanted[:, left : left + wide] = frames[side]
        if model.state.presentation.compare == "wipe":
            share = model.state.presentation.wipe
            edge = int((1 - share if mirror else share) * width)
            first, second = ("test", "reference") if mirror else ("reference", "test")
            wanted[:, :edge], wanted[:, edge:] = frames[first][:, :edge], frames[second][:, edge:]
        return wanted

    for mode in ("side by side", "wipe", "flip"):
        for mirror in (False, True):
            model.set_part("presentation", compare=mode, mirror=mirror, wipe=0.4)
            hand.frames(3)
            got, wanted = hand.do(lambda mirror=mirror: (pane(), expected(mirror)))
            low = slice(got.shape[0] // 3, None)  # below the captions
            off = np.any(got[low] != wanted[low], axis=-1)
            found[f"{mode} {mirror}"] = [int(np.sum(np.any(off, axis=0))), float(np.std(wanted))]
    from PIL import Image

    model.set_part("presentation", compare="wipe", mirror=True)
    hand.frames(3)
    hand.app.files._write_view(str(hand.folder / "view.png"))
    hand.until(lambda: (hand.folder / "view.png").exists())
    view = np.asarray(Image.open(hand.folder / "view.png"))
    found["view"] = bool(np.array_equal(view, hand.do(lambda: expected(True))))
    model.set_part("presentation", compare="difference", mirror=False)
    model.change(dataclasses.replace(model.state, test=model.state.reference))
    hand.frames(3)
    got, seen = hand.do(lambda: (pane(), model.frames["test"].on_object))
    found["no difference"] = int(np.max(got[200:][seen[200:]]))
    model.change(before)


def survives_lost_objects(hand, found):
    import glfw

    def displays():
        return {side: frame.display.copy() for side, frame in hand.model.frames.items()}

    def destroy():
        pointer = ctypes.cast(glfw.get_proc_address("glDeleteTextures"), ctypes.c_void_p).value
        delete = ctypes.CFUNCTYPE(None, ctypes.c_int, ctypes.POINTER(ctypes.c_uint))(pointer)
        for renderer in hand.app.pair_renderer._full.values():
            for name in renderer.passes.targets.held():
                delete(1, ctypes.byref(ctypes.c_uint(renderer.texture(name).glo)))

    hand.frames(4)
    before = hand.do(displays)
    pictures = hand.app.pair_renderer
    hand.do(destroy)
    hand.until(lambda: hand.app.pair_renderer is not pictures, 5)
    found["rebuilt"] = hand.app.pair_renderer is not pictures
    hand.frames(1)
    after = hand.do(displays)
    found["identical"] = all(np.array_equal(before[s], after[s]) for s in before)
    found["bright"] = int(max(np.max(d) for d in after.values()))
    found["error"] = hand.do(lambda: hand.app.pair_renderer.ctx.error)
    found["said"] = hand.said()[-1][0]


def draws_smaller_while_too_slow(hand, found):
    from relgloss_view.viewer.drawing import draft_scale

    hand.until(lambda: not hand.model.dragging)
    hand.frames(3)
    full = hand.model.picture_size
    before = hand.do(lambda: {s: f.display.copy() for s, f in hand.model.frames.items()})
    budget, draft_scale.BUDGET_S = draft_scale.BUDGET_S, 1e-9  # no machine keeps that
    try:
        place = middle(hand)
        hand.ctx.mouse_move_to_pos(place)
        hand.ctx.mouse_down(0)
        for k in range(1, 25):
            hand.ctx.mouse_move_to_pos((place[0] + 2 * (k % 5), place[1]))
            hand.frames(1)
        found["draft"] = [hand.model.draft, *hand.model.frames["test"].size, *full]
        hand.ctx.mouse_move_to_pos(place)
        hand.ctx.mouse_up(0)
        hand.frames(3)
    finally:
        draft_scale.BUDGET_S = budget
    found["full again"] = [hand.model.draft, *hand.model.frames["test"].size]
    hand.model.history.undo()
    hand.frames(2)
    after = hand.do(lambda: {s: f.display for s, f in hand.model.frames.items()})
    found["identical"] = all(np.array_equal(before[s], after[s]) for s in before)


def pins_a_pixel(hand, found):
    from imgui_bundle import imgui

    place = middle(hand)
    eye = hand.model.state.setup.eye
    hand.ctx.key_down(int(imgui.Key.mod_alt))
    hand.ctx.mouse_move_to_pos(place)
    hand.ctx.mouse_click(0)
    hand.ctx.key_up(int(imgui.Key.mod_alt))
    hand.frames(2)
    found["pinned"] = [*hand.model.pinned]
    found["size"] = [*hand.model.picture_size]
    found["still"] = hand.model.state.setup.eye == eye
    hand.model.pinned = None


def takes_every_size(hand, found):
    import glfw
    from imgui_bundle import hello_imgui

    window = ctypes.cast(hello_imgui.get_glfw_window_address(), ctypes.POINTER(glfw._GLFWwindow))
    for size in ((1, 1), (0, 0), (300, 40), (40, 300), (3000, 200), SIZE):
        hand.do(lambda size=size: glfw.set_window_size(window, *size))
        hand.frames(3)
        found[f"{size[0]}x{size[1]}"] = [*hand.model.picture_size]
    hand.do(lambda: glfw.iconify_window(window))
    hand.frames(3)
    hand.do(lambda: glfw.restore_window(window))
    hand.frames(3)
    found["error"] = hand.do(lambda: hand.app.pair_renderer.ctx.error)


SCRIPTS = [
    starts_full_and_then_rests,
    tunes_the_look,
    chooses_the_quality,
    tunes_the_scene,
    takes_back_and_does_again,
    turns_moves_and_zooms,
    draws_only_what_changed,
    draws_no_more_than_needed,
    compares,
    hides_panels_and_brings_them_back,
    shows_the_pictures_themselves,
    survives_lost_objects,
    draws_smaller_while_too_slow,
    pins_a_pixel,
    takes_every_size,
]


# --- the other side -------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    return driven.drive("test_window", tmp_path_factory.mktemp("window"), size=SIZE, panels=True)


def test_nothing_is_drawn_at_rest(found):
    got = found["starts_full_and_then_rests"]
    assert got == {"frames": ["reference", "test"], "drawn at rest": {}, "compiled at rest": 0}


def test_sliders_type_reset_and_stay_in_range(found):
    got = found["tunes_the_look"]
    assert got["typed"] == pytest.approx(1.25)
    assert got["beyond"] == pytest.approx(7.5)
    assert got["held"] == pytest.approx(10.0)
    assert got["reset"] == 0.0
    assert got["share"] == pytest.approx(0.5)
    assert got["c"] == [pytest.approx(1.5), None]
    assert got["scaled"][0] < 1.0  # and nothing clips
    assert got["scaled"][1] == 0
    assert len(got["warned"]) == 2  # above 1 and above c_max
    assert got["matched"] == pytest.approx(1.0)
    assert got["reference"] == pytest.approx(0.5)
    assert got["steps"] == 7  # reset, share, c, clip and back, match, the reference's share


def test_quality_is_one_click_away(found):
    got = found["chooses_the_quality"]
    assert got["first"][0] == got["auto"][0] == "auto"
    assert got["auto"][1] in ("auto: drawn simpler", "auto: whole model")
    assert got["exact"] == ["exact", "exact"]
    assert got["by key"] == got["auto"]


def test_every_slider_of_the_scene_sets_its_entry(found):
    got = dict(found["tunes_the_scene"])
    assert {kind: got.pop(kind) for kind in SHAPES} == {
        "cylinder": ["cylinder", "diameter_m", "height_m"],
        "sphere": ["sphere", "diameter_m"],
        "plane": ["plane", "height_m", "width_m"],
        "box": ["box", "height_m", "width_m", "depth_m"],
    }
    assert got.pop("lamp.radius_m") == 10.0  # the ends of their ranges
    assert got.pop("lamp.ambient") == 1.0
    assert len(got) == 12
    assert set(got.values()) == {12.5}


def test_undo_and_redo(found):
    assert found["takes_back_and_does_again"] == {"undone": True, "redone": True, "by menu": True}


def test_a_frame_that_takes_the_last_movement_and_the_release_loses_nothing(found):
    got = found["turns_moves_and_zooms"]
    assert got["at once True"] == pytest.approx(got["at once False"])
    assert min(map(abs, got["at once False"])) > 0.0


def test_the_hand_on_the_pictures(found):
    got = found["turns_moves_and_zooms"]
    per_pixel = 180.0 / got["width"]
    assert got["turned"] == [pytest.approx(-60 * per_pixel), pytest.approx(24 * per_pixel)]
    assert got["moved"] > 0.0
    assert got["steps"] == 2  # one for each drag
    side, kept, shift_up = got["locked"]
    assert side == "test"
    assert kept
    assert shift_up == pytest.approx(0.0, abs=1e-9)  # so the hand on the left was felt
    assert 1.0 < got["zoomed"] < 15.0
    assert got["lamp"] == pytest.approx(40 * per_pixel)
    assert got["reset"] == [0.0, None]


def test_only_what_changed_is_drawn(found):
    got = found["draws_only_what_changed"]
    assert got["c"] == {"test tone": 1, "test edges": 1}
    # The field of the grain's tilts is drawn where it is first needed, and never again.
    assert got["sigma_n"].pop("test grain", 1) == 1
    for name in ("sigma_n", "no sigma_n", "sigma_n again"):
        passes = ("shade", "split", "tone", "edges")  # the silhouette is where it was
        assert got[name] == {f"test {name}": 1 for name in passes}, name
    passes = ("edges", "shade", "split", "tone", "white")
    assert got["lamp"] == [f"{side} {name}" for side in ("reference", "test") for name in passes]
    assert got["compiled"] == 0


def test_quality_auto_is_held_while_something_moves(found):
    got = found["draws_no_more_than_needed"]
    assert got["auto"]["reference"] == {}  # each side has its own quality
    assert got["auto"]["test"] != {}
    # As it was until it no longer serves, then exact: one change at most, and nothing compiled.
    moved = got["moved"]
    assert moved[0] == got["auto"]["test"]
    assert sum(a != b for a, b in itertools.pairwise(moved)) <= 1
    assert moved[-1] in ({}, moved[0])
    assert got["compiled in the drag"] == 0
    assert got["rested"] != {}


def test_compare_modes(found):
    got = found["compares"]
    both = ["reference", "test"]
    assert got["side by side"] == ["side by side", both]
    assert got["wipe"] != 0.5
    assert got["flip"] == ["flip", ["reference"]]
    assert got["difference"] == ["difference", ["test"]]
    assert (got["flipped"], got["back"]) == (["test"], ["reference"])
    assert set(got["overlays"]) == set(constants.OVERLAYS)
    assert got["none"] == "none"


def test_panels_come_back_as_they_were(found):
    got = found["hides_panels_and_brings_them_back"]
    width, height, before_width, before_height = got["larger"]
    assert width > before_width
    assert height > before_height
    assert got["as before"]
    assert got["haploscopic"] == SIZE[1]
    assert got["left"]


@pytest.mark.parametrize("mode", ["side by side", "wipe", "flip"])
@pytest.mark.parametrize("mirror", [False, True])
def test_the_pane_is_the_pictures_pixel_by_pixel(found, mode, mirror):
    columns_off, contrast = found["shows_the_pictures_themselves"][f"{mode} {mirror}"]
    # The wipe's edge is a line, smoothed over three columns; nothing else differs.
    assert columns_off <= (3 if mode == "wipe" else 0)
    assert contrast > 20.0


def test_the_view_is_written_without_the_interface(found):
    assert found["shows_the_pictures_themselves"]["view"]


def test_equal_sides_have_no_difference(found):
    assert found["shows_the_pictures_themselves"]["no difference"] == 0


def test_lost_objects_are_made_again(found):
    got = found["survives_lost_objects"]
    assert got["rebuilt"]
    assert got["identical"]
    assert got["bright"] > 100
    assert got["error"] == "GL_NO_ERROR"
    assert "made again" in got["said"]


def test_pictures_are_smaller_while_a_drag_is_too_slow(found):
    got = found["draws_smaller_while_too_slow"]
    draft, width, height, full_width, full_height = got["draft"]
    assert draft
    assert width <= 0.3 * full_width
    assert height <= 0.3 * full_height
    assert got["full again"] == [False, full_width, full_height]
    assert got["identical"]


def test_a_pixel_is_pinned(found):
    got = found["pins_a_pixel"]
    side, column, row = got["pinned"]
    assert side == "test"
    assert [2 * column, 2 * row] == pytest.approx(got["size"], abs=3)
    assert got["still"]


def test_every_size_of_the_window(found):
    got = found["takes_every_size"]
    assert got["error"] == "GL_NO_ERROR"
    assert got["3000x200"][0] > got["300x40"][0]
    assert got[f"{SIZE[0]}x{SIZE[1]}"][0] > 100
