"""Whether this window draws what the designer of a proof saw: its grid beside a picture drawn here.

It draws through OpenGL, so it belongs into the window's own thread, once for each proof.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

from relgloss_view.proof.drawing import page_display
from relgloss_view.proof.grid import compare
from relgloss_view.proof.pair import Pair
from relgloss_view.quality.backends import FrameRenderer
from relgloss_view.viewer.state.proofs import OpenProof
from relgloss_view.viewer.state.state import SIDES, Presentation


@dataclass(frozen=True)
class SamePicture:
    """How far the pictures drawn here are from the proof's grid.

    largest: dE2000 of both pictures. points: that were compared. missed: that show the object in
    one of both alone. same: whether nobody sees a difference in either picture.
    """

    largest: float
    points: int
    missed: int
    same: bool

    @property
    def words(self) -> str:
        """The outcome in a sentence."""
        number = f"largest difference {_number(self.largest)} dE2000" if self.points else "no point"
        if self.same:
            return f"This window draws what the designer saw ({number})."
        missed = f", {self.missed} points of the outline differ" if self.missed else ""
        return (
            f"This window does not draw what the designer saw ({number}{missed}): update relgloss "
            "or the graphics driver before you judge."
        )


def _number(difference: float) -> str:
    """A difference of colour as people read it.

    >>> _number(5e-5), _number(0.034), _number(3.21)
    ('below 0.01', '0.03', '3.2')
    """
    if difference < 0.01:
        return "below 0.01"
    return f"{difference:.2f}" if difference < 1.0 else f"{difference:.1f}"


def same_picture(opened: OpenProof, renderer: FrameRenderer) -> SamePicture:
    """Draw both pictures of a proof with its first settings, and compare. Raises RelglossError."""
    state = dataclasses.replace(opened.at(0), presentation=Presentation())
    state = state.placed(display=page_display(state.setup.display))
    exact = {side: state.side(side).look.with_entries(quality="exact") for side in SIDES}
    pair = Pair({side: state.scene(side) for side in SIDES}, exact)
    width, height = opened.proof.content["size_px"]
    drawn = pair.drawn(renderer, (int(width), int(height)))
    grid = opened.proof.content["grid"]["sides"]
    found = [compare(grid[side], drawn[side]) for side in SIDES]
    return SamePicture(
        max(one.largest for one in found),
        sum(one.points for one in found),
        sum(one.missed for one in found),
        all(one.is_same for one in found),
    )
