"""Time against the number of pixels: is it a straight line?"""

from __future__ import annotations

import dataclasses
import math
import statistics
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import moderngl
import numpy as np

from relgloss_view.base.errors import RelglossError
from relgloss_view.base.room import available_bytes
from relgloss_view.base.terminal import ProgressReport
from relgloss_view.bench.speed.floor import FillFloor
from relgloss_view.bench.speed.scenes import ChartScene
from relgloss_view.bench.speed.tasks import Drawing, Floor, pass_1_changed
from relgloss_view.bench.speed.timing import PER_VISIT, Times, take_turns
from relgloss_view.picture.gpu.memory import device_bytes
from relgloss_view.picture.gpu.programs import ALL_PROGRAMS, Programs
from relgloss_view.picture.gpu.renderer import Renderer
from relgloss_view.picture.method import EXACT
from relgloss_view.picture.model.view import Size

MEGAPIXELS = (0.25, 1.0, 4.0, 9.0, 16.0, 33.0)
FLOOR_SIZE = (1280, 720)
TOLERANCE = 0.15  #: of the line
DRIVERS_SHARE = 1.15  #: what the driver keeps beside the targets
SHARE_OF_MEMORY = 0.6  #: at most


@dataclass(frozen=True)
class Line:
    """t = start + slope n, fitted in relative error."""

    start_ms: float
    slope_ms: float  #: per megapixel
    residuals: tuple[float, ...]  #: relative, of each point

    @property
    def straight(self) -> bool:
        """Whether every point lies within the tolerance."""
        return all(abs(r) <= TOLERANCE for r in self.residuals)


def fit_line(megapixels: Sequence[float], ms: Sequence[float]) -> Line:
    """The line with the least squares of relative error; no cost at no pixels is below zero."""
    n, t = np.asarray(megapixels, dtype=np.float64), np.asarray(ms, dtype=np.float64)
    columns = np.stack([np.ones_like(n), n], axis=-1) / t[:, None]
    start, slope = np.linalg.lstsq(columns, np.ones_like(t), rcond=None)[0]
    if start < 0.0:
        start, slope = 0.0, float(np.sum(n / t) / np.sum((n / t) ** 2))
    residuals = t / (start + slope * n) - 1.0
    return Line(float(start), float(slope), tuple(float(r) for r in residuals))


def size_of(megapixels: float, aspect: float = 16.0 / 9.0) -> Size:
    """A picture of about so many pixels, its sides multiples of eight."""
    height = max(8, 8 * round(math.sqrt(1e6 * megapixels / aspect) / 8))
    return max(8, 8 * round(height * aspect / 8)), height


def time_pixels(
    ctx: moderngl.Context,
    chart_scene: ChartScene,
    megapixels: Sequence[float],
    frames: int,
    progress: ProgressReport,
) -> dict[str, Any]:
    """Frames of all passes but the white's at each size, going up, then down.

    A floor of FLOOR_SIZE takes turns with each, and `steady_ms` is what a frame would take were the
    machine always as fast as it is in the median: slow spells would bend the line.
    """
    programs = Programs(ctx, ALL_PROGRAMS)
    floor, floors = FillFloor(ctx, FLOOR_SIZE), {m: Times() for m in megapixels}
    half = max(PER_VISIT, frames // 2)
    times: dict[float, Times] = {m: Times() for m in megapixels}
    try:
        for k, m in enumerate((*megapixels, *reversed(megapixels))):
            progress(k / (2 * len(megapixels)), f"{m:g} megapixels")
            if not times[m].fault:
                _time_size(ctx, programs, chart_scene, m, half, (times[m], floors[m]), floor)
    finally:
        floor.release()
        programs.release()
    floor_ms = statistics.median(ms for m in megapixels for ms in floors[m].ms or [0.0])
    rows: list[dict[str, Any]] = []
    for m in megapixels:
        size = size_of(m)
        row = {"size": size, "megapixels": 1e-6 * size[0] * size[1], **times[m].as_dict()}
        ratio = times[m].over(floors[m])
        rows.append({**row, "steady_ms": None if ratio is None else ratio * floor_ms})
    held = [row for row in rows if row["ms"] is not None]
    found: dict[str, Any] = {"tolerance": TOLERANCE, "sizes": rows}
    if len(held) > 2:
        line = fit_line([row["megapixels"] for row in held], [row["steady_ms"] for row in held])
        for row, residual in zip(held, line.residuals, strict=True):
            row["residual"] = residual
        fields = dataclasses.asdict(line)
        del fields["residuals"]
        found["line"] = {**fields, "straight": line.straight}
    return found


def _time_size(
    ctx: moderngl.Context,
    programs: Programs,
    chart_scene: ChartScene,
    megapixels: float,
    frames: int,
    into: tuple[Times, Times],
    floor: FillFloor,
) -> None:
    of_frame, of_floor = into
    size = size_of(megapixels)
    free = available_bytes()
    needed = DRIVERS_SHARE * device_bytes(size)
    if free is not None and needed > SHARE_OF_MEMORY * free:
        of_frame.fault = (
            f"needs about {needed / 1e9:.1f} GB of memory, {free / 1e9:.1f} GB are free"
        )
        return
    renderer = Renderer(ctx, programs)
    pictures = pass_1_changed(chart_scene.scene, chart_scene.look, EXACT, PER_VISIT + 1)
    task = Drawing("frame", renderer, size, pictures)
    try:
        task.warm()  # the device clears new memory as it is first written
        found = take_turns([Floor(floor), task], frames)
        of_frame.fault = found["frame"].fault
        if not of_frame.fault:
            for name, held in (("frame", of_frame), ("floor", of_floor)):
                held.ms += found[name].ms
                held.visits += found[name].visits
    except RelglossError as error:
        of_frame.fault = str(error)
    finally:
        renderer.release()
