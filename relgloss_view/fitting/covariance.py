"""How uncertain the fitted numbers are together: a jackknife over planes, and the priors.

Samples of one incidence plane share errors that J'J would take for independent, so whole planes
are left out (Efron and Tibshirani 1993, ch. 11: the delete-one jackknife of groups). An error of
the instrument that the samples do not show stays as uncertain as its prior: the numbers are found
again at other values of it, and their spread, weighted by how likely each value still is, is added.
"""

from __future__ import annotations

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.fitting.ladder import Candidate
from relgloss_view.fitting.metal import mean_strengths
from relgloss_view.fitting.model import States

ALBEDO = "albedo_relative"
_NORMAL_80 = 1.281552  #: two-sided 80 % of a normal variable


def names_of(candidate: Candidate) -> tuple[str, ...]:
    """The numbers that the covariance is of: those of the material, lobes numbered from 1."""
    rung = candidate.rung
    names = [ALBEDO] + (["sigma_deg"] if rung.rough else [])
    for j in range(1, rung.lobes + 1):
        names += [f"s_deg.{j}", f"strength.{j}", f"refractive_index.{j}"]
    return (*names, *(f"error.{k}" for k in range(1, rung.errors + 1)))


def numbers_of(candidate: Candidate, states: States) -> Array:
    """(P, M), those numbers at P states; the albedo as the ratio of its mean to the fitted one."""
    rung = candidate.rung
    fitted = max(float(np.mean(candidate.solution.state.kd)), 1e-12)
    columns = [np.mean(states.kd, axis=1) / fitted]
    if rung.rough:
        columns.append(np.degrees(np.sqrt(states.t)))
    strengths = mean_strengths(states, candidate.solution.state)
    for j in range(rung.lobes):
        columns += [np.degrees(np.exp(states.log_s[:, j])), strengths[:, j]]
        columns += [states.n[:, j]]
    columns += list(states.errors.T)[: rung.errors]
    return np.stack(columns, axis=1)


def sample_covariance(candidate: Candidate) -> Array:
    """(M, M), of the numbers of a candidate whose folds have been fitted: what noise does.

    That of the samples and their planes, and that of what all of them share, which leaving planes
    out cannot show: the readings' zero level, and the dispersion of a fitted index.
    """
    result = jackknife_covariance(numbers_of(candidate, States.of(candidate.fold_states)))
    for pair in candidate.shared_states:
        ends = numbers_of(candidate, States.of(pair))
        half = 0.5 * (ends[1] - ends[0])
        result = result + np.outer(half, half)
    return result


def prior_covariance(candidate: Candidate) -> Array:
    """(M, M), what the samples do not show of the instrument's errors and of a held index do."""
    fitted = numbers_of(candidate, States.of([candidate.solution.state]))
    result = np.zeros((fitted.shape[1],) * 2)
    for held in candidate.held:
        # The second moment about the fit over the values of the thing, as likely as each is: a
        # tilt across all planes changes the peak by its square, which no slope would see.
        moved = numbers_of(candidate, States.of(held.states)) - fitted
        weight = np.array(held.likelihoods)
        result += (moved * weight[:, None]).T @ moved / (1.0 + np.sum(weight))
    return result


def jackknife_covariance(values: Array) -> Array:
    """(M, M), from numbers (G, M) of which each row leaves one of G groups out.

    Widened as Student's t of G - 1 degrees of freedom wants it at 80 %, between the intervals of
    68 % and of 95 % that readers make of a standard error.
    """
    from scipy.special import stdtrit  # slow to import, and the window has no use for it

    count = len(values)
    away = values - np.mean(values, axis=0)
    wider = float(stdtrit(count - 1, 0.9)) / _NORMAL_80
    return np.asarray((count - 1) / count * wider**2 * (away.T @ away))
