"""Setup: the shape, lamp, eye and display of a scene, as frozen values with their ranges.

World axes: right-handed, y up, the object at the origin, the cylinder's axis is y. An azimuth is
measured about y from +z towards +x, an elevation from the horizontal plane towards +y; the default
eye, at azimuth 0, looks along -z.
"""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.parameters import Checked, choice, parameter
from relgloss_view.base.reading import refuse
from relgloss_view.display.display import Display
from relgloss_view.display.model import DisplayModel
from relgloss_view.pack.shape import Shape


def polar_point(azimuth_deg: float, elevation_deg: float, distance_m: float) -> Array:
    """World position at an azimuth, elevation and distance from the object's centre, (3,), metres.

    >>> polar_point(90.0, 0.0, 2.0).round(6).tolist()
    [2.0, 0.0, 0.0]
    """
    azimuth, elevation = math.radians(azimuth_deg), math.radians(elevation_deg)
    across = distance_m * math.cos(elevation)
    return np.array(
        [across * math.sin(azimuth), distance_m * math.sin(elevation), across * math.cos(azimuth)]
    )


MOST_RADIUS_M = 10.0  #: of a lamp
MOST_FURTHER_LAMPS = 3
Y_N_PLACES = ("maximum", "front")  #: its brightest pixel, or the point that faces the eye


