"""`relgloss export`: a material or a pack in the words of another program, with what is lost."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.base.terminal import warn
from relgloss_view.commands.outputs import check_output, files_behind, refuse_read

if TYPE_CHECKING:
    from relgloss_view.exchange.formats import Format
    from relgloss_view.material.material import Material
    from relgloss_view.pack.pack import Pack

LEAST_PX, LARGEST_PX = 16, 16384  #: of a texture
LEGEND = (
    "how to read it: dE2000 is the difference of colour between the highlight here and the file's, "
    "pixel by pixel: 1 is just seen, 3 at a glance; 95 of 100 pixels differ less than p95. Gloss "
    "is in gloss units: here -> in the file"
)


def add(commands: Any) -> None:
    """Declare the command."""
    from relgloss_view.exchange.formats import BASES, MOST_PX, endings
    from relgloss_view.pack.built_in import FINISHES
    from relgloss_view.pack.shape import SHAPES
    from relgloss_view.picture.scene.sample import SAMPLES

    parser = commands.add_parser(
        "export",
        description="Write a material or a pack for another program. The parameters of the other "
        "program are fitted to the material's picture, because a renamed width shows another "
        "highlight. The command prints what is lost, and the file holds it.",
        epilog="example: relgloss export art-coated -o art.mtlx",
    )
    parser.add_argument(
        "sample",
        metavar="SAMPLE|MATERIAL.json|PACK",
        help=f"Built-in paper ({', '.join(SAMPLES)}), built-in finish ({', '.join(FINISHES)}), "
        "material file or pack file",
    )
    parser.add_argument(
        "-o",
        "--output",
        metavar="FILE",
        required=True,
        help=f"File to write; its ending chooses the format: {endings()}",
    )
    parser.add_argument(
        "--grid",
        metavar="GRID",
        help="Directions of a CSV: gcms (the goniophotometer's 997), in-plane (dense where the "
        "highlight is), in-plane:STEP in degrees, or a CSV file of your own directions",
    )
    parser.add_argument(
        "--basis",
        choices=BASES,
        help="Directions of a BSDF XML: tensor-tree (Radiance, keeps the gloss; the default) or "
        "klems (WINDOW, loses it)",
    )
    parser.add_argument(
        "--form",
        metavar="FORM",
        choices=[form for form in SHAPES if form != "mesh"],
        help="Form that a material is put on, where the format holds forms: "
        f"{', '.join(form for form in SHAPES if form != 'mesh')}",
    )
    parser.add_argument(
        "--pixels",
        metavar="N",
        type=int,
        help=f"Longest side of a texture, in pixels (default {MOST_PX})",
    )
    parser.add_argument(
        "--bare",
        action="store_true",
        help="Leave out what others need not see: the material itself with its spectrum and "
        "source, its gloss readings, and what is lost, which is printed alone (.glb, .mtlx); "
        "import refits such a file",
    )
    parser.add_argument("--json", action="store_true", help="Print what was written as JSON")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Write the file, then print what is lost."""
    from relgloss_view.exchange.formats import MOST_PX, ExportOptions, format_of
    from relgloss_view.material.material import Material
    from relgloss_view.pack.shape import Shape

    pixels = MOST_PX if args.pixels is None else args.pixels
    if not LEAST_PX <= pixels <= LARGEST_PX:
        raise InputError(f"--pixels {pixels}: expected {LEAST_PX} to {LARGEST_PX}")
    path = Path(args.output)
    chosen = format_of(path)
    check_output(args.output, [args.sample, args.grid or args.sample])
    what = sample_of(args.sample)
    if not isinstance(what, Material):
        refuse_read(args.output, files_behind([(None, what)]))
    options = ExportOptions(
        grid=args.grid,
        basis=args.basis,
        shape=Shape(args.form) if args.form else None,
        most_px=pixels,
        bare=args.bare,
    )
    _name_unused(args, chosen, what)
    exported = chosen.write(what, path, options)
    if args.json:
        content = {
            "output": args.output,
            "format": chosen.name,
            "lines": list(exported.lines),
            "losses": {name: loss.as_json() for name, loss in exported.losses.items()},
            "is_small": exported.is_small,
        }
        print(json.dumps(content))
        return 0
    for line in exported.lines:
        print(printable(line, 400))
    lossy = [printable(name, 60) for name, loss in exported.losses.items() if not loss.is_small]
    if lossy:
        warn(
            f"compare the pictures before you use the file: the loss of {', '.join(lossy)} can be "
            "seen, or a gloss meter shows it"
        )
    if exported.losses:
        print(LEGEND)
    print(f"{printable(args.output)}: written as {chosen.name}")
    return 0


def _name_unused(args: argparse.Namespace, chosen: Format, what: Material | Pack) -> None:
    """Warn of options that this output has no use for."""
    from relgloss_view.material.material import Material

    for option in ("grid", "basis", "form", "pixels"):
        if getattr(args, option) is None:
            continue
        if option not in chosen.options:
            warn(f"--{option} changes nothing in a file of {chosen.name}")
        elif option == "form" and not isinstance(what, Material):
            warn("--form changes nothing: a pack has its own form")
        elif option == "pixels" and isinstance(what, Material):
            warn("--pixels changes nothing: a material has no textures")


def sample_of(name: str) -> Material | Pack:
    """The material or pack of an argument; InputError for what is neither."""
    from relgloss_view.pack.built_in import FINISHES, PAPERS, load_finish
    from relgloss_view.picture.scene import file_kinds
    from relgloss_view.picture.scene.sample import Sample

    if name in (*PAPERS, *FINISHES) and not Path(name).exists():
        return load_finish(name)
    kind = file_kinds.likely_kind(name)
    if kind == file_kinds.MEASUREMENT:
        raise InputError(
            f"{printable(name)}: this is a measured table; fit it first with `relgloss fit`"
        )
    if kind == file_kinds.SCENE:
        raise InputError(f"{printable(name)}: this is a scene; give a material or a pack")
    sample = Sample.from_file(name)
    return sample.material if sample.pack is None else sample.pack
