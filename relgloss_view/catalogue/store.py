"""The store of a catalogue: what was made of each file, kept from build to build.

A record is one file, named by a digest of what decides it: the bytes of the sample's file, its own
name and how it is fitted. So a file that has moved is not fitted again, and equal files share a
record. Its first line is the SHA-256 of the rest; a record that is not whole, stands under another
name or holds what no record holds counts as none. So no record waits for the disk, and whatever
ends the program costs the item in hand at most.
"""

from __future__ import annotations

import base64
import contextlib
import errno
import hashlib
import json
import math
import os
import re
import secrets
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.interruptions import checkpoint
from relgloss_view.base.json_files import parse_json
from relgloss_view.base.reading import named
from relgloss_view.catalogue.columns import (
    BY_NAME,
    BYTES,
    DONE,
    FAILED,
    FLAG,
    NUMBER,
    TABLE,
    TEXT,
    WHOLE,
)
from relgloss_view.catalogue.item import OF_FILE, OF_LOOK, OF_MACHINE, Fitted, Item
from relgloss_view.catalogue.recipe import MADE_BY, Recipe
from relgloss_view.catalogue.tree import Entry

ITEMS = "items"
PART = ".part"  #: of files that are not whole yet
HIDDEN = ("path", "material", "bytes")  #: columns that belong to a place in the tree
MOST_BYTES = 64 << 20  #: of a record
_RECORD = re.compile(r"[0-9a-f]{64}\.json|\..*\.part", re.DOTALL)  #: what this program has left
MOST = 2**62  #: of any whole number in a record
_FAILED_IN = ("", OF_FILE, OF_LOOK, OF_MACHINE)
_TYPES: dict[str, Any] = {TEXT: str, NUMBER: (float, int), WHOLE: int, FLAG: bool, BYTES: bytes}


@dataclass(frozen=True)
class Kept:
    """What is known of a record before it is read: enough to plan with."""

    look: str  #: the recipe's of_look
    failed_in: str

    def is_current(self, recipe: Recipe) -> bool:
        """Whether a build with this recipe takes it as it is."""
        if self.failed_in == OF_MACHINE:
            return False
        return self.failed_in == OF_FILE or self.look == recipe.of_look


def key_of(entry: Entry, recipe: Recipe) -> str:
    """The name of a file's record."""
    fit = recipe.of_fit if entry.kind == TABLE else MADE_BY
    name = os.path.basename(entry.file)
    parts = [entry.kind.encode(), entry.sha256.encode(), fit.encode(), os.fsencode(name)]
    return hashlib.sha256(b"\0".join(parts)).hexdigest()


class Store:
    """The records in a catalogue's folder. One program at a time writes; see build.py."""

    def __init__(self, catalogue: Path) -> None:
        self.folder = catalogue / ITEMS
        self._catalogue = catalogue

    def kept(self, key: str) -> Kept | None:
        """A record's state; None where there is none that is whole."""
        lines = self._lines(key)
        return None if lines is None else _kept(lines[0], key)

    def item(self, key: str) -> Item | None:
        """A record; its row has no place in the tree. None where there is none that is whole.

        One that holds what no record holds is removed, so that the next build makes it anew.
        """
        lines = self._lines(key)
        if lines is None:
            return None
        kept = _kept(lines[0], key)
        item = _item(lines[1], kept) if kept is not None else None
        if item is None:
            with contextlib.suppress(OSError):
                os.unlink(self._place(key))
        return item

    def put(self, key: str, item: Item, recipe: Recipe) -> None:
        """Keep an item. Raises InputError where it can't be written."""
        row = {name: value for name, value in item.row.items() if name not in HIDDEN}
        if row.get("thumbnail") is not None:
            row["thumbnail"] = base64.b64encode(row["thumbnail"]).decode("ascii")
        fitted = None if item.fitted is None else vars(item.fitted)
        head = {"key": key, "look": recipe.of_look, "failed_in": item.failed_in}
        body = {"row": row, "fitted": fitted, "driver": item.driver}
        data = b"\n".join(_json(part) for part in (head, body))
        whole = hashlib.sha256(data).hexdigest().encode() + b"\n" + data
        put_whole(self._place(key), whole, self._catalogue)

    def tidy(self, keys: Collection[str]) -> None:
        """Remove all records but these, and what a killed program has left."""
        for folder in _folders(self.folder):
            for name in os.listdir(folder):
                checkpoint()
                if _RECORD.fullmatch(name) and name.removesuffix(".json") not in keys:
                    with contextlib.suppress(OSError):
                        os.unlink(folder / name)
            with contextlib.suppress(OSError):  # it holds records
                os.rmdir(folder)

    def _place(self, key: str) -> Path:
        return self.folder / key[:2] / f"{key}.json"

    def _lines(self, key: str) -> list[bytes] | None:
        """Head and body of a record that is whole."""
        try:
            with open(self._place(key), "rb") as file:
                data = file.read(MOST_BYTES)
        except OSError:
            return None
        digest, _, rest = data.partition(b"\n")
        if hashlib.sha256(rest).hexdigest().encode() != digest:
            return None
        lines = rest.split(b"\n", 1)
        return lines if len(lines) == 2 else None


