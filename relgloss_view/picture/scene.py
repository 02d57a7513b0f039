"""Scene (what stands where) and Look (what people judge): frozen values with their ranges.

World axes: right-handed, y up, the object at the origin, the cylinder's axis is y. An azimuth is
measured about y from +z towards +x, an elevation from the horizontal plane towards +y; the default
eye, at azimuth 0, looks along -z. Each parameter declares its range, unit and meaning once, here.
"""

from __future__ import annotations

import dataclasses
import math
import numbers
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from relgloss_view.errors import InputError
from relgloss_view.material.material import DIFFUSE_MODELS, Material
from relgloss_view.text_input import fault, number

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Range:
    """The values a parameter may take, and what it means."""

    low: float
    high: float
    unit: str
    meaning: str


def parameter(default: float | None, low: float, high: float, unit: str, meaning: str) -> Any:
    """A dataclass field with a declared range; one whose default is None may be left out."""
    return _ranged(default, Range(low, high, unit, meaning), optional=default is None)


def whole_number(
    default: int, low: int, high: int, unit: str, meaning: str, *, optional: bool = False
) -> Any:
    """A dataclass field that takes whole numbers of a declared range; None too, if optional."""
    return _ranged(default, Range(low, high, unit, meaning), whole=True, optional=optional)


def _ranged(default: float | None, limits: Range, **flags: bool) -> Any:
    return field(default=default, metadata={"range": limits, **flags})


def choice(default: str, options: tuple[str, ...], meaning: str) -> Any:
    """A dataclass field that takes one of a few names."""
    return field(default=default, metadata={"options": options, "meaning": meaning})


def switch(default: bool, meaning: str) -> Any:
    """A dataclass field that is on or off."""
    return field(default=default, metadata={"switch": True, "meaning": meaning})


class Checked:
    """Checks every declared range when a value is made."""

    def __post_init__(self) -> None:
        for f in dataclasses.fields(self):  # type: ignore[arg-type]
            value = getattr(self, f.name)
            place = f"{type(self).__name__.lower()}.{f.name}"
            allowed = f.metadata.get("range")
            if allowed is not None and not (value is None and f.metadata.get("optional", False)):
                _check_range(place, value, allowed, whole=f.metadata.get("whole", False))
            options = f.metadata.get("options")
            if options is not None and value not in options:
                fault(place, f"one of {', '.join(options)}", value)
            if f.metadata.get("switch") and not isinstance(value, bool):
                fault(place, "true or false", value)


def _check_range(place: str, value: object, allowed: Range, *, whole: bool) -> None:
    unit = f" {allowed.unit}" if allowed.unit else ""
    expected = f"{allowed.low:.10g} to {allowed.high:.10g}{unit}"
    if whole and not isinstance(value, numbers.Integral):
        fault(place, f"a whole number, {expected}", value)
    number(value, place, expected, allowed.low, allowed.high)


SHAPES = ("cylinder", "sphere", "plane", "box")


@dataclass(frozen=True)
class Shape(Checked):
    """The object, centred at the origin. The cylinder and the sphere have a diameter."""

    kind: str = choice("cylinder", SHAPES, "the object's form")
    diameter_m: float = parameter(0.085, 1e-3, 10.0, "m", "of the cylinder and the sphere")
    height_m: float = parameter(0.10, 1e-3, 10.0, "m", "along y: cylinder, plane and box")
    width_m: float = parameter(0.085, 1e-3, 10.0, "m", "along x: plane and box")
    depth_m: float = parameter(0.085, 1e-3, 10.0, "m", "along z: box")

    def half_extent_m(self) -> Array:
        """Half the bounding box, (3,)."""
        radius = 0.5 * self.diameter_m
        if self.kind == "cylinder":
            return np.array([radius, 0.5 * self.height_m, radius])
        if self.kind == "sphere":
            return np.array([radius, radius, radius])
        depth = 0.5 * self.depth_m if self.kind == "box" else 0.0
        return np.array([0.5 * self.width_m, 0.5 * self.height_m, depth])

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
        return bool(np.all(np.abs(point_m) <= self.half_extent_m()))


