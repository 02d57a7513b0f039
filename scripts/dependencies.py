"""Licences and known advisories of every package that requirements/ locks.

    python scripts/dependencies.py                          # licences, from what is installed
    python scripts/dependencies.py --advisories FOLDER      # and advisories from files
    python scripts/dependencies.py --audit                  # and from pip-audit, if installed
    python scripts/dependencies.py --index                  # and from the package index
    python scripts/dependencies.py --markdown               # as the tables of docs/dependencies.md

The first line needs no network. What a source could not answer is "not checked", never "none
known". The exit status is 1 where an advisory was found or a licence asks for a decision that
DECIDED does not hold, and 0 otherwise.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from advisories import Advisory, Answers, from_audit, from_files, from_index
from licences import ABSENT, PERMISSIVE, WORST, Licence, fonts, licence_of
from locked import ROOT, Pin, locked_sets

from relgloss_view.base.terminal import Column, table

#: Licences that ask for a decision, and ours.
DECIDED = {
    "certifi": "MPL-2.0: comes with selenium, for the tests alone; nothing of it is distributed",
    "hypothesis": "runs the tests alone; nothing of it is distributed",
    "pikepdf": "MPL-2.0: used as it is, as a library; its files are not changed",
    "pathspec": "builds the wheel and runs mypy; nothing of it is distributed",
}
#: What the metadata do not hold.
NOTES = {
    "imgui-bundle": "brings the Dear ImGui Test Engine, whose licence is not MIT: the tests use it,"
    " the program does not",
    "numpy": "its wheels bring OpenBLAS (BSD) and libgfortran (GPL-3.0-or-later WITH "
    "GCC-exception-3.1)",
    "pyarrow": "its wheels bring Arrow's C++ libraries and what they use, named in its LICENSE.txt",
    "pyradiance": "its wheels bring programs of Radiance, which the tests run",
    "scipy": "its wheels bring what numpy's do",
}


def main(argv: list[str] | None = None) -> int:
    """Read, judge, ask the sources that were named, print."""
    args = _parser().parse_args(argv)
    pins = locked_sets(args.requirements)
    licences = {pin.name: licence_of(pin) for pin in pins}
    answers = [
        *(from_files(Path(path), pins) for path in args.advisories),
        *([from_audit(args.requirements, pins)] if args.audit else []),
        *([from_index(pins)] if args.index else []),
    ]
    print(_table(pins, licences, answers, markdown=args.markdown))
    print()
    undecided = [
        pin.name
        for pin in pins
        if licences[pin.name].verdict not in (PERMISSIVE, ABSENT) and pin.name not in DECIDED
    ]
    found = [(pin, a) for pin in pins for answer in answers for a in answer.found.get(pin.name, ())]
    for line in _summary(pins, licences, answers, undecided, found):
        print(f"- {line}" if args.markdown else line)
    return 1 if undecided or found else 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    add = parser.add_argument
    add(
        "--advisories",
        metavar="PATH",
        action="append",
        default=[],
        help="File, folder or zip of advisories in OSV's JSON, or in the PyPA database's YAML",
    )
    add("--audit", action="store_true", help="Ask pip-audit, which asks its service")
    add("--index", action="store_true", help="Ask the package index about each locked version")
    add("--markdown", action="store_true", help="Print tables for docs/dependencies.md")
    add(
        "--requirements",
        metavar="FOLDER",
        type=Path,
        default=ROOT / "requirements",
        help="Folder of the lock files",
    )
    return parser


def _table(
    pins: list[Pin], licences: dict[str, Licence], answers: list[Answers], *, markdown: bool
) -> str:
    heads = ("package", "version", "needed by", "licence", "verdict", "advisories")
    rows = [
        (
            pin.name,
            pin.version,
            pin.needed_by,
            licences[pin.name].expression,
            licences[pin.name].verdict,
            advisory_words(pin, answers),
        )
        for pin in pins
    ]
    if not markdown:
        return table([Column(head, left=True) for head in heads], rows)
    lines = [heads, tuple("---" for _ in heads), *rows]
    return "\n".join(f"| {' | '.join(cells)} |" for cells in lines)


def advisory_words(pin: Pin, answers: list[Answers]) -> str:
    """What the sources answered about a package: "not checked" unless one of them did answer."""
    found: list[Advisory] = [a for answer in answers for a in answer.found.get(pin.name, ())]
    if found:
        return ", ".join(dict.fromkeys(a.name for a in found))
    asked = [answer.source for answer in answers if pin.name in answer.checked]
    return f"none known ({', '.join(asked)})" if asked else "not checked"


def _summary(
    pins: list[Pin],
    licences: dict[str, Licence],
    answers: list[Answers],
    undecided: list[str],
    found: list[tuple[Pin, Advisory]],
) -> list[str]:
    """Lines below the table: the counts, the decisions, each source, each advisory."""
    counts = {v: sum(licences[p.name].verdict == v for p in pins) for v in WORST}
    lines = [f"{len(pins)} packages: " + ", ".join(f"{n} {v}" for v, n in counts.items() if n)]
    present = {pin.name for pin in pins}
    lines += [f"{name}: {why}" for name, why in {**DECIDED, **NOTES}.items() if name in present]
    lines += [f"font {name}, brought by {brings}: {words}" for name, brings, words in fonts()]
    lines += [f"LICENCE TO DECIDE ON: {name}, {licences[name].expression}" for name in undecided]
    if not answers:
        lines.append(
            "advisories: not checked; give --advisories PATH, --audit or --index, of which the "
            "last two need a network"
        )
    for answer in answers:
        lines.append(f"{answer.source}: {answer.words(len(pins))}")
    lines += [f"ADVISORY {a.name} for {p.name} {p.version}: {a.summary}" for p, a in found]
    return lines


if __name__ == "__main__":
    sys.exit(main())
