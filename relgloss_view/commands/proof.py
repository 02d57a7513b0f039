"""`relgloss proof`: one file that a designer sends and a maker opens."""

from __future__ import annotations

import importlib
from typing import Any

#: In the order in which they are used.
PARTS = ("make", "check", "show", "key")


def add(commands: Any) -> None:
    """Declare the command and its own commands."""
    parser = commands.add_parser(
        "proof",
        description="Make one HTML file of a reference picture and a design. Whoever opens it in a "
        "browser sees both, can change them, and can answer; nothing has to be installed. "
        "`relgloss view FILE.html` opens it in the window.",
        epilog="example: relgloss proof make matte-coated -o paper.html --note 'Enough gloss?'; "
        "relgloss proof check paper.html",
    )
    parts = parser.add_subparsers(metavar="PART", required=True, parser_class=type(parser))
    for name in PARTS:
        importlib.import_module(f"relgloss_view.commands.proof_{name}").add(parts)
