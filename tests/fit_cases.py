"""Synthetic samples with a known truth for the tests of the fit."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from relgloss_view.material import brdf
from relgloss_view.measure import gonio, table
from relgloss_view.measure.bands import Bands
from relgloss_view.measure.table import Measurement

Array = NDArray[np.float64]

ALBEDO = (0.05, 0.3, 0.5, 0.1)
NORMAL = np.array([0.0, 0.0, 1.0])
GRID = gonio.gcms4_grid()
#: The regular part of the grid alone: no one-degree scan across the mirror direction.
COARSE = GRID[np.isclose((GRID[:, 0] + GRID[:, 1]) % 10.0, 0.0)]


def directions(grid: Array = GRID) -> tuple[Array, Array]:
    alpha, beta, gamma = grid.T
    return gonio.gcms_directions(alpha, beta, gamma, gonio.GAMMA_S_DEG)


def facing(grid: Array = GRID) -> brdf.Facing:
    i, o = directions(grid)
    return brdf.facing(np.broadcast_to(NORMAL, i.shape), i, o)


def lobe(f: brdf.Facing, s_deg: float, n: float = 1.5) -> Array:
    return np.pi * brdf.torrance_sparrow(f, float(np.radians(s_deg)), n)


def truth(
    lobes: tuple[tuple[float, object], ...] = (),
    sigma: float = 0.1,
    albedo: tuple[float, ...] = ALBEDO,
    grid: Array = GRID,
) -> Array:
    """Radiance factors (N, B); `lobes` holds (s_deg, strength or strengths)."""
    f = facing(grid)
    first, second = brdf.oren_nayar(f, sigma)
    kd = np.asarray(albedo)
    value = np.pi * (first[:, None] * kd + second[:, None] * kd**2)
    for s_deg, strength in lobes:
        value = value + lobe(f, s_deg)[:, None] * np.asarray(strength, dtype=np.float64)
    return value


def measured(
    value: Array, *, noise: float = 0.02, seed: int = 0, grid: Array = GRID
) -> Measurement:
    """A goniophotometer table of the given radiance factors, with multiplicative noise."""
    i, o = directions(grid)
    value = value * np.exp(noise * np.random.default_rng(seed).standard_normal(value.shape))
    apart = np.degrees(np.arccos(np.clip(np.sum(i * o, axis=1), -1.0, 1.0)))
    low = np.minimum(i[:, 2], o[:, 2]) < gonio.GRAZING_COSINE
    reasons = np.where(apart < gonio.OCCLUSION_DEG, table.OCCLUDED, table.KEPT)
    reasons = np.where(low, table.GRAZING, reasons)
    bands = Bands(tuple(500.0 + 10.0 * np.arange(value.shape[1])))
    group = np.rint(grid[:, 0]).astype(np.int64)
    return Measurement(
        "case", "synthetic", i, o, bands, value, reasons, group,
        gamma_s_deg=gonio.GAMMA_S_DEG, synthetic=True,
    )  # fmt: skip
