"""`relgloss display check`: whether a monitor still shows what its file describes."""

from __future__ import annotations

import argparse
import json
import math
from typing import Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.commands.display_files import READINGS, kind_of

FAILED = 1  #: exit status where --fail-above finds more


def add(own: Any) -> None:
    """Declare the command among those of `relgloss display`."""
    parser = own.add_parser(
        "check",
        help="compare a profile or display file with new readings",
        description="Compare a profile or display file with new readings of the monitor. The "
        "verdict is printed; the exit status is 0 also where the monitor has drifted, unless "
        "--fail-above is given.",
        epilog="example: relgloss display check monitor.toml new.ti3",
    )
    parser.add_argument("file", metavar="FILE", help="ICC profile or display file")
    parser.add_argument(
        "readings", metavar="READINGS", help="New readings (.ti3, or CSV with R,G,B,X,Y,Z)"
    )
    parser.add_argument(
        "--fail-above",
        metavar="DE",
        type=float,
        help="End with status 1 where the mean dE2000 is above this, for scripts",
    )
    parser.add_argument("--json", action="store_true", help="Print the check as JSON")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Compare and print; 1 where --fail-above was given and the mean is above it."""
    from relgloss_view.display.check import check_display
    from relgloss_view.display.few_readings import with_own_black
    from relgloss_view.display.read import monitor_of
    from relgloss_view.display.readings import read_readings

    limit = args.fail_above
    if limit is not None and not (math.isfinite(limit) and limit >= 0.0):
        raise InputError(f"--fail-above {limit:g}: expected a colour difference of 0 or more")
    if kind_of(args.readings) != READINGS:
        raise InputError(
            f"{printable(args.readings)}: expected readings here; the profile or display file is "
            "named first"
        )
    monitor = monitor_of(args.file)
    found = check_display(with_own_black(monitor), read_readings(args.readings))
    failed = limit is not None and found.mean > limit
    if args.json:
        numbers = {
            "file": args.file,
            "readings": args.readings,
            "verdict": found.verdict,
            "patches": len(found.differences),
            "mean_de2000": found.mean,
            "p95_de2000": found.p95,
            "largest_de2000": found.largest,
            "largest_at": found.worst,
            "luminance_drift": found.luminance_drift,
            "white_shift_de2000": found.white_shift,
            "white_xy": list(found.white_xy),
            "black_share": found.black_share,
            "expected_black_share": found.expected_black_share,
            "gamma": found.gamma,
            "expected_gamma": found.expected_gamma,
            "sentences": list(found.sentences),
            "failed": failed,
        }
        print(json.dumps(numbers))
    else:
        words = f"mean dE2000 {found.mean:.2f}, largest {found.largest:.2f} ({found.worst})"
        print(f"{printable(monitor.name, 80)}: {found.verdict}, {words}")
        for sentence in found.sentences:
            print(f"  {printable(sentence, 600)}")
    return FAILED if failed else 0
