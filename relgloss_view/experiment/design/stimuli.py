"""Stimuli: what a setting looks like, drawn by the one renderer."""

from __future__ import annotations

import hashlib
from typing import TYPE_CHECKING, Any

from relgloss_view.experiment.design.study import Study
from relgloss_view.picture.frame import Frame
from relgloss_view.picture.output.parameters import parameters
from relgloss_view.picture.scene.setting import Setting

if TYPE_CHECKING:
    from relgloss_view.quality.backends import FrameRenderer


def draw_stimulus(renderer: FrameRenderer, study: Study, sample: int, setting: int) -> Frame:
    """The test picture of a sample at a setting of the grid, as every observer sees it."""
    return draw_look(renderer, study, sample, study.grid.settings[setting])


def draw_look(renderer: FrameRenderer, study: Study, sample: int, setting: Setting) -> Frame:
    """The test picture of a sample at any setting."""
    return renderer.render(study.scene(sample), study.test_look(setting), study.screen.size)


def draw_reference(renderer: FrameRenderer, study: Study) -> Frame:
    """The reference picture."""
    return renderer.render(study.reference_scene(), study.reference_look, study.screen.size)


def digest_of(frame: Frame) -> str:
    """SHA-256 of the digital values that the display gets, rows from the top."""
    return hashlib.sha256(frame.display.tobytes()).hexdigest()


def frame_record(frame: Frame) -> dict[str, Any]:
    """The numbers of a frame that a session keeps: what was asked for is in the study."""
    numbers = parameters(frame)
    kept = ("sigma_n_deg", "c", "c_max", "clip_count", "out_of_gamut_count", "warnings", "version")
    return {key: numbers[key] for key in kept}
