"""Reflection models in float64: Torrance-Sparrow, Oren-Nayar, EON, Lambert.

The twin of shaders/brdf.glsl: same function names, same quantities. Directions are unit vectors
that point away from the surface, `i` to the lamp and `o` to the eye; any shape (..., 3), and the
results broadcast. Angles are radians. Every BRDF is in 1/sr. Each specular lobe carries the factor
1/(4 cos_i cos_o) and a facet density whose projected area is normalised to one.
"""

from __future__ import annotations

from enum import StrEnum
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from relgloss_view.base.arrays import Array, Mask

#: Below this product of sines the azimuth between i and o is undefined; every term that holds it
#: is itself at most of this size there, so it is taken as cos(phi) = 0.
AZIMUTH_EPSILON = 1e-7
#: EON divides by one minus an albedo, which is zero at r = 0 (Portsmouth, Kutz, Hill 2025, their
#: listing guards it the same way).
EON_EPSILON = 1e-7
#: Cosines this small only guard a division: the product with the guarded term is already zero.
COSINE_EPSILON = 1e-4
#: exp(-200) = 1e-87 is nothing in a picture, and products of it do not underflow.
LARGEST_EXPONENT = 200.0


class Facing(NamedTuple):
    """The orientation of a surface element to lamp and eye, on which every model here depends."""

    mu_i: Array  #: cosine of the angle of incidence (below zero: lit from behind)
    mu_o: Array  #: cosine of the viewing angle
    t: Array  #: dot product of the tangential parts of i and o, = sin_i sin_o cos(phi)
    cos_d: Array  #: cosine of the angle between i and the half-vector
    delta2: Array  #: squared angle between the normal and the half-vector, rad^2


def facing(n: Array, i: Array, o: Array) -> Facing:
    """The orientation of normals n to directions i and o, unit vectors (..., 3) each.

    Where i = -o there is no half-vector: cos_d is 0 and delta2 is that of a right angle.

    >>> up = np.array([0.0, 0.0, 1.0])
    >>> float(facing(up, up, up).cos_d), float(facing(up, up, up).delta2)
    (1.0, 0.0)
    """
    mu_i = np.sum(n * i, axis=-1)
    mu_o = np.sum(n * o, axis=-1)
    t = np.sum((i - n * mu_i[..., None]) * (o - n * mu_o[..., None]), axis=-1)
    half = i + o
    length = np.linalg.norm(half, axis=-1)
    defined = length > AZIMUTH_EPSILON
    h = half / np.where(defined, length, 1.0)[..., None]
    cross = np.linalg.norm(np.cross(n, h), axis=-1)
    delta = np.arctan2(cross, np.sum(n * h, axis=-1))
    delta = np.where(defined, delta, 0.5 * np.pi)
    return Facing(mu_i, mu_o, t, np.where(defined, 0.5 * length, 0.0), delta * delta)


# --- specular: Torrance and Sparrow 1967 ---------------------------------------------------------


def fresnel_dielectric(cos_d: ArrayLike, n: ArrayLike) -> Array:
    """Unpolarised reflectance of a dielectric (Cook, Torrance 1982), 0 to 1.

    cos_d: cosine of the angle between the light and the facet's normal. n: refractive index, at
    least 1.

    >>> fresnel_dielectric([1.0, 0.0], 1.5).round(6).tolist()  # ((n - 1) / (n + 1))^2, and grazing
    [0.04, 1.0]
    """
    c = np.abs(np.asarray(cos_d, dtype=np.float64))
    q = np.sqrt(np.maximum(np.square(n) - 1.0 + c * c, 0.0))
    # q + c is zero only at grazing incidence on n = 1, where nothing is reflected.
    ratio = (q - c) / np.maximum(q + c, 1e-12)
    polarised = (c * (q + c) - 1.0) / (c * (q - c) + 1.0)
    return np.asarray(0.5 * ratio * ratio * (1.0 + polarised * polarised))


class MetalPart(StrEnum):
    """The two parts of a metal's reflectance F0 (1 - w) + w by the form of Schlick 1994."""

    FACING = "facing"  #: 1 - w, which carries the colour F0
    GRAZING = "grazing"  #: w = (1 - cos)^5, white


#: What a facet reflects: by its refractive index, or one part of a metal.
Fresnel = float | MetalPart


def schlick_weight(cos_d: ArrayLike) -> Array:
    """w = (1 - cos)^5 (Schlick 1994): the share of the way from normal incidence to grazing.

    >>> schlick_weight([1.0, 0.5, 0.0]).tolist()
    [0.0, 0.03125, 1.0]
    """
    return np.asarray((1.0 - np.abs(np.asarray(cos_d, dtype=np.float64))) ** 5)


