"""Keys of a session. A chord is a key with its modifiers, as ImGui counts them."""

from __future__ import annotations

from collections.abc import Callable

import imgui_bundle  # noqa: F401 - brings the GLFW that the glfw module then finds; isort: skip
import glfw
from imgui_bundle import imgui

ENTER = (int(imgui.Key.enter), int(imgui.Key.keypad_enter))
SPACE = (int(imgui.Key.space),)
BACKSPACE = (int(imgui.Key.backspace),)
PAUSE = (int(imgui.Key.p),)
_CTRL, _SHIFT = int(imgui.Key.mod_ctrl), int(imgui.Key.mod_shift)
SKIP = tuple(_CTRL | key for key in ENTER)
QUIT = (_CTRL | int(imgui.Key.q),)
EXPERIMENTER = imgui.Key.tab

#: ImGui names a key by what it writes where that is one of these, whatever else it is.
_BY_SIGN = {
    "`": "grave_accent", "-": "minus", "=": "equal", "[": "left_bracket", "]": "right_bracket",
    "\\": "backslash", ",": "comma", ";": "semicolon", "'": "apostrophe", ".": "period",
    "/": "slash",
}  # fmt: skip


def pressed(chords: tuple[int, ...]) -> bool:
    """Whether one of the chords has just been pressed; a key that is held counts once."""
    return any(imgui.is_key_chord_pressed(chord) for chord in chords)


def digit_chords(
    count: int, name_of: Callable[[int, int], str | None] = glfw.get_key_name
) -> list[tuple[int, ...]]:
    """The chords of the keys 1, 2, ... `count`: those of the row and of the keypad.

    On some keyboards digits take Shift, and without it the key writes a sign that ImGui names it by
    (on French ones 4 is the apostrophe). name_of: what GLFW's key writes, as glfw.get_key_name.
    """
    chords = []
    for digit in range(1, count + 1):
        keys = [getattr(imgui.Key, f"_{digit}"), getattr(imgui.Key, f"keypad{digit}")]
        sign = name_of(glfw.KEY_0 + digit, 0)
        if sign in _BY_SIGN:
            keys.append(getattr(imgui.Key, _BY_SIGN[sign]))
        chords.append(tuple(modifier | int(key) for key in keys for modifier in (0, _SHIFT)))
    return chords
