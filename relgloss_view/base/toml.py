"""TOML files: tables to frozen values with declared parameters, and back, exactly."""

from __future__ import annotations

import dataclasses
import numbers
import os
import tomllib
from collections.abc import Mapping
from typing import Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import fault, printable, read_text
from relgloss_view.base.writing import whole_file

AUTO = "auto"  #: what an optional entry says where its value is None


def read_toml(path: str | os.PathLike[str], most_bytes: int, expected: str) -> dict[str, Any]:
    """The tables of a TOML file; `expected` says what it should be. Raises InputError."""
    written = read_text(path, most_bytes, expected)
    try:
        return tomllib.loads(written)
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{path}: not TOML: {printable(error)}") from error
    except RecursionError as error:
        raise InputError(f"{path}: lists or tables are nested too deeply") from error
    except ValueError as error:  # a whole number longer than Python reads
        raise InputError(f"{path}: a number has too many digits") from error


def write_toml(path: str | os.PathLike[str], tables: Mapping[str, Any]) -> None:
    """Write tables as TOML, whole or not at all; InputError where that fails."""
    import tomli_w

    data = tomli_w.dumps(tables).encode("utf-8")
    with whole_file(path) as temporary:
        temporary.write_bytes(data)


def build_part(kind: type[Any], name: str, values: object, within: str = "") -> Any:
    """A frozen dataclass from a table of values, "auto" being None; InputError names the entry."""
    fields = {f.name: f for f in dataclasses.fields(kind)}
    made = {}
    for key, value in table_of(within + name, values).items():
        if key not in fields:
            known = ", ".join(fields)
            shown = printable(key, 60)
            raise InputError(f"{within}{name}.{shown}: no such entry; expected one of {known}")
        left_open = value == AUTO and fields[key].metadata.get("optional", False)
        made[key] = None if left_open else _frozen(value)
    try:
        return kind(**made)
    except (OverflowError, ValueError) as error:  # a whole number beyond every float
        raise InputError(f"[{within}{name}]: a number is too large") from error
    except InputError as error:
        if not within:
            raise
        raise InputError(f"{within}{error}") from error


def entries(part: Any) -> dict[str, Any]:
    """The entries of a part (Look, Lamp, ...) as TOML holds them.

    An entry that is None is left out where that is its default; elsewhere it is "auto".
    """
    table = {}
    for f in dataclasses.fields(part):
        value = getattr(part, f.name)
        if value is not None:
            table[f.name] = plain(value)
        elif f.default is not None:
            table[f.name] = AUTO
    return table


def plain(value: Any) -> Any:
    """A value as Python's own type, so that it is written in digits: no numpy scalar, no tuple."""
    if isinstance(value, bool | str):
        return value
    if isinstance(value, numbers.Integral):
        return int(value)
    if isinstance(value, numbers.Real):
        return float(value)
    return [plain(v) for v in value]


def table_of(name: str, values: object) -> dict[str, Any]:
    """A TOML table; InputError where something else has its name."""
    if not isinstance(values, dict):
        fault(f"[{name}]", "a table", values)
    return values


def _frozen(value: object) -> object:
    return tuple(_frozen(v) for v in value) if isinstance(value, list) else value
