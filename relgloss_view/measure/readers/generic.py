"""Generic tables: polar angle and azimuth of lamp and receiver, then wavelengths or R, G, B."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from relgloss_view.measure.gonio import spherical
from relgloss_view.measure.readers.assemble import assemble
from relgloss_view.measure.readers.columns import split_columns
from relgloss_view.measure.readers.csv_table import TextTable
from relgloss_view.measure.readers.declared import declared, same_side
from relgloss_view.measure.readers.options import ReadOptions
from relgloss_view.measure.table import Measurement

#: Column names and the largest magnitude of each angle, degrees.
COLUMNS = {
    "theta_i_deg": 90.0,
    "phi_i_deg": 360.0,
    "theta_r_deg": 90.0,
    "phi_r_deg": 360.0,
}


def read(table: TextTable, options: ReadOptions) -> Measurement:
    """Read a parsed generic table; `i` is the lamp, `r` the receiver. Raises InputError.

    options: replace what the file declares; those without a use have no effect but a warning.
    """
    facts = declared(table, options)
    angles, bands, readings = split_columns(table, COLUMNS, facts.angle_unit)
    if same_side(table, options.mirror):
        angles = angles + np.array([0.0, 0.0, 0.0, 180.0])
    theta_i, phi_i, theta_r, phi_r = angles.T
    directions = spherical(theta_i, phi_i), spherical(theta_r, phi_r)
    measurement = assemble(table.path, facts, angles, bands, readings, directions, np.abs(theta_i))
    unused = options.unused("gamma_s_deg", "part")
    return replace(measurement, warnings=(*measurement.warnings, *unused))
