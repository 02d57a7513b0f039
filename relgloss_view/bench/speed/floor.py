"""The fill floor: the least that two passes over a picture can cost on a device."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import moderngl

from relgloss_view.base.errors import RelglossError
from relgloss_view.picture.gpu.context import make_current
from relgloss_view.picture.model.view import Size

FOLDER = Path(__file__).parent


class FillFloor:
    """Two RGBA32F targets written with constants, then both read and an RGBA8 one written."""

    def __init__(self, ctx: moderngl.Context, size: Size) -> None:
        self.ctx = ctx
        make_current(ctx)
        # Stays bound when the others are freed: moderngl binds what was bound before again.
        self._parking = ctx.framebuffer([ctx.texture((1, 1), 4)])
        self._floats = [ctx.texture(size, 4, dtype="f4") for _ in range(2)]
        for texture in self._floats:
            texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
        self.display = ctx.texture(size, 4)
        self._targets = [ctx.framebuffer(self._floats), ctx.framebuffer([self.display])]
        vertex = (FOLDER / "floor.vert").read_text(encoding="utf-8")
        self._programs = [
            ctx.program(
                vertex_shader=vertex,
                fragment_shader=(FOLDER / f"{name}.frag").read_text(encoding="utf-8"),
            )
            for name in ("floor_write", "floor_show")
        ]
        for unit, name in enumerate(("first_image", "second_image")):
            self._programs[1][name] = unit
        self._arrays = [ctx.vertex_array(program, []) for program in self._programs]
        fault = ctx.error
        if fault != "GL_NO_ERROR":
            raise RelglossError(f"the fill floor at {size[0]}x{size[1]} can't be made: {fault}")

    def draw(self) -> None:
        """Both passes."""
        self.ctx.disable(moderngl.BLEND | moderngl.DEPTH_TEST | moderngl.CULL_FACE)
        for unit, texture in enumerate(self._floats):
            texture.use(unit)
        for target, array in zip(self._targets, self._arrays, strict=True):
            target.use()
            array.render(moderngl.TRIANGLES, vertices=3)

    def release(self) -> None:
        """Free everything on the device."""
        make_current(self.ctx)
        self._parking.use()
        made: list[Any] = [*self._arrays, *self._programs, *self._targets, *self._floats]
        for one in (*made, self.display):
            one.release()
