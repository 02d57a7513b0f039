"""The coordinates of ALTA that give both directions of an isotropic sample.

Source: ALTA's core/params.h, which defines them, and core/params.cpp (Belcour, Barla, Pacanowski
2014). Coordinates with two numbers or fewer, and 'RETRO_TL_TVL_PROJ_DPHI' and 'STEREOGRAPHIC',
which ALTA does not invert, are not among them.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.measure.gonio import spherical
from relgloss_view.measure.readers import half_difference

#: From the numbers (N, D) of a row to the vectors to lamp and receiver, (N, 3) each; NaN where
#: there is no such direction.
Directions = Callable[[Array], tuple[Array, Array]]


def _half(x: Array) -> tuple[Array, Array]:
    return _full_half(np.insert(x, 1, 0.0, axis=1))


def _full_half(x: Array) -> tuple[Array, Array]:
    viewer, lamp = half_difference.to_directions(*np.degrees(x.T))  # the difference is V's
    return lamp, viewer


def _spherical(x: Array) -> tuple[Array, Array]:
    theta_l, phi_l, theta_v, phi_v = np.degrees(x.T)
    return spherical(theta_l, phi_l), spherical(theta_v, phi_v)


def _difference(x: Array) -> tuple[Array, Array]:
    theta_v, theta_l, dphi = np.degrees(x.T)
    return spherical(theta_l, dphi), spherical(theta_v, 0.0 * dphi)


def _polar_plane(x: Array) -> Array:
    """Unit vectors of (theta cos(phi), theta sin(phi)), radians, (N, 2)."""
    return spherical(np.degrees(np.hypot(*x.T)), np.degrees(np.arctan2(x[:, 1], x[:, 0])))


def _projected(x: Array) -> tuple[Array, Array]:
    return spherical(np.degrees(x[:, 0]), np.zeros(len(x))), _polar_plane(x[:, 1:])


def _back(x: Array) -> tuple[Array, Array]:
    """About the back vector K = V + R, where R is the mirror direction of the lamp."""
    lamp = spherical(np.degrees(x[:, 0]), np.zeros(len(x)))
    mirror, back = lamp * [-1.0, -1.0, 1.0], _polar_plane(x[:, 1:])
    return lamp, 2.0 * np.sum(mirror * back, axis=1)[:, None] * back - mirror


def _stark(x: Array) -> tuple[Array, Array]:
    """|H_p|, |B| and the azimuth of B from H, of H = (L + V) / 2 and B = (L - V) / 2.

    |H|^2 + |B|^2 = 1 and H is normal to B, because L and V are unit vectors.
    """
    half_x, length, phi = x.T
    with np.errstate(invalid="ignore"):  # NaN: longer than unit vectors have it
        half_z = np.sqrt(1.0 - half_x**2 - length**2)
    # B = length (sin t cos phi, sin t sin phi, cos t) with half_x sin t cos phi + half_z cos t = 0.
    tilt = np.arctan2(half_z, -half_x * np.cos(phi))
    back = length[:, None] * spherical(np.degrees(tilt), np.degrees(phi))
    half = np.stack([half_x, np.zeros(len(x)), half_z], axis=1)
    return half + back, half - back


def _neumann(x: Array) -> tuple[Array, Array]:
    """|H_p|, |B_p| and the azimuth of B_p from H_p: the same vectors projected on the sample."""
    half_x, length, phi = x.T
    made = []
    for sign in (1.0, -1.0):
        flat = np.stack([half_x + sign * length * np.cos(phi), sign * length * np.sin(phi)], axis=1)
        with np.errstate(invalid="ignore"):
            up = np.sqrt(1.0 - np.sum(flat**2, axis=1))
        made.append(np.concatenate([flat, up[:, None]], axis=1))
    return made[0], made[1]


def _cartesian(x: Array) -> tuple[Array, Array]:
    return x[:, 3:], x[:, :3]


#: How many numbers the coordinates of a name have, and what makes directions of them.
COORDINATES: Mapping[str, tuple[int, Directions]] = {
    "RUSIN_TH_TD_PD": (3, _half),
    "RUSIN_TH_PH_TD_PD": (4, _full_half),
    "SPHERICAL_TL_PL_TV_PV": (4, _spherical),
    "ISOTROPIC_TV_TL_DPHI": (3, _difference),
    "ISOTROPIC_TL_TV_PROJ_DPHI": (3, _projected),
    "SCHLICK_TL_TK_PROJ_DPHI": (3, _back),
    "STARK_3D": (3, _stark),
    "NEUMANN_3D": (3, _neumann),
    "CARTESIAN": (6, _cartesian),
}
