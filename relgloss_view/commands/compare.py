"""`relgloss compare`: samples under several operators, and whether the gloss order is kept."""

from __future__ import annotations

import argparse
import dataclasses
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from relgloss_view.base.decoration import decoration
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.base.terminal import Column, Progress, table, warn
from relgloss_view.base.words import sentence_case
from relgloss_view.base.writing import check_writable, together, whole_file
from relgloss_view.commands.matched import add_reference_option, reference_look
from relgloss_view.commands.outputs import files_behind, refuse_read
from relgloss_view.commands.scene_options import (
    SAMPLE_METAVAR,
    add_scene_options,
    colour_from,
    printable_command,
    scene_from,
)
from relgloss_view.picture.pair import ratio_words

if TYPE_CHECKING:
    from collections.abc import Sequence

    from relgloss_view.gloss.comparison import Comparison, OperatorRow
    from relgloss_view.gloss.match import Reference
    from relgloss_view.operators.operator import Operator

DEFAULT_OPERATORS = "split,clip,multiscale"
SUFFIXES = (".png", ".html")
MOST_CELLS = 200


def add(commands: Any) -> None:
    """Declare the command."""
    from relgloss_view.gloss.samples import DEFAULT_GLOSS, GLOSSES
    from relgloss_view.operators.registry import OPERATORS
    from relgloss_view.picture.scene.sample import SAMPLES

    parser = commands.add_parser(
        "compare",
        description="Draw samples under several tone-mapping operators on one sheet, measure each "
        "picture (contrast, grain, sharpness, clipping, body colour), and check whether the "
        "displayed gloss orders the samples as the computed gloss of the real materials does.",
        epilog="example: relgloss compare -o papers.png -o papers.html; "
        "relgloss compare cast-coated mine.json=2.0,1/3 --operators split,multiscale:local=0 "
        "-o mine.png",
    )
    parser.add_argument(
        "sample_words",  # --samples is another option
        metavar=SAMPLE_METAVAR,
        nargs="*",
        help="Built-in papers or material files. A setting follows =: sigma_N in degrees, c as a "
        "share of c_max. Without one, c keeps the ratio of gloss to the reference (default "
        f"{', '.join(SAMPLES)})",
    )
    add_reference_option(parser)
    parser.add_argument(
        "--published",
        action="store_true",
        help="Draw the built-in papers with the settings that the paper's observers chose, c as a "
        "share of c_max",
    )
    parser.add_argument(
        "-o",
        "--output",
        metavar="OUT.png|OUT.html",
        action="append",
        required=True,
        help="Sheet as one picture, or page with pictures and numbers; may be repeated",
    )
    parser.add_argument(
        "--operators",
        metavar="LIST",
        default=DEFAULT_OPERATORS,
        help=f"Operators with commas between them, of {', '.join(OPERATORS)}. Parameters follow "
        f"colons: multiscale:local=0:rods=true (default {DEFAULT_OPERATORS})",
    )
    parser.add_argument(
        "--gloss",
        choices=GLOSSES,
        default=DEFAULT_GLOSS,
        help=f"Computed gloss that orders the real materials (default {DEFAULT_GLOSS})",
    )
    add_scene_options(parser, tuned=False, sourced=False)
    parser.add_argument("--json", action="store_true", help="Print the numbers as JSON")
    parser.set_defaults(run=run, wrong_usage=parser.error)


