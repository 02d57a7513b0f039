"""Tables of a command line: files, built-in papers, folders; and names of what is made of each."""

from __future__ import annotations

import os
import sys
import unicodedata
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from relgloss_view.base.decoration import fault_line
from relgloss_view.base.errors import InputError, RelglossError
from relgloss_view.base.interruptions import PROGRAM, checkpoint
from relgloss_view.base.reading import printable
from relgloss_view.base.terminal import warn

#: A folder with more entries is no folder of tables.
MOST_ENTRIES = 10_000
MOST_NAMED = 5  #: of the files that are passed over
LONGEST_FAULT = 1000  #: characters


@dataclass(frozen=True)
class Tables:
    """What a command line names."""

    places: tuple[str, ...]  #: files, and names of built-in papers, each once
    passed_over: tuple[str, ...]  #: files and folders in the named folders that are no tables
    several: bool  #: whether there is more than one, or a folder was named


def gather(words: Sequence[str]) -> Tables:
    """The tables that words name. A folder stands for the tables in it, not for its folders.

    Hidden files are passed over without a word. Raises InputError for a folder that can't be read
    or holds no table.
    """
    from relgloss_view.measure.readers.built_in import table_file

    places: list[str] = []
    passed_over: list[str] = []
    for word in words:
        if not word:  # Path makes the working folder of it
            raise InputError("TABLE '': expected the name of a table")
        if os.path.isdir(table_file(word)):
            tables, others = _in_folder(word)
            places += tables
            passed_over += others
        else:
            places.append(word)
    once = {_real(table_file(place)): place for place in reversed(places)}
    places = [place for place in places if once.get(_real(table_file(place))) is place]
    return Tables(
        tuple(dict.fromkeys(places)),
        tuple(dict.fromkeys(passed_over)),
        len(words) > 1 or any(os.path.isdir(table_file(word)) for word in words),
    )


def _in_folder(folder: str) -> tuple[list[str], list[str]]:
    """The tables in a folder, and what else is there, by name."""
    from relgloss_view.measure.readers.recognised import is_table

    try:
        names = sorted(name for name in os.listdir(folder) if not name.startswith("."))
    except OSError as error:
        reason = error.strerror or error
        raise InputError(f"{folder}: can't be read ({reason}); check its permissions") from error
    if len(names) > MOST_ENTRIES:
        raise InputError(
            f"{folder}: holds {len(names)} files, at most {MOST_ENTRIES} are looked at; name the "
            "tables themselves"
        )
    tables: list[str] = []
    others: list[str] = []
    for name in names:
        checkpoint()
        path = os.path.join(folder, name)
        (tables if is_table(Path(path)) else others).append(path)
    if not tables:
        raise InputError(
            f"{folder}: none of its {len(names)} files is a measured table (docs/files.md has the "
            "formats; folders in it are not searched)"
        )
    return tables, others


def report_passed_over(tables: Tables) -> None:
    """One warning that lists what is no table."""
    count = len(tables.passed_over)
    if not count:
        return
    names = [os.path.basename(path) + "/" * os.path.isdir(path) for path in tables.passed_over]
    more = f" and {count - MOST_NAMED} more" if count > MOST_NAMED else ""
    listed = ", ".join(printable(name, 60) for name in names[:MOST_NAMED])
    noun = "1 entry" if count == 1 else f"{count} entries"
    warn(
        f"passed over {noun} that {'is' if count == 1 else 'are'} no measured table: {listed}{more}"
    )


def stems(places: Sequence[str]) -> list[str]:
    """A name for what is made of each table, without ending; no two are the same file anywhere.

    It is the table's own name. Where two have the same, upper and lower case being one, the folder
    goes before it, then the ending behind it, then a number.

    >>> stems(["lot1/paper.csv", "lot2/Paper.csv", "art-coated"])
    ['lot1-paper', 'lot2-Paper', 'art-coated']
    >>> stems(["a/x.csv", "a/x.txt", "b/x.csv", "a-x-csv.csv"])
    ['a-x-csv-2', 'a-x-txt', 'b-x', 'a-x-csv']
    """
    paths = [Path(place) for place in places]
    kinds = [
        [path.stem or "table" for path in paths],
        [_joined(_folder(path), path.stem) for path in paths],
        [_joined(_folder(path), path.stem, path.suffix.lstrip(".")) for path in paths],
    ]
    chosen = list(kinds[0])
    for names in kinds[1:]:
        count = Counter(map(_folded, chosen))
        chosen = [
            name if count[_folded(old)] > 1 else old
            for name, old in zip(names, chosen, strict=True)
        ]
    # A name that a table has by itself goes before one that was made.
    own = {_folded(name) for name, plain in zip(chosen, kinds[0], strict=True) if name == plain}
    taken: set[str] = set()
    result = []
    for name, plain in zip(chosen, kinds[0], strict=True):
        number, free = 1, name
        while _folded(free) in taken or (free != plain and _folded(free) in own):
            number += 1
            free = f"{name}-{number}"
        taken.add(_folded(free))
        result.append(free)
    return result


def _joined(*parts: str) -> str:
    return "-".join(part for part in parts if part)


def _folder(path: Path) -> str:
    """Name of the folder that a file lies in."""
    return Path(os.path.realpath(os.fspath(path).replace("\0", ""))).parent.name


def _folded(name: str) -> str:
    """Equal for names that some file system takes for one."""
    return unicodedata.normalize("NFC", unicodedata.normalize("NFC", name).casefold())


def _real(path: str | os.PathLike[str]) -> str:
    return os.path.realpath(os.fspath(path).replace("\0", ""))  # opening it refuses a NUL


def output_of(folder: str, stem: str, ending: str, places: Sequence[str]) -> str:
    """The path of an output; InputError where it would replace one of the tables."""
    path = os.path.join(folder, stem + ending)
    for place in places:
        same = _folded(_real(path)) == _folded(_real(place))
        if not same and os.path.exists(path) and os.path.exists(place):
            same = os.path.samefile(path, place)  # a hard link, another spelling
        if same:
            raise InputError(f"{path}: would replace the table {place}; choose another folder")
    return path


def check_folder(option: str, name: str, ending: str) -> None:
    """InputError where an option that needs a folder names a file."""
    if not name:
        raise InputError(f"{option} '': an empty name; give the name of a folder")
    if os.path.isdir(name):
        return
    if name.lower().endswith(ending) and not name.endswith(("/", os.sep)):
        raise InputError(
            f"{option} {name}: several tables need a folder, and this is the name of one file; "
            "give a folder, such as materials/"
        )
    if os.path.lexists(name):
        raise InputError(f"{option} {name}: is a file; give the name of a folder")


def fault_of(place: str, error: Exception) -> str:
    """What went wrong with one table, on one line that names it.

    A mistake of the program is raised with RELGLOSS_FAULTS=raise.
    """
    if isinstance(error, RelglossError):
        text = str(error)
        return text if place in text else f"{place}: {text}"
    if isinstance(error, MemoryError):
        return f"{place}: out of memory; thin out the table"
    return f"{place}: {fault_line(error)}"


def print_fault(text: str) -> None:
    """A fault of one table among several, as the command prints its own."""
    print(f"{PROGRAM}: {printable(text, LONGEST_FAULT)}", file=sys.stderr)
