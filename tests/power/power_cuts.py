"""Power cuts while the program writes: what is on the disk afterwards.

Run as root, with PYTHONPATH at the project: python tests/power/power_cuts.py SCENARIO --cuts 1000.
It prints one line of JSON: the writes and flushes that the disk received, the cuts, what was wrong
after them. `--help` lists scenarios and file systems.
"""

from __future__ import annotations

import argparse
import contextlib
import dataclasses
import json
import re
import subprocess
import sys
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path

import disk
import kernel
import neighbour
import programs

Marks = list[str]
#: (what is mounted after the cut, the marks before it, all marks) -> what is wrong
Check = Callable[[Path, Marks, Marks], list[str]]
Files = dict[str, bytes]  #: by path
BEGIN, END = "begin of the recording", "end of the recording"


@dataclasses.dataclass(frozen=True)
class Scenario:
    """A program on the disk, and what must hold after a cut."""

    run: tuple[str, ...]
    #: takes what lay on the disk before the program ran and when it had ended
    check: Callable[[Files, Files], Check]
    #: run before, and on the disk when the recording begins
    prepare: tuple[tuple[str, ...], ...] = ()
    #: run after a first cut, and cut too
    again: tuple[str, ...] = ()
    #: what is on the disk after the first cut, as acknowledgements; None: those before the cut
    resumed: Callable[[Path], Marks] | None = None


# --- checks --------------------------------------------------------------------------------------


def version_of(data: bytes, name: str, versions: int) -> int | None:
    """The version that a file is, whole; None for anything else."""
    return next((v for v in range(versions) if data == programs.content(v, name)), None)


def right_versions(before: Marks, marks: Marks) -> list[int]:
    """The last acknowledged version (-1: none) and the one after it."""
    done = sum(mark.startswith("done") for mark in before)
    return [done - 1, done] if done < sum(m.startswith("done") for m in marks) else [done - 1]


def check_file(_: Files, __: Files) -> Check:
    def check(root: Path, before: Marks, marks: Marks) -> list[str]:
        file, right = root / "result.txt", right_versions(before, marks)
        if not file.exists():
            return [] if -1 in right else [f"result.txt is missing, expected version {right}"]
        data = file.read_bytes()
        version = version_of(data, "", 1 + max(right))
        return [*wrong("result.txt", data, version, right), *goes_on(root)]

    return check


def wrong(name: str, data: bytes, version: int | None, right: list[int]) -> list[str]:
    if version in right:
        return []
    if version is not None:
        return [f"{name} is version {version}, expected {right}"]
    return [f"{name} is empty" if not data else f"{name} is mixed ({len(data)} bytes)"]


def check_fresh(_: Files, __: Files) -> Check:
    def check(root: Path, before: Marks, marks: Marks) -> list[str]:
        newest = max(right_versions(before, marks))
        faults = []
        for version in range(newest + 1):
            file = root / f"new-{version}.txt"
            if not file.exists():
                if version not in right_versions(before, marks)[1:]:
                    faults.append(f"{file.name} is missing")
                continue
            data = file.read_bytes()
            faults += wrong(file.name, data, version_of(data, "", newest + 1), [version])
        return faults + goes_on(root)

    return check


def check_folder(_: Files, __: Files) -> Check:
    def check(root: Path, before: Marks, marks: Marks) -> list[str]:
        folder, right = root / "report", right_versions(before, marks)
        if not folder.exists():
            return [] if -1 in right else ["report is missing"]
        files = {p.name: p.read_bytes() for p in folder.iterdir() if p.is_file()}
        versions = {n: version_of(data, n, 1 + max(right)) for n, data in files.items()}
        for name, data in files.items():
            if versions[name] is None:
                return wrong(name, data, None, right)
        found = set(versions.values())
        if len(found) > 1:
            return [f"report is mixed: {sorted(versions.items())}, expected {right}"]
        if not found:
            return ["report is empty"]
        (version,) = found
        faults = wrong("report", b"?", version, right)
        if version is not None and sorted(files) != sorted(programs.names(version)):
            faults.append(f"report of version {version} has {sorted(files)}")
        return faults + goes_on(root)

    return check


