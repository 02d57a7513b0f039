"""JSON from outside: what a text asks for is counted before it is decoded."""

from __future__ import annotations

import json
import os
from typing import Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.nesting import MOST_JSON_VALUES, check_json
from relgloss_view.base.reading import decoding, printable, read_text

#: Of the JSON file that marks a folder as a command's own, such as a manifest.
MARK = "a file that marks a folder as relgloss's"
MOST_MARK_BYTES, MOST_MARK_VALUES = 64 * 1024 * 1024, 5_000_000


def read_json(
    path: str | os.PathLike[str],
    most_bytes: int,
    expected: str,
    *,
    most_values: int = MOST_JSON_VALUES,
) -> Any:
    """The content of a JSON file of at most `most_bytes` and `most_values`.

    expected: the wanted kind of file for the message, as in "a manifest". Raises InputError, one
    line that names the file.
    """
    written = read_text(path, most_bytes, expected)
    with decoding(path, expected):
        try:
            return parse_json(written, most_values)
        except InputError as error:
            raise InputError(f"{path}: {error}") from error


def parse_json(written: str, most_values: int = MOST_JSON_VALUES, **hooks: Any) -> Any:
    """The content of a JSON text. Raises InputError, without a file's name.

    hooks: as for json.loads; a ValueError of one of them is a fault of the text.

    >>> parse_json("[1, 2")
    Traceback (most recent call last):
    ...
    relgloss_view.base.errors.InputError: line 1, column 6: not JSON (Expecting ',' delimiter)
    """
    check_json(written, most_values)
    try:
        return json.loads(written, **hooks)
    except json.JSONDecodeError as error:
        place = f"line {error.lineno}, column {error.colno}"
        raise InputError(f"{place}: not JSON ({error.msg})") from error
    except RecursionError as error:
        raise InputError("lists or objects are nested too deeply") from error
    except ValueError as error:  # of a hook, or a number that Python refuses
        raise InputError(printable(error)) from error


def read_mark(path: str | os.PathLike[str]) -> dict[str, Any]:
    """The object in a file that marks a folder as a command's own; empty where it holds none."""
    try:
        content = read_json(path, MOST_MARK_BYTES, MARK, most_values=MOST_MARK_VALUES)
    except InputError:
        return {}
    return content if isinstance(content, dict) else {}