def run(args: argparse.Namespace) -> int:
    """Draw everything, write the sheets, and print the verdicts."""
    from relgloss_view.commands.sample_arguments import sample_arguments
    from relgloss_view.gloss.comparison import as_numbers, compare
    from relgloss_view.gloss.match import Reference
    from relgloss_view.picture.model.pixel_sampling import sample_count
    from relgloss_view.picture.peak import check_picture
    from relgloss_view.picture.scene.pack_settings import PACK_AMBIENT
    from relgloss_view.picture.scene.sample import SAMPLES
    from relgloss_view.quality.backends import open_renderer

    outputs = _checked_outputs(args.output)
    operators = operators_of(args.operators)
    scene, look, size = scene_from(args)
    look = dataclasses.replace(look, quality="exact")  # auto is measured on the split's picture
    words = args.sample_words or list(SAMPLES)
    arguments = sample_arguments(words, look, published=args.published, colour=colour_from(args))
    files = files_behind((one.sample.file, one.sample.pack) for one in arguments)
    for output in outputs:
        refuse_read(output, [args.scene, *files])
    if len(arguments) * len(operators) > MOST_CELLS:
        raise InputError(
            f"{len(arguments)} samples x {len(operators)} operators: expected at most "
            f"{MOST_CELLS} pictures"
        )
    own_light = args.scene is not None or any(w.startswith("lamp.ambient=") for w in args.set)
    if not own_light and any(argument.sample.pack is not None for argument in arguments):
        # As a new picture of a pack has, so that all samples are lit alike.
        scene = scene.placed(lamp=dataclasses.replace(scene.lamp, ambient=PACK_AMBIENT))
    check_picture(
        size, sample_count(scene, look, size), backend=args.backend, scene=scene,
        uses=[operator.name for operator in operators], kept=len(arguments) * len(operators),
        remedy="give a smaller --size or fewer --operators",
    )  # fmt: skip
    reference = None
    if not all(argument.origin for argument in arguments):
        reference = Reference.of(reference_look(args, look), args.gloss)
    samples = [
        argument.sample_look
        if argument.origin or reference is None
        else reference.matched_look(argument.sample_look, scene.setup)
        for argument in arguments
    ]
    matched = [a.sample_look.label for a in arguments if not a.origin]
    with Progress("compare") as progress, open_renderer(args.backend) as renderer:
        comparison = compare(
            renderer, samples, operators, scene, size,
            gloss=args.gloss, matched=matched, progress=progress,
        )  # fmt: skip
    command = printable_command(args.argv)
    words = ""
    if reference is not None:
        words = _matched_words(reference, matched, len(samples), comparison.factor)
    with decoration("the comparison", "its numbers are printed") as drawn, together():
        for output in outputs:
            _write(comparison, output, command, words)
    written = args.output if drawn.done else []
    status = 0 if drawn.done else 1  # decorations, and what -o asks for
    if args.json:
        print(json.dumps({"outputs": written, "size": list(size), **as_numbers(comparison)}))
        return status
    if comparison.refused:
        warn(
            f"{', '.join(comparison.refused)}: no highlight is seen in this view, so it is not "
            "ranked; turn the lamp"
        )
    for text in dict.fromkeys(_warnings(comparison)):
        warn(text)
    print(_tables(comparison))
    if words:
        print()
        print(words)
    for name in written:
        print(f"{printable(name)}: written")
    return status


def _matched_words(reference: Reference, matched: Sequence[str], count: int, factor: float) -> str:
    """Which samples are matched, to what, and what the view does to the ratio."""
    which = "all samples" if len(matched) == count else ", ".join(matched)
    words = f"{which}: matched to {reference.sample.label} (c {reference.c:.4g})"
    changed = ratio_words(factor)
    return f"{words}; {changed}" if changed else words


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
    """Operators of words such as split,multiscale:local=0; InputError where one is wrong."""
    from relgloss_view.commands.operator_options import read_parameters
    from relgloss_view.operators.registry import make_operator

    operators = []
    for word in text.split(","):
        name, *parameters = word.strip().split(":")
        make_operator(name)  # so that an unknown name is refused before its parameters
        operators.append(make_operator(name, read_parameters(name, parameters)))
    if len(set(operators)) < len(operators):
        raise InputError(f"--operators {text}: lists one operator twice; leave one out")
    return operators


