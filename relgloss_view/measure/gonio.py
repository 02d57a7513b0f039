"""Instrument angles to unit vectors, and the angle sets that instruments and readers sample.

Sample frame: normal +z, the instrument's plane of incidence at zero tilt is x-z.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

#: The tilt at which the paper's extra scan, "to measure sharp specular", crosses the mirror
#: direction. Read as the tilt of the mirror plane; the data are checked against it.
GAMMA_S_DEG = 15.0
OCCLUSION_DEG = 8.0  #: lamp and receiver arms shadow each other below this angle
GRAZING_COSINE = 0.05  #: footprints grow without bound towards the horizon


def direction(polar_deg: ArrayLike, tilt_deg: ArrayLike = 0.0) -> Array:
    """Unit vectors R_x(tilt) (sin p, 0, cos p), degrees in, shape (..., 3) out."""
    p, tau = np.broadcast_arrays(np.radians(polar_deg), np.radians(tilt_deg))
    return np.stack([np.sin(p), -np.sin(tau) * np.cos(p), np.cos(tau) * np.cos(p)], axis=-1)


def spherical(theta_deg: ArrayLike, phi_deg: ArrayLike) -> Array:
    """Unit vectors of polar angle theta and azimuth phi, degrees in, shape (..., 3) out."""
    theta, phi = np.broadcast_arrays(np.radians(theta_deg), np.radians(phi_deg))
    return np.stack(
        [np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=-1
    )


def gcms_directions(
    alpha_deg: ArrayLike,
    beta_deg: ArrayLike,
    gamma_deg: ArrayLike,
    gamma_s_deg: float = GAMMA_S_DEG,
) -> tuple[Array, Array]:
    """To lamp and to receiver for a goniophotometer of the GCMS-4 kind.

    alpha (lamp) and beta (receiver) are polar angles positive to the same side, so the mirror
    direction is beta = -alpha; the sample tilts by gamma about the in-plane axis and sees the
    mirror direction at gamma = gamma_s. Both arms tilt together ("coplanar tilt"), so that at
    beta = -alpha the half-vector stands at exactly |gamma - gamma_s| from the normal.
    """
    tilt = np.asarray(gamma_deg, dtype=np.float64) - gamma_s_deg
    return direction(alpha_deg, tilt), direction(beta_deg, tilt)


def gcms4_grid() -> Array:
    """The 997 distinct (alpha, beta, gamma) of the paper's measurement, degrees, shape (997, 3).

    The regular part is 15 x 8 x 7; the scan across the mirror direction adds 15 x 11 at
    gamma = 15, of which 8 repeat regular ones.
    """
    alphas = range(-70, 71, 10)
    regular = [(a, b, g) for a in alphas for b in range(0, 71, 10) for g in GAMMAS_DEG]
    scan = [(a, -a + d, 15) for a in alphas for d in range(-5, 6)]
    return np.array(list(dict.fromkeys(regular + scan)), dtype=np.float64)


GAMMAS_DEG = (0, 5, 10, 15, 30, 45, 60)


def tabulated_grid() -> Array:
    """(theta_i, theta_r, phi) in degrees at which a densely tabulated BRDF is read, shape (N, 3).

    A 10-degree grid up to 70 degrees in six azimuths, and the mirror scan of the paper in
    one-degree steps; phi is the azimuth between lamp and receiver, 180 in the mirror plane.
    """
    thetas = range(0, 71, 10)
    azimuths = (0, 45, 90, 135, 160, 180)
    grid = [(i, r, p if i and r else 180) for i in thetas for r in thetas for p in azimuths]
    scan = [(i, r, 180) if r >= 0 else (i, -r, 0) for i in thetas for r in range(i - 5, i + 6)]
    return np.array(list(dict.fromkeys(grid + scan)), dtype=np.float64)
