"""The options that choose a tone-mapping operator, shared by the commands that show a picture."""

from __future__ import annotations

import argparse
import dataclasses
from collections.abc import Sequence
from typing import Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.toml import AUTO
from relgloss_view.operators.operator import Operator
from relgloss_view.operators.registry import DEFAULT_OPERATOR, OPERATORS, make_operator
from relgloss_view.picture.displayed import Displayed
from relgloss_view.picture.frame import Frame
from relgloss_view.picture.scene.options import read_value

SHOWS_C = ", ".join(name for name, kind in OPERATORS.items() if kind.uses_c)


def add_operator_options(parser: argparse.ArgumentParser) -> None:
    """Declare --operator and --operator-set."""
    how = parser.add_argument_group("tone mapping")
    how.add_argument(
        "--operator",
        metavar="NAME",
        choices=list(OPERATORS),
        default=DEFAULT_OPERATOR,
        help=f"{', '.join(OPERATORS)} (default {DEFAULT_OPERATOR}; c is {SHOWS_C}'s alone)",
    )
    how.add_argument(
        "--operator-set",
        metavar="NAME=VALUE",
        action="append",
        default=[],
        help="a parameter of the operator: " + "; ".join(_described()),
    )


def operator_from(args: argparse.Namespace) -> Operator:
    """The operator of parsed options; InputError where a parameter does not fit it."""
    return make_operator(args.operator, read_settings(args.operator, args.operator_set))


def read_settings(operator: str, settings: Sequence[str]) -> dict[str, Any]:
    """Parameters of an operator from words such as local=0.3."""
    optional = {f.name: f.default is None for f in dataclasses.fields(OPERATORS[operator])}
    found: dict[str, Any] = {}
    for setting in settings:
        name, mark, text = setting.partition("=")
        if not (name and mark):
            raise InputError(
                f"{operator}, setting {setting}: expected NAME=VALUE such as contrast=50"
            )
        value = {"true": True, "false": False}.get(text.lower(), read_value(text))
        found[name] = None if value == AUTO and optional.get(name) else value
    return found


def operator_words(args: argparse.Namespace) -> list[str]:
    """The options again, for a command that draws the same; none where they are the default."""
    words = [] if args.operator == DEFAULT_OPERATOR else ["--operator", args.operator]
    for setting in args.operator_set:
        words += ["--operator-set", setting]
    return words


def shown_by(operator: Operator, frame: Frame) -> Displayed | None:
    """What the operator shows of a frame; None for the split, whose picture the frame is.

    It says so where c was asked for and has no part in the picture, and where the frame was drawn
    as well as the split's picture needs.
    """
    if operator.name == DEFAULT_OPERATOR:
        return None
    shown = operator.draw(frame)
    told = []
    if not operator.uses_c and frame.look != frame.look.without_c():
        told.append(f"{operator.name} takes no account of c, which is the split's")
    if frame.look.quality == AUTO:
        told.append(
            f"quality auto is measured on the split's picture; {operator.name} may show more of "
            "what it leaves out"
        )
    return dataclasses.replace(shown, warnings=(*told, *shown.warnings))


def _described() -> list[str]:
    """Each operator's parameters, in words; the split's are those of the look."""
    told = []
    for name, kind in OPERATORS.items():
        fields = [f.name for f in dataclasses.fields(kind)]
        if fields:
            told.append(f"{name}: {', '.join(fields)}")
    return told