def reflectance(cos_d: ArrayLike, fresnel: Fresnel) -> Array:
    """What a facet reflects of the light, 0 to 1, at the cosine of its angle to the light.

    fresnel: the refractive index of a dielectric, or a part of a metal.

    >>> reflectance([0.5], MetalPart.FACING).tolist()
    [0.96875]
    """
    if isinstance(fresnel, MetalPart):
        weight = schlick_weight(cos_d)
        return weight if fresnel is MetalPart.GRAZING else 1.0 - weight
    return fresnel_dielectric(cos_d, fresnel)


@lru_cache(maxsize=1)
def _facet_quadrature() -> tuple[Array, Array]:
    return np.polynomial.legendre.leggauss(96)


@lru_cache(maxsize=256)
def facet_amplitude(s: float) -> float:
    """Peak A of the density D = A exp(-delta^2 / 2 s^2), so that D cos(delta) integrates to 1.

    The integral runs over the hemisphere, by Gauss-Legendre quadrature; for narrow lobes it is
    (1 + 4 s^2/3) / (2 pi s^2), and 1 / (pi sqrt(2) s Dawson(sqrt(2) s)) where the tail beyond 90
    degrees is negligible.
    """
    return float(facet_amplitudes(np.asarray(s))[0])


def facet_amplitudes(s: Array) -> tuple[Array, Array]:
    """`facet_amplitude` at widths s (...,) in radians, and its slope d ln A / d ln s.

    The slope is minus the mean of (delta/s)^2 under the same integral. The integral's upper limit
    depends on s only where the integrand is below exp(-40), so the limit adds nothing.
    """
    upper = np.minimum(0.5 * np.pi, 9.0 * s)[..., None]
    x, weight = _facet_quadrature()
    delta = 0.5 * upper * (x + 1.0)
    square = (delta / s[..., None]) ** 2
    integrand = weight * (np.exp(-0.5 * square) * np.cos(delta) * np.sin(delta))
    total = np.sum(integrand, axis=-1)
    amplitude = 1.0 / (2.0 * np.pi * 0.5 * upper[..., 0] * total)
    return amplitude, -np.sum(integrand * square, axis=-1) / total


def facet_density(delta2: Array, s: float, amplitude: float | None = None) -> Array:
    """Facet normals per solid angle, 1/sr: Gaussian in the facet's angle (Torrance, Sparrow 1967).

    delta2: squared angle from the normal, rad^2. s: per-axis standard deviation of the facets,
    radians; the equivalent Beckmann slope is m = sqrt(2) s. amplitude: peak, from facet_amplitude.

    >>> peak, beside = facet_density(np.array([0.0, 0.01]), 0.1)
    >>> round(float(beside / peak), 6)  # one standard deviation from the peak: exp(-1/2)
    0.606531
    """
    peak = facet_amplitude(s) if amplitude is None else amplitude
    return np.asarray(peak * np.exp(-np.minimum(delta2 / (2.0 * s * s), LARGEST_EXPONENT)))


def shadowing(f: Facing) -> Array:
    """G / (cos_i cos_o) with the V-groove G of Torrance, Sparrow 1967 (Cook, Torrance 1982's form).

    G = min(1, 2 n.h n.i / i.h, 2 n.h n.o / i.h) is divided through analytically, so that nothing
    cancels at grazing angles. With n.h = (mu_i + mu_o) / |i + o| and i.h = |i + o| / 2.
    """
    mu_i = np.maximum(f.mu_i, 0.0)
    mu_o = np.maximum(f.mu_o, 0.0)
    unshadowed = 1.0 / np.maximum(mu_i * mu_o, COSINE_EPSILON**2)
    nh_over_ih = 0.5 * (mu_i + mu_o) / np.maximum(f.cos_d * f.cos_d, COSINE_EPSILON**2)
    grooves = 2.0 * nh_over_ih / np.maximum(np.maximum(mu_i, mu_o), COSINE_EPSILON)
    return np.asarray(np.minimum(unshadowed, grooves))


