"""Valid files written in other ways that mean the same: what a reader finds must not change.

Line ends, encodings, white space, other spellings of a number, columns in another order. A reader
may refuse one of them with its line; it must not find other values.
"""

from __future__ import annotations

import contextlib
import random
import re
import tempfile
import warnings
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from input_readers import Reader, sound

from relgloss_view.base.arrays import AnyArray
from relgloss_view.base.errors import InputError
from relgloss_view.measure.table import Measurement

SHUFFLES = 5  #: orders of the columns of a table


def differences(reader: Reader) -> Iterator[tuple[str, str]]:
    """Name and fault of each way to write one of a reader's files; the fault is '' where none is.

    Of a file that the reader refuses nothing is compared.
    """
    with tempfile.TemporaryDirectory() as folder:
        for k, seed in enumerate(reader.seeds()):
            expected = _read(reader, seed, Path(folder))
            if isinstance(expected, str):
                continue
            layouts = list(layouts_of(seed))
            for order in range(SHUFFLES):
                changed = in_other_columns(seed, random.Random(order))
                layouts += [] if changed is None else [(f"order {order} of columns", changed)]
            for name, data in layouts:
                found = _read(reader, data, Path(folder))
                yield f"{reader.name}, file {k}, {name}", _difference(expected, found)


def _read(reader: Reader, data: bytes, folder: Path) -> list[AnyArray] | str:
    """The numbers that a reader finds, or why it refuses."""
    path = folder / f"input{reader.suffix}"
    path.write_bytes(data)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            result = reader.read(path)
        except InputError as error:
            return f"refused: {error}"
    fault = sound(result)
    return f"fault: {fault}" if fault else _numbers(result)


def _numbers(result: object) -> list[AnyArray]:
    """The arrays of a measurement, a colour or a lamp, those without order sorted by direction."""
    found: list[AnyArray] = []
    factor = getattr(result, "radiance_factor", None)
    bands = getattr(result, "bands", None)
    nm = getattr(bands, "wavelengths_nm", None)
    if nm is not None:
        found.append(np.array(nm))
    if isinstance(result, Measurement):
        rows = np.column_stack(
            [result.to_lamp, result.to_receiver, np.nan_to_num(result.radiance_factor, nan=-9.0)]
        )
        found += [rows[np.lexsort(np.round(rows.T, 9))], np.array(result.kept.sum())]
    elif factor is not None:
        found.append(factor)
    for name in ("wavelengths_nm", "power", "values"):
        value = getattr(result, name, None)
        if factor is None and value is not None:
            found.append(np.asarray(value, np.float64))
    return found


def _difference(expected: list[AnyArray], found: list[AnyArray] | str) -> str:
    if isinstance(found, str):
        return found if found.startswith("fault") else ""
    if len(found) != len(expected):
        return "another kind of result"
    for a, b in zip(expected, found, strict=True):
        if np.shape(a) != np.shape(b):
            return f"{np.shape(b)} numbers in place of {np.shape(a)}"
        with contextlib.suppress(ValueError):
            if not np.allclose(a, b, rtol=1e-9, atol=1e-12):
                return f"another value, by {np.max(np.abs(np.subtract(a, b))):.3g}"
    return ""


def layouts_of(data: bytes) -> Iterator[tuple[str, bytes]]:
    """Name and bytes of other ways to write a text; what a reader takes of them must be the same.

    A reader may refuse one; it must not find other values. Nothing where the data is no text.
    """
    encoding = "utf-16" if data[:2] in (b"\xff\xfe", b"\xfe\xff") else "utf-8"
    try:
        text = data.decode(encoding)
    except UnicodeDecodeError:
        return
    if "\0" in text:
        return
    declared = re.compile(r"(<\?xml[^>]*?) encoding=(['\"])[\w-]+\2")
    bare = declared.sub(r"\1", text)
    lines = text.splitlines()
    yield "line ends of DOS", "\r\n".join([*lines, ""]).encode(encoding)
    yield "line ends of old Mac OS", "\r".join([*lines, ""]).encode(encoding)
    yield "no line end at the end", text.rstrip("\r\n").encode(encoding)
    yield "an end of file of DOS", (text + "\x1a").encode(encoding)
    yield "empty lines below", (text + "\n\n\n").encode(encoding)
    yield "a byte order mark", bare.encode("utf-8-sig")
    yield "UTF-16 with a mark", bare.encode("utf-16")
    yield "UTF-16, little end first", bare.encode("utf-16-le")
    yield "UTF-16, big end first", bare.encode("utf-16-be")
    yield "white space behind lines", "\n".join(f"{line}  " for line in lines).encode(encoding)
    yield "tabs behind lines", "\n".join(f"{line}\t" for line in lines).encode(encoding)
    yield "white space before lines", "\n".join(f" {line}" for line in lines).encode(encoding)
    yield "empty lines between", "\n\n".join(lines).encode(encoding)
    yield "capitals", re.sub(r"(?<![\d.])[a-z]\w+", _capitals, text).encode(encoding)
    number = re.compile(r"(?<![\w.,-])(\d+\.\d+)(?![\w.,%])")
    yield "more digits", number.sub(r"\g<1>00", text).encode(encoding)
    yield "signs", number.sub(r"+\1", text).encode(encoding)
    yield "exponents", number.sub(r"\1e0", text).encode(encoding)
    yield "zeros before", number.sub(r"0\1", text).encode(encoding)
    marks = ((";", "semicolon"), ("\t", "tab"), (",", "comma"))
    for mark, name in [pair for pair in marks if pair[0] in text][:1]:
        if text.count(mark) > len(lines):
            spaced = text.replace(mark, f"{mark} ")
            yield f"a space behind each {name}", spaced.encode(encoding)
            yield f"a {name} behind lines", "".join(f"{x}{mark}\n" for x in lines).encode(encoding)


def _capitals(found: re.Match[str]) -> str:
    return found[0].upper()


def in_other_columns(data: bytes, rng: random.Random) -> bytes | None:
    """A table of commas with its columns in another order; None where the data is none."""
    try:
        lines = data.decode().splitlines()
    except UnicodeDecodeError:
        return None
    widths = [line.count(",") for line in lines]
    width = max(widths, default=0)
    table = [k for k, count in enumerate(widths) if count == width]
    text = data.decode()
    if (
        width < 3
        or any(mark in text for mark in '";\t<')
        or table != list(range(table[0], len(lines)))
    ):
        return None
    order = list(range(width + 1))
    rng.shuffle(order)
    for k in table:
        cells = lines[k].split(",")
        lines[k] = ",".join(cells[place] for place in order)
    return "\n".join([*lines, ""]).encode()
