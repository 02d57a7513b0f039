"""Operator: a tone mapping from the light of a picture to a displayed picture.

Every operator takes the same float picture in cd/m2 and maps the gamut in the same way, so that two
of them differ in the tone mapping alone. The lamp's white is shown as the display's white, by
ratios of XYZ (von Kries in XYZ), as the split does.
"""

from __future__ import annotations

import dataclasses
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np

from relgloss_view.base.arrays import Array, Bytes, Floats, Mask
from relgloss_view.base.parameters import Checked
from relgloss_view.display.model import DisplayModel
from relgloss_view.picture.displayed import Digitised
from relgloss_view.picture.displayed import Displayed as Displayed
from relgloss_view.picture.frame import Frame
from relgloss_view.picture.model import tone
from relgloss_view.picture.model.view import View

#: Of a picture. What is computed from one pixel takes some 300 bytes.
PIXELS_AT_A_TIME = 1 << 16


@dataclass(frozen=True)
class SceneLight:
    """The light that reaches the eye, and the display that shows it.

    Arrays are (H, W, ...), row 0 the top. XYZ outside the object has no effect.
    """

    summands: tuple[Floats, ...]  #: (H, W, 3) each: XYZ that adds up, as diffuse and specular do
    unit_cd_m2: float  #: luminance of Y = 1 in them
    coverage: Floats  #: (H, W), share of each pixel that the object covers
    white_xyz: Array  #: (3,), of the lamp, Y = 1
    y_n_cd_m2: float  #: luminance of the perfect diffuser in the object's place
    pixels_per_degree: float  #: at the centre of the picture, seen from the scene's eye
    display: DisplayModel
    first_row: int = 0  #: of the picture, the first row that the arrays hold
    #: For whose display digital values are computed at once, and the picture's light is not kept.
    digital_of: Frame | None = None

    @classmethod
    def of(cls, frame: Frame) -> SceneLight:
        """The light of a picture: the frame's own arrays, which are computed with in float64."""
        step = View.of(frame.scene, frame.size).pixel_step
        return cls(
            (frame.diffuse, frame.specular),
            frame.y_n_cd_m2,
            frame.coverage,
            np.asarray(frame.white_xyz, dtype=np.float64),
            frame.y_n_cd_m2,
            1.0 / float(np.degrees(np.arctan(step))),
            DisplayModel.of(frame.scene.display),
        )

    def part(self, rows: slice) -> SceneLight:
        """The light of some rows, which takes no memory of its own until its XYZ is asked for."""
        summands = tuple(summand[rows] for summand in self.summands)
        coverage = self.coverage[rows]
        return dataclasses.replace(self, summands=summands, coverage=coverage, first_row=rows.start)

    @property
    def rows(self) -> slice:
        """The rows of the picture that the arrays hold."""
        return slice(self.first_row, self.first_row + self.shape[0])

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        height, width = self.coverage.shape
        return height, width

    @cached_property
    def on_object(self) -> Mask:
        """(H, W), whether the object covers any of the pixel."""
        return np.asarray(self.coverage > 0.0)

    @property
    def xyz_cd_m2(self) -> Array:
        """(H, W, 3), all light together, Y in cd/m2; computed anew, 24 bytes a pixel."""
        return self._sum(slice(None))

    @property
    def display_white_cd_m2(self) -> float:
        """Luminance of the display's white; the usual 100 cd/m2 where nobody knows it."""
        return self.display.luminance_cd_m2

    @property
    def display_xyz(self) -> Array:
        """(H, W, 3), cd/m2, the lamp's white carried to the display's; Y is as it was."""
        return self.xyz_cd_m2 * (self.display.white / self.white_xyz)

    @property
    def luminance(self) -> Array:
        """(H, W), Y in cd/m2; computed anew."""
        return self._sum(1)

    @cached_property
    def adaptation_cd_m2(self) -> float:
        """Luminance that the eye is adapted to: the log mean over the lit object, by coverage.

        Ward 1994 takes the log mean of the picture. Pixels without light have no logarithm and
        are left out; 0 where nothing is lit.
        """
        luminance = self.luminance
        lit = self.on_object & (luminance > 0.0)
        if not np.any(lit):
            return 0.0
        log = luminance[lit]
        np.log(log, out=log)
        return float(np.exp(np.average(log, weights=self.coverage[lit].astype(np.float64))))

    def _sum(self, channel: slice | int) -> Array:
        total = self.summands[0][..., channel].astype(np.float64)
        for summand in self.summands[1:]:
            total += summand[..., channel]
        total *= self.unit_cd_m2
        return total


