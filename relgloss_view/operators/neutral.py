"""Khronos PBR Neutral, the tone mapper of e-commerce's product viewers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from relgloss_view.base.arrays import Array, Mask
from relgloss_view.base.parameters import parameter
from relgloss_view.operators.operator import Displayed, LightOperator, SceneLight, show_rgb
from relgloss_view.picture.model.tone import GAMUT_TOLERANCE

F90 = 0.04  #: Khronos's name for the reflectance of n = 1.5 at normal incidence, taken off


def pbr_neutral(
    rgb: Array, start_compression: float = 0.8 - F90, desaturation: float = 0.15
) -> Array:
    """Linear RGB (..., 3), 0 to 1, of non-negative linear RGB (KhronosGroup/ToneMapping, 2024).

    Below `start_compression` it takes off what a dielectric reflects towards the eye and changes
    nothing else; above, the peak is compressed to 1 and the colour is mixed with white. Hue is
    held in linear RGB.
    """
    smallest = np.min(rgb, axis=-1, keepdims=True)
    # Larger values take the other branch; bounded, so that their squares do not overflow.
    dark = np.minimum(smallest, 2.0 * F90)
    offset = np.where(smallest < 2.0 * F90, dark - dark * dark / (4.0 * F90), F90)
    colour = rgb - offset
    peak = np.max(colour, axis=-1, keepdims=True)
    room = 1.0 - start_compression
    above = np.maximum(peak - start_compression, 0.0)
    new_peak = 1.0 - room * room / (above + room)
    held = new_peak / np.maximum(peak, start_compression)
    to_white = 1.0 - 1.0 / (desaturation * (np.maximum(peak, new_peak) - new_peak) + 1.0)
    compressed = colour * held * (1.0 - to_white) + new_peak * to_white
    return np.where(peak < start_compression, colour, compressed)


@dataclass(frozen=True)
class Neutral(LightOperator):
    """Works in the display's own linear RGB, the perfect diffuser at 1."""

    name: ClassVar[str] = "neutral"
    title: ClassVar[str] = "Khronos PBR Neutral"
    meaning: ClassVar[str] = "keeps base colours less 0.04, compresses highlights towards white"
    source: ClassVar[str] = "Khronos Group 2024, PBR Neutral tone mapper specification"

    exposure: float = parameter(1.0, 1e-3, 1e3, "", "multiplies the light before the mapping")
    start_compression: float = parameter(
        0.8 - F90, 0.01, 0.99, "", "K_s: the peak from which highlights are compressed"
    )
    desaturation: float = parameter(
        0.15, 0.0, 10.0, "", "K_d: how fast compressed highlights turn white"
    )

    def apply(self, light: SceneLight) -> Displayed:
        """See LightOperator. The mapping has no meaning below 0: such channels are cut first."""
        scale = self.exposure / light.y_n_cd_m2

        def rgb_of(part: SceneLight) -> tuple[Array, Mask]:
            relative = part.display_xyz[part.on_object] * scale
            rgb = relative @ light.display.rgb_from_xyz.T
            mapped = pbr_neutral(np.maximum(rgb, 0.0), self.start_compression, self.desaturation)
            return mapped, np.any(rgb < -GAMUT_TOLERANCE, axis=-1)

        return show_rgb(self.name, light, rgb_of)
