"""`relgloss bench --stability`: maps of where methods fail, as figures and numbers."""

from __future__ import annotations

import json
from pathlib import Path

from relgloss_view.base.reading import printable
from relgloss_view.base.terminal import Progress
from relgloss_view.base.writing import whole_folder

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
        found = {
            "format": FORMAT,
            "version": VERSION,
            "quick": quick,
            "machine": made,
            "maps": stability.as_json(maps),
        }
        text = json.dumps(found, allow_nan=False) + "\n"
        (temporary / RESULTS).write_text(text, encoding="utf-8")
        names = stability_figures.write_figures(maps, temporary)
    if as_json:
        print(json.dumps(found, allow_nan=False))
        return 0
    print(stability.summary_table(maps))
    print(f"{printable(folder)}: {', '.join(names)}, {RESULTS}")
    return 0
