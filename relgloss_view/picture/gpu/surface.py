"""Surface: what each place of a picture sees of triangles, or of a shape with finishes.

It depends on the view, the form and what is printed, and on nothing else: a change of the lamp, of
sigma_N, k or c reads it again. Where a picture has more places than MOST_TEXELS, it is drawn in
tiles, one after the other, each for the passes that read it before the next.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import moderngl
import numpy as np

from relgloss_view.pack import forms
from relgloss_view.pack.label import label_of
from relgloss_view.pack.layers import Layers, layers_of
from relgloss_view.pack.mesh import Mesh
from relgloss_view.pack.pack import Pack
from relgloss_view.pack.shape import ANALYTIC
from relgloss_view.picture.gpu.context import max_texture_size
from relgloss_view.picture.gpu.held import Key, key_of
from relgloss_view.picture.gpu.memory import MOST_TEXELS
from relgloss_view.picture.gpu.printed import notes_of, share_defines
from relgloss_view.picture.gpu.programs import Programs, Uniforms
from relgloss_view.picture.gpu.targets import TRIANGLE, Targets, surface_targets
from relgloss_view.picture.gpu.triangles import WIDE, hides_backs, projection
from relgloss_view.picture.gpu.uploads import Uploads
from relgloss_view.picture.model.surface import ArtworkPlace
from relgloss_view.picture.model.view import Box, Size, View
from relgloss_view.picture.scene.scene import Scene


def is_read(scene: Scene) -> bool:
    """Whether the scene's surface is drawn before it is shaded."""
    return scene.pack is not None or scene.shape.kind not in ANALYTIC


@dataclass(frozen=True)
class Form:
    """What a surface is drawn from."""

    mesh: Mesh | None
    pack: Pack | None
    layers: Layers | None

    @classmethod
    def of(cls, scene: Scene) -> Form:
        """The form of a scene whose surface is read."""
        layers = None if scene.pack is None else layers_of(scene.pack)
        return cls(forms.mesh_of(scene.shape), scene.pack, layers)

    @property
    def key(self) -> Key:
        """What a picture of it follows from, beside the view."""
        placed = {} if self.pack is None else print_uniforms(self.pack, self.layers)
        return key_of(self.mesh, self.layers, placed)

    @property
    def finishes(self) -> int:
        """How many finishes are told apart."""
        return 0 if self.pack is None else len(self.pack.finishes)


