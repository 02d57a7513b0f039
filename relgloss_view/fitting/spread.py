"""A chosen model where what the samples may not show is otherwise: how far its numbers go.

The errors of the instrument are freed, under their priors. Then each of them, and the refractive
index where it is held, is put at several values and the rest is fitted again; how likely a value
still is weighs it. The zero level of the readings is moved by what it is known to.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.fitting.descent import refine
from relgloss_view.fitting.ladder import FOLD_ROUNDS, Candidate, Folds, Held, evaluate
from relgloss_view.fitting.model import State, States
from relgloss_view.fitting.observations import Observations
from relgloss_view.fitting.problem import Problem

#: Of a prior's standard deviation: where the unknowns are found again.
HELD_SD = np.array([-2.0, -1.0, 1.0, 2.0])
#: Of a held refractive index: coatings, inks and varnishes have 1.4 to 1.6.
INDEX_SD = 0.05
#: Of the zero level of a table's readings, in radiance factor: dark current and stray light of a
#: goniophotometer leave some tenths of a percent of the perfect diffuser.
OFFSET_SD = 0.003
_DARKEST = 1e-6


def spread(folds: Folds, candidate: Candidate, *, errors: bool, index: bool) -> Candidate:
    """The candidate with what its samples may leave open.

    errors: whether those of the instrument are freed; index: whether a held refractive index is
    uncertain. Its rung frees the errors where it has a lobe to see them by.
    """
    observations = folds.observations
    count = len(observations.prior_sd) if errors and candidate.rung.lobes else 0
    if count:
        rung = replace(candidate.rung, errors=count)
        start = replace(candidate.solution.state, errors=np.zeros(count))
        candidate = evaluate(folds, rung, refine(Problem(observations, rung), [start])[0])
    held = _held_errors(observations, candidate) if count else ()
    if index and candidate.rung.lobes and not candidate.rung.free_index:
        held = (*held, _held_index(observations, candidate))
    offset_states = _offset_states(observations, candidate)
    return replace(candidate, held=held, offset_states=offset_states)


def _held_errors(observations: Observations, candidate: Candidate) -> tuple[Held, ...]:
    problem = Problem(observations, candidate.rung)
    count, nodes = candidate.rung.errors, len(HELD_SD)
    error = np.repeat(np.arange(count), nodes)
    value = np.tile(HELD_SD, count) * observations.prior_sd[error]
    starts = []
    for k, v in zip(error.tolist(), value.tolist(), strict=True):
        errors = candidate.solution.state.errors.copy()
        errors[k] = v
        starts.append(replace(candidate.solution.state, errors=errors))
    states = [s.state for s in refine(problem.pinned(error, value), starts, FOLD_ROUNDS)]
    likelihood = _likelihoods(problem, observations, candidate, states)
    parts = [slice(k * nodes, (k + 1) * nodes) for k in range(count)]
    return tuple(Held(tuple(states[p]), tuple(likelihood[p].tolist())) for p in parts)


def _held_index(observations: Observations, candidate: Candidate) -> Held:
    problem = Problem(observations, candidate.rung)
    start = candidate.solution.state
    values = HELD_SD * INDEX_SD
    starts = [replace(start, n=np.maximum(start.n + v, 1.01)) for v in values.tolist()]
    # Each index in a problem of its own: one whose indices differ forms each reflectance anew.
    states = [refine(problem, [s], FOLD_ROUNDS)[0].state for s in starts]
    prior = np.exp(-0.5 * HELD_SD**2)
    likelihood = prior * _likelihoods(problem, observations, candidate, states)
    return Held(tuple(states), tuple(likelihood.tolist()))


def _likelihoods(
    problem: Problem, observations: Observations, candidate: Candidate, states: list[State]
) -> Array:
    """Of states against the solution, at most 1: what one sample weighs sets the scale."""
    stacked = States.of(states)
    _, misfit = problem.reweighted(problem.columns_of(stacked), stacked)
    rise = (misfit.loss - candidate.solution.loss) / observations.sample_weight
    return np.asarray(np.exp(-np.maximum(rise, 0.0)))


def _offset_states(observations: Observations, candidate: Candidate) -> tuple[State, ...]:
    """The unknowns where the zero level of all readings is off by its standard deviation."""
    states = []
    for side in (-1.0, 1.0):
        seen = observations.value > 0.0
        moved = np.maximum(observations.value + side * OFFSET_SD, _DARKEST)
        problem = Problem(replace(observations, value=np.where(seen, moved, 0.0)), candidate.rung)
        states.append(refine(problem, [candidate.solution.state], FOLD_ROUNDS)[0].state)
    return tuple(states)