def torrance_sparrow(f: Facing, s: float, n: Fresnel) -> Array:
    """Specular BRDF of unit strength, 1/sr: D G F / (4 cos_i cos_o), zero below either horizon.

    s: per-axis standard deviation of the facets, radians. n: refractive index, or the part of a
    metal's reflectance that stands for F. Source: Torrance and Sparrow 1967.

    >>> up = np.array([0.0, 0.0, 1.0])
    >>> peak = torrance_sparrow(facing(up, up, up), 0.1, 1.5)
    >>> round(float(peak / (facet_amplitude(0.1) * 0.04 / 4)), 6)
    1.0
    """
    value = 0.25 * facet_density(f.delta2, s) * reflectance(f.cos_d, n) * shadowing(f)
    return np.where(_above(f), value, 0.0)


def metal_torrance_sparrow(f: Facing, s: float) -> tuple[Array, Array]:
    """The two parts of a metal's lobe of unit strength, 1/sr: MetalPart.FACING, then GRAZING.

    The BRDF of a metal is F0 times the first plus the second, in each band.
    """
    return torrance_sparrow(f, s, MetalPart.FACING), torrance_sparrow(f, s, MetalPart.GRAZING)


def _above(f: Facing) -> Mask:
    return (f.mu_i > 0.0) & (f.mu_o > 0.0) & (f.cos_d > 0.0)


# --- diffuse: a model is two shapes, for the albedo and for a second albedo ----------------------
#
# f = rho * first + second_albedo(rho) * second. Both shapes are free of wavelength, so a spectrum
# folds into two XYZ triples without error.


def lambert(f: Facing) -> tuple[Array, Array]:
    """The perfect diffuser: 1/pi above both horizons, and no second part (Lambert 1760)."""
    first = np.where((f.mu_i > 0.0) & (f.mu_o > 0.0), 1.0 / np.pi, 0.0)
    return first, np.zeros_like(first)


def oren_nayar(f: Facing, sigma: float) -> tuple[Array, Array]:
    """Full model of Oren and Nayar 1995 (their eqs. 30-31), for rho and rho^2.

    sigma: standard deviation of the facet slope angle, radians, 0 to about 0.7. The azimuth is
    never formed by dividing small sines, and tan((a + b)/2) is written
    (sin a + sin b) / (cos a + cos b). Where the model goes below zero (sigma > 0.7, both directions
    grazing and opposite) the result is zero.

    >>> up = np.array([0.0, 0.0, 1.0])
    >>> first, second = oren_nayar(facing(up, up, up), 0.0)  # Lambert at sigma = 0
    >>> round(float(first * np.pi), 6), float(second)
    (1.0, 0.0)
    """
    mu_i, mu_o = np.clip(f.mu_i, 0.0, 1.0), np.clip(f.mu_o, 0.0, 1.0)
    sin_i, sin_o = np.sqrt((1 - mu_i) * (1 + mu_i)), np.sqrt((1 - mu_o) * (1 + mu_o))
    product = sin_i * sin_o
    has_azimuth = product > AZIMUTH_EPSILON
    cos_phi = np.clip(np.where(has_azimuth, f.t / np.where(has_azimuth, product, 1.0), 0.0), -1, 1)
    theta_i, theta_o = np.arctan2(sin_i, mu_i), np.arctan2(sin_o, mu_o)
    a, b = np.maximum(theta_i, theta_o), np.minimum(theta_i, theta_o)
    sin_a, sin_b = np.maximum(sin_i, sin_o), np.minimum(sin_i, sin_o)
    s2 = sigma * sigma
    c1 = 1.0 - 0.5 * s2 / (s2 + 0.33)
    k = s2 / (s2 + 0.09)
    b_unit = 2.0 * b / np.pi
    c2 = 0.45 * k * (sin_a - np.where(cos_phi >= 0.0, 0.0, b_unit**3))
    c3 = 0.125 * k * (4.0 * a * b / np.pi**2) ** 2
    tan_b = sin_b / np.maximum(np.maximum(mu_i, mu_o), COSINE_EPSILON)
    tan_mean = (sin_a + sin_b) / np.maximum(mu_i + mu_o, COSINE_EPSILON)
    first = (c1 + cos_phi * c2 * tan_b + (1.0 - np.abs(cos_phi)) * c3 * tan_mean) / np.pi
    second = 0.17 * s2 / (s2 + 0.13) * (1.0 - cos_phi * b_unit**2) / np.pi
    above = (f.mu_i > 0.0) & (f.mu_o > 0.0)
    return np.where(above, np.maximum(first, 0.0), 0.0), np.where(above, second, 0.0)


def fujii_normalisation(r: float) -> float:
    """A_F = 1 / (1 + (1/2 - 2/(3 pi)) r) (Portsmouth, Kutz, Hill 2025)."""
    return 1.0 / (1.0 + (0.5 - 2.0 / (3.0 * np.pi)) * r)