def check_together(_: Files, __: Files) -> Check:
    """All outputs of one commit are of one version, once the next program has come there."""

    def check(root: Path, before: Marks, marks: Marks) -> list[str]:
        faults = goes_on(root, "one", "two", "two/report")
        right = right_versions(before, marks)
        folder = root / "two" / "report"
        files = [root / "result.txt", root / "one" / "result.txt", *sorted(folder.glob("[!.]*"))]
        versions: list[int | None] = []
        for file in files:
            name = file.name if file.parent == folder else ""
            data = file.read_bytes() if file.exists() else None
            versions.append(-1 if data is None else version_of(data, name, 1 + max(right)))
        expected = [*programs.NAMES, programs.LAST]
        if versions == [-1, -1] and -1 in right:
            return faults
        if versions == [-1, -1]:
            return [*faults, "nothing is there"]
        if len(set(versions)) > 1 or len(files) != 2 + len(expected):
            return [*faults, f"mixed: {[*zip([f.name for f in files], versions, strict=True)]}"]
        return faults + wrong("the outputs", b"?", versions[0], right)

    return check


def goes_on(root: Path, *places: str) -> list[str]:
    """The next program writes there, and leaves nothing of the one that was cut."""
    from relgloss_view.base import temporaries
    from relgloss_view.base.writing import whole_file

    temporaries._swept.clear()  # this process stands for a new one each time
    for place in ("", *places):
        temporaries.sweep(root / place)
    with whole_file(root / "next.txt") as temporary:
        temporary.write_bytes(b"next")
    left = [str(p.relative_to(root)) for p in root.rglob("*") if temporaries.is_temporary(p.name)]
    return [f"left over: {left}"] if left else []


def tree(root: Path) -> Files:
    """All that a program made below a folder, by path."""
    return {
        name: file.read_bytes()
        for file in sorted(root.rglob("*"))
        if file.is_file()
        and not re.search(r"(^|/)(\.|lost\+found)", name := str(file.relative_to(root)))
    }


def check_whole(old: Files, new: Files) -> Check:
    """What a command writes is as before it or as after it, and is there once it has ended."""
    assert old != new

    def check(after: Path, before: Marks, marks: Marks) -> list[str]:
        assert marks[-1] == "status 0", marks
        found = tree(after)
        if found == new or (found == old and "status 0" not in before):
            return goes_on(after)
        if found == old:
            return ["the command has ended with status 0, and nothing of it is on the disk"]
        same = [n for n in sorted(found) if found[n] == new.get(n)]
        older = [n for n in sorted(found) if found[n] == old.get(n) and n not in same]
        other = [f"{n} ({len(found[n])} bytes)" for n in sorted(found) if n not in (*same, *older)]
        missing = sorted((old.keys() | new.keys()) - found.keys())
        return [f"mixed: {len(same)} new, {len(older)} old, damaged {other}, missing {missing}"]

    return check


def check_settled(old: Files, new: Files) -> Check:
    """The same of outputs in several places, once the next program has come there."""
    whole = check_whole(old, new)

    def check(after: Path, before: Marks, marks: Marks) -> list[str]:
        faults = goes_on(after)
        (after / "next.txt").unlink()
        return [*faults, *whole(after, before, marks)]

    return check


def check_each(old: Files, new: Files) -> Check:
    """Every output of a command that commits one after the other is as before or as after it."""

    def check(after: Path, before: Marks, marks: Marks) -> list[str]:
        assert marks[-1] == "status 0", marks
        found = tree(after)
        right = [new] if "status 0" in before else [old, new]
        names = sorted(old.keys() | new.keys() | found.keys())
        wrong = [n for n in names if found.get(n) not in [files.get(n) for files in right]]
        return [*([f"neither old nor new: {wrong}"] if wrong else []), *goes_on(after)]

    return check


def standing(marks: Marks) -> list[list[str]]:
    """The answers that stand after some acknowledgements."""
    kept: list[list[str]] = []
    for mark in marks:
        words = mark.split()
        if len(words) == 7:
            kept.append(words)
        elif words == ["undone"]:
            kept.pop()
    return kept


def check_session(_: Files, __: Files) -> Check:
    import test_kill

    from relgloss_view.experiment.session.store import Store

    def check(root: Path, before: Marks, marks: Marks) -> list[str]:
        file = root / "session.sqlite"
        if not file.exists():
            return ["the file is missing"] if "open" in before else []
        steps = [m for m in marks if m == "undone" or len(m.split()) == 7]
        done = len([m for m in before if m in ("undone",) or len(m.split()) == 7])
        # The answer that was being stored may be there; simulated ones are stored in batches.
        ahead = len(steps) if "done" in marks else done + 1
        right = [sorted(standing(steps[:count])) for count in range(done, ahead + 1)]
        try:
            found = test_kill.as_left(file)
            # The next program opens it, and misses nothing.
            with Store(file) as store:
                again = len(store.answers())
                lost = missed(store)
        except Exception as error:
            return [f"{type(error).__name__}: {error}"]
        faults = [f"the next program says: {lost}"] if lost else []
        if sorted(found) not in right:
            gone = [a for a in right[0] if a not in found]
            faults.append(f"{len(gone)} of {len(right[0])} acknowledged answers are lost")
        if again != len(found):
            faults.append(f"read {len(found)}, then {again} answers")
        return faults + goes_on(root)

    return check


