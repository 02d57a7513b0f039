"""Draft scale: while a hand drags and frames take too long, pictures are drawn smaller."""

from __future__ import annotations

import math

BUDGET_S = 0.033  #: for a frame while something is dragged
SCALES = (1.0, 0.71, 0.5, 0.35, 0.25)  #: each draws about half as many pixels as the one before
#: Frames below this share of the budget at the next larger scale let the scale go up.
ROOM = 0.7
#: Frames that count. The slowest of them is no reason to go down, but one not to go up.
COUNTED = 3


class DraftScale:
    """Chooses the scale of the pictures from how long frames take."""

    def __init__(self) -> None:
        self.scale = 1.0
        self._step = 0
        self._frames_s: list[float] = []  #: the last at the present scale

    def rest(self) -> None:
        """Nothing is dragged: the next frame is full."""
        self.scale = 1.0
        self._frames_s.clear()

    def drag(self) -> None:
        """Something is dragged: take the scale that was good enough the last time."""
        self.scale = SCALES[self._step]

    def measured(self, frame_s: float) -> None:
        """Note how long a frame took at the present scale, while something is dragged."""
        frames_s = self._frames_s
        frames_s.append(frame_s)
        del frames_s[:-COUNTED]
        if len(frames_s) < 2:
            return
        typical = (sum(frames_s) - max(frames_s)) / (len(frames_s) - 1)
        if typical > BUDGET_S:
            # As far down as the excess asks for, since time goes with the number of pixels.
            wanted = SCALES[self._step] * math.sqrt(BUDGET_S / typical)
            self._go_to(next((k for k, s in enumerate(SCALES) if s <= wanted), len(SCALES) - 1))
        elif len(frames_s) == COUNTED and self._step > 0:
            larger = max(frames_s) * (SCALES[self._step - 1] / SCALES[self._step]) ** 2
            if larger < ROOM * BUDGET_S:
                self._go_to(self._step - 1)

    def _go_to(self, step: int) -> None:
        if step != self._step:
            self._step = step
            self._frames_s.clear()
        self.scale = SCALES[step]
