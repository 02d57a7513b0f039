"""`relgloss display`: what a monitor shows, from a profile, a display file or readings."""

from __future__ import annotations

import argparse
import json
from typing import TYPE_CHECKING, Any

from relgloss_view.base.decoration import decoration
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.base.shell import command_line, operand
from relgloss_view.base.terminal import warn
from relgloss_view.base.writing import check_writable
from relgloss_view.commands import display_check, display_convert, display_patches
from relgloss_view.commands.display_files import (
    DISPLAY_FILE,
    PROFILE,
    READINGS,
    beside,
    check_output,
    kind_of,
)

if TYPE_CHECKING:
    from relgloss_view.display.few_readings import Agreement
    from relgloss_view.display.fit import DisplayFit
    from relgloss_view.display.monitor import Monitor
    from relgloss_view.display.readings import Readings

SHOW = "show"  #: the command that is meant where its word is left out (cli.OWN_COMMANDS)
REPORTS = (".html", ".png")
WARNING = 600  #: characters
SEED = 0


def add(commands: Any) -> None:
    """Declare the command and its own commands."""
    parser = commands.add_parser(
        "display",
        usage="relgloss display FILE [READINGS] [-o MONITOR.toml] [--report OUT] [--json]\n"
        "       relgloss display COMMAND ...",
        description="Show what a monitor shows: white, black, contrast, gamut and gamma, from an "
        "ICC profile, a display file, or readings, which are fitted. `relgloss display show "
        "--help` explains the options.",
        epilog="example: relgloss display monitor.icc; relgloss display readings.ti3 -o "
        "monitor.toml --report monitor.html; relgloss snapshot --display monitor.toml -o paper.png",
    )
    own = parser.add_subparsers(dest="display_command", metavar="FILE|COMMAND", required=True)
    _add_show(own)
    display_check.add(own)
    display_convert.add(own)
    display_patches.add(own)


def _add_show(own: Any) -> None:
    show = own.add_parser(
        SHOW,
        prog="relgloss display",
        help="show what a monitor shows; this is meant where no command is named",
        description="Show what a monitor shows. Readings are fitted, and the display file that -o "
        "writes holds the model. A profile with a few readings after it gets its luminance and "
        "black from them, and is checked against them.",
        epilog="example: relgloss display readings.ti3 -o monitor.toml --report monitor.html",
    )
    show.add_argument(
        "file",
        metavar="FILE",
        help="ICC profile, display file, or readings: .ti3 of Argyll, or a table (CSV) with the "
        "columns R,G,B,X,Y,Z or R,G,B,x,y,Y",
    )
    show.add_argument(
        "readings",
        metavar="READINGS",
        nargs="?",
        help="A few readings of the profile's monitor: white, black, and some colours to check",
    )
    show.add_argument(
        "-o",
        "--output",
        metavar="MONITOR.toml",
        help="Display file to write, which --display and scene files name",
    )
    show.add_argument(
        "--report",
        metavar="OUT.html|OUT.png",
        help="Draw tone curves, gamut and errors into this file",
    )
    show.add_argument(
        "--seed", type=int, default=SEED, help=f"Seed of the cross-validation (default {SEED})"
    )
    show.add_argument("--json", action="store_true", help="Print the numbers as JSON")
    show.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Show the file, and write what was asked for; 1 where the report was not drawn."""
    from relgloss_view.display.few_readings import with_readings
    from relgloss_view.display.fit import fit_display
    from relgloss_view.display.read import monitor_of
    from relgloss_view.display.readings import read_readings

    if args.seed < 0:
        raise InputError(f"--seed {args.seed}: expected a whole number of 0 or more")
    _check_places(args)
    kind, second = kind_of(args.file), args.readings
    fit, readings, agreement = None, None, None
    if kind == READINGS:
        if second is not None:
            raise InputError(
                f"{printable(args.file)}: these are readings already; join both files, or give the "
                "profile of the monitor first"
            )
        readings = read_readings(args.file)
        fit = fit_display(readings, args.seed)
        monitor = fit.monitor
    else:
        monitor = monitor_of(args.file)
        if second is not None:
            if kind_of(second) != READINGS:
                raise InputError(f"{printable(second)}: expected readings after the profile")
            readings = read_readings(second)
            monitor, agreement = with_readings(monitor, readings)
    written = _write(args, kind, monitor, fit)
    drawn = args.report is None or _draw(args, monitor, fit, readings)
    if args.json:
        print(json.dumps(_json(args, kind, monitor, fit, agreement, written, drawn)))
    else:
        _print(args, monitor, fit, agreement, written, drawn)
    return 0 if drawn else 1


def _check_places(args: argparse.Namespace) -> None:
    """InputError where an output can't be written, before anything is read or fitted."""
    sources = [args.file] + ([] if args.readings is None else [args.readings])
    for source in sources:
        kind_of(source)
    check_output(args.output, sources)
    if args.report is None:
        return
    if not args.report.lower().endswith(REPORTS):
        named = args.report or repr(args.report)
        raise InputError(f"--report {named}: expected a name that ends in .html or .png")
    check_writable(args.report)


