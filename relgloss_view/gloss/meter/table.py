"""A gloss meter's reading straight from a measured table, to compare a fit with its data.

Values near the mirror direction are read as facets: each value divided by what a facet of
a smooth dielectric would reflect in that geometry leaves the facet density, a function of the angle
between normal and half-vector alone if the sample is isotropic. It is interpolated between the
measured angles and goes through the same windows as a material's lobes. Nothing is fitted, and the
blur of the instrument's own apertures stays in.
"""

from __future__ import annotations

import dataclasses

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.gloss.meter.geometry import (
    DISTINCTNESS,
    HAZE,
    SPECULAR,
    Density,
    Meter,
    facet_flux,
    farthest_deg,
)
from relgloss_view.gloss.meter.meter import Reading, from_fluxes, luminous_weights
from relgloss_view.gloss.meter.shares import lobe_flux
from relgloss_view.material import brdf
from relgloss_view.measure.table import Measurement

#: A table's incidence may differ by this from the meter's: at 85 degrees a degree is a tenth of the
#: reading, elsewhere less, and most of that goes with the facets' own reflectance.
INCIDENCE_TOLERANCE_DEG = 1.0
#: Half-vectors closer than this are one angle, and the mirror direction is one within it of zero.
SAME_ANGLE_DEG = 0.1
#: Leaving out every other measured angle may change the reading by this share of it.
GAPS_AGREE = 0.10
FEWEST_ANGLES = 3  #: with two there is none to leave out
#: Up to the first angle beside the mirror direction the logarithm of a lobe that the table resolves
#: falls by no more than this (1.2 standard deviations) ...
CORE_FALL = 0.7
#: ... and by about what the second angle lets expect: a narrow lobe on a broad floor bends there.
CORE_BEND = 0.25
#: A change by the instrument's blur that is worth a word.
BLUR_NOTED = 0.03
#: The core of a lobe reaches to where its logarithm has fallen by this: one standard deviation.
CORE_DROP = 0.5
#: A lobe whose variance is a smaller share of the blur's is as sharp as a mirror for it.
NARROWEST = 0.1
#: Any index does: what a facet reflects is divided out and multiplied in again.
INDEX = 1.5
NODES = 64  #: along each side of a window: the interpolated density has corners


def table_readings(measurement: Measurement) -> tuple[Reading, ...]:
    """Gloss at 20, 60, 85 and 75 degrees and haze from a table, or why it can't give them."""
    meters = (*SPECULAR.values(), HAZE)
    readings = [_read(measurement, meter) for meter in meters]
    too_fine = "0.3 degrees is finer than tables resolve; read it from a fit"
    name, standard = DISTINCTNESS.name, DISTINCTNESS.standard
    return (*readings, Reading(DISTINCTNESS.key, name, standard, None, reason=too_fine))


def _read(measurement: Measurement, meter: Meter) -> Reading:
    empty = Reading(meter.key, meter.name, meter.standard, None)
    profile = _profile(measurement, meter)
    if isinstance(profile, str):
        return dataclasses.replace(empty, reason=profile)
    # Without every other angle the gaps are twice as wide, which shows how much they matter.
    angle, level = profile
    thinned = np.unique(np.r_[0, np.arange(2, len(angle), 2), len(angle) - 1])
    likely, other = (
        float(np.sum([facet_flux(meter, w, fill, INDEX, nodes=NODES) for w in meter.windows]))
        for fill in (_filled(angle, level), _filled(angle[thinned], level[thinned]))
    )
    value = from_fluxes(meter, [likely])
    if abs(other - likely) > GAPS_AGREE * likely:
        reason = (
            "the directions are too far apart: with every other one left out the reading would "
            f"change by {abs(other / likely - 1.0):.0%}"
        )
        return dataclasses.replace(empty, reason=reason)
    note = _blur(measurement.aperture_sd_deg, meter, *profile)
    return dataclasses.replace(empty, value=value, note=note)


