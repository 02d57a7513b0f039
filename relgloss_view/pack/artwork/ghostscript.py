"""Ghostscript as a program of its own: found, run without access to files, bounded in every way.

A page of a kilobyte may compute for ever. So its processor time is bounded by the size of the file:
a small file has few seconds, since what a designer exports is large where it takes long.
"""

from __future__ import annotations

import contextlib
import math
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

from relgloss_view.base.child import Child
from relgloss_view.base.errors import InputError
from relgloss_view.base.interruptions import STEP_S, checkpoint
from relgloss_view.base.reading import named, open_regular, printable
from relgloss_view.base.terminal import ProgressReport

PROGRAMS = ("gs", "gswin64c", "gswin32c")
MOST_MEMORY_KB = 500_000  #: of its own allocations
MOST_DATA, MOST_WRITTEN = 900_000_000, 1_000_000_000  #: bytes of the process, and of each file
#: Processor time of files up to SMALL and from LARGE bytes on, and what each MB adds.
LEAST_S, MOST_S, PER_MB_S = 3.2, 20.0, 1.0
SMALL, LARGE = 200_000, 1_000_000
PER_PLANE_S = 0.01  #: what each million pixels of a plate adds
WAITING = 4.0  #: times longer than its processor time a process may take, others being busy
COARSE_DPI = 100.0


def ghostscript(path: str | os.PathLike[str]) -> str:
    """The program; InputError that gives the way to get it."""
    for name in PROGRAMS:
        found = shutil.which(name)
        if found:
            return found
    raise InputError(
        f"{named(path)}: Ghostscript, which renders PDF, is not installed; install it (Debian: apt "
        "install ghostscript, macOS: brew install ghostscript), or save the artwork as a TIFF"
    )


def allowed_s(size: int) -> float:
    """Processor time that a file of `size` bytes may take.

    >>> [round(allowed_s(n), 2) for n in (10_000, 600_000, 5_000_000)]
    [3.21, 12.2, 25.0]
    """
    share = min(max((size - SMALL) / (LARGE - SMALL), 0.0), 1.0)
    return LEAST_S + share * (MOST_S - LEAST_S) + PER_MB_S * size / 1e6


class Renderer:
    """Runs Ghostscript in a folder of ours, within a budget of processor time for all its runs.

    path: of the artwork, for messages. budget_s: as of allowed_s.
    """

    def __init__(
        self, program: str, folder: Path, path: str | os.PathLike[str], budget_s: float
    ) -> None:
        self._program, self._folder, self.path = program, folder, path
        self._budget_s = self._left_s = budget_s

    def add(self, plane_pixels: float) -> None:
        """Enlarge the budget by what writing plates of so many pixels takes."""
        self._budget_s += PER_PLANE_S * 1e-6 * plane_pixels
        self._left_s += PER_PLANE_S * 1e-6 * plane_pixels

    def run(self, words: list[str], progress: ProgressReport) -> None:
        """One run, with checkpoints. Raises InputError with one line."""
        usual = ["-q", "-dSAFER", "-dBATCH", "-dNOPAUSE", "-dNOPROMPT", "-dShowAnnots=false",
                 "--permit-file-read=intent.icc", f"-K{MOST_MEMORY_KB}",
                 "-dBufferSpace=200000000", "-sCompression=none"]  # fmt: skip
        if "-sDEVICE=pdfwrite" in words:
            usual.pop()
        log = self._folder / "log.txt"
        null = subprocess.DEVNULL
        with log.open("wb") as output:
            child = Child([self._program, *usual, *words], stdin=null, stdout=output,
                          stderr=output, cwd=self._folder)  # fmt: skip
            try:
                _bound(child.process.pid, self._left_s)
                self._wait(child, progress)
                status = child.process.returncode
            finally:
                child.close()
        target = next(w for w in words if w.startswith("-sOutputFile=")).partition("=")[2]
        if status != 0 or not (self._folder / target).exists():
            raise InputError(
                f"{named(self.path)}: Ghostscript can't render it ({_reason(log, status)}); "
                "export it again"
            )

    def _wait(self, child: Child, progress: ProgressReport) -> None:
        start_s, spent_s = time.monotonic(), 0.0
        while child.process.poll() is None:
            checkpoint()
            waited_s = time.monotonic() - start_s
            processor_s = _processor_s(child.process.pid)
            spent_s = waited_s if processor_s is None else processor_s
            if max(spent_s, waited_s / WAITING) > self._left_s:
                raise InputError(
                    f"{named(self.path)}: Ghostscript takes longer than {self._budget_s:.0f} s; "
                    "flatten the artwork, save it as a TIFF, or give a coarser resolution (dpi = "
                    f"{COARSE_DPI:g})"
                )
            progress(1.0 - math.exp(-waited_s / 5.0), "rendering the PDF")
            time.sleep(STEP_S)
        self._left_s -= spent_s


def _reason(log: Path, status: int) -> str:
    """The line of its output that gives the error."""
    with open_regular(log, "a text") as file:
        lines = file.read(4000).decode("utf-8", "replace").strip().splitlines()
    line = next((one for one in lines if "rror" in one), lines[0] if lines else f"status {status}")
    return printable(line, 120)


def _bound(process: int, most_s: float) -> None:
    """Bound a process in memory, files and processor time, where the system can do that.

    Time is bounded from here, and by the system too: it goes on where this program is killed.
    """
    if sys.platform == "linux":
        import resource

        limits = (
            (resource.RLIMIT_DATA, MOST_DATA),
            (resource.RLIMIT_FSIZE, MOST_WRITTEN),
            (resource.RLIMIT_CPU, math.ceil(most_s) + 1),
        )
        for kind, most in limits:
            # It has ended, or its limit is lower already.
            with contextlib.suppress(OSError, ValueError):
                resource.prlimit(process, kind, (most, most))


def _processor_s(process: int) -> float | None:
    """Processor time that a process has taken, s; None where the system shows none (proc(5))."""
    try:
        with open_regular(f"/proc/{process}/stat", "a text") as file:
            fields = file.read(4096).rpartition(b")")[2].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
    except (InputError, OSError, ValueError, IndexError, AttributeError):
        return None