def _write(
    args: argparse.Namespace, kind: str, monitor: Monitor, fit: DisplayFit | None
) -> str | None:
    """Write the display file; its name, or None where none was asked for."""
    from relgloss_view.display.display_file import write_display

    if args.output is None:
        return None
    if kind == PROFILE:
        write_display(args.output, monitor, profile=beside(args.output, args.file))
    elif kind == DISPLAY_FILE and monitor.beside:
        write_display(args.output, monitor, profile=beside(args.output, monitor.beside[0]))
    else:
        write_display(args.output, monitor, fit)
    return str(args.output)


def _draw(
    args: argparse.Namespace,
    monitor: Monitor,
    fit: DisplayFit | None,
    readings: Readings | None,
) -> bool:
    from relgloss_view.display.report import write_report

    kept = f"{args.output} is written" if args.output is not None else "the numbers are printed"
    with decoration(f"{args.report}: the report", kept) as drawn:
        command = command_line(["relgloss", *args.argv])
        write_report(args.report, monitor, fit, readings, command)
    return drawn.done


def _print(
    args: argparse.Namespace,
    monitor: Monitor,
    fit: DisplayFit | None,
    agreement: Agreement | None,
    written: str | None,
    drawn: bool,
) -> None:
    from relgloss_view.display.describe import describe, describe_fit, line
    from relgloss_view.display.overview import overview_of

    overview = overview_of(monitor)
    print(describe(overview, () if fit is None else fit.notes))
    if fit is not None:
        print(describe_fit(fit))
    if agreement is not None:
        words = f"dE2000 mean {agreement.mean:.2f}, largest {agreement.largest:.2f}"
        print(line("readings", f"{agreement.patches}: {words} ({agreement.place})"))
    if written is not None:
        print(f"{printable(written)}: written")
        use = ["relgloss", "snapshot", "--display", operand(written), "-o", "paper.png"]
        print(f"  {command_line(use)}")
    if args.report is not None and drawn:
        print(f"{printable(args.report)}: written")
    for text in _warnings(fit, agreement):
        warn(text, WARNING)


def _warnings(fit: DisplayFit | None, agreement: Agreement | None) -> tuple[str, ...]:
    warnings = () if fit is None else fit.warnings
    if agreement is not None and not agreement.agrees:
        warnings += (
            f"The profile does not describe these readings: they differ by dE2000 "
            f"{agreement.mean:.1f} on average. It is of another monitor or setting, or its "
            "calibration was not loaded; measure about 100 patches and fit them.",
        )
    return warnings


def _json(
    args: argparse.Namespace,
    kind: str,
    monitor: Monitor,
    fit: DisplayFit | None,
    agreement: Agreement | None,
    written: str | None,
    drawn: bool,
) -> dict[str, Any]:
    from relgloss_view.display.describe import fit_as_json
    from relgloss_view.display.overview import overview_of

    numbers: dict[str, Any] = {"file": args.file, "kind": kind}
    numbers |= overview_of(monitor).as_json()
    numbers["fit"] = None if fit is None else fit_as_json(fit)
    numbers["readings"] = None
    if agreement is not None:
        numbers["readings"] = {
            "file": args.readings,
            "patches": agreement.patches,
            "mean_de2000": agreement.mean,
            "largest_de2000": agreement.largest,
            "agrees": agreement.agrees,
        }
    numbers["warnings"] = list(_warnings(fit, agreement))
    numbers["output"] = written
    numbers["report"] = args.report if drawn else None
    return numbers
