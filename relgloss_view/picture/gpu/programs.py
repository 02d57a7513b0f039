"""Shader programs by stage and constants: compiled once, drawn with every uniform accounted for."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import moderngl
import numpy as np

from relgloss_view.base.interruptions import checkpoint
from relgloss_view.picture.gpu.shader import HANDED_ON, ShaderError, ShaderSource

Uniforms = Mapping[str, Any]  #: numbers, sequences, arrays, or textures for samplers


class Programs:
    """The programs of one context. `compiled` counts how many were made so far."""

    def __init__(self, ctx: moderngl.Context) -> None:
        self.ctx = ctx
        self.compiled = 0
        self._arrays: dict[tuple[str, tuple[tuple[str, int], ...]], moderngl.VertexArray] = {}

    def get(self, stage: str, defines: Mapping[str, int]) -> moderngl.VertexArray:
        """A stage with its constants, ready to draw; ShaderError names file and line."""
        key = (stage, tuple(sorted(defines.items())))
        if key not in self._arrays:
            source = ShaderSource(stage, defines)
            try:
                program = self.ctx.program(vertex_shader=source.vertex, fragment_shader=source.text)
            except moderngl.Error as error:
                raise ShaderError(source.explain(str(error))) from error
            self.compiled += 1
            self._arrays[key] = self.ctx.vertex_array(program, [])
        return self._arrays[key]

    def release(self) -> None:
        """Free every program; they are compiled again when next drawn."""
        for array in self._arrays.values():
            program = array.program
            array.release()
            program.release()
        self._arrays.clear()

    def draw(
        self,
        stage: str,
        defines: Mapping[str, int],
        uniforms: Uniforms,
        target: moderngl.Framebuffer,
        mode: int = moderngl.TRIANGLES,
        vertices: int = 3,
    ) -> None:
        """Draw a stage into a target: one triangle that fills it, unless it has its own vertices.

        A uniform of the stage that is not given is an error.
        """
        checkpoint()  # between passes
        array = self.get(stage, defines)
        unit = 0
        for full_name in array.program:
            member = array.program[full_name]
            if not isinstance(member, moderngl.Uniform):
                continue
            name = full_name.removeprefix(HANDED_ON)
            if name not in uniforms:
                raise ShaderError(f"{stage}: uniform {name!r} has no value")
            value = uniforms[name]
            if isinstance(value, moderngl.Texture):
                value.use(unit)
                member.value = unit
                unit += 1
            elif isinstance(value, np.ndarray):
                # Drivers cut an array to the elements that the variant reads.
                data = np.ravel(value).astype(np.float32)
                member.write(data[: member.array_length * member.dimension].tobytes())
            else:
                member.value = value
        target.use()
        self.ctx.disable(moderngl.BLEND | moderngl.DEPTH_TEST | moderngl.CULL_FACE)
        array.render(mode, vertices=vertices)
