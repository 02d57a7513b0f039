"""The status line: what was drawn, on what, how fast, and what was said last."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

from imgui_bundle import ImVec2, imgui

from relgloss_view.picture.output.parameters import warnings
from relgloss_view.viewer.shell.theme import POPUP, em, gray
from relgloss_view.viewer.shell.widgets import tooltip

if TYPE_CHECKING:
    from relgloss_view.viewer.shell.app import App

NOTE_S = 12.0  #: that a message stays in the line; it stays in the list behind it
LINE_EM = 1.75
NUMBERS_SHARE = 0.6  #: of the line's width


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
        "##status",
        None,
        flags.no_decoration | flags.no_docking | flags.no_move | flags.no_saved_settings
        | flags.no_bring_to_front_on_focus | flags.no_nav,
    )  # fmt: skip
    imgui.pop_style_color()
    imgui.pop_style_var(2)
    numbers = _numbers(app, NUMBERS_SHARE * imgui.get_content_region_avail().x)
    _message(app, imgui.get_content_region_avail().x - imgui.calc_text_size(numbers).x - em(1.5))
    imgui.same_line(max(imgui.get_window_width() - imgui.calc_text_size(numbers).x - em(0.6), 0.0))
    imgui.text_disabled(numbers)
    tooltip(_details(app))
    imgui.end()


def _message(app: App, width: float) -> None:
    model = app.model
    note = model.notes[-1] if model.notes else None
    if note is not None and time.monotonic() - note.at_s < NOTE_S:
        text = f"! {note.text}" if note.fault else note.text
    else:
        text = _warning(app) or "h: keys   drag: turn   wheel: zoom   Ctrl+drag: lamp"
    while text and imgui.calc_text_size(text).x > width:
        text = text[: int(0.92 * len(text)) - 1].rstrip() + "…" if len(text) > 4 else ""
    imgui.text_unformatted(text)
    said = "\n".join(n.text for n in model.notes[-8:])
    tooltip(f"{_warning(app)}\n{said}".strip() or "Nothing was said yet.")


def _warning(app: App) -> str:
    """The first warning of the active picture."""
    side = app.model.active_side
    frame = app.model.frames.get(side)
    told = () if frame is None else warnings(frame, app.model.displayed(side))
    if not told:
        return ""
    more = len(told) - 1
    return told[0] + (f" (and {more} more)" if more else "")


def _numbers(app: App, width: float) -> str:
    """What fits into a width, the most important first from the right."""
    model = app.model
    frame = model.frames.get(model.active_side)
    parts = [f"{1e3 * model.frame_s:.0f} ms"]
    if frame is not None:
        wide, tall = frame.size
        parts.append("c_max none" if frame.c_max is None else f"c_max {frame.c_max:.3g}")
        picture = model.displayed(model.active_side) or frame
        parts.append(f"{picture.clip_count} clipped")
        parts.append(f"{wide}x{tall}" + (" draft" if model.draft else ""))
        parts.append(f"drew {_in_short(model.redrawn)}")
        parts.append(frame.device.split("(")[0].strip())
    line = ""
    for part in parts:
        longer = f"{part}   {line}".rstrip()
        if line and imgui.calc_text_size(longer).x > width:
            break
        line = longer
    return line


def _in_short(redrawn: list[str]) -> str:
    """Passes by name, a side before them only where the other side drew something else."""
    passes: dict[str, list[str]] = {}
    for entry in redrawn:
        side, name = entry.split(" ", 1)
        passes.setdefault(name, []).append(side)
    words = [name if len(sides) > 1 else f"{sides[0]} {name}" for name, sides in passes.items()]
    return ", ".join(words) or "nothing"


def _details(app: App) -> str:
    model = app.model
    frame = model.frames.get(model.active_side)
    lines = ["Last frame drew: " + (", ".join(model.redrawn) or "nothing new") + "."]
    if frame is not None:
        eq4 = frame.scaling.c_max_eq4
        shown = model.displayed(model.active_side)
        picture = shown or frame
        lines += [
            f"Device: {frame.device}.",
            f"Active side: {model.active_side}, {frame.size[0]} x {frame.size[1]} px.",
            f"c {frame.c:.6g}, c_max {frame.c_max}, by eq. 4 {eq4}.",
            f"{picture.clip_count} pixels above white, {picture.out_of_gamut_count} out of gamut"
            + (f", by {shown.operator}." if shown else "."),
            *warnings(frame, shown),
        ]
    return "\n".join(lines)
