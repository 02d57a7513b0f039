"""Schlick 1994: a rational function from black to the picture's brightest point."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.parameters import parameter
from relgloss_view.operators.operator import SceneLight
from relgloss_view.operators.point import Curve, PointOperator

#: Share of the lit pixels that are darker than the luminance taken as the darkest. The minimum
#: itself lies at the terminator, where it follows the size of the pixels alone.
DARK_SHARE = 0.01


def rational(luminance: Array, brightest: float, p: float) -> Array:
    """p L / ((p - 1) L + L_max): 0 at 0, 1 at L_max, slope p / L_max at 0 (Schlick 1994)."""
    share = luminance / brightest
    return np.asarray(p * share / ((p - 1.0) * share + 1.0))


@dataclass(frozen=True)
class Schlick(PointOperator):
    """Uniform rational quantisation.

    p is by default Schlick's, (just_visible / 256) L_max / L_min: the darkest luminance becomes
    the first display level that differs visibly from black. Other programs fix p, at 2 or at 200.
    His variants that differ from place to place are not offered.
    """

    name: ClassVar[str] = "schlick"
    title: ClassVar[str] = "Schlick, rational"
    meaning: ClassVar[str] = "brightest to white, darkest to the first visible level"
    source: ClassVar[str] = "Schlick 1994, 5th Eurographics Workshop on Rendering, pp. 7-18"

    p: float | None = parameter(
        None, 1.0, 1e9, "", "slope in the dark; none computes it from the range"
    )
    just_visible: float = parameter(
        1.0, 0.1, 100.0, "", "smallest of 256 display levels that differs visibly from black"
    )

    def curve(self, luminance: Array, light: SceneLight) -> Curve:
        """See PointOperator."""
        brightest = float(np.max(luminance))
        p = self.p
        if p is None:
            darkest = max(float(np.quantile(luminance, DARK_SHARE)), 1e-12 * brightest)
            p = max(self.just_visible / 256.0 * brightest / darkest, 1.0)
        return functools.partial(rational, brightest=brightest, p=p)
