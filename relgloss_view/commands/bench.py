"""`relgloss bench`: speed against accuracy, charted."""

from __future__ import annotations

import argparse
import json
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

from relgloss_view.atomic import whole_folder
from relgloss_view.commands.progress import Progress
from relgloss_view.commands.scene_options import size_of_text
from relgloss_view.errors import InputError
from relgloss_view.text_input import printable, read_text

if TYPE_CHECKING:
    import moderngl

SIZE = (1280, 720)
BACKENDS = ("auto", "egl", "osmesa")
FRAMES, QUICK_FRAMES = 50, 10
ERROR_WIDTH_PX, QUICK_ERROR_WIDTH_PX = 640, 320
GRAINS, QUICK_GRAINS = 512, 64
QUICK_SCENES = ("cast-coated az50", "matte-coated az110")
MAX_RESULTS_BYTES = 16 * 1024 * 1024


def add(commands: Any) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "bench",
        help="speed against accuracy of every way to draw",
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
        "--size", metavar="WxH", type=size_of_text, default=SIZE, help="in pixels, for the times"
    )
    parser.add_argument("--backend", choices=BACKENDS, default="auto", help="(default auto)")
    parser.add_argument("--json", action="store_true", help="print the numbers as JSON")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Measure beside the folder, and move the files in when the last is done."""
    from relgloss_view.bench import report
    from relgloss_view.picture.context import open_context

    folder = _checked_folder(args.output, report.RESULTS, report.FORMAT)
    with Progress("bench") as progress, whole_folder(folder, last=report.RESULTS) as temporary:
        ctx = open_context(args.backend)
        try:
            found = _measure(args, ctx, progress)
        finally:
            ctx.release()
        report.write_results(found, temporary)
    if args.json:
        print(json.dumps(found))
        return 0
    for line in report.lines(found):
        print(line)
    print(f"{printable(folder)}: {report.RESULTS} and {report.TABLE}")
    return 0


def _checked_folder(name: str, last: str, ours: str) -> Path:
    """The folder, if nothing of somebody else's stands in the way; InputError otherwise."""
    folder = Path(name)
    if not name or (os.path.lexists(folder) and not folder.is_dir()):
        found = "is a file" if name else "an empty name"
        raise InputError(f"{name or '-o'}: {found}; give the name of a folder with -o")
    results = folder / last
    if os.path.lexists(results):
        try:
            known = json.loads(read_text(results, MAX_RESULTS_BYTES, "results"))["format"]
        except (InputError, ValueError, LookupError, TypeError, RecursionError):
            known = None
        if known != ours:
            raise InputError(f"{results}: is not of a relgloss bench; choose another folder")
    return folder


def _measure(args: argparse.Namespace, ctx: moderngl.Context, progress: Progress) -> dict[str, Any]:
    from relgloss_view.bench import methods, report, run, scenes
    from relgloss_view.bench.machine import machine

    width, height = args.size
    error_width = min(width, QUICK_ERROR_WIDTH_PX if args.quick else ERROR_WIDTH_PX)
    plan = run.Plan(
        size=args.size,
        error_size=(error_width, max(1, round(error_width * height / width))),
        frames=QUICK_FRAMES if args.quick else FRAMES,
        grains=QUICK_GRAINS if args.quick else GRAINS,
    )
    cases = [c for c in scenes.cases(args.size) if not args.quick or c.name in QUICK_SCENES]
    rows = methods.rows(quick=args.quick)
    found: dict[str, Any] = {
        "format": report.FORMAT,
        "version": report.VERSION,
        "quick": args.quick,
        "machine": machine(ctx),
        "settings": {
            "size": plan.size,
            "error_size": plan.error_size,
            "frames": plan.frames,
            "grains": plan.grains,
        },
        "scenes": [],
        "results": [],
    }
    drawers = run.Drawers(ctx)
    try:
        for k, case in enumerate(cases):

            def step(share: float, text: str, k: int = k) -> bool:
                return progress((k + share) / len(cases), text)

            facts, results = run.run_case(drawers, case, rows, plan, step)
            found["scenes"].append(facts)
            found["results"] += results
        matte = next(c for c in cases if c.paper == "matte-coated")
        found["changes"] = run.time_changes(drawers, matte, plan.size, plan.frames)
    finally:
        drawers.release()
    found["methods"] = run.summary(rows, found["results"])
    return found
