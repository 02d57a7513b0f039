"""The instrument's own errors, fitted beside the sample: zeros of its angles, and its apertures.

A goniophotometer's scales have zeros that are a few tenths of a degree off, its sample lies not
quite in the plane of the axes, and its apertures' angular spread is known to some tenths of
itself. For a lobe as narrow as these errors they decide what peak the samples seem to have. They
are unknowns with Gaussian priors about zero (nuisances; Carroll, Ruppert, Stefanski and
Crainiceanu 2006, Measurement Error in Nonlinear Models): the samples move them where they show
them, and where they do not, the prior's spread goes into the standard errors.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from relgloss_view.base.arrays import Array, Mask
from relgloss_view.material import brdf
from relgloss_view.material.material import Material
from relgloss_view.measure.findings import examine
from relgloss_view.measure.table import Measurement

#: Prior standard deviations, degrees: of the mean zero of the two arms, of the tilt that sees the
#: mirror direction, of the sample's own tilt. Instruments are set up to a few tenths of a degree.
MEAN_ZERO_SD_DEG = 0.2
GAMMA_S_SD_DEG = 0.4
TILT_SD_DEG = 0.2
#: Prior standard deviation of the logarithm of the apertures' spread against the declared one: a
#: declared full width taken for a standard deviation, or an edge that is not seen, are within it.
LOG_APERTURE_SD = 0.25
APERTURE, GAMMA_S = "ln aperture", "gamma_s"
ACROSS = "the sample's tilt across the plane"
ACROSS_ALL = (GAMMA_S, ACROSS)  #: tilts that every plane of a table has alike
#: Beyond these an error is no longer one of an instrument that was set up.
LARGEST_ANGLE = float(np.radians(3.0))
LARGEST_LOG_APERTURE = 1.5
#: Of its prior's standard deviation: how near an error is kept to a value where it is held.
PINNED = 1e-3
_PLANAR = 1e-4
_STEP = 1e-4


@dataclass(frozen=True)
class Instrument:
    """K errors that an instrument may have, K - 1 of its angles and one of its apertures.

    An error is true minus declared: radians, and the natural logarithm of the ratio of spreads.
    """

    names: tuple[str, ...]  #: what is off, as in "the zero of alpha"
    prior_sd: Array  #: (K,)
    lamp: Array  #: (K - 1, N, 3), how the direction to the lamp moves with each angle
    receiver: Array  #: (K - 1, N, 3), and that to the receiver

    @property
    def count(self) -> int:
        """K."""
        return len(self.names)

    def subset(self, rows: Mask) -> Instrument:
        """The same errors at the marked samples."""
        return replace(self, lamp=self.lamp[:, rows], receiver=self.receiver[:, rows])

    def moved(self, to_lamp: Array, to_receiver: Array, errors: Array) -> tuple[Array, Array]:
        """Unit directions (N, 3) where the errors (K,) put them."""
        lamp = to_lamp + np.tensordot(errors[:-1], self.lamp, 1)
        receiver = to_receiver + np.tensordot(errors[:-1], self.receiver, 1)
        return _unit(lamp), _unit(receiver)


def instrument_of(measurement: Measurement) -> Instrument | None:
    """The errors that the instrument of a measurement may have; None for tabulated reflectances.

    A table with gamma has the zeros of both arms together and gamma_s; one whose directions all lie
    in a plane the zeros of both arms and the sample's tilt across it; any other the two tilts of
    the sample. The zeros are one unknown, how far the bisector of the arms is off: what they do
    against one another changes the angle between them alone, which a refractive index or a
    shadowing would be taken for.
    """
    if measurement.tabulated:
        return None
    lamp, receiver = measurement.to_lamp, measurement.to_receiver
    across = np.array([1.0, 0.0, 0.0])
    turns: list[tuple[str, float, Array]]
    if measurement.gamma_s_deg is not None:
        # Both arms turn about an axis that tilts with gamma: it is seen in their bisector.
        bisector = lamp + receiver
        tilt = np.arctan2(-bisector[:, 1], bisector[:, 2])
        axis = np.stack([np.zeros_like(tilt), np.cos(tilt), np.sin(tilt)], axis=1)
        turns = [
            ("the mean zero of alpha and beta", MEAN_ZERO_SD_DEG, axis),
            (GAMMA_S, GAMMA_S_SD_DEG, -across),
        ]
    elif (normal := _plane(lamp, receiver)) is not None:
        in_plane = np.cross(normal, np.array([0.0, 0.0, 1.0]))
        turns = [
            ("the mean zero of lamp and receiver", MEAN_ZERO_SD_DEG, normal),
            (ACROSS, TILT_SD_DEG, in_plane),
        ]
    else:
        turns = [
            ("the sample's tilt about y", TILT_SD_DEG, np.array([0.0, 1.0, 0.0])),
            ("the sample's tilt about x", TILT_SD_DEG, across),
        ]
    return Instrument(
        (*(name for name, _, _ in turns), APERTURE),
        np.append(np.radians([sd for _, sd, _ in turns]), LOG_APERTURE_SD),
        np.stack([np.cross(axis, lamp) for _, _, axis in turns]),
        np.stack([np.cross(axis, receiver) for _, _, axis in turns]),
    )


def _plane(to_lamp: Array, to_receiver: Array) -> Array | None:
    """The normal of the one plane that holds the sample's normal and all directions, or None."""
    sideways = np.concatenate([to_lamp, to_receiver])[:, :2]
    length = np.linalg.norm(sideways, axis=1)
    if not np.any(length > _PLANAR):
        return None
    x, y = sideways[np.argmax(length)] / np.max(length)
    if np.any(np.abs(sideways @ np.array([-y, x])) > _PLANAR):
        return None
    # A positive turn takes the normal towards (x, y): angles grow to that side.
    return np.array([-y, x, 0.0])


