"""Point operators: they map each luminance to a luminance and keep chromaticity."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.parameters import parameter
from relgloss_view.operators.operator import (
    DISPLAY_CD_M2,
    Displayed,
    LightOperator,
    SceneLight,
    show_xyz,
)


@dataclass(frozen=True)
class PointOperator(LightOperator):
    """Scales each pixel's XYZ by displayed over seen luminance, so chromaticity is kept.

    Where the result is outside the display's gamut it is mapped as every operator's is.
    """

    display_cd_m2: float = parameter(
        DISPLAY_CD_M2, 1.0, 1e5, "cd/m2", "luminance of the display's white"
    )

    @abstractmethod
    def displayed(self, luminance: Array, light: SceneLight) -> Array:
        """Displayed luminances, relative to the display's white, of (N,) cd/m2 above 0."""

    def apply(self, light: SceneLight) -> Displayed:
        """See LightOperator."""
        lit = light.on_object & (light.luminance > 0.0)
        xyz = np.zeros(light.xyz_cd_m2.shape)
        if not np.any(lit):
            return show_xyz(self.name, light, xyz, ("nothing is lit: the picture is black",))
        luminance = light.luminance[lit]
        relative = np.maximum(self.displayed(luminance, light), 0.0)
        xyz[lit] = light.display_xyz[lit] * (relative / luminance)[:, None]
        return show_xyz(self.name, light, xyz)
