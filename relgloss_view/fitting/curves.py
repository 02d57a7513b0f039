"""A fitted material as the instrument would see it: through its apertures, at any directions."""

from __future__ import annotations

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.fitting.metal import unknowns_of
from relgloss_view.fitting.model import State, predict
from relgloss_view.fitting.shapes import geometry
from relgloss_view.material import brdf
from relgloss_view.material.material import Material
from relgloss_view.measure.gonio import direction, spherical


def state_of(material: Material) -> State:
    """The unknowns of a material whose diffuse part is Lambert or Oren-Nayar."""
    bands = material.bands.count
    log_s, n, ks = unknowns_of(material.specular, bands)
    return State(
        material.diffuse.sigma**2 if material.diffuse.model == "oren-nayar" else 0.0,
        log_s,
        n,
        np.asarray(material.diffuse.albedo, dtype=np.float64),
        ks,
    )


def seen(
    material: Material, to_lamp: Array, to_receiver: Array, aperture_sd_deg: tuple[float, float]
) -> Array:
    """Radiance factors (N, B) at unit directions (N, 3), blurred by apertures of the given sd."""
    return predict(geometry(to_lamp, to_receiver, aperture_sd_deg), state_of(material))


def facing(to_lamp: Array, to_receiver: Array) -> brdf.Facing:
    """Angles between the flat sample, the lamp and the receiver."""
    normal = np.broadcast_to(np.array([0.0, 0.0, 1.0]), to_lamp.shape)
    return brdf.facing(normal, to_lamp, to_receiver)


def in_plane(incidence_deg: float, receiver_deg: Array) -> tuple[Array, Array]:
    """Lamp at incidence_deg, receivers on the mirror side where receiver_deg is positive."""
    lamp = np.broadcast_to(direction(-incidence_deg), (len(receiver_deg), 3))
    return lamp, direction(receiver_deg)


def tilted(half_angle_deg: float, tilt_deg: Array) -> tuple[Array, Array]:
    """A mirror pair whose two arms tilt together out of the plane."""
    return direction(-half_angle_deg, tilt_deg), direction(half_angle_deg, tilt_deg)


def around(theta_deg: float, azimuth_deg: Array) -> tuple[Array, Array]:
    """Lamp and receiver at the same polar angle; azimuth 180 is the mirror direction."""
    lamp = spherical(np.full_like(azimuth_deg, theta_deg), 180.0)
    return lamp, spherical(theta_deg, 180.0 - azimuth_deg)
