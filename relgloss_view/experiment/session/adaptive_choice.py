"""Which setting an observer of an adaptive study judges next.

It is drawn by Thompson sampling (Thompson 1933): the setting nearest to a point that the posterior
of the sample draws.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from relgloss_view.experiment.design.study import RATIO, Study
from relgloss_view.experiment.design.trial_order import Trial, sample_order
from relgloss_view.experiment.session.posterior import Posterior
from relgloss_view.experiment.session.records import Answer

OF_CHOICES = 4  #: what a seed is for; see trial_order.py


class AdaptiveChoice:
    """Chooses the trials of an adaptive study; keeps what it has worked out between them."""

    def __init__(self, study: Study) -> None:
        self._study = study
        self._posteriors: dict[int, Posterior] = {}

    def next(self, ordinal: int, answers: Sequence[Answer]) -> Trial | None:
        """The next trial of an observer from all observers' answers; None when all is asked.

        A sample is through when this observer has seen `adaptive.trials` of it, or when all
        observers together have told enough.
        """
        study = self._study
        own = [a for a in answers if a.observer == ordinal and a.question == RATIO]
        position = 1 + max((a.trial.position for a in own), default=-1)
        for sample in sample_order(study, ordinal):
            seen = [a.trial.setting for a in own if a.trial.sample == sample]
            if len(seen) >= study.adaptive.trials:
                continue
            posterior = self.posterior(sample, answers)
            width = study.adaptive.interval_steps
            if max(posterior.estimate().width_steps) <= width:
                continue
            seed = [study.procedure.seed, OF_CHOICES, ordinal, position]
            setting = posterior.draw(np.random.default_rng(seed))
            return Trial(position, sample, setting, seen.count(setting))
        return None

    def posterior(self, sample: int, answers: Sequence[Answer]) -> Posterior:
        """The posterior of a sample from all answers about its ratio of gloss."""
        if sample not in self._posteriors:
            self._posteriors[sample] = Posterior(self._study.grid, len(self._study.categories))
        of_sample = self._posteriors[sample]
        of_sample.update(
            [
                (a.trial.setting, a.category)
                for a in answers
                if a.trial.sample == sample and a.question == RATIO
            ]
        )
        return of_sample
