"""Renderer: which passes a picture needs, and which of them still hold."""

from __future__ import annotations

import contextlib
import dataclasses
from collections.abc import Iterator, Mapping
from functools import partial
from typing import Any

import moderngl
import numpy as np
from numpy.typing import NDArray

from relgloss_view.errors import InputError
from relgloss_view.material.spectra import illuminant
from relgloss_view.picture.context import collect, make_current
from relgloss_view.picture.frame import Extremes, Frame, Scaling, scene_warnings
from relgloss_view.picture.light import front_white, lit_white
from relgloss_view.picture.plan import Plan, as_drawn, sample_count, tone_defines
from relgloss_view.picture.renderer.held import Held, key_of
from relgloss_view.picture.renderer.programs import Programs, Uniforms
from relgloss_view.picture.renderer.reduction import Reduction
from relgloss_view.picture.renderer.request import Request
from relgloss_view.picture.renderer.targets import (
    CLEARED,
    GEOMETRY,
    LIGHT,
    SHADE,
    SPLIT,
    TONE,
    Targets,
)
from relgloss_view.picture.renderer.uniforms import (
    PERFECT_DIFFUSER,
    display_uniforms,
    grain_uniforms,
    material_uniforms,
    view_uniforms,
    white_uniform,
)
from relgloss_view.picture.scene import Look, Scene
from relgloss_view.picture.view import Box, Size, View, check_size

