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
#: Twice the 60 degrees up to which readings of the mirror direction carry the estimate: the lamp's
#: azimuth at which a cylinder's highlight has that incidence.
TRUSTED_AZIMUTH_DEG = 120.0


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
        text = f"gloss {odd.reading.words} contradicts the other readings, which "
        text += f"allow {odd.range_words}; the estimate leaves it out; read it again"
        return Contradiction(text, factors)
    parts = [
        f"{one.reading.words} (the rest allows {one.range_words})" for one in each if one.beyond
    ]
    text = f"gloss readings contradict one another: {', '.join(parts or ['all of them'])}"
    return Contradiction(f"{text}; read them again", enlarged)


def _odd_one(each: list[_Without]) -> _Without | None:
    """The one reading that is to be left out, of readings in order of the others' likelihood.

    Of two readings neither is better than the other.
    """
    first, second = each[:2]
    if len(each) < 3 or first.log_evidence - second.log_evidence <= math.log(ODDS):
        return None
    return first if first.beyond and first.strain <= LARGEST_STRAIN else None


def high_near_grazing(posed: Problem, surfaces: Array, seed: int) -> str:
    """One line where the reading at 85 degrees lies above what facets give at the others; or ''."""
    k = posed.grazing
    if k is None or len(posed.readings) == 1 or not posed.beyond_facets(surfaces):
        return ""
    one = _without(posed, k, seed)
    if one.reading.value <= one.high:
        return ""
    rest = "other readings" if len(posed.readings) > 2 else "other reading"
    return (
        f"gloss {one.reading.words} is left out: with the {rest} the model gives "
        f"{one.range_words} there. Many prints read more, since near grazing they mirror as "
        "smoother surfaces do. Trust pictures while the lamp's azimuth is at most "
        f"{TRUSTED_AZIMUTH_DEG:g} degrees; beyond, the print is glossier"
    )


def _without(posed: Problem, k: int, seed: int) -> _Without:
    others = posed.without(k)
    random = np.random.default_rng([seed, 2, k])
    drawn = posterior(others.log_likelihood, random, COUNT)
    predicted = posed.predicted(drawn.surfaces)[:, k]
    low, high = (float(q) for q in np.quantile(predicted, REACH))
    evidence = drawn.log_evidence - float(np.sum(np.log(others.errors)))
    strain = float(others.strain(drawn.surfaces).min())
    return _Without(k, posed.readings[k], low, high, evidence, strain)
