"""`relgloss experiment new`: a study file to start from."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.base.writing import fresh_file


def add(commands: Any) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "new",
        help="write a study file to start from: the paper's experiment",
        description="Write the paper's experiment as a study file to edit, or the pair that a "
        "proof shows as a study of one sample. docs/experiment.md describes every entry.",
        epilog="example: relgloss experiment new -o mine.toml; "
        "relgloss experiment new --proof carton.html -o carton.toml",
    )
    parser.add_argument(
        "--proof",
        metavar="FILE.html",
        help="Proof whose reference and design are judged; its files are put into a folder beside "
        "the study",
    )
    parser.add_argument("-o", "--output", metavar="STUDY.toml", required=True)
    parser.add_argument(
        "--json", action="store_true", help="Print a list of the written files as JSON"
    )
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Write it where no file exists yet."""
    from relgloss_view.experiment.design.study_file import BUILT_IN, built_in_file

    if Path(args.output).suffix.lower() != ".toml":
        named = args.output or "''"
        raise InputError(f"-o {printable(named)}: expected a name that ends in .toml")
    if args.proof is not None:
        return _of_proof(args)
    with fresh_file(args.output) as temporary:
        temporary.write_bytes(built_in_file(BUILT_IN[0]).read_bytes())
    text = f"{printable(args.output)}: the paper's study"
    print(json.dumps({"file": args.output}) if args.json else text)
    return 0


def _of_proof(args: argparse.Namespace) -> int:
    """Write the study of a proof, and the folder of its files."""
    from relgloss_view.experiment.design.study_of_proof import write_study_of_proof
    from relgloss_view.proof.read import read_proof

    proof = read_proof(args.proof)
    folder = write_study_of_proof(args.output, proof)
    if args.json:
        print(json.dumps({"file": args.output, "folder": str(folder), "proof": proof.digest}))
    else:
        print(f"{printable(args.output)}: a study of {printable(proof.title, 80)}")
        print(f"  its files are in {printable(folder)}; keep both together")
    return 0
