"""The `relgloss` command: parse, call, print. Heavy imports stay inside each command."""

from __future__ import annotations

# First, for a signal may come while the rest is imported.
from relgloss_view.base.interruptions import PROGRAM, SIGNALS, WORDS  # isort: skip

import argparse
import contextlib
import importlib
import keyword
import os
import sys
from collections.abc import Sequence
from typing import Any

from relgloss_view.base import temporaries
from relgloss_view.base.errors import GLUnavailableError, InputError, RelglossError
from relgloss_view.base.reading import printable
from relgloss_view.base.room import check_start, guard_imports
from relgloss_view.base.terminal import make_streams_safe
from relgloss_view.base.version import __version__

#: Each command, a module of its own, with its line in `relgloss --help`.
COMMANDS = {
    "view": "open the window: a reference picture beside the one that is tuned",
    "measure": "show what a measured table holds, before any fit",
    "fit": "fit a reflection model to measured tables",
    "estimate": "estimate a material from gloss-meter readings and a colour",
    "snapshot": "draw one picture without a window",
    "grid": "draw the 7 x 6 stimuli of a sample, with a contact sheet and a manifest",
    "plan": "show how little of the model a scene needs, and why",
    "compare": "draw samples under several operators and check whether the gloss order is kept",
    "match": "find settings that keep a sample's gloss ratio to a reference picture",
    "gloss": "compute what gloss meters would read on a material",
    "pack": "check, write and list packs: a form, an artwork and finishes",
    "display": "show what a monitor shows, from its profile or from readings, and check it",
    "export": "write a material or a pack for another program, and print what is lost",
    "import": "read a material that another program describes",
    "proof": "make one file of a design that others open in a browser, and check it",
    "catalogue": "fit, meter, match and draw every sample of a folder, and search among them",
    "experiment": "run, simulate and analyse the subjective evaluation",
    "bench": "chart speed against accuracy of every way to draw",
    "doctor": "check this machine's OpenGL and libraries, and how to get what is missing",
}
DEFAULT_COMMAND = "view"
#: Commands of a command; the first is meant where its word is left out.
OWN_COMMANDS = {"display": ("show", "check", "convert", "patches")}
INTERRUPTED = 130
LONGEST_FAULT = 1000  #: characters


