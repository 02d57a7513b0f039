"""Sliders that the keyboard moves: arrows where the focus is, Enter to type, Delete to reset.

ImGui's own sliders take arrows only after Space, and Tab turns them into text fields. Here an arrow
moves the slider that has the focus, by a hundredth of its way; Shift by ten of these, Ctrl by a
tenth of one.
"""

from __future__ import annotations

import math

from imgui_bundle import imgui

STEPS = 100  #: from one end of a slider to the other
FAST, FINE = 10.0, 0.1  #: with Shift, with Ctrl
LOGARITHMIC = int(imgui.SliderFlags_.logarithmic)
HOW = "Enter or Ctrl+click types a value, Delete or double-click resets."

_moved = False  #: whether an arrow has moved a slider since that was last asked
#: The control that a double click has just reset; it ignores the hand until that lets go.
_reset_id = 0


def float_slider(
    label: str, value: float, low: float, high: float, written: str, flags: int = 0
) -> tuple[bool, float]:
    """A slider for a number; returns whether it was moved, and the number.

    `written` is the number's format, flags are ImGui's.
    """
    flags |= _while_tabbing(label)
    changed, number = imgui.slider_float(label, value, low, high, written, flags)
    steps = arrow_steps()
    if steps:
        number = _after(value, steps, low, high, logarithmic=bool(flags & LOGARITHMIC))
        return _note(number != value), number
    return bool(changed), float(number)


def int_slider(
    label: str, value: int, low: int, high: int, written: str, flags: int = 0
) -> tuple[bool, int]:
    """A slider for a whole number; see float_slider."""
    flags |= _while_tabbing(label)
    changed, number = imgui.slider_int(label, value, low, high, written, flags)
    steps = arrow_steps()
    if steps:
        far = round(steps * max(_round_step((high - low) / STEPS), 1.0))
        far = far or int(math.copysign(1, steps))
        after = int(_held(value, value + far, low, high))
        return _note(after != value), after
    return bool(changed), int(number)


def arrow_steps() -> float:
    """Steps to the right that arrows ask of the item before this call, if it has the focus."""
    across, _ = arrows(up_and_down=False)
    io = imgui.get_io()
    return across * (FAST if io.key_shift else 1.0) * (FINE if io.key_ctrl else 1.0)


def arrows(*, up_and_down: bool = True) -> tuple[int, int]:
    """Presses of arrows to the right and up that the item before this call has to follow.

    An item with the focus owns these keys, so that they don't carry the focus away as well.
    """
    if not imgui.is_item_focused() or imgui.is_item_active():
        return 0, 0
    key = imgui.Key
    owned = (key.left_arrow, key.right_arrow, *((key.up_arrow, key.down_arrow) * up_and_down))
    for name in owned:
        imgui.internal.set_key_owner(name, imgui.get_item_id())
    io = imgui.get_io()
    if io.key_alt or io.want_text_input:
        return 0, 0
    right, left, up, down = (
        int(name in owned and imgui.is_key_pressed(name))
        for name in (key.right_arrow, key.left_arrow, key.up_arrow, key.down_arrow)
    )
    return right - left, up - down


def note_moved() -> None:
    """Note that an arrow has moved something, which lasts for a moment as a drag does."""
    _note(True)


def take_moved() -> bool:
    """Whether an arrow has moved a slider since this was last asked."""
    global _moved
    moved, _moved = _moved, False
    return moved


def resetting() -> bool:
    """Whether the last item's default is asked for, by a double click or by Delete.

    After a double click that is so until the hand lets go.
    """
    global _reset_id
    item = imgui.get_item_id()
    if imgui.is_item_focused() and not imgui.is_item_active():
        keys = (imgui.Key.delete, imgui.Key.backspace)
        if any(imgui.is_key_pressed(key, False) for key in keys):
            return True
    if imgui.is_item_hovered() and imgui.is_mouse_double_clicked(imgui.MouseButton_.left):
        _reset_id = item
    if _reset_id == item and not imgui.is_item_active():
        held = imgui.is_mouse_down(imgui.MouseButton_.left)
        if not held:
            _reset_id = 0
        return bool(held)
    return _reset_id == item


def _while_tabbing(label: str) -> int:
    """Flags that keep Tab from making a slider a text field, unless it is one already."""
    if not imgui.is_key_down(imgui.Key.tab):
        return 0
    typing = imgui.internal.get_active_id() == imgui.get_id(label)
    return 0 if typing else int(imgui.SliderFlags_.no_input)


def _after(value: float, steps: float, low: float, high: float, *, logarithmic: bool) -> float:
    """The value after so many steps, on the slider's own scale."""
    if logarithmic and low > 0.0 and value > 0.0:
        return _held(value, value * (high / low) ** (steps / STEPS), low, high)
    return _held(value, value + steps * _round_step((high - low) / STEPS), low, high)


def _held(before: float, after: float, low: float, high: float) -> float:
    """The new value within the slider's ends; one that was typed beyond them goes no further."""
    return min(max(after, min(low, before)), max(high, before))


def _round_step(step: float) -> float:
    """The next smaller of 1, 2, 5 times a power of ten."""
    if not step > 0.0:
        return 0.0
    power = 10.0 ** math.floor(math.log10(step))
    return max(f * power for f in (1.0, 2.0, 5.0) if f * power <= step * 1.000001)


def _note(moved: bool) -> bool:
    global _moved
    _moved = _moved or moved
    return moved
