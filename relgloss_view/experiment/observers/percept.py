"""What a simulated observer sees in a picture: a perceived gloss and a perceived grain.

A model, not a measurement of people: it is there so that a study with a known answer can be run
from end to end. log G = log(contrast) - w2 grain + w3 log(sharpness / contrast), contrast being
what the highlight adds to the body's own shading, where it adds most; grain is the deviation
from grain to grain in relation to that contrast. The measures are those of docs/operators.md, of
what the display shows.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.terminal import ProgressReport, no_progress
from relgloss_view.experiment.design.stimuli import draw_look
from relgloss_view.experiment.design.study import Study
from relgloss_view.gloss.shown import Regions, grain_deviation, peak_contrast, sharpness
from relgloss_view.operators.split import Split
from relgloss_view.picture.frame import Frame
from relgloss_view.picture.scene.setting import Setting
from relgloss_view.quality.backends import FrameRenderer

LEAST_CONTRAST = 0.1  #: L*; less is no highlight to anyone
GRAIN_WEIGHT = 1.0  #: how much a grain as high as its highlight takes from log gloss
SHARPNESS_WEIGHT = 0.1  #: of the logarithm of the highlight's steepest slope over its contrast


@dataclass(frozen=True)
class Percept:
    """A picture as seen: log gloss, and grain as a share of the highlight's contrast."""

    log_gloss: float
    grain: float


def percept_of(frame: Frame) -> Percept:
    """What is seen in a frame, as the split shows it."""
    regions = Regions.of(frame)
    lightness = Split().draw(frame).lab[..., 0]
    body = np.asarray(frame.split[0], dtype=np.float64)
    # A highlight is seen against the body around it, not against the body's lightest place.
    contrast = max(peak_contrast(lightness - body, regions) or 0.0, LEAST_CONTRAST)
    grain = (grain_deviation(lightness, regions) or 0.0) / contrast
    slope = max(sharpness(lightness, regions) or 0.0, LEAST_CONTRAST)
    log_gloss = (
        math.log(contrast) - GRAIN_WEIGHT * grain + SHARPNESS_WEIGHT * math.log(slope / contrast)
    )
    return Percept(log_gloss, grain)


@dataclass(frozen=True)
class Percepts:
    """What is seen in all stimuli of a study, and in the pictures at its truths."""

    #: (samples, settings, 2): log gloss and grain.
    stimuli: Array
    truths: tuple[Setting, ...]  #: of each sample: the setting that is right
    targets: Array  #: (samples, 2): what is seen there


def see_study(
    renderer: FrameRenderer,
    study: Study,
    truths: Sequence[Setting],
    progress: ProgressReport = no_progress,
) -> Percepts:
    """Draw every stimulus, and each sample's truth, and see it."""
    settings = study.grid.settings
    stimuli = np.zeros((len(study.samples), len(settings), 2))
    for k, sample in enumerate(study.samples):
        for j, setting in enumerate(settings):
            done = (k + j / len(settings)) / len(study.samples)
            progress(done, f"{sample.label}, {setting.words}")
            stimuli[k, j] = _seen(renderer, study, k, setting)
    return Percepts(stimuli, tuple(truths), see_truths(renderer, study, truths))


def see_truths(renderer: FrameRenderer, study: Study, truths: Sequence[Setting]) -> Array:
    """(samples, 2): what is seen in the pictures that are right."""
    return np.array([_seen(renderer, study, k, truth) for k, truth in enumerate(truths)])


def _seen(renderer: FrameRenderer, study: Study, sample: int, setting: Setting) -> Array:
    seen = percept_of(draw_look(renderer, study, sample, setting))
    return np.array([seen.log_gloss, seen.grain])
