"""Keys between the window library and the interface, which takes all events of a frame at once.

The interface asks for chords: a key that was pressed in this frame while modifiers are down. Where
a key is pressed and its modifier let go within one frame, as quick hands do when frames are slow,
it sees a key without its modifier, and the chord is lost. So a frame gets events only up to the
first one that would hide another; what follows is held back for the next frame, in order.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import Any

import imgui_bundle  # noqa: F401 - brings the GLFW that the glfw module then finds; isort: skip
import glfw
from imgui_bundle import imgui

#: Modifiers as GLFW counts them, and as the interface does.
_COUNTED = {
    glfw.MOD_CONTROL: imgui.Key.mod_ctrl,
    glfw.MOD_SHIFT: imgui.Key.mod_shift,
    glfw.MOD_ALT: imgui.Key.mod_alt,
    glfw.MOD_SUPER: imgui.Key.mod_super,
}
MODIFIERS = frozenset(
    getattr(glfw, f"KEY_{side}_{name}")
    for side in ("LEFT", "RIGHT")
    for name in ("CONTROL", "SHIFT", "ALT", "SUPER")
)

Key = tuple[int, int, int, int]  #: key, scancode, action and modifiers, as GLFW reports them


class Keyboard:
    """Holds events back so that no key hides another within a frame."""

    def __init__(self, key: Callable[..., object], character: Callable[[int], object]) -> None:
        """key, character: take what GLFW's callbacks of these names get, without the window."""
        self._key, self._character = key, character
        self._held: deque[Key | int] = deque()  #: an integer is a character
        self._changed: set[int] = set()  #: keys that went down or up in this frame

    def key(self, key: int, scancode: int, action: int, mods: int) -> None:
        """A key went down or up, or is held."""
        self._take((key, scancode, action, mods))

    def character(self, codepoint: int) -> None:
        """A character was typed; it stays in its place among the keys."""
        self._take(codepoint)

    def next_frame(self) -> bool:
        """Begin a frame with the events that were held back.

        Returns whether there were any.
        """
        self._changed.clear()
        held, self._held = self._held, deque()
        for event in held:
            self._take(event)
        return bool(held)

    def _take(self, event: Key | int) -> None:
        if self._held or self._hides(event):
            self._held.append(event)
        elif isinstance(event, int):
            self._character(event)
        else:
            if event[2] != glfw.REPEAT:
                self._changed.add(event[0])
            self._key(*event)

    def _hides(self, event: Key | int) -> bool:
        """Whether a frame that already has the events before this one can't have it as well."""
        if isinstance(event, int) or event[2] == glfw.REPEAT:
            return False
        key = event[0]
        return key in self._changed or (key in MODIFIERS and not self._changed <= MODIFIERS)


def listen(window: Any, address: int) -> Keyboard:
    """Put a keyboard between GLFW's window and the interface, whose callbacks it replaces."""
    backend: Any = imgui.backends

    def give(key: int, scancode: int, action: int, mods: int) -> None:
        backend.glfw_key_callback(address, key, scancode, action, mods)
        if action == glfw.PRESS and key not in MODIFIERS:
            # The backend asks which modifiers are down now; a key that was held back had others.
            for bit, counted in _COUNTED.items():
                imgui.get_io().add_key_event(counted, bool(mods & bit))

    keyboard = Keyboard(give, lambda codepoint: backend.glfw_char_callback(address, codepoint))
    on_key: Any = lambda _, *event: keyboard.key(*event)  # noqa: E731 - annotated wrongly
    on_character: Any = lambda _, codepoint: keyboard.character(codepoint)  # noqa: E731
    glfw.set_key_callback(window, on_key)
    glfw.set_char_callback(window, on_character)
    return keyboard
