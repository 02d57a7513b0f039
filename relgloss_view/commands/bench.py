"""`relgloss bench`: speed against accuracy, charted."""

from __future__ import annotations

import argparse
import contextlib
import io
import json
import tempfile
import time
from pathlib import Path
from typing import Any

from relgloss_view.base.reading import printable
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
        description="Draw four papers under two lamps by every method: how long it takes beside "
        "the least that two passes can cost on this machine, how far it is from the float64 "
        "spectral reference. A chart, tables, and the same numbers as JSON.",
        epilog="example: relgloss bench --quick -o chart",
    )
    parser.add_argument("-o", "--output", metavar="FOLDER", required=True)
    parser.add_argument(
        "--quick",
        action="store_true",
        help="two scenes, the main methods and few frames, in under half a minute",
    )
    parser.add_argument(
        "--stability",
        action="store_true",
        help="instead, maps of where methods fail: their errors over what a scene may have",
    )
    parser.add_argument(
        "--size", metavar="WxH", type=size_of_text, default=SIZE, help="in pixels, for the times"
    )
    parser.add_argument("--backend", choices=BACKENDS, default="auto", help="(default auto)")
    parser.add_argument("--json", action="store_true", help="print the numbers as JSON")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Measure beside the folder, and move the files in when the last is done."""
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
            found = measure(ctx, args.size, extent, lambda: _time_grid(args), progress)
        finally:
            ctx.release()
        report.write_results(found, temporary)
        chart.write_chart(found, temporary)
    if args.json:
        print(json.dumps(found))
        return 0
    for line in report.lines(found):
        print(line)
    print(f"{printable(folder)}: {', '.join(chart.CHARTS)}, {report.TABLE}, {report.RESULTS}")
    return 0


def _folder(name: str) -> Path:
    """The folder, which both kinds of a run may share."""
    from relgloss_view.bench.speed import report

    ours = {report.RESULTS: report.FORMAT, stability_maps.RESULTS: stability_maps.FORMAT}
    return own_folder(name, ours, "bench", alone=True)


def _time_grid(args: argparse.Namespace) -> float:
    """Seconds that `relgloss grid` takes for its 42 pictures, as a user would call it."""
    size = "x".join(map(str, GRID_SIZE))
    parser = argparse.ArgumentParser()
    grid.add(parser.add_subparsers())
    with tempfile.TemporaryDirectory(prefix="relgloss-") as folder:
        words = ["grid", "--size", size, "--backend", args.backend, "-o", f"{folder}/stimuli"]
        parsed = parser.parse_args(words)
        parsed.argv = words
        with contextlib.redirect_stdout(io.StringIO()):
            start = time.perf_counter()
            parsed.run(parsed)
            return time.perf_counter() - start