PREPARED_SIZE = (80, 8)  #: wide enough for the reduction's further steps
PASSES = ("white", "shade", "split", "tone", "light", "geometry", "counts", "overlay")


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
        self._targets = Targets(ctx)
        self._reduction = Reduction(ctx, self.programs)
        self.held = Held()
        self._around: dict[str, object] = {}  #: what stands outside the object's bounds, by pass
        self._white = 0.0  #: of the perfect diffuser's picture
        self._seen = False  #: whether that picture shows the object
        self._extremes = Extremes.of_nothing()
        self._counts = (0, 0)
        #: What the targets show, with its scaling and Y_n.
        self._present: tuple[Request, int, Scaling, float] | None = None
        self._lamp: object = None
        self._last: Frame | None = None

    def prepare(self, scene: Scene, look: Look) -> None:
        """Compile every variant that sliders of this scene and look can reach without a pause.

        A driver compiles a program when it is first drawn with, so each draws a few pixels.
        """
        for samples in (1, 2):
            for sigma_n_deg in (0.0, max(look.sigma_n_deg, 1.0)):
                tried = dataclasses.replace(look, sigma_n_deg=sigma_n_deg, samples=samples)
                with contextlib.suppress(InputError):
                    frame = self.render(scene, tried, PREPARED_SIZE)
                    _ = frame.clip_count, frame.light, frame.normal

    def render(self, scene: Scene, look: Look, size: Size) -> Frame:
        """Draw a scene. Raises InputError for a size or a material that can't be drawn.

        The same arguments in a row give the same Frame, with what was fetched of it.
        """
        request = Request(as_drawn(scene, look), look, check_size(size))
        make_current(self.ctx)
        before = self._present
        scaling, white = self.bring_up_to_date(request)
        last = self._last
        same = before is not None and before is self._present
        if same and last is not None and (last.scene, last.look, last.size) == (scene, look, size):
            return last
        self._last = Frame(
            scene,
            look,
            size,
            scaling,
            partial(self._fetch, request),
            self._device,
            scene_warnings(scene, look, size, seen=self._seen, lit=white > 0.0),
        )
        return self._last

    def framebuffer_name(self, targets: tuple[str, ...]) -> int:
        """OpenGL's name of the framebuffer of targets that were drawn; it reads the first."""
        return int(self._targets.framebuffer(targets).glo)

    def texture_names(self) -> list[int]:
        """OpenGL's names of the textures of the targets."""
        return self._targets.names()

    def texture(self, name: str) -> moderngl.Texture:
        """A target as it was last drawn, for passes that go on from it."""
        return self._targets.texture(name)

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
        self._make_room(request.size)
        scene, look, size = request.scene, request.look, request.size
        view = View.of(scene, size)
        seen_from: dict[str, Any] = {
            **view_uniforms(scene, view),
            "samples": sample_count(scene, look, size),
        }
        white = self._white_of(scene, view, seen_from)
        plan = Plan.of(scene, look, seen_from["samples"])
        uniforms: Uniforms = {
            **seen_from,
            **(grain_uniforms(look) if plan.noise != "none" else {}),
            **material_uniforms(scene),
            "irradiance": np.pi / white if white > 0.0 else 0.0,
        }
        if self.held.stale("shade", plan, size, uniforms):
            self.draw("shade", "shade.frag", plan.defines(), uniforms, SHADE, view.bounds)
        uniforms = {**white_uniform(scene), **self.images(SHADE)}
        if self.held.stale("split", white_uniform(scene)):
            self.draw("split", "split.frag", {}, uniforms, SPLIT, view.bounds)
            self._extremes = self._reduction.extremes(self.texture("split"), view.bounds)
        scaling = Scaling.of(look, self._extremes)
        self._draw_tone("tone", request, scaling, TONE, view.bounds)
        return scaling, white

    def bring_light_up_to_date(self, request: Request) -> None:
        """Draw the tone pass's float numbers too; the rest is up to date."""
        scaling = Scaling.of(request.look, self._extremes)
        with self.all_or_nothing():
            self._draw_tone("light", request, scaling, LIGHT, None)

    def bring_geometry_up_to_date(self, request: Request) -> None:
        """Draw normals and points too; the rest is up to date."""
        if not self.held.stale("geometry"):
            return
        plan = Plan.of(request.scene, request.look)
        view = View.of(request.scene, request.size)
        uniforms = {
            **view_uniforms(request.scene, view),
            **grain_uniforms(request.look),
            "samples": sample_count(request.scene, request.look, request.size),
        }
        with self.all_or_nothing():
            self.draw(
                "geometry", "geometry.frag", plan.geometry_defines(), uniforms, GEOMETRY, None
            )

    def _make_room(self, size: Size) -> None:
        if size != self._targets.size:
            self._free_targets()
            try:
                self._targets.resize(size)
                self._reduction.resize(size)
            except BaseException:  # half of it is of no use
                self._free_targets()
                raise

    def _free_targets(self) -> None:
        self._targets.release()  # leaves a framebuffer bound that stays
        self._reduction.release()
        self._forget()

    def _forget(self) -> None:
        self.held.clear()
        self._around.clear()
        self._present, self._last = None, None

    def _white_of(self, scene: Scene, view: View, seen_from: dict[str, Any]) -> float:
        """What the perfect diffuser shows in the object's place, the lamp's power taken as one."""
        plan = Plan.of_perfect_diffuser(scene, seen_from["samples"])
        uniforms = {**seen_from, **PERFECT_DIFFUSER, "irradiance": np.pi}
        if self.held.stale("white", plan, view.size, uniforms):
            self.draw("white", "shade.frag", plan.defines(), uniforms, SHADE, view.bounds)
            diffuse = self.texture("diffuse")
            self._white, self._seen = self._reduction.peak(diffuse, view.bounds)
        white = self._white if scene.lamp.y_n == "maximum" else front_white(scene, view)
        return lit_white(white, scene)

    def _draw_tone(
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
        defines = tone_defines(request.scene.display, f"{name}.frag", samples)
        if self.held.stale(name, tuple(defines.items()), around, scaling.c):
            key = key_of(tuple(defines.items()), around, bounds)
            uniforms = {**around, "c": scaling.c, **self.images(("diffuse", *SPLIT))}
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
        framebuffer: Any = self._targets.framebuffer(targets)  # its annotation admits no None
        if targets in CLEARED and self._around.get(stage) != bounds:
            framebuffer.scissor = None
            framebuffer.use()  # or the clearing keeps to the scissor of the pass before
            framebuffer.clear(*CLEARED[targets])
            self._around[stage] = bounds
        if bounds is None:
            framebuffer.scissor = None
        else:
            left, bottom, right, top = bounds
            framebuffer.scissor = (left, bottom, right - left, top - bottom)
        self.programs.draw(stage, defines, uniforms, framebuffer)
        self.draws[name] += 1

    def _fetch(self, request: Request, stage: str) -> NDArray[Any]:
        """One stage of a frame; draws again what has been drawn over since."""
        make_current(self.ctx)
        self.bring_up_to_date(request)
        if stage == "counts":
            return np.array(self._count(request))
        if stage in LIGHT:
            self.bring_light_up_to_date(request)
        if stage in GEOMETRY:
            self.bring_geometry_up_to_date(request)
        return self._targets.read(stage)

    def _count(self, request: Request) -> tuple[int, int]:
        if self.held.stale("counts"):
            bounds = View.of(request.scene, request.size).bounds
            with self.all_or_nothing():
                self._counts = self._reduction.counts(self.texture("flags"), bounds)
            self.draws["counts"] += 1
        return self._counts
