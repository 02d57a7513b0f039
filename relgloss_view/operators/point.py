"""Point operators: they map each luminance to a luminance and keep chromaticity."""

from __future__ import annotations

import dataclasses
from abc import abstractmethod
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.parameters import parameter
from relgloss_view.operators.operator import (
    Displayed,
    LightOperator,
    SceneLight,
    show_xyz,
)

#: Displayed luminances, relative to the display's white, of (N,) cd/m2 above 0; each by itself.
Curve = Callable[[Array], Array]


@dataclass(frozen=True)
class PointOperator(LightOperator):
    """Scales each pixel's XYZ by displayed over seen luminance, so chromaticity is kept.

    Where the result is outside the display's gamut it is mapped as every operator's is.
    """

    display_cd_m2: float | None = parameter(
        None, 1.0, 1e5, "cd/m2", "luminance of the display's white; none takes the display's own"
    )

    def white_cd_m2(self, light: SceneLight) -> float:
        """Luminance of the display's white: as it is set, or as the display's is known."""
        return self.display_cd_m2 or light.display_white_cd_m2

    @abstractmethod
    def curve(self, luminance: Array, light: SceneLight) -> Curve:
        """The operator's curve for a light whose lit pixels have these luminances, (N,) cd/m2."""

    def displayed(self, luminance: Array, light: SceneLight) -> Array:
        """Displayed luminances, relative to the display's white, of (N,) cd/m2 above 0."""
        return self.curve(luminance, light)(luminance)

    def apply(self, light: SceneLight) -> Displayed:
        """See LightOperator."""
        luminance = light.luminance
        luminance = luminance[light.on_object & (luminance > 0.0)]
        if len(luminance) == 0:
            black = show_xyz(
                self.name, light, lambda part: np.zeros((int(np.sum(part.on_object)), 3))
            )
            return dataclasses.replace(black, warnings=("nothing is lit: the picture is black",))
        curve = self.curve(luminance, light)
        del luminance

        def xyz_of(part: SceneLight) -> Array:
            xyz = part.display_xyz[part.on_object]
            luminance = part.luminance[part.on_object]
            lit = luminance > 0.0
            relative = np.maximum(curve(luminance[lit]), 0.0)
            xyz[lit] *= (relative / luminance[lit])[:, None]
            xyz[~lit] = 0.0
            return xyz

        return show_xyz(self.name, light, xyz_of)
