"""SystemProfile: what a system has for a monitor; Place, of a monitor; Source, which one asks."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, Protocol

MOST_BYTES = 16 << 20  #: of a monitor's profile; those of table printers have 3 MB
NONE_NAMED = "the system names no profile"


class Place(NamedTuple):
    """Where a monitor lies on the desktop: its upper left corner and its size, pixels."""

    left: int
    top: int
    width: int
    height: int

    def shared(self, other: Place) -> int:
        """The area that both cover, pixels.

        >>> Place(0, 0, 10, 10).shared(Place(8, 8, 10, 10))
        4
        """
        across = min(self.left + self.width, other.left + other.width) - max(self.left, other.left)
        down = min(self.top + self.height, other.top + other.height) - max(self.top, other.top)
        return max(across, 0) * max(down, 0)


@dataclass(frozen=True)
class SystemProfile:
    """An ICC profile's bytes, its name (a file's, where it has one) and where it is from."""

    data: bytes
    name: str
    source: str


@dataclass(frozen=True)
class Answer:
    """A monitor's profile, or the reason why there is none; fault: it is there, and not usable."""

    profile: SystemProfile | None = None
    reason: str = NONE_NAMED
    fault: bool = False


class Source(Protocol):
    """One way to ask a system. All but `rouse` and `close` are called from one thread."""

    def answer(self, place: Place | None) -> Answer:
        """The profile of the monitor at a place; of the first one where the place is None."""

    def wait(self, longest_s: float) -> bool:
        """Sleep until another answer may be right; returns whether it may be."""

    def rouse(self) -> None:
        """End a wait now; from any thread."""

    def close(self) -> None:
        """Release what it holds; after the thread has ended."""
