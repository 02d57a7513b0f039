"""Ctrl-C, and the signals by which a system ends programs: noted at once, obeyed at safe places.

The handlers only note a signal. `checkpoint` raises it where an exception does no harm: between
pictures, files, iterations, frames of the window, steps of a wait. So none is raised inside
OpenGL, an import, a callback of a library or the commit of a result. Until the command begins its
work nothing has been made, and the handlers leave at once.

A program that imports the package keeps its own handlers, and `checkpoint` does nothing there.
"""

from __future__ import annotations

# Nothing that takes time to import comes before the handlers are in place: hence _signal, which
# `signal` only dresses up, and no contextlib.
import _signal as signal  # type: ignore[import-not-found]
import _thread
import os
import sys
import time

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from types import FrameType, TracebackType

PROGRAM = "relgloss"
MODULE = "relgloss_view.cli"
WORDS = "interrupted; no file is left half written"
#: By which programs are ended, where the system has them: Ctrl-C, `kill`, a closed terminal.
NAMES = ("SIGINT", "SIGTERM", "SIGHUP")
#: A signal sooner after the first is the same wish; a later one leaves at once. So long an
#: interruption may take to clean up.
AGAIN_S = 3.0
STEP_S = 0.05  #: of waits, between two checkpoints


class Interrupted(KeyboardInterrupt):
    """A signal that ends the program; whoever handles Ctrl-C handles it too."""

    def __init__(self, number: int) -> None:
        super().__init__()
        self.exit_status = 128 + number


class Signals:
    """What the program does on a signal, in its three parts: early, at work, at its end."""

    def __init__(self) -> None:
        self.number: int | None = None  #: the first signal that was noted
        self.raised = False  #: whether `checkpoint` has raised it
        self._noted_s = self._raised_s = 0.0
        self._held = 0  #: blocks in which no checkpoint raises
        self._commits = 0  #: those among them that a second signal must not leave
        self._caught: list[int] = []
        self._clean_ups: list[Callable[[], object]] = []
        self._main = _thread.get_ident()

    @property
    def noted(self) -> bool:
        """Whether a signal has come while the program was at work."""
        return self.number is not None

    @property
    def caught(self) -> bool:
        """Whether these handlers are in place."""
        return bool(self._caught)

    @property
    def exit_status(self) -> int:
        """The status of a program that ends by the noted signal."""
        return 128 + (self.number or 0)

    def catch(self) -> None:
        """Until `work`: leave at once, as nothing has been made yet.

        A signal that the parent has set to be ignored, as `nohup` does, stays so.
        """
        for name in NAMES:
            number = getattr(signal, name, None)
            if number is not None and signal.getsignal(number) in (
                signal.SIG_DFL,
                signal.default_int_handler,
            ):
                signal.signal(number, self._leave_early)
                self._caught.append(number)

    def work(self) -> None:
        """From now on a signal is noted."""
        for number in self._caught:
            signal.signal(number, self._note)

    def before_leaving(self, clean_up: Callable[[], object]) -> None:
        """Have `clean_up` called before a leave: it removes what no with-block has removed."""
        if clean_up not in self._clean_ups:
            self._clean_ups.append(clean_up)

    def checkpoint(self) -> None:
        """Raise Interrupted if a signal was noted: once, so that it disturbs no clean-up.

        Again where the work still goes on AGAIN_S later: something has swallowed the first. In
        other threads than the main one, and while held, nothing happens.
        """
        if self.number is None or self._held or _thread.get_ident() != self._main:
            return
        now_s = time.monotonic()
        if not self.raised or now_s > self._raised_s + AGAIN_S:
            self.raised, self._raised_s = True, now_s
            raise Interrupted(self.number)

    def hold(self, commits: int) -> None:
        """From now on no checkpoint raises, until `release` is called with the same number."""
        self._held += 1
        self._commits += commits

    def release(self, commits: int) -> None:
        """The end of what `hold` began."""
        self._commits -= commits
        self._held -= 1

    def end(self) -> None:
        """The work is done: a signal that comes now changes nothing any more."""
        for number in self._caught:
            signal.signal(number, signal.SIG_IGN)

    def leave(self, status: int) -> None:
        """Clean up, and leave without what Python does at a normal end.

        That would meet threads and an OpenGL driver in the middle of their work, and can end in a
        segmentation fault.
        """
        self.end()
        self._clean_up()
        for stream in (sys.stdout, sys.stderr):
            try:  # noqa: SIM105
                stream.flush()
            except (OSError, ValueError, AttributeError):
                pass
        os._exit(status)

    def _clean_up(self) -> None:
        for clean_up in self._clean_ups:
            try:
                clean_up()
            except Exception:  # the others have to be called all the same
                continue

    def _leave_early(self, number: int, frame: FrameType | None) -> None:
        self.end()
        _print_plainly()
        os._exit(128 + number)

    def _note(self, number: int, frame: FrameType | None) -> None:
        now_s = time.monotonic()
        if self.number is None:
            self.number, self._noted_s = number, now_s
        elif now_s > self._noted_s + AGAIN_S and not self._commits:
            # No checkpoint has come for long, and nothing is being committed.
            self.end()
            self._clean_up()
            _print_plainly()
            os._exit(self.exit_status)


class _Uninterrupted:
    """The block of `uninterrupted`."""

    def __init__(self, commits: int) -> None:
        self._commits = commits

    def __enter__(self) -> None:
        SIGNALS.hold(self._commits)

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        SIGNALS.release(self._commits)


def checkpoint() -> None:
    """A safe place to be interrupted at: raises Interrupted if a signal has been noted.

    Call it between steps of at most about a second, before a commit and never inside one, and
    never in a callback of a library that does not expect exceptions.
    """
    if SIGNALS.number is not None:
        SIGNALS.checkpoint()


def uninterrupted(*, may_leave: bool = False) -> _Uninterrupted:
    """A with-block in which no checkpoint raises, such as a commit.

    may_leave: whether a second signal, some seconds after the first, still leaves at once.
    """
    return _Uninterrupted(0 if may_leave else 1)


def pause(seconds: float) -> None:
    """Sleep, with checkpoints."""
    end_s = time.monotonic() + seconds
    while True:
        checkpoint()
        left_s = end_s - time.monotonic()
        if left_s <= 0.0:
            return
        time.sleep(min(left_s, STEP_S))


def is_program() -> bool:
    """Whether this process is the command, and not a program or a test that uses the package."""
    called = os.path.basename(sys.argv[0]).lower() if getattr(sys, "argv", None) else ""
    return called in (PROGRAM, f"{PROGRAM}.exe") or _module_of(sys.orig_argv) == MODULE


def _module_of(words: list[str]) -> str:
    """The module that a command line of Python runs with -m; empty where it runs something else."""
    k = 1
    while k < len(words) and words[k].startswith("-"):
        if words[k] == "-m":
            return words[k + 1] if k + 1 < len(words) else ""
        if words[k] in ("-c", "-"):
            return ""
        k += 2 if words[k] in ("-W", "-X", "--check-hash-based-pycs") else 1
    return ""


def _print_plainly() -> None:
    """Print the line of an interruption without the streams, which may be in use."""
    try:  # noqa: SIM105
        os.write(2, f"{PROGRAM}: {WORDS}\n".encode())
    except OSError:
        pass


SIGNALS = Signals()
if is_program():
    SIGNALS.catch()
