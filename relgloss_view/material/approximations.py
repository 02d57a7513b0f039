"""Cheaper forms of the parts of Torrance-Sparrow, for scenes that need no more.

The twin of shaders/approximations.glsl: same function names, same quantities. Angles are radians.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.material import brdf
from relgloss_view.material.brdf import Facing, Fresnel, MetalPart

FRESNEL = ("exact", "schlick", "constant")
SHADOWING = ("v-groove", "none")
#: Highest power first.
_I0_NEAR = (0.0045813, 0.0360768, 0.2659732, 1.2067492, 3.0899424, 3.5156229, 1.0)
_I0_FAR = (
    *(0.00392377, -0.01647633, 0.02635537, -0.02057706, 0.00916281),
    *(-0.00157565, 0.00225319, 0.01328592, 0.39894228),
)
FACETS = ("gaussian", "beckmann", "ggx", "mean-gaussian")


class Lobe(NamedTuple):
    """A lobe as it is drawn. A Gaussian in the angle has sharpness 1 / (2 s^2)."""

    sharpness: float
    amplitude: float
    refractive_index: Fresnel  #: or the part of a metal
    spread: float = 0.0  #: of mean-gaussian: z = spread delta^2


def plain_lobe(s: float, refractive_index: Fresnel) -> Lobe:
    """A lobe of facet standard deviation s."""
    return Lobe(0.5 / s**2, brdf.facet_amplitude(s), refractive_index)


def mean_lobe(s: float, refractive_index: Fresnel, sigma_n: float, law: str) -> Lobe:
    """A lobe of facet sd s under normals tilted with sd sigma_n, its mean: noise.mean_lobe."""
    total = s * s + sigma_n * sigma_n
    if law == "tangent":
        share, spread = s * s / total, 0.0
    else:
        share, spread = s / np.sqrt(total), sigma_n * sigma_n / (4.0 * s * s * total)
    amplitude = float(share) * brdf.facet_amplitude(s)
    return Lobe(0.5 / total, amplitude, refractive_index, spread)


def fresnel_schlick(cos_d: Array, n: float) -> Array:
    """Reflectance by Schlick 1994: exact at normal and at grazing incidence.

    >>> fresnel_schlick(np.array([1.0, 0.0]), 1.5).round(4).tolist()
    [0.04, 1.0]
    """
    f0 = ((n - 1.0) / (n + 1.0)) ** 2
    return f0 + (1.0 - f0) * (1.0 - np.abs(cos_d)) ** 5


def fresnel(model: str, cos_d: Array, n: Fresnel) -> Array:
    """Reflectance of a dielectric by the named model; 'constant' is that of normal incidence.

    A metal has its own form whatever the model.
    """
    if isinstance(n, MetalPart):
        return brdf.reflectance(cos_d, n)
    if model == "exact":
        return brdf.fresnel_dielectric(cos_d, n)
    if model == "schlick":
        return fresnel_schlick(cos_d, n)
    return np.full_like(cos_d, ((n - 1.0) / (n + 1.0)) ** 2)


def beckmann_density(delta2: Array, sharpness: float) -> Array:
    """Gaussian in tan(delta) of slope m = sqrt(2) s (Beckmann, Spizzichino 1963); 1/sr.

    delta2: squared angle from the normal, rad^2. sharpness: 1 / (2 s^2).
    """
    c2 = np.maximum(np.cos(np.sqrt(delta2)), brdf.COSINE_EPSILON) ** 2
    exponent = np.minimum(sharpness * (1.0 - c2) / c2, brdf.LARGEST_EXPONENT)
    return np.asarray(sharpness / (np.pi * c2 * c2) * np.exp(-exponent))


def ggx_density(delta2: Array, sharpness: float) -> Array:
    """Trowbridge, Reitz 1975 (GGX: Walter et al. 2007) with alpha = sqrt(2) s."""
    a2 = 1.0 / sharpness
    under = np.cos(np.sqrt(delta2)) ** 2 * (a2 - 1.0) + 1.0
    return np.asarray(a2 / (np.pi * under * under))


def bessel_i0e(z: Array) -> Array:
    """exp(-z) I0(z), z >= 0, within 3e-7 (Abramowitz, Stegun 1964, 9.8.1 and 9.8.2).

    >>> bessel_i0e(np.array([0.0, 1.0])).round(5).tolist()  # I0(1) = 1.26607
    [1.0, 0.46576]
    """
    near, far = np.minimum(z, 3.75), np.maximum(z, 3.75)
    small = np.exp(-near) * np.polyval(_I0_NEAR, (near / 3.75) ** 2)
    return np.where(z < 3.75, small, np.polyval(_I0_FAR, 3.75 / far) / np.sqrt(far))


def facets(model: str, f: Facing, lobe: Lobe) -> Array:
    """Density of the facets by the named model; each is normalised as Gaussian facets are."""
    if model == "beckmann":
        return beckmann_density(f.delta2, lobe.sharpness)
    if model == "ggx":
        return ggx_density(f.delta2, lobe.sharpness)
    exponent = np.minimum(f.delta2 * lobe.sharpness, brdf.LARGEST_EXPONENT)
    density = lobe.amplitude * np.exp(-exponent)
    return density * bessel_i0e(lobe.spread * f.delta2) if model == "mean-gaussian" else density


def unshadowed(f: Facing) -> Array:
    """1 / (cos_i cos_o), without shadowing of facets by facets."""
    mu = np.maximum(f.mu_i, 0.0) * np.maximum(f.mu_o, 0.0)
    return np.asarray(1.0 / np.maximum(mu, brdf.COSINE_EPSILON**2))


def torrance_sparrow(
    f: Facing, lobe: Lobe, fresnel_model: str, shadowing: str, facet_model: str
) -> Array:
    """Specular BRDF of unit strength, 1/sr, with the named form of each part."""
    openness = brdf.shadowing(f) if shadowing == "v-groove" else unshadowed(f)
    reflectance = fresnel(fresnel_model, f.cos_d, lobe.refractive_index)
    value = 0.25 * facets(facet_model, f, lobe) * reflectance * openness
    return np.where((f.mu_i > 0.0) & (f.mu_o > 0.0) & (f.cos_d > 0.0), value, 0.0)
