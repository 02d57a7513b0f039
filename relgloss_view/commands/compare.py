"""`relgloss compare`: samples under operators side by side, and whether the gloss order is kept."""

from __future__ import annotations

import argparse
import dataclasses
import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.base.terminal import Progress
from relgloss_view.base.writing import check_writable, whole_file
from relgloss_view.commands.scene_options import add_scene_options, printable_command, scene_from

if TYPE_CHECKING:
    from relgloss_view.gloss.comparison import Comparison
    from relgloss_view.operators.operator import Operator

DEFAULT_OPERATORS = "split,clip,multiscale"
SUFFIXES = (".png", ".html")
MOST_CELLS = 200


def add(commands: Any) -> None:
    """Declare the command."""
    from relgloss_view.commands.sample_arguments import METAVAR
    from relgloss_view.gloss.comparison import DEFAULT_GLOSS, GLOSSES
    from relgloss_view.operators.registry import OPERATORS
    from relgloss_view.picture.scene.sample import SAMPLES

    parser = commands.add_parser(
        "compare",
        description="Draw samples under several tone-mapping operators on one sheet, measure what "
        "each shows (contrast, grain, sharpness, clipping, body colour) and say whether the order "
        "of the samples is that of the real materials' computed gloss.",
        epilog="example: relgloss compare -o papers.png -o papers.html; "
        "relgloss compare cast-coated mine.json=2.0,1/3 --operators split,multiscale:local=0 "
        "-o mine.png",
    )
    parser.add_argument(
        "cases",
        metavar=METAVAR,
        nargs="*",
        help=f"built-in papers or materials, with sigma_N in degrees and c as a share of c_max "
        f"(default: {', '.join(SAMPLES)} as the paper's observers chose)",
    )
    parser.add_argument(
        "-o",
        "--output",
        metavar="OUT.png|OUT.html",
        action="append",
        required=True,
        help="the sheet as a picture, or a page that holds pictures and numbers; may be repeated",
    )
    parser.add_argument(
        "--operators",
        metavar="LIST",
        default=DEFAULT_OPERATORS,
        help=f"of {', '.join(OPERATORS)}, comma between, each with parameters if need be: "
        f"multiscale:local=0:rods=true (default {DEFAULT_OPERATORS})",
    )
    parser.add_argument(
        "--gloss",
        choices=GLOSSES,
        default=DEFAULT_GLOSS,
        help=f"that orders the real materials (default {DEFAULT_GLOSS})",
    )
    add_scene_options(parser, tuned=False, sourced=False)
    parser.add_argument("--json", action="store_true", help="print the numbers as JSON")
    parser.set_defaults(run=run, wrong_usage=parser.error)


def run(args: argparse.Namespace) -> int:
    """Draw everything, write the sheets, and say what holds."""
    from relgloss_view.commands.sample_arguments import given_samples
    from relgloss_view.gloss.comparison import as_numbers, compare
    from relgloss_view.picture.scene.sample import SAMPLES
    from relgloss_view.quality.backends import open_renderer

    outputs = _checked_outputs(args.output)
    operators = operators_of(args.operators)
    scene, look, size = scene_from(args)
    look = dataclasses.replace(look, quality="exact")  # auto is measured on the split's picture
    found = given_samples(args.cases or list(SAMPLES), look)
    cases = [given.case for given in found]
    if len(cases) * len(operators) > MOST_CELLS:
        raise InputError(
            f"{len(cases)} samples x {len(operators)} operators: expected at most "
            f"{MOST_CELLS} pictures"
        )
    with Progress("compare") as progress, open_renderer(args.backend) as renderer:
        comparison = compare(
            renderer, cases, operators, scene, size, gloss=args.gloss, progress=progress
        )
    command = printable_command(args.argv)
    for output in outputs:
        _write(comparison, output, command)
    if args.json:
        print(json.dumps({"outputs": args.output, "size": list(size), **as_numbers(comparison)}))
        return 0
    told = [
        f"{g.case.label}: no settings given, so it has sigma_N 0 and c_max; "
        f"{g.sample.file}=2.0,1/3 would set others"
        for g in found
        if not g.settings
    ]
    for text in dict.fromkeys([*told, *_warnings(comparison)]):
        print(f"warning: {printable(text, 300)}", file=sys.stderr)
    print(_table(comparison))
    for output in outputs:
        print(f"{printable(output)}: written")
    return 0


