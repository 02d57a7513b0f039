"""A smooth random field of tilts over the screen, for grain of one size at the eye.

The twin of shaders/grain_field.glsl: same function names. Independent Gaussians at the points of a
square lattice, weighted by a radial kernel, make a field without blocks or directions. Its power
spectrum is that of the kernel, which has a closed form (Sonine's integral).
"""

from __future__ import annotations

import math

import numpy as np

from relgloss_view.base.arrays import Array, Ints
from relgloss_view.picture.model.noise import cell_hash, gaussians, uniforms

FIELD_FACE = 6  #: of the hash: no face of an object has this number
FIELD_TILE = 4096  #: texels after which the field repeats
REACH_STEPS = 2.0  #: radius of the kernel, steps of the lattice
#: Lightness bends with the tilt, so that grain in L* is a little finer than the tilts that make it.
#: Tilts this much larger look as grainy on a fine display as the paper's pixels (docs/method.md).
FINER_LIGHTNESS = 1.06
#: Steps of the lattice along the side of a cell. But for that factor the field has as much power at
#: low frequencies as independent square cells of this side: its correlation integrates to
#: pi R^2 (2m + 1) / (m + 1)^2 with the kernel (1 - r^2 / R^2)^m, here m = 3.
CELL_STEPS = math.sqrt(math.pi * REACH_STEPS**2 * 7.0 / 16.0) / FINER_LIGHTNESS
_NEAR = (
    2.81022636e-08, 3.43273939e-07, -3.5233877e-06, -4.39150654e-06, 0.00021858087,
    -0.00125372503, -0.00417768164, 0.246640727, 1.50140941,
)  # fmt: skip
_FAR = (
    -0.000200214257, 0.000100950558, 0.00134934322, -0.00367342844, 0.00573950773,
    -0.0076224613, 0.00943887047, 1.00167406, 2.83297682,
)  # fmt: skip


def smooth_gaussians(place: Array, seed: int) -> Array:
    """Two independent standard normals that vary smoothly, (..., 2).

    place: (..., 2), in steps of the lattice.

    >>> smooth_gaussians(np.zeros((3, 5, 2)), 1).shape
    (3, 5, 2)
    """
    first = np.floor(place).astype(np.int64) - 1
    total = np.zeros(place.shape)
    power = np.zeros((*place.shape[:-1], 1))
    for row in range(4):  # no other point is nearer than two steps
        for column in range(4):
            point: Ints = first + np.array([column, row])
            apart = place - point
            distance2 = np.sum(apart * apart, axis=-1, keepdims=True)
            weight = np.maximum(1.0 - distance2 / REACH_STEPS**2, 0.0) ** 3
            face = np.full((*point.shape[:-1], 1), FIELD_FACE)
            hashes = cell_hash(np.concatenate([point, face], axis=-1), seed)
            total += weight * gaussians(uniforms(hashes)[..., :2])
            power += weight * weight
    return np.asarray(total / np.sqrt(power))


def inverse_erf(one_less: Array) -> Array:
    """The x with erf(x) = y, for a y from 0 to 1 that is given as 1 - y.

    Two polynomials, within 3e-7 of x (Giles 2012, "Approximating the erfinv function", single
    precision); scipy, which has the function, takes longer to load than a picture to draw.

    >>> inverse_erf(np.array([1.0, 0.5, 1e-3])).round(6).tolist()
    [0.0, 0.476936, 2.326754]
    """
    y = 1.0 - one_less
    w = -np.log(np.maximum(one_less, 1e-37) * (1.0 + y))
    near = np.polyval(_NEAR, w - 2.5)
    far = np.polyval(_FAR, np.sqrt(np.maximum(w, 0.0)) - 3.0)
    return np.asarray(y * np.where(w < 5.0, near, far))


def smooth_tilt(law: str, place: Array, seed: int) -> Array:
    """Tilt of the field along tangent and bitangent in units of sigma_N, (..., 2).

    law: 'tangent', two Gaussians; 'paper', a Gaussian angle of uniform azimuth: the direction of
    the two, and the angle whose rank among half-normal ones is the rank of their length among
    Rayleigh ones, erf(angle / sqrt 2) = 1 - exp(-length^2 / 2). So the tilt is smooth where it
    passes 0.
    place: as for smooth_gaussians.
    """
    g = smooth_gaussians(place, seed)
    if law == "tangent":
        return g
    length2 = np.sum(g * g, axis=-1, keepdims=True)
    angle = math.sqrt(2.0) * inverse_erf(np.exp(-0.5 * length2))
    return np.asarray(g * angle / np.sqrt(np.maximum(length2, 1e-30)))
