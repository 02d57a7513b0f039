"""The operators by name. Adding one is a file of its own and a line here."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import Any

from relgloss_view.base.reading import refuse
from relgloss_view.operators.clip import Clip
from relgloss_view.operators.multiscale import Multiscale
from relgloss_view.operators.neutral import Neutral
from relgloss_view.operators.operator import Operator
from relgloss_view.operators.schlick import Schlick
from relgloss_view.operators.split import Split
from relgloss_view.operators.tumblin_rushmeier import TumblinRushmeier
from relgloss_view.operators.ward import Ward
from relgloss_view.operators.ward_histogram import WardHistogram

#: The paper's own first.
OPERATORS: dict[str, type[Operator]] = {
    kind.name: kind
    for kind in (
        Split,
        Clip,
        Multiscale,
        Neutral,
        TumblinRushmeier,
        Ward,
        Schlick,
        WardHistogram,
    )
}
DEFAULT_OPERATOR = Split.name


def make_operator(name: str, parameters: Mapping[str, Any] | None = None) -> Operator:
    """A tone mapping by its name in OPERATORS, with its parameters by their names.

    Raises InputError for an unnames name and for a value out of its declared range. Every operator
    names its source; docs/operators.md lists them.

    >>> make_operator("clip").name
    'clip'
    >>> make_operator("gamma")
    Traceback (most recent call last):
    ...
    relgloss_view.base.errors.InputError: operator: expected one of split, clip, ..., found "gamma"
    """
    if name not in OPERATORS:
        refuse("operator", f"one of {', '.join(OPERATORS)}", name)
    kind = OPERATORS[name]
    names = [f.name for f in dataclasses.fields(kind)]
    for parameter in parameters or {}:
        if parameter not in names:
            refuse(f"operator {name}", f"a parameter of {', '.join(names) or 'none'}", parameter)
    return kind(**(parameters or {}))
