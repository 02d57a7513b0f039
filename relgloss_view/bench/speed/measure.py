"""Everything that one `relgloss bench` measures, in order."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import moderngl

from relgloss_view.base.terminal import ProgressReport
from relgloss_view.bench.peers import peers
from relgloss_view.bench.peers.mitsuba_peer import VARIANTS
from relgloss_view.bench.speed import methods, run, scenes, tasks
from relgloss_view.bench.speed.machine import machine
from relgloss_view.bench.speed.passes import time_passes
from relgloss_view.bench.speed.pixels import MEGAPIXELS, time_pixels
from relgloss_view.bench.speed.report import FORMAT, VERSION
from relgloss_view.bench.speed.timing import PER_VISIT
from relgloss_view.picture.gpu.context import make_current
from relgloss_view.picture.model.view import Size

Found = dict[str, Any]

PAPER = "matte-coated"  #: of what is timed on one scene alone: it has grain, and a highlight
#: Shares of the whole time, about: the chart, then the rest.
CHART_SHARE = 0.75


@dataclass(frozen=True)
class Extent:
    """How much is measured."""

    frames: int
    error_width_px: int
    grains: int  #: seeds that the mean of the grain is taken over
    scenes: tuple[str, ...] | None = None  #: None: all
    all_ways: bool = True
    megapixels: tuple[float, ...] = MEGAPIXELS
    pixel_frames: int = 10
    variants: tuple[str, ...] = VARIANTS
    peer_frames: int = 50
    repeats: int = 3  #: of what takes seconds


FULL = Extent(frames=50, error_width_px=640, grains=512)
QUICK = Extent(
    frames=8,
    error_width_px=320,
    grains=32,
    scenes=("cast-coated az50", "matte-coated az110"),
    all_ways=False,
    megapixels=(0.25, 1.0, 4.0),
    pixel_frames=4,
    variants=("scalar_rgb", "llvm_ad_rgb"),
    peer_frames=4,
    repeats=1,
)


def measure(
    ctx: moderngl.Context,
    size: Size,
    extent: Extent,
    time_grid: Callable[[], float] | None,
    progress: ProgressReport,
) -> Found:
    """All numbers of a run; `time_grid` gives the seconds that `relgloss grid` takes."""
    all_scenes = scenes.chart_scenes(size)  # refuses sizes that can't be filled
    error_width = min(size[0], extent.error_width_px)
    settings = run.RunSettings(
        size=size,
        error_size=(error_width, max(1, round(error_width * size[1] / size[0]))),
        frames=extent.frames,
        grains=extent.grains,
    )
    shown = [c for c in all_scenes if extent.scenes is None or c.name in extent.scenes]
    ways = methods.ways(quick=not extent.all_ways)
    found: Found = {
        "format": FORMAT,
        "version": VERSION,
        "quick": extent is QUICK,
        "machine": machine(ctx),
        "settings": {
            "size": size,
            "error_size": settings.error_size,
            "frames": settings.frames,
            "grains": settings.grains,
        },
        "scenes": [],
        "results": [],
    }
    drawers = run.Drawers(ctx)
    matte = next(c for c in all_scenes if c.paper == PAPER)
    try:
        for k, chart_scene in enumerate(shown):

            def step(share: float, text: str, k: int = k) -> object:
                return progress(CHART_SHARE * (k + share) / len(shown), text)

            facts, results = run.run_scene(drawers, chart_scene, ways, settings, step)
            found["scenes"].append(facts)
            found["results"] += results
        progress(CHART_SHARE, "what changes alone")
        found["changes"] = run.time_changes(drawers, matte, size, settings.frames)
    finally:
        drawers.release()
    found["methods"] = run.summary(ways, found["results"])
    found["auto"] = run.auto_against_default(found["results"])
    moved = tasks.lamp_moved(matte.scene, matte.look, PER_VISIT + 1)
    found["passes"] = {"scene": matte.name, **time_passes(ctx, size, moved, settings.frames)}

    def later(start: float, end: float) -> ProgressReport:
        return lambda share, text: progress(start + (end - start) * share, text)

    found["pixels"] = time_pixels(
        ctx, matte, extent.megapixels, extent.pixel_frames, later(CHART_SHARE, 0.85)
    )
    found["peers"] = peers.time_mitsuba(
        ctx, matte, size, extent.variants, extent.peer_frames, later(0.85, 0.95)
    )
    if extent.all_ways:
        progress(0.95, "numpy reference")
        full_ms = found["changes"]["lamp"]["ms"]
        found["peers"].append(peers.time_reference(matte, size, full_ms, extent.repeats))
    progress(0.97, "colour-science pipeline")
    found["peers"].append(peers.time_scientist(ctx, PAPER, extent.repeats))
    if time_grid is not None:
        progress(0.98, "grid")
        seconds = sorted(time_grid() for _ in range(extent.repeats))
        found["grid"] = {"size": peers.STIMULI_SIZE, "stimuli": 42, "paper": PAPER}
        found["grid"] |= {"seconds": seconds[len(seconds) // 2], "runs": len(seconds)}
    make_current(ctx)
    return found
