"""The gloss readings that an estimate begins with, and how far each may be off."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from relgloss_view.base.errors import InputError
from relgloss_view.gloss.meter.geometry import SPECULAR
from relgloss_view.material import brdf

#: How far a reading may be off, one standard deviation: a constant and a share of the reading. It
#: joins the meters' (makers of meters for ISO 2813 state reproducibilities of 0.2 units for matte
#: samples and 0.5 at 100) and the sheet's, whose gloss varies by a few per cent across it.
ERROR_UNITS, ERROR_SHARE = 0.3, 0.01
STEP = 0.1  #: gloss units that a meter shows (ISO 2813); a typed number may be coarser
LARGEST = 2000.0  #: units; a mirror at 20 degrees, the end of any meter's range
#: The most that a smooth dielectric is taken to reflect: index 1.7 over its whole surface.
LARGEST_INDEX = 1.7
MARGIN = 1.15  #: a noisy reading, or a surface that mirrors more than its facets, is no metal yet


@dataclass(frozen=True)
class GlossReading:
    """A reading in gloss units at one of the meters' angles, with its standard error."""

    angle_deg: float
    value: float
    standard_error: float

    @property
    def words(self) -> str:
        """As it is typed, such as 60=45."""
        return f"{self.angle_deg:g}={self.value:g}"


def reading_of(
    angle_deg: float, value: float, *, error: float | None = None, step: float = STEP
) -> GlossReading:
    """A reading; InputError where there is no such meter, or no such number.

    error: standard error in gloss units, None for the usual one. step: unit of the last digit.

    >>> round(reading_of(60, 45.0).standard_error, 3)
    0.542
    """
    if angle_deg not in SPECULAR:
        angles = ", ".join(f"{angle:g}" for angle in sorted(SPECULAR))
        raise InputError(f"gloss at {angle_deg:g} degrees: expected an angle of {angles}")
    place = f"gloss {angle_deg:g}={value:g}"
    if not (math.isfinite(value) and 0.0 <= value <= LARGEST):
        raise InputError(f"{place}: expected gloss units from 0 to {LARGEST:g}")
    limit = largest(angle_deg)
    if value > limit:
        raise InputError(
            f"{place}: no ink, varnish or coating reads above {limit:.0f} at {angle_deg:g} degrees;"
            " metal and foil can't be estimated from gloss: fit a measured table (`relgloss fit`)"
        )
    if error is None:
        error = math.hypot(ERROR_UNITS, ERROR_SHARE * value)
    elif not (math.isfinite(error) and 0.0 < error <= 100.0):
        raise InputError(f"gloss error {error:g}: expected gloss units above 0, at most 100")
    return GlossReading(float(angle_deg), float(value), math.hypot(error, step / math.sqrt(12.0)))


def largest(angle_deg: float) -> float:
    """The most that a smooth surface of LARGEST_INDEX reads, with a margin, in gloss units."""
    meter = SPECULAR[round(angle_deg)]
    cos = math.cos(math.radians(meter.angle_deg))
    share = float(brdf.fresnel_dielectric(cos, LARGEST_INDEX))
    return MARGIN * 100.0 * share / float(brdf.fresnel_dielectric(cos, meter.glass))


def readings_of(
    gloss: Mapping[float, float], error: float | None = None
) -> tuple[GlossReading, ...]:
    """Readings by angle; InputError where there is none."""
    if not gloss:
        raise InputError("no gloss reading: give at least one, such as 60=45")
    return tuple(reading_of(angle, gloss[angle], error=error) for angle in sorted(gloss))


def last_digit(text: str) -> float:
    """The unit of the last digit that is typed, 1 for 45 and 0.1 for 12.3; at most 1.

    >>> last_digit("45"), last_digit("12.3")
    (1.0, 0.1)
    """
    mantissa = text.lower().partition("e")[0]
    return float(10.0 ** -len(mantissa.partition(".")[2]))
