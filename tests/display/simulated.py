"""Simulated readings of displays whose faults are known."""

from __future__ import annotations

import numpy as np

from relgloss_view.display.readings import Readings
from relgloss_view.material.spectra import D65_XY, SRGB_PRIMARIES_XY, rgb_to_xyz_matrix

MATRIX = rgb_to_xyz_matrix(SRGB_PRIMARIES_XY, D65_XY)


def patches(count=100, seed=3):
    """Ends, primaries, ramps of gray and of channels, random colours; (count, 3), 0 to 1."""
    ramp = np.linspace(0.0, 1.0, 11)[1:-1, None]
    fixed = [np.zeros((2, 3)), np.ones((2, 3)), np.eye(3), 1.0 - np.eye(3)]
    fixed += [ramp * np.eye(3)[k] for k in range(3)] + [ramp * np.ones(3)]
    fixed = np.vstack(fixed)
    more = np.random.default_rng(seed).random((max(count - len(fixed), 0), 3))
    every = np.vstack([fixed, more])[:count]
    return np.random.default_rng(seed + 1).permutation(every)


def srgb(digital):
    """Light of sRGB's digital values (IEC 61966-2-1:1999)."""
    return np.where(digital <= 0.04045, digital / 12.92, ((digital + 0.055) / 1.055) ** 2.4)


def readings(light, digital=None, *, white=160.0, black=0.2, noise=0.005, seed=1, declared=True):
    """Readings of a display that shows MATRIX @ light(digital) over a neutral black, in cd/m2."""
    digital = patches() if digital is None else digital
    top = white - black
    xyz = top * light(digital) @ MATRIX.T + black * MATRIX.sum(axis=1)
    xyz = xyz * (1.0 + noise * np.random.default_rng(seed).normal(size=xyz.shape))
    return of(digital, xyz, declared)


def of(digital, xyz, declared=True):
    """Readings of given numbers."""
    places = tuple(f"line {k + 2}" for k in range(len(digital)))
    return Readings(digital, xyz, True, declared, places, "simulated.csv")
