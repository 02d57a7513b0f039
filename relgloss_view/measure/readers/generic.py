"""Generic tables: polar angle and azimuth of lamp and receiver, then wavelengths or R, G, B."""

from __future__ import annotations

import numpy as np

from relgloss_view.measure import screen
from relgloss_view.measure.gonio import spherical
from relgloss_view.measure.quantity import to_radiance_factor
from relgloss_view.measure.readers.assemble import contradictions, require_samples
from relgloss_view.measure.readers.columns import split_columns
from relgloss_view.measure.readers.csv_table import TextTable
from relgloss_view.measure.readers.declared import declared
from relgloss_view.measure.table import Measurement

#: Column names and the largest magnitude of each angle, degrees.
COLUMNS = {
    "theta_i_deg": 90.0,
    "phi_i_deg": 360.0,
    "theta_r_deg": 90.0,
    "phi_r_deg": 360.0,
}


def read(
    table: TextTable, quantity: str | None = None, gamma_s_deg: float | None = None
) -> Measurement:
    """Read a parsed generic table; `i` is the lamp, `r` the receiver. Raises InputError."""
    facts = declared(table, quantity)
    angles, bands, readings = split_columns(table, COLUMNS)
    to_lamp = spherical(angles[:, 0], angles[:, 1])
    to_receiver = spherical(angles[:, 2], angles[:, 3])
    reasons = screen.reasons(to_lamp, to_receiver, readings, saturation=facts.saturation)
    factor = to_radiance_factor(readings, facts.quantity, to_receiver[:, 2])
    warnings = list(facts.warnings)
    if gamma_s_deg is not None:
        warnings.append("the table has no gamma column; --gamma-s-deg is not used")
    contradiction = contradictions(angles, factor, reasons == "")
    if contradiction:
        warnings.append(contradiction)
    measurement = Measurement(
        name=facts.name,
        source=facts.source,
        to_lamp=to_lamp,
        to_receiver=to_receiver,
        bands=bands,
        radiance_factor=factor,
        reasons=reasons,
        group=np.rint(np.abs(angles[:, 0])).astype(np.int64),
        aperture_sd_deg=facts.aperture_sd_deg,
        warnings=tuple(warnings),
    )
    return require_samples(measurement, table.path)
