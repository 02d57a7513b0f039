"""Scene: a sample's material in its setup."""

from __future__ import annotations

from dataclasses import dataclass

from relgloss_view.material.material import Material
from relgloss_view.picture.scene.setup import Display, Eye, Lamp, Shape


@dataclass(frozen=True)
class Scene:
    """What stands where: the sample's material on a shape, lamp, eye and display."""

    material: Material
    shape: Shape = Shape()
    lamp: Lamp = Lamp()
    eye: Eye = Eye()
    display: Display = Display()
