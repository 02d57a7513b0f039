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

from relgloss_view.picture.context import collect, make_current
from relgloss_view.picture.frame import Extremes, Frame, Scaling, scene_warnings
from relgloss_view.picture.light import front_white, lit_white
from relgloss_view.picture.plan import GAMUT_CODES, TRANSFER_CODES, Plan, sample_count
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

Key = tuple[Any, ...]


@dataclass(frozen=True)
class _Request:
    """What a frame was asked to be."""

    scene: Scene
    look: Look
    size: Size


class Renderer:
    """Draws frames on one OpenGL context; keeps programs, targets and the passes still valid.

    A pass holds as long as its program and every number that goes into it are the same. `draws`
    counts the passes drawn so far by name, for those who check what is drawn again.
    """

    def __init__(self, ctx: moderngl.Context) -> None:
        self.ctx = ctx
        make_current(ctx)
        self.programs = Programs(ctx)
        self.draws = dict.fromkeys(("white", "shade", "measure", "tone", "geometry"), 0)
        self._device = str(ctx.info["GL_RENDERER"])
        self._targets = Targets(ctx)
        self._done: dict[str, Key] = {}
        self._white = 0.0  #: of the perfect diffuser's picture
        self._seen = False  #: whether that picture shows the object
        self._extremes = Extremes.of_nothing()

    def prepare(self, scene: Scene, look: Look) -> None:
        """Compile every variant that sliders of this scene and look can reach without a pause."""
        make_current(self.ctx)
        for sigma_n_deg in (0.0, max(look.sigma_n_deg, 1.0)):
            plan = Plan.of(scene, dataclasses.replace(look, sigma_n_deg=sigma_n_deg))
            self.programs.get("shade.frag", plan.defines())
            self.programs.get("geometry.frag", _geometry_defines(plan))
        self.programs.get("shade.frag", Plan.of_perfect_diffuser(scene).defines())
        for name in ("measure.frag", "reduce.frag"):
            self.programs.get(name, {"BLOCK": BLOCK})
        self.programs.get("tone.frag", _tone_defines(scene))

    def render(self, scene: Scene, look: Look, size: Size) -> Frame:
        """Draw a scene. Raises InputError for a size or a material that can't be drawn."""
        request = _Request(scene, look, check_size(size))
        make_current(self.ctx)
        scaling, white = self._bring_up_to_date(request)
        return Frame(
            scene,
            look,
            size,
            scaling,
            partial(self._fetch, request),
            self._device,
            scene_warnings(scene, look, size, seen=self._seen, lit=white > 0.0),
        )

    def release(self) -> None:
        """Free everything on the device; frames already made are drawn again when asked."""
        make_current(self.ctx)
        self._targets.release()
        self.programs.release()
        self._done.clear()
        collect(self.ctx)

    def _bring_up_to_date(self, request: _Request) -> tuple[Scaling, float]:
        """Draw what no longer holds; returns the scaling and Y_n before the lamp's power."""
        if self._targets.resize(request.size):
            self._done.clear()
        scene, look, size = request.scene, request.look, request.size
        view = View.of(scene, size)
        samples = sample_count(scene, look, size)
        seen_from: dict[str, Any] = {**view_uniforms(scene, view), "samples": samples}
        white = self._white_of(scene, view, seen_from)
        plan = Plan.of(scene, look)
        uniforms: Uniforms = {
            **seen_from,
            **(grain_uniforms(look) if plan.noise != "none" else {}),
            **material_uniforms(scene),
            "irradiance": np.pi / white if white > 0.0 else 0.0,
        }
        key = _key(plan, size, uniforms)
        if self._done.get("shade") != key:
            self._forget("shade", "tone", "geometry")
            self._draw("shade", "shade.frag", plan.defines(), uniforms, SHADE)
            self._extremes = self._measure()[0]
            self._done["shade"] = key
        scaling = Scaling.of(look, self._extremes)
        tone: Uniforms = {**display_uniforms(scene), "c": scaling.c}
        defines = _tone_defines(scene)
        key = _key(tuple(defines.items()), tone)
        if self._done.get("tone") != key:
            self._forget("tone")
            self._draw("tone", "tone.frag", defines, {**tone, **self._images(SHADE)}, TONE)
            self._done["tone"] = key
        return scaling, white

    def _white_of(self, scene: Scene, view: View, seen_from: Uniforms) -> float:
        """What the perfect diffuser shows in the object's place, the lamp's power taken as one."""
        plan = Plan.of_perfect_diffuser(scene)
        uniforms = {**seen_from, **PERFECT_DIFFUSER, "irradiance": np.pi}
        key = _key(plan, view.size, uniforms)
        if self._done.get("white") != key:
            self._forget("white", "shade", "tone", "geometry")  # they share the targets
            self._draw("white", "shade.frag", plan.defines(), uniforms, SHADE)
            extremes, self._white = self._measure()
            self._seen = extremes != Extremes.of_nothing()
            self._done["white"] = key
        white = self._white if scene.lamp.y_n == "maximum" else front_white(scene, view)
        return lit_white(white, scene)

    def _draw_geometry(self, request: _Request) -> None:
        plan = Plan.of(request.scene, request.look)
        view = View.of(request.scene, request.size)
        uniforms = {
            **view_uniforms(request.scene, view),
            **grain_uniforms(request.look),
            "samples": sample_count(request.scene, request.look, request.size),
        }
        self._draw("geometry", "geometry.frag", _geometry_defines(plan), uniforms, GEOMETRY)

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

    def _forget(self, *passes: str) -> None:
        for name in passes:
            self._done.pop(name, None)

    def _fetch(self, request: _Request, stage: str) -> NDArray[Any]:
        """One stage of a frame; draws again what has been drawn over since."""
        make_current(self.ctx)
        self._bring_up_to_date(request)
        if stage in GEOMETRY and "geometry" not in self._done:
            self._draw_geometry(request)
            self._done["geometry"] = ()
        return self._targets.read(stage)


def _key(*parts: object) -> Key:
    """A value that is equal exactly where everything that goes into a pass is."""
    return tuple(_plain(part) for part in parts)


def _plain(part: object) -> object:
    if isinstance(part, Mapping):
        return tuple((name, _plain(part[name])) for name in sorted(part))
    if isinstance(part, np.ndarray):
        return part.tobytes()
    return part


def _geometry_defines(plan: Plan) -> dict[str, int]:
    return {name: plan.defines()[name] for name in ("SHAPE", "NOISE", "GRAIN")}


def _tone_defines(scene: Scene) -> dict[str, int]:
    display = scene.display
    return {"TRANSFER": TRANSFER_CODES[display.transfer], "GAMUT": GAMUT_CODES[display.gamut]}


def _values(texture: moderngl.Texture) -> list[float]:
    """The four numbers of a 1 x 1 float texture."""
    return [float(v) for v in np.frombuffer(texture.read(), dtype=np.float32)]
