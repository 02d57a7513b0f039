"""What a picture's pixels say together: extremes, the white's peak, counts; reduced on the GPU."""

from __future__ import annotations

from typing import Any

import moderngl
import numpy as np
from numpy.typing import NDArray

from relgloss_view.picture.frame import Extremes
from relgloss_view.picture.renderer.programs import Programs
from relgloss_view.picture.view import Box, Size

#: Side of the first step's tiles: small, so that a software driver's threads share the work.
FIRST_BLOCK = 4
BLOCK = 16  #: side of the further steps' tiles
#: Results of at most this side are read back; further steps would cost more than the reading.
READ_SIDE = 16


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

    def extremes(self, split: moderngl.Texture, region: Box) -> Extremes:
        """The extremes of L_d* and L_s* in a region of a split picture."""
        steps = ("measure.frag", "reduce.frag")
        names = ("extremes_image", "brightest_image")
        results = self._run(steps, {}, {"split_image": split}, names, region)
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

    def peak(self, diffuse: moderngl.Texture, region: Box) -> tuple[float, bool]:
        """The largest Y in a region of pass 1, and whether any of its pixels shows the object."""
        result = self._summed("peak.frag", diffuse, region)
        if result is None:
            return 0.0, False
        return float(np.max(result[:, 0])), bool(np.any(result[:, 1]))

    def counts(self, flags: moderngl.Texture, region: Box) -> tuple[int, int]:
        """How many pixels of a region are clipped, and how many out of gamut."""
        result = self._summed("count.frag", flags, region)
        if result is None:
            return 0, 0
        # Each result is a whole number that float32 holds; their sum may pass 2^24.
        return int(np.sum(result[:, 0], dtype=np.float64)), int(
            np.sum(result[:, 1], dtype=np.float64)
        )

    def release(self) -> None:
        """Free the pyramid."""
        for textures, framebuffer in self._steps:
            framebuffer.release()
            for texture in textures:
                texture.release()
        self._steps.clear()

    def _summed(
        self, stage: str, source: moderngl.Texture, region: Box
    ) -> NDArray[np.float32] | None:
        """A reduction that one stage does from the first step to the last."""
        extra = {"FIRST": 1}
        names = ("source_image",)
        results = self._run((stage, stage), extra, {"source_image": source}, names, region)
        return None if results is None else results[0]

    def _run(
        self,
        stages: tuple[str, str],
        extra: dict[str, int],
        sources: dict[str, Any],
        names: tuple[str, ...],
        region: Box,
    ) -> list[NDArray[np.float32]] | None:
        """Draw the steps; the last one's targets as rows of four. None for an empty region."""
        left, bottom, right, top = region
        if right <= left or top <= bottom:
            return None
        stage, block = stages[0], FIRST_BLOCK
        size = (0, 0)
        for textures, framebuffer in self._steps:
            left, bottom, right, top = region
            size = _shrunk((right - left, top - bottom), block)
            framebuffer.scissor = (0, 0, *size)
            self._programs.draw(
                stage, {"BLOCK": block, **extra}, {**sources, "region": region}, framebuffer
            )
            sources = dict(zip(names, textures, strict=False))
            region = (0, 0, *size)
            stage, block = stages[1], BLOCK
            extra = dict.fromkeys(extra, 0)
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