def _kept(line: bytes, key: str) -> Kept | None:
    """The state in a record's head; None where it is none, or the head of another record."""
    head = _object(line)
    look, failed_in = head.get("look"), head.get("failed_in")
    if head.get("key") != key or not isinstance(look, str) or failed_in not in _FAILED_IN:
        return None
    return Kept(look, str(failed_in))


def _item(line: bytes, kept: Kept) -> Item | None:
    """The item in a record's body; None where a value is none that a record holds."""
    body = _object(line)
    row, fitted, driver = body.get("row"), body.get("fitted"), body.get("driver")
    if not isinstance(row, dict) or not isinstance(driver, str):
        return None
    try:
        if row.get("thumbnail") is not None:
            row["thumbnail"] = base64.b64decode(row["thumbnail"], validate=True)
        made = None if fitted is None else Fitted(**fitted)
    except (TypeError, ValueError):
        return None
    if not all(_fits(name, value) for name, value in row.items()) or not _is_fitted(made):
        return None
    if row.get("status") == FAILED:
        return Item(row, None, made, kept.failed_in, driver) if kept.failed_in else None
    if row.get("status") != DONE or made is None or kept.failed_in:
        return None
    return Item(row, made.material, made, "", driver)


def _object(line: bytes) -> dict[str, Any]:
    """The JSON object of a line; empty where it holds none."""
    try:
        content = parse_json(line.decode("ascii"), parse_constant=_no_constant)
    except (InputError, UnicodeDecodeError):
        return {}
    return content if isinstance(content, dict) else {}


def _no_constant(name: str) -> float:
    raise ValueError(f"{name} is no number of JSON")


def _fits(name: str, value: object) -> bool:
    """Whether a value is one of a column's kind."""
    if name not in BY_NAME or name in HIDDEN:
        return False
    if isinstance(value, bool) or value is None:
        return value is None or BY_NAME[name].kind == FLAG
    if isinstance(value, float) and not math.isfinite(value):
        return False
    if isinstance(value, int) and not -MOST <= value <= MOST:
        return False
    if isinstance(value, str) and not _is_text(value):
        return False
    return isinstance(value, _TYPES[BY_NAME[name].kind])


def _is_text(value: str) -> bool:
    try:
        value.encode("utf-8")
    except UnicodeEncodeError:
        return False
    return True


def _is_fitted(fitted: Fitted | None) -> bool:
    if fitted is None:
        return True
    number, count = fitted.sigma_n_deg, fitted.geometries
    return (
        isinstance(fitted.material, dict)
        and isinstance(number, float | int)
        and not isinstance(number, bool)
        and 0.0 <= number <= 90.0
        and (count is None or (isinstance(count, int) and 0 <= count <= MOST))
    )


def put_whole(path: Path, data: bytes, named_as: Path) -> None:
    """Write a file of a catalogue so that it is there whole or not at all.

    named_as: what a message names. Raises InputError where it can't be written; the file keeps its
    former content then.
    """
    with faults_of(named_as):
        for tries_left in (2, 1, 0):
            try:
                _put_once(path, data)
                return
            except FileNotFoundError:  # another build's tidying: some drives have no locks
                if not tries_left:
                    raise


def _put_once(path: Path, data: bytes) -> None:
    part = path.with_name(f".{path.name[:40]}.{secrets.token_hex(4)}{PART}")  # no other build's
    path.parent.mkdir(parents=True, exist_ok=True)
    try:
        with open(part, "wb") as file:
            file.write(data)
        os.replace(part, path)
    except BaseException:
        with contextlib.suppress(OSError):
            os.unlink(part)
        raise


@contextlib.contextmanager
def faults_of(catalogue: Path) -> Iterator[None]:
    """What prevents writing within the block, as one line that names the catalogue."""
    try:
        yield
    except OSError as error:
        reason = os.strerror(error.errno) if error.errno else str(error)
        is_refused = error.errno in (errno.EACCES, errno.EPERM, errno.EROFS)
        place = os.fspath(catalogue)
        if is_refused and isinstance(error.filename, str | os.PathLike):
            place = os.path.dirname(error.filename)  # of a new file, which nobody has seen
        remedy = "mend its permissions" if is_refused else "make room there"
        raise InputError(
            f"{named(place)}: can't be written ({reason}); {remedy}, then build again: what is "
            "done is kept"
        ) from error


def _json(content: dict[str, Any]) -> bytes:
    return json.dumps(content, allow_nan=False, separators=(",", ":")).encode("ascii")


def _folders(folder: Path) -> list[Path]:
    try:
        return sorted(path for path in folder.iterdir() if path.is_dir())
    except OSError:
        return []
