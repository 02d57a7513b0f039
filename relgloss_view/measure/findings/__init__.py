"""What a measured table shows by itself, before any model is fitted to it.

Each check is a module. All look at the readings of one Measurement and return findings: one plain
line each, with what is wrong, where, and how to mend it.
"""

from __future__ import annotations

import numpy as np

from relgloss_view.measure.findings import (
    bands,
    colour,
    drift,
    lamp_peak,
    lobe,
    mirror_direction,
    plateaus,
    single_rows,
    units,
)
from relgloss_view.measure.findings.finding import BANDS, MIRROR, Examined, Finding
from relgloss_view.measure.findings.rows import Rows
from relgloss_view.measure.ridge import UNKNOWN_TILT
from relgloss_view.measure.table import Measurement

__all__ = ["Examined", "Finding", "examine"]


def examine(measurement: Measurement) -> Examined:
    """The measurement as it is to be fitted, with what its own numbers show.

    Rows on a plateau of saturation are marked. A finding is serious where no fit of the table may
    be called good. The thresholds hold for noise of a few percent; docs/findings.md.

    >>> from relgloss_view import read_measurement
    >>> examine(read_measurement("art-coated")).findings
    ()
    """
    with np.errstate(all="ignore"):
        rows = Rows.of(measurement)
        if not len(rows):
            return Examined(measurement)
        measurement, dead = bands.without_dead(measurement, rows)
        rows = Rows.of(measurement) if dead else rows
        measurement, findings = plateaus.saturation(measurement, rows)
        findings = [*dead, *findings, *bands.out_of_place(measurement, rows)]
        findings += plateaus.floors(measurement, rows)
        unknown = [text for text in measurement.warnings if text.startswith(UNKNOWN_TILT)]
        findings += [Finding(MIRROR, text, True) for text in unknown]
        findings += units.radians(measurement, rows)
        if any(f.serious and f.kind not in (BANDS, MIRROR) for f in findings):
            return Examined(measurement, tuple(findings))
        elsewhere = mirror_direction.check(measurement, rows)
        findings += elsewhere
        if elsewhere:
            measurement = mirror_direction.without_other_remedy(measurement, elsewhere[0])
            return Examined(measurement, tuple(findings))
        rows = Rows.of(measurement)  # without those on a plateau
        some = rows.thinned()
        findings += units.values(measurement, some)
        if any(f.serious and f.kind != BANDS for f in findings):
            return Examined(measurement, tuple(findings))
        core = lobe.lobe_of(some)
        findings += drift.check(measurement, some, core)
        findings += lobe.coverage(measurement, rows, core)
        findings += lobe.aperture(measurement, some, core)
        findings += lobe.anisotropy(measurement, some, core)
        towards_lamp = lamp_peak.check(some)
        findings += towards_lamp
        findings += colour.check(measurement, some, core)
        findings += single_rows.check(rows, core, lamp_peak=bool(towards_lamp))
    return Examined(measurement, tuple(findings))
