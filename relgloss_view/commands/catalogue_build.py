"""`relgloss catalogue build`: the catalogue of a tree, of which only what has changed is done."""

from __future__ import annotations

import argparse
import json
import sys
from typing import TYPE_CHECKING, Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.base.shell import command_line
from relgloss_view.base.terminal import Progress
from relgloss_view.commands.fit_options import add_fit_options, fit_options
from relgloss_view.commands.scene_options import SAMPLE_METAVAR
from relgloss_view.commands.table_options import add_table_options, table_options
from relgloss_view.commands.table_places import print_fault

if TYPE_CHECKING:
    from relgloss_view.catalogue.recipe import Recipe

LOGGED_S = 60.0  #: between two lines of a log
MOST_FAULTS = 20  #: lines on the terminal; the table has all


def add(commands: Any) -> None:
    """Declare the command."""
    from relgloss_view.gloss.samples import DEFAULT_GLOSS, GLOSSES

    parser = commands.add_parser(
        "build",
        help="fit, meter, match and draw every sample of a folder",
        description="Read every measured table, material and proof in a folder and in the folders "
        "in it. Each is fitted, metered, matched to the reference and drawn; the catalogue holds "
        "one table of all of them (Parquet, for pandas and DuckDB) and their material files. "
        "Another build does only what has changed. What is done is kept however a build ends.",
        epilog="example: relgloss catalogue build scans/ -o stock --keep-going --workers 4",
    )
    parser.add_argument("folder", metavar="FOLDER", help="Folder of tables, materials and proofs")
    parser.add_argument(
        "-o",
        "--output",
        metavar="CATALOGUE",
        required=True,
        help="Folder of the catalogue: a new or an empty one, or a catalogue to renew",
    )
    parser.add_argument(
        "--reference",
        metavar=SAMPLE_METAVAR,
        default="cast-coated",
        help="Reference sample and the setting of its picture; every thumbnail keeps its ratio of "
        "gloss to it (default cast-coated at sigma_N 0 and c_max). Another reference fits nothing "
        "again",
    )
    parser.add_argument(
        "--gloss",
        choices=GLOSSES,
        default=DEFAULT_GLOSS,
        help=f"Gloss of the materials whose ratio is kept (default {DEFAULT_GLOSS})",
    )
    add_fit_options(parser)
    add_table_options(parser)
    parser.add_argument(
        "--workers",
        metavar="N",
        type=int,
        help="Number of processes that work at once (default one for each processor); results do "
        "not depend on it",
    )
    parser.add_argument(
        "--scheduler",
        metavar="ADDRESS",
        help="Work on a running Dask cluster, tcp://HOST:PORT, whose workers see the folder under "
        "the same name",
    )
    parser.add_argument(
        "--dashboard", action="store_true", help="Serve Dask's dashboard and print its address"
    )
    parser.add_argument(
        "--keep-going",
        action="store_true",
        help="Go on after a fault of a file; all faults are listed at the end and are in the table",
    )
    parser.add_argument(
        "--retry",
        action="store_true",
        help="Try files again that have failed before, though they are unchanged",
    )
    parser.add_argument("--json", action="store_true", help="Print what was done as JSON")
    parser.set_defaults(run=run, wrong_usage=parser.error)


def run(args: argparse.Namespace) -> int:
    """Build, print the report; 1 where a file has failed."""
    from relgloss_view.catalogue.build import BuildOptions, build, words_of
    from relgloss_view.catalogue.engine import EngineOptions

    recipe = recipe_from(args)
    engine = EngineOptions(
        args.workers,
        args.scheduler,
        args.dashboard,
        report=lambda line: print(line, file=sys.stderr, flush=True),
    )
    with Progress("catalogue", LOGGED_S) as progress:
        options = BuildOptions(engine, args.keep_going, args.retry, progress)
        try:
            report = build(args.folder, args.output, recipe, options)
        except KeyboardInterrupt:
            print("what is done is kept; the same command goes on from there", file=sys.stderr)
            raise
    if args.json:
        print(json.dumps({"output": args.output, **report.as_json()}))
    else:
        print("\n".join(words_of(report, args.output)))
    for fault in report.faults[:MOST_FAULTS]:
        print_fault(fault)
    more = len(report.faults) - MOST_FAULTS
    if more > 0:
        print_fault(f"{more:,} more faults; the table has them all in its column fault")
    if not report.is_complete:
        which = "this fault" if len(report.faults) == 1 else "these faults"
        words = list(args.argv)
        words.insert(words.index("build") + 1, "--keep-going")
        print_fault(
            f"{printable(args.output)}: the table is not written, because of {which}; "
            f"{report.done:,} of {report.rows:,} files are done and kept. Mend the file and build "
            f"again, or go on without it: {command_line(['relgloss', *words])}"
        )
    return int(bool(report.faults))


def recipe_from(args: argparse.Namespace) -> Recipe:
    """The recipe of the command line; InputError where the reference is none."""
    from relgloss_view.catalogue.one_thread import one_thread
    from relgloss_view.catalogue.recipe import Recipe
    from relgloss_view.catalogue.work import material_json
    from relgloss_view.commands.sample_arguments import sample_argument
    from relgloss_view.gloss.match import absolute_c
    from relgloss_view.picture.scene.look import Look
    from relgloss_view.picture.scene.sample import SAMPLES
    from relgloss_view.picture.scene.setting import FULL_SHARE

    argument = sample_argument(args.reference, Look())
    sample = argument.sample_look
    if sample.pack is not None:
        raise InputError(
            f"--reference {printable(args.reference)}: a pack has several finishes; choose a paper "
            "or a material file"
        )
    name = args.reference.partition("=")[0]
    # Options at their defaults are left out, so that a new one fits nothing again.
    fit = {key: value for key, value in fit_options(args).items() if value not in (None, "auto")}
    with one_thread():
        c = absolute_c(sample.look, sample.material)
    full = sample.look.c is None and sample.look.setting.c_fraction == FULL_SHARE
    return Recipe(
        reference=name if name in SAMPLES else material_json(sample.material),
        reference_sigma_n_deg=sample.look.sigma_n_deg,
        reference_c=None if full else c,
        gloss=args.gloss,
        fit=fit,
        table={key: value for key, value in table_options(args).items() if value is not None},
    )
