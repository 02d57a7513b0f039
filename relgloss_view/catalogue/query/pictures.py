"""Pictures of materials as a catalogue's recipe draws them, as colours, at any size."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from relgloss_view.base.arrays import Array, Mask
from relgloss_view.catalogue.look import draw
from relgloss_view.catalogue.recipe import Recipe
from relgloss_view.material.cielab import srgb_to_lab
from relgloss_view.material.material import Material
from relgloss_view.picture.frame import Frame
from relgloss_view.quality.backends import FrameRenderer, open_renderer


@dataclass(frozen=True)
class Colours:
    """A picture as colours: lab (H, W, 3) under D65 as the screen shows it, l_s (H, W), L_s*."""

    lab: Array
    l_s: Array
    on_object: Mask


@dataclass(frozen=True)
class Drawer:
    """Draws materials by a recipe; without a renderer by the one that needs no OpenGL."""

    recipe: Recipe
    renderer: FrameRenderer | None

    def draw(self, material: Material, size: tuple[int, int], sigma_n_deg: float = 0.0) -> Frame:
        """The picture at the c that keeps the gloss ratio, at most c_max."""
        if self.renderer is not None:
            return draw(material, self.recipe, self.renderer, size, sigma_n_deg)
        with open_renderer("reference") as renderer:
            frame = draw(material, self.recipe, renderer, size, sigma_n_deg)
            _ = frame.display
            return frame

    def colours(
        self, material: Material, size: tuple[int, int], sigma_n_deg: float = 0.0
    ) -> Colours:
        """The picture as colours."""
        frame = self.draw(material, size, sigma_n_deg)
        lab = srgb_to_lab(frame.display / 255.0, "D65")
        made = Colours(lab, np.asarray(frame.split[1], dtype=np.float64), frame.on_object)
        frame.forget()
        return made
