"""The `relgloss` command: parse, call, print. Heavy imports stay inside each command."""

from __future__ import annotations

import argparse
import importlib
import os
import sys
from collections.abc import Sequence

from relgloss_view import __version__
from relgloss_view.errors import RelglossError

COMMANDS = ("fit", "snapshot", "grid", "doctor")
INTERRUPTED = 130


def main(argv: Sequence[str] | None = None) -> int:
    """Run a command line; returns the exit status (0 done, 1 input, 2 usage, 3 no OpenGL)."""
    words = list(sys.argv[1:] if argv is None else argv)
    parser = _parser(words)
    args = parser.parse_args(words)
    args.argv = words
    try:
        status = int(args.run(args))
        sys.stdout.flush()
        return status
    except RelglossError as error:
        print(f"relgloss: {error}", file=sys.stderr)
        return error.exit_status
    except KeyboardInterrupt:
        print("relgloss: interrupted; nothing was written", file=sys.stderr)
        return INTERRUPTED
    except BrokenPipeError:
        # Whoever read the output has gone; the files are written.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except MemoryError:
        print("relgloss: out of memory; give a smaller --size", file=sys.stderr)
        return 1


def _parser(words: Sequence[str]) -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="relgloss",
        description="Pictures of printed packaging that keep the ratio of gloss between samples.",
        epilog="`relgloss COMMAND --help` explains each command with an example.",
    )
    parser.add_argument("--version", action="version", version=f"relgloss {__version__}")
    commands = parser.add_subparsers(metavar="COMMAND", required=True)
    # Only the command in use is imported: start-up is part of every picture's time.
    named = [name for name in COMMANDS if name in words[:1]]
    for name in named or COMMANDS:
        importlib.import_module(f"relgloss_view.commands.{name}").add(commands)
    return parser


if __name__ == "__main__":
    sys.exit(main())
