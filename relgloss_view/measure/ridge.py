"""Where the mirror ridge of a GCMS table lies, against where it is said to lie."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def check(
    angles_deg: Array, level: Array, gamma_s_deg: float, *, declared: bool = True
) -> str | None:
    """Placeholder."""
    return None
