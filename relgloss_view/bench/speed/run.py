"""A run of the chart: errors of every way on every scene, then their times, in turns."""

from __future__ import annotations

import dataclasses
import statistics
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import moderngl

from relgloss_view.base.errors import RelglossError
from relgloss_view.base.terminal import ProgressReport
from relgloss_view.bench.speed import errors, tasks
from relgloss_view.bench.speed.errors import Truth
from relgloss_view.bench.speed.floor import FillFloor
from relgloss_view.bench.speed.methods import AUTO, DEFAULT, EVERYTHING, Way
from relgloss_view.bench.speed.pareto import pareto_front
from relgloss_view.bench.speed.scenes import ChartScene
from relgloss_view.bench.speed.timing import PER_VISIT, Task, take_turns
from relgloss_view.picture.gpu.programs import ALL_PROGRAMS, Programs
from relgloss_view.picture.gpu.renderer import Renderer
from relgloss_view.picture.method import Method
from relgloss_view.picture.model.view import Size
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.scene import Scene

#: dE2000 below which pictures are one and the same: their digital values are.
NO_ERROR = 0.01
#: What an axis of the grain or of the samples is, in the end, an approximation of.
FURTHER_TRUTHS = {"grain-mean": "mean", "samples-4": "area", "samples-16": "area"}
Found = dict[str, Any]


@dataclass(frozen=True)
class RunSettings:
    """The sizes of a run's pictures, and how many of them it draws."""

    size: Size
    error_size: Size
    frames: int
    grains: int  #: seeds that the mean of the grain is taken over


class Drawers:
    """A renderer for each kind of target, so that taking turns allocates nothing."""

    def __init__(self, ctx: moderngl.Context) -> None:
        self.ctx = ctx
        self.programs = Programs(ctx, ALL_PROGRAMS)
        self._renderers: dict[object, Renderer] = {}

    def of(self, method: Method) -> Renderer:
        """The renderer that draws by a method."""
        kind = (method.targets, method.split, dict(method.variant).get("writes"))
        if kind not in self._renderers:
            self._renderers[kind] = Renderer(self.ctx, self.programs)
        return self._renderers[kind]

    def release(self) -> None:
        """Free everything on the device."""
        for renderer in self._renderers.values():
            renderer.release()
        self.programs.release()


def run_scene(
    drawers: Drawers,
    chart_scene: ChartScene,
    ways: Sequence[Way],
    settings: RunSettings,
    progress: ProgressReport,
) -> tuple[Found, list[Found]]:
    """The facts of a scene, and one result for each way of drawing it."""
    truths = _truths(chart_scene, ways, settings)
    results = []
    for k, way in enumerate(ways):
        progress(0.4 * k / len(ways), f"{chart_scene.name}: error, {way.label}")
        results.append(_error(drawers, chart_scene, way, truths[way.grainy], settings))
    floor = FillFloor(drawers.ctx, settings.size)
    timed: list[Task] = [tasks.Floor(floor)]
    try:
        for way in ways:
            truth = truths[way.grainy]
            method, look = way.build(truth.scene, truth.look, settings.size)
            pictures = tasks.pass_1_changed(truth.scene, look, method, PER_VISIT + 1)
            renderer = drawers.of(method)
            timed.append(tasks.Drawing(way.name, renderer, settings.size, pictures, method))
        times = take_turns(
            timed,
            settings.frames,
            progress=lambda share: progress(0.4 + 0.6 * share, f"{chart_scene.name}: times"),
        )
    finally:
        floor.release()
    floor_ms = times["floor"].median
    assert floor_ms is not None
    for way, result in zip(ways, results, strict=True):
        found = times[way.name]
        result.update(found.as_dict())
        result["floors"] = found.over(times["floor"])
        result["of_default"] = found.over(times[DEFAULT])
    return _scene_facts(chart_scene, truths[False], settings, floor_ms), results


def _truths(
    chart_scene: ChartScene, ways: Sequence[Way], settings: RunSettings
) -> dict[bool, Truth]:
    plain = Truth.of(chart_scene.scene, chart_scene.look, settings.error_size)
    grainy = chart_scene.grainy()
    if not any(way.grainy for way in ways) or grainy.look == chart_scene.look:
        return {False: plain, True: plain}
    return {False: plain, True: Truth.of(grainy.scene, grainy.look, settings.error_size)}


