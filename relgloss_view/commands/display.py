"""`relgloss display`: what a monitor shows, from a profile, a display file or readings."""

from __future__ import annotations

import argparse
import json
from typing import Any

from relgloss_view.commands import display_convert, display_patches

SHOW = "show"  #: the command that `relgloss display FILE` leaves out
OWN = (SHOW, "check", "convert", "patches")


def add(commands: Any) -> None:
    """Declare the command and its own commands."""
    parser = commands.add_parser(
        "display",
        usage="relgloss display FILE [READINGS] [-o MONITOR.toml] [--report OUT] [--json]\n"
        "       relgloss display COMMAND ...",
        description="Show what a monitor shows: white, black, contrast, gamut and gamma, from an "
        "ICC profile, a display file, or readings, which are fitted. `relgloss display show "
        "--help` explains the options.",
        epilog="example: relgloss display monitor.icc; relgloss display readings.ti3 -o "
        "monitor.toml --report monitor.html; relgloss snapshot --display monitor.toml -o paper.png",
    )
    own = parser.add_subparsers(dest="display_command", metavar="COMMAND", required=True)
    _add_show(own)
    display_convert.add(own)
    display_patches.add(own)
