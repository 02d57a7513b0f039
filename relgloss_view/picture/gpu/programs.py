"""Shader programs by stage and constants: compiled once, drawn with every uniform accounted for."""

from __future__ import annotations

import contextlib
from collections import OrderedDict
from collections.abc import Collection, Iterator, Mapping
from typing import Any, Protocol

import moderngl
import numpy as np

from relgloss_view.base.allocator import give_back
from relgloss_view.base.interruptions import checkpoint
from relgloss_view.picture.gpu.context import collect, drop_sources
from relgloss_view.picture.gpu.shader import HANDED_ON, ShaderError, ShaderSource
from relgloss_view.picture.gpu.uploads import Uploads

Key = tuple[object, ...]  #: a stage and its constants
Uniforms = Mapping[str, Any]  #: numbers, sequences, arrays, or textures for samplers


#: Programs that are kept. One takes 1 to 3 MB of a software driver's memory, and 5 to 60 ms to be
#: made, or some 4 ms where the driver keeps compiled programs on disk. A picture needs about ten;
#: all that sliders of one picture can reach are some 25.
MOST_PROGRAMS = 48
#: Of a benchmark, none of whose times may hold a compiler's.
ALL_PROGRAMS = 10_000
#: The share of them that is freed at once, since giving memory back to the system takes a while.
FREED_SHARE = 0.25


class Geometry(Protocol):
    """Triangles on the device."""

    def array(self, ctx: moderngl.Context, program: moderngl.Program) -> moderngl.VertexArray:
        """They, ready to be drawn by a program."""
        ...


class Programs:
    """The programs of one context, the last used ones: `most` of them.

    `compiled` counts how many were made so far, `freed` how many of them were freed to make room.
    """

    def __init__(self, ctx: moderngl.Context, most: int = MOST_PROGRAMS) -> None:
        self.ctx = ctx
        self.most = most
        self.compiled = 0
        self.freed = 0
        self.uploads = Uploads(ctx)
        self._asked: set[Key] | None = None  #: while they are noted
        #: By stage and constants, the one that was used last at the end.
        self._arrays: OrderedDict[Key, moderngl.VertexArray] = OrderedDict()

    @property
    def count(self) -> int:
        """How many programs there are now."""
        return len(self._arrays)

    def get(self, stage: str, defines: Mapping[str, int | str]) -> moderngl.VertexArray:
        """A stage with its constants, ready to draw; ShaderError names file and line.

        It stays so until another one is asked for.
        """
        key = (stage, *sorted(defines.items()))
        if self._asked is not None:
            self._asked.add(key)
        array = self._arrays.get(key)
        if array is not None:
            self._arrays.move_to_end(key)
            return array
        if len(self._arrays) >= self.most:
            self._make_room()
        source = ShaderSource(stage, defines)
        try:
            program = self.ctx.program(vertex_shader=source.vertex, fragment_shader=source.text)
        except moderngl.Error as error:
            raise ShaderError(source.explain(str(error))) from error
        drop_sources(program)
        self.compiled += 1
        self._arrays[key] = array = self.ctx.vertex_array(program, [])
        return array

    @contextlib.contextmanager
    def noted(self) -> Iterator[set[Key]]:
        """Gives the set of the programs that are asked for in the block, by stage and constants."""
        asked: set[Key] = set()
        self._asked = asked
        try:
            yield asked
        finally:
            self._asked = None

    def use(self, keys: Collection[Key]) -> bool:
        """Count programs as used now; whether all of them are there."""
        held = [key for key in keys if key in self._arrays]
        for key in held:
            self._arrays.move_to_end(key)
        return len(held) == len(keys)

    def _make_room(self) -> None:
        """Free the programs that were not used for longest."""
        count = max(1, round(FREED_SHARE * self.most))
        for _ in range(min(count, len(self._arrays))):
            _, array = self._arrays.popitem(last=False)
            _free(array)
            self.freed += 1
        collect(self.ctx)
        give_back()

    def release(self) -> None:
        """Free every program; they are compiled again when next drawn."""
        for array in self._arrays.values():
            _free(array)
        self._arrays.clear()
        self.uploads.release()
        give_back()

    def draw(
        self,
        stage: str,
        defines: Mapping[str, int | str],
        uniforms: Uniforms,
        target: moderngl.Framebuffer,
        mode: int = moderngl.TRIANGLES,
        vertices: int = 3,
        geometry: Geometry | None = None,
        depth: str = "",
        adds: bool = False,
        instances: int = 1,
        culls: bool = False,
    ) -> None:
        """Draw a stage into a target: one triangle that fills it, unless it has its own vertices.

        geometry: triangles to draw, so many instances of them. depth: what a depth must be beside
        the one that is there, such as '<', or '1' for any; '' leaves depths alone. adds: to what
        is there. culls: triangles seen from behind. A uniform of the stage that is not given is an
        error.
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
            if isinstance(value, moderngl.Texture | moderngl.Texture3D):
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
        if depth:
            self.ctx.enable(moderngl.DEPTH_TEST)
            self.ctx.depth_func = depth
        if adds:
            self.ctx.enable(moderngl.BLEND)
            self.ctx.blend_func = moderngl.ONE, moderngl.ONE
        if culls:
            self.ctx.enable(moderngl.CULL_FACE)
        if geometry is None:
            array.render(mode, vertices=vertices)
        else:
            drawn = geometry.array(self.ctx, array.program)
            drawn.render(moderngl.TRIANGLES, instances=instances)
        if depth or adds or culls:
            self.ctx.disable(moderngl.BLEND | moderngl.DEPTH_TEST | moderngl.CULL_FACE)
            self.ctx.depth_func = "<"


def _free(array: moderngl.VertexArray) -> None:
    program = array.program
    array.release()
    program.release()