def _write(comparison: Comparison, output: Path, command: str, matched: str) -> None:
    """One sheet or page; `matched` is what is to be known of the match."""
    from relgloss_view.base.version import __version__
    from relgloss_view.gloss.comparison_page import comparison_page
    from relgloss_view.gloss.comparison_sheet import comparison_sheet
    from relgloss_view.picture.output.png import save_rgb

    synthetic = all(drawn.sample.material.synthetic for drawn in comparison.samples)
    title = "Is the order of gloss kept? Samples across, operators down"
    note = "All samples are synthetic. " if synthetic else ""
    estimated = [
        drawn.sample.label for drawn in comparison.samples if drawn.sample.material.estimate
    ]
    note += f"Estimated: {', '.join(estimated)}. " if estimated else ""
    note += f"{sentence_case(matched)}. " if matched else ""
    note += "Contrasts and grain in L*; definitions in docs/operators.md."
    if output.suffix.lower() == ".html":
        with whole_file(output) as temporary:
            page = comparison_page(comparison, note, command)
            temporary.write_text(page, encoding="utf-8")
        return
    text = {"Software": f"relgloss {__version__}", "Title": title, "Command": command}
    sheet = comparison_sheet(comparison, title, note)
    save_rgb(sheet, output, text, display=comparison.display)


def _warnings(comparison: Comparison) -> list[str]:
    """The warnings of the pictures, each with its sample, and its operator if only some have it."""
    warnings: list[str] = []
    for label in comparison.rows[0].cells:
        by_operator = {row.operator.name: row.cells[label].warnings for row in comparison.rows}
        for name, texts in by_operator.items():
            for text in texts:
                everywhere = all(text in others for others in by_operator.values())
                warnings.append(f"{label}: {text}" if everywhere else f"{label}, {name}: {text}")
    return warnings


def _tables(comparison: Comparison) -> str:
    """The numbers in columns: the samples, then each operator with its verdicts."""
    labels = [drawn.sample.label for drawn in comparison.samples]
    width = 2 + max(map(len, ["sample", *labels]))
    blocks = [_sample_table(comparison, width)]
    blocks += [_operator_block(row, width) for row in comparison.rows]
    return "\n\n".join(blocks)


def _sample_table(comparison: Comparison, width: int) -> str:
    from relgloss_view.gloss.samples import gloss_number, gloss_words

    columns = (
        Column("sample", width, left=True),
        Column(gloss_words(comparison.gloss), 15),
        Column("sigma_N", 7),
        Column("c", 6),
        Column("c_max", 6),
    )
    rows = []
    for drawn in comparison.samples:
        gloss = drawn.gloss[comparison.gloss]
        rows.append(
            (
                drawn.sample.label,
                "-" if gloss is None else gloss_number(comparison.gloss, gloss),
                f"{drawn.sample.look.sigma_n_deg:.2f}",
                f"{drawn.c:.3g}",
                "-" if drawn.c_max is None else f"{drawn.c_max:.3g}",
            )
        )
    return table(columns, rows)


def _operator_block(row: OperatorRow, width: int) -> str:
    from relgloss_view.gloss.comparison_sheet import MEASURES, VERDICTS, body_words, number, percent

    columns = (
        Column("", width, left=True),
        *(Column(heading, 5) for heading in ("p99", "peak", "grain", "sharp")),
        Column("clipped", 7),
        Column("body dE", 7),
    )
    cells = []
    for label, cell in row.cells.items():
        m = cell.measures
        cells.append(
            (
                label,
                number(m.contrast_gloss),
                number(m.peak_contrast),
                number(m.graininess, 2),
                number(m.sharpness, 0),
                f"{number(percent(m.clipped_share))} %",
                number(m.body_difference, 2),
            )
        )
    lines = [row.operator.label, table(columns, cells, indent="  ")]
    for name, words in MEASURES.items():
        order = row.orders[name]
        tau = "" if order.tau is None else f", tau {order.tau:.2f}"
        lines.append(f"  {words}: {VERDICTS[order.verdict]}{tau}: {order.words}")
    return "\n".join([*lines, f"  {body_words(row)}"])
