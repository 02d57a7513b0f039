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
from numpy.typing import NDArray

from relgloss_view.base.errors import InputError
from relgloss_view.experiment.design.study import ADAPTIVE, RATIO
from relgloss_view.experiment.scaling.fine_grid import FineGrid
from relgloss_view.experiment.scaling.ordinal import OrdinalScale, ordinal_scale
from relgloss_view.experiment.scaling.successive_categories import (
    SuccessiveScale,
    Zero,
    successive_categories,
)
from relgloss_view.experiment.scaling.unfolding import fit_unfolding
from relgloss_view.experiment.session.adaptive import Posterior
from relgloss_view.experiment.session.pool import Answers, Pool
from relgloss_view.experiment.verdict.adaptive import AdaptiveVerdict, judged_adaptively
from relgloss_view.experiment.verdict.agreement import (
    kendall_w,
    krippendorff_alpha,
    no_difference_p,
)
from relgloss_view.experiment.verdict.full_grid import LEVEL, Smooth, Verdict, judged
from relgloss_view.experiment.verdict.screening import ObserverResult, judged_observers

Array = NDArray[np.float64]

DRAWS = 1000
MOST_DRAWS = 20_000  #: each keeps the smooth fit of a fine grid: about half a gigabyte
JOINT = "both"  #: the ratio and the grain together


@dataclass(frozen=True)
class Scale:
    """Closeness of the settings to one question, larger is closer, and how sure it is."""

    question: str
    probit: OrdinalScale
    torgerson: SuccessiveScale
    answered: NDArray[np.bool_]  #: (J,), settings that somebody judged
    interval: Array | None  #: (2, J), 95 %, of the probit scale
    bounds_interval: Array | None  #: (2, K-1)
    draws: Array | None  #: (B, J), of the probit scale; the mean is 0 in each
    smooth: Smooth  #: the smooth fit

    @property
    def scale(self) -> Array:
        """(J,), the probit scale, NaN without answers."""
        return np.where(self.answered, self.probit.scale, np.nan)


@dataclass(frozen=True)
class SampleResult:
    """What a study tells of one sample."""

    label: str
    answers: int
    observers: int  #: who answered about it
    p: dict[str, float]  #: by question, and JOINT: of such answers where settings do not differ
    scales: tuple[Scale, ...]  #: one a question
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
    untold: dict[str, str]  #: samples by label of which nothing can be told, and why


def analyse(
    pool: Pool,
    options: Options = Options(),
    progress: Callable[[float, str], object] = lambda share, text: None,
) -> Analysis:
    """Analyse a pool; the same pool and options give the same analysis.

    A sample about which all answers are the same, or none are there, is named in `untold`.
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
            untold[named.label] = f"all answers are {name!r}, which tells no setting from another"
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
        judged_observers(pool, options.seed),
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
        adaptive = judged_adaptively(posterior, study.grid, level)
    weights = _resampled(ratio, options)
    questions = [q for q in study.questions if len(np.unique(pool.answers(sample, q).category)) > 1]
    scales = []
    fine = FineGrid(study.grid)
    for k, question in enumerate(questions):

        def share(done: float, k: int = k) -> None:
            progress((k + done) / len(questions))

        answers = pool.answers(sample, question)
        scales.append(_scale(fine, question, answers, weights, options, share))
    by_question = {q: pool.answers(sample, q) for q in questions}
    p = {
        q: no_difference_p(a.observer, a.setting, a.category, options.seed)
        for q, a in by_question.items()
    }
    observers = {q: len(np.unique(a.observer)) for q, a in by_question.items()}
    verdicts = {
        s.question: judged(
            study.grid, s.scale, s.draws, s.smooth, p[s.question], level, observers[s.question]
        )
        for s in scales
    }
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
            verdicts[JOINT] = judged(study.grid, total, both, smooth, p[JOINT], level, least)
    ratings = ratio.ratings()
    return SampleResult(
        label,
        len(ratio.category),
        len(np.unique(ratio.observer)),
        p,
        tuple(scales),
        verdicts,
        adaptive,
        krippendorff_alpha(ratings),
        kendall_w(ratings[np.any(np.isfinite(ratings), axis=1)]),
    )


def _resampled(answers: Answers, options: Options) -> Array | None:
    """(draws, observers) how often each observer is drawn; None where there is but one.

    Drawn from those who answered about the sample.
    """
    present = np.unique(answers.observer)
    draws = options.draws
    if len(present) < 2 or draws < 1:
        return None
    random = np.random.default_rng(options.seed)
    number = len(present)
    weights = np.zeros((draws, answers.observers))
    weights[:, present] = random.multinomial(number, np.full(number, 1.0 / number), size=draws)
    return weights


def _scale(
    fine: FineGrid,
    question: str,
    answers: Answers,
    weights: Array | None,
    options: Options,
    progress: Callable[[float], object],
) -> Scale:
    counts, observer_effects = answers.counts(), options.observer_effects
    pooled = counts.sum(axis=0)
    probit = ordinal_scale(
        counts if observer_effects else pooled, observer_effects=observer_effects
    )
    try:
        torgerson = successive_categories(pooled, options.zero)
    except InputError:  # every proportion is 0 or 1, and those are left out
        nothing = np.full(len(pooled), np.nan)
        torgerson = SuccessiveScale(nothing, np.full(pooled.shape[1] - 1, np.nan))
    answered = pooled.sum(axis=1) > 0.0
    unfolding = fit_unfolding(fine.grid, pooled)
    closeness = unfolding.closeness(fine.points)
    if weights is None:
        smooth = Smooth(fine, closeness, None)
        return Scale(question, probit, torgerson, answered, None, None, None, smooth)
    drawn = np.full((len(weights), len(pooled)), np.nan)
    bounds = np.full((len(weights), pooled.shape[1] - 1), np.nan)
    surfaces = np.zeros((len(weights), len(fine.points)))
    for k, weight in enumerate(weights):
        if k % 20 == 0:
            progress(k / len(weights))
        weighted = weight[:, None, None] * counts
        total = weighted.sum(axis=0)
        surfaces[k] = fit_unfolding(fine.grid, total, unfolding).closeness(fine.points)
        try:
            fit = ordinal_scale(
                weighted if observer_effects else total,
                observer_effects=observer_effects,
                start=probit,
            )
        except InputError:
            continue  # those drawn gave one answer only: nothing is told apart
        drawn[k] = np.where(total.sum(axis=1) > 0.0, fit.scale, np.nan)
        bounds[k] = fit.bounds
    return Scale(
        question,
        probit,
        torgerson,
        answered,
        _interval(drawn),
        _interval(bounds),
        drawn,
        Smooth(fine, closeness, surfaces),
    )


def _interval(draws: Array) -> Array:
    """(2, n) ends of the central 95 % of draws (B, n); NaN where no draw has a value."""
    found = np.full((2, draws.shape[1]), np.nan)
    for k, column in enumerate(draws.T):
        there = column[np.isfinite(column)]
        if there.size:
            found[:, k] = np.quantile(there, (0.025, 0.975))
    return found
