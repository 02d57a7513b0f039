"""Gamuts as triangles in the chromaticity diagram x, y, beside sRGB's."""

from __future__ import annotations

from collections.abc import Sequence

from relgloss_view.material.spectra import SRGB_PRIMARIES_XY

Point = tuple[float, float]


def area_of_srgb(primaries: Sequence[Point]) -> float:
    """Area of a triangle of primaries; sRGB's is 1.

    >>> round(area_of_srgb(SRGB_PRIMARIES_XY), 12)
    1.0
    """
    return abs(_area(primaries)) / abs(_area(SRGB_PRIMARIES_XY))


def share_of_srgb(primaries: Sequence[Point]) -> float:
    """How much of sRGB's triangle another one covers, 0 to 1 (Sutherland and Hodgman 1974).

    >>> round(share_of_srgb([(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)]), 12)
    1.0
    """
    corners = list(primaries) if _area(primaries) > 0.0 else list(primaries)[::-1]
    cut: list[Point] = list(SRGB_PRIMARIES_XY)
    for k, start in enumerate(corners):
        cut = _on_the_left(cut, start, corners[(k + 1) % len(corners)])
        if not cut:
            return 0.0
    return abs(_area(cut)) / abs(_area(SRGB_PRIMARIES_XY))


def _area(corners: Sequence[Point]) -> float:
    return 0.5 * sum(
        x * corners[(k + 1) % len(corners)][1] - corners[(k + 1) % len(corners)][0] * y
        for k, (x, y) in enumerate(corners)
    )


def _on_the_left(corners: list[Point], start: Point, end: Point) -> list[Point]:
    """The part of a polygon on the left of a line."""

    def side(p: Point) -> float:
        across = (end[0] - start[0]) * (p[1] - start[1])
        return across - (end[1] - start[1]) * (p[0] - start[0])

    kept: list[Point] = []
    for k, p in enumerate(corners):
        before = corners[k - 1]
        a, b = side(before), side(p)
        if (a >= 0.0) != (b >= 0.0):
            t = a / (a - b)
            kept.append((before[0] + t * (p[0] - before[0]), before[1] + t * (p[1] - before[1])))
        if b >= 0.0:
            kept.append(p)
    return kept
