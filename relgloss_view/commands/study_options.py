"""A study as it is given on the command line: a file or a built-in one, with entries changed."""

from __future__ import annotations

import argparse
import re
from typing import TYPE_CHECKING, Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.toml import parse_toml

if TYPE_CHECKING:
    from relgloss_view.experiment.design.study import Study


def add_study_options(parser: argparse.ArgumentParser) -> None:
    """Declare STUDY and --set."""
    parser.add_argument(
        "study", metavar="STUDY", help="Study file (TOML), or the built-in study: paper"
    )
    parser.add_argument(
        "--set",
        metavar="NAME=VALUE",
        action="append",
        default=[],
        help="Change an entry of the study, such as procedure.repeats=2 or screen.width_px=256",
    )


def study_from(args: argparse.Namespace) -> Study:
    """The study of parsed options; InputError where it is none."""
    from relgloss_view.experiment.design.study_file import load_study

    changes: dict[str, dict[str, Any]] = {}
    for setting in args.set:
        match = re.fullmatch(r"(\w+)\.(\w+)=(.*)", setting, re.DOTALL)
        if match is None:
            raise InputError(f"--set {setting}: expected TABLE.ENTRY=VALUE, as in the study file")
        table, entry, text = match.groups()
        changes.setdefault(table, {})[entry] = _value(text)
    return load_study(args.study, changes)


def _value(text: str) -> object:
    """A value as the study file has it: TOML, or a bare word."""
    try:
        return parse_toml(f"value = {text}")["value"]
    except InputError:
        return text
