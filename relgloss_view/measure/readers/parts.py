"""The choice of one of several samples or surfaces of a file: `--part`, by name or number."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable

LISTED = 6  #: names that a message lists
LONGEST_LISTED = 60  #: characters of each


def chosen_part(path: Path, names: Sequence[str], part: str | None, kind: str = "sample") -> int:
    """The index of the wanted one of several samples; of one alone, where there is no other.

    part: a name in any case, or a number from 1. Raises InputError, which lists the first names,
    where nothing is wanted of several or what is wanted is not there.
    """
    if part is None:
        if len(names) == 1:
            return 0
        raise InputError(
            f"{path}: the file holds {len(names)} {kind}s; choose one by name or number with "
            f"--part: {_listed(names)}"
        )
    wanted = part.strip()
    for same in (str.strip, lambda text: " ".join(text.lower().split())):
        matches = [k for k, name in enumerate(names) if same(name) == same(wanted)]
        if len(matches) == 1:
            return matches[0]
        if len(matches) > 1:
            numbers = ", ".join(str(k + 1) for k in matches[:LISTED])
            raise InputError(
                f"{path}: {len(matches)} {kind}s have the name {printable(part, 40)!r}; choose "
                f"one by its number with --part ({numbers})"
            )
    if wanted.isascii() and wanted.isdecimal() and len(wanted) < 9:
        index = int(wanted) - 1
        if 0 <= index < len(names):
            return index
    raise InputError(
        f"{path}: no {kind} {printable(part, 40)!r} among {len(names)}: {_listed(names)}"
    )


def _listed(names: Sequence[str]) -> str:
    shown = [printable(name, LONGEST_LISTED) for name in names[:LISTED]]
    more = f" and {len(names) - len(shown)} more" if len(names) > len(shown) else ""
    return f"{', '.join(shown)}{more}"
