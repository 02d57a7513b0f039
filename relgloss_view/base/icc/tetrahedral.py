"""Tetrahedral interpolation of a table of colours, in float64.

A cube of nodes is cut into six tetrahedra that share its diagonal from black to white, so that
grays between two gray nodes are mixed of these two alone.

Source: Sakamoto and Itooka (1981), US patent 4,275,413; Kasson, Nin, Plouffe and Hafner (1995),
Performing color space conversions with three-dimensional linear interpolation, J. Electronic
Imaging 4(3).
"""

from __future__ import annotations

import numpy as np

from relgloss_view.base.arrays import Array, Floats
from relgloss_view.base.icc.profile import Grid


def tetrahedral(grid: Grid, values: Floats) -> Array:
    """Values (N, 3) of a grid of n channels between its nodes; (N, n) are clipped to 0 to 1.

    >>> nodes = np.zeros((2, 2, 2, 3))
    >>> nodes[1, 1, 1] = 1.0
    >>> tetrahedral(Grid(nodes), np.array([[0.5, 0.5, 0.5], [0.2, 0.9, 0.4]]))[:, 0].tolist()
    [0.5, 0.2]
    """
    shape = grid.nodes.shape[:-1]
    flat = grid.nodes.reshape(-1, 3)
    last = np.array(shape) - 1
    strides = np.array([int(np.prod(shape[k + 1 :])) for k in range(len(shape))])
    place = np.clip(values, 0.0, 1.0) * last
    cell = np.minimum(place.astype(np.int64), last - 1)
    part = place - cell
    order = np.argsort(-part, axis=1, kind="stable")
    part = np.take_along_axis(part, order, axis=1)
    corner = cell @ strides
    # Along the edges of the tetrahedron, from the lowest corner of the cell to the highest.
    result = flat[corner] * (1.0 - part[:, :1])
    for k in range(len(shape)):
        corner = corner + strides[order[:, k]]
        following = part[:, k + 1 : k + 2] if k + 1 < len(shape) else 0.0
        result += flat[corner] * (part[:, k : k + 1] - following)
    return np.asarray(result)
