"""The tables of docs/bench.md, from the results.json of a run: what stands below its last heading.

python scripts/bench_tables.py FOLDER/results.json "what else ran beside it"
"""

from __future__ import annotations

import json
import re
import statistics
import sys
import textwrap
from collections.abc import Iterable
from pathlib import Path
from typing import Any

Found = dict[str, Any]

DOCUMENT = Path(__file__).resolve().parent.parent / "docs" / "bench.md"
HEADING = "## What was found"
CHANGES = {
    "lamp": "full frame, matte paper with grain",
    "sigma_n": "sigma_N alone changed",
    "c": "c alone changed",
}


def main() -> None:
    """Write them into the document, in place of the last ones."""
    found = json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))
    text = DOCUMENT.read_text(encoding="utf-8").partition(HEADING)[0]
    lines = [HEADING, "", *told(found, sys.argv[2]), "", *methods(found), "", *others(found)]
    DOCUMENT.write_text(text + "\n".join(lines) + "\n", encoding="utf-8")


def told(found: Found, beside: str) -> list[str]:
    """Machine, driver and floor."""
    made = found["machine"]
    mesa = re.search(r"Mesa [0-9.]+", made["opengl"]["version"])
    floors = [scene["floor_ms"] for scene in found["scenes"]]
    said = (
        f"{made['cpu'].replace('(R)', '')}, {made['cores']} cores, {made['opengl']['renderer']}"
        f"{', ' + mesa[0] if mesa else ''}, {made['date'][:10]}; {beside}. Times are medians of "
        f"{found['settings']['frames']} frames at {'x'.join(map(str, found['settings']['size']))}, "
        f"the floor's {min(floors):.1f} to {max(floors):.1f} ms; errors are those of the worst of "
        f"the {len(floors)} scenes."
    )
    return textwrap.wrap(said, 105)


def methods(found: Found) -> Iterable[str]:
    """A line a method."""
    yield "| method | x floor | p95, object | p95, highlight | largest | c_max off by, % |"
    yield "| --- | --- | --- | --- | --- | --- |"
    for entry in found["methods"]:
        c_max = entry["worst_c_max"]
        cells = [
            entry["label"],
            f"{entry['floors']:.2f}",
            *(number(entry[key]) for key in ("object_p95", "highlight_p95", "worst_max")),
            "" if c_max is None else number(100.0 * c_max),
        ]
        yield f"| {' | '.join(cells)} |"


def others(found: Found) -> Iterable[str]:
    """What was measured beside the chart."""
    yield "| what | found |"
    yield "| --- | --- |"
    for key, name in CHANGES.items():
        changed = found["changes"][key]
        yield f"| {name} | {changed['ms']:.1f} ms, {changed['floors']:.2f} x floor |"
    passes = [f"{name} {ms:.1f}" for name, ms in found["passes"]["wall_ms"].items()]
    yield f"| its passes, ms | {', '.join(passes)} |"
    faster = [entry["faster"] for entry in found["auto"]]
    worst = [max(entry[key] for entry in found["auto"]) for key in ("worst_p95", "worst_max")]
    yield (
        f"| quality auto | {min(faster):.2f} to {max(faster):.2f} times as fast as the default; "
        f"p95 at most {worst[0]:.2f}, largest {worst[1]:.1f} |"
    )
    mean, apart = (
        statistics.median(r[key]["highlight"]["p95"] for r in found["results"] if key in r)
        for key in ("error_against_mean", "mean_halves_apart")
    )
    yield (
        f"| mean of the grain, from that of {found['settings']['grains']} grains | p95 over the "
        f"highlight {mean:.2f}, median scene; halves of the grains are {apart:.2f} apart |"
    )
    yield f"| 42 stimuli at 512x512 as PNG | {found['grid']['seconds']:.2f} s |"
    for peer in found["peers"]:
        if peer.get("fault"):
            yield f"| {peer['name']} | not available |"
        else:
            times = f"{peer['ms']:.0f} ms, {1.0 / peer['ours']:.3g} times ours"
            if peer.get("auto"):
                times += f", {1.0 / peer['auto']:.3g} times ours by quality auto"
            yield f"| {peer['name']}: {peer['note']} | {times} |"
    sizes = [
        f"{row['megapixels']:.3g} Mpx {100.0 * row['residual']:+.0f} %"
        for row in found["pixels"]["sizes"]
        if row.get("residual") is not None
    ]
    yield f"| time against pixels, off a straight line | {', '.join(sizes)} |"


def number(value: float | None) -> str:
    """Two digits, and none below what can be told apart."""
    if value is None:
        return "-"
    return "< 0.01" if value < 0.01 else f"{value:.2f}" if value < 1.0 else f"{value:.1f}"


if __name__ == "__main__":
    main()
