"""Simulated observers with a known truth, to prove the evaluation where people can't be watched.

An observer sees how far a picture is from the one that is right, by the distance of their kind
(kinds.py), adds noise of a standard deviation of one, and answers in which of their own categories
that falls; now and then the answer has nothing to do with the picture. Distances are in units of
that noise, so that the just noticeable differences below set how good observers are.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.parameters import Checked, choice, parameter
from relgloss_view.experiment.design.study import GRAIN
from relgloss_view.experiment.observers.kinds import (
    KINDS,
    NOTHING,
    OWN_WIDTHS,
    SETTING,
    UNIQUE,
    Kind,
    Mismatch,
    closest_on_average,
    towards_middle,
)
from relgloss_view.picture.scene.setting import Setting

OF_OBSERVER, OF_ANSWER = 5, 6  #: what a seed is for; see order.py


@dataclass(frozen=True)
class Population(Checked):
    """How simulated observers are made."""

    kind: str = choice(
        UNIQUE, tuple(KINDS), "; ".join(f"{name}: {kind.meaning}" for name, kind in KINDS.items())
    )
    gloss_jnd: float = parameter(0.15, 1e-3, 10.0, "", "log gloss that is as large as the noise")
    grain_jnd: float = parameter(0.02, 1e-4, 10.0, "", "grain that is as large as the noise")
    sigma_n_jnd: float = parameter(
        0.5, 1e-3, 10.0, "deg", "sigma_N that is as large as the noise, where settings are judged"
    )
    c_jnd: float = parameter(
        0.1,
        1e-3,
        10.0,
        "",
        "share of c_max that is as large as the noise, where settings are judged",
    )
    noise: float = parameter(1.0, 0.0, 100.0, "", "of a judgment, times that of the usual observer")
    lapse: float = parameter(0.02, 0.0, 1.0, "", "share of answers by chance")
    bias: float = parameter(0.5, 0.0, 10.0, "", "sd of personal truths, in noises of each percept")
    bound_shift: float = parameter(0.4, 0.0, 10.0, "", "sd of the shift of personal categories")
    bound_spread: float = parameter(0.15, 0.0, 2.0, "", "sd of the log of their width")

    @property
    def of_kind(self) -> Kind:
        """What that kind of observers judges, and how."""
        return KINDS[self.kind]


@dataclass(frozen=True)
class SimulatedObserver:
    """One of a population; the same number and seed give the same observer and answers."""

    population: Population
    seed: int
    number: int
    bounds: tuple[float, ...]
    bias: tuple[float, float]  #: of gloss (or c) and of grain (or sigma_N), in noises
    group: int = 0  #: of those of the kind
    to_middle: float = 0.0  #: share of answers that move one category towards the middle

    @classmethod
    def of(
        cls, population: Population, seed: int, number: int, categories: int
    ) -> SimulatedObserver:
        """The observer of a number, with personal bounds and a personal truth.

        Personal truths lie about the truth so that the whole population finds the truth closest.
        """
        kind = population.of_kind
        random = np.random.default_rng([seed, OF_OBSERVER, number])
        width = float(np.exp(population.bound_spread * random.standard_normal()))
        shift = population.bound_shift * float(random.standard_normal())
        bias = population.bias * random.standard_normal(2)
        bounds = usual_bounds(categories)
        if kind.own_widths:
            widths = np.diff(bounds, prepend=0.0)
            bounds = np.cumsum(widths * np.exp(OWN_WIDTHS * random.standard_normal(len(widths))))
        return cls(
            population,
            seed,
            number,
            tuple(float(b) * width + shift for b in bounds),
            (float(bias[0]) + closest_on_average(kind, population.bias), float(bias[1])),
            group=number % kind.groups,
            to_middle=float(random.random()) if kind.to_middle else 0.0,
        )

    def judge(self, position: int, question: int, name: str, mismatch: Mismatch) -> int:
        """The category of a stimulus with that mismatch to this observer's truth, 0 close up."""
        kind = self.population.of_kind
        random = np.random.default_rng([self.seed, OF_ANSWER, self.number, position, question])
        lapse, noise = random.random(), kind.noise(random)
        by_chance = int(random.integers(len(self.bounds) + 1))
        if kind.depends_on == NOTHING or lapse < self.population.lapse:
            return by_chance
        distance = self.distance(name, mismatch) + self.population.noise * noise
        category = int(np.searchsorted(self.bounds, distance))
        if self.to_middle and random.random() < self.to_middle:
            category = towards_middle(category, len(self.bounds) + 1)
        return category

    def mismatch(
        self, seen: Array, target: Array, setting: Setting, right: Sequence[Setting]
    ) -> Mismatch:
        """How a stimulus differs from this observer's truth.

        seen, target: (2,), log gloss and grain of the stimulus and of the picture that is right;
        setting, right: those of the stimulus, and all that are right.
        """
        p = self.population
        return Mismatch(
            gloss=float(seen[0] - target[0]) / p.gloss_jnd + self.bias[0],
            grain=float(seen[1] - target[1]) / p.grain_jnd + self.bias[1],
            settings=tuple(
                (
                    (setting.sigma_n_deg - r.sigma_n_deg) / p.sigma_n_jnd + self.bias[1],
                    (setting.c_fraction - r.c_fraction) / p.c_jnd + self.bias[0],
                )
                for r in right
            ),
        )

    def distance(self, question: str, mismatch: Mismatch) -> float:
        """How far that is by the observer's kind, in noises; asked about grain, by grain alone."""
        kind = self.population.of_kind
        if question != GRAIN:
            return kind.distance(mismatch, self.group)
        if kind.depends_on == SETTING:
            return min(abs(sigma_n) for sigma_n, _ in mismatch.settings)
        return abs(mismatch.grain)

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
            "group": self.group,
            "to_middle": self.to_middle,
            **dataclasses.asdict(self.population),
        }


def usual_bounds(categories: int) -> Array:
    """Bounds between so many categories, in noises: a little wider the farther they are."""
    steps = np.arange(categories - 1) * 4.0 / max(categories - 1, 1)
    return np.asarray(0.8 + steps + 0.08 * steps**2)
