"""What is timed of the renderer: whole frames, and what remains where one number changes."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

from relgloss_view.bench.speed.floor import FillFloor
from relgloss_view.picture.gpu.renderer import Renderer
from relgloss_view.picture.method import EXACT, Method
from relgloss_view.picture.model.view import Size
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.scene import Scene

#: Relative change of a number that makes the renderer draw again: float32 does not see it.
NUDGE = 1e-10


class Drawing:
    """Frames of a scene that differ too little to be told apart, but are not the same."""

    def __init__(
        self,
        name: str,
        renderer: Renderer,
        size: Size,
        pictures: Sequence[tuple[Scene, Look]],
        method: Method = EXACT,
    ) -> None:
        self.name = name
        self._renderer = renderer
        self._size = size
        self._pictures = pictures
        self._method = method

    def warm(self) -> None:
        """Draw the first."""
        self.frame(-1)

    def frame(self, turn: int) -> None:
        """Draw the next, to its end."""
        scene, look = self._pictures[(turn + 1) % len(self._pictures)]
        self._renderer.render(scene, look, self._size, self._method)
        self._renderer.ctx.finish()


class Floor:
    """The fill floor, as a task."""

    name = "floor"

    def __init__(self, floor: FillFloor) -> None:
        self._floor = floor

    def warm(self) -> None:
        """Draw once."""
        self.frame(-1)

    def frame(self, turn: int) -> None:
        """Draw to its end."""
        self._floor.draw()
        self._floor.ctx.finish()


def pass_1_changed(
    scene: Scene, look: Look, method: Method, count: int
) -> list[tuple[Scene, Look]]:
    """All passes but the white's are drawn again: sigma_N moves, or without grain the albedo."""
    if look.sigma_n_deg > 0.0 and method.noise != "none":
        return sigma_n_changed(scene, look, count)
    return [(_repainted(scene, k), look) for k in range(count)]


def sigma_n_changed(scene: Scene, look: Look, count: int) -> list[tuple[Scene, Look]]:
    """Looks whose sigma_N alone differs; it is above 0."""
    return [
        (scene, dataclasses.replace(look, sigma_n_deg=look.sigma_n_deg * (1.0 + NUDGE * k)))
        for k in range(count)
    ]


def c_changed(scene: Scene, look: Look, count: int) -> list[tuple[Scene, Look]]:
    """Looks whose c alone differs; it is given, and above 0."""
    assert look.c
    return [(scene, dataclasses.replace(look, c=look.c * (1.0 + NUDGE * k))) for k in range(count)]


def lamp_moved(scene: Scene, look: Look, count: int) -> list[tuple[Scene, Look]]:
    """Scenes whose lamp stands elsewhere: everything is drawn again, Y_n too."""
    lamps = [
        dataclasses.replace(scene.lamp, azimuth_deg=scene.lamp.azimuth_deg * (1.0 + NUDGE * k))
        for k in range(count)
    ]
    return [(scene.placed(lamp=lamp), look) for lamp in lamps]


def _repainted(scene: Scene, k: int) -> Scene:
    diffuse = scene.material.diffuse
    albedo = tuple(value * (1.0 + NUDGE * k) for value in diffuse.albedo)
    material = dataclasses.replace(
        scene.material, diffuse=dataclasses.replace(diffuse, albedo=albedo)
    )
    return dataclasses.replace(scene, material=material)