#: The remedy where memory runs out, by command.
LESS_MEMORY = {
    "measure": "thin out the table",
    "fit": "thin out the table",
    "snapshot": "give a smaller --size",
    "grid": "give a smaller --size",
    "compare": "give a smaller --size or fewer --operators",
    "match": "give a smaller --size",
    "catalogue": "build with fewer --workers",
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
    SIGNALS.before_leaving(temporaries.remove_all)
    guard_imports()
    try:
        status = _status_of(sys.argv[1:])
    except BaseException:
        if SIGNALS.raised:  # whatever an interrupted piece of work has led to
            SIGNALS.leave(_fault(WORDS, SIGNALS.exit_status))
        SIGNALS.end()
        raise
    if SIGNALS.noted:
        SIGNALS.leave(status)
    SIGNALS.end()
    return status


def _status_of(words: list[str]) -> int:
    """The exit status of a command line, with one line printed for what went wrong."""
    try:
        _prepare_streams()
        try:
            status = _run(words)
        except SystemExit as end:  # usage or --help, which argparse has printed
            status = end.code if isinstance(end.code, int) else 0
        if SIGNALS.raised:  # something has swallowed the exception
            return _interrupted()
        return _printed(status)
    except KeyboardInterrupt:
        return _interrupted()
    except Exception as error:
        if SIGNALS.noted:  # the signal has met a child process or a library first
            return _interrupted()
        fault = _words_of(error, words[0] if words else DEFAULT_COMMAND)
        if fault is None:
            raise
        return _fault(*fault)


def _interrupted() -> int:
    return _fault(WORDS, SIGNALS.exit_status if SIGNALS.noted else INTERRUPTED)


def _words_of(error: Exception, command: str) -> tuple[str, int] | None:
    """A fault as one line, and the exit status; None for a mistake of the program."""
    if isinstance(error, RelglossError):
        return str(error), error.exit_status
    if _lacks_memory(error):
        return f"out of memory; {LESS_MEMORY.get(command, 'close other programs')}", 1
    if isinstance(error, OSError) and temporaries.is_no_folder(error):
        return str(temporaries.no_temporary_folder()), 1
    if isinstance(error, OSError):  # of a file that the command has not named, never of a stream
        name = error.filename if error.filename is not None else "a file or a program"
        named = os.fsdecode(name) if isinstance(name, (str, bytes)) else str(name)
        reason = error.strerror or str(error) or type(error).__name__
        return f"{named}: {reason}; check that it is there, can be used and has room", 1
    if isinstance(error, ImportError) and not _is_ours(error):
        text = f"a library can't be loaded ({error}); install relgloss again"
        return f"{text}: `relgloss doctor` lists what is missing", 1
    if _is_opengl(error):
        text = f"OpenGL failed: {error}; see `relgloss doctor`, or draw with --backend reference"
        return text, GLUnavailableError.exit_status
    return None


def _run(words: list[str]) -> int:
    words = words[1:] if words[:1] == ["--"] else words
    words = words or [DEFAULT_COMMAND]
    _check_working_folder()
    temporaries.prepare(words[1:])
    if words[0] in COMMANDS:
        check_start()
    args = _parser(words).parse_args(words)
    args.argv = words
    SIGNALS.work()
    return int(args.run(args))


def _with_own_command(words: list[str]) -> list[str]:
    """`relgloss display FILE` as `relgloss display show FILE`, which is what it means."""
    own = OWN_COMMANDS.get(words[0], ())
    if len(words) > 1 and own and words[1] not in (*own, "-h", "--help"):
        return [words[0], own[0], *words[1:]]
    return words


def _check_working_folder() -> None:
    """InputError where the working folder was removed, so that no name means anything."""
    try:
        os.getcwd()
    except OSError as error:
        reason = error.strerror or error
        text = f"the working folder can't be used ({reason}); change to another one (cd)"
        raise InputError(text) from error


def _prepare_streams() -> None:
    """Let every name be printed, and no terminal obey one; InputError without stdout."""
    if sys.stderr is None:
        sys.stderr = open(os.devnull, "w")  # noqa: SIM115 - as long as the program
    if sys.stdout is None:
        # The next file that is opened would become the standard output of every library.
        raise InputError("standard output is closed; send it to /dev/null")
    make_streams_safe()


def _printed(status: int) -> int:
    """The status of a command whose results are printed, as far as standard output takes them.

    A reader that has closed the pipe has seen enough. The files are written in either case.
    """
    sys.stdout.flush()
    error = getattr(sys.stdout, "fault", None)
    if status != 0 or error is None or isinstance(error, ConnectionError):
        return status
    text = f"standard output: {error.strerror or error}; not all results are printed"
    return _fault(f"{text}; send them to another place", 1)


def _fault(text: str, status: int) -> int:
    with contextlib.suppress(OSError):
        print(f"{PROGRAM}: {printable(text, LONGEST_FAULT)}", file=sys.stderr)
    return status


def _lacks_memory(error: Exception) -> bool:
    """Whether there was none, also where a library could not be loaded, by the loader's words."""
    words = ("failed to map segment", "cannot allocate memory")
    return isinstance(error, MemoryError) or (
        isinstance(error, ImportError) and any(text in str(error) for text in words)
    )


def _is_ours(error: ImportError) -> bool:
    """Whether a name of this package can't be imported, a mistake of the program."""
    return (error.name or "").partition(".")[0] == "relgloss_view"


def _is_opengl(error: Exception) -> bool:
    """Whether an exception is moderngl's, judged by its name so that nothing is imported."""
    return any(
        kind.__module__.split(".")[0] in ("moderngl", "_moderngl", "glcontext")
        for kind in type(error).__mro__
    )


def _parser(words: Sequence[str]) -> argparse.ArgumentParser:
    parser = _Commands(
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
            module = f"{name}_" if keyword.iskeyword(name) else name  # `import` is no module's name
            importlib.import_module(f"relgloss_view.commands.{module}").add(commands)
        else:
            commands.add_parser(name, help=summary)
    return parser


class _Commands(argparse.ArgumentParser):
    """The parser of the whole line."""

    def parse_args(self, args: Any = None, namespace: Any = None) -> Any:
        """As argparse's, with the word that a command of commands may leave out."""
        words = None if args is None else _with_own_command(list(args))
        return super().parse_args(words, namespace)


class _WholeNames(argparse.ArgumentParser):
    """Takes no shortened names: `--sample` is not `--samples` where there is no `--sample`."""

    def __init__(self, **options: Any) -> None:
        super().__init__(allow_abbrev=False, **options)


if __name__ == "__main__":
    sys.exit(main())
