"""Input from outside: files read within bounds, numbers checked, text made safe to print."""

from __future__ import annotations

import contextlib
import hashlib
import json
import math
import numbers
import os
import stat
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO, NoReturn

from relgloss_view.base.errors import InputError, RelglossError
from relgloss_view.base.interruptions import checkpoint
from relgloss_view.base.visible import visible

SHOWN = 60  #: characters of a wrong value that a message shows
READ_AT_ONCE = 1 << 20  #: bytes
#: A terminal is not taken over either; other systems than Unix have neither flag.
_WITHOUT_WAITING = (
    getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_NOCTTY", 0) | getattr(os, "O_BINARY", 0)
)


def open_regular(path: str | os.PathLike[str], expected: str) -> BinaryIO:
    """A regular file, opened to be read; InputError that names the kind of anything else.

    expected: the wanted kind of file for the message, as in "a scene file (TOML)". Devices never
    end and pipes may never begin. What is opened is checked, so that no exchange of names between
    check and opening lets one in; a pipe that gets there is opened without waiting for its writer.
    """
    check_regular(path, expected)
    try:
        handle = os.open(path, os.O_RDONLY | _WITHOUT_WAITING)
    except (OSError, ValueError) as error:
        raise unreadable(path, error, expected) from None
    try:
        _check_kind(path, os.fstat(handle).st_mode, expected)
        return os.fdopen(handle, "rb")
    except BaseException:
        os.close(handle)
        raise


def check_regular(path: str | os.PathLike[str], expected: str) -> Path:
    """The path, if a regular file has that name; InputError as open_regular.

    For libraries that open a file by its name. Whoever reads it here calls open_regular.
    """
    try:
        if not os.fspath(path):
            raise InputError(f"an empty file name; give the name of {expected}")
        mode = os.stat(path).st_mode
    except (OSError, ValueError) as error:
        raise unreadable(path, error, expected) from None
    _check_kind(path, mode, expected)
    return Path(path)


def _check_kind(path: str | os.PathLike[str], mode: int, expected: str) -> None:
    if not stat.S_ISREG(mode):
        kind = "a folder" if stat.S_ISDIR(mode) else "not a regular file"
        raise InputError(f"{named(path)}: this is {kind}; give {expected}")


def sha256_of(path: str | os.PathLike[str], expected: str) -> tuple[str, int]:
    """SHA-256 of a regular file's bytes, in hexadecimal, and how many they are.

    Read in parts, with a checkpoint before each. Raises InputError as open_regular, OSError where
    reading fails.
    """
    digest, size = hashlib.sha256(), 0
    with open_regular(path, expected) as opened:
        while block := opened.read(READ_AT_ONCE):
            checkpoint()
            digest.update(block)
            size += len(block)
    return digest.hexdigest(), size


def read_text(path: str | os.PathLike[str], most_bytes: int, expected: str) -> str:
    """The UTF-8 text of a regular file of at most `most_bytes`, without a byte order mark.

    expected: the wanted kind of file for the message, as in "a scene file (TOML)". Raises
    InputError where the file is missing, too large or no UTF-8 text.
    """
    file, data = Path(path), read_bytes(path, most_bytes, expected)
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(
            f"{named(file)}: byte {error.start}: not UTF-8 text; give {expected} saved as UTF-8"
        ) from None


def read_bytes(path: str | os.PathLike[str], most_bytes: int, expected: str) -> bytes:
    """The bytes of a regular file of at most `most_bytes`; InputError as read_text."""
    with open_regular(path, expected) as file:
        return read_opened(file, path, most_bytes, expected)


def read_opened(
    file: BinaryIO, path: str | os.PathLike[str], most_bytes: int, expected: str
) -> bytes:
    """The bytes of an opened file from its present place on, at most `most_bytes`.

    path: for messages. Memory is taken for what the file holds, and not for what it may hold.
    Raises InputError.
    """
    try:
        size = os.fstat(file.fileno()).st_size
        data = file.read(min(size, most_bytes) + 1)
        # Files of the system, and those that grow, hold more than they claim.
        while size < len(data) <= most_bytes:
            more = file.read(min(most_bytes + 1 - len(data), READ_AT_ONCE))
            if not more:
                break
            data += more
    except OSError as error:
        raise unreadable(path, error, expected) from None
    if len(data) > most_bytes:
        raise InputError(f"{named(path)}: larger than {most_bytes} bytes; give {expected}")
    return data


