"""The analysis of a study: scales, bounds, what is best for each sample, and who agrees with whom.

Defined in docs/experiment.md. The method of successive categories twice: least squares under
Torgerson's condition D, as in the paper, and maximum likelihood of the ordinal probit model, which
the verdicts follow. Uncertainty is that over observers: they are drawn again with replacement
(Efron 1979).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from relgloss_view.base.terminal import ProgressReport, no_progress
from relgloss_view.experiment.design.study import ADAPTIVE, RATIO
from relgloss_view.experiment.scaling.bootstrap import ScaleValues, observer_weights, scale_values
from relgloss_view.experiment.scaling.fine_grid import FineGrid
from relgloss_view.experiment.scaling.successive_categories import Zero
from relgloss_view.experiment.session.pool import Pool
from relgloss_view.experiment.session.posterior import Posterior
from relgloss_view.experiment.verdict.adaptive import AdaptiveVerdict, adaptive_verdict
from relgloss_view.experiment.verdict.agreement import (
    kendall_w,
    krippendorff_alpha,
    no_difference_p,
)
from relgloss_view.experiment.verdict.full_grid import LEVEL, Verdict, verdict_on
from relgloss_view.experiment.verdict.groups import mixed_groups
from relgloss_view.experiment.verdict.screening import ObserverResult, observer_results

DRAWS = 1000
MOST_DRAWS = 20_000  #: each keeps the smooth fit of a fine grid: about half a gigabyte
JOINT = "both"  #: the ratio and the grain together


@dataclass(frozen=True)
class SampleResult:
    """What a study tells of one sample."""

    label: str
    answers: int
    observers: int  #: who answered about it
    p: dict[str, float]  #: by question, and JOINT: of such answers where settings do not differ
    scales: tuple[ScaleValues, ...]  #: one a question
    verdicts: dict[str, Verdict]  #: by question; JOINT too where both were asked
    adaptive: AdaptiveVerdict | None  #: of an adaptive study
    alpha: float | None  #: Krippendorff's, ordinal
    w: float | None  #: Kendall's

    @property
    def decided_by(self) -> str:
        """The question whose verdict chooses the setting."""
        return JOINT if JOINT in self.verdicts else RATIO

    @property
    def p_chance(self) -> float:
        """Of the question whose verdict chooses."""
        return self.p[self.decided_by]

    @property
    def verdict(self) -> Verdict:
        """The verdict that chooses the setting of a full-grid study."""
        return self.verdicts[self.decided_by]


@dataclass(frozen=True)
class Options:
    """How an analysis is made."""

    draws: int = DRAWS  #: of the bootstrap over observers
    seed: int = 0  #: of the bootstrap and the permutations
    observer_effects: bool = False  #: a location of each observer in the probit model
    zero: Zero = "clip"  #: what condition D does with proportions of 0 and 1


@dataclass(frozen=True)
class Analysis:
    """A whole study, analysed."""

    pool: Pool
    samples: tuple[SampleResult, ...]
    observers: tuple[ObserverResult, ...]
    options: Options
    level: float  #: that p_chance is held against
    unscaled: dict[str, str]  #: samples by label of which nothing can be told, and why


def analyse(
    pool: Pool,
    options: Options = Options(),
    progress: ProgressReport = no_progress,
) -> Analysis:
    """Analyse a pool; the same pool and options give the same analysis.

    A sample about which all answers are the same, or none are there, is named in `unscaled`.
    """
    study = pool.study
    level = LEVEL / len(study.samples)
    untold = {}
    asked = []
    for sample, named in enumerate(study.samples):
        categories = np.unique(pool.answers(sample, RATIO).category)
        if len(categories) > 1:
            asked.append(sample)
        elif len(categories) == 1:
            name = study.categories[categories[0]]
            untold[named.label] = f"all answers are {name!r}, which separates no settings"
        else:
            untold[named.label] = "nobody has judged it yet"
    results = []
    for number, sample in enumerate(asked):
        label = study.samples[sample].label

        def report(share: float, done: int = number, label: str = label) -> None:
            progress((done + share) / len(asked), label)

        results.append(_sample(pool, sample, options, level, report))
    return Analysis(
        pool,
        tuple(results),
        observer_results(pool, options.seed),
        options,
        level,
        untold,
    )


def _sample(
    pool: Pool,
    sample: int,
    options: Options,
    level: float,
    progress: Callable[[float], object],
) -> SampleResult:
    study = pool.study
    ratio = pool.answers(sample, RATIO)
    label = study.samples[sample].label
    adaptive = None
    if study.procedure.design == ADAPTIVE:
        posterior = Posterior(study.grid, len(study.categories))
        posterior.update(list(zip(ratio.setting.tolist(), ratio.category.tolist(), strict=True)))
        adaptive = adaptive_verdict(posterior, study.grid, level)
    weights = observer_weights(ratio, options.draws, options.seed)
    questions = [q for q in study.questions if len(np.unique(pool.answers(sample, q).category)) > 1]
    scales = []
    fine = FineGrid(study.grid)
    for k, question in enumerate(questions):

        def share(done: float, k: int = k) -> None:
            progress((k + done) / len(questions))

        answers = pool.answers(sample, question)
        scales.append(
            scale_values(
                fine,
                question,
                answers,
                weights,
                observer_effects=options.observer_effects,
                zero=options.zero,
                progress=share,
            )
        )
    by_question = {q: pool.answers(sample, q) for q in questions}
    p = {
        q: no_difference_p(a.observer, a.setting, a.category, options.seed)
        for q, a in by_question.items()
    }
    observers = {q: len(np.unique(a.observer)) for q, a in by_question.items()}
    groups = {}
    if weights is not None and adaptive is None:
        groups = {q: mixed_groups(fine, a, options.seed) for q, a in by_question.items()}
    alike = {q: np.max(np.bincount(a.category)) / len(a.category) for q, a in by_question.items()}
    verdicts = {
        s.question: verdict_on(
            study.grid, s.scale, s.draws, s.smooth, p[s.question], level, observers[s.question],
            groups=groups.get(s.question), places=s.places, alike=float(alike[s.question]),
        )
        for s in scales
    }  # fmt: skip
    if len(scales) == 2:
        first, second = scales
        total = first.scale + second.scale
        both = None
        if first.draws is not None and second.draws is not None:
            both = first.draws + second.draws
        if np.any(np.isfinite(total)):
            # A point needs both: where either may be chance, so may the whole.
            p[JOINT] = max(p.values())
            smooth, least = first.smooth.plus(second.smooth), min(observers.values())
            verdicts[JOINT] = verdict_on(
                study.grid, total, both, smooth, p[JOINT], level, least,
                groups=next((g for g in groups.values() if g is not None), None),
                alike=float(min(alike.values())),
            )  # fmt: skip
    ratings = ratio.ratings()
    return SampleResult(
        label=label,
        answers=len(ratio.category),
        observers=len(np.unique(ratio.observer)),
        p=p,
        scales=tuple(scales),
        verdicts=verdicts,
        adaptive=adaptive,
        alpha=krippendorff_alpha(ratings),
        w=kendall_w(ratings[np.any(np.isfinite(ratings), axis=1)]),
    )
