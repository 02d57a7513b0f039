"""TOML files: tables to frozen values with declared parameters, and back without loss."""

from __future__ import annotations

import dataclasses
import numbers
import os
import tomllib
from collections.abc import Mapping
from typing import Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.nesting import check_toml
from relgloss_view.base.reading import decoding, printable, read_text, refuse
from relgloss_view.base.writing import whole_file

AUTO = "auto"  #: the text of an optional entry whose value is None


def read_toml(path: str | os.PathLike[str], most_bytes: int, expected: str) -> dict[str, Any]:
    """The tables of a TOML file of at most `most_bytes`.

    expected: the wanted kind of file for the message. Raises InputError.
    """
    written = read_text(path, most_bytes, expected)
    with decoding(path, expected):
        try:
            return parse_toml(written)
        except InputError as error:
            raise InputError(f"{path}: {error}") from error


def parse_toml(written: str) -> dict[str, Any]:
    """The tables of a TOML text. Raises InputError, without a file's name.

    What the text asks for is counted first (nesting.py), and texts that would take more time and
    memory than any file of this program are refused.
    """
    check_toml(written)
    try:
        return tomllib.loads(written)
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"not TOML: {printable(error)}") from error
    except RecursionError as error:
        raise InputError("lists or tables are nested too deeply") from error
    except ValueError as error:  # a date that no calendar has
        raise InputError(f"not TOML: {printable(error)}") from error


def write_toml(path: str | os.PathLike[str], tables: Mapping[str, Any]) -> None:
    """Write tables as TOML, whole or not at all; InputError where that fails."""
    import tomli_w

    data = tomli_w.dumps(tables).encode("utf-8")
    with whole_file(path) as temporary:
        temporary.write_bytes(data)


def build_part(kind: type[Any], name: str, values: object, within: str = "") -> Any:
    """A frozen dataclass from a table of values; "auto" becomes None where that is allowed.

    kind: the dataclass. name: of the table. within: text before the name in messages, as in
    "reference.". Raises InputError, which names the entry.
    """
    fields = {f.name: f for f in dataclasses.fields(kind)}
    made = {}
    for key, value in table_of(within + name, values).items():
        if key not in fields:
            names = ", ".join(fields)
            entry = printable(key, 60)
            raise InputError(f"{within}{name}.{entry}: no such entry; expected one of {names}")
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
    """The fields of a dataclass (Look, Lamp, ...) as entries of a TOML table.

    A field that is None is left out where that is its default; elsewhere its entry is "auto". A
    field that came later (`later` of its declaration) is left out at its default too, and so are
    the names of its method `unwritten`.
    """
    table = {}
    unwritten = part.unwritten() if hasattr(part, "unwritten") else ()
    for f in dataclasses.fields(part):
        value = getattr(part, f.name)
        if f.name in unwritten:
            continue
        if f.metadata.get("later") and value == f.default:
            continue  # the digest of a study that began before stays the same
        if value is not None:
            table[f.name] = plain(value)
        elif f.default is not None:
            table[f.name] = AUTO
    return table


def plain(value: Any) -> Any:
    """A value in Python's own types, without numpy scalars and tuples, so that TOML can hold it.

    >>> plain((1, 2.5))
    [1, 2.5]
    """
    if isinstance(value, bool | str):
        return value
    if isinstance(value, numbers.Integral):
        return int(value)
    if isinstance(value, numbers.Real):
        return float(value)
    return [plain(v) for v in value]


def table_of(name: str, values: object) -> dict[str, Any]:
    """The values, if they are a TOML table; InputError for anything else of that name."""
    if not isinstance(values, dict):
        refuse(f"[{name}]", "a table", values)
    return values


def _frozen(value: object) -> object:
    return tuple(_frozen(v) for v in value) if isinstance(value, list) else value
