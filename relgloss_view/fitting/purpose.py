"""What a measured table can serve for, decided before any fit."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from relgloss_view.fitting.observations import DARKEST, FEWEST_SAMPLES, usable_rows
from relgloss_view.measure.findings import Finding
from relgloss_view.measure.overview.polar import Polar
from relgloss_view.measure.spectrum import is_45_0
from relgloss_view.measure.table import Measurement

FIT, ESTIMATE, NOTHING = "fit", "estimate", "nothing"


@dataclass(frozen=True)
class Purpose:
    """A use of a table, and why it is this one."""

    use: str  #: FIT, ESTIMATE or NOTHING
    text: str


def purpose_of(measurement: Measurement, findings: tuple[Finding, ...] = ()) -> Purpose:
    """What a measurement can serve for, by the same limits as a fit's.

    findings: what the table shows by itself; with a serious one a fit can't be called good.
    """
    values = np.nan_to_num(measurement.radiance_factor, nan=0.0, posinf=0.0, neginf=0.0)
    usable = usable_rows(measurement) & np.any(values > 0.0, axis=1)
    count = int(usable.sum())
    noun = "geometry" if count == 1 else "geometries"
    if count >= FEWEST_SAMPLES and float(values[usable].max()) >= DARKEST:
        serious = [finding for finding in findings if finding.serious]
        if not serious:
            return Purpose(FIT, f"`relgloss fit` ({count} usable {noun})")
        return Purpose(
            FIT, f"`relgloss fit`, but no fit can be called good: {serious[0].kind}, see above"
        )
    if count >= FEWEST_SAMPLES:
        return Purpose(
            NOTHING,
            "nothing yet: no surface is as dark as these readings; check the quantity and its unit",
        )
    few = f"{count} usable {noun}, and a fit needs {FEWEST_SAMPLES}"
    polar = Polar.of(measurement)
    colour = np.flatnonzero(usable & is_45_0(polar.lamp_deg, polar.receiver_deg))
    if len(colour) and not measurement.bands.is_rgb:
        return Purpose(
            ESTIMATE,
            "`relgloss estimate --spectrum FILE`, which takes the colour of a material: row "
            f"{colour[0] + 1} is a 45/0 reading ({few})",
        )
    lacks = "no spectrum is" if measurement.bands.is_rgb else "no row is"
    return Purpose(
        NOTHING,
        f"nothing yet: {few}; {lacks} there for `relgloss estimate --spectrum` either, which needs "
        "a 45/0 reading. Measure at and beside the mirror direction, or at 45/0",
    )
