"""Can and bottle: their profiles, by the measures of usual ones (millimetres at usual size)."""

from __future__ import annotations

import numpy as np

from relgloss_view.pack.forms.profile import Piece, arc, bezier, line, revolved
from relgloss_view.pack.mesh import Mesh
from relgloss_view.pack.shape import Shape

CONE_DEG = 35.0  #: of a can's shoulder from upright, where there is height enough
NECK_NOTE = "The neck is made narrower, so that it fits the diameter."


def can(shape: Shape) -> Mesh:
    """A drawn beverage can: base with dome and standing ring, body, neck, and lid with its seam.

    Parts: base, body, neck, lid. Body and neck are printed: a can is printed before it is necked,
    so artwork narrows with the neck. Radii of edges scale with the diameter (66 mm), or with the
    height where a can is low.
    """
    radius, height = 0.5 * shape.diameter_m, shape.height_m
    k = min(radius / 33.0, height / 60.0)
    neck = min(0.5 * shape.neck_diameter_m, radius)
    notes = (NECK_NOTE,) if neck < 0.5 * shape.neck_diameter_m else ()
    n = min(k, neck / 26.0)
    top, body_low = height - 4.8 * n, 10.73 * k
    shoulder_height, shoulder = _shoulder(radius, neck, k, 0.5 * (top - body_low), top)
    body_high = top - shoulder_height
    pieces = [
        *_can_base(radius, k, body_low),
        line("body", (radius, body_low), (radius, body_high)),
        *shoulder,
        *_can_top(neck, min(neck + n, radius), n, top, height),
    ]
    return revolved(pieces, ("body", "neck"), notes)


def _can_base(radius: float, k: float, body_low: float) -> list[Piece]:
    """Dome, standing ring of 46 mm and the slope to the body."""
    inner, rise = radius - 11.5 * k, 7.0 * k
    dome = (inner * inner + rise * rise) / (2.0 * rise)
    edge_deg = float(np.degrees(np.arctan2(dome - rise, inner)))
    ring = (radius - 10.0 * k, 1.5 * k)
    centre = (radius - 6.0 * k, body_low)
    bead = arc("base", ring, 1.5 * k, 180.0, 310.0)
    fillet = arc("base", centre, 6.0 * k, -50.0, 0.0)
    return [
        arc("base", (0.0, 10.5 * k - dome), dome, 90.0, edge_deg),
        line("base", (inner, 3.5 * k), (inner, 1.5 * k)),
        bead,
        line("base", _end(bead), _start(fillet)),
        fillet,
    ]


def _shoulder(
    radius: float, neck: float, k: float, most: float, top: float
) -> tuple[float, list[Piece]]:
    """Height and pieces of two arcs with a cone between them, no higher than `most`."""
    step, outer, inner = radius - neck, 5.0 * k, 4.0 * k
    if step <= 1e-6 * radius:
        return 0.0, []
    both = outer + inner
    angles = np.radians(np.linspace(CONE_DEG, 89.9, 1000))
    slopes = (step - both * (1.0 - np.cos(angles))) / np.sin(angles)
    heights = both * np.sin(angles) + slopes * np.cos(angles)
    fits = np.flatnonzero((heights <= most) & (slopes > 0.0))
    if slopes[0] <= 0.0:  # a small step: the arcs alone, of a smaller angle
        angle, slope = float(np.arccos(1.0 - step / both)), 0.0
    elif len(fits):
        angle, slope = float(angles[fits[0]]), float(slopes[fits[0]])
    elif step / float(np.tan(angles[-1])) >= most:  # so is a cone without arcs: a much flatter one
        return most, [line("neck", (radius, top - most), (neck, top))]
    else:  # the arcs alone are too high
        return _shoulder(radius, neck, 0.5 * k, most, top)
    height = both * np.sin(angle) + slope * np.cos(angle)
    turn = float(np.degrees(angle))
    first = arc("neck", (radius - outer, top - height), outer, 0.0, turn)
    last = arc("neck", (neck + inner, top), inner, 180.0 + turn, 180.0)
    if slope <= 1e-9 * radius:
        return float(height), [first, last]
    return float(height), [first, line("neck", _end(first), _start(last)), last]


def _can_top(neck: float, seam: float, n: float, top: float, height: float) -> list[Piece]:
    """The straight neck, the seam, the countersink and the panel of the lid."""
    flat = height - 0.6 * n
    groove, deep = seam - 3.4 * n, height - 5.8 * n
    panel = height - 3.6 * n
    corner = (groove - 1.4 * n, panel - 0.6 * n)
    under = line("neck", (neck, top + 1.5 * n), (seam, top + 2.3 * n)) if seam > neck else None
    begin = (seam, top + (2.3 if under else 1.5) * n)
    return [
        line("neck", (neck, top), (neck, top + 1.5 * n)),
        *([under] if under else []),
        line("lid", begin, (seam, flat)),
        arc("lid", (seam - 0.6 * n, flat), 0.6 * n, 0.0, 180.0),
        line("lid", (seam - 1.2 * n, flat), (groove + 0.8 * n, deep)),
        arc("lid", (groove, deep), 0.8 * n, 0.0, -180.0),
        line("lid", (groove - 0.8 * n, deep), (corner[0] + 0.6 * n, corner[1])),
        arc("lid", corner, 0.6 * n, 0.0, 90.0),
        line("lid", (corner[0], panel), (0.0, panel)),
    ]


