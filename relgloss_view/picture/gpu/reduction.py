"""Numbers over all pixels of a picture, reduced on the GPU: extremes, the white's peak, counts."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import moderngl
import numpy as np
from numpy.typing import NDArray

from relgloss_view.picture.frame import Extremes
from relgloss_view.picture.gpu.programs import Programs, Uniforms
from relgloss_view.picture.gpu.uniforms import per_size
from relgloss_view.picture.model.view import Box, Size

#: Side of the first step's tiles: small, so that a software driver's threads share the work.
FIRST_BLOCK = 4
BLOCK = 16  #: side of the further steps' tiles
#: Results of at most this side are read back; further steps would cost more than the reading.
READ_SIDE = 16


class ReductionStep(NamedTuple):
    """What draws one step."""

    stage: str
    defines: Mapping[str, int | str]
    uniforms: Uniforms


class Reduction:
    """A pyramid of small float targets over pictures of one size."""

    def __init__(self, ctx: moderngl.Context, programs: Programs) -> None:
        self.ctx = ctx
        self._programs = programs
        self._steps: list[tuple[tuple[moderngl.Texture, ...], moderngl.Framebuffer]] = []

    def resize(self, size: Size) -> None:
        """Make room for pictures of a size; `release` comes before."""
        block = FIRST_BLOCK
        while not self._steps or max(size) > READ_SIDE:
            size = _shrunk(size, block)
            textures = tuple(self.ctx.texture(size, 4, dtype="f4") for _ in range(2))
            self._steps.append((textures, self.ctx.framebuffer(textures)))
            block = BLOCK

    def extremes(self, split: moderngl.Texture, region: Box, stride: int = 1) -> Extremes:
        """The extremes of L_d* and L_s* in a region of a split picture, by every so many pixels."""
        first = ReductionStep(
            "measure.frag", {"STRIDE": stride}, {"split_image": split, **per_size(split.size)}
        )
        names = ("extremes_image", "brightest_image")
        results = self._run(first, "reduce.frag", names, region, stride=stride)
        if results is None:
            return Extremes.of_nothing()
        extremes, brightest = results
        not_finite = int(np.sum(brightest[:, 3]))
        top = brightest[np.argmax(brightest[:, 0])]
        if top[0] < -1e29 and not not_finite:
            return Extremes.of_nothing()
        return Extremes(
            smallest_ratio=float(np.min(extremes[:, 0])),
            l_d_max=float(np.max(extremes[:, 1])),
            l_s_max=float(np.max(extremes[:, 2])),
            brightest_l_d=float(top[1]),
            brightest_l_s=float(top[2]),
            not_finite=not_finite,
        )

    def white(
        self, defines: Mapping[str, int | str], uniforms: Uniforms, region: Box
    ) -> tuple[float, int]:
        """The perfect diffuser's largest Y in a region, and how many pixels show the object."""
        first = ReductionStep("white.frag", defines, uniforms)
        result = self._run(first, "peak.frag", ("source_image",), region)
        if result is None:
            return 0.0, 0
        return float(np.max(result[0][:, 0])), int(result[0][:, 1].sum(dtype=np.float64))

    def counts(self, display: moderngl.Texture, region: Box) -> tuple[int, int]:
        """How many pixels of a region are clipped, and how many out of gamut."""
        first = ReductionStep("count.frag", {"FIRST": 1}, {"source_image": display})
        result = self._run(first, "count.frag", ("source_image",), region, {"FIRST": 0})
        if result is None:
            return 0, 0
        # Each result is a whole number that float32 holds; their sum may pass 2^24.
        sums = result[0].sum(axis=0, dtype=np.float64)
        return int(sums[0]), int(sums[1])

    def release(self) -> None:
        """Free the pyramid."""
        for textures, framebuffer in self._steps:
            framebuffer.release()
            for texture in textures:
                texture.release()
        self._steps.clear()

    def _run(
        self,
        step: ReductionStep,
        further: str,
        names: tuple[str, ...],
        region: Box,
        defines: Mapping[str, int | str] | None = None,
        stride: int = 1,
    ) -> list[NDArray[np.float32]] | None:
        """Draw a first step over a region, then further ones over the results, known by `names`.

        Returns the last one's targets as rows of four; None for an empty region.
        """
        left, bottom, right, top = region
        if right <= left or top <= bottom:
            return None
        block, size = FIRST_BLOCK, (0, 0)
        for textures, framebuffer in self._steps:
            left, bottom, right, top = region
            size = _shrunk((right - left, top - bottom), block * stride)
            framebuffer.scissor = (0, 0, *size)
            constants = {"BLOCK": block, **step.defines}
            self._programs.draw(
                step.stage, constants, {**step.uniforms, "region": region}, framebuffer
            )
            images = dict(zip(names, textures, strict=False))
            step = ReductionStep(further, defines or {}, images)
            block, stride, region = BLOCK, 1, (0, 0, *size)
        _, framebuffer = self._steps[-1]
        return [
            np.frombuffer(
                framebuffer.read((0, 0, *size), components=4, attachment=k, dtype="f4"),
                dtype=np.float32,
            ).reshape(-1, 4)
            for k in range(len(names))
        ]


def _shrunk(size: Size, block: int) -> Size:
    return -(-size[0] // block), -(-size[1] // block)
