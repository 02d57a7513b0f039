"""Calls the real GLSL functions over arrays, so that tests transcribe none of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import moderngl
import numpy as np
from numpy.typing import NDArray

from relgloss_view.picture.shader import ShaderSource

WIDTH = 1024
STAGE = """#version 330 core
{includes}
{samplers}
out {kind} result;
void main() {{
    ivec2 at = ivec2(gl_FragCoord.xy);
    int index = at.y * {width} + at.x;
    {reads}
    {body}
}}
"""


def evaluate(
    ctx: moderngl.Context,
    includes: Sequence[str],
    body: str,
    inputs: Mapping[str, NDArray],
    *,
    integers: bool = False,
    defines: Mapping[str, int] | None = None,
) -> NDArray:
    """Run `body`, which sets `result`, for each row of the inputs; returns (N, 4).

    Each input (N,) or (N, k <= 4) is a vec4 of its name; uint32 inputs are uvec4. `result` is a
    vec4, or a uvec4 with `integers`.
    """
    count = len(next(iter(inputs.values())))
    height = -(-count // WIDTH)
    textures = {}
    samplers, reads = [], []
    for name, values in inputs.items():
        is_uint = values.dtype == np.uint32
        padded = np.zeros((height * WIDTH, 4), dtype=np.uint32 if is_uint else np.float32)
        padded[:count, : 1 if values.ndim == 1 else values.shape[1]] = values.reshape(count, -1)
        textures[name] = ctx.texture(
            (WIDTH, height), 4, padded.tobytes(), dtype="u4" if is_uint else "f4"
        )
        textures[name].filter = (moderngl.NEAREST, moderngl.NEAREST)
        prefix = "u" if is_uint else ""
        samplers.append(f"uniform {prefix}sampler2D {name}_values;")
        reads.append(f"{prefix}vec4 {name} = texelFetch({name}_values, at, 0);")
    source = ShaderSource(
        "test",
        defines,
        STAGE.format(
            includes="\n".join(f'#include "{name}"' for name in includes),
            samplers="\n".join(samplers),
            kind="uvec4" if integers else "vec4",
            width=WIDTH,
            reads="\n".join(reads),
            body=body,
        ),
    )
    try:
        program = ctx.program(
            vertex_shader=ShaderSource("fill.vert").text, fragment_shader=source.text
        )
    except moderngl.Error as error:
        raise AssertionError(source.explain(str(error))) from error
    for unit, (name, texture) in enumerate(textures.items()):
        if f"{name}_values" in program:
            texture.use(unit)
            program[f"{name}_values"].value = unit
    target = ctx.texture((WIDTH, height), 4, dtype="u4" if integers else "f4")
    framebuffer = ctx.framebuffer([target])
    framebuffer.use()
    ctx.vertex_array(program, []).render(moderngl.TRIANGLES, vertices=3)
    data = np.frombuffer(target.read(), dtype=np.uint32 if integers else np.float32)
    return data.reshape(-1, 4)[:count].copy()
