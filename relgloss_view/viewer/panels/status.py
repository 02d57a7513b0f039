"""The status line: the last message, and how the picture was drawn: quality, size, device, time."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

from imgui_bundle import ImVec2, imgui

from relgloss_view.picture.output.parameters import warnings
from relgloss_view.viewer.panels.drawing_words import drawing_words, quality_words
from relgloss_view.viewer.shell.actions import TURN_LAMP
from relgloss_view.viewer.shell.layout import STATUS
from relgloss_view.viewer.shell.theme import POPUP, em, gray
from relgloss_view.viewer.shell.widgets import sentence, tooltip
from relgloss_view.viewer.state.screens import screen_words, takes

if TYPE_CHECKING:
    from relgloss_view.viewer.shell.app import App

NOTE_S = 12.0  #: for which a message shows; the tooltip lists the last ones
#: The first of them show that find room.
HINTS = (
    "Help > First steps",
    "H: all keys",
    "drag: turn",
    "wheel: zoom",
    "Ctrl+drag: move the lamp",
)
#: In one wording or another, the longest that finds room.
CROWDED = (
    "Enlarge the window, or choose a smaller text size (View), to see the panels",
    "Enlarge the window to see the panels",
    "Too small for panels",
)
LINE_EM = 1.75
NUMBERS_SHARE = 0.6  #: of the line's width
SCREEN_SHARE = 0.6  #: of that, for the display in whole words


def height() -> float:
    """Of the line, in pixels."""
    return em(LINE_EM)


def show(app: App) -> None:
    """Draw the line along the lower edge of the window."""
    viewport = imgui.get_main_viewport()
    imgui.set_next_window_pos(ImVec2(viewport.pos.x, viewport.pos.y + viewport.size.y - height()))
    imgui.set_next_window_size(ImVec2(viewport.size.x, height()))
    imgui.push_style_var(imgui.StyleVar_.window_padding, ImVec2(em(0.6), em(0.3)))
    imgui.push_style_var(imgui.StyleVar_.window_min_size, ImVec2(1.0, 1.0))
    imgui.push_style_color(imgui.Col_.window_bg, gray(POPUP))
    flags = imgui.WindowFlags_
    imgui.begin(
        STATUS,
        None,
        flags.no_decoration | flags.no_docking | flags.no_move | flags.no_saved_settings
        | flags.no_bring_to_front_on_focus | flags.no_nav | flags.no_focus_on_appearing,
    )  # fmt: skip
    imgui.pop_style_color()
    imgui.pop_style_var(2)
    numbers = _numbers(app, NUMBERS_SHARE * imgui.get_content_region_avail().x)
    room = imgui.get_content_region_avail().x - imgui.calc_text_size(numbers).x - em(1.5)
    _message(app, room - _step(app))
    imgui.same_line(max(imgui.get_window_width() - imgui.calc_text_size(numbers).x - em(0.6), 0.0))
    imgui.text_disabled(numbers)
    tooltip(_details(app))
    imgui.end()


def _step(app: App) -> float:
    """A button that mends a picture without gloss; returns the width that it takes."""
    if not _lacks_gloss(app):
        return 0.0
    imgui.push_style_var(imgui.StyleVar_.frame_padding, ImVec2(em(0.5), 0.0))
    before = imgui.get_cursor_pos_x()
    if imgui.button(TURN_LAMP):
        app.model.turn_lamp()
    imgui.pop_style_var()
    tooltip("No gloss is visible in this view. Key: G.")
    imgui.same_line()
    return float(imgui.get_cursor_pos_x() - before)


def _lacks_gloss(app: App) -> bool:
    """Whether the active picture shows none of its sample's gloss, while nothing is dragged.

    The button itself is pressed and held too; it must not go away under the hand.
    """
    model = app.model
    frame = model.frames.get(model.active_side)
    pressed = imgui.internal.get_active_id() == imgui.get_id(TURN_LAMP)
    return frame is not None and (pressed or not model.dragging) and frame.lacks_gloss


def _message(app: App, width: float) -> None:
    model = app.model
    note = model.notes[-1] if model.notes else None
    if note is not None and time.monotonic() - note.at_s < NOTE_S:
        text = f"! {note.text}" if note.fault else note.text
    else:
        text = _warning(app) or _crowded(app, width) or _hint(width)
    while text and imgui.calc_text_size(text).x > width:
        text = text[: int(0.92 * len(text)) - 1].rstrip() + "…" if len(text) > 4 else ""
    imgui.text_unformatted(text)
    messages = "\n".join(n.text for n in model.notes[-8:])
    tooltip(f"{_warning(app)}\n{messages}".strip() or "No messages yet.")


def _crowded(app: App, width: float) -> str:
    """Why panels don't show, where the window is too small for them."""
    if not app.layout.crowded:
        return ""
    return next((t for t in CROWDED if imgui.calc_text_size(t).x <= width), CROWDED[-1])


