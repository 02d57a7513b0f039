"""Renderer: which passes a picture needs, and which of them still hold."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

import moderngl
import numpy as np
from numpy.typing import NDArray

from relgloss_view.picture.frame import Extremes, Frame, Scaling, scene_warnings
from relgloss_view.picture.plan import TRANSFER_CODES, Plan
from relgloss_view.picture.renderer.programs import Programs, Uniforms
from relgloss_view.picture.renderer.targets import BLOCK, GEOMETRY, SHADE, TONE, Targets
from relgloss_view.picture.renderer.uniforms import (
    PERFECT_DIFFUSER,
    display_uniforms,
    grain_uniforms,
    material_uniforms,
    view_uniforms,
)
from relgloss_view.picture.scene import Look, Scene
from relgloss_view.picture.view import Size, View, check_size


@dataclass(frozen=True)
class _Request:
    """What a frame was asked to be; passes are drawn again only where their part of it changes."""

    scene: Scene
    look: Look
    size: Size

    def white_key(self) -> object:
        """What Y_n depends on: the geometry, not the lamp's power or spectrum."""
        lamp = dataclasses.replace(self.scene.lamp, luminance_cd_m2=1.0, illuminant="")
        return (self.scene.shape, lamp, self.scene.eye, self.look.samples, self.size)

    def shade_key(self) -> object:
        """What pass 1 depends on: everything but c and the display."""
        look = dataclasses.replace(self.look, c=None, c_fraction=None)
        scene = self.scene
        return (scene.material, scene.shape, scene.lamp, scene.eye, look, self.size)


