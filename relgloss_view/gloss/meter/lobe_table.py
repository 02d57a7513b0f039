"""What a lobe of unit strength sends into a meter or a colour instrument, from a table made once.

The shares of `geometry.lobe_flux` take milliseconds each; an estimate asks for a million of them.
They are smooth in the logarithm of the lobe's width, and their quotient to Fresnel's reflectance at
the instrument's own angle is smooth in the refractive index. So a table of a few widths and indices
(`scripts/make_lobe_table.py`) holds them: cubic in the logarithm of the width and of fourth degree
in the index it differs by less than 1e-4 of a share from the integral (tests).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from relgloss_view.base.arrays import Array
from relgloss_view.base.resources import asset
from relgloss_view.gloss.meter.geometry import (
    SPECULAR,
    Meter,
    Window,
    facet_flux,
)
from relgloss_view.material import brdf

#: Widths of the table in degrees, even in the logarithm, and its refractive indices.
WIDTHS_DEG = tuple(float(s) for s in np.geomspace(0.05, 40.0, 81))
INDICES = (1.3, 1.4, 1.5, 1.6, 1.7)
#: Incidence of colour instruments with a sphere (CIE 15:2004: d:8), degrees.
SPHERE_DEG = 8.0
#: The gloss trap that excludes the specular part, as a round opening about the mirror direction. No
#: standard fixes its size; a port of 25 mm in a sphere of 150 mm is seen under this angle.
TRAP = Meter(
    "trap", "gloss trap", "CIE 15:2004, d:8", SPHERE_DEG, (Window(10.0, 10.0, round=True),), (0, 0)
)
ALBEDO = "albedo-8"  #: share of the light from 8 degrees that the lobe reflects anywhere
TRAPPED = "trap-8"  #: and what of it falls into the gloss trap
#: The angle of each column, at whose reflectance its shares are stored as quotients.
ANGLES_DEG: dict[str, float] = {
    **{f"gloss-{angle}": float(angle) for angle in SPECULAR},
    ALBEDO: SPHERE_DEG,
    TRAPPED: SPHERE_DEG,
}
FINE = 1601  #: places in ln s at which the table is resampled; between them a line is exact to 1e-5


@dataclass(frozen=True)
class LobeTable:
    """The table, resampled for look-ups of thousands of lobes at once.

    polynomials: (FINE, C, I), for each place in ln s and each column of ANGLES_DEG the coefficients
    of a polynomial in `_scaled(index)`: the share over Fresnel's reflectance.
    """

    polynomials: Array

    def shares(self, columns: Sequence[str], log_s: Array, index: Array) -> Array:
        """Shares (N, C) of the light that lobes of unit strength send into instruments.

        columns: of ANGLES_DEG. log_s: (N,), natural logarithm of the width in degrees, held within
        the table. index: (N,), refractive index, 1.3 to 1.7.
        """
        low, high = np.log(WIDTHS_DEG[0]), np.log(WIDTHS_DEG[-1])
        place = np.clip((log_s - low) * ((FINE - 1) / (high - low)), 0.0, FINE - 1.000001)
        k = place.astype(np.intp)
        part = (place - k)[:, None]
        powers = np.vander(_scaled(index), len(INDICES), increasing=True)
        result = np.empty((len(place), len(columns)))
        for c, column in enumerate(columns):
            rows = self.polynomials[:, _COLUMNS.index(column)]
            near = rows[k] * (1.0 - part) + rows[k + 1] * part
            cos = np.cos(np.radians(ANGLES_DEG[column]))
            fresnel = brdf.fresnel_dielectric(cos, index)
            result[:, c] = np.einsum("ni,ni->n", near, powers) * fresnel
        return result


_COLUMNS = list(ANGLES_DEG)


def _scaled(index: ArrayLike) -> Array:
    """The refractive index, -1 to 1 over the table."""
    middle, half = 0.5 * (INDICES[0] + INDICES[-1]), 0.5 * (INDICES[-1] - INDICES[0])
    return (np.asarray(index, dtype=np.float64) - middle) / half


@lru_cache(maxsize=1)
def lobe_table() -> LobeTable:
    """The table that comes with relgloss."""
    with asset("gloss", "lobe_table.csv").open(encoding="utf-8") as file:
        rows = [line for line in file if not line.startswith("#")][1:]
    values = np.array([float(row.rpartition(",")[2]) for row in rows])
    quotients = values.reshape(len(_COLUMNS), len(WIDTHS_DEG), len(INDICES))
    nodes = _scaled(INDICES)[:, None] ** np.arange(len(INDICES))
    coefficients = np.linalg.solve(nodes, quotients[..., None])[..., 0]
    return LobeTable(_resampled(np.moveaxis(coefficients, 0, 1)))


def _resampled(values: Array) -> Array:
    """Cubic Lagrange interpolation along the first axis, from an even grid to FINE places."""
    last = len(values) - 1
    place = np.linspace(0.0, last, FINE)
    first = np.clip(place.astype(np.intp) - 1, 0, last - 3)
    x = place - first
    weights = (
        -(x - 1.0) * (x - 2.0) * (x - 3.0) / 6.0,
        x * (x - 2.0) * (x - 3.0) / 2.0,
        -x * (x - 1.0) * (x - 3.0) / 2.0,
        x * (x - 1.0) * (x - 2.0) / 6.0,
    )
    return np.asarray(sum(w[:, None, None] * values[first + k] for k, w in enumerate(weights)))


def exact_share(column: str, s_deg: float, index: float) -> float:
    """What the table holds, by the integral itself; slow."""
    s = float(np.radians(s_deg))
    amplitude = brdf.facet_amplitude(s)

    def flux(meter: Meter) -> float:
        return facet_flux(
            meter, meter.windows[0], lambda d2: brdf.facet_density(d2, s, amplitude), index, s
        )

    if column == ALBEDO:
        return _albedo(s_deg, index)
    if column == TRAPPED:
        return flux(TRAP)
    return flux(SPECULAR[round(ANGLES_DEG[column])])


def _albedo(s_deg: float, index: float) -> float:
    from relgloss_view.material.albedo import directional_albedo
    from relgloss_view.material.material import Diffuse, Lobe, Material
    from relgloss_view.measure.bands import RGB

    lobe = Lobe((1.0,), s_deg, index)
    alone = Material("lobe", "table", RGB, Diffuse("lambert", (0.0,) * 3), (lobe,))
    return float(directional_albedo(alone, SPHERE_DEG)[1][0, 0])
