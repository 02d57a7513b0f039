"""A chosen model where what the samples may not show is otherwise: how far its numbers go.

Each error of the instrument, and the refractive index where it is held, is put at several values
and the rest is fitted again; how likely a value still is weighs it. Another explanation of the
table that is as likely is one such value. What moves all readings together is moved by what it is
known to.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.fitting.choice import Choice
from relgloss_view.fitting.descent import refine
from relgloss_view.fitting.ladder import FOLD_ROUNDS, Candidate, Held, evaluate
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
DISPERSION_SD = 0.012  #: of an index that is fitted as one to all bands
_DARKEST = 1e-6


def spread(choice: Choice, *, errors: bool, index: bool) -> Candidate:
    """The chosen candidate with what its samples may leave open.

    errors: whether those of the instrument are uncertain; index: whether a held refractive index
    is. Where the choice found errors, its folds find their own.
    """
    observations, candidate = choice.few, choice.best
    if not candidate.rung.lobes:
        return replace(candidate, shared_states=_shared_states(observations, candidate))
    metal = candidate.rung.metals > 0  # which has no index, and whose errors none has worked out
    count = len(observations.prior_sd) if errors and not metal else 0

    def at_rest(states: Iterable[State]) -> tuple[State, ...]:
        """The states with all errors of the instrument zero."""
        return tuple(replace(state, errors=np.zeros(count)) for state in states)

    rung = replace(candidate.rung, errors=count)
    (state,) = at_rest([candidate.solution.state])
    resting = replace(candidate, rung=rung, solution=replace(candidate.solution, state=state))
    held = _held_errors(observations, resting) if count else ()
    if index and not metal and not candidate.rung.free_index:
        others = _held_index(observations, candidate)
        held = (*held, replace(others, states=at_rest(others.states)))
    rival = choice.rival
    if rival is not None and rival.candidate.rung.lobes == candidate.rung.lobes and not metal:
        held = (*held, Held(at_rest([rival.candidate.solution.state]), (rival.likelihood,)))
    if count and choice.errors.size:
        folds = evaluate(choice.folds, rung, resting.solution).fold_states
    else:
        folds = at_rest(candidate.fold_states)
    pairs = [at_rest(pair) for pair in _shared_states(observations, candidate)]
    return replace(
        resting,
        fold_states=folds,
        held=held,
        shared_states=tuple((low, high) for low, high in pairs),
    )


def _held_errors(observations: Observations, candidate: Candidate) -> tuple[Held, ...]:
    """Each error at its prior's nodes, the others at rest."""
    problem = Problem(observations, candidate.rung)
    count, nodes = candidate.rung.errors, len(HELD_SD)
    centre = problem.prior.centre[0]
    error = np.repeat(np.arange(count), nodes)
    errors = np.zeros((count * nodes, count))
    values = np.tile(HELD_SD, count) * observations.prior_sd[error] + centre[error]
    errors[np.arange(len(error)), error] = values
    starts = [replace(candidate.solution.state, errors=e) for e in errors]
    states = [s.state for s in refine(problem.pinned(errors), starts, FOLD_ROUNDS)]
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
    stacked = States.of([candidate.solution.state, *states])
    _, misfit = problem.reweighted(problem.columns_of(stacked), stacked)
    rise = (misfit.loss[1:] - misfit.loss[0]) / observations.sample_weight
    return np.asarray(np.exp(-np.maximum(rise, 0.0)))


def _shared_states(
    observations: Observations, candidate: Candidate
) -> tuple[tuple[State, State], ...]:
    """What moves all samples together, by a standard deviation to either side.

    The zero level of the readings; and, where one index is fitted to all bands, its dispersion: a
    coating's index falls by some 0.02 over the visible (Cauchy's coefficients of polymers; Kasarova
    et al. 2007).
    """
    start, ends = candidate.solution.state, []
    for side in (-1.0, 1.0):
        value = observations.value
        moved = np.maximum(value + side * OFFSET_SD, np.where(value > 0.0, _DARKEST, -np.inf))
        # A value below zero is noise, which moves as others do, as far as its floor reaches.
        moved = np.where(value < 0.0, np.maximum(moved, -0.9 * observations.floor), moved)
        moved = np.where(value == 0.0, 0.0, moved)
        problem = Problem(replace(observations, value=moved), candidate.rung)
        ends.append(refine(problem, [start], FOLD_ROUNDS)[0].state)
    pairs = [(ends[0], ends[1])]
    if candidate.rung.free_index:
        problem = Problem(observations, replace(candidate.rung, free_index=False))
        ends = [
            refine(problem, [replace(start, n=start.n + n)], FOLD_ROUNDS)[0].state
            for n in (-DISPERSION_SD, DISPERSION_SD)
        ]
        pairs.append((ends[0], ends[1]))
    return tuple(pairs)