def _hint(width: float) -> str:
    """As many of HINTS as a width in pixels holds."""
    line = ""
    for hint in HINTS:
        longer = f"{line}   {hint}".lstrip()
        if imgui.calc_text_size(longer).x > width:
            break
        line = longer
    return line


def _warning(app: App) -> str:
    """The first warning of the active picture."""
    side = app.model.active_side
    frame = app.model.frames.get(side)
    if frame is None or app.model.dragging:  # they are worked out at rest
        return ""
    texts = warnings(frame, app.model.displayed(side))
    if not texts:
        return ""
    more = len(texts) - 1
    return texts[0] + (f" (and {more} more)" if more else "")


def _numbers(app: App, width: float) -> str:
    """As much as fits into a width, the most important first from the right."""
    model = app.model
    frame = model.frames.get(model.active_side)
    whole, brief = screen_words(model.state, model.screen)
    roomy = imgui.calc_text_size(whole).x < SCREEN_SHARE * width
    parts = [f"{1e3 * model.frame_s:.0f} ms a frame", whole if roomy else brief]
    if frame is not None:
        wide, tall = frame.size
        picture = model.displayed(model.active_side) or frame
        parts.append(quality_words(frame))
        parts.append(f"{picture.clip_count} pixels clipped")
        parts.append(f"{wide} x {tall} px" + (", draft" if model.draft else ""))
        parts.append(frame.device.split("(")[0].strip())
    line = ""
    for part in parts:
        longer = f"{part}   {line}".rstrip()
        if line and imgui.calc_text_size(longer).x > width:
            break
        line = longer
    return line


def _details(app: App) -> str:
    model = app.model
    passes = ", ".join(f"{side} {name}" for side, name in model.redrawn)
    lines = [f"Drawn for {screen_words(model.state, model.screen)[0]}."]
    lines += [sentence(model.screen.reason)] if model.screen.fault else []
    lines += list(model.screen.notes) if takes(model.state, model.screen) else []
    lines += [f"Passes drawn last: {passes or 'none'}."]
    frame = model.frames.get(model.active_side)
    if frame is not None:
        displayed = model.displayed(model.active_side)
        picture = displayed or frame
        mapping = f"; tone mapping: {displayed.operator}" if displayed else ""
        lines += [
            f"Device: {frame.device}.",
            f"Active side: {model.active_side}, {frame.size[0]} x {frame.size[1]} px.",
            f"Quality {frame.look.quality}. {drawing_words(frame.method)}.",
            f"Contrast gloss (c) {frame.c:.6g}, highest (c_max) {_plain(frame.c_max)}, by eq. 4 "
            f"{_plain(frame.scaling.c_max_eq4)}.",
            f"{picture.clip_count} pixels above white, {picture.out_of_gamut_count} out of gamut"
            f"{mapping}.",
            *(() if model.dragging else warnings(frame, displayed)),
        ]
    return "\n".join(lines)


def _plain(value: float | None) -> str:
    return "none" if value is None else f"{value:.6g}"
