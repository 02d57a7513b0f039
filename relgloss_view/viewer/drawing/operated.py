"""What other operators than the split show of the window's pictures, worked out at rest.

They take up to a second or so in numpy: a thread does it, and until it has, the split's picture
shows and says so. Operators have their default parameters here.
"""

from __future__ import annotations

import dataclasses
import weakref
from collections.abc import Callable

from relgloss_view.base.errors import RelglossError
from relgloss_view.operators.registry import DEFAULT_OPERATOR, make_operator
from relgloss_view.picture.displayed import Displayed
from relgloss_view.picture.frame import Frame
from relgloss_view.viewer.drawing.pictures import Pictures, Shown
from relgloss_view.viewer.files.background import Worker
from relgloss_view.viewer.state.model import Operated
from relgloss_view.viewer.state.state import DIFFERENCE, SIDES, State

COMPUTING = "being worked out"
WHEN_AT_REST = "comes when you let go"
NOT_UNDER_OVERLAYS = "is not shown under overlays and difference maps"

Key = tuple[str, object]


class _Side:
    """What one side holds: the last picture worked out, and the work that is under way."""

    def __init__(self, wake: Callable[[], None]) -> None:
        self.worker: Worker[Key, Displayed] = Worker(wake)
        self.key: Key | None = None
        self.result = Operated(None)
        self.frame: weakref.ref[Frame] | None = None  #: that the result was last found to fit


class OperatedPictures:
    """The operators' pictures of both sides."""

    def __init__(self, wake: Callable[[], None]) -> None:
        self._sides = {side: _Side(wake) for side in SIDES}

    def replaced(
        self, state: State, shown: dict[str, Shown], pictures: Pictures, *, at_rest: bool
    ) -> tuple[dict[str, Shown], dict[str, Operated]]:
        """The pictures with those of operators put in, and what there is to say by side.

        A side of the split has no entry in the second.
        """
        presentation = state.presentation
        plain = presentation.overlay == "none" and presentation.compare != DIFFERENCE
        replaced, told = dict(shown), {}
        for side, one in shown.items():
            name = presentation.operator(side)
            if name == DEFAULT_OPERATOR:
                continue
            if not (plain or presentation.haploscopic):
                told[side] = Operated(None, NOT_UNDER_OVERLAYS)
                continue
            told[side] = self.of(side, name, one.frame, at_rest=at_rest)
            displayed = told[side].displayed
            if displayed is not None:
                framebuffer = pictures.uploads.framebuffer(side, displayed)
                replaced[side] = dataclasses.replace(one, framebuffer=framebuffer)
        return replaced, told

    def of(self, side: str, name: str, frame: Frame, *, at_rest: bool) -> Operated:
        """What an operator shows of a frame; work is begun at rest only. Call it every frame."""
        held = self._sides[side]
        ended = held.worker.take()
        if ended is not None:
            held.key, held.frame = ended.key, None
            held.result = Operated(ended.value, ended.fault)
        if self._fits(held, name, frame):
            return held.result
        if not at_rest:
            return Operated(None, WHEN_AT_REST)
        if not held.worker.busy:
            try:
                work = _work(name, frame)
            except RelglossError as error:
                return Operated(None, str(error))
            held.worker.start((name, _what_counts(frame)), work)
        return Operated(None, COMPUTING)

    def _fits(self, held: _Side, name: str, frame: Frame) -> bool:
        if held.key is None or held.key[0] != name:
            return False
        if held.frame is None or held.frame() is not frame:
            if held.key[1] != _what_counts(frame):
                return False
            held.frame = weakref.ref(frame)
        return True


def _what_counts(frame: Frame) -> object:
    """What an operator's picture depends on; c is the split's."""
    return frame.scene, frame.look.without_c(), frame.size


def _work(name: str, frame: Frame) -> Callable[[], Displayed]:
    """The work, with all that it needs of the device fetched: a thread must not ask for it."""
    operator = make_operator(name)
    _ = frame.diffuse, frame.specular, frame.white_xyz
    return lambda: operator.draw(frame)
