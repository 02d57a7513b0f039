"""What gloss meters and a picture's highlight would be on a sample whose reflection is known.

Direct quadrature over a meter's window and source image, written apart from
relgloss_view.gloss.meter: other nodes, other code, the same definitions (ISO 2813, ASTM D523,
TAPPI T 480). Readings are in gloss units, luminous for illuminant C.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.bench.verdicts.reflection import TrueSample, interface
from relgloss_view.material import spectra
from relgloss_view.measure.bands import Bands

#: Incidence -> full angles of the window in and across the plane, of the source image, glass.
METERS = {
    20: ((1.8, 3.6), (0.75, 2.5), 1.567),
    60: ((4.4, 11.7), (0.75, 2.5), 1.567),
    85: ((4.0, 6.0), (0.75, 2.5), 1.567),
    75: ((11.4, 11.4), (0.0, 0.0), 1.540),
}
ROUND = (75,)  #: whose window is a disc
#: Incidences at which a picture of a cylinder shows the highlight: lamps at 50 and 110 degrees.
PEAK_DEG = (25.0, 55.0)
NODES = 24  #: on each side of the mirror image, in each direction
SOURCE_NODES = 6


@lru_cache(maxsize=8)
def _gauss(count: int) -> tuple[Array, Array]:
    return np.polynomial.legendre.leggauss(count)


def _peaked_nodes(centre: float, half: float, width: float) -> tuple[Array, Array]:
    """Nodes and weights on [-half, half], dense around `centre` at the scale `width`."""
    node, weight = _gauss(NODES)
    nodes, weights = [], []
    for end in (-half, half):
        length = np.arcsinh((end - centre) / width)
        u = 0.5 * length * (node + 1.0)
        nodes.append(centre + width * np.sinh(u))
        weights.append(0.5 * abs(length) * weight * width * np.cosh(u))
    return np.concatenate(nodes), np.concatenate(weights)


def _spin(directions: Array, azimuth_deg: float) -> Array:
    c, s = np.cos(np.radians(azimuth_deg)), np.sin(np.radians(azimuth_deg))
    x, y = directions[..., 0], directions[..., 1]
    return np.stack([c * x - s * y, s * x + c * y, directions[..., 2]], axis=-1)


def luminous_weights(wavelengths_nm: Array) -> Array:
    """Weights (B, 3) of X, Y, Z for illuminant C; Y of a perfect diffuser is 1."""
    bands = Bands(tuple(float(nm) for nm in wavelengths_nm))
    return spectra.xyz_weights(bands, spectra.illuminant("C"))


def gloss(sample: TrueSample, angle_deg: int, azimuth_deg: float = 0.0) -> float:
    """The reading at 20, 60, 85 or 75 degrees with the sample turned by an azimuth, gloss units."""
    (window_x, window_y), (source_x, source_y), glass = METERS[angle_deg]
    theta = np.radians(angle_deg)
    luminous = _luminous_brdf(sample)
    half_x, half_y = (np.tan(np.radians(0.5 * w)) for w in (window_x, window_y))
    width = np.radians(max(sample.narrowest_deg, 0.02))
    node, weight = _gauss(SOURCE_NODES)
    sx = np.tan(np.radians(0.5 * source_x)) * node if source_x else np.zeros(1)
    sy = np.tan(np.radians(0.5 * source_y)) * node if source_y else np.zeros(1)
    wx = weight / 2.0 if source_x else np.ones(1)
    wy = weight / 2.0 if source_y else np.ones(1)
    flux = glass_flux = 0.0
    for x0, share_x in zip(sx, wx, strict=True):
        for y0, share_y in zip(sy, wy, strict=True):
            i = _point(theta, x0, y0, -1.0)
            r_s, r_p = interface(np.asarray(i[2]), np.asarray(glass))
            glass_flux += share_x * share_y * 0.5 * float(abs(r_s) ** 2 + abs(r_p) ** 2)
            # The mirror image of a point (x, y) of the source is (x, -y) in this frame.
            xs, ws = _peaked_nodes(x0, half_x, 2.0 * width)
            ys, vs = _peaked_nodes(-y0, half_y, 2.0 * width * np.cos(theta))
            if angle_deg in ROUND:
                xs, ws = _peaked_nodes(0.0, half_x, 2.0 * width)
                chord = np.sqrt(np.maximum(half_x**2 - xs**2, 0.0))
                scale = 2.0 * width * np.cos(theta)
                pairs = [_peaked_nodes(0.0, c, scale) for c in chord]
                y = np.stack([p[0] for p in pairs])
                area = ws[:, None] * np.stack([p[1] for p in pairs])
                x = np.broadcast_to(xs[:, None], y.shape)
            else:
                x, y = np.meshgrid(xs, ys, indexing="ij")
                area = ws[:, None] * vs
            o = _point(theta, x, y, 1.0)
            solid = area * (1.0 + x * x + y * y) ** -1.5
            value = luminous(_spin(i, azimuth_deg), _spin(o, azimuth_deg))
            flux += share_x * share_y * float(np.sum(solid * value * o[..., 2]))
    return 100.0 * flux / glass_flux


def _point(theta: float, x: float | Array, y: float | Array, side: float) -> Array:
    """Unit vector to a point (x, y) of the plane at unit distance on the axis of lamp or receiver.

    x grows away from the normal for the receiver (side 1) and for the lamp (side -1) alike.
    """
    x, y = np.broadcast_arrays(np.asarray(x, dtype=np.float64), np.asarray(y, dtype=np.float64))
    v = np.stack(
        [
            side * (np.sin(theta) + x * np.cos(theta)),
            y,
            np.cos(theta) - x * np.sin(theta),
        ],
        axis=-1,
    )
    return np.asarray(v / np.linalg.norm(v, axis=-1, keepdims=True))


def _luminous_brdf(sample: TrueSample) -> Callable[[Array, Array], Array]:
    """The luminous BRDF, 1/sr, as a function of directions; spectra are summed once.

    A lobe's luminous reflectance is interpolated over 2,001 cosines, which leaves errors of 1e-6.
    """
    weights = luminous_weights(sample.wavelengths_nm)[:, 1]
    rho = sample.body.albedo
    rho_y, rho2_y = float(rho @ weights), float(rho**2 @ weights)
    cosines = np.linspace(0.0, 1.0, 2001)
    tables = [h.surface.reflectance(cosines) @ (weights * h.strength) for h in sample.highlights]

    def value(i: Array, o: Array) -> Array:
        i = np.broadcast_to(i, o.shape)
        first, second = sample.body.mean(i, o)
        total = rho_y * first + rho2_y * second
        for lobe, table in zip(sample.highlights, tables, strict=True):
            mirror, cos_d = lobe.without_fresnel(i, o)
            total = total + mirror * np.interp(cos_d, cosines, table)
        if sample.retro is not None:
            total = total + sample.retro.mean(i, o)
        return np.asarray(total)

    return value


def peak(sample: TrueSample, incidence_deg: float, azimuth_deg: float = 0.0) -> Array:
    """XYZ (3,) of the highlight's top relative to a perfect diffuser, illuminant C."""
    theta = np.radians(incidence_deg)
    i = _spin(np.array([-np.sin(theta), 0.0, np.cos(theta)]), azimuth_deg)
    o = _spin(np.array([np.sin(theta), 0.0, np.cos(theta)]), azimuth_deg)
    return np.asarray(np.pi * sample.brdf(i, o) @ luminous_weights(sample.wavelengths_nm))


@dataclass(frozen=True)
class Truth:
    """What is right about a sample, in each orientation that counts."""

    gloss: dict[int, tuple[float, ...]]  #: meter -> reading in each orientation
    peak: dict[float, tuple[Array, ...]]  #: incidence -> XYZ in each orientation


def truth_of(sample: TrueSample, azimuths_deg: tuple[float, ...] = (0.0,)) -> Truth:
    """Readings and peaks with the sample turned by each azimuth."""
    return Truth(
        {m: tuple(gloss(sample, m, a) for a in azimuths_deg) for m in METERS},
        {t: tuple(peak(sample, t, a) for a in azimuths_deg) for t in PEAK_DEG},
    )
