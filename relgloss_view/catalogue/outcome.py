"""The outcome of a build: the table and the folder of materials, written from the store."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.interruptions import checkpoint
from relgloss_view.base.json_files import read_mark
from relgloss_view.base.reading import named
from relgloss_view.base.terminal import ProgressReport
from relgloss_view.base.version import __version__
from relgloss_view.catalogue import table
from relgloss_view.catalogue.columns import DONE, FAILED, TABLE_FILE
from relgloss_view.catalogue.places import (
    FOLDER,
    SUFFIX,
    from_system,
    in_system,
    material_places,
)
from relgloss_view.catalogue.recipe import Recipe
from relgloss_view.catalogue.store import PART, Store, put_whole
from relgloss_view.catalogue.tree import FORMAT, Entry
from relgloss_view.material.files import FORMAT as MATERIAL_FORMAT
from relgloss_view.material.files import material_text


@dataclass
class Written:
    """What was written and removed."""

    done: int = 0
    removed: int = 0
    qualities: dict[str, int] = field(default_factory=dict)  #: how many fits of each
    drivers: set[str] = field(default_factory=set)
    materials: set[str] = field(default_factory=set)  #: from the catalogue's folder


def write_outcome(
    catalogue: Path,
    entries: Sequence[Entry],
    keys: Mapping[str, str],
    store: Store,
    recipe: Recipe,
    progress: ProgressReport,
) -> Written:
    """Write the materials, then the table, then remove the materials that no row names.

    entries: sorted by path. keys: the record of each path; one without is a failed row. Raises
    InputError where something can't be written; the former table stays then.
    """
    written = Written()
    places = material_places(entry.path for entry in entries)
    metadata: dict[str, Any] = {
        "format": FORMAT,
        "version": table.VERSION,
        "program": __version__,
        "recipe": recipe.as_json(),
        "drivers": [],
    }

    def rows() -> Iterator[dict[str, Any]]:
        for number, entry in enumerate(entries):
            checkpoint()
            progress(number / len(entries), f"{number + 1:,} of {len(entries):,} rows written")
            yield _row(catalogue, entry, keys.get(entry.path), places, store, written)
        metadata["drivers"] = sorted(written.drivers)

    table.write_table(catalogue / TABLE_FILE, rows(), metadata, catalogue)
    written.removed = _remove_others(catalogue, written.materials)
    return written


def _row(
    catalogue: Path,
    entry: Entry,
    key: str | None,
    places: Mapping[str, str],
    store: Store,
    written: Written,
) -> dict[str, Any]:
    """The row of a file, whose material is written."""
    row: dict[str, Any] = {"path": entry.path, "kind": entry.kind, "bytes": entry.size}
    if key is None:
        return row | {"status": FAILED, "fault": entry.fault}
    item = store.item(key)
    if item is None:
        raise InputError(f"{named(catalogue)}: the store was changed meanwhile; build again")
    row = item.row | row
    if item.material is not None:
        text = material_text(item.material).encode("utf-8")
        _put_changed(catalogue / in_system(places[entry.path]), text, catalogue)
        row["material"] = places[entry.path]
        written.materials.add(places[entry.path])
    if item.driver:
        written.drivers.add(item.driver)
    written.done += row["status"] == DONE
    if row.get("quality"):
        written.qualities[row["quality"]] = written.qualities.get(row["quality"], 0) + 1
    return row


def _put_changed(path: Path, data: bytes, named_as: Path) -> None:
    """Write a file unless it holds this already."""
    with contextlib.suppress(OSError):
        if path.stat().st_size == len(data) and path.read_bytes() == data:
            return
    put_whole(path, data, named_as)


def _remove_others(catalogue: Path, kept: set[str]) -> int:
    """Remove the materials that are none of `kept`, and folders without any; how many there were.

    What is no material of this program stays.
    """
    removed = 0
    for folder, _, names in os.walk(catalogue / FOLDER, topdown=False):
        for name in names:
            checkpoint()
            path = Path(folder) / name
            place = from_system(path.relative_to(catalogue).as_posix())
            if place in kept:
                continue
            is_part = name.startswith(".") and name.endswith(PART)
            if is_part or (name.endswith(SUFFIX) and _is_material(path)):
                with contextlib.suppress(OSError):
                    path.unlink()
                    removed += not is_part
        with contextlib.suppress(OSError):  # it holds files
            os.rmdir(folder)
    return removed


def _is_material(path: Path) -> bool:
    return read_mark(path).get("format") == MATERIAL_FORMAT