def fujii_albedo(mu: Array, r: float) -> Array:
    """Directional albedo of the Fujii model at rho = 1, their polynomial fit (2025)."""
    m = 1.0 - mu
    g = m * (0.0571085289 + m * (0.491881867 + m * (-0.332181442 + m * 0.0714429953)))
    return np.asarray((1.0 + r * g) * fujii_normalisation(r))


def fujii_mean_albedo(r: float) -> float:
    """Hemispherical albedo of the Fujii model at rho = 1 (Portsmouth, Kutz, Hill 2025)."""
    return fujii_normalisation(r) * (1.0 + (2.0 / 3.0 - 28.0 / (15.0 * np.pi)) * r)


def eon(f: Facing, r: float) -> tuple[Array, Array]:
    """Energy-preserving Oren-Nayar (Portsmouth, Kutz, Hill 2025), for rho and rho_ms.

    r: roughness, 0 to 1. The second shape multiplies `second_albedo`.

    >>> up = np.array([0.0, 0.0, 1.0])
    >>> first, _ = eon(facing(up, up, up), 0.0)  # Lambert at r = 0
    >>> round(float(first * np.pi), 6)
    1.0
    """
    mu_i, mu_o = np.clip(f.mu_i, 0.0, 1.0), np.clip(f.mu_o, 0.0, 1.0)
    largest = np.maximum(np.maximum(mu_i, mu_o), COSINE_EPSILON)
    s_over_t = np.where(f.t > 0.0, f.t / largest, f.t)
    first = fujii_normalisation(r) * (1.0 + r * s_over_t) / np.pi
    missing_i = np.maximum(EON_EPSILON, 1.0 - fujii_albedo(mu_i, r))
    missing_o = np.maximum(EON_EPSILON, 1.0 - fujii_albedo(mu_o, r))
    missing = max(EON_EPSILON, 1.0 - fujii_mean_albedo(r))
    second = missing_i * missing_o / (missing * np.pi)
    above = (f.mu_i > 0.0) & (f.mu_o > 0.0)
    return np.where(above, np.maximum(first, 0.0), 0.0), np.where(above, second, 0.0)


def second_albedo(model: str, albedo: ArrayLike, sigma: float) -> Array:
    """The albedo that multiplies a model's second shape: 0, rho^2, or EON's rho_ms."""
    rho = np.asarray(albedo, dtype=np.float64)
    if model in ("lambert", "qualitative"):
        return np.zeros_like(rho)
    if model == "oren-nayar":
        return np.asarray(rho * rho)
    mean = fujii_mean_albedo(sigma)
    return np.asarray(rho * rho * mean / (1.0 - rho * (1.0 - mean)))


def qualitative_oren_nayar(f: Facing, sigma: float) -> tuple[Array, Array]:
    """Oren and Nayar's qualitative model (1995, eq. 32): their first two terms, no second part."""
    c1, c2, *_ = diffuse_terms("qualitative", sigma)
    largest = np.maximum(np.maximum(f.mu_i, f.mu_o), COSINE_EPSILON)
    first = (c1 + c2 * np.maximum(f.t, 0.0) / largest) / np.pi
    return np.where((f.mu_i > 0.0) & (f.mu_o > 0.0), first, 0.0), np.zeros_like(f.t)


def diffuse_terms(model: str, sigma: float) -> tuple[float, float, float, float]:
    """The terms of a model that depend on its roughness (radians) alone, for the shader."""
    if model in ("oren-nayar", "qualitative"):
        s2 = sigma * sigma
        k = s2 / (s2 + 0.09)
        return 1.0 - 0.5 * s2 / (s2 + 0.33), 0.45 * k, 0.125 * k, 0.17 * s2 / (s2 + 0.13)
    if model == "eon":
        missing = max(EON_EPSILON, 1.0 - fujii_mean_albedo(sigma))
        return sigma, fujii_normalisation(sigma), 1.0 / missing, 0.0
    return 0.0, 0.0, 0.0, 0.0


def diffuse_shapes(model: str, f: Facing, sigma: float) -> tuple[Array, Array]:
    """The two shapes of 'lambert', 'oren-nayar', 'eon' or 'qualitative'; sigma in radians."""
    if model == "lambert":
        return lambert(f)
    if model == "oren-nayar":
        return oren_nayar(f, sigma)
    if model == "eon":
        return eon(f, sigma)
    if model == "qualitative":
        return qualitative_oren_nayar(f, sigma)
    raise ValueError(f"no diffuse model is named {model!r}")
