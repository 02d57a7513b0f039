"""Rungs with a metal's lobe, tried where a lobe has a colour or is brighter than a dielectric's.

A dielectric's lobe has one colour at every angle. That of a foil or a metallic ink turns white at
grazing incidence: m_b = a_b T (1 - w) + k T w with a_b = k F0_b (Schlick 1994), the columns of
shapes.metal_columns.
"""

from __future__ import annotations

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.fitting.descent import refine
from relgloss_view.fitting.ladder import RELEVANT_SHARE, Candidate, Folds, enough, evaluate
from relgloss_view.fitting.limits import OPTICAL_INDEX
from relgloss_view.fitting.model import Rung, State, States, brightness
from relgloss_view.fitting.problem import Problem
from relgloss_view.material.material import Lobe

#: Each with the rungs between which its colour shows: of neutral lobes, of coloured ones. The last
#: is for a foil whose highlight is narrow on a wide foot.
METALS = (
    (Rung("metal", lobes=1, metals=1), "lobe", "spectral-lobe"),
    (Rung("metal-and-lobe", lobes=2, metals=1), "two-lobes", "two-spectral-lobes"),
    (Rung("two-metals", lobes=2, metals=2), "metal-and-lobe", "two-spectral-lobes"),
)
NAMES = tuple(rung.name for rung, *_ in METALS)
#: F0 above this in some band is no metal's: the lobe would darken towards grazing incidence.
LARGEST_F0 = 1.1
#: Brightness (model.brightness, one is a full lobe of index 1.5) beyond which a lobe is no
#: dielectric's: that of the largest index that a coating has, F0 = ((n - 1) / (n + 1))^2.
BRIGHTEST_DIELECTRIC = ((OPTICAL_INDEX[1] - 1.0) / (OPTICAL_INDEX[1] + 1.0)) ** 2 / 0.04
_GUESS_ROUNDS = 4


def with_metals(folds: Folds, candidates: list[Candidate], tried: str) -> list[Candidate]:
    """The candidates of the ladder, and those with a metal that a coloured lobe calls for.

    tried: 'auto', 'none', or the one of NAMES that is fitted alone.

    A rung is tried where its coloured rung predicts left-out samples better than the neutral one,
    or where the neutral one has a lobe that is brighter than a dielectric's: silver has no colour.
    All others cost nothing. Two metals are tried for the second reason, and where a metal below a
    lobe predicts better than two coloured lobes: the foot of a foil's highlight is a metal's too.
    Candidates come in order of size: only two metals are larger than two coloured lobes.
    """
    if tried == "none":
        return candidates
    if tried in NAMES:
        return [_forced(folds, candidates, tried)]
    by_name = {candidate.name: candidate for candidate in candidates}
    for rung, neutral, coloured in METALS:
        start, plain = by_name.get(coloured), by_name.get(neutral)
        if start is None or not _is_called_for(rung, plain, start):
            continue
        by_name[rung.name] = fitted(folds, rung, start)
    made = [by_name[name] for name in NAMES if name in by_name]
    made = [one for one in made if largest_f0(one.solution.state) <= LARGEST_F0]
    last = next((k for k, c in enumerate(candidates) if c.rung.spectral and c.rung.lobes > 1), None)
    place = len(candidates) if last is None else last
    # Of two coloured lobes each has a strength in each band, of two metals a white part too.
    small = [candidate for candidate in made if candidate.rung.metals == 1]
    large = [candidate for candidate in made if candidate.rung.metals > 1]
    return [*candidates[:place], *small, *candidates[place:], *large]


def _is_called_for(rung: Rung, plain: Candidate | None, coloured: Candidate) -> bool:
    """Whether a rung is worth its time; plain: its neutral rung, if that was tried."""
    if plain is None:
        return rung.metals == 1
    small, large = (plain, coloured) if rung.metals == 1 else (coloured, plain)
    if not enough(small, large, RELEVANT_SHARE):
        return True
    dielectrics = brightness(plain.solution.state)[plain.rung.metals :]
    return bool(np.any(dielectrics > BRIGHTEST_DIELECTRIC))


