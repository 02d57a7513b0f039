"""Label: the parts of a form, which of them are printed, and the size of what is printed."""

from __future__ import annotations

import math
from typing import NamedTuple

from relgloss_view.pack.shape import ANALYTIC, Shape

#: Parts of the analytic forms by number of `Hit.face`. Of a box the front alone is printed.
ANALYTIC_PARTS: dict[str, tuple[str, ...]] = {
    "cylinder": ("side", "top", "bottom"),
    "sphere": ("body",),
    "plane": ("front",),
    "box": ("right", "left", "top", "bottom", "front", "back"),
}
_PRINTED = ("side", "body", "front")
#: An artwork whose width is within this share of the girth goes around without a seam.
SAME_GIRTH = 0.002


class Label(NamedTuple):
    """What a form's artwork lies on.

    parts: names. printed: whether artwork lies on each. size_m: width and height of the label.
    around: whether its left edge meets its right one.
    """

    parts: tuple[str, ...]
    printed: tuple[bool, ...]
    size_m: tuple[float, float]
    around: bool


def label_of(shape: Shape) -> Label:
    """The label of a form. Raises InputError where a mesh file can't be read.

    >>> label_of(Shape("plane", width_m=0.1, height_m=0.2)).size_m
    (0.1, 0.2)
    """
    if shape.kind not in ANALYTIC:
        from relgloss_view.pack.forms import mesh_of

        mesh = mesh_of(shape)
        assert mesh is not None
        return Label(mesh.parts, mesh.printed, mesh.label_size_m, mesh.around)
    parts = ANALYTIC_PARTS[shape.kind]
    printed = tuple(part in _PRINTED for part in parts)
    if shape.kind == "cylinder":
        size = (math.pi * shape.diameter_m, shape.height_m)
    elif shape.kind == "sphere":  # along its equator and a meridian
        size = (math.pi * shape.diameter_m, 0.5 * math.pi * shape.diameter_m)
    else:
        size = (shape.width_m, shape.height_m)
    return Label(parts, printed, size, shape.kind in ("cylinder", "sphere"))