def stored_answers(root: Path) -> Marks:
    """The answers in a session file, as acknowledgements."""
    import test_kill

    file = root / "session.sqlite"
    return [" ".join(words) for words in test_kill.as_left(file)] if file.exists() else []


def missed(store: object) -> str:
    """What an opened session reports as lost; nothing may be."""
    if getattr(store, "log_missing", False):
        return "the log is missing"
    return str(getattr(store, "losses", None) or "")


# --- scenarios -----------------------------------------------------------------------------------

SCENARIOS = {
    "files": Scenario(("files", "6"), check_file),
    "fresh": Scenario(("fresh", "6"), check_fresh),
    "folders": Scenario(("folders", "5"), check_folder),
    "together": Scenario(
        ("together", "4"), check_together, again=("sweep", "one", "two", "two/report")
    ),
    "people": Scenario(
        ("people", "40"), check_session, again=("people", "10"), resumed=stored_answers
    ),
    "simulated": Scenario(
        ("answers", "full", "2"), check_session, again=("answers", "full", "2"),
        resumed=stored_answers,
    ),
    "snapshot": Scenario(
        ("command", "snapshot", "-o", "out.png", "--size", "64x64", "--sigma-n", "2"),
        check_whole,
        (("command", "snapshot", "-o", "out.png", "--size", "64x64"),),
    ),
    "compare": Scenario(
        ("command", "compare", "matte-coated", "-o", "sheet.png", "-o", "sheet.html", "--size",
         "64x64", "--operators", "split,clip"),
        check_settled,
        (
            ("command", "compare", "uncoated", "-o", "sheet.png", "-o", "sheet.html", "--size",
             "64x64", "--operators", "split,clip"),
        ),
        again=("sweep",),
    ),
    # The material is committed before its report is drawn.
    "fit": Scenario(
        ("command", "fit", "matte-coated", "-o", "lot.json", "--report", "lot.png", "--model",
         "rough"),
        check_each,
        (
            ("command", "fit", "uncoated", "-o", "lot.json", "--report", "lot.png", "--model",
             "rough"),
        ),
    ),
    "analyse": Scenario(
        ("command", "experiment", "analyse", "session.sqlite", "-o", "report", "--draws", "20",
         "--seed", "1"),
        check_whole,
        (
            ("answers", "full", "2"),
            ("command", "experiment", "analyse", "session.sqlite", "-o", "report", "--draws", "20"),
        ),
    ),
}  # fmt: skip


@dataclasses.dataclass(frozen=True)
class Conditions:
    """On what disk, beside whom, and without what."""

    file_system: str = "ext4"
    neighbour: bool = False
    period_s: float = 0.0  #: of a neighbour that keeps its file all the time; 0: none
    without: tuple[str, ...] = ()
    pragmas: tuple[tuple[str, str], ...] = ()


def examined(
    name: str, conditions: Conditions, count: int, seed: int, place: Path, again: int = 0
) -> disk.Outcome:
    """Record a scenario, cut it, and check what is left. In a private room alone."""
    scenario = SCENARIOS[name]
    with disk.RecordedDisk(disk.FILE_SYSTEMS[conditions.file_system], place) as recorded:
        for words in scenario.prepare:
            run_on(recorded, {}, words)
        kernel.sync(recorded.root)
        old = tree(recorded.root)
        log, begin, marks = recording(recorded, conditions, scenario.run)
        check = scenario.check(old, tree(recorded.root))
        recorded.stop()
        skipped = len(log.marks(begin))
        outcome = disk.examine(
            recorded,
            lambda root, before: check(root, before[skipped:], marks),
            disk.chosen_cuts(begin, len(log.records), count, seed),
            log,
        )
        if scenario.again and again:
            firsts = disk.chosen_cuts(begin, len(log.records), again, seed + 1)
            for number, (cut, image) in enumerate(disk.images(log, firsts)):
                inner = place / f"again-{number}"
                inner.mkdir()
                before = log.marks(cut.position)[skipped:]
                if scenario.resumed is not None:
                    with recorded.examined(image) as root:
                        before = [m for m in before if m == "open"] + scenario.resumed(root)
                later = cut_again(scenario, check, conditions, image, inner, before, marks)
                outcome.cuts += later.cuts
                outcome.faults += [f"{cut}, then {fault}" for fault in later.faults]
        return outcome


