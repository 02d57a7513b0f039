"""Shape: the form and the size of an object.

Axes: right-handed, y up, the object's bounding box centred at the origin. The four analytic forms
are met by rays; the others are triangles, which pack.forms.mesh_of makes.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.errors import InputError
from relgloss_view.base.parameters import Checked, choice, parameter
from relgloss_view.base.reading import numbers_of, refuse, text
from relgloss_view.pack.mesh import Mesh

#: The sizes of each shape, by its name.
SIZES = {
    "cylinder": ("diameter_m", "height_m"),
    "sphere": ("diameter_m",),
    "plane": ("width_m", "height_m"),
    "box": ("width_m", "height_m", "depth_m"),
    "can": ("diameter_m", "height_m", "neck_diameter_m"),
    "bottle": ("diameter_m", "height_m", "neck_diameter_m"),
    "carton": ("width_m", "height_m", "depth_m", "edge_radius_m"),
    "pouch": ("width_m", "height_m", "depth_m"),
    "mesh": (),
}
SHAPES = tuple(SIZES)
CURVED = ("cylinder", "sphere")  #: towards the eye, by half_extent_m()[0]
ANALYTIC = ("cylinder", "sphere", "plane", "box")
PROFILED = ("can", "bottle")  #: may have a profile
#: Points of a profile, and its size: radii and heights in millimetres.
FEWEST_POINTS, MOST_POINTS, MOST_MM = 2, 200, 10_000.0
#: Sizes that a form has where none is given; other sizes and forms have those of the fields.
#: Can: 330 ml. Bottle: 500 ml PET. Pouch: depth at its thickest.
USUAL_SIZES: dict[str, dict[str, float]] = {
    "can": {"diameter_m": 0.066, "height_m": 0.115, "neck_diameter_m": 0.052},
    "bottle": {"diameter_m": 0.065, "height_m": 0.210, "neck_diameter_m": 0.028},
    "carton": {"width_m": 0.070, "height_m": 0.160, "depth_m": 0.040, "edge_radius_m": 0.0005},
    "pouch": {"width_m": 0.140, "height_m": 0.190, "depth_m": 0.045},
}
OLD_SIZES = ("diameter_m", "height_m", "width_m", "depth_m")  #: of every written scene so far
UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "inch": 0.0254}
FALLBACK_SIZES = {
    "diameter_m": 0.085,
    "height_m": 0.10,
    "width_m": 0.085,
    "depth_m": 0.085,
    "neck_diameter_m": 0.052,
    "edge_radius_m": 0.0005,
}


@dataclass(frozen=True)
class Shape(Checked):
    """The object, at the origin; without a size, a form has its USUAL_SIZES.

    kind: one of SHAPES. A cylinder stands about y; a plane faces +z; a can and a bottle stand about
    y, a carton's and a pouch's front face +z; a mesh comes from `file`.
    diameter_m, height_m, width_m, depth_m: SIZES lists which a form has; metres, 0.001 to 10.
    neck_diameter_m: of can and bottle. edge_radius_m: of a carton's edges, 0 to 0.05.
    profile_mm: of a bottle (or can), points (radius, height) in millimetres from the base upwards,
    in place of diameter, height and neck. file: of a mesh; unit: of its coordinates, one of UNITS,
    or 'auto', which the file's format decides.
    Raises InputError where a value is out of its range.

    >>> Shape("box", width_m=0.06, depth_m=0.02).half_extent_m().tolist()
    [0.03, 0.05, 0.01]
    >>> Shape("sphere").contains(np.array([0.0, 0.04, 0.0]))
    True
    >>> Shape("can").diameter_m, Shape("cylinder").diameter_m
    (0.066, 0.085)
    """

    kind: str = choice("cylinder", SHAPES, "the object's form", label="Form")
    diameter_m: float = parameter(
        None, 1e-3, 10.0, "m", "diameter of cylinder, sphere, can and bottle", label="Diameter"
    )
    height_m: float = parameter(
        None, 1e-3, 10.0, "m", "height along y of every form but the sphere", label="Height"
    )
    width_m: float = parameter(
        None, 1e-3, 10.0, "m", "width along x of plane, box, carton and pouch", label="Width"
    )
    depth_m: float = parameter(
        None, 1e-3, 10.0, "m", "depth along z of box, carton and pouch", label="Depth"
    )
    neck_diameter_m: float = parameter(
        None, 1e-3, 10.0, "m", "diameter of the neck of can and bottle", label="Neck"
    )
    edge_radius_m: float = parameter(
        None, 0.0, 0.05, "m", "radius of a carton's edges", label="Edge radius"
    )
    profile_mm: tuple[tuple[float, float], ...] = field(default=(), metadata={"later": True})
    file: str = field(default="", metadata={"later": True})
    unit: str = choice("auto", ("auto", *UNITS), "unit of a mesh file", label="Unit", later=True)

    def __post_init__(self) -> None:
        usual = {**FALLBACK_SIZES, **USUAL_SIZES.get(self.kind, {})}
        for name, size in usual.items():
            if getattr(self, name) is None:
                object.__setattr__(self, name, size)
        super().__post_init__()
        object.__setattr__(self, "profile_mm", _profile(self.profile_mm))
        text(self.file, "shape.file")
        if self.kind == "mesh" and not self.file:
            raise InputError("shape.file: expected the name of a mesh file, for kind 'mesh'")

    def at_usual(self) -> frozenset[str]:
        """Names of the entries that have the usual value of the form.

        >>> sorted(Shape("can", height_m=0.2).at_usual() & set(SIZES["can"]))
        ['diameter_m', 'neck_diameter_m']
        """
        usual: dict[str, Any] = {**FALLBACK_SIZES, **USUAL_SIZES.get(self.kind, {})}
        usual |= {"profile_mm": (), "file": "", "unit": "auto"}
        return frozenset(n for n, value in usual.items() if getattr(self, n) == value)

    def unwritten(self) -> frozenset[str]:
        """Entries that a file leaves out: usual ones, but for those that it always had."""
        always = OLD_SIZES if self.kind in ANALYTIC else ()
        return self.at_usual() - set(always)

    def with_entries(self, **entries: Any) -> Shape:
        """The shape with other entries; sizes that are the present form's usual ones go with it."""
        own = {f.name: getattr(self, f.name) for f in dataclasses.fields(self)}
        own = {name: value for name, value in own.items() if name not in self.at_usual()}
        return Shape(**{**own, **entries})

    def with_kind(self, kind: str) -> Shape:
        """The shape as another form; sizes that are the present form's usual ones change with it.

        >>> Shape().with_kind("can").height_m, Shape(height_m=0.2).with_kind("can").height_m
        (0.115, 0.2)
        """
        return self.with_entries(kind=kind)

    def half_extent_m(self) -> Array:
        """Half the bounding box, (3,)."""
        radius = 0.5 * self.diameter_m
        if self.kind == "cylinder":
            return np.array([radius, 0.5 * self.height_m, radius])
        if self.kind == "sphere":
            return np.array([radius, radius, radius])
        if self.kind == "plane":
            return np.array([0.5 * self.width_m, 0.5 * self.height_m, 0.0])
        if self.kind == "box":
            return np.array([0.5 * self.width_m, 0.5 * self.height_m, 0.5 * self.depth_m])
        return np.array(self._mesh().half_extent_m)

    def contains(self, point_m: Array) -> bool:
        """Whether a point is inside the object (a plane has no inside)."""
        x, y, z = point_m
        radius = 0.5 * self.diameter_m
        if self.kind == "plane":
            return False
        if self.kind == "sphere":
            return bool(x * x + y * y + z * z <= radius * radius)
        if self.kind == "cylinder":
            return bool(x * x + z * z <= radius * radius and abs(y) <= 0.5 * self.height_m)
        if not np.all(np.abs(point_m) <= self.half_extent_m()):
            return False
        return self.kind == "box" or self._mesh().contains(point_m)

    def _mesh(self) -> Mesh:
        from relgloss_view.pack.forms import mesh_of  # it makes meshes of shapes

        mesh = mesh_of(self)
        assert mesh is not None
        return mesh


