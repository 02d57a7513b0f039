"""Is nothing lost when a signal strikes? Every command, interrupted at random moments.

python scripts/interrupt.py --count 300
python scripts/interrupt.py --count 1000 --workers 16 --json interruptions.json
python scripts/interrupt.py --count 100 --handlers raising

Each trial runs a command in a folder of its own and sends INT (to the process group, as a terminal
does), TERM or HUP at a moment drawn from its whole run or, every other time, from its start. Then
it looks at the exit status, at what was printed, at the files beside the outputs and in TMPDIR, at
processes that are still there, and at the time from the signal to the end. `--handlers none` and
`--handlers raising` are the controls: no handlers, and handlers that raise wherever they are called
(about 1 of 100 signals then ends in a segmentation fault).

A signal before the program's first line, while Python itself starts, can't be handled: such trials
are counted, but not judged.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import math
import os
import random
import secrets
import shutil
import signal
import sqlite3
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass, field
from pathlib import Path

from relgloss_view.base.interruptions import WORDS
from relgloss_view.base.resources import asset
from relgloss_view.base.temporaries import is_temporary
from relgloss_view.base.terminal import Column, table

ROOT = Path(__file__).resolve().parents[1]
NUMBERS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
LONGEST_S = 120.0
MARK = "RELGLOSS_TRIAL"  #: variable by which a trial's processes are known
LINE = f"relgloss: {WORDS}"
AFTER = 1.05  #: signals come until this share of the usual time of a command
#: Every other one comes while the program is loaded and compiles its shaders.
START_S = 1.5
LATE = 0.5  #: from this share of it on, a program without handlers is at fault
CHILDREN_S = 3.0  #: how long a child may outlive the program
CAUGHT = ("SigCgt", "SigIgn")  #: entries of /proc/PID/status
HANDLERS = ("noting", "raising", "none")
BROKEN = ("Traceback", "Exception ignored", "Fatal Python error", "Segmentation fault")

CONTROL = """
import os, sys
words, kind = sys.argv[2:], sys.argv[1]
sys.argv = ["relgloss", *words]
sys.path.insert(0, {root!r})
from relgloss_view.base import interruptions
from relgloss_view import cli
raised = []
if kind == "raising":
    def note(self, number, frame):
        raised.append(number)
        raise interruptions.Interrupted(number)
    interruptions.Signals._note = note
    cli._interrupted = lambda: cli._fault(interruptions.WORDS, 128 + raised[0])
else:
    import signal
    for number in interruptions.SIGNALS._caught:
        signal.signal(number, signal.SIG_DFL)
    interruptions.SIGNALS._caught.clear()
status = cli.main()
if raised:
    os._exit(status)
