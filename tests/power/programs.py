"""Programs that write to a recorded disk. What they acknowledge they print, into the disk's log.

Run: python programs.py OPTIONS NAME ARGUMENTS, in the folder that they write to. OPTIONS is JSON:
`without` names what fsync does nothing for, `pragmas` replaces settings of SQLite (both are
controls), and `neighbour` has another program's file kept before each change of a name.
"""

from __future__ import annotations

import contextlib
import json
import os
import sqlite3
import stat
import sys
from pathlib import Path

TESTS = Path(__file__).parent.parent
sys.path.insert(0, str(TESTS / "experiment"))
sys.path.insert(0, str(TESTS / "experiment" / "session"))

from neighbour import Neighbour  # noqa: E402

#: Of Python's audit: what changes the names of a folder, or makes a file.
CHANGES = ("os.rename", "os.link", "os.remove", "os.mkdir", "os.rmdir", "os.symlink", "open")
NAMES = ("index.html", "numbers.csv", "picture.png")
LAST = "results.json"


# --- versions of files, which a reader can tell whole from mixed ---------------------------------


def content(version: int, name: str = "") -> bytes:
    """A version of a file: of another length each, up to 200 kB, and no two parts alike."""
    length = (1, 37, 4096, 5000, 70_000, 200_000)[(version + len(name)) % 6]
    line = f"{name} {version} ".encode()
    return line + b"".join(line + b"%d\n" % k for k in range(length // (len(line) + 4)))


def names(version: int) -> list[str]:
    """The files of a version of a folder; one of them is new each time."""
    return [*NAMES, f"only-{version % 3}.txt", LAST]


def write_files(rounds: int) -> None:
    """One file, replaced again and again."""
    from relgloss_view.base.writing import whole_file

    for version in range(rounds):
        with whole_file("result.txt") as temporary:
            temporary.write_bytes(content(version))
        print("done", version, flush=True)


def write_fresh(rounds: int) -> None:
    """Files of new names."""
    from relgloss_view.base.writing import fresh_file

    for version in range(rounds):
        with fresh_file(f"new-{version}.txt") as temporary:
            temporary.write_bytes(content(version))
        print("done", version, flush=True)


def write_folders(rounds: int) -> None:
    """A folder of several files, replaced again and again."""
    from relgloss_view.base.writing import whole_folder

    for version in range(rounds):
        former = [f"only-{(version - 1) % 3}.txt"]
        with whole_folder("report", LAST, lambda _, former=former: former) as temporary:
            for name in names(version):
                (temporary / name).write_bytes(content(version, name))
        print("done", version, flush=True)


def write_together(rounds: int) -> None:
    """Two files and a folder in three places, replaced by one commit again and again."""
    from relgloss_view.base.writing import together, whole_file, whole_folder

    for place in ("one", "two"):
        os.mkdir(place)
    for version in range(rounds):
        with together():
            with whole_file("one/result.txt") as temporary:
                temporary.write_bytes(content(version))
            with whole_folder("two/report", LAST) as temporary:
                for name in (*NAMES, LAST):
                    (temporary / name).write_bytes(content(version, name))
            with whole_file("result.txt") as temporary:
                temporary.write_bytes(content(version))
        print("done", version, flush=True)


def sweep(*places: str) -> None:
    """What every command begins with: what a cut has left in some places is finished, or goes."""
    from relgloss_view.base.temporaries import sweep

    for place in (".", *places):
        sweep(place)


def command(*words: str) -> None:
    """The program itself; its exit status is acknowledged."""
    from relgloss_view.cli import main

    # What it prints is no acknowledgement.
    with open(os.devnull, "w") as nowhere, contextlib.redirect_stdout(nowhere):
        status = main(list(words))
    print("status", status, flush=True)


def answers(design: str, observers: str) -> None:
    """A simulated study: prints each answer once it is stored."""
    import killed

    killed.main("session.sqlite", design, int(observers))


def people(count: str) -> None:
    """People answer; every fifth answer is taken back, and the question answered again."""
    import killed
    from cases import Clock, to_trial

    from relgloss_view.experiment.session.flow import Flow, Phase
    from relgloss_view.experiment.session.store import Store

    given = 0
    with Store("session.sqlite", killed.made("full")) as store:
        print("open", flush=True)
        while given < int(count):
            observer = store.observer()
            flow = Flow(store, observer, store.begin_run(observer, "device", {}), Clock())
            to_trial(flow)
            while flow.phase is Phase.TRIAL and given < int(count):
                flow.shown()
                flow._clock.now_s += 1.0
                trial, question, category = flow.trial, flow.question, given % 3
                assert flow.answer(category)
                given += 1
                # What is acknowledged: an answer that stands, and an answer taken back.
                print(
                    observer.name, trial.position, trial.sample, trial.setting, trial.repeat,
                    question, category, flush=True,
                )  # fmt: skip
                to_trial(flow)
                if given % 5 == 0 and flow.undo():
                    print("undone", flush=True)
                    to_trial(flow)
            flow.end()


PROGRAMS = {
    "files": lambda rounds: write_files(int(rounds)),
    "fresh": lambda rounds: write_fresh(int(rounds)),
    "folders": lambda rounds: write_folders(int(rounds)),
    "together": lambda rounds: write_together(int(rounds)),
    "sweep": sweep,
    "command": command,
    "answers": answers,
    "people": people,
}


# --- controls and the neighbour ------------------------------------------------------------------


def watch(neighbour: Neighbour) -> None:
    """Have the neighbour's file kept before each change of a name below this folder."""
    root = os.getcwd()

    def hook(event: str, arguments: tuple[object, ...]) -> None:
        if event not in CHANGES or not isinstance(arguments[0], str | bytes | os.PathLike):
            return
        path = os.path.abspath(os.fsdecode(arguments[0]))
        if path.startswith(root) and (event != "open" or arguments[1] is None):
            neighbour.keep()

    sys.addaudithook(hook)


def leave_out(kinds: list[str]) -> None:
    """Have fsync do nothing for "files", for "folders", or for both."""
    fsync = os.fsync

    def some(file: int) -> None:
        if ("folders" if stat.S_ISDIR(os.fstat(file).st_mode) else "files") not in kinds:
            fsync(file)

    os.fsync = some


def replace_pragmas(pragmas: dict[str, str]) -> None:
    """Have SQLite set other values, whatever the program asks for."""

    class Connection(sqlite3.Connection):
        def execute(self, sql: str, *values: object) -> sqlite3.Cursor:
            words = sql.replace("=", " ").split()
            if len(words) == 3 and words[0] == "PRAGMA" and words[1] in pragmas:
                super().execute(f"PRAGMA {words[1]} = {pragmas[words[1]]}").fetchall()
                return super().execute("SELECT ?", (words[2],))  # it got what it asked for
            return super().execute(sql, *values)

    connect = sqlite3.connect
    sqlite3.connect = lambda *a, **k: connect(*a, **{"factory": Connection, **k})


def main(options: str, name: str, *arguments: str) -> None:
    chosen = json.loads(options)
    neighbour = Neighbour(".neighbour")
    leave_out(chosen.get("without", []))
    if chosen.get("pragmas"):
        replace_pragmas(chosen["pragmas"])
    if chosen.get("neighbour"):
        watch(neighbour)
    PROGRAMS[name](*arguments)


if __name__ == "__main__":
    main(*sys.argv[1:])
