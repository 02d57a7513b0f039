"""`relgloss import`: a material that another program describes, as a material file."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

from relgloss_view.base.reading import printable
from relgloss_view.base.terminal import warn
from relgloss_view.commands.outputs import check_output


def add(commands: Any) -> None:
    """Declare the command."""
    from relgloss_view.exchange.formats import READERS

    parser = commands.add_parser(
        "import",
        description="Read a material of another program's file. Its parameters are fitted to "
        "lobes, what cannot be carried is printed, and the material is marked as described, "
        "because nothing was measured.",
        epilog="example: relgloss import plastic.mtlx -o plastic.json",
    )
    parser.add_argument(
        "file",
        metavar="FILE",
        help=f"File of another program: {', '.join(known.name for known in READERS)}",
    )
    parser.add_argument(
        "-o", "--output", metavar="MATERIAL.json", required=True, help="Material file to write"
    )
    parser.add_argument(
        "--part", metavar="NAME", help="Name of the material to read, where the file has several"
    )
    parser.add_argument("--json", action="store_true", help="Print what was read as JSON")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Read the material, write it, then print what it is and what was not carried."""
    from relgloss_view.exchange.formats import reader_of
    from relgloss_view.exchange.loss import MOST_DE2000, Loss
    from relgloss_view.material.files import save_material

    path = Path(args.file)
    known = reader_of(path)
    check_output(args.output, [args.file], ".json")
    material = known.read(path, args.part)
    save_material(material, args.output)
    record = material.described
    if args.json:
        content = {
            "output": args.output,
            "format": known.name,
            "name": material.name,
            "described": record.as_json() if record else None,
            "warnings": list(material.warnings),
        }
        print(json.dumps(content))
        return 0
    for text in material.warnings:
        warn(text)
    if record is None:
        print("the file holds the material that relgloss wrote, and its parameters are unchanged")
    elif record.losses:
        loss = Loss.of_json(record.losses)
        print(f"{loss.verdict}\nfitted to {record.model}: {loss.words}")
        if loss.de2000_p95 > MOST_DE2000:
            warn(
                "the material shows another highlight than the description: our lobes have no "
                "such tails; compare the pictures before you use it"
            )
    print(f"{printable(args.output)}: written, {printable(material.name, 60)}")
    return 0
