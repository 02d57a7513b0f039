"""`relgloss experiment`: the subjective evaluation, from a study file to chosen settings."""

from __future__ import annotations

import importlib
from typing import Any

#: In the order in which they are used.
PARTS = ("new", "run", "simulate", "analyse", "export")


def add(commands: Any) -> None:
    """Declare the command and its own commands."""
    parser = commands.add_parser(
        "experiment",
        help="the subjective evaluation: run it, simulate it, analyse it",
        description="Find the settings that keep a sample's ratio of gloss to the reference, by "
        "asking people (Ishii et al.). A study file defines what they see, `run` asks them and "
        "keeps each answer, `analyse` finds the best settings. `simulate` asks simulated "
        "observers.",
        epilog="example: relgloss experiment simulate paper -o trial.sqlite && "
        "relgloss experiment analyse trial.sqlite -o report",
    )
    parts = parser.add_subparsers(metavar="PART", required=True, parser_class=type(parser))
    for name in PARTS:
        importlib.import_module(f"relgloss_view.commands.experiment_{name}").add(parts)
