"""The tables of the built-in papers, by name, so that every command works from any folder."""

from __future__ import annotations

import os
from pathlib import Path

from relgloss_view.base.resources import asset


def built_in_tables() -> tuple[str, ...]:
    """Names of the built-in papers whose synthetic tables come with relgloss.

    >>> built_in_tables()
    ('art-coated', 'cast-coated', 'matte-coated', 'uncoated')
    """
    return tuple(sorted(file.stem for file in asset("papers").glob("*.csv")))


def table_file(place: str | os.PathLike[str]) -> Path:
    """The file of a table: the place itself, or the table of the built-in paper of that name.

    A file of that name goes before the built-in one.

    >>> table_file("art-coated").name, table_file("mine.csv").name
    ('art-coated.csv', 'mine.csv')
    """
    name = os.fspath(place)
    if name in built_in_tables() and not os.path.lexists(name):
        return asset("papers", f"{name}.csv")
    return Path(name)
