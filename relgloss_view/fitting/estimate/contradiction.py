"""Whether readings contradict one another, which of them does, and how an estimate goes on."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.fitting.estimate.given import GlossReading
from relgloss_view.fitting.estimate.sampler import posterior

if TYPE_CHECKING:
    from relgloss_view.fitting.estimate.problem import Problem

#: Sum of squared misfits and of the squared distance of the index, over errors, that no consistent
#: readings leave: surfaces have more unknowns than there are readings, so the best draw of
#: consistent ones is off by far less.
LARGEST_STRAIN = 12.0
COUNT = 400  #: draws without a reading
REACH = (0.005, 0.995)
#: Odds from which one reading is taken to be the wrong one.
ODDS = 10.0
IGNORED = 1e4  #: by this factor the error of a reading grows that is left out
GRAZING_DEG = 85.0
GRAZING = "many surfaces mirror more at grazing angles than the model's facets do"


@dataclass(frozen=True)
class Contradiction:
    """One line that names the readings, and the factors (R,) by which their errors are enlarged."""

    words: str
    factors: tuple[float, ...]


class _Without(NamedTuple):
    """What the other readings allow for one."""

    k: int
    reading: GlossReading
    low: float
    high: float
    log_evidence: float  #: of the others, by which this one is the wrong one
    strain: float  #: of the others' best draw

    @property
    def beyond(self) -> bool:
        return not self.low <= self.reading.value <= self.high

    @property
    def high_near_grazing(self) -> bool:
        """Whether it is as real surfaces are, and facets are not."""
        return self.reading.angle_deg == GRAZING_DEG and self.reading.value > self.high

    @property
    def range_words(self) -> str:
        return f"{self.low:.3g} to {self.high:.3g}"


def contradiction_of(posed: Problem, surfaces: Array, seed: int) -> Contradiction | None:
    """The contradiction of readings whose best draws are off by more than errors allow."""
    least = float(posed.strain(surfaces).min())
    if least <= LARGEST_STRAIN:
        return None
    readings = posed.readings
    # Errors as large as the readings show them to be (Birge 1932).
    enlarged = (math.sqrt(least / len(readings)),) * len(readings)
    each = [_without(posed, k, seed) for k in range(len(readings))]
    each.sort(key=lambda one: -one.log_evidence)
    if len(readings) == 1:
        text = f"gloss {readings[0].words} contradicts the colour: a surface of this colour reads "
        return Contradiction(f"{text}{each[0].range_words}; read both again", enlarged)
    odd = _odd_one(each)
    if odd is not None:
        factors = tuple(IGNORED if k == odd.k else 1.0 for k in range(len(readings)))
        several = len(readings) > 2
        text = f"gloss {odd.reading.words} contradicts the other reading{'s' * several}, which "
        text += f"allow{'' if several else 's'} {odd.range_words}; the estimate leaves it out"
        advice = f" ({GRAZING})" if odd.high_near_grazing else "; read it again"
        return Contradiction(text + advice, factors)
    parts = [
        f"{one.reading.words} (the rest allows {one.range_words})" for one in each if one.beyond
    ]
    text = f"gloss readings contradict one another: {', '.join(parts or ['all of them'])}"
    return Contradiction(f"{text}; read them again", enlarged)


def _odd_one(each: list[_Without]) -> _Without | None:
    """The one reading that is to be left out, of readings in order of the others' likelihood.

    Of two readings neither is better than the other, unless it is high near grazing.
    """
    grazing = [one for one in each if one.high_near_grazing]
    first, second = each[:2]
    if len(each) > 2 and first.log_evidence - second.log_evidence > math.log(ODDS):
        grazing = [first]
    return next((one for one in grazing if one.beyond and one.strain <= LARGEST_STRAIN), None)


def _without(posed: Problem, k: int, seed: int) -> _Without:
    others = posed.without(k)
    random = np.random.default_rng([seed, 2, k])
    drawn = posterior(others.log_likelihood, random, COUNT)
    predicted = posed.predicted(drawn.surfaces)[:, k]
    low, high = (float(q) for q in np.quantile(predicted, REACH))
    evidence = drawn.log_evidence - float(np.sum(np.log(others.errors)))
    strain = float(others.strain(drawn.surfaces).min())
    return _Without(k, posed.readings[k], low, high, evidence, strain)
