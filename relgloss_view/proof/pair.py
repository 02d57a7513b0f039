"""Pair: the two scenes of a proof and their looks, as they are drawn on both sides."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass

from relgloss_view.base.arrays import Bytes, Floats, Mask
from relgloss_view.base.errors import InputError
from relgloss_view.pack.shape import Shape
from relgloss_view.picture.frame import Frame
from relgloss_view.picture.model.view import at_one_scale
from relgloss_view.picture.pair import common_factor
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.scene_file import SceneFile
from relgloss_view.picture.scene.setting import Setting
from relgloss_view.picture.scene.setup import Setup
from relgloss_view.proof.drawing import page_display
from relgloss_view.proof.settings import SIDES, LampPlace, PictureSetting, Settings
from relgloss_view.quality.backends import FrameRenderer


@dataclass(frozen=True)
class Drawn:
    """One picture of a pair. Arrays are (H, W, ...), row 0 the top.

    lab: L~*, a*, b* after the split and scaling, before gamut mapping. l_d, l_s: before scaling.
    rgb: digital values, 8 bits. c: of the picture, with the common factor. c_max: None where no
    pixel shows a highlight.
    """

    lab: Floats
    l_d: Floats
    l_s: Floats
    on_object: Mask
    rgb: Bytes
    c: float
    c_max: float | None
    warnings: tuple[str, ...] = ()

    @classmethod
    def of(cls, frame: Frame) -> Drawn:
        """The picture of a frame, all of it fetched."""
        l_d, l_s = frame.split
        return cls(
            frame.lab, l_d, l_s, frame.on_object, frame.display, frame.c, frame.c_max,
            frame.warnings,
        )  # fmt: skip


@dataclass(frozen=True)
class Pair:
    """Scene and look of each of SIDES, for the page's display, drawn with the whole model.

    All c are absolute. Raises InputError where a look has none.
    """

    scenes: Mapping[str, Scene]
    looks: Mapping[str, Look]

    @classmethod
    def of(cls, content: SceneFile) -> Pair:
        """The pair of a scene file that holds a reference."""
        if content.reference is None or content.reference_look is None:
            raise InputError("[reference]: expected a reference beside the sample")
        display = page_display(content.setup.display)
        setup = dataclasses.replace(content.setup, display=display)
        return cls(
            {
                "reference": content.reference.scene(_reference_setup(content, setup)),
                "test": content.sample.scene(setup),
            },
            {"reference": _exact(content.reference_look), "test": _exact(content.look)},
        )

    @property
    def settings(self) -> Settings:
        """What can be changed of the pair."""
        setup = self.scenes["test"].setup
        sides = {}
        for name, look in self.looks.items():
            if look.c is None:
                raise InputError(f"{name}: expected c itself, found a share of c_max")
            sides[name] = PictureSetting(look.sigma_n_deg, look.c)
        return Settings(**sides, eye=setup.eye, lamp=LampPlace.of(setup.lamp))

    def at(self, settings: Settings) -> Pair:
        """The pair with other settings. A lamp that is a file is named by its path."""
        scenes, looks = {}, {}
        for name in SIDES:
            scene, own = self.scenes[name], settings.side(name)
            scenes[name] = Scene(scene.material, settings.in_setup(scene.setup), pack=scene.pack)
            looks[name] = self.looks[name].at(Setting(own.sigma_n_deg, c=own.c))
        return Pair(scenes, looks)

    def framed(self, size: tuple[int, int]) -> Pair:
        """The pair as it is seen in pictures of a size: both objects at one scale."""
        shapes = [scene.shape for scene in self.scenes.values()]
        eyes = {name: at_one_scale(shapes, one.eye, size) for name, one in self.scenes.items()}
        scenes = {name: one.placed(eye=eyes[name]) for name, one in self.scenes.items()}
        return Pair(scenes, self.looks)

    def factor(self, renderer: FrameRenderer, size: tuple[int, int]) -> float:
        """The common factor of both c in this view."""
        contrasts = []
        scenes = self.framed(size).scenes
        for name in SIDES:
            frame = renderer.render(scenes[name], self.looks[name], size)
            contrasts.append((frame.c, frame.c_max))
        return common_factor(contrasts)

    def drawn(self, renderer: FrameRenderer, size: tuple[int, int]) -> dict[str, Drawn]:
        """Both pictures, at one scale and with the pair's common factor."""
        factor = self.factor(renderer, size)
        scenes = self.framed(size).scenes
        pictures = {}
        for name in SIDES:
            frame = renderer.render(scenes[name], self.looks[name], size, factor=factor)
            pictures[name] = Drawn.of(frame)
        return pictures


def _reference_setup(content: SceneFile, setup: Setup) -> Setup:
    """The setup of the reference, which has a form of its own beside a pack."""
    if content.sample.pack is None:
        return setup
    return setup.placed(shape=content.reference_shape or Shape())


def _exact(look: Look) -> Look:
    return look.with_entries(quality="exact")
