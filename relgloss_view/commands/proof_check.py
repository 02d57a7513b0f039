"""`relgloss proof check`: whether a proof is whole, signed, and drawn here as it was there."""

from __future__ import annotations

import argparse
import json
from typing import Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import named, printable
from relgloss_view.base.terminal import Progress


def add(commands: Any) -> None:
    """Declare the command."""
    from relgloss_view.quality.backends import BACKENDS

    parser = commands.add_parser(
        "check",
        help="check that a proof is whole, who signed it, and that it is drawn here as it was sent",
        description="Check that nothing of a proof was changed, and name what was. Check its "
        "signatures. Draw both pictures again, and compare them with the proof's own numbers. The "
        "exit status is 1 where anything is wrong.",
        epilog="example: relgloss proof check carton.html",
    )
    parser.add_argument("file", metavar="FILE.html", help="Proof to check")
    parser.add_argument(
        "--backend",
        choices=BACKENDS,
        default="auto",
        help="What draws: egl or osmesa through OpenGL, or reference in float64 (slow)",
    )
    parser.add_argument("--json", action="store_true", help="Print the check as JSON")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Check and print; InputError, exit status 1, where anything is wrong."""
    from relgloss_view.proof.check import check_page, check_proof, sentences
    from relgloss_view.proof.keys import known_keys
    from relgloss_view.proof.read import read_page
    from relgloss_view.quality.backends import open_renderer
    from relgloss_view.viewer.state.places import config_folder

    page = read_page(args.file)
    try:
        known = known_keys(config_folder())
        found = check_page(page, known)
        if found.proof is not None:
            with Progress("proof") as progress, open_renderer(args.backend, progress) as renderer:
                found = check_proof(page, known, renderer)
    except InputError as error:
        raise InputError(f"{named(args.file)}: {error}") from error
    if args.json:
        print(json.dumps({"file": args.file, **found.as_json()}))
    else:
        title = f", {printable(found.proof.title, 80)}" if found.proof else ""
        print(f"{printable(args.file)}{title}")
        for line in sentences(found):
            print(f"  {line}")
    if found.faults:
        raise InputError(f"{named(args.file)}: {'; '.join(found.faults)}")
    return 0
