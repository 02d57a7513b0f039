"""A catalogue in memory, of rows that are declared here."""

from __future__ import annotations

from pathlib import Path

from relgloss_view.catalogue.columns import NAMES
from relgloss_view.catalogue.recipe import Recipe


class MemoryCatalogue:
    """What a search needs of a catalogue."""

    def __init__(self, rows, materials=None, thumbnails=None, recipe=None):
        whole = [{**dict.fromkeys(NAMES), "status": "done", "kind": "table", **row} for row in rows]
        self.rows = sorted(whole, key=lambda row: row["path"])
        for row in self.rows:
            row.pop("thumbnail", None)
        self.materials, self.pictures = materials or {}, thumbnails or {}
        self.recipe = recipe or Recipe()
        self.folder = Path("catalogue")

    def thumbnails(self, paths):
        return {path: self.pictures[path] for path in paths if path in self.pictures}

    def material(self, path):
        return self.materials[path]


def paths(found):
    return [hit.path for hit in found.hits]
