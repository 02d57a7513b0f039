"""Values: the columns of a catalogue as arrays, made when a query first asks for them."""

from __future__ import annotations

import unicodedata
from collections.abc import Mapping, Sequence
from functools import cache
from typing import Any

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.catalogue.columns import LAB
from relgloss_view.catalogue.query.vocabulary import EMPTY_IS_TEXT


def plain(text: str) -> str:
    """A text as it is compared: composed characters, without upper and lower case.

    >>> plain("GLA\\u0308NZEND") == plain("gl\\u00e4nzend")
    True
    """
    return unicodedata.normalize("NFC", unicodedata.normalize("NFKC", text).casefold())


class Values:
    """Columns of rows, which are dictionaries by columns.NAMES; None is a missing value."""

    def __init__(self, rows: Sequence[Mapping[str, Any]]) -> None:
        self.rows = rows
        self.numbers = cache(self._numbers)
        self.texts = cache(self._texts)

    def __len__(self) -> int:
        return len(self.rows)

    def _numbers(self, column: str) -> Array:
        """A column's numbers (N,); NaN where there is none."""
        values = [row.get(column) for row in self.rows]
        return np.array([np.nan if v is None else float(v) for v in values], dtype=np.float64)

    def _texts(self, column: str) -> tuple[str | None, ...]:
        """A column's texts as they are compared; None where there is none."""
        empty = "" if column in EMPTY_IS_TEXT else None
        values = (row.get(column) for row in self.rows)
        return tuple(plain(str(v)) if v not in (None, "") else empty for v in values)

    @property
    def colours(self) -> Array:
        """L*, a*, b* (N, 3); NaN where there is none."""
        return np.stack([self.numbers(name) for name in LAB], axis=-1)
