"""Ctrl-C, and the signals by which a system ends programs: clean up, then leave with 128 + number.

The first signal is raised as an exception, so that every with-block removes what it has made. The
program then leaves at once: what Python does at a normal end would meet an OpenGL driver in the
middle of its work, and can end in a segmentation fault.
"""

from __future__ import annotations

# Nothing that takes time to import comes before the handlers are in place: hence _signal, which
# `signal` only dresses up, and no contextlib.
import _signal as signal  # type: ignore[import-not-found]
import os
import sys
import time

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from types import FrameType

PROGRAM = "relgloss"
MODULE = "relgloss_view.cli"
WORDS = "interrupted; no file is left half written"
#: By which programs are ended, where the system has them: Ctrl-C, `kill`, a closed terminal.
NAMES = ("SIGINT", "SIGTERM", "SIGHUP")
AGAIN_S = 1.0  #: a signal sooner after the first is the same wish, and does not stop the clean-up
RETRY_S = 0.005
#: While these are at work an exception has to wait: C code below them calls Python and does not
#: expect one (moderngl ends in a segmentation fault), or swallows it. tempfile leaves the file by
#: which it tries a folder.
DELICATE_MODULES = ("moderngl", "_moderngl", "glcontext", "importlib", "tempfile")
DELICATE_FUNCTIONS = ("__del__",)


class Interrupted(KeyboardInterrupt):
    """A signal that ends the program; whoever handles Ctrl-C handles it too."""

    def __init__(self, number: int) -> None:
        super().__init__()
        self.exit_status = 128 + number


class Signals:
    """What the program does on a signal, in its three parts: early, at work, at its end."""

    def __init__(self) -> None:
        self._first_s: float | None = None
        self._waiting: int | None = None  #: a signal that could not be raised yet
        self._caught: list[int] = []
        self._clean_up: Callable[[], object] = lambda: None

    @property
    def interrupted(self) -> bool:
        """Whether one has come while the program was at work."""
        return self._first_s is not None

    @property
    def caught(self) -> bool:
        """Whether these handlers are in place."""
        return bool(self._caught)

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

    def work(self, clean_up: Callable[[], object]) -> None:
        """From now on: raise Interrupted.

        clean_up: removes what no with-block has removed, before a leave.
        """
        self._clean_up = clean_up
        for number in self._caught:
            signal.signal(number, self._on_signal)
        if self._caught and hasattr(signal, "setitimer"):
            signal.signal(signal.SIGALRM, self._on_retry)

    def end(self) -> None:
        """The work is done: a signal that comes now changes nothing any more."""
        if self._caught and hasattr(signal, "setitimer"):
            signal.setitimer(signal.ITIMER_REAL, 0.0)
        self._waiting = None
        for number in self._caught:
            signal.signal(number, signal.SIG_IGN)

    def leave(self, status: int) -> None:
        """Clean up, and leave without what Python does at a normal end."""
        self.end()
        self._clean_up()
        for stream in (sys.stdout, sys.stderr):
            try:  # noqa: SIM105
                stream.flush()
            except (OSError, ValueError, AttributeError):
                pass
        os._exit(status)

    def _leave_early(self, number: int, frame: FrameType | None) -> None:
        self.end()
        try:  # noqa: SIM105
            os.write(2, f"{PROGRAM}: {WORDS}\n".encode())
        except OSError:
            pass
        os._exit(128 + number)

    def _on_signal(self, number: int, frame: FrameType | None) -> None:
        now_s = time.monotonic()
        if self._first_s is None or now_s > self._first_s + AGAIN_S:
            self._first_s = now_s
            self._raise(number, frame)

    def _on_retry(self, _: int, frame: FrameType | None) -> None:
        if self._waiting is not None:
            self._raise(self._waiting, frame)

    def _raise(self, number: int, frame: FrameType | None) -> None:
        if hasattr(signal, "setitimer") and _is_delicate(frame):
            self._waiting = number
            signal.setitimer(signal.ITIMER_REAL, RETRY_S)
            return
        self._waiting = None
        raise Interrupted(number)


def _is_delicate(frame: FrameType | None) -> bool:
    """Whether an exception in this frame could meet C code that does not expect it."""
    while frame is not None:
        module = str(frame.f_globals.get("__name__", "")).partition(".")[0]
        if module in DELICATE_MODULES or frame.f_code.co_name in DELICATE_FUNCTIONS:
            return True
        frame = frame.f_back
    return False


def is_program() -> bool:
    """Whether this process is the command, and not a program or a test that uses the package."""
    called = os.path.splitext(os.path.basename(sys.argv[0]))[0] if sys.argv else ""
    words = sys.orig_argv
    return called == PROGRAM or any(
        words[k : k + 2] == ["-m", MODULE] for k in range(len(words) - 1)
    )


SIGNALS = Signals()
if is_program():
    SIGNALS.catch()
