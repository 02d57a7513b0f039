"""The paper's own tone mapping, in the list with the others."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from relgloss_view.display.model import DisplayModel
from relgloss_view.operators.operator import Displayed, Operator
from relgloss_view.picture.frame import Frame


@dataclass(frozen=True)
class Split(Operator):
    """Takes the frame's own picture; its parameters are the look's: sigma_N and c."""

    name: ClassVar[str] = "split"
    title: ClassVar[str] = "Diffuse and specular L* apart"
    meaning: ClassVar[str] = "scales the specular part of L* by c; keeps colour and shading"
    source: ClassVar[str] = "Ishii et al., relative-glossiness matching, eqs. 1-4"
    uses_c: ClassVar[bool] = True

    def draw(self, frame: Frame) -> Displayed:
        """See Operator."""
        return Displayed(
            self.name,
            frame.light.astype(np.float64),
            frame.display,
            frame.clipped,
            frame.out_of_gamut,
            DisplayModel.of(frame.scene.display),
            frame.warnings,
        )
