"""The choice of a model, and of whether the instrument has errors: both by what is held out.

The ladder is climbed with the instrument in order. Then its errors are freed, in the models of
neutral lobes; only where they predict held-out planes better than the chosen model does, by more
than one standard error and by an amount that matters, the table is corrected for them and the
ladder climbed again. A model that is wrong in its tails would otherwise bend the instrument.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from relgloss_view.base.arrays import Array, Mask
from relgloss_view.base.terminal import ProgressReport
from relgloss_view.fitting import ladder, metal
from relgloss_view.fitting.descent import refine
from relgloss_view.fitting.instrument import ACROSS_ALL, PINNED, corrected
from relgloss_view.fitting.ladder import Candidate, Folds
from relgloss_view.fitting.limits import OPTICAL_INDEX, at_limits
from relgloss_view.fitting.model import Rung, State, log_residual, predict
from relgloss_view.fitting.observations import TAU, Observations, compress, prepare
from relgloss_view.fitting.problem import Problem
from relgloss_view.fitting.verdict import main_lobe
from relgloss_view.measure.table import Measurement

#: Share of the chosen model's held-out error that errors of the instrument must gain.
RELEVANT_SHARE_ERRORS = 0.04
#: ... and what freeing more of them must gain against one alone, or against all but the apertures:
#: one that is in order would follow what the model lacks, as the apertures' blur a lobe's tails.
RELEVANT_SHARE_MORE = 0.25
_FIRST_TILT = 1.5  #: prior standard deviations
_FIRST_SPREAD = 1.2  #: of the logarithm: a full width that was declared as a deviation, reversed
_LEAST_NOISE = 0.005
_ROUNDS = 3  #: of corrections: the errors are first-order about the geometry


@dataclass(frozen=True)
class Options:
    """What a caller asks of the choice."""

    rungs: tuple[Rung, ...]
    index: float
    free_index: bool
    free_errors: bool
    seed: int
    start_s_deg: float | None
    progress: ProgressReport | None
    metals: str = "auto"  #: tried where a colour shows, or 'none', or the name of the one rung


@dataclass(frozen=True)
class Choice:
    """The chosen candidate among those that were tried, on a measurement that may be corrected."""

    measurement: Measurement
    full: Observations  #: all bands
    few: Observations  #: the bands of the search
    candidates: tuple[Candidate, ...]
    folds: Folds
    best: Candidate
    errors: Array  #: (K,), of the instrument, which the measurement is corrected for; empty: none
    other: Candidate | None = None  #: the same with its refractive index free, which gained less
    rival: Rival | None = None  #: another explanation, where the samples hardly tell the two apart


@dataclass(frozen=True)
class Rival:
    """Errors of the instrument where an index was chosen, or the other way about.

    Both change how a narrow highlight grows with incidence.
    """

    candidate: Candidate
    errors: Array  #: (K,), of the instrument
    index: float  #: refractive index of the explanation that has one
    likelihood: float  #: against the chosen one, by what is held out; at most 1


def choose(measurement: Measurement, options: Options) -> Choice:
    """Climb the ladder, with the instrument in order and, where that predicts better, without."""
    full = prepare(measurement, options.seed)
    choice = _climbed(measurement, full, np.zeros(0), options, (0.0, 0.5))
    if not options.free_errors or not len(full.prior_sd):
        return choice
    ladder.report(options.progress, 0.6, "errors of the instrument")
    errors, found = _errors(choice, options)
    if not errors.size:
        return choice if found is None else replace(choice, rival=_rival(choice.best, found, found))
    moved = corrected(measurement, errors)
    full = replace(prepare(moved, options.seed), noise=choice.few.noise, prior_centre=-errors)
    climbed = _climbed(moved, full, errors, options, (0.6, 0.9))
    if found is None or not choice.best.rung.free_index:
        return climbed
    return replace(climbed, rival=_rival(found, choice.best, found))


def _rival(chosen: Candidate, other: Candidate, with_errors: Candidate) -> Rival | None:
    """The other explanation, if one of the two is a fitted index; None else."""
    index = next((c for c in (chosen, other) if c.rung.free_index), None)
    if index is None or chosen.rung.lobes != other.rung.lobes:
        return None
    mean, se = ladder.gain(other, chosen)
    worse = max(mean, 0.0) / max(se, 1e-12)
    return Rival(
        other,
        with_errors.solution.state.errors,
        float(index.solution.state.n[main_lobe(index.solution.state)]),
        float(np.exp(-0.5 * worse**2)),
    )


def _climbed(
    measurement: Measurement,
    full: Observations,
    errors: Array,
    options: Options,
    shares: tuple[float, float],
) -> Choice:
    few = compress(full)
    report = options.progress

    def progress(share: float, text: str) -> bool:
        at = shares[0] + share * (shares[1] - shares[0])
        return report is None or report(at, text) is not False

    candidates, folds = ladder.climb(
        few, options.rungs, options.index, progress, options.start_s_deg
    )
    candidates = metal.with_metals(folds, candidates, options.metals)
    best, other = candidates[ladder.choose(candidates)], None
    if options.free_index:
        held = metal.dielectric_of(candidates, best)
        freed = ladder.free_index(folds, held)
        if freed is not None:
            candidates.insert(candidates.index(held) + 1, freed)
            best, other = _with_index(best, freed)
    noise = _noise(few, best.solution.state)
    full, few = replace(full, noise=noise), replace(few, noise=noise)
    folds = replace(folds, observations=few)
    return Choice(measurement, full, few, tuple(candidates), folds, best, errors, other)


def _with_index(best: Candidate, freed: Candidate) -> tuple[Candidate, Candidate | None]:
    """The better of the chosen candidate and of one whose index is free, and a likely other.

    An index that no dielectric has stands in for what the model lacks, so it must gain more; that
    of a second lobe may not have one at all.
    """
    state = freed.solution.state
    if at_limits(freed.rung, state):
        return best, None
    usual = (state.n >= OPTICAL_INDEX[0]) & (state.n <= OPTICAL_INDEX[1])
    main = main_lobe(state)
    if not np.all(usual[np.arange(len(usual)) != main]):
        return best, None
    share = ladder.RELEVANT_SHARE_INDEX if usual[main] else ladder.RELEVANT_SHARE_ODD_INDEX
    if at_limits(best.rung, best.solution.state):
        # A lobe at its widest stands in for an index that was held.
        near = freed.cv_mean <= (1.0 + ladder.LIMIT_COST) * best.cv_mean + ladder.RELEVANT
        return (freed if near else best), None
    mean, se = ladder.gain(best, freed)
    certain = mean > (ladder.CERTAIN_INDEX if usual[main] else 1.0) * se
    if certain and mean > share * best.cv_mean:
        return freed, None
    return best, (freed if usual[main] else None)


def _errors(choice: Choice, options: Options) -> tuple[Array, Candidate | None]:
    """The errors of the instrument (K,) that predict better than the chosen model, or none.

    And the candidate that has them, where they explain something though the chosen does it as well.
    """
    measurement, few, folds = choice.measurement, choice.few, choice.folds
    neutral = [
        c for c in choice.candidates
        if c.rung.lobes and not c.rung.own and not c.rung.free_index
    ]  # fmt: skip
    freed = [with_errors(folds, c) for c in neutral if np.any(c.solution.state.ks > 0.0)]
    if not freed:
        return np.zeros(0), None
    found = min(freed, key=lambda c: c.cv_mean)
    plain = min(neutral, key=lambda c: c.cv_mean)
    if ladder.enough(plain, found, RELEVANT_SHARE_ERRORS):
        return np.zeros(0), None
    # The fewest errors that explain it.
    held = next(c for c in neutral if replace(c.rung, errors=found.rung.errors) == found.rung)
    count = len(few.prior_sd)
    free = np.full(count, True)
    for some in (*np.eye(count, dtype=bool), np.arange(count) < count - 1):
        fewer = with_errors(folds, held, some)
        if ladder.enough(fewer, found, RELEVANT_SHARE_MORE):
            found, free = fewer, some
            break
    if ladder.enough(choice.best, found, RELEVANT_SHARE_ERRORS):
        return np.zeros(0), found
    chosen, errors = found, found.solution.state.errors
    # Exact directions instead of the first order about those of the table.
    for _ in range(_ROUNDS - 1):
        moved = replace(
            compress(prepare(corrected(measurement, errors), options.seed)),
            noise=few.noise,
            prior_sd=_held(few.prior_sd, free),
            prior_centre=-errors,
        )
        start = replace(found.solution.state, errors=np.zeros(len(errors)))
        more = refine(Problem(moved, found.rung), [start])[0].state
        found = replace(found, solution=replace(found.solution, state=more))
        errors = errors + more.errors
    return np.asarray(errors), chosen


def with_errors(folds: Folds, candidate: Candidate, free: Mask | None = None) -> Candidate:
    """The same rung, which has a lobe, with the errors of the instrument free, cross-validated.

    free: (K,), those that are; without it all.
    """
    few = folds.observations
    if free is not None:
        few = replace(few, prior_sd=_held(few.prior_sd, free))
        folds = replace(folds, observations=few)
    count = len(few.prior_sd)
    rung = replace(candidate.rung, errors=count)
    starts = [np.zeros(count)]
    for k in [k for k, name in enumerate(few.error_names) if name in ACROSS_ALL]:
        # A tilt across all planes lowers the peak by its square: it is found from either side.
        far = np.where(np.arange(count) == k, _FIRST_TILT * few.prior_sd, 0.0)
        starts += [far, -far]
    # Apertures far too narrow to matter show no slope towards those that would.
    starts.append(np.where(np.arange(count) == count - 1, _FIRST_SPREAD, 0.0))
    state = candidate.solution.state
    solutions = refine(Problem(few, rung), [replace(state, errors=errors) for errors in starts])
    return ladder.evaluate(folds, rung, min(solutions, key=lambda s: s.loss))


def _held(prior_sd: Array, free: Mask) -> Array:
    """The priors where all but the marked errors are held."""
    return np.where(free, prior_sd, PINNED * prior_sd)


def _noise(few: Observations, state: State) -> float:
    """Standard deviation of the logarithmic residuals of most samples, within what is likely."""
    residual = log_residual(few, predict(few.geometry, state))[few.weight > 0.0]
    return float(np.clip(1.4826 * np.median(np.abs(residual)), _LEAST_NOISE, TAU))
