"""The stage: where the two pictures go, and the hand on them."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from dataclasses import dataclass

from imgui_bundle import ImVec2, imgui

from relgloss_view.picture.model.view import Size
from relgloss_view.viewer.drawing import camera
from relgloss_view.viewer.drawing.arrangement import Arrangement, Rect, as_shown
from relgloss_view.viewer.drawing.canvas import Canvas, canvas_of
from relgloss_view.viewer.drawing.pair_renderer import DrawnPair
from relgloss_view.viewer.panels import (
    artwork_hand,
    captions,
    drop_hand,
    ghost_outlines,
    mask_tints,
)
from relgloss_view.viewer.shell import sliders
from relgloss_view.viewer.shell.theme import em, gray
from relgloss_view.viewer.state.model import Model, Pixel
from relgloss_view.viewer.state.state import WIPE, State

ARROW_DEG = 2.0  #: that a press of an arrow turns
HANDLE_EM = 0.8  #: width of what takes hold of the wipe's edge


@dataclass(frozen=True)
class DrawnPane:
    """The pictures that were drawn for a pane, and where they are in it."""

    arrangement: Arrangement
    pair: DrawnPair


def show(
    model: Model,
    draw: Callable[[Size], DrawnPane | None],
    drop: Callable[[str], None] = lambda side: None,
) -> Canvas:
    """Show the pictures and take the hand on them; `draw` makes them for a size in pixels.

    drop: called with the side on whose picture a sample was dropped.
    Returns the canvas to paint below the interface, in pixels of the window.
    """
    origin = imgui.get_cursor_screen_pos()
    room = imgui.get_content_region_avail()
    pane = (int(room.x), int(room.y))
    model.pointer = None
    drawn = draw(pane)
    if drawn is None:
        return Canvas()
    painter = imgui.get_window_draw_list()
    presentation = model.state.presentation
    wiping = presentation.compare == WIPE and not presentation.haploscopic
    share = 1.0 - presentation.wipe if presentation.mirror else presentation.wipe
    edge = int(share * pane[0]) if wiping else None
    canvas = canvas_of(pane, presentation, drawn.arrangement, drawn.pair.pictures, edge)
    if edge is not None:
        _line(painter, origin, edge, pane[1])
    _take_hand(model, origin, pane, drawn, edge, drop)
    if not presentation.haploscopic:
        mask_tints.show(model, painter, origin, drawn.arrangement)
        ghost_outlines.show(model, painter, origin, drawn.arrangement)
        captions.show(model, painter, origin, drawn.arrangement, drawn.pair.faults)
    return canvas.moved(int(origin.x), int(origin.y))


def _line(painter: imgui.ImDrawList, origin: ImVec2, x: int, height: int) -> None:
    colour = imgui.color_convert_float4_to_u32(gray(0.8))
    place = origin.x + x
    painter.add_line(ImVec2(place, origin.y), ImVec2(place, origin.y + height), colour, 1.0)


def _ring(origin: ImVec2, pane: Size) -> None:
    """The ring of the focus, within the pane: ImGui draws its own around it, unseen."""
    colour = imgui.get_color_u32(imgui.Col_.nav_cursor)
    low = ImVec2(origin.x + 1.0, origin.y + 1.0)
    high = ImVec2(origin.x + pane[0] - 1.0, origin.y + pane[1] - 1.0)
    imgui.get_window_draw_list().add_rect(low, high, colour, thickness=2.0)


def _take_hand(
    model: Model,
    origin: ImVec2,
    pane: Size,
    drawn: DrawnPane,
    edge: int | None,
    drop: Callable[[str], None],
) -> None:
    """Let the mouse turn, move and zoom the pictures, and place the lamp and the wipe."""
    if edge is not None:
        _wipe_handle(model, origin, pane, edge)
    imgui.set_cursor_screen_pos(origin)
    buttons = imgui.ButtonFlags_
    imgui.invisible_button(
        "stage",
        ImVec2(max(pane[0], 1), max(pane[1], 1)),
        buttons.mouse_button_left
        | buttons.mouse_button_right
        | buttons.mouse_button_middle
        | buttons.enable_nav,
    )
    mouse = imgui.get_mouse_pos()
    here = (mouse.x - origin.x, mouse.y - origin.y)
    under = _under(drawn, here, mirrored=model.state.presentation.mirror, edge=edge)
    drop_hand.take_drop(under, origin, drop)
    _take_keys(model, next(iter(drawn.arrangement.rects.values()))[2:])
    if imgui.is_item_focused() and imgui.get_io().nav_visible:
        _ring(origin, pane)
    hovered, active = imgui.is_item_hovered(), imgui.is_item_active()
    if hovered and model.state.presentation.haploscopic and imgui.is_mouse_clicked(1):
        model.set_part("presentation", haploscopic=False)  # no menu is there to do it
        return
    if hovered and under is not None:
        side, at, rect = under
        size_px = drawn.pair.pictures[side].size
        column, row = int(at[0] * size_px[0] / rect[2]), int(at[1] * size_px[1] / rect[3])
        if not model.dragging:
            model.pointer = Pixel(side, column, row)
        # A hand on a picture never chooses its side: the reference is not tuned by accident.
        if imgui.is_mouse_clicked(imgui.MouseButton_.left) and imgui.get_io().key_alt:
            model.pinned = Pixel(side, column, row)
        if not artwork_hand.take_wheel(model, side, at, rect[2:]):
            _zoom(model, imgui.get_io().mouse_wheel, at, rect[2:])
        if imgui.is_mouse_double_clicked(imgui.MouseButton_.left):
            state = model.state.with_part("presentation", life_size=False)
            model.change(state.placed(eye=camera.framed(state.setup.eye)))
            return
    if artwork_hand.take_press(model, under, active=active):
        return
    # On the frame of the press the mouse may have come from far away; a slow frame takes the last
    # movement and the release together.
    if (active and not imgui.is_item_activated()) or imgui.is_item_deactivated():
        size = next(iter(drawn.arrangement.rects.values()))[2:]
        _drag(model, size)


def _zoom(model: Model, notches: float, at: tuple[float, float], size: Size) -> None:
    """Zoom by turns of the wheel towards a place of the picture."""
    if notches == 0.0:
        return
    eye = camera.zoomed(_state_on_screen(model, size).scene(model.active_side), notches, at, size)
    state = model.state.with_part("presentation", life_size=False)
    model.change(state.placed(eye=eye), gesture="zoom")
    model.hold()


def _drag(model: Model, size: Size) -> None:
    io = imgui.get_io()
    delta = io.mouse_delta
    if delta.x == 0.0 and delta.y == 0.0:
        return
    if model.state.presentation.mirror:
        delta = ImVec2(-delta.x, delta.y)
    moved = (delta.x, delta.y)
    button = imgui.MouseButton_.left
    left = imgui.is_mouse_down(button) or imgui.is_mouse_released(button)
    lamp = left and io.key_ctrl
    pan = not lamp and (not left or io.key_shift)
    if lamp or not io.key_alt:
        _move(model, moved, size, lamp=lamp, pan=pan)


def _move(model: Model, moved: tuple[float, float], size: Size, *, lamp: bool, pan: bool) -> None:
    """Move the lamp, the picture or else the object by so many pixels, right and down."""
    state = model.state
    if lamp:
        turned = camera.turned(state.setup.lamp, moved, size)
        model.change(state.placed(lamp=turned), gesture="lamp in the picture")
    elif not pan:
        eye = camera.orbited(state.setup.eye, moved, size)
        model.change(state.placed(eye=eye), gesture="orbit")
    else:
        on_screen = _state_on_screen(model, size)
        eye = camera.panned(on_screen.scene(model.active_side), moved, size)
        if state.presentation.life_size:  # its angle is the monitor's, not the eye's
            angle_deg = state.setup.eye.field_of_view_deg
            eye = dataclasses.replace(eye, field_of_view_deg=angle_deg)
        model.change(state.placed(eye=eye), gesture="pan")


def _take_keys(model: Model, size: Size) -> None:
    """Let arrows, plus and minus do what drags and the wheel do, where pictures have the focus."""
    across, up = sliders.arrows()
    if (across or up) and artwork_hand.take_arrows(model, across, up):
        sliders.note_moved()
        return
    if model.state.presentation.mirror:
        across = -across
    if across or up:
        step = ARROW_DEG / camera.DEGREES_ACROSS * size[0]
        io = imgui.get_io()
        _move(model, (step * across, -step * up), size, lamp=io.key_ctrl, pan=io.key_shift)
        sliders.note_moved()
    if imgui.is_item_focused() and not imgui.is_any_item_active():
        key, centre = imgui.Key, (0.5 * size[0], 0.5 * size[1])
        plus = any(imgui.is_key_pressed(k) for k in (key.equal, key.keypad_add))
        minus = any(imgui.is_key_pressed(k) for k in (key.minus, key.keypad_subtract))
        _zoom(model, float(plus) - float(minus), centre, size)


def _state_on_screen(model: Model, size: Size) -> State:
    """The state with the eye that the pictures on the screen have."""
    return as_shown(model.state, size, model.pixel_pitch_m)


def _wipe_handle(model: Model, origin: ImVec2, pane: Size, edge: int) -> None:
    half = 0.5 * em(HANDLE_EM)
    imgui.set_cursor_screen_pos(ImVec2(origin.x + edge - half, origin.y))
    size = ImVec2(2.0 * half, max(pane[1], 1))
    imgui.invisible_button("wipe", size, imgui.ButtonFlags_.enable_nav)
    steps = sliders.arrow_steps() / sliders.STEPS
    if steps:
        steps = -steps if model.state.presentation.mirror else steps
        share = min(max(model.state.presentation.wipe + steps, 0.0), 1.0)
        model.set_part("presentation", gesture="wipe", wipe=share)
        sliders.note_moved()
    if imgui.is_item_hovered() or imgui.is_item_active():
        imgui.set_mouse_cursor(imgui.MouseCursor_.resize_ew)
    if imgui.is_item_active() and pane[0] > 0:
        share = (imgui.get_mouse_pos().x - origin.x) / pane[0]
        if model.state.presentation.mirror:
            share = 1.0 - share
        model.set_part("presentation", gesture="wipe", wipe=min(max(share, 0.0), 1.0))


def _under(
    drawn: DrawnPane, here: tuple[float, float], *, mirrored: bool, edge: int | None
) -> tuple[str, tuple[float, float], Rect] | None:
    """Side, place in its picture and rectangle of the picture under the mouse."""
    for side, rect in drawn.arrangement.rects.items():
        if edge is not None and ((here[0] < edge) == (side == "reference")) == mirrored:
            continue
        x, y = here[0] - rect[0], here[1] - rect[1]
        if side in drawn.pair.pictures and 0 <= x < rect[2] and 0 <= y < rect[3]:
            return side, (rect[2] - 1 - x if mirrored else x, y), rect
    return None
