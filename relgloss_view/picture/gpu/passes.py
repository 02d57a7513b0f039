"""Renderer: which passes a picture needs, and which of them still hold."""

from __future__ import annotations

import contextlib
import dataclasses
from collections.abc import Iterator, Mapping
from functools import partial
from typing import Any

import moderngl
import numpy as np

from relgloss_view.base.errors import InputError
from relgloss_view.material.spectra import illuminant
from relgloss_view.picture.frame import Extremes, Frame, Scaling, scene_warnings
from relgloss_view.picture.gpu.context import collect, make_current
from relgloss_view.picture.gpu.held import Held, key_of
from relgloss_view.picture.gpu.on_demand import fetch
from relgloss_view.picture.gpu.programs import Programs, Uniforms
from relgloss_view.picture.gpu.reduction import Reduction
from relgloss_view.picture.gpu.request import Request
from relgloss_view.picture.gpu.targets import CLEARED, PARTS, SHADE, SPLIT, TONE, Targets
from relgloss_view.picture.gpu.uniforms import (
    NO_GRAIN,
    display_uniforms,
    grain_uniforms,
    material_uniforms,
    view_uniforms,
)
from relgloss_view.picture.gpu.variant import Plan, tone_defines
from relgloss_view.picture.method import Method
from relgloss_view.picture.model.drawn import as_drawn
from relgloss_view.picture.model.light import front_white, lit_white
from relgloss_view.picture.model.pixel_sampling import sample_count
from relgloss_view.picture.model.view import Box, Size, View, check_size
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.quality.planner import Planner

PREPARED_SIZE = (80, 8)  #: wide enough for the reduction's further steps
PASSES = ("white", "shade", "tone", "light", "geometry", "counts", "overlay")


