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
from relgloss_view.fitting.descent import gauss_newton_step, refine
from relgloss_view.fitting.ladder import FOLD_ROUNDS, Candidate, Held, evaluate
from relgloss_view.fitting.model import Rung, State, States, influence
from relgloss_view.fitting.observations import Observations, compress
from relgloss_view.fitting.problem import Equations, Problem

#: Of a prior's standard deviation: where the unknowns are found again.
HELD_SD = np.array([-2.0, -1.0, 1.0, 2.0])
#: Of a held refractive index: coatings, inks and varnishes have 1.4 to 1.6.
INDEX_SD = 0.05
#: Of the zero level of a table's readings, in radiance factor: dark current and stray light of a
#: goniophotometer leave some tenths of a percent of the perfect diffuser.
OFFSET_SD = 0.003
DISPERSION_SD = 0.012  #: of an index that is fitted as one to all bands
_DARKEST = 1e-6


def spread(choice: Choice, whole: Observations, *, errors: bool, index: bool) -> Candidate:
    """The chosen candidate with what its samples may leave open.

    whole: what it was refined on, which is more than its choice was made on where that was a part.
    errors: whether those of the instrument are uncertain; index: whether a held refractive index
    is. Where the choice found errors, its folds find their own.
    """
    observations, candidate = choice.few, choice.best
    part = choice.measurement.stands_for is not None
    few = compress(whole, like=choice.full) if part else observations
    few = replace(few, prior_centre=observations.prior_centre)
    if part:
        candidate = replace(candidate, fold_states=without_each_group(candidate, few))
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
    if count and choice.errors.size and part:
        folds = without_each_group(resting, few)
    elif count and choice.errors.size:
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


def without_each_group(candidate: Candidate, whole: Observations) -> tuple[State, ...]:
    """States of a chosen model without each group of a table that is larger than its own samples.

    whole: all that the model was refined on. Each state is one step of Newton from the candidate's,
    with equations that are summed group by group (the infinitesimal jackknife's finite form;
    Giordano et al. 2019): one pass over the whole instead of one fit for each group.
    """
    rung, solution = candidate.rung, candidate.solution.state
    problem = Problem(whole, rung)
    start = States.of([solution])
    start, _ = problem.reweighted(problem.columns_of(start), start)
    parts = []
    for group in range(whole.groups):
        rows = whole.group == group
        if np.any(whole.weight[rows] > 0.0):
            parts.append(_newton(whole.subset(rows), rung, start))
    states = []
    total = [sum(arrays) for arrays in zip(*parts, strict=True)]
    for part in parts:
        rest = Equations(*(a - b for a, b in zip(total, part, strict=True)))
        none = np.zeros(1)
        states.append(gauss_newton_step(problem.unknowns, start, rest, none)[0])
    return tuple(states)


def _newton(observations: Observations, rung: Rung, states: States) -> Equations:
    """Equations of a step from one state, with the curvature of the loss instead of its weights."""
    problem = Problem(observations, rung)
    columns = problem.columns_of(states)
    misfit = problem.misfit(problem.model(columns, states.kd, states.ks))
    slopes = problem.equations(columns, misfit, states)
    # Of soft-L1, whose slope over r is w = (1 + (r / TAU)^2)^(-1/2), the second derivative is w^3.
    weight = observations.weight.T[None] * influence(misfit.residual) ** 2
    bent = Problem(observations, rung, weight=weight).equations(columns, misfit, states)
    return bent._replace(own_gradient=slopes.own_gradient, shared_gradient=slopes.shared_gradient)


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
