"""Pictures of materials as a catalogue's recipe draws them, at any size."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from relgloss_view.base.arrays import Array, Mask
from relgloss_view.catalogue.recipe import Recipe
from relgloss_view.gloss.match import Reference, matched
from relgloss_view.gloss.samples import SampleLook
from relgloss_view.material.cielab import srgb_to_lab
from relgloss_view.material.files import material_from_dict
from relgloss_view.material.material import Material
from relgloss_view.picture.frame import Frame
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.sample import load_sample
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.setup import Setup
from relgloss_view.quality.backends import FrameRenderer, open_renderer

PAPER = Setup()


@dataclass(frozen=True)
class Colours:
    """A picture as colours: lab (H, W, 3) under D65 as the screen shows it, l_s (H, W), L_s*."""

    lab: Array
    l_s: Array
    on_object: Mask


@dataclass(frozen=True)
class Drawer:
    """Draws materials by a recipe."""

    recipe: Recipe
    renderer: FrameRenderer | None

    @classmethod
    def of(cls, recipe: Recipe, renderer: FrameRenderer | None) -> Drawer:
        """A drawer; without a renderer it opens the one without OpenGL for each picture."""
        return cls(recipe, renderer)

    @cached_property
    def reference(self) -> Reference:
        """The reference of the recipe's gloss ratio."""
        named = self.recipe.reference
        material = load_sample(named) if isinstance(named, str) else material_from_dict(named)
        label = named if isinstance(named, str) else material.name
        look = Look(
            sigma_n_deg=self.recipe.reference_sigma_n_deg,
            c=self.recipe.reference_c,
            c_fraction=1.0 if self.recipe.reference_c is None else None,
        )
        return Reference.of(SampleLook(label, material, look), self.recipe.gloss)

    def draw(self, material: Material, size: tuple[int, int], sigma_n_deg: float = 0.0) -> Frame:
        """The picture at the matched c, cut at the picture's c_max."""
        if self.renderer is None:
            with open_renderer("reference") as renderer:
                frame = self._drawn(renderer, material, size, sigma_n_deg)
                _ = frame.display
                return frame
        return self._drawn(self.renderer, material, size, sigma_n_deg)

    def _drawn(
        self, renderer: FrameRenderer, material: Material, size: tuple[int, int], sigma: float
    ) -> Frame:
        scene = Scene(material, PAPER)
        c = matched(self.reference, material, sigma).test_c
        frame = renderer.render(scene, Look(sigma_n_deg=sigma, c=c, samples=None), size)
        if frame.c_max is not None and frame.c > frame.c_max:
            look = Look(sigma_n_deg=sigma, c=frame.c_max, samples=None)
            frame = renderer.render(scene, look, size)
        return frame

    def colours(self, material: Material, size: tuple[int, int]) -> Colours:
        """The picture as colours."""
        frame = self.draw(material, size)
        made = Colours(
            srgb_to_lab(frame.display / 255.0, "D65"), np.asarray(frame.split[1], dtype=np.float64),
            frame.on_object,
        )  # fmt: skip
        frame.forget()
        return made
