"""Directions from half-vector and difference angles, and back (Rusinkiewicz 1998)."""

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


def angles_of(i: Array, o: Array) -> tuple[Array, Array, Array]:
    """theta_h, theta_d and phi_d in radians, (N,) each, of unit vectors to lamp and eye, (N, 3).

    phi_d is from -pi to pi; at the pole, where the half-vector has no azimuth, it is the lamp's.

    >>> lamp, eye = np.array([[0.0, 0.6, 0.8]]), np.array([[0.0, -0.6, 0.8]])
    >>> [round(float(angle[0]), 3) for angle in angles_of(lamp, eye)]
    [0.0, 0.644, 1.571]
    """
    half = i + o
    half /= np.linalg.norm(half, axis=1)[:, None]
    sin_h = np.hypot(half[:, 0], half[:, 1])
    theta_h = np.arctan2(sin_h, half[:, 2])
    # The azimuth of h, as a unit vector; at the pole any will do.
    polar = sin_h > 0.0
    cos_p = np.where(polar, half[:, 0] / np.where(polar, sin_h, 1.0), 1.0)
    sin_p = np.where(polar, half[:, 1] / np.where(polar, sin_h, 1.0), 0.0)
    # i in the frame whose pole is h: turned by -phi_h about z, then by -theta_h about y.
    x = i[:, 0] * cos_p + i[:, 1] * sin_p
    y = i[:, 1] * cos_p - i[:, 0] * sin_p
    dx = x * half[:, 2] - i[:, 2] * sin_h
    dz = x * sin_h + i[:, 2] * half[:, 2]
    return theta_h, np.arctan2(np.hypot(dx, y), dz), np.arctan2(y, dx)
