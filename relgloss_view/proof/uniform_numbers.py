"""Uniforms of a drawing as JSON: what the shaders of a page take, number by number."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

#: Of colours that are drawn band by band, which no page does.
OF_BANDS = ("band_weights", "band_reflectance")


def uniform_numbers(uniforms: Mapping[str, Any]) -> dict[str, float | list[float]]:
    """Uniforms by name: a number, or a flat list, matrices column by column. OF_BANDS are left out.

    >>> uniform_numbers({"c": 2, "lamp_m": np.array([0.0, 1.0, 0.0]), "band_weights": 1.0})
    {'c': 2.0, 'lamp_m': [0.0, 1.0, 0.0]}
    """
    return {
        name: float(value) if np.ndim(value) == 0 else np.ravel(np.asarray(value, float)).tolist()
        for name, value in uniforms.items()
        if name not in OF_BANDS
    }
