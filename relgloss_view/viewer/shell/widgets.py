"""Controls made from declared parameters: range, unit, default and meaning come from their fields.

Ctrl-click types a value, a double click resets it, a tooltip says what it is. Each returns whether
the user changed it, and the value; ids are the labels with `##` before them.
"""

from __future__ import annotations

import dataclasses
from typing import Any

from imgui_bundle import imgui

from relgloss_view.base.parameters import Range
from relgloss_view.viewer.shell.theme import em, gray

LABEL_EM = 7.5  #: width of the column of labels
NARROW_EM = 13.0  #: a panel below this has its labels above the controls
HOW = "Ctrl-click types a value, a double click resets it."

#: The control that a double click has just reset; it ignores the hand until that lets go.
_reset_id = 0


def declared(owner: type, name: str) -> dataclasses.Field[Any]:
    """The field of a dataclass that declares a parameter."""
    return next(f for f in dataclasses.fields(owner) if f.name == name)


def tooltip(text: str) -> None:
    """Explain the item before this call, after the mouse has rested on it."""
    if imgui.begin_item_tooltip():
        imgui.push_text_wrap_pos(em(24))
        imgui.text_unformatted(text)
        imgui.pop_text_wrap_pos()
        imgui.end_tooltip()


def quiet(text: str) -> None:
    """Text that stands back."""
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


def label(text: str) -> None:
    """Put a control's label on the left and make room for the control beside it."""
    imgui.align_text_to_frame_padding()
    imgui.text_unformatted(text)
    if imgui.get_content_region_avail().x >= em(NARROW_EM):
        imgui.same_line(em(LABEL_EM))
    imgui.set_next_item_width(-1.0)


def slider(
    text: str,
    owner: type,
    name: str,
    value: float,
    *,
    low: float | None = None,
    high: float | None = None,
    default: float | None = None,
    digits: str = "%.3g",
    logarithmic: bool = False,
) -> tuple[bool, float]:
    """A slider for a declared number. `low` and `high` narrow what the hand reaches, not typing."""
    field = declared(owner, name)
    allowed: Range = field.metadata["range"]
    start: float | None = field.default if default is None else default  # type: ignore[assignment]
    flags = imgui.SliderFlags_.logarithmic if logarithmic else imgui.SliderFlags_.none
    unit = f" {allowed.unit}" if allowed.unit else ""
    label(text)
    ends = (allowed.low if low is None else low, allowed.high if high is None else high)
    whole = field.metadata.get("whole", False)
    if whole:
        ends_int = (int(ends[0]), min(int(ends[1]), 2**30))
        changed, whole_number = imgui.slider_int(
            f"##{text}", int(value), *ends_int, f"%d{unit}", flags
        )
        number = float(whole_number)
    else:
        changed, number = imgui.slider_float(f"##{text}", value, *ends, f"{digits}{unit}", flags)
    resetting = reset_by_double_click()
    tooltip(_meaning(allowed, start))
    if resetting and start is not None:
        return value != start, start
    bounded = min(max(number, allowed.low), allowed.high)
    return changed and bounded != value, int(bounded) if whole else bounded


def reset_by_double_click() -> bool:
    """Whether a double click on the last item asks for its default; so until the hand lets go."""
    global _reset_id
    item = imgui.get_item_id()
    if imgui.is_item_hovered() and imgui.is_mouse_double_clicked(imgui.MouseButton_.left):
        _reset_id = item
    if _reset_id == item and not imgui.is_item_active():
        resetting = imgui.is_mouse_down(imgui.MouseButton_.left)
        if not resetting:
            _reset_id = 0
        return resetting
    return _reset_id == item


def combo(
    text: str,
    options: tuple[str, ...],
    value: str,
    meaning: str,
    *,
    shown: dict[str, str] | None = None,
) -> tuple[bool, str]:
    """A list of names to choose from; `shown` gives some of them other words."""
    words = shown or {}
    label(text)
    chosen = value
    if imgui.begin_combo(f"##{text}", words.get(value, value)):
        for option in options:
            if imgui.selectable(words.get(option, option), option == value)[0]:
                chosen = option
        imgui.end_combo()
    else:
        tooltip(meaning)
    return chosen != value, chosen


def choice(text: str, owner: type, name: str, value: str) -> tuple[bool, str]:
    """A list for a declared choice."""
    metadata = declared(owner, name).metadata
    return combo(text, metadata["options"], value, sentence(metadata["meaning"]))


def checkbox(text: str, value: bool, meaning: str) -> bool:
    """A box to tick; returns whether it was clicked."""
    clicked, _ = imgui.checkbox(text, value)
    tooltip(sentence(meaning))
    return bool(clicked)


def button(text: str, meaning: str, *, width: float = 0.0, enabled: bool = True) -> bool:
    """A button that says what it does; `width` in pixels, 0 as wide as its text."""
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
    return text[:1].upper() + text[1:] + ("" if text.endswith((".", "?", "!")) else ".")


def _meaning(allowed: Range, default: float | None) -> str:
    unit = f" {allowed.unit}" if allowed.unit else ""
    text = f"{sentence(allowed.meaning)}\n{allowed.low:g} to {allowed.high:g}{unit}"
    if default is not None:
        text += f"; default {default:g}{unit}"
    return f"{text}.\n{HOW}"