sys.exit(status)
"""

PAPER = str(asset("papers", "art-coated.csv"))
SMALL = ("--set", "screen.width_px=64", "--set", "screen.height_px=64")


@dataclass(frozen=True)
class Case:
    """A command, and what it may leave."""

    words: tuple[str, ...]
    makes: tuple[str, ...] = ()  #: files and folders that are there whole or not at all
    needs: tuple[str, ...] = ()  #: prepared files that it reads
    grows: tuple[str, ...] = ()  #: files that may be there with a part of the answers
    home: str = ""  #: in place of a folder of its own
    on_display: bool = False  #: runs until it is interrupted, on an X server


CASES = {
    "fit": Case(("fit", PAPER, "-o", "m.json", "--report", "r.png"), ("m.json", "r.png")),
    "fit, no home": Case(
        ("fit", PAPER, "-o", "m.json", "--report", "r.png"), ("m.json", "r.png"), home="/dev/null"
    ),
    "fit many": Case(("fit", PAPER, "uncoated", "-o", "materials"), grows=("materials",)),
    "measure": Case(("measure", PAPER, "-o", "m.png"), ("m.png",)),
    "snapshot png": Case(("snapshot", "--size", "512x512", "-o", "a.png"), ("a.png",)),
    "snapshot exr": Case(("snapshot", "--size", "512x512", "-o", "a.exr"), ("a.exr",)),
    "snapshot reference": Case(
        ("snapshot", "--backend", "reference", "--size", "256x256", "-o", "a.png"), ("a.png",)
    ),
    "grid": Case(("grid", "--size", "256x256", "-o", "stimuli"), ("stimuli",)),
    "compare": Case(("compare", "--size", "128x128", "-o", "c.html"), ("c.html",)),
    "match": Case(("match",)),
    "gloss": Case(("gloss", PAPER)),
    "plan": Case(("plan",)),
    "simulate": Case(
        ("experiment", "simulate", "paper", *SMALL, "--observers", "2", "--echo", "-o", "s.sqlite"),
        grows=("s.sqlite",),
    ),
    "analyse": Case(
        ("experiment", "analyse", "in.sqlite", "--draws", "50", "-o", "report"),
        ("report",),
        ("in.sqlite",),
    ),
    "export": Case(
        ("experiment", "export", "in.sqlite", "-o", "a.csv"),
        ("a.csv",),
        ("in.sqlite",),
    ),
    "bench": Case(("bench", "--quick", "--size", "160x120", "-o", "bench"), ("bench",)),
    "doctor": Case(("doctor",)),
    "proof make": Case(
        ("proof", "make", "matte-coated", "--size", "256x256", "-o", "p.html"), ("p.html",)
    ),
    "proof answer": Case(
        ("proof", "make", "in.html", "--note", "Yes", "-o", "p.html"), ("p.html",), ("in.html",)
    ),
    "proof check": Case(("proof", "check", "in.html"), needs=("in.html",)),
    "proof show": Case(
        ("proof", "show", "in.html", "--files", "files"), ("files",), ("in.html",)
    ),
    "proof key": Case(("proof", "key", "-o", "a.key"), ("a.key", "a.key.pub")),
    "view screenshot": Case(
        ("view", PAPER, "--screenshot", "v.png", "--frames", "20"), ("v.png",)
    ),
    "view": Case(("view", "--window", "500x400"), on_display=True),
    "experiment run": Case(
        ("experiment", "run", "paper", "-o", "people.sqlite", "--window", "400x300"),
        grows=("people.sqlite",), on_display=True,
    ),
}  # fmt: skip
PREPARED = {
    "in.sqlite": ("experiment", "simulate", "paper", *SMALL, "--observers", "2", "-o", "in.sqlite"),
    "in.html": ("proof", "make", "matte-coated", "--size", "256x256", "-o", "in.html"),
}


@dataclass
class Trial:
    """What came of one signal."""

    case: str
    number: int
    at_s: float
    handled: bool = True  #: whether the program's handlers were in place
    status: int = 0
    waited_s: float = 0.0
    faults: list[str] = field(default_factory=list)
    printed: str = ""


def main() -> int:
    """Run the trials and print the table; 1 where a fault was found."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    add = parser.add_argument
    add("--count", type=int, default=100, metavar="N", help="Number of signals (default 100)")
    add("--workers", type=int, default=2, metavar="N", help="Trials at a time (default 2)")
    add("--minutes", type=float, metavar="T", help="Start no trial after that time")
    add("--seed", type=int, default=1, metavar="N", help="Seed of the moments (default 1)")
    add("--only", action="append", choices=CASES, metavar="NAME", help="Command; may be repeated")
    add("--handlers", choices=HANDLERS, default="noting", help="Handlers of the program")
    add("--json", metavar="FILE", help="File for all trials")
    args = parser.parse_args()
    end_s = time.monotonic() + 60.0 * (args.minutes or math.inf)
    with tempfile.TemporaryDirectory() as base, x_server() as display:
        home = Path(base)
        cases = {k: c for k, c in CASES.items() if not args.only or k in args.only}
        if display is None:
            cases = {k: c for k, c in cases.items() if not c.on_display}
            print("no Xvfb: the windows are left out", file=sys.stderr)
        setup = Setup(home, args.handlers, display)
        setup.prepare({name for case in cases.values() for name in case.needs})
        with ThreadPoolExecutor(args.workers) as pool:
            usual_s = dict(zip(cases, pool.map(setup.usual_s, cases.values()), strict=True))
        random_ = random.Random(args.seed)
        names = list(cases)
        plan = []
        for k in range(args.count):
            name = names[k % len(names)]
            number = NUMBERS[k // len(names) % len(NUMBERS)]
            until_s = AFTER * usual_s[name]
            if k // len(names) % 2:
                until_s = min(until_s, START_S)
            plan.append((name, number, random_.uniform(0.0, until_s), usual_s[name]))
        with ThreadPoolExecutor(args.workers) as pool:
            made = pool.map(
                lambda one: setup.trial(*one) if time.monotonic() < end_s else None, plan
            )
            trials = [trial for trial in made if trial is not None]
    print(f"{len(trials)} of {args.count} signals")
    print(summary(trials, usual_s))
    for trial in trials:
        if trial.faults:
            where = f"{trial.case}, {signal.Signals(trial.number).name} at {trial.at_s:.3f} s"
            print(f"\n{where}: {'; '.join(trial.faults)} (status {trial.status})")
            print(trial.printed[-1500:])
    if args.json:
        Path(args.json).write_text(json.dumps([asdict(trial) for trial in trials], indent=1))
    return int(any(trial.faults for trial in trials))


@dataclass(frozen=True)
class Setup:
    """Where trials run, and how the program is started."""

    home: Path
    handlers: str
    display: str | None

    def prepare(self, names: set[str]) -> None:
        """Make the files that commands read."""
        for name in names:
            words = [sys.executable, "-m", "relgloss_view.cli", *PREPARED[name]]
            done = subprocess.run(
                words, cwd=self.home, env=self._variables(self.home, ""), capture_output=True
            )
            assert done.returncode == 0, done.stderr.decode()

    def usual_s(self, case: Case) -> float:
        """How long the command takes; for a window, how long it is left open."""
        if case.on_display:
            return 4.0
        folder = self._folder(case)
        began = time.monotonic()
        process = self._start(case, folder, "usual")
        _, err = process.communicate(timeout=LONGEST_S)
        assert process.returncode == 0, (case.words, err)
        taken = time.monotonic() - began
        missing = [name for name in case.makes if not whole(folder / name)]
        assert not missing, missing
        shutil.rmtree(folder)
        return taken

    def trial(self, name: str, number: int, at_s: float, usual_s: float) -> Trial:
        """One signal, and what came of it."""
        case, trial = CASES[name], Trial(name, number, at_s)
        folder, mark = self._folder(case), secrets.token_hex(8)
        process = self._start(case, folder, mark)
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.communicate(timeout=at_s)
        trial.handled = handled(process.pid)
        sent = time.monotonic()
        running = process.poll() is None
        if running:
            with contextlib.suppress(ProcessLookupError):
                if number == signal.SIGINT:
                    os.killpg(process.pid, number)
                else:
                    os.kill(process.pid, number)
        elif case.on_display:
            trial.faults.append("the window has closed by itself")
        try:
            out, err = process.communicate(timeout=LONGEST_S)
        except subprocess.TimeoutExpired:
            process.kill()
            out, err = process.communicate()
            trial.faults.append("did not end")
        trial.waited_s = time.monotonic() - sent if running else 0.0
        trial.status, trial.printed = process.returncode, err + out
        if trial.handled or not running or at_s > LATE * usual_s:
            self._judge(trial, case, folder, err)
        left = children(mark)
        if left:
            trial.faults.append(f"left running: {', '.join(left)}")
        shutil.rmtree(folder, ignore_errors=True)
        return trial

    def _judge(self, trial: Trial, case: Case, folder: Path, err: str) -> None:
        faults = trial.faults
        if trial.status < 0:
            faults.append(f"crash by {signal.Signals(-trial.status).name}")
        elif trial.status not in (0, 128 + trial.number):
            faults.append(f"status {trial.status}")
        if any(word in trial.printed for word in BROKEN):
            faults.append("traceback")
        lines = [line for line in err.splitlines() if not line.startswith("warning:")]
        if trial.status == 128 + trial.number and (not lines or lines[-1] != LINE):
            faults.append("the line of an interruption is missing")
        if trial.status == 0 and (case.on_display or LINE in lines):
            faults.append("status 0 of what was interrupted")
        for path in folder.rglob("*"):
            if is_temporary(path.name) or path.parent == folder / "tmp":
                faults.append(f"temporary left: {path.relative_to(folder)}")
        known = {*case.makes, *case.needs, *case.grows, "tmp", "home"}
        known |= {f"{name}{end}" for name in case.grows for end in ("-wal", "-shm", "-journal")}
        for path in folder.iterdir():
            if path.name not in known and not is_temporary(path.name):
                faults.append(f"left: {path.name}")
        for name in (*case.makes, *case.grows):
            if os.path.lexists(folder / name):
                if not whole(folder / name):
                    faults.append(f"half written: {name}")
            elif trial.status == 0:
                faults.append(f"missing: {name}")

    def _folder(self, case: Case) -> Path:
        folder = Path(tempfile.mkdtemp(dir=self.home))
        for name in ("tmp", "home"):
            (folder / name).mkdir()
        for name in case.needs:
            shutil.copy(self.home / name, folder / name)
        return folder

    def _variables(self, folder: Path, mark: str, home: str = "") -> dict[str, str]:
        home = home or str(folder / "home")
        variables = {**os.environ, "PYTHONPATH": str(ROOT), MARK: mark}
        variables |= {"OMP_NUM_THREADS": "1", "HOME": home}
        variables |= {"TMPDIR": str(folder / "tmp")} if mark else {}
        for name in ("CONFIG", "STATE", "DATA", "CACHE"):
            variables[f"XDG_{name}_HOME"] = f"{home}/{name}"
        return variables if self.display is None else {**variables, "DISPLAY": self.display}

    def _start(self, case: Case, folder: Path, mark: str) -> subprocess.Popen[str]:
        how = ["-m", "relgloss_view.cli"]
        if self.handlers != "noting":
            how = ["-c", CONTROL.format(root=str(ROOT)), self.handlers]
        words = [sys.executable, *how, *case.words]

        def ready() -> None:
            for number in NUMBERS:
                signal.signal(number, signal.SIG_DFL)

        return subprocess.Popen(
            words, cwd=folder, env=self._variables(folder, mark, case.home), start_new_session=True,
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, preexec_fn=ready,
        )  # fmt: skip


def handled(pid: int) -> bool:
    """Whether a process catches TERM, or ignores it at its end: Python itself does neither."""
    try:
        status = Path(f"/proc/{pid}/status").read_text(encoding="ascii", errors="replace")
    except OSError:
        return True
    masks = {
        line[:6]: int(line.split()[1], 16) for line in status.splitlines() if line[:6] in CAUGHT
    }
    bit = 1 << (signal.SIGTERM - 1)
    return bool((masks.get("SigCgt", 0) | masks.get("SigIgn", 0)) & bit)


def children(mark: str) -> list[str]:
    """Processes of a trial that are still there after a while."""
    end_s = time.monotonic() + CHILDREN_S
    while True:
        found = []
        for place in Path("/proc").glob("[0-9]*"):
            with contextlib.suppress(OSError):
                if f"{MARK}={mark}".encode() in (place / "environ").read_bytes():
                    words = (place / "cmdline").read_bytes().replace(b"\0", b" ")
                    found.append(words.decode("utf-8", "replace")[:80])
        if not found or time.monotonic() > end_s:
            return found
        time.sleep(0.05)


#: The last file of each folder; it lists the others.
LISTS = {"stimuli": "manifest.json", "report": "results.json", "bench": "results.json"}


def whole(path: Path) -> bool:
    """Whether an output can be read to its end."""
    try:
        if path.is_dir():
            lists = LISTS.get(path.name)
            return (not lists or (path / lists).exists()) and all(map(whole, path.iterdir()))
        content = path.read_bytes()
        if path.suffix == ".png":
            return content.endswith(b"IEND\xaeB`\x82")
        if path.suffix == ".json":
            json.loads(content)
        elif path.suffix == ".html":
            return b"</html>" in content[-20:]
        elif path.suffix == ".exr":
            import OpenEXR

            with OpenEXR.File(str(path)) as file:
                return bool(file.channels())
        elif path.suffix == ".sqlite":
            with contextlib.closing(sqlite3.connect(path)) as opened:
                return bool(opened.execute("pragma integrity_check").fetchone() == ("ok",))
        return bool(content)
    except (OSError, ValueError, RuntimeError, sqlite3.Error):
        return False


def summary(trials: Sequence[Trial], usual_s: dict[str, float]) -> str:
    """The table: a line a command."""
    columns = (
        Column("command", left=True), Column("usual s"), Column("signals"),
        Column("before\nhandlers"), Column("inter-\nrupted"), Column("finished"),
        Column("crashes"), Column("trace-\nbacks"), Column("other\nfaults"),
        Column("median\nwait s"), Column("longest\nwait s"),
    )  # fmt: skip
    rows = []
    for name in (*usual_s, "all"):
        some = [t for t in trials if name in (t.case, "all")]
        judged = [t for t in some if t.handled]
        waits = sorted(t.waited_s for t in judged if t.status >= 128) or [0.0]
        faults = [fault for trial in some for fault in trial.faults]
        crashes = sum(fault.startswith("crash") for fault in faults)
        traces = sum(fault == "traceback" for fault in faults)
        rows.append(
            (
                name,
                f"{usual_s[name]:.1f}" if name in usual_s else "",
                str(len(some)),
                str(len(some) - len(judged)),
                str(sum(t.status >= 128 for t in judged)),
                str(sum(t.status == 0 for t in judged)),
                str(crashes),
                str(traces),
                str(len(faults) - crashes - traces),
                f"{waits[len(waits) // 2]:.2f}",
                f"{waits[-1]:.2f}",
            )
        )
    return table(columns, rows)


@contextlib.contextmanager
def x_server() -> Iterator[str | None]:
    """The name of a display that nobody sees; None where there is no Xvfb."""
    if shutil.which("Xvfb") is None:
        yield None
        return
    read, write = os.pipe()
    words = ["Xvfb", "-displayfd", str(write), "-screen", "0", "1280x1024x24", "-nolisten", "tcp"]
    quiet = subprocess.DEVNULL
    server = subprocess.Popen(words, pass_fds=[write], stdout=quiet, stderr=quiet)
    os.close(write)
    try:
        with os.fdopen(read) as pipe:
            number = pipe.readline().strip()
        yield f":{number}" if number else None
    finally:
        server.terminate()
        server.wait()


if __name__ == "__main__":
    sys.exit(main())
