"""The `relgloss` command: parse, call, print. Heavy imports stay inside each command."""

from __future__ import annotations

# First, for a signal may come while the rest is imported.
from relgloss_view.base.interruptions import SIGNALS, WORDS, Interrupted  # isort: skip

import argparse
import contextlib
import importlib
import os
import sys
from collections.abc import Sequence
from typing import Any

from relgloss_view.base import temporaries
from relgloss_view.base.errors import GLUnavailableError, InputError, RelglossError
from relgloss_view.base.reading import printable
from relgloss_view.base.room import check_start
from relgloss_view.base.terminal import make_streams_safe
from relgloss_view.base.version import __version__

#: Each command, a module of its own, with its line in `relgloss --help`.
COMMANDS = {
    "view": "open the window: a reference picture beside the one that is tuned",
    "fit": "fit a reflection model to a measured table",
    "snapshot": "draw one picture without a window",
    "grid": "draw the 7 x 6 stimuli of a sample, with a contact sheet and a manifest",
    "plan": "show how little of the model a scene needs, and why",
    "compare": "draw samples under several operators and check whether the gloss order is kept",
    "match": "find settings that keep a sample's gloss ratio to a reference picture",
    "gloss": "compute what gloss meters would read on a material",
    "experiment": "run, simulate and analyse the subjective evaluation",
    "bench": "chart speed against accuracy of every way to draw",
    "doctor": "check this machine's OpenGL and libraries, and how to get what is missing",
}
DEFAULT_COMMAND = "view"
INTERRUPTED = 130
LONGEST_FAULT = 1000  #: characters


#: The remedy where memory runs out, by command.
LESS_MEMORY = {
    "fit": "thin out the table",
    "snapshot": "give a smaller --size",
    "grid": "give a smaller --size",
    "compare": "give a smaller --size or fewer --operators",
    "match": "give a smaller --size",
    "experiment": "give fewer --draws, or smaller pictures in the study",
    "bench": "give a smaller --size",
}


def main(argv: Sequence[str] | None = None) -> int:
    """Run a command line; returns the exit status (0 done, 1 input, 2 usage, 3 no OpenGL)."""
    if argv is not None or not SIGNALS.caught:
        streams = sys.stdout, sys.stderr
        try:
            return _status_of(list(sys.argv[1:] if argv is None else argv))
        finally:
            sys.stdout, sys.stderr = streams
    SIGNALS.work(temporaries.remove_all)
    try:
        status = _status_of(sys.argv[1:])
    except BaseException:
        SIGNALS.end()
        raise
    if SIGNALS.interrupted:
        SIGNALS.leave(status)
    SIGNALS.end()
    return status


def _status_of(words: list[str]) -> int:
    try:
        _prepare_streams()
        try:
            status = _run(words)
        except SystemExit as end:  # usage or --help, which argparse has printed
            status = end.code if isinstance(end.code, int) else 0
        sys.stdout.flush()
        return status
    except RelglossError as error:
        return _fault(str(error), error.exit_status)
    except Interrupted as signal:
        return _fault(WORDS, signal.exit_status)
    except KeyboardInterrupt:
        return _fault(WORDS, INTERRUPTED)
    except BrokenPipeError:
        _drop_output()  # the reader has closed the pipe; the files are written
        return 0
    except (MemoryError, ImportError) as error:
        if isinstance(error, ImportError) and not _lacks_memory(error):
            raise
        remedy = LESS_MEMORY.get(words[0] if words else "", "close other programs")
        return _fault(f"out of memory; {remedy}", 1)
    except OSError as error:
        # Commands name the files that they can't read or write, so this is a stream.
        _drop_output()
        reason = f"standard output: {error.strerror}" if error.strerror else str(error)
        return _fault(f"{reason}; choose another place", 1)
    except Exception as error:
        if not _is_opengl(error):
            raise
        text = f"OpenGL failed: {error}; see `relgloss doctor`, or draw with --backend reference"
        return _fault(text, GLUnavailableError.exit_status)


def _run(words: list[str]) -> int:
    words = words[1:] if words[:1] == ["--"] else words
    words = words or [DEFAULT_COMMAND]
    if words[0] in COMMANDS:
        check_start()
    args = _parser(words).parse_args(words)
    args.argv = words
    return int(args.run(args))


def _prepare_streams() -> None:
    """Let every name be printed, and no terminal obey one; InputError without stdout."""
    if sys.stderr is None:
        sys.stderr = open(os.devnull, "w")  # noqa: SIM115 - as long as the program
    if sys.stdout is None:
        # The next file that is opened would become the standard output of every library.
        raise InputError("standard output is closed; send it to /dev/null")
    make_streams_safe()


def _fault(text: str, status: int) -> int:
    with contextlib.suppress(OSError):
        print(f"relgloss: {printable(text, LONGEST_FAULT)}", file=sys.stderr)
    return status


def _drop_output() -> None:
    """Send what is still buffered to the null device, so that the exit does not fail on it."""
    with contextlib.suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _lacks_memory(error: ImportError) -> bool:
    """Whether a library could not be loaded for want of memory, by the loader's words."""
    return any(text in str(error) for text in ("failed to map segment", "cannot allocate memory"))


def _is_opengl(error: Exception) -> bool:
    """Whether an exception is moderngl's, judged by its name so that nothing is imported."""
    return any(
        kind.__module__.split(".")[0] in ("moderngl", "_moderngl", "glcontext")
        for kind in type(error).__mro__
    )


def _parser(words: Sequence[str]) -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="relgloss",
        description="Pictures of printed packaging that keep the ratio of gloss between samples.",
        epilog="`relgloss` alone opens the window; `relgloss COMMAND --help` explains each command "
        "with an example.",
    )
    parser.add_argument("--version", action="version", version=f"relgloss {__version__}")
    commands = parser.add_subparsers(metavar="COMMAND", required=True, parser_class=_WholeNames)
    # Only the command in use is imported: start-up is part of every picture's time.
    for name, summary in COMMANDS.items():
        if name == words[0]:
            importlib.import_module(f"relgloss_view.commands.{name}").add(commands)
        else:
            commands.add_parser(name, help=summary)
    return parser


class _WholeNames(argparse.ArgumentParser):
    """Takes no shortened names: `--sample` is not `--samples` where there is no `--sample`."""

    def __init__(self, **options: Any) -> None:
        super().__init__(allow_abbrev=False, **options)


if __name__ == "__main__":
    sys.exit(main())
