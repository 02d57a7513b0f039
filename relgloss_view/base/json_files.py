"""JSON files of this program: what they ask for is counted before they are decoded."""

from __future__ import annotations

import json
import os
from typing import Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.nesting import MOST_JSON_VALUES, check_json
from relgloss_view.base.reading import decoding, printable, read_text


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
    try:
        check_json(written, most_values)
    except InputError as error:
        raise InputError(f"{path}: {error}") from error
    with decoding(path, expected):
        try:
            return json.loads(written)
        except ValueError as error:
            raise InputError(f"{path}: not JSON: {printable(error)}") from error