def _blur(aperture_sd_deg: tuple[float, float], meter: Meter, angle: Array, level: Array) -> str:
    """What the instrument's own apertures take from the reading, where that is worth a word.

    Half-vectors are blurred by E/2 in the plane of incidence and E/(2 cos theta) across it, E the
    hypotenuse of both apertures' angular sds; the peak falls by both, and the profile, measured in
    the plane and read as isotropic, is as wide as the in-plane blur makes it. A Gaussian as wide
    as the profile's core is sent through the windows with the blur and without.
    """
    drop = np.log(level[0] / level)
    fallen = np.flatnonzero(drop >= CORE_DROP)
    blur2 = (0.5 * np.radians(np.hypot(*aperture_sd_deg))) ** 2
    if not len(fallen) or blur2 == 0.0:
        return ""
    seen2 = angle[fallen[0]] ** 2 / (2.0 * drop[fallen[0]])
    sharp2 = seen2 - blur2
    if sharp2 < NARROWEST * blur2:
        return "the sample is as sharp as the table's own apertures: reads low"
    across2 = sharp2 + blur2 / np.cos(np.radians(meter.angle_deg)) ** 2
    seen, sharp = float(np.sqrt(seen2)), float(np.sqrt(sharp2))
    peak = brdf.facet_amplitude(sharp) * sharp2 / float(np.sqrt(seen2 * across2))

    def blurred(delta2: Array) -> Array:
        return brdf.facet_density(delta2, seen, peak)

    windows = meter.windows
    with_blur = sum(facet_flux(meter, w, blurred, INDEX, seen) for w in windows)
    without = sum(lobe_flux(meter, w, float(np.degrees(sharp)), INDEX) for w in windows)
    change = with_blur / without - 1.0 if without > 0.0 else 0.0
    if abs(change) < BLUR_NOTED:
        return ""
    return (
        f"some {abs(change):.0%} {'low' if change < 0 else 'high'}: the table's apertures blur it"
    )


def _profile(measurement: Measurement, meter: Meter) -> tuple[Array, Array] | str:
    """Angles between normal and half-vector (rad, increasing) and facet densities, or a reason."""
    polar = np.degrees(np.arccos(np.clip(measurement.to_lamp[:, 2], -1.0, 1.0)))
    luminous = np.where(measurement.kept[:, None], measurement.radiance_factor, np.nan) @ (
        luminous_weights(measurement.bands)
    )
    with np.errstate(invalid="ignore"):
        usable = measurement.kept & (luminous > 0.0)
    near = usable & (np.abs(polar - meter.angle_deg) <= INCIDENCE_TOLERANCE_DEG)
    if not np.any(near):
        return (
            f"the table has no incidence within {INCIDENCE_TOLERANCE_DEG:g} degree of "
            f"{meter.angle_deg:g} degrees"
        )
    i, o = measurement.to_lamp[near], measurement.to_receiver[near]
    f = brdf.facing(np.broadcast_to(np.array([0.0, 0.0, 1.0]), i.shape), i, o)
    unit = 0.25 * brdf.fresnel_dielectric(f.cos_d, INDEX) * brdf.shadowing(f)
    density = luminous[near] / (np.pi * unit)
    delta = np.sqrt(f.delta2)

    step = np.radians(SAME_ANGLE_DEG)
    _, group = np.unique(np.rint(delta / step).astype(np.int64), return_inverse=True)
    count = np.bincount(group)
    angle = np.bincount(group, delta) / count
    level = np.exp(np.bincount(group, np.log(density)) / count)
    if angle[0] > step:
        return (
            f"the nearest direction has its half-vector {np.degrees(angle[0]):.2g} degrees from "
            "the normal: the mirror direction itself is not in the table"
        )
    if len(angle) < FEWEST_ANGLES:
        return f"only {len(angle)} angles between normal and half-vector"
    square, fall = angle * angle, np.log(level[0] / level)
    straight = fall[2] * square[1] / square[2]
    if fall[1] > CORE_FALL or abs(fall[1] - straight) > CORE_BEND:
        return (
            "the directions are too far apart: the lobe is narrower than the "
            f"{np.degrees(angle[1]):.2g} degrees between the first two half-vectors"
        )
    needed = max(farthest_deg(meter, window) for window in meter.windows)
    if np.degrees(angle[-1]) < needed:
        return (
            f"half-vectors reach {np.degrees(angle[-1]):.2g} degrees from the normal, and the "
            f"window sees {needed:.2g}"
        )
    return angle, level


def _filled(angle: Array, level: Array) -> Density:
    """A density through measured angles: a Gaussian between two, straight in ln D over delta^2."""
    square, logarithm = angle * angle, np.log(level)

    def density(delta2: Array) -> Array:
        return np.asarray(np.exp(np.interp(delta2, square, logarithm)))

    return density
