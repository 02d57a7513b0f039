"""A display's way back, light to digital values, as nodes that shaders interpolate."""

from __future__ import annotations

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.display.monitor import Emission

#: Cells of a curve. The way back of a power of 5 or of 0.5 is then off by at most 3e-4 between two
#: nodes, an eighth of a step of 8 bits, and of one of 2.2 by 1e-5.
CURVE_CELLS = 1024


def curve_nodes(emission: Emission) -> Array:
    """(3, CURVE_CELLS, 2): each channel's digital value at a cell's lower end, and its rise.

    The cells are even in the fourth root of light. What transfer.glsl's curves_encode reads.
    """
    light = np.linspace(0.0, 1.0, CURVE_CELLS + 1) ** 4
    digital = emission.digital(np.repeat(light[:, None], 3, axis=1)).T
    return np.stack([digital[:, :-1], np.diff(digital, axis=1)], axis=-1)
