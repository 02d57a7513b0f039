"""Pace: while a hand drags and frames take too long, pictures are drawn smaller; full at rest."""

from __future__ import annotations

import math

BUDGET_S = 0.033  #: for a frame while something is dragged
SCALES = (1.0, 0.71, 0.5, 0.35, 0.25)  #: each draws about half as many pixels as the one before
#: Frames below this share of the budget at the next larger scale let the scale go up.
ROOM = 0.7
SMOOTHING = 0.5
#: Consecutive frames over the budget before the scale goes down: one slow frame is no reason.
PATIENCE = 2


class Pace:
    """Chooses the scale of the pictures from how long frames take."""

    def __init__(self) -> None:
        self.scale = 1.0
        self._step = 0
        self._frame_s: float | None = None
        self._slow = 0

    def rest(self) -> None:
        """Nothing is dragged: the next frame is full."""
        self.scale = 1.0
        self._frame_s = None
        self._slow = 0

    def drag(self) -> None:
        """Something is dragged: go on with the scale that was good enough the last time."""
        self.scale = SCALES[self._step]

    def measured(self, frame_s: float) -> None:
        """Note how long a frame took at the present scale, while something is dragged."""
        before = self._frame_s
        smooth = frame_s if before is None else before + SMOOTHING * (frame_s - before)
        self._frame_s = smooth
        self._slow = self._slow + 1 if smooth > BUDGET_S else 0
        if self._slow >= PATIENCE and self._step < len(SCALES) - 1:
            # As far down as the excess asks for, since time goes with the number of pixels.
            wanted = SCALES[self._step] * math.sqrt(BUDGET_S / smooth)
            while self._step < len(SCALES) - 1 and SCALES[self._step] > wanted:
                self._step += 1
            self._start_over()
        elif self._step > 0:
            larger = smooth * (SCALES[self._step - 1] / SCALES[self._step]) ** 2
            if larger < ROOM * BUDGET_S:
                self._step -= 1
                self._start_over()

    def _start_over(self) -> None:
        self.scale = SCALES[self._step]
        self._frame_s = None
        self._slow = 0
