"""`relgloss experiment analyse`: scales, bounds and verdicts from the answers of a study."""

from __future__ import annotations

import argparse
import contextlib
import json
from pathlib import Path
from typing import Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.interruptions import checkpoint
from relgloss_view.base.reading import printable
from relgloss_view.base.temporaries import scratch_folder
from relgloss_view.base.terminal import Progress, warn
from relgloss_view.base.writing import whole_folder
from relgloss_view.commands.output_folder import own_folder
from relgloss_view.commands.scene_options import printable_command


def add(commands: Any) -> None:
    """Declare the command."""
    from relgloss_view.experiment.verdict.analysis import DRAWS

    parser = commands.add_parser(
        "analyse",
        help="scales, bounds and the best setting of each sample, with a report",
        description="Pool the answers of session files and analyse them by the method of "
        "successive categories: Torgerson's condition D, and the ordinal probit model that the "
        "verdicts follow; uncertainty by drawing the observers again. -o writes a report (HTML, "
        "PNG, CSV, JSON) and a scene file of each chosen setting, which the window opens.",
        epilog="example: relgloss experiment analyse monday.sqlite tuesday.sqlite -o report",
    )
    parser.add_argument("files", metavar="FILE", nargs="+", help="Session files of one study")
    parser.add_argument("-o", "--output", metavar="FOLDER", help="Folder for the report")
    parser.add_argument(
        "--draws",
        metavar="N",
        type=int,
        default=DRAWS,
        help=f"Number of resamplings of the observers (default {DRAWS})",
    )
    parser.add_argument(
        "--seed", metavar="N", type=int, default=0, help="Seed of the resampling (default 0)"
    )
    parser.add_argument(
        "--observer-effects",
        action="store_true",
        help="Let each observer judge everything closer or farther by an amount of their own",
    )
    parser.add_argument(
        "--zero",
        choices=("clip", "drop"),
        default="clip",
        help="Treatment of proportions of 0 and 1 in condition D: clip them to 1/(2N), or drop "
        "them (default clip)",
    )
    parser.add_argument(
        "--pool-displays",
        action="store_true",
        help="Pool answers on displays that differ by more than the limits too. The report then "
        "states what differs",
    )
    parser.add_argument("--json", action="store_true", help="Print the results as JSON")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Read, analyse, write what was asked for, print."""
    from relgloss_view.experiment.report.folder import (
        PAGE,
        RESULTS,
        earlier_files,
        write_report,
    )
    from relgloss_view.experiment.report.results import FORMAT, as_numbers
    from relgloss_view.experiment.report.sentences import summary
    from relgloss_view.experiment.session.losses import warnings
    from relgloss_view.experiment.session.pool import read_pool
    from relgloss_view.experiment.verdict.analysis import MOST_DRAWS, Options, analyse

    checkpoint()  # the imports have taken a while
    if not 2 <= args.draws <= MOST_DRAWS:
        raise InputError(f"--draws {args.draws}: expected 2 to {MOST_DRAWS}")
    if not 0 <= args.seed < 2**31:
        raise InputError(f"--seed {args.seed}: expected 0 to {2**31 - 1}")
    options = Options(args.draws, args.seed, args.observer_effects, args.zero)
    folder: Path | None = None
    written: tuple[str, ...] = ()
    if args.output is not None:
        folder = own_folder(args.output, {RESULTS: FORMAT}, "experiment analyse", alone=True)
    with scratch_folder() as lamps:
        pool = read_pool(args.files, lamps, pool_displays=args.pool_displays)
        for record in pool.records:
            for line in warnings(record.losses, record.path):
                warn(line)
        for line in pool.displays.beyond:
            warn(line)
        with Progress("analyse") as progress, contextlib.ExitStack() as stack:
            # The place is tried first: an analysis takes minutes.
            place = None if folder is None else whole_folder(folder, RESULTS, earlier_files)
            temporary = None if place is None else stack.enter_context(place)
            analysis = analyse(pool, options, progress)
            if temporary is not None:
                command = printable_command(args.argv)
                written = write_report(temporary, analysis, command=command, progress=progress)
    print(json.dumps(as_numbers(analysis)) if args.json else summary(analysis))
    if folder is not None and not args.json:
        first = PAGE if PAGE in written else RESULTS
        print(f"{printable(folder)}: {first}, and the files that belong to it")
    return 0
