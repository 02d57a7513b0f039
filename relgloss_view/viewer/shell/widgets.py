"""Controls made from declared parameters: label, range, unit, default and meaning of their fields.

The keyboard moves them as the mouse does (see sliders.py); a tooltip explains them. Each returns
whether the user changed it, and the value. The id of a control is its label with `##` before it.
"""

from __future__ import annotations

import contextlib
import dataclasses
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from imgui_bundle import ImVec2, imgui

from relgloss_view.base.parameters import Range
from relgloss_view.base.words import sentence_case
from relgloss_view.viewer.shell import sliders
from relgloss_view.viewer.shell.sliders import HOW
from relgloss_view.viewer.shell.theme import em, gray

LABEL_EM = 11.6  #: width of the column of labels
TOOLTIP_EM, TOOLTIP_GAP_EM = 26.0, 0.4  #: width of its words at most; from the item to it
WIDEST_RANGE = 1e6  #: a wider one is no help
CONTROL_EM = 7.0  #: a panel without this much room beside its labels has them above the controls
_label_em = LABEL_EM


def declared(owner: type, name: str) -> dataclasses.Field[Any]:
    """The field of a dataclass that declares a parameter."""
    return next(f for f in dataclasses.fields(owner) if f.name == name)


def tooltip(text: str, *, beside: bool = False) -> None:
    """Explain the item before this call, after the mouse has rested on it, or the focus.

    The words stand below the item, or above it where there is no room, and not while a hand moves
    it. beside: to the left or right of its window instead, for the rows of a list.
    """
    flags = imgui.HoveredFlags_
    if imgui.is_item_active() or not imgui.is_item_hovered(flags.for_tooltip | flags.delay_normal):
        return
    words = imgui.calc_text_size(text, wrap_width=em(TOOLTIP_EM))
    padding = imgui.get_style().window_padding
    size = ImVec2(words.x + 2.0 * padding.x, words.y + 2.0 * padding.y)
    imgui.set_next_window_pos(_tooltip_place(size, beside=beside))
    if imgui.begin_tooltip():
        imgui.push_text_wrap_pos(padding.x + em(TOOLTIP_EM))
        imgui.text_unformatted(text)
        imgui.pop_text_wrap_pos()
        imgui.end_tooltip()


def _tooltip_place(size: ImVec2, *, beside: bool) -> ImVec2:
    """The upper left corner of a tooltip of a size, within the program's window."""
    low, high = imgui.get_item_rect_min(), imgui.get_item_rect_max()
    viewport, gap = imgui.get_main_viewport(), em(TOOLTIP_GAP_EM)
    right, bottom = viewport.pos.x + viewport.size.x, viewport.pos.y + viewport.size.y
    if beside:
        window, width = imgui.get_window_pos().x, imgui.get_window_size().x
        x, y = window + width + gap, low.y
        x = x if x + size.x <= right else window - gap - size.x
    else:
        x, y = low.x, high.y + gap
        y = y if y + size.y <= bottom else low.y - gap - size.y
    x, y = min(x, right - size.x), min(y, bottom - size.y)
    return ImVec2(max(x, viewport.pos.x), max(y, viewport.pos.y))


def quiet(text: str) -> None:
    """Text in the quiet gray."""
    imgui.push_style_color(imgui.Col_.text, imgui.get_style().color_(imgui.Col_.text_disabled))
    imgui.text_unformatted(text)
    imgui.pop_style_color()


def wrapped(text: str, *, dim: bool = False) -> None:
    """Text that breaks its lines at the panel's edge."""
    if dim:
        disabled = imgui.get_style().color_(imgui.Col_.text_disabled)
        imgui.push_style_color(imgui.Col_.text, disabled)
    imgui.push_text_wrap_pos(0.0)
    imgui.text_unformatted(text)
    imgui.pop_text_wrap_pos()
    if dim:
        imgui.pop_style_color()


def label_of(owner: type, name: str) -> str:
    """The label that a field declares: a plain word, and the symbol behind it."""
    text: str = declared(owner, name).metadata["label"]
    return text


@contextlib.contextmanager
def label_column(width_em: float) -> Iterator[None]:
    """Give the labels another width, for windows with short ones."""
    global _label_em
    before, _label_em = _label_em, width_em
    try:
        yield
    finally:
        _label_em = before


def label(text: str) -> None:
    """Put a control's label on the left and make room for the control beside it."""
    imgui.align_text_to_frame_padding()
    beside = imgui.get_content_region_avail().x >= em(_label_em + CONTROL_EM)
    if text or beside:
        imgui.text_unformatted(text)
    if beside:
        imgui.same_line(em(_label_em))
    imgui.set_next_item_width(-1.0)


@dataclass(frozen=True)
class Reach:
    """The part of a declared range that a slider's hand reaches; typing reaches all of it.

    low, high: None is the range's own end. digits: format of the number.
    """

    low: float | None = None
    high: float | None = None
    digits: str = "%.3g"
    logarithmic: bool = False


