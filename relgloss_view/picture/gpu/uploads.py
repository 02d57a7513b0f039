"""Uploads: meshes and layers on the device, shared by the pictures of one OpenGL context."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable
from typing import Any

import moderngl
import numpy as np

from relgloss_view.display.inverse_nodes import curve_nodes
from relgloss_view.display.monitor import Emission
from relgloss_view.pack.layers import Layers
from relgloss_view.pack.mesh import Mesh
from relgloss_view.picture.gpu.printed import Printed, part_rows
from relgloss_view.picture.gpu.triangles import Triangles

KEPT = 4  #: of each kind: those of two panes, and of one step back


class Uploads:
    """What was uploaded, by the object that it was made of: the last used ones.

    `made` counts how many uploads there were.
    """

    def __init__(self, ctx: moderngl.Context) -> None:
        self.ctx = ctx
        self.made = 0
        self._held: dict[str, OrderedDict[object, Any]] = {}

    def triangles(self, mesh: Mesh) -> Triangles:
        """A mesh."""
        held: Triangles = self._get("mesh", mesh, lambda: Triangles(self.ctx, mesh))
        return held

    def printed(self, layers: Layers) -> Printed:
        """The layers of a pack."""
        held: Printed = self._get("layers", layers, lambda: Printed(self.ctx, layers))
        return held

    def part_table(self, layers: Layers, printed: tuple[bool, ...]) -> moderngl.Texture:
        """What artwork.glsl needs to know of each part of a form."""

        def made() -> moderngl.Texture:
            rows = part_rows(layers, printed).astype(np.float32)
            texture = self.ctx.texture((len(rows), 1), 4, rows.tobytes(), dtype="f4")
            texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
            return texture

        held: moderngl.Texture = self._get("parts", (layers, printed), made)
        return held

    def curves(self, emission: Emission) -> moderngl.Texture:
        """A monitor's curves, from light to digital values."""

        def made() -> moderngl.Texture:
            nodes = curve_nodes(emission).astype(np.float32)
            texture = self.ctx.texture((nodes.shape[1], 3), 2, nodes.tobytes(), dtype="f4")
            texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
            return texture

        held: moderngl.Texture = self._get("curves", emission, made)
        return held

    def _get(self, kind: str, key: object, make: Callable[[], Any]) -> Any:
        held = self._held.setdefault(kind, OrderedDict())
        if key in held:
            held.move_to_end(key)
            return held[key]
        while len(held) >= KEPT:
            held.popitem(last=False)[1].release()
        made = make()
        self.made += 1
        held[key] = made
        return made

    def bytes(self) -> int:
        """Bytes of meshes and layers on the device."""
        return sum(
            one.bytes() for kind in ("mesh", "layers") for one in self._held.get(kind, {}).values()
        )

    def release(self) -> None:
        """Free all of it; it is uploaded again when it is next drawn."""
        for held in self._held.values():
            for one in held.values():
                one.release()
        self._held.clear()
