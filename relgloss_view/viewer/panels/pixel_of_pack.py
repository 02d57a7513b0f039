"""What a pixel of a pack shows: finishes with their shares, the label, plates, the artwork."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.picture.frame import Frame
from relgloss_view.viewer.drawing.picking import Picked, pick

LONGEST = 40  #: characters of a name
LEAST_SHARE = 0.005  #: a smaller one would read 0 %


@dataclass(frozen=True)
class Row:
    """A quantity of a point of a pack: its name, its meaning, and its words."""

    name: str
    meaning: str
    texts: Callable[[Picked], list[str]]


def _shares(values: dict[str, float]) -> str:
    return ", ".join(
        f"{printable(name, LONGEST)} {100.0 * share:.0f} %"
        for name, share in values.items()
        if share >= LEAST_SHARE
    )


ROWS = (
    Row(
        "Finish",
        "The finishes whose highlights the pixel shows, with their shares.",
        lambda p: [_shares(p.shares)],
    ),
    Row(
        "Label (mm)",
        "The part of the form, and the place to the right and up from the label's centre.",
        lambda p: [f"{printable(p.part, LONGEST)}: {p.label_mm[0]:.1f}, {p.label_mm[1]:.1f}"],
    ),
    Row(
        "Plates",
        "The plates of the artwork that print there, beside its colours.",
        lambda p: [_shares(p.plates) or "-"],
    ),
    Row(
        "Artwork (L*, a*, b*)",
        "The approved colour of the artwork there, under D50.",
        lambda p: ["-"] if p.lab is None else [f"{value:.1f}" for value in p.lab],
    ),
)


class Picks:
    """The last point that was read in each side's picture."""

    def __init__(self) -> None:
        self._last: dict[str, tuple[Frame, int, int, Picked | None]] = {}

    def of(
        self, side: str, frame: Frame | None, column: int, row: int, *, dragging: bool
    ) -> Picked | None:
        """The point under a pixel; None of a sample, off the object, or while a hand drags."""
        if frame is None or frame.scene.pack is None:
            return None
        last = self._last.get(side)
        if last is not None and last[0] is frame and last[1:3] == (column, row):
            return last[3]
        if dragging:
            return None if last is None else last[3]
        try:
            picked = pick(frame.scene, frame.size, (column + 0.5, row + 0.5))
        except InputError:  # the picture's own line reports it
            picked = None
        self._last[side] = frame, column, row, picked
        return picked
