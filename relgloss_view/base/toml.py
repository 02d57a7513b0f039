"""TOML files: tables to frozen values with declared parameters, and back without loss."""

from __future__ import annotations

import dataclasses
import numbers
import os
import re
import tomllib
from collections.abc import Mapping
from typing import Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable, read_text, refuse
from relgloss_view.base.writing import whole_file

MOST_PARTS = 8  #: of a dotted key; no file of this program has more than 3
_PART = r"""(?:[A-Za-z0-9_-]+|"[^"\n]*"|'[^'\n]*')[ \t]*"""
_LONG_KEY = re.compile(rf"(?:^|[{{,\[])[ \t]*(?:{_PART}\.[ \t]*){{{MOST_PARTS}}}", re.MULTILINE)
AUTO = "auto"  #: the text of an optional entry whose value is None


def read_toml(path: str | os.PathLike[str], most_bytes: int, expected: str) -> dict[str, Any]:
    """The tables of a TOML file of at most `most_bytes`.

    expected: the wanted kind of file for the message. Raises InputError.
    """
    written = read_text(path, most_bytes, expected)
    try:
        return parse_toml(written)
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{path}: not TOML: {printable(error)}") from error
    except RecursionError as error:
        raise InputError(f"{path}: lists or tables are nested too deeply") from error
    except ValueError as error:  # a whole number longer than Python reads
        raise InputError(f"{path}: a number has too many digits") from error


def parse_toml(written: str) -> dict[str, Any]:
    """The tables of a TOML text. Raises what tomllib raises.

    RecursionError also for a key of very many parts, as in a.a.a = 1: the time that tomllib takes
    for it grows with the square of their number, to 6 s for 20,000.
    """
    if _LONG_KEY.search(written):
        raise RecursionError
    return tomllib.loads(written)


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
    field that came later (`later` of its declaration) is left out at its default too.
    """
    table = {}
    for f in dataclasses.fields(part):
        value = getattr(part, f.name)
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
