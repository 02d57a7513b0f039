"""Files of displays that the window opens: ICC profiles and display files, by their content."""

from __future__ import annotations

import os
import re

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import read_beginning
from relgloss_view.display.read import monitor_of
from relgloss_view.viewer.files.monitor_profile import prepare
from relgloss_view.viewer.state.screens import name_of_other
from relgloss_view.viewer.state.state import AS_DECLARED, SIDES, State

DISPLAY_SUFFIXES = (".icc", ".icm", ".toml")
PROFILE = "profile"  #: the entry of the scene's display
SEEN_ON = {f"{side}_seen_on": side for side in SIDES}  #: entries of the presentation, by side
HEAD_BYTES = 64 * 1024
_ICC_AT, _ICC = 36, b"acsp"
_DISPLAY_FILE = re.compile(rb'^[ \t]*format[ \t]*=[ \t]*["\']relgloss-display["\']', re.MULTILINE)


def is_display_file(path: str | os.PathLike[str]) -> bool:
    """Whether a file is an ICC profile or a display file; False also where it can't be read."""
    try:
        head = read_beginning(path, HEAD_BYTES, "a display")
    except InputError:
        return False
    return head[_ICC_AT : _ICC_AT + len(_ICC)] == _ICC or _DISPLAY_FILE.search(head) is not None


def check_display(path: str) -> None:
    """Read the display of a file, so that drawing for it takes no time. Raises InputError."""
    prepare(monitor_of(path))


def with_display(state: State, entry: str, path: str) -> State:
    """The state with a display's file, or with "" for none, at PROFILE or an entry of SEEN_ON.

    A scene's profile is one that pictures are drawn for from then on.
    """
    if entry in SEEN_ON:
        return state.with_part("presentation", **{entry: path})
    state = state.with_part("display", profile=path)
    return state.with_part("presentation", screen=AS_DECLARED) if path else state


def display_note(entry: str, path: str) -> str:
    """A line on what was opened."""
    name = name_of_other(path)
    if entry in SEEN_ON:
        return f"the {SEEN_ON[entry]} picture is as {name} shows it"
    return f'pictures are drawn for {name}, the scene\'s display now; Scene: "Show for" changes it'
