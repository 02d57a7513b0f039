"""Simulated observers with a known truth, to prove the evaluation where people can't be watched.

An observer sees how far a picture is from the one that is right, adds noise of a standard deviation
of one (Thurstone 1927: the discriminal dispersion), and says in which of their own categories that
falls; now and then the answer has nothing to do with the picture. Distances are in units of that
noise, so that the just noticeable differences below set how good observers are.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.parameters import Checked, choice, parameter
from relgloss_view.experiment.design.study import GRAIN

UNIQUE, RATIO_ONLY, RANDOM = "unique", "ratio", "random"
KINDS = (UNIQUE, RATIO_ONLY, RANDOM)
OF_OBSERVER, OF_ANSWER = 5, 6  #: what a seed is for; see order.py


@dataclass(frozen=True)
class Population(Checked):
    """How simulated observers are made."""

    kind: str = choice(
        UNIQUE, KINDS,
        "unique: gloss and grain have to be right; ratio: gloss alone; random: answers by chance",
    )  # fmt: skip
    gloss_jnd: float = parameter(0.15, 1e-3, 10.0, "", "log gloss that is as large as the noise")
    grain_jnd: float = parameter(0.02, 1e-4, 10.0, "", "grain that is as large as the noise")
    noise: float = parameter(1.0, 0.0, 100.0, "", "of a judgment, times that of the usual observer")
    lapse: float = parameter(0.02, 0.0, 1.0, "", "share of answers by chance")
    bias: float = parameter(0.5, 0.0, 10.0, "", "sd of personal truths, in noises of each percept")
    bound_shift: float = parameter(0.4, 0.0, 10.0, "", "sd of the shift of personal categories")
    bound_spread: float = parameter(0.15, 0.0, 2.0, "", "sd of the log of their width")


@dataclass(frozen=True)
class SimulatedObserver:
    """One of a population; the same number and seed give the same observer and answers."""

    population: Population
    seed: int
    number: int
    bounds: tuple[float, ...]
    bias: tuple[float, float]  #: of log gloss and of grain, in noises

    @classmethod
    def of(
        cls, population: Population, seed: int, number: int, categories: int
    ) -> SimulatedObserver:
        """The observer of a number, with personal bounds and a personal truth."""
        random = np.random.default_rng([seed, OF_OBSERVER, number])
        width = float(np.exp(population.bound_spread * random.standard_normal()))
        shift = population.bound_shift * float(random.standard_normal())
        bias = population.bias * random.standard_normal(2)
        bounds = tuple(float(b) * width + shift for b in usual_bounds(categories))
        return cls(population, seed, number, bounds, (float(bias[0]), float(bias[1])))

    def judge(self, position: int, question: int, name: str, seen: Array, target: Array) -> int:
        """The category of a stimulus, 0 close upwards; seen and target are (2,)."""
        random = np.random.default_rng([self.seed, OF_ANSWER, self.number, position, question])
        lapse, noise = random.random(), float(random.standard_normal())
        by_chance = int(random.integers(len(self.bounds) + 1))
        if self.population.kind == RANDOM or lapse < self.population.lapse:
            return by_chance
        distance = self.distance(name, seen, target) + self.population.noise * noise
        return int(np.searchsorted(self.bounds, distance))

    def distance(self, question: str, seen: Array, target: Array) -> float:
        """How far a stimulus is from this observer's truth, in noises; (2,) each."""
        p = self.population
        gloss = float(seen[0] - target[0]) / p.gloss_jnd + self.bias[0]
        grain = float(seen[1] - target[1]) / p.grain_jnd + self.bias[1]
        if question == GRAIN:
            return abs(grain)
        if p.kind == RATIO_ONLY:
            return abs(gloss)
        return float(np.hypot(gloss, grain))

    def response_s(self, position: int) -> float:
        """How long an answer takes; log-normal about two seconds."""
        random = np.random.default_rng([self.seed, OF_ANSWER, self.number, position, 99])
        return float(np.exp(np.log(2.0) + 0.4 * random.standard_normal())) + 0.2

    def details(self) -> dict[str, object]:
        """How this observer was made, for the session file."""
        return {
            "seed": self.seed,
            "bounds": list(self.bounds),
            "bias": list(self.bias),
            **dataclasses.asdict(self.population),
        }


def usual_bounds(categories: int) -> Array:
    """Bounds between so many categories, in noises: a little wider the farther they are."""
    steps = np.arange(categories - 1) * 4.0 / max(categories - 1, 1)
    return np.asarray(0.8 + steps + 0.08 * steps**2)
