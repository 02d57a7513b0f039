"""Results that plots keep from one redraw of the window to the next, none of them stale."""

from __future__ import annotations

import weakref
from collections.abc import Callable, Hashable
from typing import Generic, TypeVar

from relgloss_view.display.display import Display
from relgloss_view.picture.frame import Frame

T = TypeVar("T")


def light_of(frame: Frame) -> object:
    """All that the light of a frame depends on, before scaling and display."""
    seen = frame.scene.display  # the size of a pixel at the eye goes into the grain
    display = Display(
        pixel_pitch_mm=seen.pixel_pitch_mm, viewing_distance_m=seen.viewing_distance_m
    )
    scene = frame.scene.placed(display=display)
    return scene, frame.look.without_c(), frame.size


class PerFrame(Generic[T]):
    """A result of a frame's arrays: computed once for each frame, and never during a drag.

    The arrays come from the GPU, which takes milliseconds. During a drag the last result is kept;
    it still holds where `key` of both frames is the same, and is out of date otherwise.
    """

    def __init__(
        self, work: Callable[[Frame], T], key: Callable[[Frame], object] | None = None
    ) -> None:
        self._work = work
        self._key = key
        self._made_from: weakref.ref[Frame] | None = None
        self._made_key: object = None
        self._asked: tuple[weakref.ref[Frame], bool] | None = None
        self._value: T | None = None

    def get(self, frame: Frame | None, *, dragging: bool) -> tuple[T | None, bool]:
        """The result and whether it holds for this frame; None where there is none yet."""
        if frame is None:
            self._made_from = self._asked = self._value = self._made_key = None
            return None, False
        if self._made_from is not None and self._made_from() is frame:
            return self._value, True
        if not dragging:
            # Also where the key is the same: a lamp's file may have been edited in between.
            value = self._work(frame)
            self._value, self._made_from = value, weakref.ref(frame)
            self._made_key = self._key(frame) if self._key else None
            self._asked = None
            return value, True
        return self._value, self._value is not None and self._still_holds(frame)

    def _still_holds(self, frame: Frame) -> bool:
        if self._key is None:
            return False
        if self._asked is None or self._asked[0]() is not frame:
            self._asked = weakref.ref(frame), self._key(frame) == self._made_key
        return self._asked[1]


class Recent(Generic[T]):
    """The last few results by the very objects they were made from.

    A Material can't be hashed, as a fit's evidence holds dictionaries, and is slow to compare.
    Identity is exact while the object is held here, and materials are frozen.
    """

    def __init__(self, longest: int = 8) -> None:
        self._longest = longest
        self._kept: list[tuple[object, Hashable, T]] = []

    def get(self, source: object, key: Hashable, make: Callable[[], T]) -> T:
        """The result for an object, by identity, and a key, by value; made if it is not there."""
        value = self.peek(source, key)
        if value is not None:
            return value
        value = make()
        self._kept.append((source, key, value))
        del self._kept[: -self._longest]
        return value

    def peek(self, source: object, key: Hashable) -> T | None:
        """The result, if it is there."""
        for k, (kept, kept_key, value) in enumerate(self._kept):
            if kept is source and kept_key == key:
                self._kept.append(self._kept.pop(k))
                return value
        return None