def recording(
    recorded: disk.RecordedDisk, conditions: Conditions, words: Sequence[str]
) -> tuple[disk.Log, int, Marks]:
    """Run a program; what the disk received till it ended, where that begins, all marks of it."""
    options = {
        "without": conditions.without,
        "pragmas": dict(conditions.pragmas),
        "neighbour": conditions.neighbour,
    }
    recorded.mark(BEGIN)
    with beside(recorded, conditions.period_s):
        run_on(recorded, options, words)
    recorded.mark(END)
    log = recorded.log()
    begin, end = log.position(BEGIN), log.position(END)
    log = disk.Log(log.start, log.records[: end - 1])
    return log, begin, log.marks(end - 1)[len(log.marks(begin)) :]


CUTS_AGAIN = 8


def cut_again(
    scenario: Scenario,
    check: Check,
    conditions: Conditions,
    image: disk.Image,
    place: Path,
    before: Marks,
    marks: Marks,
) -> disk.Outcome:
    """Start the machine after a cut, run a program there, and cut it too."""
    with disk.RecordedDisk(disk.FILE_SYSTEMS[conditions.file_system], place, image) as recorded:
        log, begin, more = recording(recorded, conditions, scenario.again)
        recorded.stop()
        skipped = len(log.marks(begin))
        everything = marks if scenario.resumed is None else [*before, *more]
        return disk.examine(
            recorded,
            lambda root, later: check(root, [*before, *later[skipped:]], everything),
            disk.chosen_cuts(begin, len(log.records), CUTS_AGAIN, len(before)),
            log,
        )


@contextlib.contextmanager
def beside(recorded: disk.RecordedDisk, period_s: float):
    if not period_s:
        yield
        return
    words = [sys.executable, neighbour.__file__, str(recorded.root / ".other"), str(period_s)]
    process = subprocess.Popen(words)
    try:
        yield
    finally:
        process.kill()
        process.wait()


def run_on(recorded: disk.RecordedDisk, options: dict[str, object], words: Sequence[str]) -> None:
    with open(recorded.marks, "wb", buffering=0) as marks:
        subprocess.run(
            [sys.executable, programs.__file__, json.dumps(options), *words],
            cwd=recorded.root,
            stdout=marks,
            check=True,
        )


# --- the command ---------------------------------------------------------------------------------


def in_room(
    words: Sequence[str], place: Path, patience_s: float | None = None
) -> subprocess.CompletedProcess[str]:
    """This script in a private room of its own; `place` is an empty folder."""
    command = [sys.executable, __file__, *words, "--place", str(place)]
    return subprocess.run(
        kernel.in_private_room(command),
        capture_output=True,
        text=True,
        timeout=patience_s,
    )


def main(words: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("scenario", choices=SCENARIOS)
    parser.add_argument("--file-system", choices=disk.FILE_SYSTEMS, default="ext4")
    parser.add_argument("--cuts", type=int, default=100, help="Number of power cuts (default 100)")
    parser.add_argument(
        "--again",
        type=int,
        default=0,
        help=f"Number of cuts after which the next program is cut too, {CUTS_AGAIN} times each",
    )
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument(
        "--neighbour",
        action="store_true",
        help="Another program keeps its file before each change of a name",
    )
    parser.add_argument(
        "--period-s", type=float, default=0.0, help="Another program keeps its file at this period"
    )
    parser.add_argument(
        "--without",
        nargs="*",
        default=[],
        choices=("files", "folders"),
        help="What fsync does nothing for",
    )
    parser.add_argument(
        "--pragma", nargs="*", default=[], metavar="NAME=VALUE", help="Other settings of SQLite"
    )
    parser.add_argument("--place", type=Path, help=argparse.SUPPRESS)
    args = parser.parse_args(words)
    if args.place is None:
        why = kernel.missing() or disk.FILE_SYSTEMS[args.file_system].missing()
        if why:
            print(why, file=sys.stderr)
            return 2
        with tempfile.TemporaryDirectory() as place:
            done = in_room(sys.argv[1:] if words is None else words, Path(place))
        print(done.stdout, end="")
        print(done.stderr, end="", file=sys.stderr)
        return done.returncode
    conditions = Conditions(
        args.file_system,
        args.neighbour,
        args.period_s,
        tuple(args.without),
        tuple(tuple(p.split("=")) for p in args.pragma),
    )
    outcome = examined(args.scenario, conditions, args.cuts, args.seed, args.place, args.again)
    print(json.dumps(dataclasses.asdict(outcome)))
    return 1 if outcome.faults else 0


if __name__ == "__main__":
    sys.path[:0] = [str(programs.TESTS / "experiment"), str(programs.TESTS / "experiment/session")]
    sys.exit(main())
