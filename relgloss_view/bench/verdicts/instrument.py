"""Goniophotometers that read a known sample: grids, open apertures, noise, and their CSV files.

Every table goes through the file that an instrument would write, so that the readers' own checks
take part. Apertures are hard discs over which the reflection is averaged on both sides.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from relgloss_view.base.arrays import Array, Ints
from relgloss_view.bench.verdicts.reflection import TrueSample
from relgloss_view.measure import gonio

GCMS, GENERIC = "gcms", "generic"
HEADERS = {
    GCMS: "alpha_deg,beta_deg,gamma_deg",
    GENERIC: "theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg",
}
#: Noise as goniophotometers have it: common to a plane of incidence, to a sample, an offset of the
#: table in radiance factor, and a reading's own.
PLANE_NOISE, SAMPLE_NOISE, OFFSET_NOISE, READING_NOISE = 0.02, 0.01, 0.003, 0.002
#: Geometries evaluated at once; each takes up to 1,024 pairs of directions.
CHUNK = 48
RINGS, SPOKES = 4, 8


@dataclass(frozen=True)
class Grid:
    """The angles at which an instrument reads."""

    name: str
    convention: str  #: GCMS or GENERIC
    angles_deg: Array  #: (N, 3) alpha, beta, gamma; or (N, 4) theta_i, phi_i, theta_r, phi_r
    finest_s_deg: float  #: the narrowest lobe that its steps resolve
    out_of_plane: bool

    @property
    def plane(self) -> Ints:
        """(N,), which samples share a plane or a setting of the lamp."""
        lamp = self.angles_deg[:, :1] if self.convention == GCMS else self.angles_deg[:, :2]
        return np.asarray(np.unique(np.rint(10.0 * lamp), axis=0, return_inverse=True)[1].ravel())


def _unique(rows: Sequence[tuple[float, ...]]) -> Array:
    return np.array(list(dict.fromkeys(rows)), dtype=np.float64)


def _aside(theta_i: float, theta_r: float) -> tuple[float, ...]:
    """In-plane angles with the mirror direction at theta_r = theta_i."""
    return (theta_i, 180.0, theta_r, 0.0) if theta_r >= 0.0 else (theta_i, 180.0, -theta_r, 180.0)


def paper_grid(rng: np.random.Generator, s_deg: float) -> Grid:
    """The grid of Ishii et al., 997 geometries."""
    return Grid("paper's GCMS grid", GCMS, gonio.gcms4_grid(), 0.4, True)


def coarse_grid(rng: np.random.Generator, s_deg: float) -> Grid:
    """Its regular part alone, in steps of ten degrees."""
    grid = gonio.gcms4_grid()
    regular = np.isclose((grid[:, 0] + grid[:, 1]) % 10.0, 0.0)
    return Grid("GCMS grid without the scan", GCMS, grid[regular], 5.0, True)


def in_plane_grid(rng: np.random.Generator, s_deg: float) -> Grid:
    """Receiver scans in the plane at 5 to 8 incidences, finer around the mirror direction."""
    count = int(rng.integers(5, 9))
    incidences = np.sort(rng.choice([5.0, 15, 20, 30, 40, 45, 50, 60, 65, 70, 75], count, False))
    fine = float(rng.choice([0.5, 1.0]))
    rows = []
    for i in incidences:
        receivers = [*np.arange(-75.0, 75.1, 2.5), *(i + np.arange(-6.0, 6.01, fine))]
        rows += [_aside(float(i), float(r)) for r in receivers if abs(r) <= 80 and abs(r + i) > 5]
    return Grid("in-plane scans", GENERIC, _unique(rows), 0.6 * fine + 0.1, False)


def in_plane_gcms_grid(rng: np.random.Generator, s_deg: float) -> Grid:
    """The same by a GCMS at one tilt."""
    count = int(rng.integers(5, 9))
    alphas = np.sort(rng.choice([-75.0, -70, -60, -50, -45, -30, -20, -15, -5], count, False))
    fine = float(rng.choice([0.5, 1.0]))
    rows = []
    for a in alphas:
        betas = [*np.arange(-75.0, 75.1, 2.5), *(-a + np.arange(-6.0, 6.01, fine))]
        rows += [(float(a), float(b), 15.0) for b in betas if abs(b) <= 80.0]
    return Grid("in-plane scans, GCMS", GCMS, _unique(rows), 0.6 * fine + 0.1, False)


def mirror_scan_grid(rng: np.random.Generator, s_deg: float) -> Grid:
    """A GCMS that crosses the mirror direction in steps of half a degree, in and out of plane."""
    rows: list[tuple[float, ...]] = []
    for a in (-20.0, -45.0, -60.0, -75.0):
        rows += [(a, -a + d, 15.0) for d in np.arange(-6.0, 6.01, 0.5) if -a + d <= 80.0]
        rows += [(a, float(b), 15.0) for b in np.arange(-70.0, 75.1, 5.0)]
        rows += [(a, -a + d, 15.0 + g) for g in (-10, -5, -2, -1, -0.5, 0.5, 1, 2, 5, 10, 30)
                 for d in (-2.0, 0.0, 2.0)]  # fmt: skip
    return Grid("half-degree mirror scan", GCMS, _unique(rows), 0.4, True)


def hemisphere_grid(rng: np.random.Generator, s_deg: float) -> Grid:
    """Receivers over the hemisphere at four or five incidences, with a patch around the mirror."""
    incidences = (10.0, 25.0, 40.0, 55.0, 65.0)[: int(rng.integers(4, 6))]
    step = float(rng.choice([1.0, 2.0]))
    rows = []
    for i in incidences:
        rows += [
            (i, 180.0, float(t), float(p)) for t in range(0, 76, 10) for p in range(0, 360, 30)
        ]
        rows += [
            (i, 180.0, i + a * step, float(np.round(b * step / np.sin(np.radians(i)), 4)) % 360.0)
            for a in range(-4, 5) for b in range(-4, 5) if i + a * step >= 1.0
        ]  # fmt: skip
    return Grid("hemisphere", GENERIC, _unique(rows), 0.7 * step, True)


def tabulated_grid(rng: np.random.Generator, s_deg: float) -> Grid:
    """The grid at which relgloss reads tabulated BRDFs: six azimuths and the one-degree scan."""
    theta_i, theta_r, phi = gonio.tabulated_grid().T
    angles = np.stack([theta_i, np.full_like(phi, 180.0), theta_r, 180.0 - phi], axis=1)
    return Grid("tabulated BRDF", GENERIC, angles, 0.5, True)


def half_vector_grid(rng: np.random.Generator, s_deg: float) -> Grid:
    """Half-vectors in rings as wide as the lobe, as adaptive instruments place them (RGL)."""
    rings = np.unique(np.concatenate([s_deg * np.array([0.3, 0.7, 1, 1.5, 2, 3, 5]), [15, 30, 45]]))
    rows = []
    for i in (5.0, 20.0, 35.0, 50.0, 62.0, 74.0):
        lamp = gonio.spherical(i, 180.0)
        for delta in (0.0, *rings):
            for turn in np.arange(0.0, 360.0, 30.0) if delta else (0.0,):
                h = gonio.spherical(delta, turn)
                o = 2.0 * (lamp @ h) * h - lamp
                theta = float(np.degrees(np.arccos(np.clip(o[2], -1.0, 1.0))))
                if theta <= 80.0:
                    phi = float(np.degrees(np.arctan2(o[1], o[0]))) % 360.0
                    rows.append((i, 180.0, round(theta, 4), round(phi, 4)))
    return Grid("rings of half-vectors", GENERIC, _unique(rows), 0.4, True)


#: Grids that sound tables are measured on.
GRIDS = (
    paper_grid, in_plane_grid, in_plane_gcms_grid, mirror_scan_grid, hemisphere_grid,
    tabulated_grid, half_vector_grid,
)  # fmt: skip


@lru_cache(maxsize=4)
def _disc(rings: int, spokes: int) -> tuple[Array, Array]:
    """Points (P, 2) on the unit disc and their weights, which sum to one."""
    node, weight = np.polynomial.legendre.leggauss(rings)
    radius = np.sqrt(0.5 * (node + 1.0))
    turns = 2.0 * np.pi * (np.arange(spokes)[None, :] + 0.5 * (np.arange(rings)[:, None] % 2))
    angle = turns / spokes
    points = np.stack([radius[:, None] * np.cos(angle), radius[:, None] * np.sin(angle)], axis=-1)
    return points.reshape(-1, 2), np.repeat(0.5 * weight / spokes, spokes)


@lru_cache(maxsize=2)
def _bell(nodes: int) -> tuple[Array, Array]:
    """Points (P, 2) of a two-dimensional unit Gaussian, and weights (Gauss-Hermite)."""
    x, w = np.polynomial.hermite_e.hermegauss(nodes)
    w = w / w.sum()
    points = np.stack(np.meshgrid(x, x, indexing="ij"), axis=-1).reshape(-1, 2)
    return points, np.outer(w, w).ravel()


def _around(axis: Array, offsets: Array) -> Array:
    """Unit vectors (N, P, 3) beside the axes (N, 3) by tangents of angles (P, 2)."""
    helper = np.where(np.abs(axis[:, 2:]) < 0.9, [[0.0, 0.0, 1.0]], [[0.0, 1.0, 0.0]])
    first = np.cross(helper, axis)
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    second = np.cross(axis, first)
    v = axis[:, None] + offsets[:, 0, None] * first[:, None] + offsets[:, 1, None] * second[:, None]
    return np.asarray(v / np.linalg.norm(v, axis=-1, keepdims=True))


def read(
    sample: TrueSample, i: Array, o: Array, sd_deg: tuple[float, float], *, soft: bool = False
) -> Array:
    """Radiance factors (N, B) through apertures of per-axis deviations sd_deg on both sides.

    A disc of diameter d has the deviation d / 4. The reading is the light that passes both
    apertures relative to that from a perfect diffuser. soft: Gaussian apertures instead of discs.
    """
    delta = np.degrees(np.arccos(np.clip(_half(i, o)[:, 2], -1.0, 1.0)))
    reach = 9.0 * sample.narrowest_deg + 3.0 * float(np.hypot(*sd_deg))
    if sample.retro is not None:
        apart = np.degrees(np.arccos(np.clip(np.sum(i * o, axis=1), -1.0, 1.0)))
        delta = np.minimum(delta, apart)
    near = delta < reach
    result = np.empty((len(i), len(sample.wavelengths_nm)))
    for which, fine in ((near, True), (~near, False)):
        for rows in np.array_split(np.flatnonzero(which), max(1, int(which.sum()) // CHUNK)):
            if len(rows):
                result[rows] = _averaged(sample, i[rows], o[rows], sd_deg, soft, fine)
    return result


def _half(i: Array, o: Array) -> Array:
    h = i + o
    return np.asarray(h / np.maximum(np.linalg.norm(h, axis=1, keepdims=True), 1e-12))


def _averaged(
    sample: TrueSample, i: Array, o: Array, sd_deg: tuple[float, float], soft: bool, fine: bool
) -> Array:
    if soft:
        points, weights = _bell(6 if fine else 2)
        scale = 1.0
    else:
        points, weights = _disc(RINGS, SPOKES) if fine else _disc(1, 4)
        scale = 2.0
    lamp, receiver = (
        _around(axis, scale * np.radians(sd) * points)
        for axis, sd in zip((i, o), sd_deg, strict=True)
    )
    shape = (len(i), len(points), len(points), 3)
    a = np.broadcast_to(lamp[:, :, None], shape)
    b = np.broadcast_to(receiver[:, None, :], shape)
    light = np.maximum(a[..., 2], 0.0) * np.maximum(b[..., 2], 0.0) * np.outer(weights, weights)
    white = np.maximum(light.sum(axis=(1, 2)), 1e-12) / np.pi

    def mean(value: Array) -> Array:
        return np.asarray((value * light).sum(axis=(1, 2)) / white)

    first, second = sample.body.mean(i, o)
    rho = sample.body.albedo
    total = np.pi * (first[:, None] * rho + second[:, None] * rho**2)
    for lobe in sample.highlights:
        total += mean(lobe.mean(a, b))[:, None] * lobe.colour(i, o)
    if sample.retro is not None:
        total += mean(sample.retro.mean(a, b))[:, None]
    return np.asarray(total)


def noisy(values: Array, plane: Ints, rng: np.random.Generator) -> Array:
    """Readings with correlated noise; see PLANE_NOISE and the constants beside it."""
    planes = np.exp(PLANE_NOISE * rng.standard_normal(int(plane.max()) + 1))[plane]
    samples = np.exp(SAMPLE_NOISE * rng.standard_normal(len(values)))
    each = np.exp(READING_NOISE * rng.standard_normal(values.shape))
    offset = OFFSET_NOISE * rng.standard_normal()
    return np.asarray(values * (planes * samples)[:, None] * each + offset)


def as_csv(
    convention: str, angles_deg: Array, wavelengths_nm: Array, values: Array, facts: dict[str, str]
) -> str:
    """The text of a table for the GCMS reader or the generic one."""
    lines = [f"# {key}: {text}" for key, text in facts.items()]
    lines.append(",".join([HEADERS[convention], *(f"{nm:g}" for nm in wavelengths_nm)]))
    for where, row in zip(angles_deg, values, strict=True):
        fields = [f"{x:.8g}" for x in where] + ["" if np.isnan(v) else f"{v:.6g}" for v in row]
        lines.append(",".join(fields))
    return "\n".join(lines) + "\n"