def polar_point(azimuth_deg: float, elevation_deg: float, distance_m: float) -> Array:
    """World position at an azimuth, elevation and distance from the object's centre, (3,)."""
    azimuth, elevation = math.radians(azimuth_deg), math.radians(elevation_deg)
    across = distance_m * math.cos(elevation)
    return np.array(
        [across * math.sin(azimuth), distance_m * math.sin(elevation), across * math.cos(azimuth)]
    )


Y_N_PLACES = ("maximum", "front")  #: its brightest pixel, or the point that faces the eye


@dataclass(frozen=True)
class Lamp(Checked):
    """A point lamp, as bright as makes a white standard in the object's place show Y_n."""

    azimuth_deg: float = parameter(50.0, -180.0, 180.0, "deg", "0 is the default eye, 90 its right")
    elevation_deg: float = parameter(0.0, -90.0, 90.0, "deg", "above the horizontal plane")
    distance_m: float = parameter(1.0, 1e-3, 1e3, "m", "from the object's centre")
    luminance_cd_m2: float = parameter(110.0, 1e-3, 1e6, "cd/m2", "Y_n: of the perfect diffuser")
    y_n: str = choice("maximum", Y_N_PLACES, "where the perfect diffuser shows Y_n")
    illuminant: str = "HP5"  #: a name that spectra.illuminant knows, or a two-column file

    def __post_init__(self) -> None:
        super().__post_init__()
        if not isinstance(self.illuminant, str):
            fault("lamp.illuminant", "a name", self.illuminant)

    @property
    def position_m(self) -> Array:
        """World position, (3,)."""
        return polar_point(self.azimuth_deg, self.elevation_deg, self.distance_m)


@dataclass(frozen=True)
class Eye(Checked):
    """The eye looks at the object's centre; the picture is in perspective.

    A shift slides the picture's frame sideways, as a view camera's lens does: it moves what is
    shown without turning anything.
    """

    azimuth_deg: float = parameter(0.0, -180.0, 180.0, "deg", "0 looks along -z")
    elevation_deg: float = parameter(0.0, -90.0, 90.0, "deg", "above the horizontal plane")
    distance_m: float = parameter(0.6, 1e-3, 1e3, "m", "from the object's centre")
    #: Angle of view across the height of the picture; None frames the object.
    field_of_view_deg: float | None = parameter(
        None, 1e-3, 170.0, "deg", "across the height of the picture; none frames the object"
    )
    shift_right: float = parameter(
        0.0, -100.0, 100.0, "", "of the picture's centre, as the tangent of an angle"
    )
    shift_up: float = parameter(0.0, -100.0, 100.0, "", "see shift_right")

    @property
    def position_m(self) -> Array:
        """World position, (3,)."""
        return polar_point(self.azimuth_deg, self.elevation_deg, self.distance_m)


GAMUTS = ("chroma", "clip")  #: reduce chroma at held L* and hue, or cut RGB
MIN_GAMUT_AREA = 1e-3  #: twice the triangle's area in the xy diagram; sRGB has 0.22


def _is_table(value: object, rows: int) -> bool:
    return isinstance(value, tuple) and len(value) == rows


def _is_xy(value: object) -> bool:
    """Whether a value is a chromaticity that a light can have."""
    if not (isinstance(value, tuple) and len(value) == 2):
        return False
    if any(isinstance(v, bool) or not isinstance(v, int | float) for v in value):
        return False
    x, y = value
    return bool(x >= 0.0 and y > 0.0 and x + y <= 1.0)


