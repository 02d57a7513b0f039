"""What a simulated observer sees in a picture: a highlight, a grain, and the gloss of the two.

A model, not a measurement of people: it is there so that a study with a known answer can be run
from end to end. log G = log(contrast) + w3 log(sharpness / contrast) + grain_weight grain, contrast
being what the highlight adds to the body's own shading, where it adds most; grain is the deviation
from grain to grain in relation to that contrast. The measures are those of docs/operators.md, of
what the display shows.

Nobody measured whether the grain of a print raises or lowers gloss, so that there is no gloss here
without a stated grain_weight (docs/experiment.md, "Does grain raise gloss?").
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
SHARPNESS_WEIGHT = 0.1  #: of the logarithm of the highlight's steepest slope over its contrast
#: Grain lowers or raises log gloss; as much of gloss's range as bumps raise it in published
#: comparisons. For those who state none.
BOTH_SIGNS = (-4.0, 4.0)


@dataclass(frozen=True)
class Percept:
    """A picture as seen: its highlight, and grain as a share of the highlight's contrast."""

    highlight: float  #: log gloss of the highlight alone
    grain: float

    def log_gloss(self, grain_weight: float) -> float:
        """Of the whole; grain_weight: what a grain as high as its highlight adds to log gloss."""
        return self.highlight + grain_weight * self.grain


def percept_of(frame: Frame) -> Percept:
    """What is seen in a frame, as the split shows it."""
    regions = Regions.of(frame)
    lightness = Split().draw(frame).lab[..., 0]
    body = np.asarray(frame.split[0], dtype=np.float64)
    # A highlight is seen against the body around it, not against the body's lightest place.
    contrast = max(peak_contrast(lightness - body, regions) or 0.0, LEAST_CONTRAST)
    grain = (grain_deviation(lightness, regions) or 0.0) / contrast
    slope = max(sharpness(lightness, regions) or 0.0, LEAST_CONTRAST)
    return Percept(math.log(contrast) + SHARPNESS_WEIGHT * math.log(slope / contrast), grain)


@dataclass(frozen=True)
class Percepts:
    """What is seen in all stimuli of a study, and in the pictures at its truths."""

    #: (samples, settings, 2): log gloss of the highlight alone, and grain.
    stimuli: Array
    truths: tuple[Setting, ...]  #: of each sample: the setting that is right
    targets: Array  #: (samples, 2): what is seen there
    #: What a grain as high as its highlight adds to log gloss, for the observers in turn.
    grain_weights: tuple[float, ...]

    def __post_init__(self) -> None:
        if not self.grain_weights:
            raise ValueError("grain_weights: expected at least one")

    def grain_weight_of(self, observer: int) -> float:
        """That of the observer of a number; pairs of observers take turns, as do groups within."""
        return self.grain_weights[observer // 2 % len(self.grain_weights)]

    def seen_by(self, observer: int) -> tuple[Array, Array]:
        """Stimuli and targets as that observer sees them: log gloss and grain."""
        mixed = np.array([[1.0, self.grain_weight_of(observer)], [0.0, 1.0]]).T
        return self.stimuli @ mixed, self.targets @ mixed


def see_study(
    renderer: FrameRenderer,
    study: Study,
    truths: Sequence[Setting],
    grain_weights: Sequence[float],
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
    targets = see_truths(renderer, study, truths)
    return Percepts(stimuli, tuple(truths), targets, tuple(grain_weights))


def unseen(study: Study, truths: Sequence[Setting]) -> Percepts:
    """For observers who judge settings and see no picture: all that would be seen is NaN."""
    nothing = np.full((len(study.samples), len(study.grid), 2), np.nan)
    return Percepts(nothing, tuple(truths), nothing[:, 0], (np.nan,))


def see_truths(renderer: FrameRenderer, study: Study, truths: Sequence[Setting]) -> Array:
    """(samples, 2): what is seen in the pictures that are right."""
    return np.array([_seen(renderer, study, k, truth) for k, truth in enumerate(truths)])


def _seen(renderer: FrameRenderer, study: Study, sample: int, setting: Setting) -> Array:
    seen = percept_of(draw_look(renderer, study, sample, setting))
    return np.array([seen.highlight, seen.grain])
