"""Which ways of drawing nothing else beats in both time and error."""

from __future__ import annotations

from collections.abc import Sequence


def pareto_front(points: Sequence[tuple[float, float]]) -> list[int]:
    """Indices of the points that no other is at least as small as in both and smaller in one.

    In order of the first coordinate. Of equal points each counts.
    """
    front = [
        k
        for k, (x, y) in enumerate(points)
        if not any(u <= x and v <= y and (u < x or v < y) for u, v in points)
    ]
    return sorted(front, key=lambda k: points[k])