def _checked_outputs(names: list[str]) -> list[Path]:
    """The places, if their endings name formats and they can be written; InputError otherwise."""
    outputs = [Path(name) for name in names]
    for output in outputs:
        if output.suffix.lower() not in SUFFIXES:
            expected = " or ".join(SUFFIXES)
            raise InputError(f"{output}: expected a name that ends in {expected}")
        check_writable(output)
    return outputs


def operators_of(text: str) -> list[Operator]:
    """Operators of words such as split,multiscale:local=0; InputError where one is none."""
    from relgloss_view.commands.operator_options import read_settings
    from relgloss_view.operators.registry import make_operator

    operators = []
    for word in text.split(","):
        name, *settings = word.strip().split(":")
        make_operator(name)  # an unknown name is told before its parameters
        operators.append(make_operator(name, read_settings(name, settings)))
    if len(set(operators)) < len(operators):
        raise InputError(f"--operators {text}: one stands there twice")
    return operators


def _write(comparison: Comparison, output: Path, command: str) -> None:
    from relgloss_view.base.version import __version__
    from relgloss_view.gloss.comparison_page import comparison_page
    from relgloss_view.gloss.comparison_sheet import comparison_sheet
    from relgloss_view.picture.output.png import save_rgb

    synthetic = all(s.case.material.synthetic for s in comparison.samples)
    title = "Is the order of gloss kept? Samples across, operators down"
    note = "All samples are synthetic. " if synthetic else ""
    note += "Contrasts and grain in L*; definitions in docs/operators.md."
    if output.suffix.lower() == ".html":
        with whole_file(output) as temporary:
            page = comparison_page(comparison, note, command)
            temporary.write_text(page, encoding="utf-8")
        return
    text = {"Software": f"relgloss {__version__}", "Title": title, "Command": command}
    save_rgb(comparison_sheet(comparison, title, note), output, text, srgb=comparison.srgb)


def _warnings(comparison: Comparison) -> list[str]:
    """What the pictures' warnings say, each with the sample and the operator it is about."""
    told: list[str] = []
    for label in comparison.rows[0].cells:
        by_operator = {row.operator.name: row.cells[label].warnings for row in comparison.rows}
        for name, texts in by_operator.items():
            for text in texts:
                everywhere = all(text in others for others in by_operator.values())
                told.append(f"{label}: {text}" if everywhere else f"{label}, {name}: {text}")
    return told


def _table(comparison: Comparison) -> str:
    """The numbers in columns, operator by operator."""
    from relgloss_view.gloss.comparison import title_of, words_of
    from relgloss_view.gloss.comparison_sheet import MEASURES, VERDICTS, body_words, number

    wide = max(len("sample"), *(len(s.case.label) for s in comparison.samples)) + 2
    lines = [f"{'sample':{wide}}{words_of(comparison.gloss):>17}{'sigma_N':>9}{'c':>8}{'c_max':>8}"]
    for s in comparison.samples:
        c_max = "-" if s.c_max is None else f"{s.c_max:.3g}"
        gloss = s.gloss[comparison.gloss]
        shown = "-" if gloss is None else f"{gloss:.4g}"
        lines.append(
            f"{s.case.label:{wide}}{shown:>17}{s.case.look.sigma_n_deg:>9.2f}{s.c:>8.3g}{c_max:>8}"
        )
    for row in comparison.rows:
        lines += ["", title_of(row.operator)]
        heads = f"{'p99':>7}{'peak':>7}{'grain':>7}{'sharp':>7}{'clipped':>9}{'body dE':>9}"
        lines.append(f"  {'':{wide}}{heads}")
        for label, cell in row.cells.items():
            m = cell.measures
            share = None if m.clipped_share is None else 100.0 * m.clipped_share
            lines.append(
                f"  {label:{wide}}{number(m.contrast_gloss):>7}{number(m.peak_contrast):>7}"
                f"{number(m.graininess, 2):>7}{number(m.sharpness, 0):>7}"
                f"{number(share) + ' %':>9}{number(m.body_difference, 2):>9}"
            )
        for name, words in MEASURES.items():
            order = row.orders[name]
            tau = "" if order.tau is None else f", tau {order.tau:.2f}"
            lines.append(f"  {words}: {VERDICTS[order.verdict]}{tau}: {order.words}")
        lines.append(f"  {body_words(row)}")
    return "\n".join(lines)
