"""What is typed for a new material: gloss readings and a colour, and the estimate they ask for."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.fitting.estimate.colour import LIGHTNESS_ERROR, LabColour
from relgloss_view.fitting.estimate.estimate import Estimate, estimate
from relgloss_view.fitting.estimate.given import GlossReading, last_digit, reading_of
from relgloss_view.measure.spectrum import AT_45_0, ColourReading

ANGLES_DEG = (20, 60, 85, 75)  #: of the meters, the usual ones first
LAB_STEP = 0.1  #: of the fields for L, a, b
Lab = tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class SpectrumRead:
    """A spectrum that was read from a file; each time it is read it is another one."""

    file: str
    part: str  #: of a file that holds several; empty for the only one
    reading: ColourReading


@dataclass(frozen=True)
class ReadingsTyped:
    """The fields: gloss by angle as typed (empty: no reading), and the colour.

    gloss: texts in the order of ANGLES_DEG. lab: L*, a*, b* under D50, which count where there is
    no spectrum. geometry: of the colour, one of measure.spectrum.GEOMETRIES.

    >>> ReadingsTyped(("", "45", "", ""), (50.0, 0.0, 0.0)).readings()[0].words
    '60=45'
    """

    gloss: tuple[str, ...] = ("",) * len(ANGLES_DEG)
    lab: Lab = (50.0, 0.0, 0.0)
    spectrum: SpectrumRead | None = field(default=None)
    geometry: str = AT_45_0

    def readings(self) -> tuple[GlossReading, ...]:
        """The readings, by rising angle; InputError where a text is none."""
        by_angle = {}
        for angle, text in zip(ANGLES_DEG, self.gloss, strict=True):
            if text.strip():
                by_angle[angle] = _reading(angle, text.strip().replace(",", "."))
        return tuple(by_angle[angle] for angle in sorted(by_angle))

    @property
    def colour(self) -> LabColour | ColourReading:
        """The colour as the estimate takes it."""
        if self.spectrum is not None:
            return self.spectrum.reading
        return LabColour(self.lab, lightness_error=_LIGHTNESS_ERROR)

    def estimate(self) -> Estimate:
        """The materials that agree; InputError without a reading, or for an impossible colour."""
        readings = self.readings()
        if not readings:
            raise InputError("type at least one gloss reading")
        return estimate(readings, self.colour, geometry=self.geometry)


_LIGHTNESS_ERROR = math.hypot(LIGHTNESS_ERROR, LAB_STEP / math.sqrt(12.0))


def _reading(angle: int, text: str) -> GlossReading:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise InputError(
            f"gloss at {angle} degrees: expected a number such as 45, found {printable(text, 30)!r}"
        )
    return reading_of(angle, value, step=last_digit(text))