def _profile(points: object) -> tuple[tuple[float, float], ...]:
    """The points of a profile, checked; InputError."""
    place = "shape.profile_mm"
    if not isinstance(points, tuple | list):
        refuse(place, "a list of points [radius, height] in mm", points)
    if points and not FEWEST_POINTS <= len(points) <= MOST_POINTS:
        refuse(place, f"{FEWEST_POINTS} to {MOST_POINTS} points", len(points))
    profile: list[tuple[float, float]] = []
    for k, point in enumerate(points):
        expected = f"a number, -{MOST_MM:g} to {MOST_MM:g} mm"
        pair = numbers_of(point, f"{place}[{k}]", expected, -MOST_MM, MOST_MM)
        if len(pair) != 2 or pair[0] < 0.0:
            refuse(f"{place}[{k}]", "[radius, height] with a radius of 0 or more", point)
        if profile and pair == profile[-1]:
            refuse(f"{place}[{k}]", "another place than the point before", point)
        profile.append((pair[0], pair[1]))
    if profile:
        radii, heights = zip(*profile, strict=True)
        if max(radii) < 0.5 or max(heights) - min(heights) < 1.0 or heights[-1] < heights[0]:
            refuse(place, "points upwards, at least 1 mm wide and high", "less")
        if 0.0 in radii[1:-1]:
            refuse(place, "a radius above 0 between the ends", 0.0)
    return tuple(profile)