def _error(
    drawers: Drawers, chart_scene: ChartScene, way: Way, truth: Truth, settings: RunSettings
) -> Found:
    method, look = way.build(truth.scene, truth.look, settings.size)
    result: Found = {
        "scene": chart_scene.name,
        "method": way.name,
        "group": way.group,
        "label": way.label,
        "sigma_n_deg": look.sigma_n_deg,
        "samples_per_pixel": look.samples**2 if look.samples else None,
        "stages": dataclasses.asdict(method),
        "error": None,
    }
    renderer = drawers.of(method)
    try:
        frame = renderer.render(truth.scene, look, truth.size, method)
        result["c_max"] = frame.c_max
        if way.own_c:
            own = dataclasses.replace(look, c=errors.shown_c(frame.c_max))
            frame = renderer.render(truth.scene, own, truth.size, method)
        result["error"] = truth.errors(frame).as_dict()
        further = FURTHER_TRUTHS.get(way.name)
        if further == "area":
            finest = errors.finely_sampled(renderer, truth)
            result["error_against_area"] = finest.errors_of(
                errors.shown_lab(renderer.render(truth.scene, look, truth.size, method))
            ).as_dict()
        elif further is not None:
            apart, mean = errors.mean_of_grains(renderer, truth, range(settings.grains))
            shown = errors.shown_lab(renderer.render(truth.scene, look, truth.size, method))
            result["error_against_mean"] = mean.errors_of(shown).as_dict()
            result["mean_halves_apart"] = apart.as_dict()
    except RelglossError as error:
        result["fault"] = str(error)
    return result


def _scene_facts(
    chart_scene: ChartScene, truth: Truth, settings: RunSettings, floor_ms: float
) -> Found:
    return {
        "scene": chart_scene.name,
        "paper": chart_scene.paper,
        "lamp_azimuth_deg": chart_scene.scene.lamp.azimuth_deg,
        "sigma_n_deg": chart_scene.look.sigma_n_deg,
        "c": truth.look.c,
        "c_max": truth.c_max,
        "coverage": float(truth.on_object.mean()),
        "highlight": float(truth.highlight.mean()),
        "floor_ms": floor_ms,
    }


def time_changes(drawers: Drawers, chart_scene: ChartScene, size: Size, frames: int) -> Found:
    """What a frame takes where c, sigma_N, or the lamp alone has changed, beside the floor."""
    look = dataclasses.replace(chart_scene.look, c=1.0)
    renderer = drawers.of(Method())
    floor = FillFloor(drawers.ctx, size)
    count = PER_VISIT + 1

    def changing(name: str, pictures: list[tuple[Scene, Look]]) -> tasks.Drawing:
        return tasks.Drawing(name, renderer, size, pictures)

    try:
        times = take_turns(
            [
                tasks.Floor(floor),
                changing("c", tasks.c_changed(chart_scene.scene, look, count)),
                changing("sigma_n", tasks.sigma_n_changed(chart_scene.scene, look, count)),
                changing("lamp", tasks.lamp_moved(chart_scene.scene, look, count)),
            ],
            frames,
        )
    finally:
        floor.release()
    found: Found = {"scene": chart_scene.name}
    for name, timed in times.items():
        found[name] = {**timed.as_dict(), "floors": timed.over(times["floor"])}
    return found


def summary(ways: Sequence[Way], results: Sequence[Found]) -> list[Found]:
    """One entry for each way over all scenes: median time, worst error, and the Pareto front."""
    entries: list[Found] = []
    for way in ways:
        of_way = [result for result in results if result["method"] == way.name]
        drawn = [r for r in of_way if r["error"] is not None and r["floors"] is not None]
        if not drawn:
            continue
        p95 = [r["error"]["worst_p95"] for r in drawn]
        of_part = {
            f"{part}_p95": max((s["p95"] for r in drawn if (s := r["error"][part])), default=None)
            for part in ("object", "highlight")
        }
        c_max = [abs(v) for r in drawn if (v := r["error"]["c_max"]) is not None]
        entries.append(
            {
                "method": way.name,
                "group": way.group,
                "label": way.label,
                "scenes": len(drawn),
                "ms": statistics.median(r["ms"] for r in drawn),
                "floors": statistics.median(r["floors"] for r in drawn),
                "worst_p95": max(p95),
                **of_part,
                "median_p95": statistics.median(p95),
                "worst_max": max(s["max"] for r in drawn for s in _spreads(r)),
                "worst_c_max": max(c_max, default=None),
                "default": way.name == DEFAULT,
                "charted": way.charted,
            }
        )
    charted = [entry for entry in entries if entry["charted"]]
    front = pareto_front([(e["floors"], max(e["worst_p95"], NO_ERROR)) for e in charted])
    for entry in entries:
        entry["front"] = any(entry is charted[k] for k in front)
    return entries


def auto_against_default(results: Sequence[Found]) -> list[Found]:
    """Of each scene: how many times faster quality auto is than the default, and its errors.

    And than what draws everything, needed or not, and keeps it all.
    """
    found = []
    everything = {r["scene"]: r["of_default"] for r in results if r["method"] == EVERYTHING}
    for auto in results:
        if auto["method"] != AUTO or not (auto["error"] and auto["of_default"]):
            continue
        whole = everything.get(auto["scene"])
        found.append(
            {
                "scene": auto["scene"],
                "faster": 1.0 / auto["of_default"],
                "faster_than_everything": whole / auto["of_default"] if whole else None,
                "worst_p95": auto["error"]["worst_p95"],
                "worst_max": max(s["max"] for s in _spreads(auto)),
            }
        )
    return found


def _spreads(result: Found) -> list[Found]:
    error = result["error"]
    return [error[part] for part in ("object", "highlight") if error[part] is not None]
