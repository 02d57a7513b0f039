"""A display's way back, light to digital values, as nodes that shaders interpolate."""

from __future__ import annotations

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.display.monitor import Emission
from relgloss_view.display.table import Table

#: Cells of a curve. The way back of a power of 5 or of 0.5 is then off by at most 3e-4 between two
#: nodes, an eighth of a step of 8 bits, and of one of 2.2 by 1e-5.
CURVE_CELLS = 1024

#: Nodes of a table along each channel.
TABLE_NODES = 49


def curve_nodes(emission: Emission) -> Array:
    """(3, CURVE_CELLS, 2): each channel's digital value at a cell's lower end, and its rise.

    The cells are even in the fourth root of light. What transfer.glsl's curves_encode reads.
    """
    light = np.linspace(0.0, 1.0, CURVE_CELLS + 1) ** 4
    digital = emission.digital(np.repeat(light[:, None], 3, axis=1)).T
    return np.stack([digital[:, :-1], np.diff(digital, axis=1)], axis=-1)


def table_nodes(table: Table) -> Array:
    """(TABLE_NODES, TABLE_NODES, TABLE_NODES, 4): blue first, then green, then red; the last is 1.

    Nodes are even in the power of 3/8 of light, of which transfer.glsl's table_place finds the
    place. Digital values of light that the table does not reach run on straight beyond 0 and 1, by
    table.MOST_BEYOND at most: cells at the table's edge then have no bend inside, and show it.
    """
    axis = np.linspace(0.0, 1.0, TABLE_NODES) ** (8.0 / 3.0)
    blue, green, red = np.meshgrid(axis, axis, axis, indexing="ij")
    light = np.stack([red, green, blue], axis=-1).reshape(-1, 3)
    digital = table.run_on(light)
    nodes = np.concatenate([digital, np.ones((len(light), 1))], axis=1)
    return nodes.reshape(TABLE_NODES, TABLE_NODES, TABLE_NODES, 4)