def _forced(folds: Folds, candidates: list[Candidate], name: str) -> Candidate:
    """One rung with a metal, whatever its F0."""
    rung, _, coloured = METALS[NAMES.index(name)]
    start = next(candidate for candidate in candidates if candidate.name == coloured)
    return fitted(folds, rung, start)


def dielectric_of(candidates: list[Candidate], best: Candidate) -> Candidate:
    """The candidate whose index is freed: of a metal, which has none, the coloured rung it is from.

    An index of 3 and more is another way to say metal, with a colour that does not turn white.
    """
    if best.rung.metals == 0:
        return best
    coloured = METALS[NAMES.index(best.name)][2]
    return next((candidate for candidate in candidates if candidate.name == coloured), best)


def fitted(folds: Folds, rung: Rung, coloured: Candidate) -> Candidate:
    """A rung with a metal, from the widths of a coloured candidate in either order."""
    problem = Problem(folds.observations, rung)
    start = coloured.solution.state
    order = np.arange(rung.lobes)
    log_s = np.array([np.roll(start.log_s, k) for k in order])
    n = np.array([np.roll(start.n, k) for k in order])
    t = np.full(len(order), start.t)
    kd, ks = problem.first_guess(problem.columns(t, log_s, n), _GUESS_ROUNDS)
    states = States(t, log_s, n, kd, ks, np.zeros((len(order), 0)))
    solutions = refine(problem, [states[k] for k in range(len(states))])
    return evaluate(folds, rung, min(solutions, key=lambda s: s.loss))


def largest_f0(state: State) -> float:
    """The largest F0 of a state's brightest metal; infinite where there is nothing white.

    Samples hardly show the white part of a weak foot; a material has it as white as it can be.
    """
    white = state.ks[len(state.log_s) :, 0]
    colour = np.max(state.ks[: len(white)], axis=1)
    main = int(np.argmax(colour))
    return float(colour[main] / white[main]) if white[main] > 0.0 else np.inf


def metals_of(state: State) -> int:
    """How many lobes of a state, the first, are a metal's."""
    return len(state.ks) - len(state.log_s)


def lobe_of(state: State, j: int) -> Lobe:
    """A metal's lobe of a state as it goes into a material."""
    colour, white = state.ks[j], float(state.ks[len(state.log_s) + j, 0])
    strength = max(white, float(np.max(colour)))
    s_deg = float(np.degrees(np.exp(state.log_s[j])))
    return Lobe((strength,), s_deg, f0=tuple(float(a) / strength for a in colour))


def mean_strengths(states: States, fitted: State) -> Array:
    """(P, J), mean strength of each lobe, which errors are taken of.

    A metal's is what a material has as its strength, that of the white part, at the fitted state;
    what varies from state to state is how bright it is head on.
    """
    mean = np.mean(states.ks, axis=2)
    for j in range(metals_of(fitted)):
        white = lobe_of(fitted, j).strength[0] if np.any(fitted.ks[j] > 0.0) else 0.0
        mean[:, j] *= white / max(float(np.mean(fitted.ks[j])), 1e-12)
    return np.asarray(mean[:, : len(fitted.log_s)])


def unknowns_of(lobes: tuple[Lobe, ...], bands: int) -> tuple[Array, Array, Array]:
    """ln s (J,), indices (J,) and ks (J + M, B) of a material's lobes, metals first."""
    ordered = sorted(lobes, key=lambda lobe: not lobe.is_metal)
    parts = [lobe.parts(bands) for lobe in ordered]
    rows = [part[0].spectrum for part in parts] + [part[1].spectrum for part in parts if part[1:]]
    return (
        np.log([lobe.s for lobe in ordered]),
        np.array([lobe.refractive_index for lobe in ordered]),
        np.array(rows).reshape(-1, bands),
    )
