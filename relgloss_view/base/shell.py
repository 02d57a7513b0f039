"""Command lines that are shown to be pasted into a shell."""

from __future__ import annotations

import os
import re
import shlex
from collections.abc import Sequence

from relgloss_view.base.visible import is_seen

#: What a message, a terminal or an editor changes: such a space is written as a number.
_FRAGILE_SPACE = re.compile(r"^ | $|  ")


def command_line(words: Sequence[str | os.PathLike[str]]) -> str:
    """Words as one line for a POSIX shell, each quoted where it needs that.

    A word that can't be pasted as it is, with control characters or bytes that are not UTF-8, is
    written as $'...' with their numbers; bash, zsh and ksh read that (POSIX 2024).

    >>> command_line(["relgloss", "experiment", "run", "my answers.sqlite"])
    "relgloss experiment run 'my answers.sqlite'"
    >>> command_line(["relgloss", "view", "a\\nb.toml"])
    "relgloss view $'a\\\\x0ab.toml'"
    """
    return " ".join(_quoted(os.fspath(word)) for word in words)


def option(name: str, value: str) -> list[str]:
    """The words of an option; a value that begins as an option does is joined to it."""
    return [f"{name}={value}"] if value.startswith("-") else [name, value]


def operand(path: str | os.PathLike[str]) -> str:
    """A file as a word that is never taken for an option."""
    name = os.fspath(path)
    return os.path.join(os.curdir, name) if name.startswith("-") else name


def _quoted(word: str) -> str:
    if all(map(is_seen, word)) and not _FRAGILE_SPACE.search(word):
        return shlex.quote(word)
    return "$'" + "".join(_numbered(c) for c in word) + "'"


def _numbered(character: str) -> str:
    if character in "'\\":
        return "\\" + character
    if is_seen(character) and character != " ":
        return character
    return "".join(f"\\x{byte:02x}" for byte in character.encode("utf-8", "surrogateescape"))