class Renderer:
    """Draws frames on one OpenGL context; keeps programs, targets and the passes still valid.

    A pass holds as long as its program and every number that goes into it are the same. `draws`
    counts the passes drawn so far by name, for those who check what is drawn again. Renderers of
    one context may share their programs.
    """

    def __init__(self, ctx: moderngl.Context, programs: Programs | None = None) -> None:
        self.ctx = ctx
        make_current(ctx)
        self.programs = programs or Programs(ctx)
        self._shares_programs = programs is not None
        self.draws = dict.fromkeys(PASSES, 0)
        self._device = str(ctx.info["GL_RENDERER"])
        self.targets = Targets(ctx)
        self.reduction = Reduction(ctx, self.programs)
        self.held = Held()
        self._around: dict[str, object] = {}  #: what stands outside the object's bounds, by pass
        self._white = 0.0  #: of the perfect diffuser's picture
        self._object_pixels = 0  #: of that picture
        self._extremes = Extremes.of_nothing()
        self._once = Extremes.of_nothing()  #: of the picture without grain, where a method asks
        self.counts = (0, 0)
        #: What the targets show, with its scaling and Y_n.
        self._present: tuple[Request, int, Scaling, float] | None = None
        self._lamp: object = None
        self._last: Frame | None = None
        self.planner = Planner()  #: which method draws what asks for quality "auto"

    def prepare(self, scene: Scene, look: Look) -> None:
        """Compile every variant that sliders of this scene and look can reach without a pause.

        A driver compiles a program when it is first drawn with, so each draws a few pixels.
        """
        for samples in (1, 2):
            for sigma_n_deg in (0.0, max(look.sigma_n_deg, 1.0)):
                tried = dataclasses.replace(
                    look, sigma_n_deg=sigma_n_deg, samples=samples, quality="exact"
                )
                with contextlib.suppress(InputError):
                    frame = self.render(scene, tried, PREPARED_SIZE)
                    _ = frame.clip_count, frame.light, frame.normal, frame.specular

    def request(
        self, scene: Scene, look: Look, size: Size, method: Method | None = None
    ) -> Request:
        """What a frame is asked to be; no method: by the look's quality. InputError for a size."""
        if method is None:
            method = self.planner.method(scene, look, check_size(size))
        return Request(as_drawn(scene, look), look, check_size(size), method)

    def render(self, scene: Scene, look: Look, size: Size, method: Method | None = None) -> Frame:
        """Draw a scene. Raises InputError for a size or a material that can't be drawn.

        The same arguments in a row give the same Frame, with what was fetched of it. A method
        draws less than the whole model.
        """
        request = self.request(scene, look, size, method)
        make_current(self.ctx)
        before = self._present
        scaling, white = self.bring_up_to_date(request)
        last = self._last
        same = before is not None and before is self._present
        asked = scene, look, size, request.method
        if same and last and (last.scene, last.look, last.size, last.method) == asked:
            return last
        self._last = Frame(
            scene,
            look,
            size,
            scaling,
            partial(fetch, self, request),
            self._device,
            scene_warnings(scene, look, size, seen=self._object_pixels > 0, lit=white > 0.0),
            request.method,
            self._object_pixels,
        )
        return self._last

    def framebuffer_name(self, targets: tuple[str, ...]) -> int:
        """OpenGL's name of the framebuffer of targets that were drawn; it reads the first."""
        return int(self.targets.framebuffer(targets).glo)

    def texture(self, name: str) -> moderngl.Texture:
        """A target as it was last drawn, for passes that go on from it."""
        return self.targets.texture(name)

    def release(self) -> None:
        """Free everything on the device; frames already made are drawn again when asked."""
        make_current(self.ctx)
        self._free_targets()
        if not self._shares_programs:
            self.programs.release()
        collect(self.ctx)

    @contextlib.contextmanager
    def all_or_nothing(self) -> Iterator[None]:
        """A pass that fails half way was not drawn: nothing that was noted holds any more."""
        try:
            yield
        except BaseException:
            self._forget()
            raise

    def bring_up_to_date(self, request: Request) -> tuple[Scaling, float]:
        """Draw what no longer holds; returns the scaling and Y_n before the lamp's power."""
        lamp = illuminant(request.scene.lamp.illuminant)  # another one where its file was edited
        if self._present is not None and self._present[:2] == (request, id(lamp)):
            return self._present[2:]
        with self.all_or_nothing():
            scaling, white = self._draw_what_changed(request)
        self._present = (request, id(lamp), scaling, white)
        self._lamp = lamp  # kept, so that no other lamp can have its identity
        return scaling, white

    def _draw_what_changed(self, request: Request) -> tuple[Scaling, float]:
        self._present = None
        self._make_room(request)
        once, lamp = request.without_grain(), illuminant(request.scene.lamp.illuminant)
        if request.method.c_max == "once" and self.held.stale("once", once, id(lamp)):
            self._draw_shade(once)
            self._once = self._extremes
        white = self._draw_shade(request)
        extremes = self._once if request.method.c_max == "once" else self._extremes
        scaling = Scaling.of(request.look, extremes, eq4=request.method.c_max == "eq4")
        bounds = View.of(request.scene, request.size).bounds
        self.draw_tone("tone", request, scaling, TONE, bounds)
        return scaling, white

    def _draw_shade(self, request: Request) -> float:
        """Pass 1 and its extremes, if they no longer hold; returns Y_n before the lamp's power."""
        plan, uniforms, white = self._shading(request)
        if self.held.stale("shade", plan, request.size, uniforms):
            self._shade(request, plan, uniforms)
        stride = 2 if request.method.c_max == "sparse" else 1
        if self.held.stale("extremes", stride):
            bounds = View.of(request.scene, request.size).bounds
            self._extremes = self.reduction.extremes(self.texture("split"), bounds, stride)
            self.targets.check_fits(self._extremes)
        return white

    def bring_parts_up_to_date(self, request: Request) -> None:
        """Draw diffuse and specular XYZ too, where pass 1 did not keep them."""
        if self.held.stale("parts"):
            plan, uniforms, _ = self._shading(request)
            with self.all_or_nothing():
                self._shade(request, dataclasses.replace(plan, parts="xyz"), uniforms)

    def _shade(self, request: Request, plan: Plan, uniforms: Uniforms) -> None:
        bounds = View.of(request.scene, request.size).bounds
        targets = {"split": SPLIT, "xyz": PARTS, "all": SHADE}[plan.parts]
        self.draw("shade", "shade.frag", plan.defines(), uniforms, targets, bounds)
        if plan.parts != "split":
            self.held.stale("parts")  # they hold now

    def _shading(self, request: Request) -> tuple[Plan, Uniforms, float]:
        """How pass 1 is drawn, with what, and Y_n before the lamp's power."""
        scene, look, size, method = request.scene, request.look, request.size, request.method
        view = View.of(scene, size)
        seen_from: dict[str, Any] = {
            **view_uniforms(scene, view),
            "samples": sample_count(scene, look, size),
        }
        plan = Plan.of(scene, look, seen_from["samples"], method)
        white = self._white_of(scene, view, plan, seen_from)
        uniforms: dict[str, Any] = {
            **seen_from,
            **(grain_uniforms(look) if plan.noise != "none" else NO_GRAIN),
            **material_uniforms(scene, look, method),
            "irradiance": np.pi / white if white > 0.0 else 0.0,
        }
        if plan.cube_root == "table":
            uniforms["cube_root_table"] = self.targets.cube_root_table()
        return plan, uniforms, white

    def _make_room(self, request: Request) -> None:
        if (request.size, request.method.targets) != (self.targets.size, self.targets.numbers):
            self._free_targets()
            try:
                self.targets.resize(request.size, request.method.targets)
                self.reduction.resize(request.size)
            except BaseException:  # half of it is of no use
                self._free_targets()
                raise

    def _free_targets(self) -> None:
        self.targets.release()  # leaves a framebuffer bound that stays
        self.reduction.release()
        self._forget()

    def _forget(self) -> None:
        self.held.clear()
        self._around.clear()
        self._present, self._last = None, None

    def _white_of(self, scene: Scene, view: View, plan: Plan, seen_from: dict[str, Any]) -> float:
        """What the perfect diffuser shows in the object's place, the lamp's power taken as one."""
        defines = plan.white_defines()
        if self.held.stale("white", tuple(defines.items()), view.size, seen_from):
            self._white, self._object_pixels = self.reduction.white(defines, seen_from, view.bounds)
            self.draws["white"] += 1
        white = self._white if scene.lamp.y_n == "maximum" else front_white(scene, view)
        return lit_white(white, scene)

    def draw_tone(
        self,
        name: str,
        request: Request,
        scaling: Scaling,
        targets: tuple[str, ...],
        bounds: Box | None,
    ) -> None:
        """Scale and show; outside the bounds stands the surround, which c does not change."""
        around: Uniforms = display_uniforms(request.scene)
        samples = sample_count(request.scene, request.look, request.size)
        defines = tone_defines(request.scene.display, f"{name}.frag", samples, request.method)
        if self.held.stale(name, tuple(defines.items()), around, scaling.c):
            key = key_of(tuple(defines.items()), around, bounds)
            sources = ("diffuse", "split") if samples > 1 else ("split",)
            uniforms = {**around, "c": scaling.c, **self.images(sources)}
            if self._around.get(name) != key:
                bounds = None
            self.draw(name, f"{name}.frag", defines, uniforms, targets, bounds)
            self._around[name] = key

    def images(self, names: tuple[str, ...]) -> dict[str, Any]:
        """Targets as they were last drawn, by the names that shaders know them by."""
        return {f"{name}_image": self.texture(name) for name in names}

    def draw(
        self,
        name: str,
        stage: str,
        defines: Mapping[str, int],
        uniforms: Uniforms,
        targets: tuple[str, ...],
        bounds: Box | None,
    ) -> None:
        """Draw a pass inside the bounds of the object; None draws the whole picture."""
        framebuffer: Any = self.targets.framebuffer(targets)  # its annotation admits no None
        for target in targets:
            if target in CLEARED and self._around.get(target) != bounds:
                cleared: Any = self.targets.framebuffer((target,))
                cleared.scissor = None
                cleared.use()  # or the clearing keeps to the scissor of the pass before
                cleared.clear(*CLEARED[target])
                self._around[target] = bounds
        if bounds is None:
            framebuffer.scissor = None
        else:
            left, bottom, right, top = bounds
            framebuffer.scissor = (left, bottom, right - left, top - bottom)
        self.programs.draw(stage, defines, uniforms, framebuffer)
        self.draws[name] += 1
