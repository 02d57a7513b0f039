"""Colorimetric reproduction: colours are kept, and L* above the display's white is cut."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from relgloss_view.base.arrays import Array, Mask
from relgloss_view.base.parameters import choice
from relgloss_view.operators.operator import (
    Displayed,
    LightOperator,
    SceneLight,
    show_rgb,
    show_xyz,
)
from relgloss_view.picture.model.tone import GAMUT_TOLERANCE

CUTS = ("lightness", "rgb")


@dataclass(frozen=True)
class Clip(LightOperator):
    """The split with c = 1: the perfect diffuser is the display's white (Ishii et al., Fig. 9b)."""

    name: ClassVar[str] = "clip"
    title: ClassVar[str] = "Colorimetric, clipped"
    meaning: ClassVar[str] = "shows L*, a*, b* as they are and cuts what is above white"
    source: ClassVar[str] = "Ishii et al., relative-glossiness matching, Figure 9 (b); CIE 15 L*"

    cut: str = choice("lightness", CUTS, "cut L* at 100 and hold hue, or cut R, G and B each")

    def apply(self, light: SceneLight) -> Displayed:
        """See LightOperator."""

        def relative(part: SceneLight) -> Array:
            return part.display_xyz[part.on_object] / light.y_n_cd_m2

        def rgb_of(part: SceneLight) -> tuple[Array, Mask]:
            rgb = relative(part) @ light.display.rgb_from_xyz.T
            return rgb, np.any(rgb < -GAMUT_TOLERANCE, axis=-1)

        if self.cut == "lightness":
            return show_xyz(self.name, light, relative)
        return show_rgb(self.name, light, rgb_of)
