"""What a name in a query stands for: an item, a built-in paper, or a material file."""

from __future__ import annotations

import difflib
import posixpath
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.catalogue.columns import DONE, READINGS
from relgloss_view.catalogue.look import LAB_LAMP
from relgloss_view.catalogue.query.fault import QueryError
from relgloss_view.catalogue.query.found import Searched
from relgloss_view.catalogue.query.terms import ReferenceName
from relgloss_view.catalogue.query.values import Values, plain
from relgloss_view.gloss.match import gloss_of
from relgloss_view.material.material import Material
from relgloss_view.material.recolour import colour_of
from relgloss_view.picture.scene.sample import SAMPLES, load_sample

MOST_NAMES = 5  #: that a message lists
KEYS = {column: key for key, column in READINGS.items()}


@dataclass(frozen=True)
class Resolved:
    """A reference: what it is in words, the row of an item, and its material when asked for."""

    words: str
    load: Callable[[], Material]
    row: int | None = None  #: its place among the rows; None for a sample outside
    sigma_n_deg: float = 0.0  #: graininess of its picture

    @cached_property
    def material(self) -> Material:
        """Its material."""
        return self.load()

    def reading(self, column: str, values: Values) -> float:
        """Its gloss in a column of columns.READINGS; NaN where it has none."""
        if self.row is not None:
            return float(values.numbers(column)[self.row])
        return gloss_of(self.material, KEYS[column])

    def colour(self, values: Values) -> Array:
        """Its L*, a*, b* at 45/0; NaN where it has none."""
        if self.row is not None:
            return np.asarray(values.colours[self.row])
        return colour_of(self.material, LAB_LAMP)


def resolved(name: ReferenceName, catalogue: Searched, values: Values, text: str) -> Resolved:
    """The sample of a name: by file, by name, by file without folder, without ending, outside.

    text: of the query, for messages. Raises QueryError where there is no such sample or several.
    """
    wanted = plain(name.text)
    paths = values.texts("path")
    for candidates in (
        [k for k, path in enumerate(paths) if path == wanted],
        [k for k, one in enumerate(values.texts("name")) if one == wanted],
        [k for k, path in enumerate(paths) if path and posixpath.basename(path) == wanted],
        [k for k, path in enumerate(paths) if path and _stem(path) == wanted],
    ):
        if len(candidates) > 1:
            candidates = [k for k in candidates if values.rows[k]["status"] == DONE] or candidates
        if len(candidates) == 1:
            return _of_item(candidates[0], catalogue, values, name, text)
        if candidates and name.text not in SAMPLES:
            listed = ", ".join(str(values.rows[k]["path"]) for k in candidates[:MOST_NAMES])
            more = f" and {len(candidates) - MOST_NAMES} more" * (len(candidates) > MOST_NAMES)
            raise QueryError(
                text, *name.span, f"{len(candidates)} items have this name",
                f"write the file of one: {listed}{more}",
            )  # fmt: skip
    if wanted in SAMPLES:
        return Resolved(f"built-in {wanted}", lambda: load_sample(wanted))
    if Path(name.text).suffix.lower() == ".json" and Path(name.text).is_file():
        return Resolved(f"material file {printable(name.text)}", lambda: _of_file(name, text))
    raise _unknown(name, values, text)


def _stem(path: str) -> str:
    return posixpath.splitext(posixpath.basename(path))[0]


def _of_item(
    k: int, catalogue: Searched, values: Values, name: ReferenceName, text: str
) -> Resolved:
    row: Any = values.rows[k]
    path = str(row["path"])
    if row["status"] != DONE:
        raise QueryError(
            text, *name.span, f"{path} failed: {row.get('fault') or 'no results'}",
            "choose another sample",
        )  # fmt: skip
    sigma = float(row.get("sigma_n_deg") or 0.0)
    return Resolved(f"item {path}", lambda: catalogue.material(path), k, sigma)


def _of_file(name: ReferenceName, text: str) -> Material:
    from relgloss_view.material.files import load_material

    try:
        return load_material(name.text)
    except InputError as error:
        raise QueryError(text, *name.span, str(error), "choose another sample") from error


def _unknown(name: ReferenceName, values: Values, text: str) -> QueryError:
    known = dict.fromkeys(
        [str(row.get("name")) for row in values.rows if row.get("name")]
        + [str(row["path"]) for row in values.rows]
        + list(SAMPLES)
    )
    lower = {plain(one): one for one in known}
    wanted = plain(name.text)
    # Close matches of 10,000 names take seconds; names that share words with it come first.
    likely = [one for one in lower if wanted in one or one in wanted][:200]
    near = difflib.get_close_matches(wanted, [*likely, *list(lower)[:2000]], 3, 0.6) or likely[:3]
    remedy = (
        f"did you mean {' or '.join(lower[one] for one in dict.fromkeys(near))}? " if near else ""
    )
    return QueryError(
        text, *name.span, "no item, built-in paper or material file has this name",
        f"{remedy}write the name or the file of an item, one of {', '.join(SAMPLES)}, or a "
        "material file (.json)",
    )  # fmt: skip
