"""Hash, Gaussian tilt of the normal, and the mean of a lobe over that tilt.

The twin of shaders/noise.glsl: same function names; the integers are identical, the rest is in
float64. Angles are radians.
"""

from __future__ import annotations

import numpy as np

from relgloss_view.base.arrays import Array, Ints, UInts

ATTEMPTS = 4


def pcg3d(v: UInts) -> UInts:
    """Hash of three 32-bit integers, (..., 3) (Jarzynski, Olano 2020).

    >>> pcg3d(np.array([1, 2, 3], dtype=np.uint32)).tolist()
    [4204755366, 1223881804, 1500469937]
    """
    # Slices keep an axis: numpy warns of wrap-around on scalars, not on arrays.
    x, y, z = (v[..., k : k + 1] * _U(1664525) + _U(1013904223) for k in range(3))
    x += y * z
    y += z * x
    z += x * y
    x ^= x >> _U(16)
    y ^= y >> _U(16)
    z ^= z >> _U(16)
    x += y * z
    y += z * x
    z += x * y
    return np.concatenate([x, y, z], axis=-1)


def cell_hash(cell: Ints, seed: int) -> UInts:
    """Three hashes of a grain cell (column, row, face), (..., 3); negative cells wrap."""
    key = np.array(cell, dtype=np.int64).astype(np.uint32)
    key[..., 2] = _U(seed) + key[..., 2] * _U(0x9E3779B9)
    return pcg3d(key)


def uniforms(hashes: UInts) -> Array:
    """Numbers inside (0, 1) from the upper 23 bits; exact in float32 too.

    >>> uniforms(np.array([0, 2**32 - 1], dtype=np.uint32)).tolist() == [2.0**-24, 1.0 - 2.0**-24]
    True
    """
    return np.asarray(((hashes >> _U(9)).astype(np.float64) + 0.5) * 2.0**-23)


def gaussians(u: Array) -> Array:
    """Two independent standard normals from two uniforms, (..., 2) (Box, Muller 1958)."""
    radius = np.sqrt(-2.0 * np.log(u[..., 0]))
    angle = 2.0 * np.pi * u[..., 1]
    return np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=-1)


def frame(n: Array) -> tuple[Array, Array]:
    """Tangent and bitangent of unit normals (Duff et al. 2017)."""
    x, y, z = np.moveaxis(n, -1, 0)
    side = np.where(z >= 0.0, 1.0, -1.0)
    a = -1.0 / (side + z)
    b = x * y * a
    tangent = np.stack([1.0 + side * x * x * a, side * b, -side * x], axis=-1)
    bitangent = np.stack([b, side + y * y * a, -y], axis=-1)
    return tangent, bitangent


def tilt_angles(law: str, hashes: UInts, sigma: float) -> Array:
    """Tilt along tangent and bitangent, (..., 2).

    law: 'paper', the angle is Gaussian of standard deviation sigma and its azimuth uniform (Ishii
    et al.); 'tangent', both components are Gaussian, so the angle is Rayleigh distributed.
    sigma: radians.

    >>> hashes = cell_hash(np.stack([np.arange(4000)] * 3, axis=-1), 0)
    >>> angle = np.linalg.norm(tilt_angles("paper", hashes, 0.1), axis=-1)
    >>> round(float(np.sqrt(np.mean(angle**2))), 2)
    0.1
    """
    u = uniforms(hashes)
    g = gaussians(u[..., :2])
    if law == "tangent":
        return sigma * g
    azimuth = 2.0 * np.pi * u[..., 2]
    along = np.stack([np.cos(azimuth), np.sin(azimuth)], axis=-1)
    return np.asarray(sigma * g[..., :1] * along)


def tilted(n: Array, angles: Array) -> Array:
    """Unit normals turned by the tilt, (..., 3)."""
    tangent, bitangent = frame(n)
    theta = np.linalg.norm(angles, axis=-1, keepdims=True)
    sinc = np.sinc(theta / np.pi)
    turned = n * np.cos(theta) + sinc * (angles[..., :1] * tangent + angles[..., 1:] * bitangent)
    return np.asarray(turned / np.linalg.norm(turned, axis=-1, keepdims=True))


def visible_tilt(n: Array, o: Array, angles: Array) -> Array:
    """Normals turned by angles (..., 2) along tangent and bitangent, for an eye in direction o.

    A tilt that would turn the grain away from the eye is halved up to three times, then dropped.
    """
    result = np.array(n)
    open_ = np.ones(n.shape[:-1], dtype=bool)
    for _ in range(ATTEMPTS):
        candidate = tilted(n, angles)
        visible = open_ & (np.sum(candidate * o, axis=-1) > 0.0)
        result[visible] = candidate[visible]
        open_ &= ~visible
        angles = 0.5 * angles
    return result


def noisy_normal(law: str, n: Array, o: Array, hashes: UInts, sigma: float) -> Array:
    """The tilted normal of a grain, (..., 3), whose tilt follows from its hash."""
    if law == "none" or sigma <= 0.0:
        return n
    return visible_tilt(n, o, tilt_angles(law, hashes, sigma))


def mean_lobe(delta: Array, s: float, sigma: float, law: str = "paper") -> Array:
    """Expectation of exp(-delta'^2 / 2 s^2), delta' the tilted normal's angle to the half-vector.

    Gaussian tilt of uniform azimuth ('paper'): (1 + q^2)^-1/2 exp(-delta^2 / 2(s^2 + sigma^2))
    I0e(z), q = sigma/s, z = delta^2 sigma^2 / (4 s^2 (s^2 + sigma^2)). delta, s, sigma: radians,
    small; Fresnel, masking and cosines are taken as constant. Replace s by s/sqrt(2) for the second
    moment.

    >>> mean_lobe(np.array([0.0]), 0.1, 0.1, "tangent").round(6).tolist()  # s^2 / (s^2 + sigma^2)
    [0.5]
    >>> mean_lobe(np.array([0.0]), 0.1, 0.1).round(6).tolist()  # (1 + q^2)^-1/2
    [0.707107]
    """
    from scipy.special import i0e

    total = s * s + sigma * sigma
    envelope = np.exp(-np.square(delta) / (2.0 * total))
    if law == "tangent":
        return np.asarray(s * s / total * envelope)
    z = np.square(delta) * sigma * sigma / (4.0 * s * s * total)
    return np.asarray(s / np.sqrt(total) * envelope * i0e(z))


def _U(value: int) -> np.uint32:
    return np.uint32(value & 0xFFFFFFFF)
