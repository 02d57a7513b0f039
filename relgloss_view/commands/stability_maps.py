"""`relgloss bench --stability`: maps of where methods fail, as figures and numbers."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from relgloss_view.base.reading import printable
from relgloss_view.base.terminal import Column, Progress, table
from relgloss_view.base.writing import whole_folder

if TYPE_CHECKING:
    from relgloss_view.bench.stability.maps import Map

FORMAT, VERSION = "relgloss-stability", 1
RESULTS = "stability.json"
QUICK_CELLS = 12  #: along each side of a map


def run(folder: Path, backend: str, *, quick: bool, as_json: bool) -> int:
    """Draw the maps beside the folder, and move the files in when the last is done."""
    from relgloss_view.bench.speed.machine import machine
    from relgloss_view.bench.stability import figures as stability_figures
    from relgloss_view.bench.stability import maps as stability
    from relgloss_view.picture.gpu.context import open_context

    with Progress("bench") as progress, whole_folder(folder, last=RESULTS) as temporary:
        ctx = open_context(backend)
        try:
            made = machine(ctx)
            maps = stability.all_maps(ctx, progress, QUICK_CELLS if quick else None)
        finally:
            ctx.release()
        results = {
            "format": FORMAT,
            "version": VERSION,
            "quick": quick,
            "machine": made,
            "maps": stability.as_json(maps),
        }
        text = json.dumps(results, allow_nan=False) + "\n"
        (temporary / RESULTS).write_text(text, encoding="utf-8")
        names = stability_figures.write_figures(maps, temporary)
    if as_json:
        print(json.dumps(results, allow_nan=False))
        return 0
    print(_summary(maps))
    print(f"{printable(folder)}: {', '.join(names)}, {RESULTS}")
    return 0


COLUMNS = (
    Column("", 40, left=True),
    Column("cells", 7),
    Column("inside", 6),
    Column("worst inside", 12),
    Column("bound", 6),
    Column("failed", 6),
)


def _summary(maps: list[Map]) -> str:
    """A row for each map of errors: cells, those in its domain, their largest error, failures."""
    return table(COLUMNS, [_row(m) for m in maps if m.subject.is_error], indent="  ")


def _row(m: Map) -> tuple[str, ...]:
    domain = m.subject.domain
    inside = int(np.sum(m.inside)) if domain else 0
    worst = f"{np.max(m.error[m.inside]):.1e}" if inside else "nowhere"
    in_domain = (str(inside), worst, f"{domain.bound:g}") if domain else ("", "", "")
    failed = int(np.sum(~np.isfinite(m.error)))
    return (m.subject.title, str(m.error.size), *in_domain, str(failed))
