"""The two pictures of a trial: drawn before they show, and kept so that they can be told again."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from relgloss_view.base.errors import InputError
from relgloss_view.experiment.design.stimuli import digest_of, frame_record
from relgloss_view.experiment.design.study import Study
from relgloss_view.experiment.design.trial_order import Trial
from relgloss_view.experiment.session.store import Store
from relgloss_view.picture.model.view import Size
from relgloss_view.viewer.drawing.arrangement import Arrangement
from relgloss_view.viewer.drawing.canvas import Canvas, canvas_of
from relgloss_view.viewer.drawing.pair_renderer import PairRenderer, SidePicture
from relgloss_view.viewer.state.state import Side, State
from relgloss_view.viewer.trials.placement import presentation_of


def state_of(study: Study, trial: Trial) -> State:
    """What the two renderers draw in a trial."""
    look = study.test_look(study.grid.settings[trial.setting])
    return State(
        Side(study.reference, study.reference_look),
        Side(study.samples[trial.sample].sample, look),
        study.setup,
        presentation_of(study),
    )


class Pair:
    """Draws the pictures of a trial once, and keeps what they were in the session file."""

    def __init__(self, ctx: Any, store: Store, run: int, study: Study) -> None:
        """study: the store's, on the display in front of the observer."""
        self._ctx = ctx
        self._store, self._run = store, run
        self._study = study
        self._presentation = presentation_of(study)
        self._pictures = PairRenderer(ctx)
        self._of: tuple[int, int] | None = None  #: sample and setting of what is drawn
        self._shown: dict[str, SidePicture] = {}
        self._kept: set[tuple[int | None, int | None]] = set()

    def ready(self, trial: Trial) -> bool:
        """Whether the pictures of a trial stand ready to be shown."""
        return self._of == (trial.sample, trial.setting)

    def prepare(self, trial: Trial) -> None:
        """Draw the pictures of a trial to the last pixel, and keep what they are.

        InputError where a picture can't be drawn, or what it is can't be kept.
        """
        self._of = None
        size = self._study.screen.size
        state = state_of(self._study, trial)
        pair = self._pictures.draw(state, Arrangement(size, {}), 1.0, None)
        self._shown = pair.pictures
        for side, fault in pair.faults.items():
            raise InputError(f"the {side} picture can't be drawn: {fault}")
        self._keep(None, None, "reference")
        self._keep(trial.sample, trial.setting, "test")
        self._ctx.finish()
        self._of = (trial.sample, trial.setting)

    def _keep(self, sample: int | None, setting: int | None, side: str) -> None:
        if (sample, setting) in self._kept:
            return
        frame = self._shown[side].frame
        self._store.keep_picture(
            self._run, sample, setting, digest_of(frame), frame.device, frame_record(frame)
        )
        self._kept.add((sample, setting))

    def canvas(self, window: Size, arrangement: Arrangement) -> Canvas:
        """What is painted of the pictures that stand ready."""
        return canvas_of(window, self._presentation, arrangement, self._shown)

    def finish_frame(self) -> bool:
        """Wait until all that was drawn is on the screen; returns whether the device took it."""
        self._ctx.finish()
        return bool(self._ctx.error == "GL_NO_ERROR")

    def restore(self, is_texture: Callable[[int], bool], *, lost: bool) -> None:
        """Make everything anew where the device has lost it, or is known to have."""
        if lost or self._pictures.lost(is_texture):
            self._pictures.abandon()
            self._pictures = PairRenderer(self._ctx)
            self._of, self._shown = None, {}

    def release(self) -> None:
        """Free everything on the device."""
        self._pictures.release()