@dataclass(frozen=True)
class Operator(Checked, ABC):
    """A tone mapping with its parameters; each declares its range (picture.scene)."""

    name: ClassVar[str]  #: in the registry, on the command line
    title: ClassVar[str]  #: in a list
    meaning: ClassVar[str]  #: one line
    source: ClassVar[str]  #: who published it
    uses_c: ClassVar[bool] = False  #: whether the look's c goes into its picture

    @property
    def label(self) -> str:
        """The name with the parameters that differ from their defaults."""
        changed = [
            f"{f.name} {getattr(self, f.name)}"
            for f in dataclasses.fields(self)
            if getattr(self, f.name) != f.default
        ]
        return f"{self.name} ({', '.join(changed)})" if changed else self.name

    @abstractmethod
    def draw(self, frame: Frame) -> Displayed:
        """The picture that the operator makes of a frame."""

    def draw_digital(self, frame: Frame) -> Displayed:
        """The same picture to look at and to count, without its light, which is most of it."""
        return self.draw(frame).without_light()


@dataclass(frozen=True)
class LightOperator(Operator):
    """An operator that needs no more than the light."""

    def draw(self, frame: Frame) -> Displayed:
        """See Operator."""
        picture = self.apply(SceneLight.of(frame)).for_display(frame)
        return dataclasses.replace(picture, settings=dataclasses.asdict(self))

    def draw_digital(self, frame: Frame) -> Displayed:
        """See Operator."""
        picture = self.apply(dataclasses.replace(SceneLight.of(frame), digital_of=frame))
        return dataclasses.replace(picture, settings=dataclasses.asdict(self)).without_light()

    @abstractmethod
    def apply(self, light: SceneLight) -> Displayed:
        """The picture that the operator makes of the light."""


#: Of the pixels of some rows that show the object, (N, 3) in their order: XYZ or RGB.
ColoursOf = Callable[[SceneLight], Array]
#: Of the same pixels: linear display RGB (N, 3), whether each is clipped, and out of gamut.
ShownOf = Callable[[SceneLight], tuple[Array, Mask, Mask]]


def show_xyz(operator: str, light: SceneLight, xyz_of: ColoursOf) -> Displayed:
    """Show XYZ relative to the display's white (Y = 1), as the split's picture is shown.

    xyz_of: computes some rows at a time, so that a large picture takes little memory. L* above 100
    is cut; a colour outside the gamut keeps L* and hue, or is cut, as the display is set
    (tone.display_rgb).
    """

    def shown(part: SceneLight) -> tuple[Array, Mask, Mask]:
        lab = tone.lab_from_xyz(xyz_of(part), light.display.white)
        rgb, inside = tone.display_rgb(lab, light.display)
        return rgb, lab[:, 0] > 100.0 + tone.CLIP_TOLERANCE, ~inside

    return _compose(operator, light, shown)


def show_rgb(
    operator: str, light: SceneLight, rgb_of: Callable[[SceneLight], tuple[Array, Mask]]
) -> Displayed:
    """Show linear display RGB, cutting each channel.

    rgb_of: the colours (N, 3) of the pixels of some rows that show the object, and which of them
    are out of gamut.
    """

    def shown(part: SceneLight) -> tuple[Array, Mask, Mask]:
        rgb, out_of_gamut = rgb_of(part)
        clipped = np.any(rgb > 1.0 + tone.GAMUT_TOLERANCE, axis=-1)
        return np.clip(rgb, light.display.lowest, 1.0), clipped, out_of_gamut

    return _compose(operator, light, shown)


def rows_at_a_time(shape: tuple[int, int]) -> Iterator[slice]:
    """Rows of pictures (H, W) from the top, about PIXELS_AT_A_TIME pixels."""
    height, width = shape
    step = max(PIXELS_AT_A_TIME // max(width, 1), 1)
    for first in range(0, height, step):
        yield slice(first, min(first + step, height))


def _compose(operator: str, light: SceneLight, shown_of: ShownOf) -> Displayed:
    """Put the object's pixels over the surround, as the reference renderer does."""
    display, frame = light.display, light.digital_of
    clipped, out_of_gamut = (np.zeros(light.shape, dtype=bool) for _ in range(2))
    at_once = None if frame is None else Digitised(frame)
    digital = np.empty((*light.shape, 3), np.uint8) if at_once is None else at_once.values
    whole = np.zeros((0, 0, 3)) if at_once else np.empty((*light.shape, 3))
    for rows in rows_at_a_time(light.shape):
        part = light.part(rows)
        seen = part.on_object
        picture = np.full((*seen.shape, 3), display.background_rgb)
        if np.any(seen):
            rgb, clipped[rows][seen], out_of_gamut[rows][seen] = shown_of(part)
            share = part.coverage[seen].astype(np.float64)[:, None]
            picture[seen] = share * rgb + (1.0 - share) * display.background_rgb
        if at_once is not None:
            at_once.add(picture)
        else:
            whole[rows] = picture
            digital[rows] = quantise(picture, display)
    return Displayed(
        operator=operator,
        light=whole,
        digital=digital,
        clipped=clipped,
        out_of_gamut=out_of_gamut,
        display=display,
    )


def quantise(picture: Array, display: DisplayModel) -> Bytes:
    """Digital values of 8 bits of linear display RGB, rounded to the nearest."""
    return np.floor(255.0 * tone.encode(picture, display) + 0.5).astype(np.uint8)
