"""The functions of geometry that a model is a combination of, and their derivatives.

A rung of the ladder predicts, in band b,

    m_b = kd_b D1(t) + kd_b^2 D2(t) + sum_j ks_jb L_j(ln s_j, n),

with t = sigma^2. Every derivative is again a combination of a few columns that do not depend on
the band: D1, D2, L_j, dD1/dt, dD2/dt, dL_j/dln s_j (and dL_j/dn). All in radiance factors.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from relgloss_view.base.arrays import Array, Mask
from relgloss_view.fitting.instrument import Instrument, Sway, sway
from relgloss_view.material import brdf

#: exp(-100) is far below any floor, and its square and fourth power are still normal numbers.
LARGEST_EXPONENT = 100.0
_REFERENCE_SIGMA = 0.3
_STEP = 1e-3


@dataclass(frozen=True)
class Geometry:
    """What the shapes need of N geometries; made once per set of samples."""

    facing: brdf.Facing
    along: Array  #: (N,), squared tilt of the half-vector in the plane of lamp and receiver, rad^2
    across: Array  #: (N,), and across it; the two sum to delta^2
    blur_along: float | Array  #: variance that the apertures add in that plane, rad^2
    blur_across: Array  #: (N,), and across it
    grooves: Array  #: (N,), pi G / (4 cos_i cos_o)
    flat: Array  #: (N,), the parts of Oren-Nayar: constant,
    directed: Array  #: (N,), single scattering
    interreflected: Array  #: (N,), and its rho^2 term
    sway: Sway | None = None  #: how errors of the instrument move the above

    def subset(self, rows: Mask) -> Geometry:
        """The geometries marked in `rows`."""
        return Geometry(
            facing=brdf.Facing(*(part[rows] for part in self.facing)),
            along=self.along[rows],
            across=self.across[rows],
            blur_along=self.blur_along,
            blur_across=self.blur_across[rows],
            grooves=self.grooves[rows],
            flat=self.flat[rows],
            directed=self.directed[rows],
            interreflected=self.interreflected[rows],
            sway=None if self.sway is None else self.sway.subset(rows),
        )


def geometry(
    to_lamp: Array,
    to_receiver: Array,
    aperture_sd_deg: tuple[float, float],
    instrument: Instrument | None = None,
) -> Geometry:
    """Prepare the shapes at unit directions (N, 3); the apertures' per-axis sd is in degrees.

    instrument: its errors at the same samples, where they are to be fitted too.

    With E = hypot(lamp, receiver) the half-vector is blurred by E/2 in the plane of the two
    directions and by E / (2 cos theta_d) across it, since |i + o| = 2 cos theta_d.
    """
    i, o = to_lamp, to_receiver
    normal = np.broadcast_to(np.array([0.0, 0.0, 1.0]), i.shape)
    f = brdf.facing(normal, i, o)
    split = i - o
    length = np.linalg.norm(split, axis=-1)
    # Where lamp and receiver coincide there is no plane, and the blur is round.
    in_plane = np.where(length > 1e-9, split[:, 2] / np.maximum(length, 1e-9), np.sqrt(0.5))
    tilt2 = np.sin(np.sqrt(f.delta2)) ** 2
    share = np.where(length > 1e-9, np.minimum(in_plane**2 / np.maximum(tilt2, 1e-18), 1.0), 0.5)
    e = np.radians(np.hypot(*aperture_sd_deg))
    first, second = brdf.oren_nayar(f, _REFERENCE_SIGMA)
    flat, _ = brdf.lambert(f)
    t = _REFERENCE_SIGMA**2
    return Geometry(
        facing=f,
        along=f.delta2 * share,
        across=f.delta2 * (1.0 - share),
        blur_along=float((e / 2.0) ** 2),
        blur_across=(e / (2.0 * np.maximum(f.cos_d, 0.05))) ** 2,
        grooves=0.25 * np.pi * brdf.shadowing(f),
        flat=np.pi * flat,
        directed=np.pi * (first - (1.0 - 0.5 * t / (t + 0.33)) * flat) / (t / (t + 0.09)),
        interreflected=np.pi * second / (0.17 * t / (t + 0.13)),
        sway=None if instrument is None else sway(instrument, i, o),
    )


def displaced(g: Geometry, errors: Array) -> Geometry:
    """The geometry where errors of the instrument, (..., K), put it, to their first order.

    What lobes depend on gets the shape (..., N); the diffuse part hardly changes and stays.
    """
    sway = g.sway
    if sway is None:
        raise ValueError("the geometry was made without an instrument")
    angles, spread2 = errors[..., :-1], np.exp(2.0 * errors[..., -1:])
    cos_d = np.clip(g.facing.cos_d + angles @ sway.cos_d_slope, 1e-6, 1.0)
    return replace(
        g,
        facing=g.facing._replace(cos_d=cos_d),
        along=(sway.along + angles @ sway.along_slope) ** 2,
        across=(sway.across + angles @ sway.across_slope) ** 2,
        blur_along=g.blur_along * spread2,
        blur_across=g.blur_across * spread2,
        grooves=g.grooves * np.exp(angles @ sway.grooves_slope),
    )


def error_slopes(g: Geometry, errors: Array, log_s: Array, n: Array) -> Array:
    """d ln L / d error of a lobe, (P, K, N), at errors (P, K), widths and indices (P,)."""
    sway, moved = g.sway, displaced(g, errors)
    if sway is None:
        raise ValueError("the geometry was made without an instrument")
    s2 = np.exp(2.0 * log_s)[:, None]
    wide, tall = s2 + moved.blur_along, s2 + moved.blur_across
    angles = errors[:, :-1]
    along = (sway.along + angles @ sway.along_slope) / wide
    across = (sway.across + angles @ sway.across_slope) / tall
    cos_d, index = moved.facing.cos_d, n[:, None]
    up, down = np.minimum(cos_d + _STEP, 1.0), np.maximum(cos_d - _STEP, 1e-6)
    change = np.log(brdf.fresnel_dielectric(up, index) / brdf.fresnel_dielectric(down, index))
    slopes = np.empty((*errors.shape, len(g.along)))
    slopes[:, :-1] = (
        (change / (up - down))[:, None] * sway.cos_d_slope
        + sway.grooves_slope
        - along[:, None] * sway.along_slope
        - across[:, None] * sway.across_slope
    )
    slopes[:, -1] = (along**2 * wide - 1.0) * moved.blur_along / wide
    slopes[:, -1] += (across**2 * tall - 1.0) * moved.blur_across / tall
    return slopes


def diffuse_columns(g: Geometry, t: ArrayLike) -> tuple[Array, Array, Array, Array]:
    """D1, D2 and their derivatives to t = sigma^2, each (..., N) for t of shape (...,).

    They are brdf.oren_nayar in its separable form.
    """
    t = np.asarray(t, dtype=np.float64)[..., None]
    raw = (1.0 - 0.5 * t / (t + 0.33)) * g.flat + t / (t + 0.09) * g.directed
    positive = raw > 0.0
    slope = -0.5 * 0.33 / (t + 0.33) ** 2 * g.flat + 0.09 / (t + 0.09) ** 2 * g.directed
    second = 0.17 * t / (t + 0.13) * g.interreflected
    second_slope = 0.17 * 0.13 / (t + 0.13) ** 2 * g.interreflected
    return np.where(positive, raw, 0.0), second, np.where(positive, slope, 0.0), second_slope


def lobe_columns(g: Geometry, log_s: ArrayLike, n: ArrayLike) -> tuple[Array, Array]:
    """L and dL/dln s of a Torrance-Sparrow lobe of unit strength, seen through the apertures.

    Each is (..., N) for log_s and n of shape (...,).
    """
    facets, slope = facet_columns(g, log_s)
    lobe = facets * brdf.fresnel_dielectric(g.facing.cos_d, np.asarray(n)[..., None])
    return lobe, lobe * slope


def metal_columns(g: Geometry, log_s: ArrayLike) -> tuple[Array, Array, Array]:
    """The two parts of a metal's lobe of unit strength, and d ln / d ln s of both: all (..., N).

    The first is T (1 - w), which carries the colour F0, the second T w, which is white; T is the
    lobe without reflectance, w the weight of Schlick 1994.
    """
    facets, slope = facet_columns(g, log_s)
    weight = brdf.schlick_weight(g.facing.cos_d)
    return facets * (1.0 - weight), facets * weight, slope


def facet_columns(g: Geometry, log_s: ArrayLike) -> tuple[Array, Array]:
    """A lobe without its Fresnel reflectance, and d ln L / d ln s: both (..., N)."""
    s = np.exp(np.asarray(log_s, dtype=np.float64))
    amplitude, amplitude_slope = brdf.facet_amplitudes(s)
    s2 = (s * s)[..., None]
    wide, tall = s2 + g.blur_along, s2 + g.blur_across
    along, across = g.along / wide, g.across / tall
    peak = amplitude[..., None] * s2 / np.sqrt(wide * tall)
    exponent = np.minimum(0.5 * (along + across), LARGEST_EXPONENT)
    facets = peak * np.exp(-exponent) * g.grooves
    slope = amplitude_slope[..., None] + 2.0 + (along - 1.0) * s2 / wide
    return facets, slope + (across - 1.0) * s2 / tall


def index_slope(g: Geometry, n: ArrayLike) -> Array:
    """d ln F / dn, (..., N) for n of shape (...,)."""
    middle = np.asarray(n, dtype=np.float64)[..., None]
    above, below = middle + _STEP, np.maximum(middle - _STEP, 1.0)
    high, low, at = (
        brdf.fresnel_dielectric(g.facing.cos_d, index) for index in (above, below, middle)
    )
    return np.asarray((high - low) / ((above - below) * np.maximum(at, 1e-12)))
