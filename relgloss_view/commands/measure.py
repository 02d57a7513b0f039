"""`relgloss measure`: what measured tables hold and how good they are, before any fit."""

from __future__ import annotations

import argparse
import json
import os
from typing import TYPE_CHECKING, Any

from relgloss_view.base.decoration import decoration
from relgloss_view.base.interruptions import checkpoint
from relgloss_view.base.reading import printable
from relgloss_view.base.writing import check_writable, make_folder
from relgloss_view.commands import table_places
from relgloss_view.commands.table_options import add_table_options, table_options

if TYPE_CHECKING:
    from relgloss_view.fitting.purpose import Purpose
    from relgloss_view.measure.overview import Overview


def add(commands: Any) -> None:
    """Declare the command."""
    from relgloss_view.measure.readers.built_in import built_in_tables

    parser = commands.add_parser(
        "measure",
        description="Show a measured table before any fit: what was read and left out, where the "
        "mirror ridge lies, repeatability, reciprocity, saturation, spectra of a few directions, "
        "and what the table can serve for. `relgloss fit --dry-run` shows the same.",
        epilog="example: relgloss measure paper.csv -o paper.png",
    )
    parser.add_argument(
        "tables",
        nargs="+",
        metavar="TABLE|FOLDER|SAMPLE",
        help="Measured tables of any format that is read, folders of them, or built-in papers "
        f"({', '.join(built_in_tables())})",
    )
    parser.add_argument(
        "-o",
        "--report",
        metavar="OUT.png|FOLDER",
        help="Draw the table into this file; with several tables, into a file for each in this "
        "folder",
    )
    add_table_options(parser)
    parser.add_argument("--json", action="store_true", help="Print the numbers as JSON")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Show all tables; 0 where each is read and every picture asked for is drawn, else 1.

    One table's fault is the command's. Of several, each fault is one line, and the others are
    shown. Options as `relgloss fit` has them: nothing is fitted or written but the pictures.
    """
    tables = table_places.gather(args.tables)
    if not tables.several:
        place = tables.places[0]
        if args.report is not None:
            _check_picture(args.report, place)
        entry, drawn = _show(args, place, args.report)
        if args.json:
            print(json.dumps(entry))
        return 0 if drawn else 1
    if args.report is not None:
        table_places.check_folder("--report", args.report, ".png")
        make_folder(args.report)
    table_places.report_passed_over(tables)
    entries: list[dict[str, Any]] = []
    status, shown = 0, False
    stems = table_places.stems(tables.places)
    for place, stem in zip(tables.places, stems, strict=True):
        checkpoint()
        try:
            picture = None
            if args.report is not None:
                picture = table_places.output_of(args.report, stem, ".png", tables.places)
            entry, drawn = _show(args, place, picture, apart=shown)
            shown = True
            status = status if drawn else 1
        except Exception as error:
            fault = table_places.fault_of(place, error)
            table_places.print_fault(fault)
            entry, status = {"table": place, "fault": fault}, 1
        entries.append(entry)
    if args.json:
        print(json.dumps({"tables": entries, "passed_over": list(tables.passed_over)}))
    return status


def _show(
    args: argparse.Namespace, place: str, picture: str | None, *, apart: bool = False
) -> tuple[dict[str, Any], bool]:
    """Read a table, print its overview and draw it; its JSON, and whether it was drawn if asked.

    apart: below a blank line.
    """
    from relgloss_view.fitting.purpose import purpose_of
    from relgloss_view.measure.overview import look_over
    from relgloss_view.measure.overview.describe import LABEL, describe
    from relgloss_view.measure.readers import read_measurement

    overview = look_over(read_measurement(place, **table_options(args)))
    purpose = purpose_of(overview.measurement, overview.findings)
    if not args.json:
        print("\n" * apart + describe(overview))
        print(f"  {'serves for':<{LABEL}}{purpose.text}")
    drawn = picture is None or _draw(overview, purpose, picture, args.json)
    entry = {"table": place, **overview.as_json()}
    entry["serves_for"] = {"use": purpose.use, "text": purpose.text}
    entry["report"] = picture if drawn else None
    return entry, drawn


def _draw(overview: Overview, purpose: Purpose, picture: str, quiet: bool) -> bool:
    from relgloss_view.measure.overview.figure import write_overview

    with decoration(f"{picture}: the picture", "the numbers are printed") as drawn:
        write_overview(overview, picture, purpose.text)
    if drawn.done and not quiet:
        print(f"{printable(picture)}: written")
    return drawn.done


def _check_picture(picture: str, place: str) -> None:
    """InputError where the picture's name is wrong, not writable, or that of the table."""
    from relgloss_view.base.errors import InputError

    if not picture.lower().endswith(".png"):
        raise InputError(f"--report {picture or repr(picture)}: expected a name that ends in .png")
    check_writable(picture)
    table_places.output_of(os.path.dirname(picture), os.path.basename(picture), "", [place])