@dataclass(frozen=True)
class Display(Checked):
    """The monitor: its white shows L* = 100. sRGB, or primaries with gain, offset and gamma."""

    transfer: str = choice("srgb", ("srgb", "gain-offset-gamma"), "how RGB becomes light")
    gamut: str = choice("chroma", GAMUTS, "what is done with colours it can't show")
    gain: float = parameter(1.0, 0.1, 10.0, "", "light = (gain d + offset)^gamma + flare")
    offset: float = parameter(0.0, -0.5, 0.5, "", "see gain")
    gamma: float = parameter(2.2, 0.5, 5.0, "", "see gain")
    flare: float = parameter(0.0, 0.0, 0.2, "", "see gain")
    primaries_xy: tuple[tuple[float, float], ...] = ((0.64, 0.33), (0.30, 0.60), (0.15, 0.06))
    white_xy: tuple[float, float] = (0.3127, 0.3290)
    background_lstar: float = parameter(50.0, 0.0, 100.0, "L*", "neutral surround of the object")

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.gain + self.offset <= 0.0 or max(self.offset, 0.0) >= self.gain + self.offset:
            raise InputError(
                f"display.gain {self.gain:g} with display.offset {self.offset:g}: white is no "
                "brighter than black; expected gain + offset above 0 and above offset"
            )
        if not (_is_table(self.primaries_xy, 3) and all(_is_xy(xy) for xy in self.primaries_xy)):
            raise InputError(
                "display.primaries_xy: expected three chromaticities, as [[x, y], ...]"
            )
        if not _is_xy(self.white_xy):
            raise InputError("display.white_xy: expected a chromaticity, as [x, y]")
        (rx, ry), (gx, gy), (bx, by) = self.primaries_xy
        area = (gx - rx) * (by - ry) - (bx - rx) * (gy - ry)
        if abs(area) < MIN_GAMUT_AREA:
            raise InputError("display.primaries_xy: the three primaries lie on a line")


GRAINS = ("screen", "surface")
NOISE_LAWS = ("paper", "tangent")
QUALITIES = ("exact", "auto")
NOISY_LOBES = ("both", "specular")


@dataclass(frozen=True)
class Look(Checked):
    """What is tuned by eye: graininess sigma_N and the scaling c of the specular L*.

    c is given either as a value or as a fraction of the exact c_max; both None means c_max.
    """

    sigma_n_deg: float = parameter(
        0.0, 0.0, 10.0, "deg", "graininess: standard deviation of the tilt of the surface normal"
    )
    c: float | None = parameter(
        None, 0.0, 1e4, "", "contrast gloss: scales the specular part of L*"
    )
    c_fraction: float | None = parameter(
        None, 0.0, 10.0, "", "contrast gloss as a share of c_max, the most that the display shows"
    )
    grain: str = choice("screen", GRAINS, "what a grain is fixed to")
    grain_px: int = whole_number(1, 1, 1024, "px", "side of a screen grain")
    grain_mm: float = parameter(0.2, 0.001, 100.0, "mm", "side of a surface grain")
    noise_law: str = choice("paper", NOISE_LAWS, "distribution of the tilt")
    noisy_lobes: str = choice("both", NOISY_LOBES, "which reflections see the tilt")
    seed: int = whole_number(0, 0, 2**31 - 1, "", "of the grain")
    #: None takes as many as the narrowest lobe needs. One samples the pixel's centre, so that
    #: each number of a picture can be computed again from the point and normal that go with it.
    samples: int | None = whole_number(
        1, 1, 16, "", "samples along each side of a pixel", optional=True
    )
    diffuse_model: str = choice("fitted", ("fitted", *DIFFUSE_MODELS), "draws the diffuse part")
    quality: str = choice("exact", QUALITIES, "draws the whole model, or what this scene needs")

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.c is not None and self.c_fraction is not None:
            raise InputError("look: give c or c_fraction, not both")


@dataclass(frozen=True)
class Scene:
    """What stands where: the sample's material on a shape, lamp, eye and display."""

    material: Material
    shape: Shape = Shape()
    lamp: Lamp = Lamp()
    eye: Eye = Eye()
    display: Display = Display()
