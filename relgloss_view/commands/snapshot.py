"""`relgloss snapshot`: draw one picture without a window."""

from __future__ import annotations

import argparse
import json
from typing import Any

from relgloss_view.base.reading import printable
from relgloss_view.base.terminal import Progress, warn
from relgloss_view.base.writing import check_writable
from relgloss_view.commands.matched import (
    add_reference_option,
    match_words,
    matched_finishes,
    matched_picture,
)
from relgloss_view.commands.operator_options import (
    add_operator_options,
    displayed_by,
    operator_from,
)
from relgloss_view.commands.outputs import files_behind, refuse_read
from relgloss_view.commands.scene_options import add_scene_options, printable_command, scene_from
from relgloss_view.picture.scene.look import viewed_look

BITS = (8, 16)


def add(commands: Any) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "snapshot",
        description="Draw one picture of a sample and save it: PNG to look at, OpenEXR to measure.",
        epilog="example: relgloss snapshot --sample art-coated -o art.png; relgloss snapshot "
        "--material mine.json --reference standard.json --sigma-n 0.5 -o mine.png",
    )
    parser.add_argument(
        "-o", "--output", metavar="OUT.png|OUT.exr", required=True, help="File of the picture"
    )
    add_scene_options(parser, look=viewed_look())
    add_reference_option(parser)
    add_operator_options(parser)
    parser.add_argument(
        "--bits", type=int, choices=BITS, help="Bits in each channel of a PNG (default 8)"
    )
    parser.add_argument("--json", action="store_true", help="Print the picture's numbers as JSON")
    parser.set_defaults(run=run, wrong_usage=parser.error)


def run(args: argparse.Namespace) -> int:
    """Draw, write, and print the sample and its setting."""
    from relgloss_view.commands.proof_scene import proof_as_scene

    with proof_as_scene(args):
        return _drawn(args)


def _drawn(args: argparse.Namespace) -> int:
    from relgloss_view.display.model import DisplayModel
    from relgloss_view.picture.model.pixel_sampling import sample_count
    from relgloss_view.picture.output.export import check_suffix, save_frame
    from relgloss_view.picture.output.parameters import SPLIT, parameters, warnings
    from relgloss_view.picture.peak import check_picture
    from relgloss_view.picture.seen import seen_words
    from relgloss_view.quality.backends import open_renderer

    output = check_suffix(args.output)
    if args.bits is not None and output.suffix.lower() != ".png":
        args.wrong_usage(f"argument --bits: {output} is OpenEXR, which holds floats; leave it out")
    operator = operator_from(args)
    scene, look, size = scene_from(args)
    scene, look = matched_finishes(args, scene, look)
    picture = matched_picture(args, scene, look)
    if picture is not None:
        look = picture.look
    if not operator.uses_c:  # the graininess stays, so that operators show the same surface
        look, picture = look.without_c() if picture is not None else look, None
    check_writable(output)
    given = [args.scene, args.artwork, args.material, args.pack]
    refuse_read(output, [*given, *files_behind([(None, scene.pack)])])
    format_ = "exr" if args.bits is None and output.suffix.lower() != ".png" else "png"
    use = format_ + ("16" if args.bits == 16 else "") if operator.name == SPLIT else operator.name
    samples = sample_count(scene, look, size)
    check_picture(size, samples, backend=args.backend, uses=[use], scene=scene)
    with Progress("snapshot") as progress, open_renderer(args.backend, progress) as renderer:
        factor = 1.0 if picture is None else picture.factor(renderer, scene, size)
        frame = renderer.render(scene, look, size, factor=factor)
        progress(0.5, operator.name)
        displayed = displayed_by(operator, frame)
        command = printable_command(args.argv)
        save_frame(frame, output, command, bits=args.bits or 8, displayed=displayed)
        numbers = parameters(frame, displayed)
        numbers["match"] = None if picture is None else picture.as_numbers(frame)
    if args.json:
        print(json.dumps({"output": str(output), **numbers}))
        return 0
    for warning in warnings(frame, displayed):
        warn(warning)
    settings = f"sigma_N {look.sigma_n_deg:g} deg, "
    if displayed is None:
        c_max = "no highlight" if frame.c_max is None else f"c_max {frame.c_max:.4g}"
        settings += f"c {frame.c:.4g} ({c_max})"
    else:
        settings += f"operator {operator.name}"
    sample = printable(scene.name, 80)
    marks = scene.marks
    sample += f" ({marks})" if marks else ""
    print(f"{printable(output)}: {sample}, {settings}")
    seen = DisplayModel.of(scene.display).seen
    if seen is not None:
        print(f"  {seen_words(seen)}")
    if picture is not None:
        print(f"  {match_words(picture, frame)}")
    elif operator.uses_c and look.c is None and look.c_fraction is None:
        print("  the scene gives no c, so it is c_max; --c matched keeps the ratio of gloss")
    return 0
