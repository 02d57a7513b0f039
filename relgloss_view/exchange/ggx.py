"""GGX facets: the reflection of the programs that do not draw a Gaussian in the facet's angle.

Directions are unit vectors in the sample frame (normal +z), `i` to the lamp and `o` to the eye.
Angles are radians, every BRDF is in 1/sr. alpha is the slope width of Walter et al. 2007; most
programs store a roughness whose square is alpha.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from relgloss_view.base.arrays import Array, Mask

#: Below it a cosine is grazing, and what it divides is nothing in a picture.
LEAST_COSINE = 1e-8
LEAST_ALPHA = 1e-4  #: of a lobe that a float32 shader can draw
#: Of facets that look about as wide as a Gaussian of s: a little below sqrt(2), which the width of
#: the Gaussian itself would give, because GGX has longer tails.
ALPHA_PER_S = 1.2


class Turn(NamedTuple):
    """The cosines on which isotropic facets depend."""

    mu_i: Array  #: to the normal
    mu_o: Array
    cos_h: Array  #: of the half-vector to the normal
    cos_d: Array  #: of the half-vector to i
    i_dot_o: Array
    above: Mask  #: where both directions are above the horizon


def turn(i: Array, o: Array) -> Turn:
    """The cosines of directions (..., 3) to lamp and eye.

    >>> up = np.array([0.0, 0.0, 1.0])
    >>> float(turn(up, up).cos_h)
    1.0
    """
    mu_i, mu_o = np.broadcast_arrays(i[..., 2], o[..., 2])
    i_dot_o = np.clip(np.sum(i * o, axis=-1), -1.0, 1.0)
    length = np.sqrt(np.maximum(2.0 + 2.0 * i_dot_o, LEAST_COSINE))
    cos_h = np.minimum((mu_i + mu_o) / length, 1.0)
    above = (mu_i > 0.0) & (mu_o > 0.0)
    clipped_i, clipped_o = np.maximum(mu_i, LEAST_COSINE), np.maximum(mu_o, LEAST_COSINE)
    return Turn(clipped_i, clipped_o, cos_h, 0.5 * length, i_dot_o, above)


def density(cos_h: Array, alpha: float) -> Array:
    """Facet normals per solid angle, 1/sr (Walter et al. 2007, eq. 33; Trowbridge, Reitz 1975).

    >>> round(float(density(np.array(1.0), 0.1) * np.pi * 0.1**2), 9)
    1.0
    """
    square = alpha * alpha
    cos2 = cos_h * cos_h
    return np.asarray(square / (np.pi * (cos2 * square + (1.0 - cos2)) ** 2))


def shadowing(t: Turn, alpha: float) -> Array:
    """G / (4 mu_i mu_o) of Smith's G for facets whose heights correlate (Heitz 2014, eq. 99).

    >>> up = np.array([0.0, 0.0, 1.0])
    >>> float(shadowing(turn(up, up), 0.3))
    0.25
    """
    square = alpha * alpha
    root_i = np.sqrt(square + (1.0 - square) * t.mu_i**2)
    root_o = np.sqrt(square + (1.0 - square) * t.mu_o**2)
    return np.asarray(0.5 / (root_i * t.mu_o + root_o * t.mu_i))


def separable_shadowing(t: Turn, alpha: float) -> Array:
    """G / (4 mu_i mu_o) where lamp and eye shadow independently (Walter et al. 2007, eq. 34)."""
    square = alpha * alpha
    first = 1.0 / (t.mu_i + np.sqrt(square + (1.0 - square) * t.mu_i**2))
    second = 1.0 / (t.mu_o + np.sqrt(square + (1.0 - square) * t.mu_o**2))
    return np.asarray(first * second)


def head_on(index: float) -> float:
    """What a dielectric reflects at normal incidence, 0 to 1 (Fresnel 1823).

    >>> round(head_on(1.5), 6)
    0.04
    """
    return ((index - 1.0) / (index + 1.0)) ** 2


def index_of(f0: float) -> float:
    """The refractive index, 1 or more, that reflects f0 (0 to below 1) at normal incidence.

    >>> round(index_of(0.04), 6)
    1.5
    """
    root = float(np.sqrt(min(max(f0, 0.0), 0.99999)))
    return (1.0 + root) / (1.0 - root)
