"""Overview: what a measured table holds and how good it is, in numbers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from relgloss_view.base.arrays import Array, Mask
from relgloss_view.measure.findings import Finding, examine
from relgloss_view.measure.findings.rows import Rows
from relgloss_view.measure.overview.directions import Direction, directions
from relgloss_view.measure.overview.polar import Polar
from relgloss_view.measure.overview.reciprocity import Reciprocity, reciprocity
from relgloss_view.measure.overview.repeats import Repeats, repeats
from relgloss_view.measure.overview.ridges import Summit, summits
from relgloss_view.measure.table import SATURATED, Measurement

#: Rows of each reason that are listed.
MOST_LISTED = 3
#: A reason that no reader marks: a fit passes over such rows, where an arm may be in the way.
DARK = "zero in every band"


@dataclass(frozen=True)
class LeftOut:
    """Rows that are left out for one reason."""

    reason: str
    count: int
    first: tuple[int, ...]  #: rows of the table, from 0


@dataclass(frozen=True)
class Overview:
    """What a table shows of itself. Angles are in degrees, readings radiance factors."""

    measurement: Measurement  #: with the rows on a plateau marked as saturated
    mask: Mask  #: (N,), rows that are used
    polar: Polar  #: angles of all N rows
    level: Array  #: (N,), mean over the bands
    left_out: tuple[LeftOut, ...]  #: by reason, the most frequent first
    summits: tuple[Summit, ...]  #: the mirror ridge, by incidence
    repeats: Repeats
    reciprocity: Reciprocity
    directions: tuple[Direction, ...]
    findings: tuple[Finding, ...]

    @property
    def used(self) -> int:
        """Number of geometries that are used."""
        return int(self.mask.sum())

    @property
    def warnings(self) -> tuple[str, ...]:
        """What the reader reports."""
        return self.measurement.warnings

    @property
    def ridge_offset_deg(self) -> float | None:
        """Median distance of the ridge from the mirror direction, receiver's angle."""
        offsets = [s.offset_deg for s in self.summits if s.offset_deg is not None]
        return float(np.median(offsets)) if offsets else None

    def as_json(self) -> dict[str, Any]:
        """The overview as JSON holds it; numbers that are not known are null."""
        table, repeated, pairs = self.measurement, self.repeats, self.reciprocity
        at = self._geometry
        used = self.mask
        return {
            "name": table.name,
            "source": table.source,
            "file": table.file,
            "format": table.format,
            "quantity": table.quantity,
            "synthetic": table.synthetic,
            "bands": list(table.bands.labels),
            "geometries": len(table.reasons),
            "used": self.used,
            "incidence_deg": _span(self.polar.lamp_deg[used]),
            "receiver_deg": _span(self.polar.receiver_deg[used]),
            "in_plane": int(np.sum(self.polar.out_of_plane_deg[used] < 0.5)),
            "radiance_factor": _span(table.radiance_factor[used]),
            "aperture_sd_deg": list(table.aperture_sd_deg),
            "gamma_s_deg": table.gamma_s_deg,
            "left_out": [
                {"reason": o.reason, "count": o.count, "first": [at(row) for row in o.first]}
                for o in self.left_out
            ],
            "saturated": sum(o.count for o in self.left_out if o.reason == SATURATED),
            "mirror_ridge": {
                "offset_deg": self.ridge_offset_deg,
                "summits": [
                    {
                        "incidence_deg": s.incidence_deg,
                        "receiver_deg": s.receiver_deg,
                        "offset_deg": s.offset_deg,
                        "radiance_factor": s.radiance_factor,
                    }
                    for s in self.summits
                ],
            },
            "repeatability": {
                "geometries": repeated.geometries,
                "readings": repeated.readings,
                "relative_sd": repeated.relative_sd,
                "largest": repeated.largest,
                "copies": repeated.copies,
                "widest": [at(row) for row in repeated.rows],
            },
            "reciprocity": {
                "pairs": pairs.pairs,
                "interpolated": pairs.interpolated,
                "median": pairs.typical(),
                "p95": pairs.typical(95.0),
                "bias": pairs.bias,
                "near_mirror_median": pairs.typical(where=pairs.near_mirror),
                "body_median": pairs.typical(where=~pairs.near_mirror),
            },
            "spectra": [
                {
                    "part": d.part,
                    **at(d.row),
                    "radiance_factor": table.radiance_factor[d.row].tolist(),
                }
                for d in self.directions
            ],
            "findings": [
                {"about": f.kind, "text": f.text, "serious": f.serious} for f in self.findings
            ],
            "warnings": list(self.warnings),
        }

    def _geometry(self, row: int) -> dict[str, Any]:
        """A row of the table as JSON holds it, counted from 1."""
        level = float(self.level[row])
        return {
            "row": row + 1,
            "lamp_deg": float(self.polar.lamp_deg[row]),
            "receiver_deg": float(self.polar.signed_receiver_deg[row]),
            "out_of_plane_deg": float(self.polar.out_of_plane_deg[row]),
            "mean_radiance_factor": level if np.isfinite(level) else None,
        }


def look_over(measurement: Measurement) -> Overview:
    """What a measurement shows of itself before any fit; any number of geometries is enough.

    >>> from relgloss_view import read_measurement
    >>> paper = look_over(read_measurement("art-coated"))
    >>> paper.used, [(o.reason, o.count) for o in paper.left_out]
    (931, [('lamp and receiver within 8 degrees', 66)])
    """
    examined = examine(measurement)
    table = examined.measurement
    polar = Polar.of(table)
    level = np.asarray(table.radiance_factor.mean(axis=1))
    rows = Rows.of(table)
    dark = table.kept & ~np.any(np.nan_to_num(table.radiance_factor) > 0.0, axis=1)
    used = table.kept & ~dark
    at = np.flatnonzero(used)
    with np.errstate(all="ignore"):
        return Overview(
            measurement=table,
            mask=used,
            polar=polar,
            level=level,
            left_out=_left_out(table, dark),
            summits=summits(rows, polar.subset(rows.index)),
            repeats=repeats(table.to_lamp[at], table.to_receiver[at], level[at], at),
            reciprocity=reciprocity(polar.subset(used), level[at]),
            directions=directions(polar, used),
            findings=examined.findings,
        )


def _left_out(measurement: Measurement, dark: Mask) -> tuple[LeftOut, ...]:
    masks = {reason: measurement.reasons == reason for reason in measurement.left_out()}
    if np.any(dark):
        masks[DARK] = dark
    parts = [
        LeftOut(reason, int(mask.sum()), tuple(np.flatnonzero(mask)[:MOST_LISTED].tolist()))
        for reason, mask in masks.items()
    ]
    return tuple(sorted(parts, key=lambda part: -part.count))


def _span(values: Array) -> list[float] | None:
    finite = values[np.isfinite(values)]
    return [float(finite.min()), float(finite.max())] if finite.size else None
