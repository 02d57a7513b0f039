"""Finding: one thing that a measured table shows about itself, before any model is fitted."""

from __future__ import annotations

from dataclasses import dataclass, field

from relgloss_view.measure.table import Measurement

#: What a finding is about.
MIRROR = "mirror direction"
PLATEAU = "plateau"
FLOOR = "floor"
LAMP_PEAK = "peak towards the lamp"
APERTURE = "aperture"
UNITS = "units"
ANISOTROPY = "anisotropy"
COLOUR = "colour"
ROWS = "rows"
COVERAGE = "coverage"
BANDS = "bands"
DRIFT = "drift"


@dataclass(frozen=True)
class Finding:
    """What is wrong or odd in a table, where, and how to mend it, in one line."""

    kind: str  #: one of the constants above
    text: str
    serious: bool  #: whether no fit of the table may be called good


@dataclass(frozen=True)
class Examined:
    """A measurement as it is to be used, and what its own numbers show."""

    measurement: Measurement  #: rows on a plateau are marked table.SATURATED
    findings: tuple[Finding, ...] = field(default=())

    @property
    def serious(self) -> tuple[str, ...]:
        """The lines for which no fit may be called good."""
        return tuple(f.text for f in self.findings if f.serious)

    @property
    def texts(self) -> tuple[str, ...]:
        """All lines, those that the reader has already put among its warnings left out."""
        return tuple(f.text for f in self.findings if f.text not in self.measurement.warnings)
