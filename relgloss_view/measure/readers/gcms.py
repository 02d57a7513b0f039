"""Tables of a GCMS-type goniophotometer: lamp alpha, receiver beta, tilt gamma of the sample."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from relgloss_view.measure import ridge
from relgloss_view.measure.gonio import gcms_directions
from relgloss_view.measure.quantity import canonical_quantity
from relgloss_view.measure.readers.assemble import assemble
from relgloss_view.measure.readers.columns import split_columns
from relgloss_view.measure.readers.csv_table import TextTable
from relgloss_view.measure.readers.declared import declared, same_side
from relgloss_view.measure.readers.options import ReadOptions
from relgloss_view.measure.table import Measurement

#: Column names and the largest magnitude of each angle, degrees.
COLUMNS = {"alpha_deg": 90.0, "beta_deg": 90.0, "gamma_deg": 90.0}


def read(table: TextTable, options: ReadOptions) -> Measurement:
    """Read a parsed GCMS table. Raises InputError.

    options: replace what the file declares. The tilt gamma_s is checked against the ridge in the
    data.
    """
    facts = declared(table, options)
    angles, bands, readings = split_columns(table, COLUMNS, facts.angle_unit)
    if same_side(table, options.mirror):
        angles = angles * np.array([1.0, -1.0, 1.0])
    alpha, beta, gamma = angles.T
    directions = gcms_directions(alpha, beta, gamma, facts.gamma_s_deg)
    measurement = assemble(
        table.path, facts, angles, bands, readings, directions, alpha, arms_occlude=True
    )
    kept = measurement.kept
    level = measurement.radiance_factor[kept].mean(axis=1)
    elsewhere = ridge.check(angles[kept], level, facts.gamma_s_deg, declared=facts.gamma_s_declared)
    return replace(
        measurement,
        gamma_s_deg=facts.gamma_s_deg,
        warnings=(
            *measurement.warnings,
            *([elsewhere] if elsewhere else []),
            *options.unused("part"),
        ),
    )


def write_gcms_csv(
    path: str | Path,
    *,
    name: str,
    source: str,
    quantity: str,
    gamma_s_deg: float,
    angles_deg: ArrayLike,
    wavelengths_nm: Sequence[float],
    values: ArrayLike,
    comments: Mapping[str, object] | None = None,
    digits: int = 6,
) -> None:
    """Write a table that `read` takes back.

    angles_deg: (N, 3), alpha, beta and gamma. wavelengths_nm: centres of the B bands, nanometres.
    values: (N, B), in the unit of the quantity, NaN for a missing reading. comments: further
    `# key: value` lines, such as aperture_sd_deg. digits: significant digits of a value.

    Raises ValueError where the shapes do not agree and OSError where the file can't be written.
    """
    angles = np.asarray(angles_deg, dtype=np.float64)
    readings = np.asarray(values, dtype=np.float64)
    if angles.shape != (len(angles), 3) or readings.shape != (len(angles), len(wavelengths_nm)):
        raise ValueError(
            f"angles {angles.shape} and values {readings.shape} do not make a table of "
            f"{len(wavelengths_nm)} bands"
        )
    facts = {
        "name": name,
        "source": source,
        "quantity": canonical_quantity(quantity, "quantity"),
        "gamma_s_deg": f"{gamma_s_deg:g}",
        **(comments or {}),
    }
    lines = [f"# {key}: {' '.join(str(value).split())}" for key, value in facts.items()]
    lines.append(",".join([*COLUMNS, *(f"{nm:g}" for nm in wavelengths_nm)]))
    for direction, row in zip(angles, readings, strict=True):
        fields = [f"{x:.10g}" for x in direction]
        fields += ["" if np.isnan(x) else f"{x:.{digits}g}" for x in row]
        lines.append(",".join(fields))
    Path(path).write_text("\n".join(lines) + "\n", encoding="utf-8", newline="\n")
