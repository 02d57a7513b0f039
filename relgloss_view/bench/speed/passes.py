"""The time of each pass of a frame, by the wall clock and by the device's own where it is sane."""

from __future__ import annotations

import statistics
import time
from collections import defaultdict
from collections.abc import Mapping, Sequence
from typing import Any

import moderngl

from relgloss_view.picture.gpu.programs import Geometry, Programs, Uniforms
from relgloss_view.picture.gpu.renderer import Renderer
from relgloss_view.picture.method import EXACT
from relgloss_view.picture.model.view import Size
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.scene import Scene

#: Stages of the shaders -> the pass that they are part of.
PASS_OF = {
    "white.frag": "white",
    "peak.frag": "white",
    "shade.frag": "shade",
    "split.frag": "split",
    "measure.frag": "measure",
    "reduce.frag": "measure",
    "tone.frag": "tone",
}
#: The device's clock is believed where a frame's passes take this share of their wall time.
SANE = (0.2, 1.1)


class TimedPrograms(Programs):
    """Programs that note how long each draw takes, finished before and after."""

    def __init__(self, ctx: moderngl.Context) -> None:
        super().__init__(ctx)
        self.wall_ms: dict[str, float] = defaultdict(float)
        self.device_ms: dict[str, float] = defaultdict(float)

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
        """As Programs.draw."""
        query = self.ctx.query(time=True)
        self.ctx.finish()
        start = time.perf_counter()
        with query:
            own = mode, vertices, geometry, depth, adds, instances, culls
            super().draw(stage, defines, uniforms, target, *own)
        self.ctx.finish()
        part = PASS_OF.get(stage, stage)
        self.wall_ms[part] += 1e3 * (time.perf_counter() - start)
        self.device_ms[part] += 1e-6 * query.elapsed


def time_passes(
    ctx: moderngl.Context, size: Size, pictures: Sequence[tuple[Scene, Look]], frames: int
) -> dict[str, Any]:
    """Medians of each pass in milliseconds, over frames that draw all of them.

    `rest` is what a frame takes beside its passes: reading the extremes back, and Python.
    """
    programs = TimedPrograms(ctx)
    renderer = Renderer(ctx, programs)
    wall: dict[str, list[float]] = defaultdict(list)
    device: dict[str, list[float]] = defaultdict(list)
    try:
        for k in range(frames + 1):
            programs.wall_ms.clear()
            programs.device_ms.clear()
            start = time.perf_counter()
            scene, look = pictures[k % len(pictures)]
            renderer.render(scene, look, size, EXACT)
            ctx.finish()
            whole = 1e3 * (time.perf_counter() - start)
            if k == 0:  # compiles
                continue
            for part, ms in programs.wall_ms.items():
                wall[part].append(ms)
                device[part].append(programs.device_ms[part])
            wall["rest"].append(whole - sum(programs.wall_ms.values()))
    finally:
        renderer.release()
        programs.release()
    of_wall = {part: statistics.median(ms) for part, ms in wall.items()}
    of_device = {part: statistics.median(ms) for part, ms in device.items()}
    return {"wall_ms": of_wall, **believed(of_wall, of_device)}


def believed(wall_ms: Mapping[str, float], device_ms: Mapping[str, float]) -> dict[str, Any]:
    """The device's times, or None and the reason not to believe them."""
    drawn = sum(ms for part, ms in wall_ms.items() if part != "rest")
    share = sum(device_ms.values()) / max(drawn, 1e-9)
    if SANE[0] <= share <= SANE[1]:
        return {"device_ms": dict(device_ms), "device_clock": "sane"}
    told = f"not believed: it counts {share:.3g} of the wall time of the same passes"
    return {"device_ms": None, "device_clock": told}
