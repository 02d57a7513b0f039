"""`relgloss experiment run`: the window in which an observer answers."""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.interruptions import checkpoint
from relgloss_view.base.reading import printable, read_beginning
from relgloss_view.base.shell import command_line, operand, option
from relgloss_view.base.terminal import Progress, warn
from relgloss_view.commands.scene_options import size_of_text

if TYPE_CHECKING:
    from relgloss_view.experiment.design.study import Study
    from relgloss_view.experiment.session.records import Observer
    from relgloss_view.experiment.session.store import Store

SQLITE = b"SQLite format 3\0"  #: how every such file begins
SUFFIX = ".sqlite"


def add(commands: Any) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "run",
        help="one observer's session: the window for judging pictures",
        description="Lead one observer through a study: consent, instructions, adaptation, then "
        "pairs of pictures, judged with the keys 1, 2, ... or the mouse. Every answer is on the "
        "disk before the next pictures show. Give the command again to resume an interrupted "
        "session at the same pair; it prints whose session it is. Keys: Backspace takes the last "
        "answer back, P pauses, Tab (held) shows the progress to the experimenter, Ctrl+Enter "
        "ends the adaptation early, Ctrl+Q ends.",
        epilog="example: relgloss experiment run paper -o answers.sqlite; the next observer, or "
        "the same one later: relgloss experiment run answers.sqlite; the next observer where the "
        "last one does not come back: relgloss experiment run answers.sqlite --new",
    )
    parser.add_argument(
        "study",
        metavar="STUDY",
        help="Study file (TOML), `paper` for the built-in study, or a session file to resume",
    )
    parser.add_argument(
        "-o",
        "--output",
        metavar="FILE.sqlite",
        help="Session file for the answers of all observers of a study (default: beside the study "
        "file, with its name)",
    )
    who = parser.add_mutually_exclusive_group()
    who.add_argument(
        "--observer",
        metavar="ID",
        help="Pseudonym of the observer. By default the first observer who has not finished "
        "resumes, or a new one begins",
    )
    who.add_argument(
        "--new",
        action="store_true",
        help="Begin a new observer. Unfinished sessions of others keep their answers",
    )
    parser.add_argument(
        "--window",
        metavar="WxH",
        type=size_of_text,
        help="Window size in pixels, in place of the full screen",
    )
    screen = parser.add_mutually_exclusive_group()
    screen.add_argument(
        "--display",
        metavar="FILE",
        help="Display in front of the observer: an ICC profile, or a display file that `relgloss "
        "display` wrote. Pictures are drawn for it, and the session keeps it. By default the last "
        "one given for this session, then the study's, then the system's own profile, then sRGB",
    )
    screen.add_argument(
        "--display-profile",
        metavar="FILE.icc",
        help="ICC profile of the display, kept with the answers. Pictures are not drawn for it; "
        "--display draws for it",
    )
    parser.add_argument("--json", action="store_true", help="Print the outcome as JSON")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Open the window, and tell in the end how far the observer came."""
    from relgloss_view.picture.peak import check_window

    check_window()
    from relgloss_view.commands.view import warn_if_clamped
    from relgloss_view.display.kept_file import keep_file
    from relgloss_view.experiment.session.losses import warnings
    from relgloss_view.experiment.session.store import Store
    from relgloss_view.viewer.shell.platform import open_platform
    from relgloss_view.viewer.shell.window import Window
    from relgloss_view.viewer.trials import letters
    from relgloss_view.viewer.trials.app import Trials
    from relgloss_view.viewer.trials.device import full_screen, read_profile
    from relgloss_view.viewer.trials.experimenter_line import continues

    checkpoint()  # the imports have taken a while
    profile = None if args.display_profile is None else read_profile(args.display_profile)
    if args.display is not None:
        keep_file(args.display)  # a faulty one is reported before a session file is made
    path, study = _session(args.study, args.output)
    open_platform(headless=False)  # where no window can show, no file is made
    with Store(path, study) as store:
        store.study.check_drawn_again()
        for line in warnings(store.losses, path):
            warn(line)
        observer = _observer(store, args.observer, new=args.new)
        notice = continues(store, observer) or f"{printable(observer.name)} begins"
        print(notice, file=sys.stderr, flush=True)
        for line in letters.warnings(store.study):
            warn(line)
        with Progress("experiment") as progress:
            program = Trials(store, observer, profile, progress, args.display, _announce)
            if args.window is None:
                window = Window(program, tune=full_screen)
            else:
                window = Window(program, args.window)
                warn_if_clamped(args, window.size)
            window.run()
    if program.failed:
        raise InputError(program.failed)
    _tell(args, path, observer.name, *program.progress)
    checkpoint()
    return 0


def _announce(line: str) -> None:
    print(printable(line, 1000), file=sys.stderr, flush=True)


def _observer(store: Store, name: str | None, *, new: bool) -> Observer:
    """Who is led through the study: a person, in a file of people."""
    from relgloss_view.experiment.session.flow import nothing_left
    from relgloss_view.experiment.session.records import SIMULATED

    if any(observer.kind == SIMULATED for observer in store.observers()):
        raise InputError(
            f"{printable(store.path)}: holds simulated answers; give people a file of their own "
            "with -o"
        )
    if new:
        return store.new_observer()
    observer = store.observer(name)
    while name is None and nothing_left(store, observer):  # killed on the last page
        store.end(observer)
        observer = store.observer()
    return observer


def _session(argument: str, output: str | None) -> tuple[Path, Study | None]:
    """The session file, and its study; no study where the session file itself is given."""
    from relgloss_view.experiment.design.study_file import BUILT_IN, load_study

    if _is_sqlite(argument):
        if output is not None:
            raise InputError(
                f"{printable(argument)}: is a session file and is continued; leave -o out, or give "
                "a study file to begin another session"
            )
        return Path(argument), None
    study = load_study(argument)
    if output is not None:
        return Path(output), study
    if argument in BUILT_IN and not Path(argument).exists():
        raise InputError(
            f"the built-in study {argument!r} needs a place for its answers; give one, such as "
            f"-o {argument}{SUFFIX}"
        )
    return Path(argument).with_suffix(SUFFIX), study


def _is_sqlite(argument: str) -> bool:
    try:
        return read_beginning(argument, len(SQLITE), "a session") == SQLITE
    except InputError:  # reported by whoever reads it as a study
        return False


def _tell(args: argparse.Namespace, path: Path, observer: str, answered: int, total: int) -> None:
    if args.json:
        content = {"session": str(path), "observer": observer, "answered": answered, "total": total}
        print(json.dumps(content))
        return
    text = f"{printable(path)}: {printable(observer)} has judged {answered} of {total}"
    if answered < total:
        line = command_line(
            ["relgloss", "experiment", "run", operand(path), *option("--observer", observer)]
        )
        text += f"; `{line}` resumes"
    print(text)
