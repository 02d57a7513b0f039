"""`relgloss fit`: tables of measured reflectance become materials."""

from __future__ import annotations

import argparse
import json
import os
from typing import Any

from relgloss_view.base.decoration import decoration
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.base.terminal import Progress
from relgloss_view.base.writing import check_writable
from relgloss_view.commands.fit_options import add_fit_options, fit_options
from relgloss_view.commands.table_options import add_table_options, table_options
from relgloss_view.commands.table_places import gather


def add(commands: Any) -> None:
    """Declare the command."""
    from relgloss_view.measure.readers.built_in import built_in_tables

    parser = commands.add_parser(
        "fit",
        description="Fit the Torrance-Sparrow and Oren-Nayar models to measured tables of "
        "reflectance, in any format that docs/files.md lists. Cross-validation over incidence "
        "planes chooses the smallest model that is enough; the material file keeps the evidence.",
        epilog="example: relgloss fit paper.csv -o paper.json --report paper.png; "
        "a folder of tables: relgloss fit scans/ -o materials/ --report reports/",
    )
    parser.add_argument(
        "tables",
        nargs="+",
        metavar="TABLE|FOLDER|SAMPLE",
        help="Measured tables of any format that is read, folders of them, or built-in papers "
        f"({', '.join(built_in_tables())}) for their synthetic tables",
    )
    parser.add_argument(
        "-o",
        "--output",
        metavar="MATERIAL.json|FOLDER",
        help="File of the fitted material. Several tables, or a folder of them, need a folder: "
        "each material is named after its table",
    )
    parser.add_argument(
        "--report",
        metavar="OUT.png|FOLDER",
        help="Plot data, fit and candidates into this file; with several tables, into a file for "
        "each in this folder",
    )
    parser.add_argument(
        "--dry-run",
        action="store_true",
        help="Show what the tables hold and fit nothing, as `relgloss measure` does; --report "
        "then draws that",
    )
    add_fit_options(parser)
    parser.add_argument(
        "--seed", metavar="N", type=int, default=0, help="Seed of the cross-validation (default 0)"
    )
    add_table_options(parser)
    parser.add_argument(
        "--aperture-sd-deg",
        metavar="DEG",
        type=float,
        nargs=2,
        help="Angular standard deviations of the apertures of lamp and receiver, along one axis",
    )
    parser.add_argument("--json", action="store_true", help="Print the fitted material as JSON")
    parser.set_defaults(run=run, wrong_usage=parser.error)


def run(args: argparse.Namespace) -> int:
    """Read, fit, write, and print the evidence; with several tables, a summary."""
    from relgloss_view.commands import fit_many, measure

    if args.dry_run:
        return measure.run(args)
    if args.output is None:
        args.wrong_usage("the following arguments are required: -o/--output")
    of_fit = fit_options(args)
    if args.aperture_sd_deg and not all(0.0 <= a <= 10.0 for a in args.aperture_sd_deg):
        raise InputError("--aperture-sd-deg: expected two angles of 0 to 10 degrees")
    if args.seed < 0:
        raise InputError(f"--seed {args.seed}: expected a whole number of at least 0")
    options = {
        **of_fit,
        "aperture_sd_deg": tuple(args.aperture_sd_deg) if args.aperture_sd_deg else None,
        "seed": args.seed,
    }
    tables = gather(args.tables)
    if tables.several or _is_folder(args.output):
        return fit_many.run(args, tables, options)
    return _fit_one(args, tables.places[0], options)


def _fit_one(args: argparse.Namespace, place: str, options: dict[str, Any]) -> int:
    from relgloss_view.fitting import describe_fit, fit_material, write_fit_report
    from relgloss_view.material.files import material_to_dict, save_material
    from relgloss_view.measure.readers import read_measurement

    _check_places(args, place)
    measurement = read_measurement(place, **table_options(args))
    with Progress("fit") as progress:
        material = fit_material(measurement, progress=progress, **options)
    save_material(material, args.output)
    if args.report:
        with decoration(f"{args.report}: the report", f"{args.output} is written"):
            write_fit_report(material, measurement, args.report)
    if args.json:
        print(json.dumps({"output": args.output, **material_to_dict(material)}))
        return 0
    print(describe_fit(material))
    print(f"{printable(args.output)}: written")
    return 0


def _is_folder(name: str) -> bool:
    """Whether a name of an output means a folder: it is one, or it ends as one."""
    return os.path.isdir(name) or name.endswith(("/", os.sep))


def _check_places(args: argparse.Namespace, place: str) -> None:
    """Refuse names that are wrong, the same or not writable, before the fit takes its time."""
    places = {"TABLE": place, "-o": args.output}
    if args.report is not None:
        places["--report"] = args.report
    seen: dict[str, str] = {}
    for option, path in places.items():
        suffix = {"-o": ".json", "--report": ".png"}.get(option, "")
        if not path or not path.lower().endswith(suffix):
            expected = f"a name that ends in {suffix}" if suffix else "the name of a table"
            raise InputError(f"{option} {path or repr(path)}: expected {expected}")
        if option != "TABLE":
            check_writable(path)
        real = os.path.realpath(path.replace("\0", ""))  # opening it refuses a NUL
        other = seen.setdefault(real, option)
        if other != option:
            raise InputError(
                f"{option} {path}: is the same file as {other} {places[other]}; "
                "choose another place"
            )
