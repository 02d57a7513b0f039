"""The window's pictures by operators other than the split, computed while nothing moves.

They take up to a second or so in numpy. A thread computes them; until it has, the split's picture
shows, with a remark. Operators have their default parameters here.
"""

from __future__ import annotations

import weakref
from collections.abc import Callable

from relgloss_view.base.allocator import give_back
from relgloss_view.base.errors import RelglossError
from relgloss_view.operators.registry import DEFAULT_OPERATOR, make_operator
from relgloss_view.picture.displayed import Displayed
from relgloss_view.picture.frame import Frame
from relgloss_view.viewer.drawing.pair_renderer import SidePicture
from relgloss_view.viewer.files.background import Worker
from relgloss_view.viewer.state.model import OperatorPicture
from relgloss_view.viewer.state.state import DIFFERENCE, SIDES, State

COMPUTING = "is being computed"
WHEN_AT_REST = "follows when you let go"
NOT_UNDER_OVERLAYS = "is not shown under overlays and difference maps"

Key = tuple[str, object]


class _Side:
    """The last picture that was computed for a side, and the work that is under way."""

    def __init__(self, wake: Callable[[], None]) -> None:
        self.worker: Worker[Key, Displayed] = Worker(wake)
        self.key: Key | None = None
        self.result = OperatorPicture(None)
        self.frame: weakref.ref[Frame] | None = None  #: the last one that the result fits
        self.inputs: weakref.ref[Frame] | None = None  #: the one that is worked on

    def forget_inputs(self) -> None:
        """Free the arrays that were fetched for the work: 40 bytes a pixel."""
        frame = None if self.inputs is None else self.inputs()
        self.inputs = None
        if frame is not None:
            frame.forget()
        give_back()


class OperatorPictures:
    """The operators' pictures of both sides."""

    def __init__(self, wake: Callable[[], None]) -> None:
        self._sides = {side: _Side(wake) for side in SIDES}

    def of_pair(
        self, state: State, pictures: dict[str, SidePicture], *, at_rest: bool
    ) -> dict[str, OperatorPicture]:
        """The operators' pictures by side; a side of the split has none."""
        presentation = state.presentation
        plain = presentation.overlay == "none" and presentation.compare != DIFFERENCE
        by_side = {}
        for side, picture in pictures.items():
            name = presentation.operator(side)
            if name == DEFAULT_OPERATOR:
                continue
            if plain or presentation.haploscopic:
                by_side[side] = self.of(side, name, picture.frame, at_rest=at_rest)
            else:
                by_side[side] = OperatorPicture(None, NOT_UNDER_OVERLAYS)
        return by_side

    def of(self, side: str, name: str, frame: Frame, *, at_rest: bool) -> OperatorPicture:
        """An operator's picture of a frame; work begins at rest only. Call it in every frame."""
        own = self._sides[side]
        ended = own.worker.take()
        if ended is not None:
            own.key, own.frame = ended.key, None
            own.result = OperatorPicture(ended.value, ended.fault)
            own.forget_inputs()
        if self._fits(own, name, frame):
            return own.result
        if not at_rest:
            return OperatorPicture(None, WHEN_AT_REST)
        if not any(other.worker.busy for other in self._sides.values()):  # one picture's memory
            try:
                work = _work(name, frame)
            except RelglossError as error:
                return OperatorPicture(None, str(error))
            own.inputs = weakref.ref(frame)
            own.worker.start((name, _dependence(frame)), work)
        return OperatorPicture(None, COMPUTING)

    def _fits(self, own: _Side, name: str, frame: Frame) -> bool:
        if own.key is None or own.key[0] != name:
            return False
        if own.frame is None or own.frame() is not frame:
            if own.key[1] != _dependence(frame):
                return False
            own.frame = weakref.ref(frame)
        return True


def _dependence(frame: Frame) -> object:
    """All that an operator's picture depends on; c is the split's."""
    return frame.scene, frame.look.without_c(), frame.size


def _work(name: str, frame: Frame) -> Callable[[], Displayed]:
    """The work, with all that it needs of the device fetched: a thread must not ask for it."""
    operator = make_operator(name)
    _ = frame.diffuse, frame.specular, frame.white_xyz, frame.edges, frame.on_object
    return lambda: operator.draw_digital(frame)
