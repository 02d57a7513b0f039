"""What gloss meters and a colour instrument would read on many surfaces at once."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.fitting.estimate import prior
from relgloss_view.fitting.estimate.prior import INDEX, LOG_S, RATIO, SHARE, STRENGTH
from relgloss_view.gloss.meter.geometry import SPECULAR
from relgloss_view.gloss.meter.lobe_table import ALBEDO, TRAPPED, lobe_table
from relgloss_view.gloss.meter.shares import diffuse_flux
from relgloss_view.material import brdf
from relgloss_view.material.material import S_DEG_MAX
from relgloss_view.measure.spectrum import AT_45_0, SPHERE_INCLUDED

#: Incidence at which the peak is counted, as of a fit (fitting.derived).
PEAK_DEG = 45.0
#: Between lamp and receiver of 45/0: half of 45 degrees to the half-vector, and 22.5 to the facet.
HALF_45_0 = np.radians(22.5)


def lobes(surfaces: Array) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
    """ln of the width in degrees and strength, (N,) each, of the main and the second lobe."""
    share = np.exp(surfaces[:, SHARE])
    main = surfaces[:, STRENGTH] / (1.0 + share)
    log_s = surfaces[:, LOG_S]
    second = np.minimum(log_s + surfaces[:, RATIO], np.log(S_DEG_MAX))
    return (log_s, main), (second, share * main)


def lobe_readings(surfaces: Array, angles: Sequence[float]) -> Array:
    """The lobes' part (N, A) of the readings at A angles, gloss units."""
    units = [
        100.0 / SPECULAR[round(angle)].mirror_flux(SPECULAR[round(angle)].glass) for angle in angles
    ]
    return _shares(surfaces, [f"gloss-{round(angle)}" for angle in angles]) * units


def diffuse_units(angles: Sequence[float]) -> Array:
    """The reading (A,) of a perfect Lambertian diffuser at A angles, gloss units."""
    meters = [SPECULAR[round(angle)] for angle in angles]
    return np.array(
        [
            100.0 * diffuse_flux(m, m.windows[0], "lambert", 0.0)[0] / m.mirror_flux(m.glass)
            for m in meters
        ]
    )


def lobe_colour(surfaces: Array, geometry: str) -> Array:
    """The lobes' gray part (N,) of a radiance factor in a geometry of colour instruments.

    45:0 is taken at its nominal directions. A sphere sees the whole directional albedo at 8 degrees
    (reciprocity: d:8 is 8:d), without what falls into the gloss trap where that is excluded.
    """
    if geometry != AT_45_0:
        albedo, trapped = _shares(surfaces, [ALBEDO, TRAPPED]).T
        left = albedo if geometry == SPHERE_INCLUDED else np.maximum(albedo - trapped, 0.0)
        return np.asarray(left)
    lamp = np.array([np.sin(2.0 * HALF_45_0), 0.0, np.cos(2.0 * HALF_45_0)])
    up = np.array([0.0, 0.0, 1.0])
    facing = brdf.facing(up, lamp, up)
    return _radiance_factor(surfaces, facing)


def peaks(surfaces: Array, diffuse_y: Array) -> Array:
    """Luminous radiance factor (N,) in the mirror direction of 45 degrees (fitting.derived)."""
    theta = np.radians(PEAK_DEG)
    lamp = np.array([-np.sin(theta), 0.0, np.cos(theta)])
    facing = brdf.facing(np.array([0.0, 0.0, 1.0]), lamp, lamp * np.array([-1.0, 1.0, 1.0]))
    return diffuse_y + _radiance_factor(surfaces, facing)


def _radiance_factor(surfaces: Array, facing: brdf.Facing) -> Array:
    """pi f (N,) of the lobes for one pair of directions (brdf.torrance_sparrow)."""
    fresnel = brdf.fresnel_dielectric(facing.cos_d, surfaces[:, INDEX])
    total = np.zeros(len(surfaces))
    for log_s, strength in lobes(surfaces):
        s = np.radians(np.exp(log_s))
        amplitude = np.interp(log_s, *_amplitudes()) / (s * s)
        exponent = np.minimum(facing.delta2 / (2.0 * s * s), brdf.LARGEST_EXPONENT)
        total += strength * amplitude * np.exp(-exponent)
    return np.asarray(0.25 * np.pi * total * fresnel * brdf.shadowing(facing))


@lru_cache(maxsize=1)
def _amplitudes() -> tuple[Array, Array]:
    """ln s of widths in degrees, and the density's peak times s^2, which hardly varies."""
    log_s = np.linspace(prior.LOWER[LOG_S], np.log(S_DEG_MAX), 801)
    s = np.radians(np.exp(log_s))
    return log_s, np.asarray(brdf.facet_amplitudes(s)[0] * s * s)


def _shares(surfaces: Array, columns: Sequence[str]) -> Array:
    """Shares of the light (N, C) that both lobes send into instruments."""
    (main_s, main), (second_s, second) = lobes(surfaces)
    log_s, index = np.concatenate([main_s, second_s]), np.tile(surfaces[:, INDEX], 2)
    shares = lobe_table().shares(columns, log_s, index)
    count = len(surfaces)
    return np.asarray(main[:, None] * shares[:count] + second[:, None] * shares[count:])
