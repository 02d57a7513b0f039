"""Kill commands before every call that changes a folder, and judge what they leave.

    .venv/bin/python tests/base/kill_commands.py compare grid --step 5
    .venv/bin/python tests/base/kill_commands.py --signal TERM

Each command has written its files once; then it runs with other options and is killed before call
number 1, 1 + STEP, and so on. Right is: every folder and set of files is the old or the new one, at
once or after the next command; the user's own files are there; the next run is not refused, writes
the new files, and leaves nothing temporary. Prints a line for each command: calls, and faults.
"""

from __future__ import annotations

import argparse
import contextlib
import os
import re
import shutil
import signal
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import kill_points

from relgloss_view import cli
from relgloss_view.base import interruptions, temporaries

SMALL = ["--size", "24x24"]
STUDY = ["--set", "screen.width_px=24", "--set", "screen.height_px=24"]


@dataclass(frozen=True)
class Case:
    """A command: the words of its first run, of the second one, and what it needs before."""

    first: list[str]
    second: list[str]
    at_once: bool  #: whether one rename is the commit, so that no next command is needed
    session: bool = False
    separate: bool = False  #: files that are not one set: each is old or new for itself


GRID = ["grid", *SMALL, "-o", "out"]
COMPARE = ["compare", *SMALL, "-o", "out/a.png", "-o", "out/b.html", "art-coated"]
ANALYSE = ["experiment", "analyse", "s.sqlite", "--draws", "5", "-o", "out"]
EXPORT = ["experiment", "export", "s.sqlite", "-o", "answers.csv", "--stimuli", "out"]
MATCH = ["match", *SMALL, "uncoated", "-o", "out/curve.png", "--write", "pair.toml"]
FIT = ["fit", "uncoated", "-o", "out/m.json", "--report", "r.png"]
CASES = {
    "grid": Case([*GRID, "--operator", "clip"], GRID, at_once=True),
    "compare": Case([*COMPARE, "--operators", "clip"], COMPARE, at_once=False),
    "analyse": Case([*ANALYSE, "--seed", "1"], ANALYSE, at_once=True, session=True),
    "export": Case([], EXPORT, at_once=False, session=True),
    "match": Case([*MATCH, "--grain", "1"], MATCH, at_once=False),
    "fit": Case([*FIT, "--refractive-index", "1.6"], FIT, at_once=True, separate=True),
}


def run(words: list[str], at: int = 0, sent: int = signal.SIGKILL) -> int:
    """Run a command in a fork as the program does; the signal that ended it."""

    def program() -> None:
        interruptions.SIGNALS.catch()
        with open(os.devnull, "w") as nothing:
            os.dup2(nothing.fileno(), 1)
            os.dup2(nothing.fileno(), 2)
        sys.argv = ["relgloss", *words]
        status = cli.main()
        os._exit(0 if at and status >= 128 else status)

    return kill_points.run(program, at, sent)


def judge(name: str, case: Case, base: Path, step: int, sent: int) -> int:
    """Kill a command at its calls; the number of faults, each printed."""
    ready = base / "ready"
    out = ready / "out"
    (out / "notes").mkdir(parents=True)
    with contextlib.chdir(ready):
        if case.session:
            study = ["paper", *STUDY, "-o", "s.sqlite", "--observers", "2"]
            assert run(["experiment", "simulate", *study]) == 0
        shutil.rmtree(out)
        if "out/" in " ".join(case.second):
            out.mkdir()
        if case.first:
            assert run(case.first) == 0
        out.mkdir(exist_ok=True)
        if case.first:
            (out / "notes").mkdir()
            (out / "notes" / "mine.txt").write_text("mine")
            (out / "mine.txt").write_text("mine")
    before = tree(ready)
    done = base / "done"
    shutil.copytree(ready, done)
    with contextlib.chdir(done):
        assert run(case.second) == 0
    after = tree(done)
    faults, calls, at = 0, 0, 1
    ended = True
    while ended:
        work = base / str(at)
        shutil.copytree(ready, work)
        with contextlib.chdir(work):
            if sent == signal.SIGKILL:
                ended = bool(run(case.second, at, sent))
            else:
                run(case.second, at, sent)
                ended = at < 400
            faults += found(name, at, "after", case, case.at_once, work, before, after)
            if not case.at_once:
                kill_points.run(lambda: temporaries.prepare(case.second))
                faults += found(name, at, "repaired", case, True, work, before, after)
            if sent != signal.SIGKILL and (left := temporary(work)):
                faults += complain(name, at, f"left {left}")
            if run(case.second):
                faults += complain(name, at, "the next run was killed")
            if tree(work) != after:
                faults += complain(name, at, "the next run has not written the new files")
            if left := temporary(work):
                faults += complain(name, at, f"the next run has left {left}")
        shutil.rmtree(work)
        calls, at = at, at + step
    print(f"{name}: killed before every {step}. of {calls} calls: {faults} faults", flush=True)
    return faults


def found(
    name: str, at: int, when: str, case: Case, whole: bool, work: Path,
    before: kill_points.Tree, after: kill_points.Tree,
) -> int:  # fmt: skip
    """Faults of what is there: a mixture, or something of the user's that is missing."""
    now = tree(work)
    kept = {k: v for k, v in before.items() if after.get(k) == v}
    if any(now.get(k) != v for k, v in kept.items()):
        return complain(name, at, f"{when}: a file of the user's is missing")
    if case.separate:
        names = {*before, *after, *now}
        good = all(now.get(k) in (before.get(k), after.get(k)) for k in names)
    else:
        good = not whole or now in (before, after)
    return 0 if good else complain(name, at, f"{when}: neither the old files nor the new ones")


def tree(folder: Path) -> kill_points.Tree:
    """All files; without the seconds that a fit took, which no two runs share."""
    found = kill_points.tree(folder)
    for name, (mode, content) in found.items():
        if name.endswith(".json") and isinstance(content, bytes):
            found[name] = mode, re.sub(rb'"seconds": [\d.]+', b"", content)
    return found


def temporary(work: Path) -> list[str]:
    return [*kill_points.temporary(work), *os.listdir(tempfile.gettempdir())]


def complain(name: str, at: int, words: str) -> int:
    print(f"{name}, call {at}: {words}", flush=True)
    return 1


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("commands", nargs="*", choices=[*CASES, []], metavar="COMMAND")
    parser.add_argument("--step", type=int, default=1, help="from one kill to the next, in calls")
    parser.add_argument("--signal", choices=("KILL", "TERM", "INT", "HUP"), default="KILL")
    args = parser.parse_args()
    sent = getattr(signal, f"SIG{args.signal}")
    faults = 0
    for name in args.commands or CASES:
        with tempfile.TemporaryDirectory() as base:
            here = Path(base)
            (here / "tmp").mkdir()
            os.environ["TMPDIR"] = tempfile.tempdir = str(here / "tmp")
            try:
                faults += judge(name, CASES[name], here, args.step, sent)
            finally:
                tempfile.tempdir = None
                del os.environ["TMPDIR"]
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
