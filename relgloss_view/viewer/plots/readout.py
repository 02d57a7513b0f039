"""The numbers of one pixel, and the pixels around it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from relgloss_view.base.arrays import AnyArray, Array, Bytes, Mask
from relgloss_view.picture.frame import Frame
from relgloss_view.picture.model import tone
from relgloss_view.picture.stages import Part

Triple = tuple[float, float, float]


@dataclass(frozen=True)
class Readout:
    """One pixel of a frame. Off the object only `display_rgb` has a meaning."""

    on_object: bool
    display_rgb: tuple[int, int, int]  #: 8 bits
    diffuse_cd_m2: float = 0.0
    specular_cd_m2: float = 0.0
    xyz: Triple = (0.0, 0.0, 0.0)  #: diffuse and specular together, relative to Y_n
    l_d: float = 0.0
    l_s: float = 0.0  #: before scaling
    lab: Triple = (0.0, 0.0, 0.0)  #: L~*, a*, b*, before it is cut and mapped into the gamut
    half_deg: float | None = None  #: half-vector from the smooth normal, at the pixel's centre
    half_tilted_deg: float | None = None  #: from the normal after the grain's tilt
    clipped: bool = False
    out_of_gamut: bool = False


@dataclass(frozen=True)
class Patch:
    """The pixels around one, row 0 the top; those beyond the picture are marked."""

    rgb: Bytes  #: (N, N, 3)
    lstar: Array  #: (N, N), L~* as displayed: at most 100, the surround's off the object
    inside: Mask  #: (N, N)


@dataclass(frozen=True)
class Stages:
    """Every stage of a frame that a readout needs, of some of its rows, fetched at once."""

    first_row: int  #: of the picture, that of the arrays
    height: int  #: of the picture
    y_n_cd_m2: float
    diffuse: AnyArray
    specular: AnyArray
    lab: AnyArray
    display: Bytes
    normal: AnyArray
    tilted_normal: AnyArray
    point_m: AnyArray
    on_object: Mask
    clipped: Mask
    out_of_gamut: Mask
    lamp_m: Array
    eye_m: Array
    background_lstar: float

    @classmethod
    def of(cls, frame: Frame, rows: range | None = None) -> Stages:
        """Fetch them: of all rows, or of some, which a large picture takes 0.1 kB a pixel of."""
        height = frame.size[1]
        rows = range(height) if rows is None else range(max(rows.start, 0), min(rows.stop, height))
        part = Part(frame, rows.start, rows.stop)
        return cls(
            first_row=part.rows.start,
            height=height,
            y_n_cd_m2=frame.y_n_cd_m2,
            diffuse=part.diffuse,
            specular=part.specular,
            lab=part.lab,
            display=part.display,
            normal=part.normal,
            tilted_normal=part.tilted_normal,
            point_m=part.point_m,
            on_object=part.on_object,
            clipped=part.clipped,
            out_of_gamut=part.out_of_gamut,
            lamp_m=frame.scene.lamp.position_m,
            eye_m=frame.scene.eye.position_m,
            background_lstar=frame.scene.display.background_lstar,
        )

    def read(self, column: int, row: int) -> Readout | None:
        """The pixel at a column from the left and a row from the top; None where it is not here."""
        count, width = self.on_object.shape
        if not (0 <= column < width and 0 <= row - self.first_row < count):
            return None
        at = row - self.first_row, column
        r, g, b = (int(v) for v in self.display[at])
        if not self.on_object[at]:
            return Readout(False, (r, g, b))
        diffuse, specular = (s[at].astype(np.float64) for s in (self.diffuse, self.specular))
        l_d, l_s = tone.split_lightness(diffuse[1], specular[1])
        return Readout(
            on_object=True,
            display_rgb=(r, g, b),
            diffuse_cd_m2=float(diffuse[1]) * self.y_n_cd_m2,
            specular_cd_m2=float(specular[1]) * self.y_n_cd_m2,
            xyz=_triple(diffuse + specular),
            l_d=float(l_d),
            l_s=float(l_s),
            lab=_triple(self.lab[at]),
            half_deg=self._half_deg(self.normal, at),
            half_tilted_deg=self._half_deg(self.tilted_normal, at),
            clipped=bool(self.clipped[at]),
            out_of_gamut=bool(self.out_of_gamut[at]),
        )

    def _half_deg(self, normal: AnyArray, at: tuple[int, int]) -> float | None:
        return half_vector_deg(normal[at], self.point_m[at], self.lamp_m, self.eye_m)

    def patch(self, column: int, row: int, radius: int = 4) -> Patch:
        """The pixels within `radius` of one, to each side."""
        count, width = self.on_object.shape
        rows = np.arange(row - radius, row + radius + 1)
        columns = np.arange(column - radius, column + radius + 1)
        inside = ((rows >= 0) & (rows < self.height))[:, None] & (columns >= 0) & (columns < width)
        held = np.clip(rows - self.first_row, 0, count - 1)
        place = np.ix_(held, np.clip(columns, 0, width - 1))
        displayed = np.minimum(self.lab[..., 0][place].astype(np.float64), 100.0)
        lstar = np.where(self.on_object[place], displayed, self.background_lstar)
        return Patch(self.display[place], lstar, inside)


def half_vector_deg(
    normal: AnyArray, point_m: AnyArray, lamp_m: Array, eye_m: Array
) -> float | None:
    """Angle between a normal and the half-vector of lamp and eye as the point sees them, degrees.

    None where there is no normal, or where lamp and eye are opposite.
    """
    n = np.asarray(normal, dtype=np.float64)
    to_lamp, to_eye = (place - np.asarray(point_m, dtype=np.float64) for place in (lamp_m, eye_m))
    lengths = np.linalg.norm(to_lamp), np.linalg.norm(to_eye)
    if not np.any(n) or not all(lengths):
        return None
    h = to_lamp / lengths[0] + to_eye / lengths[1]
    if np.linalg.norm(h) < 1e-7:
        return None
    return float(np.degrees(np.arctan2(np.linalg.norm(np.cross(n, h)), np.dot(n, h))))


def _triple(values: AnyArray) -> Triple:
    x, y, z = (float(v) for v in values)
    return x, y, z
