"""Tumblin and Rushmeier 1993: the display is as bright, in Stevens's sense, as the scene."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.parameters import parameter
from relgloss_view.operators.operator import SceneLight
from relgloss_view.operators.point import Curve, PointOperator

#: cd/m2 of one lambert, 1/pi cd/cm2.
LAMBERT_CD_M2 = 1e4 / math.pi
#: Adaptation is taken as no darker: below 2e-4 cd/m2 the law's exponent is negative.
DARKEST_CD_M2 = 1e-3


def brightness_law(adaptation_cd_m2: float) -> tuple[float, float]:
    """alpha and beta of brightness = 10^beta L^alpha, in brils, L in lamberts.

    Stevens and Stevens 1963, as Tumblin and Rushmeier 1993 take it. A bril is the brightness of a
    microlambert to the eye adapted to it, and the law gives 1.01 there.
    """
    log = math.log10(max(adaptation_cd_m2, DARKEST_CD_M2) / LAMBERT_CD_M2)
    return 0.4 * log + 2.92, -0.4 * log * log - 2.584 * log + 2.0208


@dataclass(frozen=True)
class TumblinRushmeier(PointOperator):
    """L_d = L_w^(alpha_w/alpha_d) 10^((beta_w - beta_d)/alpha_d), less the display's black.

    Sources disagree. Luminances and adaptation are in lamberts here, as in RenderPark, because
    Stevens's constants are: in lamberts they make a bril of a microlambert. Tizian's tonemapper
    puts cd/m2 into them. It also adds 0.84 to log10 of both adaptations, and RenderPark 0.84 to
    the natural log of the scene's; here nothing is added unless `adaptation_offset` is set. All
    take L_max / sqrt(contrast), the middle of the display's range, as its adaptation, and the
    log mean as the scene's.
    """

    name: ClassVar[str] = "tumblin-rushmeier"
    title: ClassVar[str] = "Tumblin and Rushmeier"
    meaning: ClassVar[str] = "matches brightness, by Stevens's law at each adaptation"
    source: ClassVar[str] = "Tumblin and Rushmeier 1993, IEEE Computer Graphics and Applications 13"

    contrast: float = parameter(100.0, 2.0, 1e6, "", "contrast of the display, white over black")
    adaptation_offset: float = parameter(
        0.0, 0.0, 2.0, "", "added to log10 of the scene's adaptation luminance"
    )

    def curve(self, luminance: Array, light: SceneLight) -> Curve:
        """See PointOperator."""
        scene = light.adaptation_cd_m2 * 10.0**self.adaptation_offset
        alpha_w, beta_w = brightness_law(scene)
        white = self.white_cd_m2(light)
        alpha_d, beta_d = brightness_law(white / math.sqrt(self.contrast))

        def shown(luminance: Array) -> Array:
            log_shown = alpha_w * np.log10(luminance / LAMBERT_CD_M2) + beta_w - beta_d
            shown_cd_m2 = LAMBERT_CD_M2 * 10.0 ** np.minimum(log_shown / alpha_d, 100.0)
            return np.asarray(shown_cd_m2 / white - 1.0 / self.contrast)

        return shown
