"""Tone curves: light of a channel's digital value, and back, in float64."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from relgloss_view.base.arrays import Array

NODES = 4097
STEPS = 6  #: of the regula falsi within a cell of nodes, which is nearly straight


@dataclass(frozen=True, eq=False)
class ToneCurve:
    """A rising curve from digital values to light, both 0 to 1.

    forward: takes and gives float64 arrays; where it falls, the largest value so far counts.

    >>> square = ToneCurve(lambda d: d * d)
    >>> square.light(np.array([0.5])).tolist(), square.digital(np.array([0.25])).round(12).tolist()
    ([0.25], [0.5])
    """

    forward: Callable[[Array], Array]

    @cached_property
    def _nodes(self) -> tuple[Array, Array]:
        digital = np.linspace(0.0, 1.0, NODES)
        light = np.maximum.accumulate(np.clip(self.forward(digital), 0.0, 1.0))
        return digital, light

    def light(self, digital: Array) -> Array:
        """Light of digital values, which are cut to 0 to 1."""
        return np.clip(self.forward(np.clip(digital, 0.0, 1.0)), 0.0, 1.0)

    def digital(self, light: Array) -> Array:
        """The smallest digital values that show this light; 0 or 1 where none does.

        By regula falsi (Illinois, Dowell and Jarratt 1971) between the nodes of a table.
        """
        at, nodes = self._nodes
        cell = np.clip(np.searchsorted(nodes, light, side="left"), 1, NODES - 1)
        low, high = at[cell - 1].copy(), at[cell].copy()
        below, above = nodes[cell - 1] - light, nodes[cell] - light
        flat = above - below <= 0.0
        x = high.copy()
        for _ in range(STEPS):
            span = np.where(above - below > 0.0, above - below, 1.0)
            x = np.where(flat, high, low - below * (high - low) / span)
            off = np.where(flat, 0.0, self.light(x) - light)
            under = off < 0.0
            low, above = np.where(under, x, low), np.where(under, 0.5 * above, off)
            high, below = np.where(under, high, x), np.where(under, off, 0.5 * below)
        x = np.where(light <= nodes[0], 0.0, np.where(light >= nodes[-1], at[_first_top(nodes)], x))
        return np.clip(x, 0.0, 1.0)


def _first_top(nodes: Array) -> int:
    """The first node that shows as much as any."""
    return int(np.argmax(nodes >= nodes[-1]))