def bottle(shape: Shape) -> Mesh:
    """A PET bottle: base, body (the label panel, a little deeper), shoulder, neck and cap.

    Parts: base, body, shoulder, neck, cap; the body is printed. Heights scale with the height
    (210 mm), radii of edges with the smaller of both scales.
    """
    radius, height = 0.5 * shape.diameter_m, shape.height_m
    k, v = min(radius / 32.5, height / 210.0), height / 210.0
    neck = min(0.5 * shape.neck_diameter_m, radius - 3.0 * k)
    notes = (NECK_NOTE,) if neck < 0.5 * shape.neck_diameter_m else ()
    n = min(k, neck / 14.0)
    panel = radius - 0.8 * k
    finish = height - 24.0 * n  # where neck and support ring meet
    low, high = 58.0 * v, 128.0 * v
    wide_high = high + 8.0 * v
    shoulder = finish - 2.0 * n - wide_high
    pieces = [
        *_bottle_base(radius, k),
        line("base", (radius, 9.0 * k), (radius, low - 3.0 * k)),
        _step("base", (radius, low - 3.0 * k), (panel, low)),
        line("body", (panel, low), (panel, high)),
        _step("shoulder", (panel, high), (radius, high + 3.0 * k)),
        line("shoulder", (radius, high + 3.0 * k), (radius, wide_high)),
        bezier(
            "shoulder",
            (radius, wide_high),
            (radius, wide_high + 0.55 * shoulder),
            (neck, wide_high + 0.55 * shoulder),
            (neck, wide_high + shoulder),
        ),
        *_finish(neck, n, finish, height),
    ]
    return revolved(pieces, ("body",), notes)


def _bottle_base(radius: float, k: float) -> list[Piece]:
    inner, rise = radius - 10.0 * k, 5.0 * k
    dome = (inner * inner + rise * rise) / (2.0 * rise)
    edge_deg = float(np.degrees(np.arctan2(dome - rise, inner)))
    lip = arc("base", (inner + 1.0 * k, 1.0 * k), 1.0 * k, 180.0, 270.0)
    return [
        arc("base", (0.0, 1.0 * k + rise - dome), dome, 90.0, edge_deg),
        lip,
        arc("base", (radius - 9.0 * k, 9.0 * k), 9.0 * k, -90.0, 0.0),
    ]


def _finish(neck: float, n: float, y: float, height: float) -> list[Piece]:
    """The end of the neck, its support ring, and the cap."""
    ring, cap, edge = neck + 2.5 * n, neck + 1.2 * n, 1.2 * n
    under, over = y, y + 2.0 * n
    band = over + 4.5 * n
    return [
        line("neck", (neck, y - 2.0 * n), (neck, under)),
        line("neck", (neck, under), (ring - 0.5 * n, under)),
        arc("neck", (ring - 0.5 * n, under + 0.5 * n), 0.5 * n, -90.0, 0.0),
        line("neck", (ring, under + 0.5 * n), (ring, over - 0.5 * n)),
        arc("neck", (ring - 0.5 * n, over - 0.5 * n), 0.5 * n, 0.0, 90.0),
        line("neck", (ring - 0.5 * n, over), (neck, over)),
        line("neck", (neck, over), (neck, over + n)),
        line("cap", (neck, over + n), (cap, over + n)),
        line("cap", (cap, over + n), (cap, band)),
        line("cap", (cap, band), (cap - 0.4 * n, band + 0.4 * n)),
        line("cap", (cap - 0.4 * n, band + 0.4 * n), (cap, band + 0.8 * n)),
        line("cap", (cap, band + 0.8 * n), (cap, height - edge)),
        arc("cap", (cap - edge, height - edge), edge, 0.0, 90.0),
        line("cap", (cap - edge, height), (0.0, height)),
    ]


def _step(part: str, start: tuple[float, float], end: tuple[float, float]) -> Piece:
    """A soft step between two upright walls."""
    middle = 0.5 * (start[1] + end[1])
    return bezier(part, start, (start[0], middle), (end[0], middle), end)


def _start(piece: Piece) -> tuple[float, float]:
    return float(piece.points[0, 0]), float(piece.points[0, 1])


def _end(piece: Piece) -> tuple[float, float]:
    return float(piece.points[-1, 0]), float(piece.points[-1, 1])
