"""A catalogue of made rows: what the panel needs, without a file of the table."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np

from relgloss_view.catalogue.columns import NAMES
from relgloss_view.catalogue.recipe import Recipe

FINISHES = ("gloss", "silk", "matt", "uncoated")


def row_of(k: int) -> dict:
    """Row k: gloss falls with k; every 7th is poor, every 11th is estimated, every 13th failed."""
    path = f"mill-{k % 5}/sheet-{k:05d}.csv"
    gloss = 90.0 / (1.0 + 0.002 * k)
    row = dict.fromkeys(NAMES)
    row |= {
        "path": path, "kind": "table", "status": "done", "sha256": f"{k:064x}", "bytes": 1000 + k,
        "name": f"Sheet {k} {FINISHES[k % 4]}", "source": "made for a test", "marks": "",
        "material": f"materials/{path}.json", "quality": "good", "model": "two lobes",
        "gloss_60": gloss, "gloss_60_se": 0.4, "gloss_20": 0.5 * gloss, "gloss_20_se": 0.5,
        "haze": 3.0, "L_star": 92.0 - 0.001 * k, "a_star": 0.5, "b_star": -2.0,
        "gloss_ratio": gloss / 90.0, "c": 0.1, "c_max": 0.3, "is_ratio_kept": k % 17 != 3,
        "warnings": "", "s_deg_1": 1.0 + 0.01 * k,
    }  # fmt: skip
    if k % 7 == 2:
        row |= {"quality": "poor", "warnings": "the highlight was not measured\nfew angles"}
    if k % 11 == 4:
        row["marks"] = "estimated"
    if k % 13 == 6:
        row = dict.fromkeys(NAMES) | {
            "path": path, "kind": "table", "status": "failed", "fault": "line 3: not a number",
            "bytes": 12,
        }  # fmt: skip
    return row


def png_of(k: int, px: int = 128) -> bytes:
    """A picture that tells its number: its middle has the gray k modulo 200, plus 40."""
    from PIL import Image

    pixels = np.full((px, px, 3), 118, np.uint8)
    pixels[:, px // 4 : -px // 4] = 40 + k % 200
    pixels[px // 3 : px // 3 + 6, px // 4 : -px // 4] = 250
    held = io.BytesIO()
    Image.fromarray(pixels).save(held, "PNG")
    return held.getvalue()


class MadeCatalogue:
    """As much of a Catalogue as searches and the window use; counts what is asked of it."""

    def __init__(self, folder: Path, count: int) -> None:
        self.folder, self.recipe = Path(folder), Recipe()
        self.rows = sorted((row_of(k) for k in range(count)), key=lambda row: row["path"])
        self._numbers = {row_of(k)["path"]: k for k in range(count)}
        self.asked: list[list[str]] = []

    def thumbnails(self, paths):
        wanted = list(paths)
        self.asked.append(wanted)
        return {path: png_of(k) for path in wanted if (k := self._numbers[path]) % 13 != 6}

    def material(self, path):
        from relgloss_view.material.files import load_material

        return load_material(self.folder / f"materials/{path}.json")


def opened_of(folder: Path, count: int):
    """An open catalogue of made rows, with the material files of the first few."""
    from relgloss_view.catalogue.query.search import Searcher
    from relgloss_view.material.files import save_material
    from relgloss_view.picture.scene.sample import load_sample
    from relgloss_view.viewer.state.catalogues import OpenCatalogue

    made = MadeCatalogue(folder, count)
    for row in made.rows[:4]:
        if row["material"]:
            file = Path(folder) / row["material"]
            file.parent.mkdir(parents=True, exist_ok=True)
            save_material(load_sample("art-coated"), file)
    return OpenCatalogue(str(folder), made, Searcher(made))
