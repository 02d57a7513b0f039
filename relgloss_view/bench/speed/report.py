"""A run's numbers as files and as lines for a terminal."""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from relgloss_view.base.csv_files import write_csv
from relgloss_view.base.reading import printable
from relgloss_view.base.terminal import Column, table

Found = dict[str, Any]

FORMAT, VERSION = "relgloss-bench", 1
RESULTS, TABLE = "results.json", "results.csv"
PARTS, STATISTICS = ("object", "highlight"), ("mean", "p95", "max")
COLUMNS = (
    "scene",
    "method",
    "group",
    "sigma_n_deg",
    "samples_per_pixel",
    "ms",
    "floors",
    "frames",
    "c_max",
    "c_max_error",
    *(f"{part}_{name}" for part in PARTS for name in (*STATISTICS, "pixels")),
    "fault",
)


def write_results(found: Found, folder: Path) -> None:
    """results.json, everything; results.csv, one line a row and scene."""
    text = json.dumps(found, indent=1) + "\n"
    (folder / RESULTS).write_text(text, encoding="utf-8")
    rows = (_flat(result) for result in found["results"])
    write_csv(folder / TABLE, COLUMNS, ([row.get(name, "") for name in COLUMNS] for row in rows))


def _flat(result: Found) -> Found:
    row = {name: result.get(name) for name in COLUMNS}
    error = result["error"] or {}
    row["c_max_error"] = error.get("c_max")
    for part in PARTS:
        spread = error.get(part) or {}
        row |= {f"{part}_{name}": value for name, value in spread.items()}
    return {name: "" if value is None else value for name, value in row.items()}


def lines(found: Found) -> Iterable[str]:
    """What a terminal shows."""
    made, settings = found["machine"], found["settings"]
    width, height = settings["size"]
    device = printable(made["opengl"]["renderer"], 80)
    yield f"{printable(made['cpu'], 80)}, {made['cores']} cores; {device}"
    error_size = "x".join(map(str, settings["error_size"]))
    yield (
        f"{len(found['scenes'])} scenes at {width}x{height}, medians of {settings['frames']} "
        f"frames; errors at {error_size}, dE2000, worst scene"
    )
    floors = [scene["floor_ms"] for scene in found["scenes"]]
    yield f"fill floor {min(floors):.1f} to {max(floors):.1f} ms"
    yield ""
    yield table(METHOD_COLUMNS, [_method_row(entry) for entry in found["methods"]])
    yield "* nothing else is both faster and nearer"
    yield from _others(found)


METHOD_COLUMNS = (
    Column("", 32, left=True),
    Column("ms", 6),
    Column("x floor", 7),
    Column("p95\nobject", 6),
    Column("p95 of\nhighlight", 9),
    Column("max", 6),
    Column("c_max\noff by", 7),
)


def _method_row(entry: Found) -> tuple[str, ...]:
    return (
        f"{'*' if entry['front'] else ' '} {entry['label']}",
        f"{entry['ms']:.1f}",
        f"{entry['floors']:.2f}",
        _number(entry["object_p95"]),
        _number(entry["highlight_p95"]),
        _number(entry["worst_max"]),
        _percent(entry["worst_c_max"]),
    )


#: Where a result has an error against something else, too: that, and what it is called.
FURTHER = {
    "error_against_mean": "the mean of many grains",
    "error_against_area": "pixels averaged over their area",
}


def _others(found: Found) -> Iterable[str]:
    for key, truth in FURTHER.items():
        worst: dict[str, float] = {}
        for result in found["results"]:
            if key in result:
                label = result["label"]
                worst[label] = max(worst.get(label, 0.0), result[key]["worst_p95"])
        told = [f"{label} p95 {_number(p95)}" for label, p95 in worst.items()]
        if told:
            yield f"against {truth}: {', '.join(told)}"
    if auto := found.get("auto"):
        faster = [entry["faster"] for entry in auto]
        whole = [e for entry in auto if (e := entry["faster_than_everything"])]
        beside = f"{min(whole):.2f} to {max(whole):.2f} as everything drawn; " if whole else ""
        worst = max(entry["worst_p95"] for entry in auto)
        yield (
            f"quality auto: {min(faster):.2f} to {max(faster):.2f} times as fast as the default, "
            f"{beside}p95 at most {worst:.2f}"
        )
    if changes := found.get("changes"):
        told = [
            f"{label} {changes[name]['ms']:.1f} ms = {changes[name]['floors']:.2f} x floor"
            for name, label in (("lamp", "full frame"), ("sigma_n", "sigma_N"), ("c", "c"))
        ]
        yield f"changed alone, {changes['scene']}: {', '.join(told)}"
    if passes := found.get("passes"):
        told = [f"{name} {ms:.1f}" for name, ms in passes["wall_ms"].items()]
        yield f"passes, ms: {', '.join(told)}; device clock {passes['device_clock']}"
    if grid := found.get("grid"):
        yield f"grid: {grid['stimuli']} stimuli at 512x512 as PNG in {grid['seconds']:.2f} s"
    if pixels := found.get("pixels"):
        told = [f"{row['megapixels']:.2f} Mpx {_off_line(row)}" for row in pixels["sizes"]]
        yield f"pixels, off the line: {', '.join(told)}"
    for peer in found.get("peers", ()):
        yield f"{peer['name']}: {_peer(peer)}"


def _off_line(row: Found) -> str:
    if row.get("residual") is None:
        return str(row.get("fault", "not fitted"))
    return f"{row['steady_ms']:.1f} ms ({100 * row['residual']:+.0f} %)"


def _peer(peer: Found) -> str:
    if peer.get("fault"):
        return f"not available: {printable(peer['fault'], 200)}"
    told = f"{peer['ms']:.0f} ms"
    if peer.get("floors") is not None:
        told += f" = {peer['floors']:.1f} x floor"
    return f"{told}, {1.0 / peer['ours']:.3g} times ours ({peer['note']})"


def _percent(share: float | None) -> str:
    if share is None:
        return ""
    return "< 0.01 %" if share < 1e-4 else f"{100.0 * share:.2g} %"


def _number(value: float | None) -> str:
    if value is None:
        return "-"
    return f"{value:.3f}" if value < 1.0 else f"{value:.1f}"
