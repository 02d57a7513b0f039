"""The profile that colord has for a monitor, by a program that asks it over D-Bus.

colord's session helper usually sets the X property (see x11.py); this is for sessions without one.
There is no D-Bus library here: gdbus (GLib) or busctl (systemd) asks, in a process that is ended
where it takes too long. colord sends signals where a profile changes; the times of its two tables
are looked at in their place.

Source: colord's D-Bus interface org.freedesktop.ColorManager (Hughes 2010).
"""

from __future__ import annotations

import ast
import os
import re
import shutil
import subprocess

from relgloss_view.base.child import Child
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import read_bytes
from relgloss_view.display.system.answer import MOST_BYTES, Answer, SystemProfile

LONGEST_S = 2.0  #: of one question
SERVICE = "org.freedesktop.ColorManager"
PROPERTY = "org.freedesktop.DBus.Properties.Get"
OBJECT = "/org/freedesktop/ColorManager"
TABLES = ("/var/lib/colord/mapping.db", "/var/lib/colord/storage.db")
_QUOTED = re.compile(r"""'(?:[^'\\]|\\.)*'|"(?:[^"\\]|\\.)*\"""")
_IS_EMPTY = ("", "/")


class Colord:
    """Asks colord for the profiles of monitors, by RandR's names of them."""

    def __init__(self) -> None:
        self._program = next((p for p in map(shutil.which, ("gdbus", "busctl")) if p), None)
        self._stamps = _stamps()

    @property
    def there(self) -> bool:
        """Whether there are tables and a program, so that another answer may come."""
        return self._program is not None and any(stamp is not None for stamp in self._stamps)

    def changed(self) -> bool:
        """Whether colord's tables have changed since this was last asked."""
        before, self._stamps = self._stamps, _stamps()
        return before != self._stamps

    def answer(self, output: str) -> Answer:
        """The profile of a monitor; none where nothing answers."""
        if self._program is None or not output:
            return Answer()
        device = self._ask(OBJECT, SERVICE, "FindDeviceByProperty", "XRANDR_name", output)
        profile = "" if device in _IS_EMPTY else self._ask(device, f"{SERVICE}.Device", "Profiles")
        file = "" if profile in _IS_EMPTY else self._ask(profile, f"{SERVICE}.Profile", "Filename")
        if not file:
            return Answer()
        try:
            data = read_bytes(file, MOST_BYTES, "an ICC profile")
        except InputError as error:
            return Answer(None, f"colord's profile: {error}", fault=True)
        return Answer(SystemProfile(data, os.path.basename(file), "colord"))

    def _ask(self, place: str, interface: str, name: str, *words: str) -> str:
        """The first text of the answer of a method with words, or of a property without; or ""."""
        assert self._program is not None
        if self._program.endswith("gdbus"):
            call = ["call", "--system", "--timeout", f"{LONGEST_S:.0f}", "--dest", SERVICE]
            call += ["--object-path", place, "--method"]
            call += [f"{interface}.{name}", *words] if words else [PROPERTY, interface, name]
        elif words:
            call = ["--system", "call", SERVICE, place, interface, name, "s" * len(words), *words]
        else:
            call = ["--system", "get-property", SERVICE, place, interface, name]
        try:
            child = Child(
                [self._program, *call],
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
            )
        except (OSError, ValueError):
            return ""
        outcome = child.outcome(LONGEST_S)
        return first_text(outcome.out) if outcome.status == 0 else ""


def first_text(answer: str) -> str:
    """The first quoted text of an answer of gdbus or busctl.

    >>> first_text("(<[objectpath '/a/b', '/c']>,)"), first_text('ao 1 "/a b"'), first_text("ao 0")
    ('/a/b', '/a b', '')
    """
    found = _QUOTED.search(answer)
    if found is None:
        return ""
    try:
        return str(ast.literal_eval(found.group()))
    except (ValueError, SyntaxError):
        return ""


def _stamps() -> tuple[int | None, ...]:
    stamps: list[int | None] = []
    for table in TABLES:
        try:
            stamps.append(os.stat(table).st_mtime_ns)
        except OSError:
            stamps.append(None)
    return tuple(stamps)
