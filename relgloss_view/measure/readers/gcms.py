"""Tables of a GCMS-type goniophotometer: lamp alpha, receiver beta, tilt gamma of the sample."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from relgloss_view.measure import ridge, screen
from relgloss_view.measure.gonio import gcms_directions
from relgloss_view.measure.quantity import known, to_radiance_factor
from relgloss_view.measure.readers.assemble import contradictions, require_samples
from relgloss_view.measure.readers.columns import split_columns
from relgloss_view.measure.readers.csv_table import TextTable
from relgloss_view.measure.readers.declared import declared
from relgloss_view.measure.table import KEPT, Measurement

#: Column names and the largest magnitude of each angle, degrees.
COLUMNS = {"alpha_deg": 90.0, "beta_deg": 90.0, "gamma_deg": 90.0}


def read(
    table: TextTable, quantity: str | None = None, gamma_s_deg: float | None = None
) -> Measurement:
    """Read a parsed GCMS table; the arguments win over the file. Raises InputError.

    The tilt gamma_s that sees the mirror direction is checked against the ridge in the data.
    """
    facts = declared(table, quantity, gamma_s_deg)
    angles, bands, readings = split_columns(table, COLUMNS)
    to_lamp, to_receiver = gcms_directions(
        angles[:, 0], angles[:, 1], angles[:, 2], facts.gamma_s_deg
    )
    reasons = screen.reasons(
        to_lamp, to_receiver, readings, saturation=facts.saturation, arms_occlude=True
    )
    factor = to_radiance_factor(readings, facts.quantity, to_receiver[:, 2])
    kept = reasons == KEPT
    found = [
        contradictions(angles, factor, kept),
        ridge.check(
            angles[kept],
            factor[kept].mean(axis=1),
            facts.gamma_s_deg,
            declared=facts.gamma_s_given,
        ),
    ]
    measurement = Measurement(
        name=facts.name,
        source=facts.source,
        to_lamp=to_lamp,
        to_receiver=to_receiver,
        bands=bands,
        radiance_factor=factor,
        reasons=reasons,
        group=np.rint(angles[:, 0]).astype(np.int64),
        aperture_sd_deg=facts.aperture_sd_deg,
        gamma_s_deg=facts.gamma_s_deg,
        warnings=(*facts.warnings, *(warning for warning in found if warning)),
    )
    return require_samples(measurement, table.path)


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

    angles_deg is (N, 3) of alpha, beta, gamma; values (N, B), in the given quantity, NaN for a
    missing reading, to so many significant digits. comments adds `# key: value` lines, such as
    aperture_sd_deg.
    Raises ValueError where the shapes do not agree and OSError where the file cannot be written.
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
        "quantity": known(quantity, "quantity"),
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
