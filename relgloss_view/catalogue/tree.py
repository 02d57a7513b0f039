"""What lies in a tree: its tables, materials and proofs, each with the digest of its bytes."""

from __future__ import annotations

import hashlib
import os
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from relgloss_view.base.errors import InputError
from relgloss_view.base.foreign import HEAD_BYTES
from relgloss_view.base.interruptions import checkpoint
from relgloss_view.base.json_files import read_mark
from relgloss_view.base.reading import named, open_regular, sha256_of
from relgloss_view.catalogue.columns import MATERIAL, PROOF, TABLE
from relgloss_view.catalogue.work import EXPECTED
from relgloss_view.material.files import FORMAT as MATERIAL_FORMAT
from relgloss_view.material.files import MAX_BYTES as MOST_MATERIAL_BYTES
from relgloss_view.measure.readers.recognised import is_table
from relgloss_view.proof.read import HEAD_BYTES as PROOF_HEAD_BYTES
from relgloss_view.proof.read import is_marked

MARK = "catalogue.json"  #: the file that marks a folder as a catalogue
FORMAT = "relgloss-catalogue"
MOST_FILES = 1_000_000
MOST_DEPTH = 200


@dataclass(frozen=True)
class Entry:
    """A file of the tree that the catalogue has a row for.

    file: its absolute path. path: from the top, with /, as the row has it; no two have the same.
    fault: why it can't be read at all; it has no digest then.
    """

    file: str
    path: str
    kind: str
    size: int
    sha256: str = ""
    fault: str = ""


@dataclass(frozen=True)
class Tree:
    """What was found: entries sorted by path, and how many files are none of a catalogue's."""

    entries: tuple[Entry, ...]
    passed_over: int
    faults: tuple[str, ...] = ()  #: of folders that can't be read
    doubtful: tuple[str, ...] = ()  #: files passed over though they are named as tables are
    importable: tuple[str, ...] = ()  #: files passed over that `relgloss import` may read


def is_catalogue(folder: str | os.PathLike[str]) -> bool:
    """Whether a folder is marked as a catalogue.

    >>> is_catalogue("no such folder")
    False
    """
    mark = os.path.join(folder, MARK)
    return os.path.isfile(mark) and read_mark(mark).get("format") == FORMAT


def scan(root: str | os.PathLike[str], seen: Callable[[int], object] = bool) -> Tree:
    """The tables, materials and proofs of a tree, at most MOST_DEPTH folders deep.

    Hidden files, catalogues, and links to folders of the tree itself are passed over. seen: called
    with the number of files that were looked at. Raises InputError where `root` can't be read.
    """
    top = os.path.realpath(root)
    if not os.path.isdir(top):
        raise InputError(f"{named(os.fspath(root))}: is no folder; give a folder of tables")
    entries: list[Entry] = []
    faults: list[str] = []
    passed_over, doubtful, importable = 0, list[str](), list[str]()
    for number, found in enumerate(_files(top, faults)):
        checkpoint()
        if number >= MOST_FILES:
            raise InputError(
                f"{named(os.fspath(root))}: holds more than {MOST_FILES:,} files; make a catalogue "
                "of each of its folders"
            )
        seen(number + 1)
        entry = _entry(top, found)
        if entry is None:
            passed_over += 1
            if found.lower().endswith(_TABLES) and len(doubtful) < MOST_DOUBTFUL:
                doubtful.append(_path_in(top, found))
            if found.lower().endswith(_IMPORTABLE) and len(importable) < MOST_DOUBTFUL:
                importable.append(_path_in(top, found))
        else:
            entries.append(entry)
    entries.sort(key=lambda entry: entry.path)
    doubtful.sort()
    importable.sort()
    return Tree(tuple(entries), passed_over, tuple(faults), tuple(doubtful), tuple(importable))


def _files(top: str, faults: list[str]) -> Iterator[str]:
    """The regular files below a folder, sorted within each; each folder once."""
    waiting, entered = [(top, 0)], {_identity(top)}
    while waiting:
        folder, depth = waiting.pop()
        try:
            with os.scandir(folder) as listed:
                found = sorted(listed, key=lambda one: one.name)
        except OSError as error:
            reason = error.strerror or error
            line = f"can't be read ({reason}); mend its permissions"
            if folder == top:
                raise InputError(f"{named(folder)}: {line}") from error
            faults.append(f"{named(_path_in(top, folder))}: {line}")
            continue
        folders = []
        for one in found:
            if one.name.startswith("."):
                continue
            kind = _kind_of_entry(one)
            if kind == "folder":
                real = os.path.realpath(one.path)
                if one.is_symlink() and (_is_within(top, real) or _is_within(real, top)):
                    continue  # it is in the tree under its own name, or holds the tree
                if _identity(one.path) in entered:
                    continue
                if depth + 1 >= MOST_DEPTH:
                    line = f"more than {MOST_DEPTH} folders within each other; move it up"
                    faults.append(f"{named(_path_in(top, one.path))}: {line}")
                    continue
                if not is_catalogue(one.path):
                    entered.add(_identity(one.path))
                    folders.append((one.path, depth + 1))
            elif kind == "file":
                yield one.path
        waiting.extend(reversed(folders))


