"""Others that draw the same picture, timed in the same run where they are installed."""

from __future__ import annotations

import dataclasses
import statistics
import time
from collections.abc import Sequence
from typing import Any

import moderngl

from relgloss_view.base.errors import RelglossError
from relgloss_view.base.interruptions import checkpoint
from relgloss_view.base.reading import printable
from relgloss_view.base.terminal import ProgressReport
from relgloss_view.bench.peers import mitsuba_runner, scientist
from relgloss_view.bench.speed import tasks
from relgloss_view.bench.speed.floor import FillFloor
from relgloss_view.bench.speed.scenes import ChartScene, chart_scenes
from relgloss_view.bench.speed.timing import PER_VISIT, Task, take_turns
from relgloss_view.experiment.design.grid import Grid
from relgloss_view.picture.gpu.renderer import Renderer
from relgloss_view.picture.method import EXACT
from relgloss_view.picture.model.view import Size
from relgloss_view.picture.reference import ReferenceRenderer
from relgloss_view.quality.planner import advise

Found = dict[str, Any]

STIMULI_SIZE = (512, 512)
SCIENTIST = "colour-science pipeline"


def time_mitsuba(
    ctx: moderngl.Context,
    chart_scene: ChartScene,
    size: Size,
    variants: Sequence[str],
    frames: int,
    progress: ProgressReport,
) -> list[Found]:
    """Mitsuba's variants, the floor and our full frames take turns.

    `ours` is our exact frame over theirs, `auto` that of quality "auto".
    """
    renderer, floor, simpler = Renderer(ctx), FillFloor(ctx, size), Renderer(ctx)
    scene, look = chart_scene.scene, chart_scene.look
    pictures = tasks.lamp_moved(scene, look, PER_VISIT + 1)
    ours = tasks.Drawing("full frame", renderer, size, pictures, EXACT)
    method = advise(scene, look, size).method
    auto = tasks.Drawing("quality auto", simpler, size, pictures, method)
    timed: list[Task] = [tasks.Floor(floor), ours, auto]
    opened: list[mitsuba_runner.MitsubaPeer] = []
    missing: dict[str, str] = {}
    try:
        for variant in variants:
            progress(0.0, f"mitsuba {variant} starts")
            try:
                opened.append(mitsuba_runner.open_peer(variant, chart_scene, size))
            except RelglossError as error:
                missing[f"mitsuba {variant}"] = str(error)
        times = take_turns(
            [*timed, *opened], frames, progress=lambda share: progress(share, "mitsuba")
        )
    finally:
        for peer in opened:
            peer.release()
        floor.release()
        simpler.release()
        renderer.release()
    note = "1 sample a pixel, no tone mapping"
    found: list[Found] = [{"name": name, "fault": why} for name, why in missing.items()]
    for peer in opened:
        entry = {"name": peer.name, "size": size, **times[peer.name].as_dict(), "note": note}
        if entry["ms"] is not None:
            entry["floors"] = times[peer.name].over(times["floor"])
            entry["ours"] = times["full frame"].over(times[peer.name])
            entry["auto"] = times["quality auto"].over(times[peer.name])
        found.append(entry)
    return found


def time_reference(chart_scene: ChartScene, size: Size, ours_ms: float, repeats: int) -> Found:
    """The float64 spectral reference; `ours_ms` is our full frame of that size."""
    seconds = []
    for k in range(repeats):
        start = time.perf_counter()
        ReferenceRenderer().render(
            chart_scene.scene, dataclasses.replace(chart_scene.look, seed=k), size
        )
        seconds.append(time.perf_counter() - start)
    ms = 1e3 * statistics.median(seconds)
    return {
        "name": "numpy reference",
        "size": size,
        "ms": ms,
        "frames": repeats,
        "ours": ours_ms / ms,
        "note": "float64, band by band, one core",
    }


def time_scientist(ctx: moderngl.Context, paper: str, repeats: int) -> Found:
    """42 stimuli by the plain pipeline, from a few; and all 42 of ours, drawn and read back."""
    chart_scene = next(c for c in chart_scenes(STIMULI_SIZE) if c.paper == paper)
    stimuli = [(s.sigma_n_deg, s.c_fraction) for s in Grid().settings]
    checkpoint()
    try:
        scientist.load()
    except Exception as error:  # of the library, or of one that it loads: a peer that is missing
        return {"name": SCIENTIST, "fault": printable(f"{type(error).__name__}: {error}")}
    scientist.draw(chart_scene.scene, (64, 64), 1.0, 1.0, 0)  # its own first use
    seconds = []
    for seed in range(repeats):
        checkpoint()
        sigma_n_deg, c_fraction = stimuli[(7 * seed + 20) % len(stimuli)]
        start = time.perf_counter()
        scientist.draw(chart_scene.scene, STIMULI_SIZE, sigma_n_deg, c_fraction, seed)
        seconds.append(time.perf_counter() - start)
    theirs = 1e3 * len(stimuli) * statistics.median(seconds)
    ours = 1e3 * statistics.median(_draw_all(ctx, chart_scene, stimuli) for _ in range(repeats))
    return {
        "name": SCIENTIST,
        "size": STIMULI_SIZE,
        "stimuli": len(stimuli),
        "ms": theirs,
        "frames": repeats,
        "ours_ms": ours,
        "ours": ours / theirs,
        "note": f"{len(stimuli)} stimuli, from {repeats} drawn; ours {ours:.0f} ms, read back",
    }


def _draw_all(
    ctx: moderngl.Context, chart_scene: ChartScene, stimuli: Sequence[tuple[float, float]]
) -> float:
    """Seconds for all stimuli as 8-bit pictures, on a renderer that has drawn before."""
    renderer = Renderer(ctx)
    try:
        renderer.prepare(chart_scene.scene, chart_scene.look)
        start = time.perf_counter()
        for sigma_n_deg, c_fraction in stimuli:
            look = dataclasses.replace(
                chart_scene.look, sigma_n_deg=sigma_n_deg, c_fraction=c_fraction
            )
            _ = renderer.render(chart_scene.scene, look, STIMULI_SIZE).display
        return time.perf_counter() - start
    finally:
        renderer.release()
