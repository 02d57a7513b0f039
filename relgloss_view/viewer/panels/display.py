"""The display that pictures are shown for, what is known of it, and the surround."""

from __future__ import annotations

import os
from typing import Any

from imgui_bundle import imgui

from relgloss_view.base.reading import printable
from relgloss_view.display.display import Display
from relgloss_view.viewer.files.display_files import PROFILE, SEEN_ON, with_display
from relgloss_view.viewer.shell import widgets
from relgloss_view.viewer.shell.file_actions import FileActions
from relgloss_view.viewer.shell.theme import em
from relgloss_view.viewer.shell.widgets import Reach
from relgloss_view.viewer.state.model import Model
from relgloss_view.viewer.state.screens import black_of, luminance_of, name_of_other, screen_words
from relgloss_view.viewer.state.state import Presentation

LONGEST_NAME = 40  #: characters of a file
CLEAR_EM = 1.8  #: width of the button that takes a file away
#: Sliders by entry: of what is known of the display, of the surround, of the presentation.
OF_DISPLAY = {
    "luminance_cd_m2": Reach(20.0, 2000.0, digits="%.0f", logarithmic=True),
    "black_cd_m2": Reach(0.0, 5.0, digits="%.3f"),
    "reflected_cd_m2": Reach(0.0, 50.0, digits="%.1f"),
}
SURROUND = {
    "background_lstar": Reach(digits="%.0f"),
    "pixel_pitch_mm": Reach(0.05, 0.6, digits="%.3f"),
    "viewing_distance_m": Reach(0.2, 3.0, digits="%.2f", logarithmic=True),
}
PRESENTATION = {
    "gap_px": Reach(high=200.0, digits="%.0f"),
    "difference_max": Reach(high=50.0, digits="%.1f"),
}
EMPTY = {PROFILE: "none", **dict.fromkeys(SEEN_ON, "this display")}


def show(model: Model, files: FileActions) -> None:
    """Controls of the display, of what it is seen on, and of the surround."""
    changed, chosen = widgets.choice(Presentation, "screen", model.state.presentation.screen)
    if changed:
        model.set_part("presentation", screen=chosen)
    widgets.label("")
    widgets.wrapped(f"{screen_words(model.state, model.screen)[0]}.", dim=True)
    _file(model, files, Display, PROFILE, model.state.setup.display.profile)
    _light(model)
    presentation, choices = model.state.presentation, ["gamut", "edges", "dither"]
    for entry in SEEN_ON:
        _file(model, files, Presentation, entry, getattr(presentation, entry))
    if any(getattr(presentation, entry) for entry in SEEN_ON):
        choices.insert(0, "seen_white")
    _sliders(model, "display", Display, SURROUND)
    _sliders(model, "presentation", Presentation, PRESENTATION)
    for name in choices:
        changed, chosen = widgets.choice(Display, name, getattr(model.state.setup.display, name))
        if changed:
            model.set_part("display", **{name: chosen})


def _file(model: Model, files: FileActions, owner: type, entry: str, file: str) -> None:
    """A file of a display: a button with its name that asks for another, and one that clears it."""
    text = widgets.label_of(owner, entry)
    widgets.label(text)
    name = printable(os.path.basename(file), LONGEST_NAME) if file else EMPTY[entry]
    meaning = widgets.sentence(widgets.declared(owner, entry).metadata["meaning"])
    if file:
        meaning += f"\n{printable(file, 300)}: {name_of_other(file)}"
    gap = imgui.get_style().item_inner_spacing.x
    room = imgui.get_content_region_avail().x - (em(CLEAR_EM) + gap if file else 0.0)
    if widgets.button(f"{_fitting(name, room)}##{text}", meaning, width=room):
        files.ask_display(text, entry)
    if file:
        imgui.same_line(0.0, gap)
        if widgets.button(f"x##{text}", f"back to {EMPTY[entry]}", width=em(CLEAR_EM)):
            model.change(with_display(model.state, entry, ""))


def _light(model: Model) -> None:
    """White, black, and what the screen reflects: of the screen that pictures are drawn for."""
    display = model.on_screen.setup.display
    known, by = luminance_of(display)
    _optional(model, "luminance_cd_m2", known, by)
    black, by = black_of(display, display.luminance_cd_m2 or known)
    _optional(model, "black_cd_m2", black, by)
    _sliders(model, "display", Display, {"reflected_cd_m2": OF_DISPLAY["reflected_cd_m2"]})


def _optional(model: Model, name: str, known: float, by: str) -> None:
    """A number that the display may leave to its profile: reset, it does so again."""
    declared, reach = getattr(model.state.setup.display, name), OF_DISPLAY[name]
    value = known if declared is None else declared
    if declared is None:
        reach = Reach(reach.low, reach.high, f"{reach.digits} cd/m2, {by}", reach.logarithmic)
    changed, number = widgets.slider(
        Display, name, value, reach, default=known, unit=declared is not None
    )
    if changed:
        wanted = None if number == known else number
        entries: dict[str, Any] = {name: wanted}
        model.attempt(lambda: model.set_part("display", gesture=f"display {name}", **entries))


def _sliders(model: Model, part: str, owner: type, sliders: dict[str, Reach]) -> None:
    for name, reach in sliders.items():
        value = getattr(model.state.part(part), name)
        changed, number = widgets.slider(owner, name, value, reach)
        if changed:
            entries: dict[str, Any] = {name: number}
            model.set_part(part, gesture=f"{part} {name}", **entries)


def _fitting(name: str, room: float) -> str:
    """A name that fits a button, shortened from its end."""
    padding = 2.0 * imgui.get_style().frame_padding.x
    while len(name) > 4 and imgui.calc_text_size(name).x + padding > room:
        name = name[:-2].rstrip("…") + "…"
    return name
