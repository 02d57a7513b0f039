"""Instrument angles to unit vectors, and the angle sets that instruments and readers sample.

Sample frame: normal +z, the instrument's plane of incidence at zero tilt is x-z.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from relgloss_view.base.arrays import Array

#: Tilt at which the extra scan of Ishii et al., "to measure sharp specular", crosses the mirror
#: direction. The readers take it as the tilt of the mirror plane and check the data against it.
GAMMA_S_DEG = 15.0
OCCLUSION_DEG = 8.0  #: lamp and receiver arms shadow each other below this angle
GRAZING_COSINE = 0.05  #: footprints grow without bound towards the horizon


def direction(polar_deg: ArrayLike, tilt_deg: ArrayLike = 0.0) -> Array:
    """Unit vectors R_x(tilt) (sin p, 0, cos p), shape (..., 3).

    polar_deg: angle p from the normal in the plane of incidence, degrees, signed.
    tilt_deg: turn about the x axis, degrees.

    >>> direction(30.0, 60.0).round(4).tolist()
    [0.5, -0.75, 0.433]
    """
    p, tau = np.broadcast_arrays(np.radians(polar_deg), np.radians(tilt_deg))
    return np.stack([np.sin(p), -np.sin(tau) * np.cos(p), np.cos(tau) * np.cos(p)], axis=-1)


def spherical(theta_deg: ArrayLike, phi_deg: ArrayLike) -> Array:
    """Unit vectors of polar angle theta and azimuth phi, both in degrees; shape (..., 3).

    >>> spherical(60.0, 90.0).round(4).tolist()
    [0.0, 0.866, 0.5]
    """
    theta, phi = np.broadcast_arrays(np.radians(theta_deg), np.radians(phi_deg))
    return np.stack(
        [np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=-1
    )


def from_normal(directions: Array) -> Array:
    """Angles (N,) of vectors (N, 3) of any length from the normal, degrees; exact near 0.

    >>> from_normal(np.array([[0.0, 1.0, 1.0], [0.0, 0.0, 2.0]])).round(6).tolist()
    [45.0, 0.0]
    """
    across = np.hypot(directions[:, 0], directions[:, 1])
    return np.asarray(np.degrees(np.arctan2(across, directions[:, 2])))


def gcms_directions(
    alpha_deg: ArrayLike,
    beta_deg: ArrayLike,
    gamma_deg: ArrayLike,
    gamma_s_deg: float = GAMMA_S_DEG,
) -> tuple[Array, Array]:
    """Unit vectors to the lamp and to the receiver of a GCMS goniophotometer, (..., 3) each.

    alpha_deg, beta_deg: polar angles of lamp and receiver, degrees, -90 to 90. Both are positive to
    the same side, so the mirror direction is beta = -alpha.
    gamma_deg: tilt of the sample about the in-plane axis, degrees, -90 to 90.
    gamma_s_deg: tilt that sees the mirror direction, degrees.

    Both arms tilt together ("coplanar tilt"): at beta = -alpha the half-vector lies at exactly
    |gamma - gamma_s| from the normal. Geometry after Ishii et al.

    >>> lamp, receiver = gcms_directions(-45.0, 45.0, 15.0)
    >>> float((lamp + receiver)[2].round(4))  # along the normal at gamma = gamma_s
    1.4142
    """
    tilt = np.asarray(gamma_deg, dtype=np.float64) - gamma_s_deg
    return direction(alpha_deg, tilt), direction(beta_deg, tilt)


def gcms4_grid() -> Array:
    """The 997 distinct (alpha, beta, gamma) that Ishii et al. measured, degrees, (997, 3).

    The regular part is 15 x 8 x 7. The scan across the mirror direction adds 15 x 11 geometries at
    gamma = 15, of which 8 repeat regular ones.

    >>> gcms4_grid().shape == (15 * 8 * 7 + 15 * 11 - 8, 3)
    True
    """
    alphas = range(-70, 71, 10)
    regular = [(a, b, g) for a in alphas for b in range(0, 71, 10) for g in GAMMAS_DEG]
    scan = [(a, -a + d, 15) for a in alphas for d in range(-5, 6)]
    return np.array(list(dict.fromkeys(regular + scan)), dtype=np.float64)


GAMMAS_DEG = (0, 5, 10, 15, 30, 45, 60)


def tabulated_grid() -> Array:
    """(theta_i, theta_r, phi) at which a densely tabulated BRDF is read, degrees, (N, 3).

    A 10-degree grid up to 70 degrees in six azimuths, and the mirror scan of Ishii et al. in
    one-degree steps. phi is the azimuth between lamp and receiver, 180 on the mirror's side.
    """
    thetas = range(0, 71, 10)
    azimuths = (0, 45, 90, 135, 160, 180)
    grid = [(i, r, p if i and r else 180) for i in thetas for r in thetas for p in azimuths]
    scan = [(i, r, 180) if r >= 0 else (i, -r, 0) for i in thetas for r in range(i - 5, i + 6)]
    return np.array(list(dict.fromkeys(grid + scan)), dtype=np.float64)
