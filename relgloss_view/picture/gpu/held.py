"""Which passes still hold: each is noted with everything that went into it."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

Key = tuple[object, ...]

#: The passes that follow from a pass, and no longer hold where it is drawn again.
FOLLOWING = {
    "grain": ("shade",),
    "shade": ("split", "xyz", "geometry"),
    "split": ("extremes", "tone", "light"),
    "geometry": ("overlay",),
    "light": ("overlay",),
    "tone": ("counts", "overlay"),
}


class Held:
    """The passes that hold, by name, with the numbers they were drawn from."""

    def __init__(self) -> None:
        self._keys: dict[str, Key] = {}

    def renew(self, name: str, *parts: object) -> bool:
        """Note what a pass is drawn from; True where it must be drawn again.

        Then what follows from it no longer holds either.
        """
        key = key_of(*parts)
        if self._keys.get(name) == key:
            return False
        self.forget(name)
        self._keys[name] = key
        return True

    def holds(self, name: str) -> bool:
        """Whether a pass holds, for the numbers it was last drawn from."""
        return name in self._keys

    def is_drawn_from(self, name: str, *parts: object) -> bool:
        """Whether a pass holds for these numbers."""
        return self._keys.get(name) == key_of(*parts)

    def drop(self, name: str) -> None:
        """A pass no longer holds, since its targets were freed; what was drawn from it does."""
        self._keys.pop(name, None)

    def forget(self, name: str) -> None:
        """A pass and what follows from it no longer hold."""
        self._keys.pop(name, None)
        for following in FOLLOWING.get(name, ()):
            self.forget(following)

    def clear(self) -> None:
        """Nothing holds."""
        self._keys.clear()


def key_of(*parts: object) -> Key:
    """A value that is equal exactly where everything that goes into a pass is."""
    return tuple(_plain(part) for part in parts)


def _plain(part: object) -> object:
    if isinstance(part, Mapping):
        return tuple((name, _plain(part[name])) for name in sorted(part))
    if isinstance(part, np.ndarray):
        return part.tobytes()
    return part