def _kind_of_entry(one: os.DirEntry[str]) -> str:
    """folder, file, or nothing: a pipe, a device, a link that leads nowhere or in a circle."""
    try:
        return "folder" if one.is_dir() else "file" if one.is_file() else ""
    except OSError:
        return ""


def _identity(folder: str) -> tuple[int, int]:
    try:
        there = os.stat(folder)
    except OSError:
        return 0, 0
    return there.st_dev, there.st_ino


def _is_within(top: str, path: str) -> bool:
    return path == top or path.startswith(top.rstrip(os.sep) + os.sep)


def _entry(top: str, file: str) -> Entry | None:
    """The entry of a file; None where it is neither table nor material nor proof."""
    path = _path_in(top, file)
    try:
        size = os.stat(file).st_size
        with open_regular(file, EXPECTED) as opened:
            head = opened.read(HEAD_BYTES)
    except (InputError, OSError) as error:
        inner = error.__cause__ or error.__context__ or error  # open_regular hides it
        reason = getattr(inner, "strerror", None) or str(error)
        if file.lower().endswith(_DATA):
            if isinstance(inner, FileNotFoundError):  # it has gone since its folder was listed
                return None
            is_refused = isinstance(inner, PermissionError)
            remedy = "mend its permissions" if is_refused else "mend it, or move it elsewhere"
            line = f"can't be read ({_reason(reason, file)}); {remedy}"
            return Entry(file, path, _kind_by_name(file), 0, fault=line)
        return None
    kind = kind_of(file, head, size)
    if kind is None:
        return None
    try:
        digest, size = sha256_of(file, EXPECTED)
    except (InputError, OSError) as error:
        return Entry(file, path, kind, size, fault=f"can't be read ({_reason(str(error), file)})")
    return Entry(file, path, kind, size, digest)


def _path_in(top: str, file: str) -> str:
    return text_of(os.path.relpath(file, top).replace(os.sep, "/"))


def kind_of(file: str, head: bytes, size: int) -> str | None:
    """TABLE, MATERIAL or PROOF by the beginning of a file's content; None for anything else."""
    if is_marked(head[:PROOF_HEAD_BYTES]):
        return PROOF
    if head.lstrip(b"\xef\xbb\xbf \t\r\n").startswith(b"{"):
        if MATERIAL_FORMAT.encode() in head:
            return MATERIAL
        if HEAD_BYTES < size <= MOST_MATERIAL_BYTES and _names_format(file):
            return MATERIAL
        return None
    return TABLE if is_table(Path(file)) else None


def _names_format(file: str) -> bool:
    """Whether a JSON file is a material whose format stands far behind."""
    return read_mark(file).get("format") == MATERIAL_FORMAT


#: Names of tables: one that is passed over may be a table with headings that nobody knows.
#: Endings of materials of other programs.
_IMPORTABLE = (".mtlx", ".glb", ".gltf")
_TABLES = (
    ".csv", ".tsv", ".txt", ".dat", ".xlsx", ".xls", ".ods", ".bsdf", ".binary", ".cxf", ".astm",
)  # fmt: skip
MOST_DOUBTFUL = 1000
#: Files that nobody can read count where their names promise something.
_DATA = (".csv", ".txt", ".tsv", ".json", ".html", ".bsdf", ".binary", ".xml", ".cxf", ".astm")


_SHOWN = re.compile(r"\\x.*~[0-9a-f]{8}\Z", re.DOTALL)  #: what text_of makes of a name


def _kind_by_name(file: str) -> str:
    lower = file.lower()
    return MATERIAL if lower.endswith(".json") else PROOF if lower.endswith(".html") else TABLE


def _reason(text: str, file: str) -> str:
    return " ".join(text.replace(f"{named(file)}: ", "").split())[:200]


def text_of(path: str) -> str:
    r"""A path as text that any file can hold; a name that is no UTF-8 gets a digest behind it.

    So does a name that looks as if it had got one: two paths never have the same text.

    >>> text_of("lot/paper.csv"), text_of("a\udcff.csv")
    ('lot/paper.csv', 'a\\xff.csv~9ee97a19')
    """
    data = os.fsencode(path)  # the same bytes, whichever encoding this user's names have
    try:
        text = data.decode("utf-8")
    except UnicodeDecodeError:
        return f"{data.decode('utf-8', 'backslashreplace')}~{_digest_of(path)}"
    return f"{text}~{_digest_of(path)}" if _SHOWN.search(text) else text


def _digest_of(path: str) -> str:
    return hashlib.sha256(os.fsencode(path)).hexdigest()[:8]
