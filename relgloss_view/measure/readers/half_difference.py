"""Directions from half-vector and difference angles (Rusinkiewicz 1998)."""

from __future__ import annotations

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.measure.gonio import spherical


def to_directions(
    theta_h: Array, phi_h: Array, theta_d: Array, phi_d: Array
) -> tuple[Array, Array]:
    """Unit vectors to lamp and receiver, (N, 3) each, of four angles in degrees, (N,) each.

    theta_h, phi_h: of the half-vector. theta_d, phi_d: of the lamp in the half-vector's frame,
    which is the sample's turned by theta_h about y and then by phi_h about z.

    >>> lamp, receiver = to_directions(*np.array([[0.0], [0.0], [30.0], [0.0]]))
    >>> lamp.round(4).tolist(), receiver.round(4).tolist()
    ([[0.5, 0.0, 0.866]], [[-0.5, 0.0, 0.866]])
    """
    half, difference = spherical(theta_h, phi_h), spherical(theta_d, phi_d)
    tilt, turn = np.radians(theta_h), np.radians(phi_h)
    x = np.cos(tilt) * difference[:, 0] + np.sin(tilt) * difference[:, 2]
    z = np.cos(tilt) * difference[:, 2] - np.sin(tilt) * difference[:, 0]
    y = difference[:, 1]
    lamp = np.stack(
        [np.cos(turn) * x - np.sin(turn) * y, np.sin(turn) * x + np.cos(turn) * y, z], axis=1
    )
    along = np.sum(lamp * half, axis=1)[:, None]
    return lamp, 2.0 * along * half - lamp
