"""`relgloss proof`: one file that a designer sends and a maker opens."""

from __future__ import annotations

import importlib
import importlib.util
from typing import Any

PARTS = ("make", "check", "show", "key")


def add(commands: Any) -> None:
    """Declare the command and its own commands."""
    parser = commands.add_parser("proof", description="One file.")
    parts = parser.add_subparsers(metavar="PART", required=True, parser_class=type(parser))
    for name in PARTS:
        if importlib.util.find_spec(f"relgloss_view.commands.proof_{name}"):
            importlib.import_module(f"relgloss_view.commands.proof_{name}").add(parts)
