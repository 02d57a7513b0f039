"""Model: what the panels read and change. No OpenGL, no window library."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from relgloss_view.base.errors import RelglossError
from relgloss_view.base.reading import printable
from relgloss_view.measure.table import Measurement
from relgloss_view.picture.displayed import Displayed
from relgloss_view.picture.frame import Frame
from relgloss_view.picture.model.view import Size
from relgloss_view.picture.scene.sample import Sample
from relgloss_view.picture.scene.setting import Setting
from relgloss_view.viewer.state.history import History
from relgloss_view.viewer.state.state import State


@dataclass(frozen=True)
class Operated:
    """A side's picture by an operator, or why the split's shows in its place."""

    displayed: Displayed | None
    told: str = ""


LONGEST_NOTE = 400  #: characters
NOTES_KEPT = 50
HOLD_S = 0.4  #: between turns of the wheel that belong together


@dataclass(frozen=True)
class Note:
    """Something the window says in its status line."""

    text: str
    fault: bool = False
    at_s: float = field(default_factory=time.monotonic)


class Model:
    """The state with its history, the pictures last drawn, and what was said.

    Panels change the state with `change`; the next frame draws what that asks for.
    """

    def __init__(self, state: State) -> None:
        self.history = History(state)
        #: The pictures as last drawn, by side; empty before the first.
        self.frames: dict[str, Frame] = {}
        #: What operators other than the split made of them, by side; none for a side of the split.
        self.operated: dict[str, Operated] = {}
        self.notes: list[Note] = []
        #: Tables read in this window, by file, so that plots can show their points.
        self.measurements: dict[str, Measurement] = {}
        self.active_side = "test"  #: the one that panels show where they show one
        self.dragging = False  #: whether the hand holds something that changes pictures
        #: The pixel under the mouse, and the one that is held: side, column, row from the top.
        self.pointer: tuple[str, int, int] | None = None
        self.pinned: tuple[str, int, int] | None = None

        #: What the last frame was like.
        self.frame_s = 0.0
        self.redrawn: list[str] = []  #: passes drawn when there last were any, 'side pass'
        self.draft = False  #: whether pictures are drawn smaller, while something is dragged
        self.picture_size: Size = (1, 1)
        #: Takes the pane's pixels, (H, W, 3), without what the interface writes on them; asked for
        #: once, answered by the next full frame.
        self.take_view: Callable[[NDArray[np.uint8]], None] | None = None
        self.gap_px = 0  #: between the pictures on the screen
        self.pixel_pitch_m: float | None = None  #: of the monitor; None where it does not say
        #: Draws a side's picture at another size, in pixels; may raise RelglossError.
        self.render_at: Callable[[str, Size], Frame] | None = None
        self._held_until_s = 0.0

    @property
    def state(self) -> State:
        """The present state."""
        return self.history.state

    def hold(self) -> None:
        """Let a gesture without a held button, such as turns of the wheel, go on for a moment."""
        self._held_until_s = time.monotonic() + HOLD_S

    def displayed(self, side: str) -> Displayed | None:
        """What an operator shows of a side's picture as last drawn; None where the split shows."""
        operated = self.operated.get(side)
        return None if operated is None else operated.displayed

    @property
    def held(self) -> bool:
        """Whether such a gesture goes on."""
        return time.monotonic() < self._held_until_s

    def change(self, state: State, gesture: object = None) -> None:
        """Make a state the present one; see History.change."""
        self.history.change(state, gesture)

    def set_part(self, part: str, gesture: object = None, **changes: Any) -> None:
        """Change entries of shape, lamp, eye, display or presentation."""
        self.change(self.state.with_part(part, **changes), gesture)

    def set_look(self, side: str, gesture: object = None, **changes: Any) -> None:
        """Change entries of a side's look."""
        self.change(self.state.with_look(side, **changes), gesture)

    def set_setting(self, side: str, setting: Setting, gesture: object = None) -> None:
        """Change sigma_N and c of a side."""
        self.change(self.state.with_setting(side, setting), gesture)

    def set_sample(self, side: str, sample: Sample) -> None:
        """Put another sample on a side."""
        self.change(self.state.with_sample(side, sample))

    def say(self, text: str, *, fault: bool = False) -> None:
        """Show a line in the status line and keep it in the list of messages."""
        self.notes.append(Note(printable(text, LONGEST_NOTE), fault))
        del self.notes[:-NOTES_KEPT]

    def say_once(self, text: str, *, fault: bool = False) -> None:
        """Say something, unless it was the last thing said."""
        if not self.notes or self.notes[-1].text != printable(text, LONGEST_NOTE):
            self.say(text, fault=fault)

    def attempt(self, action: Callable[[], object]) -> bool:
        """Do something that may fail for a reason the user can mend; a failure is said."""
        try:
            action()
        except RelglossError as error:
            self.say(str(error), fault=True)
            return False
        return True
