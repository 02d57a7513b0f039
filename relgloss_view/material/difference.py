"""CIEDE2000 colour difference. The twin of shaders/difference.glsl, in float64."""

from __future__ import annotations

import numpy as np

from relgloss_view.base.arrays import Array


def chroma_weight(chroma: Array) -> Array:
    """sqrt(C^7 / (C^7 + 25^7))."""
    c7 = (chroma / 25.0) ** 7
    return np.asarray(np.sqrt(c7 / (c7 + 1.0)))


def hue(a: Array, b: Array) -> Array:
    """Hue angle, radians, 0 to 2 pi; 0 where a and b are 0."""
    return np.asarray(np.arctan2(b, a) % (2.0 * np.pi))


def delta_e_2000(first: Array, second: Array) -> Array:
    """CIEDE2000 difference (...) of L*, a*, b* colours (..., 3); all parametric weights are one.

    Source: Sharma, Wu, Dalal 2005, "The CIEDE2000 color-difference formula: implementation notes".

    >>> pair = np.array([[50.0, 2.6772, -79.7751], [50.0, 0.0, -82.7485]])
    >>> round(float(delta_e_2000(*pair)), 4)  # the first pair of their table 1
    2.0425
    """
    l1, a1, b1 = np.moveaxis(first, -1, 0)
    l2, a2, b2 = np.moveaxis(second, -1, 0)
    stretch = 1.5 - 0.5 * chroma_weight(0.5 * (np.hypot(a1, b1) + np.hypot(a2, b2)))
    c1, c2 = np.hypot(a1 * stretch, b1), np.hypot(a2 * stretch, b2)
    h1, h2 = hue(a1 * stretch, b1), hue(a2 * stretch, b2)
    gray = c1 * c2 == 0.0
    turn = (h2 - h1 + np.pi) % (2.0 * np.pi) - np.pi
    turn = np.where(np.abs(h2 - h1) <= np.pi, h2 - h1, turn)
    turn = np.where(gray, 0.0, turn)
    hue_difference = 2.0 * np.sqrt(c1 * c2) * np.sin(0.5 * turn)
    apart = np.abs(h1 - h2) > np.pi
    around = np.where(h1 + h2 < 2.0 * np.pi, 2.0 * np.pi, -2.0 * np.pi)
    mean_hue = np.where(gray, h1 + h2, 0.5 * (h1 + h2 + np.where(apart, around, 0.0)))
    square = (0.5 * (l1 + l2) - 50.0) ** 2
    c_mean = 0.5 * (c1 + c2)
    t = (
        1.0
        - 0.17 * np.cos(mean_hue - np.radians(30.0))
        + 0.24 * np.cos(2.0 * mean_hue)
        + 0.32 * np.cos(3.0 * mean_hue + np.radians(6.0))
        - 0.20 * np.cos(4.0 * mean_hue - np.radians(63.0))
    )
    bump = 30.0 * np.exp(-(((np.degrees(mean_hue) - 275.0) / 25.0) ** 2))
    rotation = -np.sin(np.radians(2.0 * bump)) * 2.0 * chroma_weight(c_mean)
    lightness = (l2 - l1) / (1.0 + 0.015 * square / np.sqrt(20.0 + square))
    chroma = (c2 - c1) / (1.0 + 0.045 * c_mean)
    hue_part = hue_difference / (1.0 + 0.015 * c_mean * t)
    total = lightness**2 + chroma**2 + hue_part**2 + rotation * chroma * hue_part
    return np.asarray(np.sqrt(np.maximum(total, 0.0)))
