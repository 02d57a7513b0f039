"""Scene: a sample's material in its setup."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any

from relgloss_view.base.reading import printable
from relgloss_view.display.display import Display
from relgloss_view.material.material import Material
from relgloss_view.pack.pack import Pack
from relgloss_view.pack.shape import Shape
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.setup import Eye, Lamp, Setup


@dataclass(frozen=True, init=False)
class Scene:
    """The content of one picture: a material and the setup that surrounds it.

    material: of the sample. setup: shape, lamp, eye and display; the defaults are the paper's
    cylinder. shape, lamp, eye, display: each replaces that part of the setup. pack: a pack in place
    of one material on one shape; the setup's shape is then the pack's, and `material` is that of
    its base finish.

    >>> from relgloss_view import load_sample
    >>> scene = Scene(load_sample("uncoated"), lamp=Lamp(azimuth_deg=110.0))
    >>> scene.lamp.azimuth_deg, scene.shape.kind
    (110.0, 'cylinder')
    >>> scene.placed(shape=Shape("sphere")).shape.kind
    'sphere'
    """

    material: Material
    setup: Setup
    pack: Pack | None

    def __init__(
        self,
        material: Material,
        setup: Setup | None = None,
        *,
        shape: Shape | None = None,
        lamp: Lamp | None = None,
        eye: Eye | None = None,
        display: Display | None = None,
        pack: Pack | None = None,
    ) -> None:
        shape = shape if pack is None else pack.shape
        parts = {"shape": shape, "lamp": lamp, "eye": eye, "display": display}
        replaced: dict[str, Any] = {k: part for k, part in parts.items() if part is not None}
        object.__setattr__(self, "material", material if pack is None else pack.material)
        object.__setattr__(self, "setup", dataclasses.replace(setup or Setup(), **replaced))
        object.__setattr__(self, "pack", pack)

    def placed(self, **parts: Shape | Lamp | Eye | Display) -> Scene:
        """The scene with whole parts of its setup replaced, as in `placed(lamp=Lamp())`."""
        return Scene(self.material, self.setup.placed(**parts), pack=self.pack)

    @property
    def materials(self) -> tuple[Material, ...]:
        """The materials that are drawn: the sample's, or those of a pack's finishes."""
        if self.pack is None:
            return (self.material,)
        return tuple(finish.material for finish in self.pack.finishes)

    def parts(self, look: Look) -> tuple[tuple[Material, float], ...]:
        """Each material with its sigma_N in a look, degrees; a finish may have its own."""
        own = look.sigma_n_deg
        if self.pack is None:
            return ((self.material, own),)
        return tuple(
            (finish.material, own if finish.sigma_n_deg is None else finish.sigma_n_deg)
            for finish in self.pack.finishes
        )

    @property
    def name(self) -> str:
        """The name of the pack, or of the material."""
        return self.material.name if self.pack is None else self.pack.name

    @property
    def marks(self) -> str:
        """How far the materials are not measured ones, of all finishes together; '' if they are."""
        return ", ".join(dict.fromkeys(m.marks for m in self.materials if m.marks))

    @property
    def warnings(self) -> tuple[str, ...]:
        """The warnings of the materials; those of a pack with the name of the finish in front."""
        if self.pack is None:
            return self.material.warnings
        return tuple(
            f"finish {printable(finish.name, 60)!r}: {text}"
            for finish in self.pack.finishes
            for text in finish.material.warnings
        )

    @property
    def shape(self) -> Shape:
        """The object's form and size."""
        return self.setup.shape

    @property
    def lamp(self) -> Lamp:
        """The lamp that lights it."""
        return self.setup.lamp

    @property
    def eye(self) -> Eye:
        """The eye that sees it."""
        return self.setup.eye

    @property
    def display(self) -> Display:
        """The display that shows it."""
        return self.setup.display
