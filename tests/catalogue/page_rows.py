"""A result of a search with as many rows as are asked for: seeded, with thumbnails of their own."""

from __future__ import annotations

import io

import numpy as np
from PIL import Image
from search_rows import MemoryCatalogue

from relgloss_view.catalogue.query.search import search


def thumbnail(gray: float, width: float, colour: tuple[float, float, float]) -> bytes:
    """A gray cylinder with a highlight, 128 x 128, as PNG: about as large as a drawn one."""
    x, y = np.meshgrid(np.linspace(-1, 1, 128), np.linspace(-1, 1, 128))
    shade = gray * np.sqrt(np.clip(1 - x**2, 0, 1))[..., None] * np.asarray(colour)
    light = np.exp(-((x - 0.2) ** 2) / width**2 - y**2 / 4)[..., None]
    rgb = np.where(np.abs(x)[..., None] < 0.8, 0.8 * shade + 0.5 * light, 0.47)
    out = io.BytesIO()
    Image.fromarray((255 * np.clip(rgb, 0, 1)).astype(np.uint8)).save(out, "PNG")
    return out.getvalue()


def seeded_rows(count: int, seed: int = 20) -> list[dict]:
    """Rows of tables and materials; every 50th has failed, every 7th has no fit, some no colour."""
    rng = np.random.default_rng(seed)
    rows = []
    for k in range(count):
        gloss = float(rng.uniform(2, 95))
        row = {
            "path": f"lot {k % 9}/stock-{k:05d}.csv",
            "name": f"Stock {k:05d} {'matte' if gloss < 30 else 'gloss'}",
            "kind": "table" if k % 3 else "material",
            "material": f"materials/lot {k % 9}/stock-{k:05d}.json",
            "marks": ("synthetic", "", "estimated, described")[k % 3],
            "quality": None if k % 7 == 0 else ("good", "good", "poor")[k % 3],
            "gloss_20": gloss * 0.4, "gloss_60": gloss, "gloss_60_se": 0.3,
            "gloss_75": gloss * 1.05,
            "gloss_85": min(100.0, gloss * 1.2), "haze": float(rng.uniform(0, 40)),
            "s_deg_1": float(rng.lognormal(1, 0.7)), "L_star": float(rng.uniform(20, 97)),
            "a_star": float(rng.normal(0, 12)), "b_star": float(rng.normal(3, 14)),
            "gloss_ratio": gloss / 60, "is_ratio_kept": k % 11 != 0, "sigma_n_deg": 0.0, "c": 0.1,
            "warnings": "The fit is poor.\nA band was left out." if k % 13 == 0 else "",
        }  # fmt: skip
        if k % 50 == 49:
            row |= {"status": "failed", "fault": "line 3: no number", "material": None}
        if k % 17 == 16:
            row |= dict.fromkeys(("L_star", "a_star", "b_star"))
        rows.append(row)
    return rows


def seeded_catalogue(count: int) -> MemoryCatalogue:
    """A catalogue in memory of seeded rows."""
    rows = seeded_rows(count)
    rng = np.random.default_rng(7)
    pool = [
        thumbnail(rng.uniform(0.3, 1), rng.uniform(0.05, 0.6), tuple(rng.uniform(0.6, 1, 3)))
        for _ in range(min(count, 64))
    ]
    pictures = {row["path"]: pool[k % len(pool)] for k, row in enumerate(rows)
                if row.get("status") != "failed"}  # fmt: skip
    return MemoryCatalogue(rows, thumbnails=pictures)


def seeded(count: int):
    """All rows as found, and their catalogue."""
    catalogue = seeded_catalogue(count)
    return search(catalogue, "", None), catalogue
