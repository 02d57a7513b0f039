"""The hand on a pack: a click chooses the finish under it; drags, wheel and arrows move artwork."""

from __future__ import annotations

from dataclasses import dataclass

from imgui_bundle import imgui

from relgloss_view.base.errors import InputError
from relgloss_view.picture.model.view import Size
from relgloss_view.viewer.drawing import picking
from relgloss_view.viewer.drawing.arrangement import Rect, as_shown
from relgloss_view.viewer.panels.plot_widgets import Kept
from relgloss_view.viewer.state import packs
from relgloss_view.viewer.state.model import Model
from relgloss_view.viewer.state.packs import Mm
from relgloss_view.viewer.state.state import State

NUDGE_MM = 0.1  #: of a press of an arrow; Shift ten times as far
TURN_DEG = 1.0  #: of one notch of the wheel
SCALE_STEP = 1.02  #: with Ctrl
CLICK_PX = 4.0  #: a hand that has moved less has clicked

#: Side, place in its picture and rectangle of the picture under the mouse.
Under = tuple[str, tuple[float, float], Rect]


@dataclass
class _Press:
    """The button that is held: where it went down, and what it carries."""

    side: str = ""
    at: tuple[float, float] = (0.0, 0.0)
    size: Size = (1, 1)
    moved: bool = False
    carries: bool = False  #: whether it carries the artwork
    label_mm: Mm | None = None  #: the place on the label under the last pointer


_press = Kept(_Press)


def moves(model: Model, side: str) -> bool:
    """Whether a hand on a side's picture would move an artwork."""
    pack = model.pack(side)
    if pack is None or pack.artwork is None:
        return False
    return model.moving_artwork or imgui.get_io().key_alt


def take_press(model: Model, under: Under | None, *, active: bool) -> bool:
    """Carry the artwork with a held button, or choose a finish where it lets go.

    active: whether a button that went down on the pictures is held. Returns whether the hand is
    taken, so that nothing else moves.
    """
    press = _press.of(model)
    if press.side and not active:  # let go
        if imgui.is_item_deactivated():  # a slow frame takes the last movement with it
            _follow(model, press, under)
        if not press.moved and not imgui.get_io().key_alt:
            choose(model, press.side, press.at, press.size)
        carried, press.side, press.carries = press.carries, "", False
        return carried
    if active and imgui.is_item_activated():
        left = imgui.is_mouse_down(imgui.MouseButton_.left)
        press.side, press.moved, press.carries, press.label_mm = "", False, False, None
        if under is not None and left:
            press.side, press.at, press.size = under[0], under[1], under[2][2:]
            io = imgui.get_io()
            press.carries = moves(model, under[0]) and not io.key_ctrl and not io.key_shift
            if press.carries:
                press.label_mm = _label_place(model, press.side, press.at, press.size)
        return press.carries
    if not (active and press.side):
        return False
    _follow(model, press, under)
    return press.carries


def _follow(model: Model, press: _Press, under: Under | None) -> None:
    """Note how far the mouse has come from the press, and carry the artwork there."""
    if under is not None and under[0] == press.side:
        far = max(abs(a - b) for a, b in zip(under[1], press.at, strict=True))
        press.moved = press.moved or far > CLICK_PX
        if press.carries:
            _carry(model, press, under[1])
    else:
        press.moved = True


def choose(model: Model, side: str, at: tuple[float, float], size: Size) -> None:
    """Make the finish that lies at a place of a side's picture the active one."""
    if model.pack(side) is None:
        return
    try:
        picked = picking.pick(_on_screen(model, size).scene(side), size, at)
    except InputError as error:
        model.report_once(str(error), fault=True)
        return
    if picked is None:
        return
    model.choose_finish(side, picked.finish)
    if side == "test":
        model.active_side = side


def take_wheel(model: Model, side: str, at: tuple[float, float], size: Size) -> bool:
    """Turn the artwork, or scale it with Ctrl; returns whether the wheel was taken."""
    notches = imgui.get_io().mouse_wheel
    if notches == 0.0 or not moves(model, side):
        return False
    pack = model.pack(side)
    assert pack is not None
    about = _label_place(model, side, at, size)
    if imgui.get_io().key_ctrl:
        placement = packs.scaled(pack.placement, SCALE_STEP**notches, about)
    else:
        placement = packs.turned(pack.placement, TURN_DEG * notches, about)
    model.place_artwork(side, placement, gesture="artwork by the wheel")
    model.hold()
    return True


def take_arrows(model: Model, across: int, up: int) -> bool:
    """Nudge the artwork of the active side; returns whether the arrows were taken."""
    side = model.active_side
    pack = model.pack(side)
    if pack is None or pack.artwork is None or not model.moving_artwork:
        return False
    step = NUDGE_MM * (10.0 if imgui.get_io().key_shift else 1.0)
    try:
        girth = packs.girth_mm(pack.shape)
    except InputError:
        girth = None
    placement = packs.nudged(pack.placement, step * across, step * up, girth)
    model.place_artwork(side, placement, gesture="artwork by arrows")
    return True


def _carry(model: Model, press: _Press, at: tuple[float, float]) -> None:
    """Move the artwork so that what was under the pointer is under it again."""
    here = _label_place(model, press.side, at, press.size)
    before, press.label_mm = press.label_mm, here or press.label_mm
    pack = model.pack(press.side)
    if here is None or before is None or pack is None or here == before:
        return
    girth = packs.girth_mm(pack.shape)
    placement = packs.dragged(pack.placement, before, here, girth)
    model.place_artwork(press.side, placement, gesture="artwork by hand")


def _label_place(model: Model, side: str, at: tuple[float, float], size: Size) -> Mm | None:
    """The place on the printed part of the label under a place of a picture."""
    scene = _on_screen(model, size).scene(side)
    try:
        place = picking.label_place(scene, size, at)
    except InputError:
        return None
    return None if place is None else place[0]


def _on_screen(model: Model, size: Size) -> State:
    """The state with the eye that the pictures on the screen have."""
    return as_shown(model.state, size, model.pixel_pitch_m)
