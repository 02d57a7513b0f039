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
        help=f"Operator that maps the tones: {', '.join(OPERATORS)} (default {DEFAULT_OPERATOR}). "
        f"c changes the picture of {SHOWS_C} only",
    )
    how.add_argument(
        "--operator-set",
        metavar="NAME=VALUE",
        action="append",
        default=[],
        help="Value of a parameter of the operator: " + "; ".join(_parameter_names()),
    )


def operator_from(args: argparse.Namespace) -> Operator:
    """The operator of parsed options; InputError where a parameter does not fit it."""
    return make_operator(args.operator, read_parameters(args.operator, args.operator_set))


def read_parameters(operator: str, settings: Sequence[str]) -> dict[str, Any]:
    """Parameters of an operator by name, from words such as local=0.3."""
    optional = {f.name: f.default is None for f in dataclasses.fields(OPERATORS[operator])}
    parameters: dict[str, Any] = {}
    for setting in settings:
        name, mark, text = setting.partition("=")
        if not (name and mark):
            raise InputError(
                f"{operator}, setting {setting}: expected NAME=VALUE such as contrast=50"
            )
        value = {"true": True, "false": False}.get(text.lower(), read_value(text))
        parameters[name] = None if value == AUTO and optional.get(name) else value
    return parameters


def operator_words(args: argparse.Namespace) -> list[str]:
    """The options again, for a command that draws the same; none where all are the default."""
    words = [] if args.operator == DEFAULT_OPERATOR else ["--operator", args.operator]
    for setting in args.operator_set:
        words += ["--operator-set", setting]
    return words


def displayed_by(operator: Operator, frame: Frame) -> Displayed | None:
    """The operator's picture of a frame; None for the split, whose picture the frame is.

    The picture has a warning where c was given and has no effect, and where quality auto chose
    how to draw by the split's picture.
    """
    if operator.name == DEFAULT_OPERATOR:
        return None
    picture = operator.draw(frame)
    warnings = []
    if not operator.uses_c and frame.look != frame.look.without_c():
        warnings.append(f"{operator.name} takes no account of c, which is the split's")
    if frame.look.quality == AUTO:
        warnings.append(
            f"quality auto is measured on the split's picture; {operator.name} may show more of "
            "what it leaves out"
        )
    return dataclasses.replace(picture, warnings=(*warnings, *picture.warnings))


def _parameter_names() -> list[str]:
    """Each operator with the names of its parameters; the split has those of the look."""
    lines = []
    for name, kind in OPERATORS.items():
        fields = [f.name for f in dataclasses.fields(kind)]
        if fields:
            lines.append(f"{name}: {', '.join(fields)}")
    return lines
