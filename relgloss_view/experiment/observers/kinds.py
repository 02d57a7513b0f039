"""Kinds of simulated observers: what they judge, by which distance, with which noise.

The analysis assumes one ideal place, distances that grow without end and normal noise
(docs/experiment.md). People need not: each kind beside `unique` breaks some of that. All numbers
here are chosen, not measured. A new kind is a function and a line in KINDS.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from dataclasses import dataclass
from statistics import NormalDist

import numpy as np

TOO_GLOSSY, TOO_DULL = 1.5, 0.5  #: how much a mismatch of gloss counts on either side
SATURATION = 4.0  #: noises that no distance of the asymmetric kind reaches
OWN_WIDTHS = 0.3  #: sd of the log of each category's width, where every category has its own

PICTURE, SETTING, NOTHING = "picture", "setting", "nothing"  #: what a kind's answers depend on


@dataclass(frozen=True)
class Mismatch:
    """How a stimulus differs from one observer's truth, signed, in units of the noise."""

    gloss: float  #: above 0: too glossy; NaN where no picture was seen
    grain: float  #: above 0: too grainy; NaN where no picture was seen
    #: (sigma_N, c), one pair for each setting that is right
    settings: tuple[tuple[float, float], ...] = ()


def both(mismatch: Mismatch, group: int) -> float:
    """Euclidean in gloss and grain, as the analysis assumes in a plane of its own."""
    return float(np.hypot(mismatch.gloss, mismatch.grain))


def gloss_alone(mismatch: Mismatch, group: int) -> float:
    """The ratio of gloss, and nothing else."""
    return abs(mismatch.gloss)


def nothing(mismatch: Mismatch, group: int) -> float:
    """No distance: the answers are by chance."""
    return 0.0


def asymmetric(mismatch: Mismatch, group: int) -> float:
    """Too glossy counts three times as much as too dull; far pictures are all equally far.

    d = S (1 - exp(-hypot(w gloss, grain) / S)); the exponential is Shepard's (1987) decay of
    similarity, the two slopes are those of Kahneman and Tversky's (1979) value function.
    """
    weight = TOO_GLOSSY if mismatch.gloss > 0.0 else TOO_DULL
    distance = math.hypot(weight * mismatch.gloss, mismatch.grain)
    return SATURATION * -math.expm1(-distance / SATURATION)


def city_block(mismatch: Mismatch, group: int) -> float:
    """|sigma_N| + |c|: dimensions that are judged apart and added (Attneave 1950)."""
    ((sigma_n, c),) = mismatch.settings
    return abs(sigma_n) + abs(c)


def one_of_two(mismatch: Mismatch, group: int) -> float:
    """Group 0 judges gloss alone, group 1 grain alone: points of view (Tucker and Messick 1963)."""
    return abs(mismatch.gloss if group == 0 else mismatch.grain)


def nearest_of_two(mismatch: Mismatch, group: int) -> float:
    """Euclidean in (sigma_N, c), from the nearer of two settings that are equally right."""
    return min(math.hypot(sigma_n, c) for sigma_n, c in mismatch.settings)


def larger(mismatch: Mismatch, group: int) -> float:
    """The larger of the two mismatches (the dominance metric: Coombs 1964)."""
    return max(abs(mismatch.gloss), abs(mismatch.grain))


def normal(random: np.random.Generator) -> float:
    """Thurstone's (1927) discriminal dispersion; the probit link of the analysis."""
    return float(random.standard_normal())


def logistic(random: np.random.Generator) -> float:
    """Heavier tails, sd 1; the proportional odds model (McCullagh 1980)."""
    return float(random.logistic(scale=math.sqrt(3.0) / math.pi))


def gumbel(random: np.random.Generator) -> float:
    """Skewed towards far, mean 0, sd 1; the log-log link (McCullagh 1980)."""
    scale = math.sqrt(6.0) / math.pi
    return float(random.gumbel(loc=-float(np.euler_gamma) * scale, scale=scale))


@dataclass(frozen=True)
class Kind:
    """One kind of observers, and what a study of them may rightly find."""

    meaning: str
    distance: Callable[[Mismatch, int], float]  #: of a mismatch, for an observer of a group
    noise: Callable[[np.random.Generator], float]
    depends_on: str = PICTURE
    own_widths: bool = True  #: whether the width of each category is personal, not their sum alone
    groups: int = 1  #: observers belong to them in turn
    right_settings: int = 1  #: settings that are equally right
    one_best: bool = True  #: whether "best" is right: for all of them one setting is closest
    to_middle: bool = False  #: whether answers move towards the middle category
    signed: bool = False  #: whether too glossy and too dull are different


UNIQUE, RATIO_ONLY, RANDOM = "unique", "ratio", "random"
ASYMMETRIC, CITY_BLOCK, TWO_GROUPS = "asymmetric", "city-block", "two-groups"
TWO_OPTIMA, MIDDLE = "two-optima", "middle"

KINDS = {
    UNIQUE: Kind("gloss and grain have to be right", both, normal, own_widths=False),
    RATIO_ONLY: Kind("gloss alone counts", gloss_alone, normal, own_widths=False, one_best=False),
    RANDOM: Kind(
        "answers by chance", nothing, normal, NOTHING, own_widths=False, one_best=False
    ),
    ASYMMETRIC: Kind(
        "too glossy is worse than too dull, and answers saturate", asymmetric, gumbel, signed=True
    ),
    CITY_BLOCK: Kind("differences of sigma_N and c are added", city_block, logistic, SETTING),
    TWO_GROUPS: Kind(
        "half judge gloss alone, half grain alone", one_of_two, logistic, groups=2, one_best=False
    ),
    TWO_OPTIMA: Kind(
        "two settings far apart are equally right",
        nearest_of_two, logistic, SETTING, right_settings=2, one_best=False,
    ),
    MIDDLE: Kind(
        "the worse of gloss and grain counts, and answers tend to the middle category",
        larger, logistic, to_middle=True,
    ),
}  # fmt: skip


@functools.lru_cache(maxsize=8)
def closest_on_average(kind: Kind, sd: float) -> float:
    """The mismatch of gloss that a population finds closest whose personal truths differ by sd.

    In noises; the mean of both percepts' truths is 0. Where too glossy is worse, it is below 0: a
    picture that is too dull for most of them is too glossy for few.
    """
    if not kind.signed or sd == 0.0:
        return 0.0
    gloss = [NormalDist(0.0, sd).inv_cdf((k + 0.5) / 101) for k in range(101)]
    grain = [NormalDist(0.0, sd).inv_cdf((k + 0.5) / 21) for k in range(21)]

    def mean(at: float) -> float:
        return sum(kind.distance(Mismatch(at + a, b), 0) for a in gloss for b in grain)

    # The mean of distances that rise on both sides has one minimum: a search by thirds ends there.
    low, high = -3.0 * sd, 3.0 * sd
    while high - low > 1e-3 * sd:
        third = (high - low) / 3.0
        if mean(low + third) < mean(high - third):
            high -= third
        else:
            low += third
    return 0.5 * (low + high)


def towards_middle(category: int, categories: int) -> int:
    """One category nearer to the middle one, or to the two in the middle.

    The central tendency of judgment (Hollingworth 1910), as a preference for middle answers.
    """
    above = 2 * category - (categories - 1)
    return category - int(np.sign(above)) if abs(above) >= 2 else category
