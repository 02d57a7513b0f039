"""Strip: some rows of a stage that is drawn on request, so that all of it needs no memory."""

from __future__ import annotations

from typing import Any

import moderngl

from relgloss_view.base.arrays import AnyArray
from relgloss_view.picture.gpu.drawing import Drawing
from relgloss_view.picture.gpu.programs import Programs
from relgloss_view.picture.gpu.targets import CLEARED, Targets
from relgloss_view.picture.model.view import Size


class Strip:
    """Targets as wide as the picture that hold some of its rows."""

    def __init__(self, ctx: moderngl.Context, programs: Programs) -> None:
        self._programs = programs
        self._targets = Targets(ctx)
        self._present: dict[tuple[str, ...], tuple[object, slice]] = {}

    def holds(self, targets: tuple[str, ...], asked: object, rows: slice) -> bool:
        """Whether these targets show these rows of what was asked for."""
        return self._present.get(targets) == (asked, rows)

    def draw(self, drawing: Drawing, size: Size, asked: object, rows: slice) -> None:
        """Draw some rows, counted from the top, of a picture of a size.

        asked: all that the pixels follow from. Raises InputError where the device has no memory.
        """
        width, count = size[0], rows.stop - rows.start
        held = self._targets.size
        if held is None or held[0] != width or held[1] < count:
            self.release()
            self._targets.resize((width, count))
        self._present.pop(drawing.targets, None)
        framebuffer: Any = self._targets.framebuffer(drawing.targets)
        for target in drawing.targets:
            if target in CLEARED:
                cleared: Any = self._targets.framebuffer((target,))
                cleared.scissor = None
                cleared.use()
                cleared.clear(*CLEARED[target])
        lowest = size[1] - rows.stop
        left, bottom, right, top = drawing.bounds or (0, 0, *size)
        bottom, top = max(bottom, lowest), min(top, lowest + count)
        if right > left and top > bottom:
            bounds = left, bottom, right, top
            tiles = ((bounds, {}),) if drawing.tiles is None else drawing.tiles(bounds)
            for (left, bottom, right, top), surface in tiles:
                framebuffer.scissor = (left, bottom - lowest, right - left, top - bottom)
                uniforms = {**drawing.uniforms, **surface, "lowest_row": lowest}
                self._programs.draw(drawing.stage, drawing.defines, uniforms, framebuffer)
        self._present[drawing.targets] = asked, rows

    def read(self, stage: str, count: int) -> AnyArray:
        """A stage's rows as they were last drawn, (count, W, components), from the top."""
        assert self._targets.size is not None
        height = self._targets.size[1]
        return self._targets.read(stage, slice(height - count, height))

    def bytes(self) -> int:
        """Bytes of the targets."""
        return self._targets.bytes()

    def release(self) -> None:
        """Free the targets; they are made again for the next rows."""
        self._present.clear()
        self._targets.release()
