"""The check grid: what a picture is at points spread over it, to be compared on another machine."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from relgloss_view.base.arrays import AnyArray, Array
from relgloss_view.base.errors import InputError
from relgloss_view.material.difference import delta_e_2000
from relgloss_view.proof.entries import MOST_LAB
from relgloss_view.proof.pair import Drawn

COLUMNS = ROWS = 24
DECIMALS = 4  #: of L*, a*, b*: far below the rounding of float32 in them
#: dE2000 that no eye sees, and above what float32 does to the same picture on two machines.
LARGEST_DE2000 = 0.3
#: Of the grid's points, that may show the object in one of both alone: another rounding moves a
#: silhouette by less than a pixel.
MISSED_SHARE = 0.01


@dataclass(frozen=True)
class Comparison:
    """How far a picture is from a grid.

    largest, mean: dE2000 over the points that show the object in both. points: how many those are.
    missed: how many show it in one of both alone, as at a silhouette.
    """

    largest: float
    mean: float
    points: int
    missed: int

    @property
    def is_same(self) -> bool:
        """Whether nobody sees a difference; the page, with shaders of its own, asks for more."""
        few = self.missed <= MISSED_SHARE * (self.points + self.missed)
        return self.points > 0 and self.largest <= LARGEST_DE2000 and few


def places(size: tuple[int, int]) -> tuple[AnyArray, AnyArray]:
    """Columns and rows of the grid's pixels in a picture of this size, (COLUMNS,) and (ROWS,).

    >>> [part[:2].tolist() for part in places((512, 480))]
    [[10, 32], [10, 30]]
    """
    width, height = size
    columns = ((2 * np.arange(COLUMNS) + 1) * width) // (2 * COLUMNS)
    rows = ((2 * np.arange(ROWS) + 1) * height) // (2 * ROWS)
    return columns, rows


def grid_of(pictures: Mapping[str, Drawn]) -> dict[str, Any]:
    """The grid of both pictures as a proof's JSON holds it, row by row from the top."""
    sides = {}
    for name, picture in pictures.items():
        at = _at(picture)
        seen = picture.on_object[at].ravel()
        lab = np.round(picture.lab[at].astype(np.float64).reshape(-1, 3), DECIMALS)
        sides[name] = {
            "lab": [_plain(row) if there else None for row, there in zip(lab, seen, strict=True)],
            "l_d": _column(picture.l_d[at], seen),
            "l_s": _column(picture.l_s[at], seen),
        }
    return {"columns": COLUMNS, "rows": ROWS, "sides": sides}


def compare(side: Mapping[str, Any], picture: Drawn) -> Comparison:
    """A side of a grid beside a picture of the same size.

    side: of content["grid"]["sides"]. Raises InputError for anything else.
    """
    try:
        return _compared(side, picture)
    except (AttributeError, IndexError, KeyError, TypeError, ValueError):
        raise InputError("content.grid: expected the points of both pictures") from None


def _compared(side: Mapping[str, Any], picture: Drawn) -> Comparison:
    at = _at(picture)
    seen = picture.on_object[at].ravel()
    drawn = picture.lab[at].astype(np.float64).reshape(-1, 3)
    kept = np.array([row is not None for row in side["lab"]])
    both = seen & kept
    if not both.any():
        return Comparison(0.0, 0.0, 0, int(np.sum(seen != kept)))
    lab = np.array([row for row, there in zip(side["lab"], both, strict=True) if there], float)
    if not (np.abs(lab) <= MOST_LAB).all():
        raise ValueError("beyond any colour")
    differences = delta_e_2000(lab, drawn[both])
    return Comparison(
        float(np.max(differences)),
        float(np.mean(differences)),
        int(np.sum(both)),
        int(np.sum(seen != kept)),
    )


def _at(picture: Drawn) -> Any:
    height, width = picture.on_object.shape
    columns, rows = places((width, height))
    return np.ix_(rows, columns)


def _column(values: Array, seen: Array) -> list[float | None]:
    rounded = np.round(np.asarray(values, np.float64).ravel(), DECIMALS)
    return [_number(v) if there else None for v, there in zip(rounded, seen, strict=True)]


def _plain(row: Array) -> list[float]:
    return [_number(v) for v in row]


def _number(value: float) -> float:
    return float(value) + 0.0  # no -0, which JSON writes as 0
