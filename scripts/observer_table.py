"""The table of docs/experiment.md: how the analysis does with each kind of simulated observers.

python scripts/observer_table.py RESULT.json [...]

RESULT.json is what `relgloss experiment simulate paper --kind all --studies N --json` prints; of
several files with other seeds the rows are put together. Prints Markdown.
"""

from __future__ import annotations

import json
import sys
from collections import Counter
from collections.abc import Iterable
from pathlib import Path
from typing import Any

HEAD = (
    "| observers (`--kind`) | grain weight | true setting leads | it or one beside it "
    "| it is in the set of the best | 95 % interval holds sigma_N, c | verdicts |"
)


def main() -> None:
    """Print the table of the files that the command line names."""
    files = [json.loads(Path(name).read_text(encoding="utf-8")) for name in sys.argv[1:]]
    print("\n".join(table(files)))


def table(files: Iterable[dict[str, Any]]) -> list[str]:
    """A row for each kind of observers and weight of grain, with the number of cases."""
    cases: dict[tuple[str, float | None, bool], list[dict[str, Any]]] = {}
    for found in files:
        for part in found.get("tables", [found]):
            key = (part["kind"], part["grain_weight"], part["one_best"])
            cases.setdefault(key, []).extend(part["studies"])
    lines = [HEAD, "|" + " --- |" * HEAD.count(" |")]
    for (kind, weight, one_best), studies in cases.items():
        cells = (
            kind,
            "sees no picture" if weight is None else f"{weight:+g}",
            share(studies, "exact"),
            share(studies, "near"),
            share(studies, "in_set"),
            intervals(studies),
            verdicts(studies) + ("" if one_best else "; *best* is wrong"),
        )
        lines.append("| " + " | ".join(cells) + " |")
    count = {len(studies) for studies in cases.values()}
    return [*lines, "", f"Samples judged in each row: {', '.join(map(str, sorted(count)))}."]


def share(studies: list[dict[str, Any]], name: str) -> str:
    """Of those cases that have it."""
    values = [s[name] for s in studies if s[name] is not None]
    return f"{100 * sum(values) / len(values):.0f} %" if values else "-"


def intervals(studies: list[dict[str, Any]]) -> str:
    """How often those that there are hold the truth; where some cases have none, of how many."""
    count = sum(s["c_inside"] is not None for s in studies)
    words = f"{share(studies, 'sigma_n_inside')}, {share(studies, 'c_inside')}"
    return words if count in (0, len(studies)) else f"{words} of {count}"


def verdicts(studies: list[dict[str, Any]]) -> str:
    """Each with its share of the cases, the most frequent first."""
    counts = Counter(s["status"] for s in studies).most_common()
    return ", ".join(f"{name} {100 * n / len(studies):.0f} %" for name, n in counts)


if __name__ == "__main__":
    main()