class Renderer:
    """Draws frames on one OpenGL context; keeps programs, targets and the passes still valid.

    `draws` counts the passes drawn so far by name, for those who check what is drawn again.
    """

    def __init__(self, ctx: moderngl.Context, programs: Programs | None = None) -> None:
        self.ctx = ctx
        self.programs = programs or Programs(ctx)
        self.draws = dict.fromkeys(("white", "shade", "measure", "tone", "geometry"), 0)
        self._targets = Targets(ctx)
        self._done: dict[str, object] = {}
        self._white = 0.0
        self._extremes = Extremes.of_nothing()

    def prepare(self, scene: Scene, look: Look) -> None:
        """Compile every variant that sliders of this scene and look can reach without a pause."""
        for sigma_n_deg in (0.0, max(look.sigma_n_deg, 1.0)):
            plan = Plan.of(scene, dataclasses.replace(look, sigma_n_deg=sigma_n_deg))
            self.programs.get("shade.frag", plan.defines())
            self.programs.get("geometry.frag", _geometry_defines(plan))
        self.programs.get("shade.frag", Plan.of_perfect_diffuser(scene, look).defines())
        for name in ("measure.frag", "reduce.frag"):
            self.programs.get(name, {"BLOCK": BLOCK})
        self.programs.get("tone.frag", _tone_defines(scene))

    def render(self, scene: Scene, look: Look, size: Size) -> Frame:
        """Draw a scene. Raises InputError for a size or a material that can't be drawn."""
        request = _Request(scene, look, check_size(size))
        scaling = self._bring_up_to_date(request)
        return Frame(
            scene,
            look,
            size,
            scaling,
            partial(self._fetch, request),
            str(self.ctx.info["GL_RENDERER"]),
            scene_warnings(scene, lit=self._white > 0.0),
        )

    def release(self) -> None:
        """Free the targets; frames whose stages were not fetched are drawn again when asked."""
        self._targets.release()
        self._done.clear()

    def _bring_up_to_date(self, request: _Request) -> Scaling:
        if self._targets.resize(request.size):
            self._done.clear()
        view = View.of(request.scene, request.size)
        if self._done.get("shade") != request.shade_key():
            white_key = request.white_key()
            white_holds = self._done.get("white") == white_key
            self._done.clear()  # both passes share targets: an error leaves nothing half valid
            if not white_holds:
                self._white = self._draw_white(request, view)
            self._done["white"] = white_key
            self._draw_shade(request, view)
            self._extremes = self._measure()[0]
            self._done["shade"] = request.shade_key()
        scaling = Scaling.of(request.look, self._extremes)
        tone_key = (scaling.c, request.scene.display)
        if self._done.get("tone") != tone_key:
            self._draw_tone(request.scene, scaling.c)
            self._done["tone"] = tone_key
        return scaling

    def _draw_white(self, request: _Request, view: View) -> float:
        """The largest Y of the perfect diffuser in the object's place, lamp power free."""
        plan = Plan.of_perfect_diffuser(request.scene, request.look)
        uniforms = {
            **view_uniforms(request.scene, view),
            **PERFECT_DIFFUSER,
            "irradiance": np.pi,
        }
        self._draw("white", "shade.frag", plan.defines(), uniforms, SHADE)
        return self._measure()[1]

    def _draw_shade(self, request: _Request, view: View) -> None:
        plan = Plan.of(request.scene, request.look)
        uniforms = {
            **view_uniforms(request.scene, view),
            **grain_uniforms(request.look),
            **material_uniforms(request.scene),
            "irradiance": np.pi / self._white if self._white > 0.0 else 0.0,
        }
        self._draw("shade", "shade.frag", plan.defines(), uniforms, SHADE)

    def _draw_geometry(self, request: _Request) -> None:
        plan = Plan.of(request.scene, request.look)
        view = View.of(request.scene, request.size)
        uniforms = {**view_uniforms(request.scene, view), **grain_uniforms(request.look)}
        self._draw("geometry", "geometry.frag", _geometry_defines(plan), uniforms, GEOMETRY)

    def _draw_tone(self, scene: Scene, c: float) -> None:
        uniforms = {**display_uniforms(scene), **self._images(SHADE), "c": c}
        self._draw("tone", "tone.frag", _tone_defines(scene), uniforms, TONE)

    def _measure(self) -> tuple[Extremes, float]:
        """Reduce pass 1 to its extremes and the largest Y of its diffuse target."""
        self.draws["measure"] += 1
        uniforms = self._images(SHADE)
        stage = "measure.frag"
        for textures, framebuffer in self._targets.reduction:
            self.programs.draw(stage, {"BLOCK": BLOCK}, uniforms, framebuffer)
            uniforms = {f"{name}_image": texture for name, texture in textures.items()}
            stage = "reduce.frag"
        ratio, l_d_max, l_s_max, y_max = _values(uniforms["extremes_image"])
        total, l_d, l_s, not_finite = _values(uniforms["brightest_image"])
        if total < -1e29 and not not_finite:
            return Extremes.of_nothing(), 0.0
        return Extremes(ratio, l_d_max, l_s_max, l_d, l_s, int(not_finite)), y_max

    def _images(self, names: tuple[str, ...]) -> dict[str, Any]:
        return {f"{name}_image": self._targets.texture(name) for name in names}

    def _draw(
        self,
        name: str,
        stage: str,
        defines: Mapping[str, int],
        uniforms: Uniforms,
        targets: tuple[str, ...],
    ) -> None:
        self.programs.draw(stage, defines, uniforms, self._targets.framebuffer(targets))
        self.draws[name] += 1

    def _fetch(self, request: _Request, stage: str) -> NDArray[Any]:
        """One stage of a frame; draws again what has been drawn over since."""
        self._bring_up_to_date(request)
        if stage in GEOMETRY and "geometry" not in self._done:
            self._draw_geometry(request)
            self._done["geometry"] = True
        return self._targets.read(stage)


def _geometry_defines(plan: Plan) -> dict[str, int]:
    return {name: plan.defines()[name] for name in ("SHAPE", "NOISE", "GRAIN")}


def _tone_defines(scene: Scene) -> dict[str, int]:
    return {"TRANSFER": TRANSFER_CODES[scene.display.transfer]}


def _values(texture: moderngl.Texture) -> list[float]:
    """The four numbers of a 1 x 1 float texture."""
    return [float(v) for v in np.frombuffer(texture.read(), dtype=np.float32)]
