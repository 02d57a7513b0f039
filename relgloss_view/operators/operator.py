"""Operator: a tone mapping from the light of a picture to a displayed picture.

Every operator takes the same float picture in cd/m2 and maps the gamut in the same way, so that two
of them differ in the tone mapping alone. The lamp's white is shown as the display's white, by
ratios of XYZ (von Kries in XYZ), as the split does.
"""

from __future__ import annotations

import dataclasses
from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np

from relgloss_view.base.arrays import Array, Bytes, Mask
from relgloss_view.base.parameters import Checked
from relgloss_view.picture.displayed import Displayed as Displayed
from relgloss_view.picture.frame import Frame
from relgloss_view.picture.model import tone
from relgloss_view.picture.model.tone import DisplayModel
from relgloss_view.picture.model.view import View

#: cd/m2 of the display's white, where an operator needs to know (science: sRGB at 100 cd/m2).
DISPLAY_CD_M2 = 100.0


@dataclass(frozen=True)
class SceneLight:
    """The light that reaches the eye, and the display that shows it.

    Arrays are (H, W, ...), row 0 the top. XYZ outside the object has no effect.
    """

    xyz_cd_m2: Array  #: (H, W, 3), diffuse and specular together; Y in cd/m2
    coverage: Array  #: (H, W), share of each pixel that the object covers
    white_xyz: Array  #: (3,), of the lamp, Y = 1
    y_n_cd_m2: float  #: luminance of the perfect diffuser in the object's place
    pixels_per_degree: float  #: at the centre of the picture, seen from the scene's eye
    display: DisplayModel

    @classmethod
    def of(cls, frame: Frame) -> SceneLight:
        """The light of a picture, in float64."""
        light = frame.diffuse.astype(np.float64)
        light += frame.specular  # in place: a large picture's temporaries are its largest cost
        light *= frame.y_n_cd_m2
        step = View.of(frame.scene, frame.size).pixel_step
        return cls(
            light,
            frame.coverage.astype(np.float64),
            np.asarray(frame.white_xyz, dtype=np.float64),
            frame.y_n_cd_m2,
            1.0 / float(np.degrees(np.arctan(step))),
            DisplayModel.of(frame.scene.display),
        )

    @cached_property
    def on_object(self) -> Mask:
        """(H, W), whether the object covers any of the pixel."""
        return self.coverage > 0.0

    @cached_property
    def display_xyz(self) -> Array:
        """(H, W, 3), cd/m2, the lamp's white carried to the display's; Y is as it was."""
        return self.xyz_cd_m2 * (self.display.white / self.white_xyz)

    @property
    def luminance(self) -> Array:
        """(H, W), Y in cd/m2."""
        return self.xyz_cd_m2[..., 1]

    @cached_property
    def adaptation_cd_m2(self) -> float:
        """Luminance that the eye is adapted to: the log mean over the lit object, by coverage.

        Ward 1994 takes the log mean of the picture. Pixels without light have no logarithm and
        are left out; 0 where nothing is lit.
        """
        lit = self.on_object & (self.luminance > 0.0)
        if not np.any(lit):
            return 0.0
        return float(np.exp(np.average(np.log(self.luminance[lit]), weights=self.coverage[lit])))


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


@dataclass(frozen=True)
class LightOperator(Operator):
    """An operator that needs no more than the light."""

    def draw(self, frame: Frame) -> Displayed:
        """See Operator."""
        picture = self.apply(SceneLight.of(frame)).for_display(frame)
        return dataclasses.replace(picture, settings=dataclasses.asdict(self))

    @abstractmethod
    def apply(self, light: SceneLight) -> Displayed:
        """The picture that the operator makes of the light."""


def show_xyz(
    operator: str, light: SceneLight, xyz: Array, warnings: tuple[str, ...] = ()
) -> Displayed:
    """Show XYZ (H, W, 3) relative to the display's white (Y = 1), as the split's picture is shown.

    L* above 100 is cut; a colour outside the gamut keeps L* and hue, or is cut, as the display
    is set (tone.display_rgb).
    """
    seen = light.on_object
    lab = tone.lab_from_xyz(xyz[seen], light.display.white)
    rgb, inside = tone.display_rgb(lab, light.display)
    return _compose(
        operator, light, rgb, lab[:, 0] > 100.0 + tone.CLIP_TOLERANCE, ~inside, warnings
    )


def show_rgb(
    operator: str, light: SceneLight, rgb: Array, out_of_gamut: Mask, warnings: tuple[str, ...] = ()
) -> Displayed:
    """Show linear display RGB (H, W, 3), cutting each channel; `out_of_gamut` is (H, W)."""
    seen = light.on_object
    on_object = rgb[seen]
    clipped = np.any(on_object > 1.0 + tone.GAMUT_TOLERANCE, axis=-1)
    return _compose(
        operator, light, np.clip(on_object, 0.0, 1.0), clipped, out_of_gamut[seen], warnings
    )


def _compose(
    operator: str,
    light: SceneLight,
    rgb: Array,
    clipped: Mask,
    out_of_gamut: Mask,
    warnings: tuple[str, ...],
) -> Displayed:
    """Put the object's pixels (N, ...) over the surround, as the reference renderer does."""
    seen, display = light.on_object, light.display
    share = light.coverage[seen][:, None]
    picture = np.full((*seen.shape, 3), display.background_light)
    picture[seen] = share * rgb + (1.0 - share) * display.background_light
    return Displayed(
        operator=operator,
        light=picture,
        digital=quantise(picture, display),
        clipped=_spread(clipped, seen),
        out_of_gamut=_spread(out_of_gamut, seen),
        display=display,
        warnings=warnings,
    )


def _spread(flags: Mask, seen: Mask) -> Mask:
    """Flags (N,) of the pixels seen, in the picture (H, W)."""
    mask = np.zeros(seen.shape, dtype=bool)
    mask[seen] = flags
    return mask


def quantise(picture: Array, display: DisplayModel) -> Bytes:
    """Digital values of 8 bits of linear display RGB, rounded to the nearest."""
    return np.floor(255.0 * tone.encode(picture, display) + 0.5).astype(np.uint8)