def slider(
    owner: type,
    name: str,
    value: float,
    reach: Reach = Reach(),
    *,
    default: float | None = None,
    unit: bool = True,
) -> tuple[bool, float]:
    """A slider for a declared number; a double click goes to `default`, or to the field's.

    unit: written behind the number, unless the format of `reach` has it.
    """
    field = declared(owner, name)
    allowed: Range = field.metadata["range"]
    start: float | None = field.default if default is None else default  # type: ignore[assignment]
    flags = imgui.SliderFlags_.logarithmic if reach.logarithmic else imgui.SliderFlags_.none
    of_number = f" {allowed.unit}" if allowed.unit and unit else ""
    text = label_of(owner, name)
    label(text)
    low = allowed.low if reach.low is None else reach.low
    high = allowed.high if reach.high is None else reach.high
    whole = field.metadata.get("whole", False)
    if whole:
        ends = int(low), min(int(high), 2**30)
        changed, whole_number = sliders.int_slider(
            f"##{text}", int(value), *ends, f"%d{of_number}", int(flags)
        )
        number = float(whole_number)
    else:
        written = f"{reach.digits}{of_number}"
        changed, number = sliders.float_slider(f"##{text}", value, low, high, written, int(flags))
    resetting = sliders.resetting()
    tooltip(_meaning(allowed, start, text, (low, high)))
    if resetting and start is not None:
        return value != start, start
    bounded = min(max(number, allowed.low), allowed.high)
    return changed and bounded != value, int(bounded) if whole else bounded


def combo(
    text: str,
    options: tuple[str, ...],
    value: str,
    meaning: str,
    *,
    words: dict[str, str] | None = None,
) -> tuple[bool, str]:
    """A list of names to choose from; `words` replace some of them on the screen."""
    words = words or {}
    label(text)
    chosen = value
    if imgui.begin_combo(f"##{text}", words.get(value, value)):
        for option in options:
            if imgui.selectable(words.get(option, option), option == value)[0]:
                chosen = option
            if option == value:
                imgui.set_item_default_focus()  # where the keyboard begins
        imgui.end_combo()
    else:
        tooltip(meaning)
    return chosen != value, chosen


def choice(owner: type, name: str, value: str) -> tuple[bool, str]:
    """A list for a declared choice."""
    metadata = declared(owner, name).metadata
    return combo(metadata["label"], metadata["options"], value, sentence(metadata["meaning"]))


def buttons(text: str, meanings: dict[str, str], value: str) -> tuple[bool, str]:
    """Buttons side by side, one for each of a few names; the chosen one is bright.

    meanings: the tooltip of each name.
    """
    label(text)
    gap = imgui.get_style().item_inner_spacing.x
    room = imgui.get_content_region_avail().x
    width = (room - gap * (len(meanings) - 1)) / len(meanings)
    chosen = value
    for k, (name, meaning) in enumerate(meanings.items()):
        if k:
            imgui.same_line(0.0, gap)
        if toggle(f"{name}##{text}", on=name == value, width=width):
            chosen = name
        tooltip(sentence(meaning))
    return chosen != value, chosen


def toggle(text: str, *, on: bool, width: float) -> bool:
    """One of several buttons of which one is on; returns whether it was clicked."""
    style = imgui.get_style()
    ground = style.color_(imgui.Col_.slider_grab if on else imgui.Col_.button)
    imgui.push_style_color(imgui.Col_.button, ground)
    pressed = imgui.button(text, (width, 0.0))
    imgui.pop_style_color()
    return bool(pressed)


def checkbox(text: str, value: bool, meaning: str) -> bool:
    """A box to tick; returns whether it was clicked."""
    clicked, _ = imgui.checkbox(text, value)
    tooltip(sentence(meaning))
    return bool(clicked)


def button(text: str, meaning: str, *, width: float = 0.0, enabled: bool = True) -> bool:
    """A button, with a tooltip; `width` in pixels, 0 as wide as its text."""
    imgui.begin_disabled(not enabled)
    pressed = imgui.button(text, (width, 0.0))
    imgui.end_disabled()
    tooltip(sentence(meaning))
    return bool(pressed)


def small_button(text: str, meaning: str) -> bool:
    """A button as high as a line of text."""
    pressed = imgui.small_button(text)
    tooltip(sentence(meaning))
    return bool(pressed)


def flag(text: str, meaning: str) -> None:
    """A short word of warning: brighter than the text around it, without a colour."""
    imgui.push_style_color(imgui.Col_.text, gray(1.0))
    imgui.text_unformatted(f"! {text}")
    imgui.pop_style_color()
    tooltip(sentence(meaning))


def sentence(text: str) -> str:
    """A meaning as a sentence."""
    return sentence_case(text) + ("" if text.endswith((".", "?", "!")) else ".")


def _meaning(allowed: Range, default: float | None, label: str, reach: tuple[float, float]) -> str:
    """The words of a slider's tooltip, without its label and what the slider shows by itself.

    reach: the ends of the slider; typing reaches the whole of the allowed range.
    """
    name = label.partition(" (")[0]
    meaning = allowed.meaning.strip()
    before, colon, after = meaning.partition(": ")
    if colon and before.casefold() == name.casefold():
        meaning = after
    unit = f" {allowed.unit}" if allowed.unit else ""
    facts = []
    if (allowed.low, allowed.high) != reach and allowed.high <= WIDEST_RANGE:
        facts.append(f"Typed values: {allowed.low:.6g} to {allowed.high:.6g}{unit}.")
    if default is not None:
        facts.append(f"Default: {default:.4g}{unit}.")
    return "\n".join(part for part in (sentence(meaning), " ".join(facts), HOW) if part)
