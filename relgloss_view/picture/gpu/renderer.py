"""Renderer: a scene and a look become a Frame, for window, files and tests alike."""

from __future__ import annotations

import contextlib
import dataclasses
import math
from collections.abc import Callable
from functools import partial

import moderngl

from relgloss_view.base.errors import InputError
from relgloss_view.picture.frame import Frame, scene_warnings
from relgloss_view.picture.gpu.context import check_home, collect, is_forked, make_current
from relgloss_view.picture.gpu.passes import Passes
from relgloss_view.picture.gpu.programs import Programs
from relgloss_view.picture.gpu.request import Request
from relgloss_view.picture.gpu.tidying import tidy
from relgloss_view.picture.method import EXACT, Method
from relgloss_view.picture.model.drawn import as_drawn
from relgloss_view.picture.model.view import Size, check_size
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.scene import Scene

PREPARED_SIZE = (80, 8)  #: wide enough for the reduction's further steps

#: Scene, look and size -> how much of the model the picture is drawn with.
Chooser = Callable[[Scene, Look, Size], Method]


def everything(scene: Scene, look: Look, size: Size) -> Method:
    """The chooser that takes the whole model for every picture."""
    return EXACT


class Renderer:
    """Draws frames on one OpenGL context, in the thread and the process that opened it.

    Elsewhere all of it, and its frames where they fetch a stage, raise RelglossError.

    programs: Renderers of one context may share theirs. choose: the method of a picture, by the
    look's quality (quality.planner.MethodChooser.method); without it every picture is drawn with
    the whole model.
    `draws` counts the passes drawn so far by name, for those who check what is drawn again.
    """

    def __init__(
        self,
        ctx: moderngl.Context,
        programs: Programs | None = None,
        choose: Chooser = everything,
    ) -> None:
        self.ctx = ctx
        make_current(ctx)
        self.programs = Programs(ctx) if programs is None else programs
        self.choose = choose
        self.passes = Passes(ctx, self.programs)
        self._shares_programs = programs is not None
        self._device = str(ctx.info["GL_RENDERER"])
        self._last: Frame | None = None

    @property
    def draws(self) -> dict[str, int]:
        """How often each pass was drawn so far."""
        return self.passes.draws

    def prepare(self, scene: Scene, look: Look, method: Method = EXACT) -> None:
        """Compile what sliders of this scene and look can reach with a method, without a pause.

        A driver compiles a program when it is first drawn with, so each draws a few pixels.
        """
        for samples in (1, 2):
            for sigma_n_deg in (0.0, max(look.sigma_n_deg, 1.0)):
                tried = dataclasses.replace(look, sigma_n_deg=sigma_n_deg, samples=samples)
                with contextlib.suppress(InputError):
                    frame = self.render(scene, tried, PREPARED_SIZE, method)
                    _ = frame.clip_count, frame.light, frame.normal, frame.specular

    def request(
        self,
        scene: Scene,
        look: Look,
        size: Size,
        method: Method | None = None,
        factor: float = 1.0,
    ) -> Request:
        """What a frame is asked to be; no method: by the look's quality. InputError for a size."""
        if method is None:
            method = self.choose(scene, _about_as_scaled(look, factor), check_size(size))
        return Request(as_drawn(scene, look), look, check_size(size), method, factor)

    def render(
        self,
        scene: Scene,
        look: Look,
        size: Size,
        method: Method | None = None,
        *,
        factor: float = 1.0,
    ) -> Frame:
        """Draw a scene. Raises InputError for a size or a material that can't be drawn.

        The same arguments in a row give the same Frame, with what was fetched of it. A method
        draws less than the whole model. factor: of the look's c, picture.pair.common_factor.
        """
        request = self.request(scene, look, size, method, factor)
        make_current(self.ctx)
        before = self.passes.present
        drawn = self.passes.bring_up_to_date(request)
        last = self._last
        same = before is not None and before is self.passes.present
        asked = scene, look, size, request.method, factor
        if same and last and _asked_of(last) == asked:
            return last
        self._last = Frame(
            scene,
            look,
            size,
            scaling=drawn.scaling,
            fetch=partial(self.passes.fetch, request),
            device=self._device,
            warnings=(
                *scene_warnings(
                    scene, look, size, seen=drawn.object_pixels > 0, lit=drawn.white > 0.0
                ),
                *self.passes.surface.notes(scene),
            ),
            method=request.method,
            object_pixels=drawn.object_pixels,
            l_s_max=drawn.l_s_max,
        )
        return self._last

    def forget(self) -> int:
        """Free all targets; programs stay. Returns the targets' bytes."""
        make_current(self.ctx)
        freed = self.passes.targets.bytes()
        self._last = None
        self.passes.release()
        return freed

    def framebuffer_name(self, targets: tuple[str, ...]) -> int:
        """OpenGL's name of the framebuffer of targets that were drawn; it reads the first."""
        check_home(self.ctx)
        return int(self.passes.targets.framebuffer(targets).glo)

    def texture(self, name: str) -> moderngl.Texture:
        """A target as it was last drawn, for passes that start from it."""
        check_home(self.ctx)
        return self.passes.texture(name)

    def tidy(self) -> int:
        """Free what can be drawn again and does not show; returns its bytes. See tidying.py."""
        make_current(self.ctx)
        return tidy(self.passes)

    def release(self) -> None:
        """Free everything on the device; frames already made are drawn again when asked.

        After a fork it does nothing: everything belongs to the process before the fork.
        """
        if is_forked(self.ctx):
            return
        make_current(self.ctx)
        self._last = None
        self.passes.release()
        if not self._shares_programs:
            self.programs.release()
        collect(self.ctx)


def _asked_of(frame: Frame) -> tuple[object, ...]:
    """What a frame was asked to be."""
    return frame.scene, frame.look, frame.size, frame.method, frame.scaling.factor


def _about_as_scaled(look: Look, factor: float) -> Look:
    """The look with c about as the picture shows it, for the choice of a method.

    In steps of 2^(1/4), since c_max and so the factor depend a little on the method in turn.
    """
    if factor == 1.0 or look.c is None or factor <= 0.0:
        return look
    coarse = 2.0 ** (round(4.0 * math.log2(factor)) / 4.0)
    return look if coarse == 1.0 else look.with_entries(c=look.c * coarse)
