"""`relgloss bench`: speed against accuracy, charted."""

from __future__ import annotations

import argparse
import contextlib
import io
import json
import time
from pathlib import Path
from typing import Any

from relgloss_view.base.decoration import decoration
from relgloss_view.base.reading import printable
from relgloss_view.base.temporaries import scratch_folder
from relgloss_view.base.terminal import Progress
from relgloss_view.base.writing import whole_folder
from relgloss_view.commands import grid, stability_maps
from relgloss_view.commands.output_folder import own_folder
from relgloss_view.commands.scene_options import size_of_text

SIZE = (1280, 720)
BACKENDS = ("auto", "egl", "osmesa")
GRID_SIZE = (512, 512)


def add(commands: Any) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "bench",
        description="Draw four papers under two lamps by every method. Each time is compared with "
        "the least that two passes can take on this machine, each picture with the float64 "
        "spectral reference. Writes a chart, a table and all numbers as JSON.",
        epilog="example: relgloss bench --quick -o chart",
    )
    parser.add_argument(
        "-o", "--output", metavar="FOLDER", required=True, help="Folder for charts and numbers"
    )
    parser.add_argument(
        "--quick",
        action="store_true",
        help="Draw two scenes by the main methods in few frames; takes under half a minute",
    )
    parser.add_argument(
        "--stability",
        action="store_true",
        help="Map where methods fail instead: their errors over the range of scenes",
    )
    parser.add_argument(
        "--size",
        metavar="WxH",
        type=size_of_text,
        default=SIZE,
        help="Size in pixels of the pictures that are timed (default 1280x720)",
    )
    parser.add_argument(
        "--backend",
        choices=BACKENDS,
        default="auto",
        help="OpenGL context that draws (default auto)",
    )
    parser.add_argument("--json", action="store_true", help="Print the numbers as JSON")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Measure, and write the files beside the folder until the last is done."""
    if args.stability:
        maps = _folder(args.output)
        quick, as_json = bool(args.quick), bool(args.json)
        return stability_maps.run(maps, args.backend, quick=quick, as_json=as_json)
    from relgloss_view.bench.speed import chart, report
    from relgloss_view.bench.speed.measure import FULL, QUICK, measure
    from relgloss_view.picture.gpu.context import open_context

    folder = _folder(args.output)
    with Progress("bench") as progress, whole_folder(folder, last=report.RESULTS) as temporary:
        ctx = open_context(args.backend)
        try:
            extent = QUICK if args.quick else FULL
            results = measure(ctx, args.size, extent, lambda: _time_grid(args), progress)
        finally:
            ctx.release()
        report.write_results(results, temporary)
        charts = [temporary / name for name in chart.CHARTS]
        kept = f"{report.RESULTS} has all numbers"
        with decoration(chart.CHARTS[0], kept, files=charts) as drawn:
            chart.write_chart(results, temporary)
    if args.json:
        print(json.dumps(results))
        return 0
    for line in report.lines(results):
        print(line)
    written = [*(chart.CHARTS if drawn.done else ()), report.TABLE, report.RESULTS]
    print(f"{printable(folder)}: {', '.join(written)}")
    return 0


def _folder(name: str) -> Path:
    """The output folder, which the two kinds of runs may share."""
    from relgloss_view.bench.speed import report

    ours = {report.RESULTS: report.FORMAT, stability_maps.RESULTS: stability_maps.FORMAT}
    return own_folder(name, ours, "bench", alone=True)


def _time_grid(args: argparse.Namespace) -> float:
    """Seconds that `relgloss grid` takes for its 42 pictures, as a user would call it."""
    size = "x".join(map(str, GRID_SIZE))
    parser = argparse.ArgumentParser()
    grid.add(parser.add_subparsers())
    with scratch_folder() as folder:
        words = ["grid", "--size", size, "--backend", args.backend, "-o", f"{folder}/stimuli"]
        parsed = parser.parse_args(words)
        parsed.argv = words
        with contextlib.redirect_stdout(io.StringIO()):
            start = time.perf_counter()
            parsed.run(parsed)
            return time.perf_counter() - start
