"""A material's reflection in luminance: slices in the plane of incidence, albedo, measured points.

Luminance is Y under the scene's lamp, so that a BRDF of 1/pi is the perfect diffuser's.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from relgloss_view.base.arrays import Array, Mask
from relgloss_view.material import brdf
from relgloss_view.material.albedo import directional_albedo
from relgloss_view.material.material import Material
from relgloss_view.material.spectra import Illuminant, illuminant, xyz_weights
from relgloss_view.measure.bands import Bands
from relgloss_view.measure.gonio import direction
from relgloss_view.measure.table import NEGATIVE, Measurement
from relgloss_view.viewer.plots.caches import Recent

STEEPEST_DEG = 85.0  #: incidence and receiver angles end here
SAME_ANGLE_DEG = 0.5  #: a measured incidence this near is the one asked for
MOST_POINTS = 2000  #: that are drawn at an incidence; a plot is hardly as many pixels wide
IN_PLANE = 1e-4  #: of sin_i sin_o, by which lamp, normal and receiver may miss one plane
#: Dense towards grazing incidence, where Fresnel's reflectance bends; each takes 3 ms.
ALBEDO_INCIDENCES_DEG = np.array([0.0, 20.0, 40.0, 50.0, 60.0, 65.0, 70.0, 75.0, 80.0, 85.0])


@dataclass(frozen=True)
class Slice:
    """BRDF in the plane of incidence, luminance, 1/sr, at receiver angles in degrees.

    Receiver angles are positive on the mirror side.
    """

    incidence_deg: float
    receiver_deg: Array
    diffuse: Array
    specular: Array

    @property
    def total(self) -> Array:
        """Diffuse and specular together."""
        return self.diffuse + self.specular


@dataclass(frozen=True)
class Albedo:
    """Share of the luminance that is reflected, by angle of incidence in degrees."""

    incidence_deg: Array
    diffuse: Array
    specular: Array

    @property
    def total(self) -> Array:
        """Diffuse and specular together."""
        return self.diffuse + self.specular


@dataclass(frozen=True)
class Points:
    """Measured values in the plane of incidence: receiver angles in degrees, BRDF in 1/sr."""

    incidence_deg: float
    receiver_deg: Array
    value: Array


def radiance_factor(value: Array) -> Array:
    """pi times a BRDF: 1 is the perfect diffuser."""
    return np.pi * value


def to_polar(receiver_deg: Array, value: Array) -> tuple[Array, Array]:
    """(f cos, f sin): along the normal, and along the surface towards the mirror side."""
    angle = np.radians(receiver_deg)
    return value * np.cos(angle), value * np.sin(angle)


def receiver_angles(material: Material, incidence_deg: float) -> Array:
    """Receiver angles in degrees for a smooth curve: dense where a lobe peaks."""
    width = min([lobe.s_deg for lobe in material.visible_lobes()], default=40.0)
    near = incidence_deg + np.linspace(-4.0, 4.0, 81) * max(width, 0.05)
    angles = np.unique(np.concatenate([np.linspace(-STEEPEST_DEG, STEEPEST_DEG, 171), near]))
    return np.asarray(angles[np.abs(angles) <= STEEPEST_DEG])


def brdf_slice(material: Material, lamp: str, incidence_deg: float) -> Slice:
    """The slice at an angle of incidence; InputError for a lamp that is none."""
    light = illuminant(lamp)

    def make() -> Slice:
        receiver = receiver_angles(material, incidence_deg)
        i = np.broadcast_to(direction(-incidence_deg), (len(receiver), 3))
        weights = material.xyz_weights(light)[:, 1]
        diffuse, specular = material.evaluate(i, direction(receiver))
        return Slice(incidence_deg, receiver, diffuse @ weights, specular @ weights)

    return _slices.get(material, (light, incidence_deg), make)


def seen_through_apertures(
    material: Material, lamp: str, incidence_deg: float, aperture_sd_deg: tuple[float, float]
) -> Points | None:
    """The total BRDF as an instrument with these apertures sees it; None where that is the slice.

    None too for the diffuse model that no fit uses, EON.
    """
    if max(aperture_sd_deg) <= 0.0 or material.diffuse.model == "eon":
        return None
    light = illuminant(lamp)

    def make() -> Points:
        from relgloss_view.fitting import curves

        receiver = receiver_angles(material, incidence_deg)
        factor = curves.seen(material, *curves.in_plane(incidence_deg, receiver), aperture_sd_deg)
        return Points(incidence_deg, receiver, factor @ _luminance(material.bands, light) / np.pi)

    return _blurred.get(material, (light, incidence_deg, aperture_sd_deg), make)


def albedo_curve(material: Material, lamp: str, *, wait: bool = True) -> Albedo | None:
    """Directional albedo at ALBEDO_INCIDENCES_DEG; InputError for a lamp that is none.

    It takes 30 ms the first time: without `wait` it is None until it has been computed.
    """
    light = illuminant(lamp)
    parts = _albedos.peek(material, ())
    if parts is None:
        if not wait:
            return None
        parts = _albedos.get(
            material, (), lambda: directional_albedo(material, ALBEDO_INCIDENCES_DEG)
        )
    weights = material.xyz_weights(light)[:, 1]
    return Albedo(ALBEDO_INCIDENCES_DEG, parts[0] @ weights, parts[1] @ weights)


def measured_incidences(measurement: Measurement) -> Array:
    """Angles of incidence in degrees, whole ones, that have three or more points in their plane."""

    def make() -> Array:
        points = _planes.get(measurement, (), lambda: _Plane.of(measurement))
        angles, count = np.unique(np.round(points.incidence_deg[points.rows]), return_counts=True)
        return np.asarray(angles[count >= 3])

    return _incidences.get(measurement, (), make)


def measured_points(measurement: Measurement, lamp: str, incidence_deg: float) -> Points | None:
    """Up to MOST_POINTS points measured at an incidence, by receiver; None where none is nearby."""
    light = illuminant(lamp)

    def make() -> tuple[Points | None]:
        plane = _planes.get(measurement, (), lambda: _Plane.of(measurement))
        near = np.abs(plane.incidence_deg - incidence_deg) < SAME_ANGLE_DEG
        rows = plane.rows & near
        value = measurement.radiance_factor[rows] @ _luminance(measurement.bands, light) / np.pi
        receiver = plane.receiver_deg[rows]
        above = np.isfinite(value) & (value > 0.0)
        if not np.any(above):
            return (None,)
        order = np.argsort(receiver[above])
        if len(order) > MOST_POINTS:
            order = order[np.linspace(0, len(order) - 1, MOST_POINTS).astype(int)]
        return (Points(incidence_deg, receiver[above][order], value[above][order]),)

    return _points.get(measurement, (light, incidence_deg), make)[0]


@dataclass(frozen=True)
class _Plane:
    """Angles of a measurement's samples, and which of them lie in the plane of incidence."""

    incidence_deg: Array
    receiver_deg: Array
    rows: Mask

    @classmethod
    def of(cls, measurement: Measurement) -> _Plane:
        normal = np.broadcast_to(np.array([0.0, 0.0, 1.0]), measurement.to_lamp.shape)
        f = brdf.facing(normal, measurement.to_lamp, measurement.to_receiver)
        theta_i, theta_o = (np.arccos(np.clip(mu, 0.0, 1.0)) for mu in (f.mu_i, f.mu_o))
        sines = np.sin(theta_i) * np.sin(theta_o)
        rows = measurement.kept.copy()
        if measurement.bands.is_rgb:
            # A saturated colour has a negative channel, and a luminance all the same.
            rows |= measurement.reasons == NEGATIVE
        rows &= (f.mu_i > 0.0) & (f.mu_o > 0.0) & (np.abs(np.abs(f.t) - sines) < IN_PLANE)
        rows &= np.all(np.isfinite(measurement.radiance_factor), axis=1)
        side = np.where(f.t > 0.0, -1.0, 1.0)
        return cls(np.degrees(theta_i), side * np.degrees(theta_o), np.asarray(rows))


def _luminance(bands: Bands, light: Illuminant) -> Array:
    return np.asarray(xyz_weights(bands, light)[:, 1])


_slices: Recent[Slice] = Recent()
_blurred: Recent[Points] = Recent()
_albedos: Recent[tuple[Array, Array]] = Recent()
_points: Recent[tuple[Points | None]] = Recent()
_planes: Recent[_Plane] = Recent(4)
_incidences: Recent[Array] = Recent(4)