class Surface:
    """The surface of one picture on the device, as it was last drawn."""

    def __init__(self, ctx: moderngl.Context, programs: Programs, uploads: Uploads) -> None:
        self.ctx = ctx
        self.uploads = uploads
        self.drawn = 0  #: how often a tile was drawn
        self._programs = programs
        self._targets = Targets(ctx)
        self.masks = Targets(ctx)  #: for mesh_edges.draw_coverage
        self._names: tuple[str, ...] = ()
        self._key: Key | None = None

    def tiles(
        self,
        form: Form,
        view: View,
        samples: int,
        defines: Mapping[str, int | str],
        uniforms: Uniforms,
        bounds: Box,
    ) -> Iterator[tuple[Box, Uniforms]]:
        """The tiles of a part of a picture, and what reads each; it holds until the next.

        samples: along each side of a pixel. defines: of the variant's shape. uniforms: of the view.
        bounds: pixels.
        """
        size = self.tile_size(view.size, samples)
        columns, rows = (
            range(low // side * side, high, side)
            for low, high, side in zip(bounds[:2], bounds[2:], size, strict=True)
        )
        for bottom in rows:
            for left in columns:
                tile = left, bottom, left + size[0], bottom + size[1]
                inside = (*np.maximum(tile[:2], bounds[:2]), *np.minimum(tile[2:], bounds[2:]))
                whole = reached(tile, view)
                yield (
                    tuple(int(v) for v in inside),  # type: ignore[misc]
                    self._tile(form, view, tile, whole, samples, defines, uniforms),
                )

    def notes(self, scene: Scene) -> tuple[str, ...]:
        """What a user should know of how a scene's artwork is drawn."""
        return () if scene.pack is None else notes_of(self.ctx, layers_of(scene.pack))

    def tile_size(self, size: Size, samples: int) -> Size:
        """Width and height of the tiles, pixels: the whole picture where it fits."""
        most = max(1, max_texture_size(self.ctx) // samples)
        width = min(size[0], most, max(1, MOST_TEXELS // samples**2))
        return width, min(size[1], most, max(1, MOST_TEXELS // (samples**2 * width)))

    def _tile(
        self,
        form: Form,
        view: View,
        tile: Box,
        inside: Box,
        samples: int,
        defines: Mapping[str, int | str],
        uniforms: Uniforms,
    ) -> Uniforms:
        """Draw a tile unless it is held; returns what reads it."""
        size = samples * (tile[2] - tile[0]), samples * (tile[3] - tile[1])
        names = surface_targets(form.finishes)
        left, bottom = samples * tile[0], samples * tile[1]
        where: dict[str, Any] = {
            "surface_from": (left, bottom),
            "per_surface": (1.0 / size[0], 1.0 / size[1]),
            "samples": samples,
        }
        placed = {} if form.pack is None else print_uniforms(form.pack, form.layers)
        key = key_of(form.key, uniforms, defines, tile, samples, names)
        if key != self._key or size != self._targets.size:
            self._key = None
            self._make_room(size, names)
            box = (
                samples * inside[0] - left,
                samples * inside[1] - bottom,
                samples * (inside[2] - inside[0]),
                samples * (inside[3] - inside[1]),
            )
            inputs = {**uniforms, **where, **placed}
            if form.mesh is not None:
                inputs |= self._draw_triangles(form.mesh, view, tile, box, samples)
            if form.pack is not None and form.layers is not None:
                inputs |= self._printed(form)
            self._draw(form, defines, inputs, names, box)
            self._key = key
            self.drawn += 1
        return {**where, **{name: self._targets.texture(name) for name in names}}

    def _make_room(self, size: Size, names: tuple[str, ...]) -> None:
        if size != self._targets.size or set(self._names) - set(names):
            self._targets.release()
            self._targets.size = size
        self._names = names

    def _draw_triangles(
        self, mesh: Mesh, view: View, tile: Box, box: Box, samples: int
    ) -> Uniforms:
        triangles = self.uploads.triangles(mesh)
        target: Any = self._targets.framebuffer(TRIANGLE, depth=True)
        target.scissor = box
        target.use()
        target.clear(depth=1.0)
        self._programs.draw(
            "mesh.frag",
            {},
            projection(mesh, view, tile, samples),
            target,
            geometry=triangles,
            depth="<",
            culls=hides_backs(mesh, view),
        )
        return {**triangles.uniforms, "triangle_image": self._targets.texture(*TRIANGLE)}

    def _printed(self, form: Form) -> Uniforms:
        assert form.pack is not None
        assert form.layers is not None
        label = label_of(form.pack.shape)
        return {
            **self.uploads.printed(form.layers).uniforms,
            "part_table": self.uploads.part_table(form.layers, label.printed),
        }

    def _draw(
        self,
        form: Form,
        defines: Mapping[str, int | str],
        inputs: Uniforms,
        names: tuple[str, ...],
        box: Box,
    ) -> None:
        constants = {**defines, "FINISHES": form.finishes, "MESH_WIDE": WIDE}
        if form.layers is not None:
            constants["CHANNELS"] = self.uploads.printed(form.layers).channel_targets
            constants |= share_defines(form.layers)
        target: Any = self._targets.framebuffer(names)
        target.scissor = box
        self._programs.draw("surface.frag", constants, inputs, target)

    def bytes(self) -> int:
        """Bytes of the targets."""
        return self._targets.bytes()

    def release(self) -> None:
        """Free the targets; the mesh and the artwork stay with the context."""
        self._key = None
        self._targets.release()
        self.masks.release()


def reached(tile: Box, view: View) -> Box:
    """The part of a tile that the object can reach."""
    low = [max(a, b) for a, b in zip(tile[:2], view.bounds[:2], strict=True)]
    high = [min(a, b) for a, b in zip(tile[2:], view.bounds[2:], strict=True)]
    high = [max(a, b) for a, b in zip(low, high, strict=True)]
    return low[0], low[1], high[0], high[1]


def print_uniforms(pack: Pack, layers: Layers | None) -> dict[str, Any]:
    """Where the artwork lies on the label, as artwork.glsl takes it."""
    assert layers is not None
    place = ArtworkPlace.of(pack.placement, layers, label_of(pack.shape))
    return {
        "artwork_from_label": place.matrix.ravel(),
        "label_offset_m": place.offset_m,
        "girth_m": place.girth_m,
        "wraps": int(place.repeats),
    }