def read_beginning(path: str | os.PathLike[str], count: int, expected: str) -> bytes:
    """At most `count` bytes from the beginning of a regular file; InputError as open_regular."""
    with open_regular(path, expected) as file:
        try:
            return file.read(count)
        except OSError as error:
            raise unreadable(path, error, expected) from None


@contextlib.contextmanager
def decoding(path: str | os.PathLike[str], expected: str) -> Iterator[None]:
    """Turn whatever a decoder raises on the content of a file into one InputError line.

    Libraries that decode files raise what their code happens to raise on damaged ones: KeyError,
    AttributeError, OverflowError, MemoryError. The faults that have a reason of their own are
    found before; this is the net below them. Errors of the system become `unreadable`, and
    InputError and errors beyond Exception pass.
    """
    try:
        yield
    except RelglossError:
        raise
    except OSError as error:
        raise unreadable(path, error, expected) from error
    except MemoryError as error:
        raise InputError(f"{named(path)}: not enough memory to read it; give {expected}") from error
    except RecursionError as error:
        raise InputError(
            f"{named(path)}: its parts are nested too deeply; give {expected}"
        ) from error
    except Exception as error:
        kind = type(error).__name__
        raise InputError(f"{named(path)}: can't be decoded ({kind}); give {expected}") from error


def unreadable(
    path: str | os.PathLike[str], error: OSError | ValueError, expected: str
) -> InputError:
    """The InputError of a file that can't be read; a ValueError means an impossible file name."""
    reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
    return InputError(f"{named(path)}: can't be read ({reason}); check the name, give {expected}")


def named(path: str | os.PathLike[str]) -> str:
    """A file's name for a message; of a very long one, which another file may hold, both ends.

    >>> named("a.csv"), len(named(4000 * "a"))
    ('a.csv', 160)
    """
    name = os.fspath(path)
    return name if len(name) <= 250 else f"{name[:55]} ... {name[-100:]}"


def printable(text: object, limit: int = 200) -> str:
    """Outside text on one line of at most `limit` characters, control characters made visible.

    >>> printable("a\\tname\\nwith \\x1b[31mcolour")
    'a name with \\\\x1b[31mcolour'
    """
    line = " ".join(str(text)[: 4 * limit].split())
    line = visible(line)
    return line if len(line) <= limit else line[: limit - 3] + "..."


def refuse(place: str, expected: str, found: object) -> NoReturn:
    """Raise InputError 'PLACE: expected ..., found ...'.

    place: file, table or entry. expected: the wanted value in words. found: the actual value, which
    the message shows as JSON, cut to SHOWN characters.
    """
    try:
        shown = json.dumps(found, default=str)
    except (ValueError, RecursionError):  # an int too long to print, a list too deep
        shown = f"a value of type {type(found).__name__} that is too large to show"
    raise InputError(f"{place}: expected {expected}, found {printable(shown, SHOWN)}")


def number(value: object, place: str, expected: str, low: float, high: float) -> float:
    """A finite number from `low` to `high`, as a float; InputError for anything else.

    >>> number(3, "seed", "a number from 0 to 9", 0, 9)
    3.0
    >>> number(True, "seed", "a number from 0 to 9", 0, 9)
    Traceback (most recent call last):
    ...
    relgloss_view.base.errors.InputError: seed: expected a number from 0 to 9, found true
    """
    if isinstance(value, bool) or not isinstance(value, numbers.Real):
        refuse(place, expected, value)
    try:
        result = float(value)
    except OverflowError:
        refuse(place, expected, value)
    if not (math.isfinite(result) and low <= result <= high):
        refuse(place, expected, value)
    return result


def numbers_of(
    values: object, place: str, expected: str, low: float, high: float
) -> tuple[float, ...]:
    """A list of such numbers as a tuple; InputError names the first that is wrong."""
    if isinstance(values, str | bytes) or not hasattr(values, "__iter__"):
        refuse(place, f"a list, each {expected}", values)
    return tuple(
        number(value, f"{place}[{k}]", expected, low, high) for k, value in enumerate(values)
    )


def text(value: object, place: str) -> str:
    """A text that can be written as UTF-8; InputError for anything else."""
    if not isinstance(value, str):
        refuse(place, "a text", value)
    try:
        value.encode("utf-8")
    except UnicodeEncodeError:
        refuse(place, "a text without lone surrogates", value)
    return value
