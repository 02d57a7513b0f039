"""`relgloss catalogue`: many samples at once, in one table with pictures."""

from __future__ import annotations

import importlib
from typing import Any

PARTS = ("build", "search")


def add(commands: Any) -> None:
    """Declare the command and its own commands."""
    parser = commands.add_parser(
        "catalogue",
        description="Make a catalogue of a folder of measured tables, materials and proofs: each "
        "is fitted, metered, matched to a reference and drawn. Then find samples in it by gloss, "
        "colour and pictures. docs/catalogue.md describes the table.",
        epilog="example: relgloss catalogue build scans/ -o stock; "
        "relgloss catalogue search stock 'gloss 60 between 40 and 50'",
    )
    parts = parser.add_subparsers(metavar="PART", required=True, parser_class=type(parser))
    for name in PARTS:
        importlib.import_module(f"relgloss_view.commands.catalogue_{name}").add(parts)
