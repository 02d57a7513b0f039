"""Lights: what arrives at a point from each lamp, and what a lamp's size does to a lobe.

The twin of shaders/lights.glsl. A lamp is a disc of uniform radiance that faces the object. At a
point it has the angular radius r, and its light is taken from its centre:

- The irradiance of a facing disc is I cos_i / (d^2 + R^2), exact where the whole disc is above the
  horizon: the projected solid angle of a cone of half-angle r is pi sin^2 r cos_i.
- A half-vector turns by half of what the light's direction turns in the plane of incidence, and by
  half of it over cos th_d across the plane (the Jacobian: Walter et al. 2007, eq. 14). So a lobe of
  facet sd s is seen as a Gaussian averaged over an ellipse of the radii r/2 and r / (2 cos th_d).
  Its variances are s^2 + (r/4)^2 and s^2 + (r / (4 cos th_d))^2, since a uniform disc of radius 1
  has the variance 1/4 along each axis. Where the ellipse is wider than the lobe it has a flat top,
  so the lobe is drawn as `spread_by_lamp` has it.

docs/light.md shows where this holds, against Mitsuba's disc.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.material import brdf
from relgloss_view.material.approximations import Lobe
from relgloss_view.material.brdf import Facing
from relgloss_view.material.material import Material
from relgloss_view.picture.model.view import float32
from relgloss_view.picture.scene.setup import FurtherLamp, Lamp, Setup


class Arriving(NamedTuple):
    """The light of one lamp at points (...)."""

    i: Array  #: (..., 3), unit vectors to the lamp
    #: (d^2 + R^2) over the lamp's share: one over the irradiance of a surface that faces the lamp
    distance2: Array
    sin2_r: Array | float  #: squared sine of the lamp's angular radius; 0.0 for a point


def lamps_of(setup: Setup) -> tuple[Lamp | FurtherLamp, ...]:
    """The lamps that give light, the main one first."""
    return (setup.lamp, *(lamp for lamp in setup.further_lamps if lamp.share > 0.0))


def share_of(lamp: Lamp | FurtherLamp) -> float:
    """A lamp's intensity over the main lamp's."""
    return 1.0 if isinstance(lamp, Lamp) else lamp.share


def lit(setup: Setup, point_m: Array) -> Iterator[Arriving]:
    """The light of each lamp at points (..., 3), the main lamp's first; places as float32 has them.

    >>> [light] = lit(Setup(), np.zeros((1, 3)))
    >>> float(np.round(light.distance2[0], 6)), light.sin2_r
    (1.0, 0.0)
    """
    for lamp in lamps_of(setup):
        way = float32(lamp.position_m) - point_m
        distance2 = np.maximum(np.sum(way * way, axis=-1), 1e-30)
        i = way / np.sqrt(distance2)[..., None]
        sin2_r: Array | float = 0.0
        if lamp.radius_m > 0.0:
            radius2 = lamp.radius_m**2
            distance2 = distance2 + radius2
            sin2_r = radius2 / distance2
        yield Arriving(i, distance2 / share_of(lamp), sin2_r)


def white_seen(setup: Setup, point_m: Array, normal: Array) -> Array:
    """What the perfect diffuser shows at points (..., 3) under lamps of power pi, (...)."""
    seen = np.zeros(point_m.shape[:-1])
    for light in lit(setup, point_m):
        mu_i = np.maximum(np.sum(normal * light.i, axis=-1), 0.0)
        seen = seen + mu_i / light.distance2
    return seen


def across(n: Array, i: Array, o: Array, f: Facing) -> Array:
    """Share of the squared facet angle that lies across the plane of incidence, 0 to 1.

    n, i, o: unit vectors (..., 3). Where i = o every plane is one of incidence, and it is 0.
    """
    beside = np.cross(i, o)
    beside2 = np.maximum(np.sum(beside * beside, axis=-1), 1e-12)
    sine2 = np.maximum(np.sin(np.sqrt(f.delta2)) ** 2, 1e-12)
    return np.asarray(np.minimum(np.sum(n * beside, axis=-1) ** 2 / (beside2 * sine2), 1.0))


#: exponent = 1 + a t^4 / (t^3 + b t^2 + c t + d), t the radius of a disc in sd of the Gaussian that
#: is averaged over it: fitted to the non-central chi-squared distribution (see spread_by_lamp).
EXPONENT = (0.61656425, 3.33675464, -6.02685123, 51.47644039)
#: Gamma(1 + x), 0 <= x <= 1, within 5e-5 (Abramowitz, Stegun 1964, 6.1.35), highest power first.
GAMMA = (-0.1010678, 0.4245549, -0.6998588, 0.9512363, -0.5748646, 1.0)
LARGEST_LOG = 5.0  #: of the power in the exponent, whose exponential is nothing beyond


def disc_peak(t2: Array) -> Array:
    """Peak of a Gaussian averaged over a disc, over its own: 2 (1 - exp(-t^2/2)) / t^2.

    t2: squared radius of the disc over the Gaussian's variance. Exact: the Rayleigh distribution.
    """
    half = 0.5 * np.asarray(t2)
    small = 1.0 - half * (0.5 - half * (1.0 / 6.0 - half / 24.0))
    return np.where(half < 0.05, small, -np.expm1(-half) / np.maximum(half, 0.05))


def disc_exponent(t2: Array) -> Array:
    """Exponent of exp(-u^exponent), 1 for a Gaussian: it grows as the disc outgrows the lobe."""
    a, b, c, d = EXPONENT
    t = np.sqrt(t2)
    return 1.0 + a * t2 * t2 / (((t + b) * t + c) * t + d)


def spread_by_lamp(
    f: Facing, sharpness: float, share_across: Array, sin2_r: Array | float
) -> tuple[Array, Array]:
    """What a lamp's size makes of a Gaussian lobe: its squared angle, and a factor of its peak.

    f: orientation. sharpness: 1 / (2 s^2). share_across: from `across`. sin2_r: as in Arriving.

    The average of a Gaussian over a disc is the non-central chi-squared distribution of the disc's
    radius. It is drawn as peak exp(-u^exponent): the peak is exact, u is scaled so that the volume
    is, and the exponent is fitted: within 1 % of the peak for discs up to three times as wide as
    the lobe, 7 % for wider ones, at their edge. Small discs make it the Gaussian of the variances
    above.
    Of an ellipse the peak is the geometric mean of those of discs of its radii, and the exponent
    goes from one axis to the other with the direction.
    """
    cos2 = np.maximum(f.cos_d**2, brdf.COSINE_EPSILON)
    q = np.asarray(sharpness * sin2_r / 8.0)
    within, beside = 1.0 + q, 1.0 + q / cos2
    along, aside = (1.0 - share_across) / within, share_across / beside
    shape = np.sqrt(within * beside) * (along + aside)
    peak = np.sqrt(disc_peak(4.0 * q) * disc_peak(4.0 * q / cos2))
    exponent = disc_exponent(4.0 * q * (along + aside * cos2**-0.75) / (along + aside))
    u = f.delta2 * sharpness * shape * peak * np.polyval(GAMMA, 1.0 / exponent)
    log = np.minimum(exponent * np.log(np.maximum(u, 1e-30)), LARGEST_LOG)
    return np.exp(log) / sharpness, peak


def widened(lobe: Lobe, cos_d: Array, sin2_r: Array | float) -> Lobe:
    """A lobe of another kind, or the mean one of grain, as wide all round as the lamp makes it.

    Its peak is that of spread_by_lamp. The numbers of the lobe are those of
    approximations.mean_lobe, with the facets that much wider.
    """
    total = 0.5 / lobe.sharpness
    s2 = total / (1.0 + 2.0 * lobe.spread / lobe.sharpness)
    cosine = np.sqrt(np.maximum(cos_d**2, brdf.COSINE_EPSILON))
    wider2 = s2 / disc_peak(np.asarray(sin2_r) / (4.0 * s2 * cosine))
    tilt2 = total - s2
    wide = wider2 + tilt2
    amplitude: Any = lobe.amplitude * np.sqrt(total * s2 / (wide * wider2))
    sharpness: Any = 0.5 / wide  # as Lobe's numbers are, but one a point
    spread: Any = tilt2 / (4.0 * wider2 * wide)
    return Lobe(sharpness, amplitude, lobe.refractive_index, spread)


def specular(material: Material, f: Facing, share_across: Array, sin2_r: Array | float) -> Array:
    """Specular BRDF under a lamp of some size, 1/sr, (..., B); a point has sin2_r 0.

    The lobes of Material.evaluate_facing, each made as wide as the lamp makes it.
    """
    total = np.zeros((*f.delta2.shape, material.bands.count))
    for lobe in material.specular:
        sharpness = 0.5 / lobe.s**2
        delta2, peak = spread_by_lamp(f, sharpness, share_across, sin2_r)
        seen = f._replace(delta2=delta2)
        for part in lobe.parts(material.bands.count):
            shape = peak * brdf.torrance_sparrow(seen, lobe.s, part.fresnel)
            total = total + shape[..., None] * part.spectrum
    return total


def reflected(material: Material, f: Facing, n: Array, light: Arriving, o: Array) -> Array:
    """Specular BRDF of a surface with normals n under a light, 1/sr, (..., B); f: its facing."""
    if isinstance(light.sin2_r, float):
        return material.evaluate_facing(f)[1]
    return specular(material, f, across(n, light.i, o, f), light.sin2_r)
