"""Trees of samples that tests of catalogues build, and a cheap stand-in for the work on a file."""

from __future__ import annotations

import dataclasses
import hashlib
import json
from pathlib import Path

import materials

from relgloss_view.base.resources import asset
from relgloss_view.catalogue.columns import DONE, FAILED
from relgloss_view.catalogue.item import OF_FILE, OF_MACHINE, Fitted, Item
from relgloss_view.catalogue.recipe import Recipe
from relgloss_view.material.files import material_to_dict, save_material

BROKEN_TABLE = "# quantity: brdf\nalpha_deg,beta_deg,gamma_deg,550\n30,-30,0,none\n"


def save(path: Path, paper: str = "art", name: str | None = None) -> Path:
    """A material file of one of materials.PAPERS."""
    path.parent.mkdir(parents=True, exist_ok=True)
    material = materials.paper(paper)
    save_material(dataclasses.replace(material, name=name or path.stem), path)
    return path


def small_table(path: Path) -> Path:
    """A tenth of the art-coated paper's table, which a fit of one model reads in no time."""
    path.parent.mkdir(parents=True, exist_ok=True)
    lines = asset("papers", "art-coated.csv").read_text(encoding="utf-8").splitlines()
    first = next(k for k, line in enumerate(lines) if line.startswith("alpha"))
    kept = lines[: first + 1] + lines[first + 1 :: 10]
    path.write_text("\n".join(kept) + "\n", encoding="utf-8")
    return path


def contents(folder: Path) -> dict[str, bytes]:
    """All files of a catalogue but the lock, by their paths."""
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and path.name != ".lock"
    }


def quick_item(
    file: str, path: str, kind: str, sha256: str, recipe: Recipe, fitted: Fitted | None = None
) -> Item:
    """In place of make_item: numbers that the digest gives; files named by a fault have it."""
    row = {"path": path, "kind": kind, "sha256": sha256}
    if "broken" in path or "lonely" in path:
        where = OF_FILE if "broken" in path else OF_MACHINE
        return Item({**row, "status": FAILED, "fault": "line 3: is broken"}, failed_in=where)
    if fitted is None:
        material = dataclasses.replace(materials.paper("art"), name=sha256[:8])
        fitted = Fitted(json.loads(json.dumps(material_to_dict(material))), 7)
    digest = hashlib.sha256((sha256 + recipe.of_look).encode()).digest()
    row |= {"name": sha256[:8], "gloss_60": digest[0] / 7.0, "thumbnail": digest * 30}
    return Item({**row, "status": DONE}, fitted.material, fitted, driver="none")


def quick_tree(folder: Path, count: int = 6) -> Path:
    """A tree for quick_item."""
    for k in range(count):
        save(folder / f"lot {k % 3}" / f"stock-{k}.json", name=f"stock {k}")
    return folder