@dataclass(frozen=True)
class Lamp(Checked):
    """The main lamp, so bright that the perfect diffuser in the object's place shows Y_n.

    azimuth_deg: degrees, -180 to 180, from +z towards +x.
    elevation_deg: degrees, -90 to 90, above the horizontal plane.
    distance_m: from the object's centre, metres, 0.001 to 1000.
    luminance_cd_m2: Y_n, cd/m2, 0.001 to 1,000,000.
    y_n: 'maximum', the perfect diffuser shows Y_n in its brightest pixel, or 'front', at the point
    that faces the eye.
    illuminant: HP5, D65, D50, A, C, another name of colour-science, or a file of wavelength (nm)
    and power; that of every light of the scene.
    radius_m: of a disc that faces the object, metres, 0 (a point) to 10.
    ambient: share of Y_n that a uniform surround gives, 0 to 1; the lamps give the rest.

    Raises InputError where a value is out of its range.

    >>> Lamp(azimuth_deg=90.0, distance_m=2.0).position_m.round(6).tolist()
    [2.0, 0.0, 0.0]
    """

    azimuth_deg: float = parameter(
        50.0,
        -180.0,
        180.0,
        "deg",
        "0 is the direction of the default eye, 90 its right",
        label="Lamp direction (azimuth)",
    )
    elevation_deg: float = parameter(
        0.0, -90.0, 90.0, "deg", "above the horizontal plane", label="Lamp height (elevation)"
    )
    distance_m: float = parameter(
        1.0, 1e-3, 1e3, "m", "distance from the object's centre", label="Lamp distance"
    )
    luminance_cd_m2: float = parameter(
        110.0,
        1e-3,
        1e6,
        "cd/m2",
        "Y_n: luminance of the perfect diffuser",
        label="White luminance (Y_n)",
    )
    y_n: str = choice(
        "maximum",
        Y_N_PLACES,
        "maximum: the perfect diffuser shows Y_n in its brightest pixel; "
        "front: at the point that faces the eye",
        label="White measured at (Y_n)",
    )
    #: A name that spectra.illuminant knows, or a two-column file.
    illuminant: str = field(default="HP5", metadata={"label": "Lamp spectrum"})
    radius_m: float = parameter(
        0.0,
        0.0,
        MOST_RADIUS_M,
        "m",
        "radius of the lamp's disc, which faces the object; 0 is a point",
        label="Lamp radius",
        later=True,
    )
    ambient: float = parameter(
        0.0,
        0.0,
        1.0,
        "",
        "share of Y_n that comes from a uniform surround",
        label="Ambient light (share of Y_n)",
        later=True,
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        if not isinstance(self.illuminant, str):
            refuse("lamp.illuminant", "a name", self.illuminant)

    @property
    def position_m(self) -> Array:
        """World position, (3,)."""
        return polar_point(self.azimuth_deg, self.elevation_deg, self.distance_m)


@dataclass(frozen=True)
class FurtherLamp(Checked):
    """A lamp beside the main one, with the same spectrum.

    azimuth_deg, elevation_deg, distance_m, radius_m: as those of Lamp.
    share: its intensity in candela over the main lamp's, 0 to 100.

    Raises InputError where a value is out of its range.

    >>> FurtherLamp(azimuth_deg=-90.0, share=0.5).position_m.round(6).tolist()
    [-1.0, 0.0, 0.0]
    """

    TABLE: ClassVar[str] = "further_lamp"

    azimuth_deg: float = parameter(
        -50.0,
        -180.0,
        180.0,
        "deg",
        "0 is the direction of the default eye, 90 its right",
        label="Lamp direction (azimuth)",
    )
    elevation_deg: float = parameter(
        0.0, -90.0, 90.0, "deg", "above the horizontal plane", label="Lamp height (elevation)"
    )
    distance_m: float = parameter(
        1.0, 1e-3, 1e3, "m", "distance from the object's centre", label="Lamp distance"
    )
    radius_m: float = parameter(
        0.0,
        0.0,
        MOST_RADIUS_M,
        "m",
        "radius of the lamp's disc, which faces the object; 0 is a point",
        label="Lamp radius",
    )
    share: float = parameter(
        1.0,
        0.0,
        100.0,
        "",
        "intensity in candela over the main lamp's",
        label="Intensity (main lamp = 1)",
    )

    @property
    def position_m(self) -> Array:
        """World position, (3,)."""
        return polar_point(self.azimuth_deg, self.elevation_deg, self.distance_m)


@dataclass(frozen=True)
class Eye(Checked):
    """The eye, which looks at the object's centre; the picture is in perspective.

    azimuth_deg: degrees, -180 to 180, from +z towards +x.
    elevation_deg: degrees, -90 to 90, above the horizontal plane.
    distance_m: from the object's centre, metres, 0.001 to 1000.
    field_of_view_deg: across the height of the picture, degrees, up to 170; None frames the object.
    shift_right, shift_up: of the picture's centre, as tangents of angles, -100 to 100. A shift
    slides the frame sideways, as a view camera does, without turning the eye.

    Raises InputError where a value is out of its range.

    >>> Eye().position_m.tolist()
    [0.0, 0.0, 0.6]
    """

    azimuth_deg: float = parameter(
        0.0, -180.0, 180.0, "deg", "0 looks along -z", label="Eye direction (azimuth)"
    )
    elevation_deg: float = parameter(
        0.0, -90.0, 90.0, "deg", "above the horizontal plane", label="Eye height (elevation)"
    )
    distance_m: float = parameter(
        0.6, 1e-3, 1e3, "m", "distance from the object's centre", label="Eye distance"
    )
    #: Angle of view across the height of the picture; None frames the object.
    field_of_view_deg: float | None = parameter(
        None,
        1e-3,
        170.0,
        "deg",
        "across the height of the picture; none frames the object",
        label="Angle of view",
    )
    shift_right: float = parameter(
        0.0, -100.0, 100.0, "", "of the picture's centre, as the tangent of an angle"
    )
    shift_up: float = parameter(0.0, -100.0, 100.0, "", "see shift_right")

    @property
    def position_m(self) -> Array:
        """World position, (3,)."""
        return polar_point(self.azimuth_deg, self.elevation_deg, self.distance_m)


@dataclass(frozen=True)
class Setup:
    """The surroundings of a sample in a picture: its shape, the lamps, the eye and the display.

    Each field has the name of its table in a scene file; that of the further lamps, at most three,
    is [[further_lamp]]. Raises InputError where there are more, or where the display's black is as
    bright as its white, which may be that of its profile.

    >>> setup = Setup().with_entries("lamp", azimuth_deg=110.0)
    >>> setup.lamp.azimuth_deg, setup.eye == Eye()
    (110.0, True)
    """

    shape: Shape = Shape()
    lamp: Lamp = Lamp()
    eye: Eye = Eye()
    display: Display = Display()
    further_lamps: tuple[FurtherLamp, ...] = ()

    def __post_init__(self) -> None:
        lamps = self.further_lamps
        if not (isinstance(lamps, tuple) and all(isinstance(k, FurtherLamp) for k in lamps)):
            refuse("further_lamps", "a tuple of FurtherLamp", lamps)
        if len(lamps) > MOST_FURTHER_LAMPS:
            refuse("further_lamp", f"at most {MOST_FURTHER_LAMPS} lamps", len(lamps))
        if self.display.black_cd_m2 is not None:
            DisplayModel.of(dataclasses.replace(self.display, seen_on=""))

    @property
    def is_plain(self) -> bool:
        """Whether one point lamp is all the light."""
        return not (self.further_lamps or self.lamp.radius_m or self.lamp.ambient)

    def with_entries(self, part: str, **entries: Any) -> Setup:
        """The setup with entries of one part changed, such as lamp and azimuth_deg.

        Raises InputError where a value is out of its range.
        """
        present = getattr(self, part)
        if isinstance(present, Shape):
            return dataclasses.replace(self, shape=present.with_entries(**entries))
        changed: dict[str, Any] = {part: dataclasses.replace(present, **entries)}
        return dataclasses.replace(self, **changed)

    def placed(self, **parts: Shape | Lamp | Eye | Display) -> Setup:
        """The setup with whole parts replaced, as in `placed(eye=Eye())`."""
        changes: dict[str, Any] = dict(parts)
        return dataclasses.replace(self, **changes)

    def parts(self) -> dict[str, Any]:
        """Shape, lamp, eye and display by name; the further lamps are a list beside them."""
        return {name: getattr(self, name) for name in ("shape", "lamp", "eye", "display")}