def corrected(measurement: Measurement, errors: Array) -> Measurement:
    """The measurement with its directions and apertures where the errors (K,) put them."""
    instrument = instrument_of(measurement)
    if instrument is None or not np.any(errors):
        return measurement
    lamp, receiver = instrument.moved(measurement.to_lamp, measurement.to_receiver, errors)
    scale = float(np.exp(errors[-1]))
    first, second = measurement.aperture_sd_deg
    return replace(
        measurement,
        to_lamp=lamp,
        to_receiver=receiver,
        aperture_sd_deg=(scale * first, scale * second),
    )


def as_fitted(measurement: Measurement, material: Material) -> Measurement:
    """The measurement as the fit of `material` to it saw it.

    Without the rows and bands that the table's own findings leave out, its directions and apertures
    corrected for the errors of the instrument that the fit found. Unchanged without a fit.
    """
    fit = material.fit
    if fit is None:
        return measurement
    measurement = examine(measurement).measurement
    instrument = instrument_of(measurement)
    if instrument is not None and all(name in fit.instrument for name in instrument.names):
        found = [float(fit.instrument[name]["value"]) for name in instrument.names]
        errors = np.append(np.radians(found[:-1]), found[-1])
        measurement = corrected(measurement, errors)
    spread = fit.residuals.get("aperture_sd_deg")  # that of the fit, whoever declared it
    if spread is None:
        return measurement
    return replace(measurement, aperture_sd_deg=(float(spread[0]), float(spread[1])))


def _unit(directions: Array) -> Array:
    return np.asarray(directions / np.linalg.norm(directions, axis=-1, keepdims=True))


@dataclass(frozen=True)
class Sway:
    """How the errors move what a lobe's shape depends on, to first order about zero errors.

    Tilts are signed here: errors of a fraction of a lobe's width carry it over the normal.
    """

    along: Array  #: (N,), tilt of the half-vector in the plane of the two directions, rad
    across: Array  #: (N,)
    along_slope: Array  #: (K - 1, N)
    across_slope: Array  #: (K - 1, N)
    cos_d_slope: Array  #: (K - 1, N)
    grooves_slope: Array  #: (K - 1, N), of the logarithm of G / (4 cos_i cos_o)

    def subset(self, rows: Mask) -> Sway:
        """The marked samples."""
        return Sway(
            self.along[rows],
            self.across[rows],
            self.along_slope[:, rows],
            self.across_slope[:, rows],
            self.cos_d_slope[:, rows],
            self.grooves_slope[:, rows],
        )


def sway(instrument: Instrument, to_lamp: Array, to_receiver: Array) -> Sway:
    """The first order of each error at unit directions (N, 3), by central differences."""
    along, across = signed_tilts(to_lamp, to_receiver)
    slopes = []
    for k in range(instrument.count - 1):
        ends = []
        for step in (_STEP, -_STEP):
            errors = np.zeros(instrument.count)
            errors[k] = step
            lamp, receiver = instrument.moved(to_lamp, to_receiver, errors)
            facing = brdf.facing(np.broadcast_to((0.0, 0.0, 1.0), lamp.shape), lamp, receiver)
            grooves = np.log(np.maximum(brdf.shadowing(facing), 1e-300))
            ends.append((*signed_tilts(lamp, receiver), facing.cos_d, grooves))
        slopes.append([(up - down) / (2.0 * _STEP) for up, down in zip(*ends, strict=True)])
    return Sway(along, across, *(np.array(part) for part in zip(*slopes, strict=True)))


def signed_tilts(to_lamp: Array, to_receiver: Array) -> tuple[Array, Array]:
    """Angles (N,) of the normal from the half-vector, in the plane of the directions and across.

    Their squares sum to that of the angle between the two. Where lamp and receiver coincide the
    plane is the one that holds the x axis.
    """
    half = _unit(to_lamp + to_receiver)
    split = to_lamp - to_receiver
    length = np.linalg.norm(split, axis=1, keepdims=True)
    aside = np.array([1.0, 0.0, 0.0]) - half[:, :1] * half
    split = np.where(length > 1e-6, split / np.maximum(length, 1e-6), _unit(aside))
    third = np.cross(half, split)
    sine2 = split[:, 2] ** 2 + third[:, 2] ** 2
    sine = np.sqrt(sine2)
    angle = np.arctan2(sine, half[:, 2])
    ratio = np.where(sine > 1e-12, angle / np.maximum(sine, 1e-12), 1.0)
    return np.asarray(split[:, 2] * ratio), np.asarray(third[:, 2] * ratio)
