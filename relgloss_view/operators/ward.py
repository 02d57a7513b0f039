"""Ward 1994: one factor for the whole picture, so that just visible contrasts stay just visible."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from relgloss_view.base.arrays import Array
from relgloss_view.operators.operator import SceneLight
from relgloss_view.operators.point import Curve, PointOperator


def contrast_scale(adaptation_cd_m2: float, display_cd_m2: float) -> float:
    """Display luminance over scene luminance: the ratio of the thresholds at each adaptation.

    Ward 1994, with Blackwell's thresholds, proportional to (1.219 + L^0.4)^2.5. The display's
    observer is adapted to half of its white.
    """
    display = 1.219 + (0.5 * display_cd_m2) ** 0.4
    scene = 1.219 + adaptation_cd_m2**0.4
    return float((display / scene) ** 2.5)


@dataclass(frozen=True)
class Ward(PointOperator):
    """Linear: luminances above the display's white are clipped."""

    name: ClassVar[str] = "ward"
    title: ClassVar[str] = "Ward, contrast-based scale"
    meaning: ClassVar[str] = "one linear factor, so that just visible contrasts stay so"
    source: ClassVar[str] = "Ward 1994, Graphics Gems IV, pp. 415-421"

    def curve(self, luminance: Array, light: SceneLight) -> Curve:
        """See PointOperator."""
        white = self.white_cd_m2(light)
        scale = contrast_scale(light.adaptation_cd_m2, white)
        return lambda luminance: luminance * (scale / white)
