"""Made catalogues, in memory or as a folder: what searches, page and panel are tested with.

Usage: python scripts/made_catalogue.py CATALOGUE [COUNT]
"""

from __future__ import annotations

import functools
import io
import json
import sys
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from relgloss_view.catalogue.columns import NAMES, TABLE_FILE
from relgloss_view.catalogue.recipe import Recipe
from relgloss_view.catalogue.tree import FORMAT, MARK
from relgloss_view.material.files import load_material, save_material
from relgloss_view.material.material import Material
from relgloss_view.picture.scene.sample import load_sample

FINISHES = ("gloss", "silk", "matt", "uncoated")
SAMPLE = "art-coated"  #: the material of every row that has one
GRAYS = 200  #: different pictures


def main() -> int:
    """Write a catalogue of COUNT rows, 10,000 by default."""
    write(Path(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 10_000)
    return 0


def row_of(k: int) -> dict[str, Any]:
    """Row k: gloss falls with k; every 7th is poor, every 11th is estimated, every 13th failed."""
    path = f"mill-{k % 5}/sheet-{k:05d}.csv"
    row: dict[str, Any] = dict.fromkeys(NAMES)
    if is_failed(k):
        row |= {"path": path, "kind": "table", "status": "failed", "bytes": 12}
        return row | {"fault": "line 3: not a number"}
    gloss = 90.0 / (1.0 + 0.002 * k)
    row |= {"path": path, "kind": "table", "status": "done", "sha256": f"{k:064x}"}
    row |= {"name": f"Sheet {k} {FINISHES[k % 4]}", "source": "made for a test", "marks": ""}
    row |= {"material": f"materials/{path}.json", "quality": "good", "model": "two-lobes"}
    row |= {"gloss_60": gloss, "gloss_60_se": 0.4, "gloss_20": 0.5 * gloss, "gloss_20_se": 0.5}
    row |= {"haze": 3.0, "s_deg_1": 1.0 + 0.01 * k, "bytes": 1000 + k, "warnings": ""}
    row |= {"L_star": 92.0 - 0.001 * k, "a_star": 0.5, "b_star": -2.0}
    row |= {"gloss_ratio": gloss / 90.0, "c": 0.1, "c_max": 0.3, "is_ratio_kept": k % 17 != 3}
    if k % 7 == 2:
        row |= {"quality": "poor", "warnings": "the highlight was not measured\nfew angles"}
    if k % 11 == 4:
        row["marks"] = "estimated"
    return row


def is_failed(k: int) -> bool:
    """Whether row k has no material and no picture."""
    return k % 13 == 6


@functools.cache
def png_of(k: int, px: int = 128) -> bytes:
    """A picture of one of GRAYS grays, with a grain that makes its file as long as a real one."""
    from PIL import Image

    rng = np.random.default_rng(k)
    pixels = np.full((px, px, 3), 118, np.uint8)
    grain = rng.integers(0, 8, (px, px // 2, 1))
    pixels[:, px // 4 : -px // 4] = 40 + k % GRAYS + grain
    pixels[px // 3 : px // 3 + 6, px // 4 : -px // 4] = 250
    held = io.BytesIO()
    Image.fromarray(pixels).save(held, "PNG")
    return held.getvalue()


def sorted_rows(count: int) -> list[tuple[int, dict[str, Any]]]:
    """Numbers and rows, sorted by path as a catalogue has them."""
    return sorted(((k, row_of(k)) for k in range(count)), key=lambda one: str(one[1]["path"]))


def write(folder: Path, count: int, materials: int = 20) -> None:
    """Write a catalogue as a folder, with the material files of the first rows."""
    from relgloss_view.catalogue.table import VERSION, write_table

    folder.mkdir(parents=True, exist_ok=True)
    (folder / MARK).write_text(json.dumps({"format": FORMAT, "version": 1}), encoding="utf-8")
    metadata = {"format": FORMAT, "version": VERSION, "recipe": Recipe().as_json()}
    rows = sorted_rows(count)

    def pictured() -> Iterator[dict[str, Any]]:
        for k, row in rows:
            yield row if is_failed(k) else row | {"thumbnail": png_of(k % GRAYS)}

    write_table(folder / TABLE_FILE, pictured(), metadata, folder / TABLE_FILE)
    write_materials(folder, (row for _, row in rows[:materials]))


def write_materials(folder: Path, rows: Iterable[dict[str, Any]]) -> None:
    """Write the material files of rows."""
    material = load_sample(SAMPLE)
    for row in rows:
        if row["material"]:
            file = folder / row["material"]
            file.parent.mkdir(parents=True, exist_ok=True)
            save_material(material, file)


class MemoryCatalogue:
    """As much of a Catalogue as searches, pages and the window use, of rows that are declared.

    rows: what they lack is empty; done tables unless they say otherwise. materials, thumbnails
    (PNG): by path. `asked` notes the paths of the thumbnails that were asked for.
    """

    def __init__(
        self,
        rows: Iterable[dict[str, Any]],
        materials: Mapping[str, Material] | None = None,
        thumbnails: Mapping[str, bytes] | None = None,
        recipe: Recipe | None = None,
        folder: str | Path = "catalogue",
    ) -> None:
        usual = {**dict.fromkeys(NAMES), "status": "done", "kind": "table"}
        self.rows = sorted(({**usual, **row} for row in rows), key=lambda row: str(row["path"]))
        for row in self.rows:
            row.pop("thumbnail", None)
        self.materials, self.pictures = materials or {}, thumbnails or {}
        self.recipe, self.folder = recipe or Recipe(), Path(folder)
        self.asked: list[list[str]] = []

    def picture(self, path: str) -> bytes | None:
        """The picture of an item; None where it has none."""
        return self.pictures.get(path)

    def thumbnails(self, paths: Iterable[str]) -> dict[str, bytes]:
        """Pictures by path."""
        wanted = list(paths)
        self.asked.append(wanted)
        made = ((path, self.picture(path)) for path in wanted)
        return {path: picture for path, picture in made if picture is not None}

    def material(self, path: str) -> Material:
        """The material of an item."""
        return self.materials[path]


class MadeCatalogue(MemoryCatalogue):
    """The rows of row_of, with their pictures; the first few have material files."""

    def __init__(self, folder: Path, count: int) -> None:
        super().__init__((row_of(k) for k in range(count)), folder=folder)
        self._numbers = {str(row_of(k)["path"]): k for k in range(count)}
        write_materials(self.folder, self.rows[:4])

    def picture(self, path: str) -> bytes | None:
        """The picture of an item; None where it has none."""
        k = self._numbers[path]
        return None if is_failed(k) else png_of(k % GRAYS)

    def material_file(self, path: str) -> Path:
        """The material file of an item."""
        return self.folder / f"materials/{path}.json"

    def material(self, path: str) -> Material:
        """The material of an item."""
        return load_material(self.material_file(path))


if __name__ == "__main__":
    sys.exit(main())
