"""Passes: what has to be drawn for a picture, in which order, and which of it still holds.

Pass 1 writes diffuse and specular to two float targets (shade.frag). Pass 2 splits their L*
(split.frag), from which c_max is reduced, and then scales, maps the gamut and encodes (tone.frag),
so that a change of c alone draws the last stage alone. The rest is drawn when it is asked for.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Mapping
from functools import partial
from typing import Any

import moderngl
import numpy as np

from relgloss_view.base.arrays import AnyArray
from relgloss_view.material.spectra import illuminant
from relgloss_view.pack import forms
from relgloss_view.picture.frame import Extremes, Scaling
from relgloss_view.picture.gpu.asked import geometry_of, silhouette_of
from relgloss_view.picture.gpu.context import make_current
from relgloss_view.picture.gpu.drawing import PASSES, Drawing, Drawn, Tiles
from relgloss_view.picture.gpu.edges import Silhouette
from relgloss_view.picture.gpu.finishes import ink_uniforms
from relgloss_view.picture.gpu.held import Held, key_of
from relgloss_view.picture.gpu.programs import Programs, Uniforms
from relgloss_view.picture.gpu.reduction import Reduction
from relgloss_view.picture.gpu.request import Request
from relgloss_view.picture.gpu.shading import Shading, shading_of
from relgloss_view.picture.gpu.strip import Strip
from relgloss_view.picture.gpu.surface import Form, Surface
from relgloss_view.picture.gpu.targets import (
    CLEARED,
    GEOMETRY,
    GRAIN_FIELD,
    LIGHT,
    SPLIT,
    TONE,
    XYZ,
    Targets,
)
from relgloss_view.picture.gpu.uniforms import (
    LAMP_NAMES,
    WHOLE,
    display_uniforms,
    field_size,
    per_size,
    view_uniforms,
)
from relgloss_view.picture.gpu.variant import Variant, tone_defines
from relgloss_view.picture.model.light import front_white, lit_white
from relgloss_view.picture.model.pixel_sampling import sample_count
from relgloss_view.picture.model.view import Box, View
from relgloss_view.picture.peak import check_picture


class Passes:
    """The passes of pictures on one OpenGL context, their targets, and the ones that still hold.

    A pass holds while its program and its numbers are the same. `draws` counts passes by name.
    """

    def __init__(self, ctx: moderngl.Context, programs: Programs) -> None:
        self.ctx = ctx
        self.programs = programs
        self.draws = dict.fromkeys(PASSES, 0)
        self.targets = Targets(ctx)
        self.reduction = Reduction(ctx, programs)
        self.silhouette = Silhouette(ctx)
        self.strip = Strip(ctx, programs)
        self.surface = Surface(ctx, programs, programs.uploads)
        self.held = Held()
        self.present: Request | None = None  #: what the targets show
        self._drawn: Drawn | None = None  #: with it
        self.around: dict[str, object] = {}  #: what fills the picture outside the object, by pass
        self._white = 0.0  #: of the perfect diffuser's picture
        self._object_pixels = 0  #: of that picture
        self._extremes = Extremes.of_nothing()
        self._once, self._counts = Extremes.of_nothing(), (0, 0)  #: the first is without grain
        self._lamp: object = None
        self.written: tuple[str, ...] = ()  #: the targets of pass 1, as last drawn

    def bring_up_to_date(self, request: Request) -> Drawn:
        """Draw what no longer holds of a picture."""
        lamp = illuminant(request.scene.lamp.illuminant)  # another one where its file was edited
        if self._drawn is not None and self.present == request and self._lamp is lamp:
            return self._drawn
        with self.all_or_nothing():
            self.present, self._drawn = None, None
            self._make_room(request)
            drawn = self._draw_what_changed(request)
        self.present, self._drawn = request, drawn
        self._lamp = lamp  # kept, so that no other lamp can have its identity
        return drawn

    def fetch(self, request: Request, stage: str, rows: slice | None = None) -> AnyArray:
        """One stage of a picture as an array; draws again what has been drawn over since.

        rows: from the top, all by default. Of what is drawn on request, only these are drawn.
        """
        make_current(self.ctx)
        if stage == "counts":
            return np.array(self.counts(request))
        drawn = self.bring_up_to_date(request)
        if stage == "edges":
            with self.all_or_nothing():
                return silhouette_of(self, request).pixels
        drawing = self._on_request(request, drawn.scaling, stage)
        if drawing is None or rows is None or rows.stop - rows.start == request.size[1]:
            if drawing is not None:
                self._bring(drawing)
            return self.targets.read(stage, rows)
        asked = request, self._lamp
        if not self.strip.holds(drawing.targets, asked, rows):
            with self.all_or_nothing():
                self.strip.draw(drawing, request.size, asked, rows)
            self.draws[drawing.name] += 1
        return self.strip.read(stage, rows.stop - rows.start)

    def bring(self, request: Request, *stages: str) -> None:
        """Draw stages over the whole picture that are drawn on request only."""
        drawn = self.bring_up_to_date(request)
        for stage in stages:
            drawing = self._on_request(request, drawn.scaling, stage)
            if drawing is not None:
                self._bring(drawing)

    def _bring(self, drawing: Drawing) -> None:
        if self.held.renew(drawing.held, *drawing.parts):
            with self.all_or_nothing():
                self.draw(*drawing.arguments)

    def _on_request(self, request: Request, scaling: Scaling, stage: str) -> Drawing | None:
        """What draws a stage that is drawn on request only; None for the others."""
        if stage in XYZ:
            return self._xyz(request)
        if stage in LIGHT:
            return self._tone("light", request, scaling, LIGHT)
        return geometry_of(self, request) if stage in GEOMETRY else None

    def _xyz(self, request: Request) -> Drawing | None:
        """Diffuse and specular as XYZ, where pass 1 wrote something else."""
        shading = self._shading(request)
        if set(XYZ) <= set(shading.variant.targets):
            return None
        variant, inputs = shading.variant.writing("xyz"), self._inputs(shading)
        bounds = View.of(request.scene, request.size).bounds
        tiles = self.tiles(request, variant)
        return Drawing(
            "shade", "shade.frag", variant.defines(), inputs, XYZ, bounds, "xyz", (), tiles
        )

    def tiles(self, request: Request, variant: Variant) -> Tiles | None:
        """The tiles of the surface that a variant reads; None where rays meet the object."""
        if variant.surface == "met":
            return None
        view = View.of(request.scene, request.size)
        seen = view_uniforms(request.scene, view, afar=variant.afar)
        uniforms = {name: value for name, value in seen.items() if name not in LAMP_NAMES}
        samples = sample_count(request.scene, request.look, request.size)
        samples = samples if variant.sampled else 1
        form = Form.of(request.scene)
        defines = variant.surface_defines()
        uniforms |= ink_uniforms(request.scene.pack, request.look, request.method)
        return partial(self.surface.tiles, form, view, samples, defines, uniforms)

    def counts(self, request: Request) -> tuple[int, int]:
        """How many pixels are clipped, and how many out of gamut."""
        self.bring_up_to_date(request)
        if self.held.renew("counts"):
            bounds = View.of(request.scene, request.size).bounds
            with self.all_or_nothing():
                self._counts = self.reduction.counts(self.texture("display"), bounds)
            self.draws["counts"] += 1
        return self._counts

    @contextlib.contextmanager
    def all_or_nothing(self) -> Iterator[None]:
        """A pass that fails half way was not drawn: nothing that was noted holds any more."""
        try:
            yield
        except BaseException:
            self._forget()
            raise

    def texture(self, name: str) -> moderngl.Texture:
        """A target as it was last drawn, for passes that start from it."""
        return self.targets.texture(name)

    def images(self, names: tuple[str, ...]) -> dict[str, Any]:
        """Targets as they were last drawn, by the names that shaders know them by."""
        return {f"{name}_image": self.texture(name) for name in names}

    def draw(
        self,
        name: str,
        stage: str,
        defines: Mapping[str, int | str],
        uniforms: Uniforms,
        targets: tuple[str, ...],
        bounds: Box | None,
        tiles: Tiles | None = None,
        vertices: tuple[int, int] = (moderngl.TRIANGLES, 3),
    ) -> None:
        """Draw a pass inside the bounds of the object; None draws the whole picture.

        tiles: of the surface that it reads. vertices: mode and count of the stage's own ones.
        """
        framebuffer: Any = self.targets.framebuffer(targets)  # its annotation admits no None
        for target in targets:
            if target in CLEARED and self.around.get(target) != bounds:
                cleared: Any = self.targets.framebuffer((target,))
                cleared.scissor = None
                cleared.use()  # or the clearing keeps to the scissor of the pass before
                cleared.clear(*CLEARED[target])
                self.around[target] = bounds
        parts = ((bounds, {}),) if tiles is None or bounds is None else tiles(bounds)
        for part, surface in parts:
            if part is None:
                framebuffer.scissor = None
            else:
                left, bottom, right, top = part
                framebuffer.scissor = (left, bottom, right - left, top - bottom)
            self.programs.draw(stage, defines, {**uniforms, **surface}, framebuffer, *vertices)
        self.draws[name] += 1

    def release(self) -> None:
        """Free everything that a size needs."""
        self.strip.release()
        self.surface.release()
        self.targets.release()  # leaves a framebuffer bound that stays
        self.reduction.release()
        self.silhouette.release()
        self._forget()

    def _draw_what_changed(self, request: Request) -> Drawn:
        method = request.method
        once, lamp = request.without_grain(), illuminant(request.scene.lamp.illuminant)
        if method.c_max == "once" and self.held.renew("once", once, id(lamp)):
            self._draw_light(once)
            self._once = self._extremes
        white = self._draw_light(request)
        extremes = self._once if method.c_max == "once" else self._extremes
        scaling = Scaling.of(
            request.look, extremes, eq4=method.c_max == "eq4", factor=request.factor
        )
        bounds = View.of(request.scene, request.size).bounds
        if self._draw_tone(request, scaling, bounds):
            self._draw_edges(request, scaling)
        return Drawn(scaling, white, self._object_pixels, extremes.l_s_max)

    def _draw_light(self, request: Request) -> float:
        """Pass 1, the split of what it wrote, and its extremes; returns Y_n as in Drawn."""
        shading = self._shading(request)
        variant, bounds = shading.variant, View.of(request.scene, request.size).bounds
        if variant.reads_field:
            self._draw_field(request, shading)
        form = Form.of(request.scene).key if variant.surface == "read" else ()
        if self.held.renew("shade", variant, request.size, shading.uniforms, form):
            self._shade(request, shading, variant)
        if not variant.splits and self.held.renew("split"):
            diffuse, specular = map(self.texture, variant.targets)
            images = {"diffuse_image": diffuse, "specular_image": specular}
            uniforms = {**self._inputs(shading), **images, **per_size(request.size)}
            self.draw("split", "split.frag", variant.split_defines(), uniforms, SPLIT, bounds)
        stride = 2 if request.method.c_max == "sparse" else 1
        if self.held.renew("extremes", stride):
            self._extremes = self.reduction.extremes(self.texture("split"), bounds, stride)
            self.targets.check_fits(self._extremes)
        return shading.white

    def _shade(self, request: Request, shading: Shading, variant: Variant) -> None:
        bounds, inputs = View.of(request.scene, request.size).bounds, self._inputs(shading)
        self.written = variant.targets
        tiles = self.tiles(request, variant)
        self.draw("shade", "shade.frag", variant.defines(), inputs, self.written, bounds, tiles)

    def _draw_field(self, request: Request, shading: Shading) -> None:
        """The tilts of grain that has one size at the eye: neither scene nor sigma_N moves them."""
        defines = shading.variant.field_defines()
        uniforms = {name: shading.uniforms[name] for name in ("field_step", "seed")}
        size = field_size(request.scene, request.look, request.size)
        if self.held.renew("grain", tuple(defines.items()), uniforms, size):
            target = self.targets.grain_field(size)
            self.programs.draw("grain_field.frag", defines, uniforms, target)
            self.draws["grain"] += 1

    def field(self, variant: Variant) -> dict[str, Any]:
        """The field as it was last drawn, where the variant reads it."""
        return {"grain_field": self.texture(*GRAIN_FIELD)} if variant.reads_field else {}

    def _inputs(self, shading: Shading) -> Uniforms:
        """The uniforms, with the textures that the variant reads."""
        albedos = self.targets.albedo_table(shading.uniforms.get("albedo_rows"))
        inputs = {**shading.uniforms, **self.field(shading.variant), **albedos}
        if shading.variant.cube_root == "table":
            inputs["cube_root_table"] = self.targets.cube_root_table()
        return inputs

    def _shading(self, request: Request) -> Shading:
        view = View.of(request.scene, request.size)

        def white_of(variant: Variant, seen_from: dict[str, Any]) -> float:
            return self._white_of(request, view, variant, seen_from)

        return shading_of(request, view, white_of)

    def _make_room(self, request: Request) -> None:
        if (request.size, request.method.targets) != (self.targets.size, self.targets.numbers):
            self.release()
            check_picture(request.size, opened=True, scene=request.scene)
            try:
                self.targets.resize(request.size, request.method.targets)
                self.reduction.resize(request.size)
            except BaseException:  # half of it is of no use
                self.release()
                raise

    def _forget(self) -> None:
        self.held.clear()
        self.around.clear()
        self.present, self._drawn = None, None

    def _white_of(
        self, request: Request, view: View, variant: Variant, seen_from: dict[str, Any]
    ) -> float:
        """What the perfect diffuser shows in the object's place, the lamp's power taken as one."""
        scene, defines = request.scene, variant.white_defines()
        mesh = forms.mesh_of(scene.shape) if variant.surface == "read" else None
        if self.held.renew("white", tuple(defines.items()), view.size, seen_from, mesh):
            tiles = self.tiles(request, variant)
            parts = ((view.bounds, {}),) if tiles is None else tiles(view.bounds)
            self._white, self._object_pixels = 0.0, 0
            for bounds, surface in parts:
                seen = {**seen_from, **surface}
                white, pixels = self.reduction.white(defines, seen, bounds)
                self._white = max(self._white, white)
                self._object_pixels += pixels
            self.draws["white"] += 1
        white = self._white if scene.lamp.y_n == "maximum" else front_white(scene.setup, view)
        return lit_white(white, scene.setup)

    def _tone(
        self, name: str, request: Request, scaling: Scaling, targets: tuple[str, ...]
    ) -> Drawing:
        """Scale and show: the display's picture, or its float numbers."""
        around: Uniforms = display_uniforms(request.scene, self.programs.uploads)
        samples = sample_count(request.scene, request.look, request.size)
        defines = tone_defines(request.scene.display, f"{name}.frag", samples, request.method)
        sources = ("diffuse", "split") if samples > 1 else ("split",)
        uniforms = {
            **around,
            **per_size(request.size),
            **self.images(sources),
            **WHOLE,
            "c": scaling.c,
        }
        edges = request.scene.display.edges if name == "tone" else ""
        parts = tuple(defines.items()), around, scaling.c, edges
        return Drawing(name, f"{name}.frag", defines, uniforms, targets, None, name, parts)

    def _draw_tone(self, request: Request, scaling: Scaling, bounds: Box) -> bool:
        """Scale and show; the surround outside the bounds does not change with c.

        Returns whether there was anything to draw.
        """
        drawing = self._tone("tone", request, scaling, TONE)
        renewed = self.held.renew(drawing.held, *drawing.parts)
        if renewed:
            defines, around, *_ = drawing.parts
            key = key_of(defines, around, bounds)
            kept = self.around.get("tone") == key
            self.draw(*drawing._replace(bounds=bounds if kept else None).arguments)
            self.around["tone"] = key
        return renewed

    def _draw_edges(self, request: Request, scaling: Scaling) -> None:
        """Draw the pixels at the silhouette over pass 2; several samples have shares of their own.

        They are drawn by points, so that a change of c costs no more than they do.
        """
        scene, size = request.scene, request.size
        if scene.display.edges != "smooth" or sample_count(scene, request.look, size) > 1:
            return
        listed = silhouette_of(self, request).edges
        if listed.texture is None:
            return
        defines = tone_defines(scene.display, "edge.frag", 1, request.method)
        uniforms = {
            **display_uniforms(scene, self.programs.uploads),
            **per_size(size),
            **self.images(SPLIT),
            "edge_list": listed.texture,
            "c": scaling.c,
        }
        points = moderngl.POINTS, listed.count
        self.draw("edges", "edge.frag", defines, uniforms, TONE, None, vertices=points)
