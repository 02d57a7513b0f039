"""Calls the real GLSL functions over arrays, for tests and for the maps of where methods fail."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import moderngl
import numpy as np

from relgloss_view.base.arrays import AnyArray
from relgloss_view.picture.gpu.context import make_current
from relgloss_view.picture.gpu.shader import ShaderError, ShaderSource, stage_text

WIDTH = 1024


def evaluate(
    ctx: moderngl.Context,
    includes: Sequence[str],
    body: str,
    inputs: Mapping[str, AnyArray],
    *,
    integers: bool = False,
    defines: Mapping[str, int | str] | None = None,
    samplers: Mapping[str, moderngl.Texture | moderngl.Texture3D] | None = None,
) -> AnyArray:
    """Run `body`, which sets `result`, for each row of the inputs; returns (N, 4).

    Each input (N,) or (N, k <= 4) is a vec4 of its name, in float32; uint32 inputs are uvec4.
    `result` is a vec4, or a uvec4 with `integers`. `samplers` are textures that the library itself
    reads. ShaderError names what does not compile.
    """
    make_current(ctx)
    count = len(next(iter(inputs.values())))
    size = (WIDTH, -(-count // WIDTH))
    constants: dict[str, int | str] = {
        "WIDTH": WIDTH,
        **(defines or {}),
        **({"INTEGERS": 1} if integers else {}),
    }
    source = ShaderSource("evaluate", constants, _composed(includes, body, inputs))
    textures = {name: _texture(ctx, size, values) for name, values in inputs.items()}
    target = ctx.texture(size, 4, dtype="u4" if integers else "f4")
    framebuffer = ctx.framebuffer([target])
    try:
        program = ctx.program(
            vertex_shader=ShaderSource("fill.vert").text, fragment_shader=source.text
        )
    except moderngl.Error as error:
        raise ShaderError(source.explain(str(error))) from error
    array = ctx.vertex_array(program, [])
    bound = {f"{name}_values": texture for name, texture in textures.items()}
    bound |= samplers or {}
    for unit, (name, texture) in enumerate(bound.items()):
        if name in program:
            texture.use(unit)
            program[name] = unit
    framebuffer.use()
    ctx.disable(moderngl.BLEND | moderngl.DEPTH_TEST | moderngl.CULL_FACE)
    array.render(moderngl.TRIANGLES, vertices=3)
    data = np.frombuffer(target.read(), dtype=np.uint32 if integers else np.float32)
    for made in (array, program, target, *textures.values()):
        made.release()
    # The framebuffer is bound and falls with the context's garbage: it can't be freed while bound
    # where no screen exists.
    return data.reshape(-1, 4)[:count].copy()


def _composed(includes: Sequence[str], body: str, inputs: Mapping[str, AnyArray]) -> str:
    kinds = {n: "u" if values.dtype == np.uint32 else "" for n, values in inputs.items()}
    declared = [f"uniform {kind}sampler2D {name}_values;" for name, kind in kinds.items()]
    read = [f"{k}vec4 {name} = texelFetch({name}_values, at, 0);" for name, k in kinds.items()]
    text = stage_text("evaluate.frag")
    for mark, lines in (
        ("//@include", [f'#include "{name}"' for name in includes]),
        ("//@declare", declared),
        ("//@read", read),
        ("//@body", [body]),
    ):
        text = text.replace(mark, "\n".join(lines))
    return text


def _texture(ctx: moderngl.Context, size: tuple[int, int], values: AnyArray) -> Any:
    whole = values.dtype == np.uint32
    padded = np.zeros((size[0] * size[1], 4), dtype=np.uint32 if whole else np.float32)
    rows = values.reshape(len(values), -1)
    padded[: len(rows), : rows.shape[1]] = rows
    texture = ctx.texture(size, 4, padded.tobytes(), dtype="u4" if whole else "f4")
    texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
    return texture
