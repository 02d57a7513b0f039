"""Faults put into files: flipped bits, cut and joined parts, odd numbers, keys, nesting, columns.

`mutated` draws faults at random; `bombs` makes by hand what costs a reader most for its size.
"""

from __future__ import annotations

import json
import random
import re
import struct
from collections.abc import Callable, Iterator, Sequence
from typing import Any

from input_formats import VOCABULARY, fault_of

MOST_BYTES = 1_000_000  #: of an input
OWN_FAULTS = 0.35  #: share of faults that know the format

_NUMBER = re.compile(rb"[+-]?\d+\.?\d*(?:[eE][+-]?\d+)?")
_WORD = re.compile(rb"[A-Za-z_]{2,}")
_NUMBERS = (
    b"nan", b"-nan", b"inf", b"-inf", b"1e999", b"-1e999", b"-0", b"-0.0", b"0", b"1", b"-1",
    b"1e-400", b"4e-324", b"1e308", b"1e300", b"1e20", b"-1e20", b"9" * 30, b"9" * 5000, b"0x10",
    b"1_000", b"1,5", b"1.5.2", b"0.1e", b"", b"true", b"null", b'"x"', b"[]", b"{}", b"[1,2]",
    b"180", b"90.0000001", b"89.99", b"1.0D+3", b"1979-05-27", b"07:32:00", b"\xd9\xa1", b"1e",
    b"2147483648", b"9223372036854775808", b"18446744073709551616", b"1/0", b"1/3", b"0/0",
)  # fmt: skip
_TEXTS = (
    b"\x00", b"\x1b[31m", b"\x1b]0;title\x07", b"\r", b"\r\n", b"\n", b"\t", b"\xff", b"\xfe\xff",
    b"\xef\xbb\xbf", b"\xed\xa0\x80", b"\xe2\x80\xae", b"\xe2\x80\xa8", b"\xc2\x85", b"\xc2\xa0",
    b"\xf0\x9f\x98\x80", b"'", b'"', b'"""', b"'''", b"\\", b"\\u0000", b"\\ud800", b"\\U00110000",
    b"#", b"=", b"[", b"]", b"{", b"}", b"[[", b"]]", b",", b";", b".", b"..", b"a.a.a.a.a.a.a.a.",
    b":", b"%", b"$", b"$\\frac{1}{$", b"../../x", b"/dev/null", b"=cmd|' /C calc'!A0", b"\x1a",
    b"\x7f", b"\xc2\x9b31m", b"%s%n", b"<script>", b"-- ", b"a" * 300, b" " * 300, b"," * 300,
    b"[" * 300, b"{" * 300, b"(" * 300, b"nan", b"Infinity", b"null", b"__proto__",
)  # fmt: skip
_WHOLE = (0, 1, 2, 0x7F, 0x80, 0xFF, 0x7FFF, 0xFFFF, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF)


def mutated(seeds: Sequence[bytes], rng: random.Random, name: str = "") -> bytes:
    """One of the files with one to four faults, at most MOST_BYTES long.

    name: of a reader, whose own faults are a third of all.
    """
    data = rng.choice(seeds)
    other = rng.choice(seeds)
    for _ in range(rng.choice((1, 1, 1, 2, 2, 3, 4))):
        if name in VOCABULARY and rng.random() < OWN_FAULTS:
            data = fault_of(name, data, rng)[:MOST_BYTES]
        else:
            data = rng.choice(_FAULTS)(data, other, rng)[:MOST_BYTES]
    return data


def _place(data: bytes, rng: random.Random) -> int:
    """A place in the data; its beginning, where formats are recognised, more often."""
    length = len(data)
    return rng.randrange(min(length, 200) + 1) if rng.random() < 0.3 else rng.randrange(length + 1)


def _flip(data: bytes, other: bytes, rng: random.Random) -> bytes:
    changed = bytearray(data)
    for _ in range(rng.choice((1, 1, 2, 8, 50))):
        if changed:
            changed[min(_place(data, rng), len(changed) - 1)] ^= 1 << rng.randrange(8)
    return bytes(changed)


def _byte(data: bytes, other: bytes, rng: random.Random) -> bytes:
    changed = bytearray(data)
    for _ in range(rng.choice((1, 2, 5))):
        if changed:
            at = min(_place(data, rng), len(changed) - 1)
            changed[at] = rng.choice((0, 255, 10, 13, 32, 44, 34, 46, rng.randrange(256)))
    return bytes(changed)


def _run(data: bytes, other: bytes, rng: random.Random) -> bytes:
    at = _place(data, rng)
    run = bytes((rng.randrange(256),)) * rng.choice((1, 10, 100, 1000, 20_000))
    return data[:at] + run + data[at + (len(run) if rng.random() < 0.5 else 0) :]


def _cut(data: bytes, other: bytes, rng: random.Random) -> bytes:
    return data[: _place(data, rng)]


def _without(data: bytes, other: bytes, rng: random.Random) -> bytes:
    at = _place(data, rng)
    return data[:at] + data[at + rng.choice((1, 2, 4, 16, 200, 3000)) :]


def _again(data: bytes, other: bytes, rng: random.Random) -> bytes:
    at, end = sorted((_place(data, rng), _place(data, rng)))
    part = data[at : min(end, at + 5000)]
    return data[:at] + part * rng.choice((2, 2, 3, 20)) + data[at + len(part) :]


def _swap(data: bytes, other: bytes, rng: random.Random) -> bytes:
    at, from_ = _place(data, rng), _place(other, rng)
    part = other[from_ : from_ + rng.choice((4, 40, 400, 10**6))]
    return data[:at] + part + data[at + (len(part) if rng.random() < 0.5 else 0) :]


def _token(data: bytes, other: bytes, rng: random.Random) -> bytes:
    at = _place(data, rng)
    return data[:at] + rng.choice(_TEXTS) * rng.choice((1, 1, 1, 2, 30)) + data[at:]


def _replace(pattern: re.Pattern[bytes], by: Callable[[random.Random, bytes], bytes]) -> _Fault:
    def fault(data: bytes, other: bytes, rng: random.Random) -> bytes:
        found = list(pattern.finditer(data[:50_000]))
        if not found:
            return data
        for match in sorted(rng.sample(found, min(len(found), rng.choice((1, 1, 3)))), key=_end):
            new = by(rng, match[0])
            data = data[: match.start()] + new + data[match.end() :]
            if len(new) != len(match[0]):
                break
        return data

    return fault


def _end(match: re.Match[bytes]) -> int:
    return -match.end()


def _number(rng: random.Random, old: bytes) -> bytes:
    if rng.random() < 0.2:
        return old + rng.choice((b"0", b"e5", b".", b"-", b" %", b"nm"))
    return rng.choice(_NUMBERS)


def _word(rng: random.Random, old: bytes) -> bytes:
    choices = (
        old[::-1],
        old.upper(),
        old + old,
        b"",
        b"x" * 5000,
        b'"' + old + b'"',
        b"".join((old, b".", old)),
        b"name",
        b"look",
        b"=1+1",
        old[:1] + b"\xc3\xa9",
        b"\x1b[2J" + old,
    )
    return rng.choice(choices)


def _lines(data: bytes, other: bytes, rng: random.Random) -> bytes:
    lines = data.split(b"\n")
    k, j = rng.randrange(len(lines)), rng.randrange(len(lines))
    kind = rng.randrange(6)
    if kind == 0:
        lines[k], lines[j] = lines[j], lines[k]
    elif kind == 1:
        lines.insert(k, lines[j])
    elif kind == 2:
        del lines[k]
    elif kind == 3:
        lines[k:k] = [lines[j]] * 500
    elif kind == 4:
        lines[k] += rng.choice((b",1", b",", b";", b"\t", b',"', b" # x", b"=", b"," * 400))
    else:
        lines = [line[: rng.randrange(len(line) + 1)] for line in lines[:1000]]
    return b"\n".join(lines)


def _columns(data: bytes, other: bytes, rng: random.Random) -> bytes:
    mark = rng.choice((b",", b";", b"\t"))
    new = rng.choice((b";", b"\t", b",", b" ", b",,", b'","', b"|", b""))
    return data.replace(mark, new, rng.choice((1, 5, -1)))


def _encoding(data: bytes, other: bytes, rng: random.Random) -> bytes:
    text = data.decode("utf-8", "replace")
    kinds = ("utf-16", "utf-16-le", "utf-16-be", "utf-32", "utf-8-sig", "cp1252", "utf-7")
    return text.encode(rng.choice(kinds), "replace")


def _json(data: bytes, other: bytes, rng: random.Random) -> bytes:
    """A value inside a JSON text replaced by another of any kind."""
    try:
        content = json.loads(data)
    except (ValueError, RecursionError):
        return _flip(data, other, rng)
    values: tuple[Any, ...] = (
        None,
        True,
        -1,
        0,
        1e308,
        float("nan"),
        float("inf"),
        "",
        "\ud800",
        "x" * 5000,
        [],
        {},
        [[]],
        {"": {}},
        [0.5] * 3000,
        10**400,
        -0.0,
        "\x1b[31m",
        [None],
        {"a": [1]},
    )
    at = content
    while isinstance(at, dict | list) and at:
        key = rng.choice(list(at)) if isinstance(at, dict) else rng.randrange(len(at))
        inner = at[key]  # type: ignore[index, unused-ignore]
        if not isinstance(inner, dict | list) or not inner or rng.random() < 0.4:
            kind = rng.random()
            if kind < 0.7:
                at[key] = rng.choice(values)  # type: ignore[index, unused-ignore]
            elif kind < 0.85 or isinstance(at, list):
                del at[key]  # type: ignore[arg-type, unused-ignore]
            else:
                at[rng.choice(("", "name", "x" * 300, "\ud800", str(key) + "2"))] = at.pop(key)
            break
        at = inner
    return json.dumps(content).encode("utf-8", "surrogatepass")


def _binary(data: bytes, other: bytes, rng: random.Random) -> bytes:
    """An aligned number of a binary format replaced by one that is at an end of its range."""
    kind = rng.choice(("<I", ">I", "<H", ">H", "<Q", ">Q", "<f", "<d"))
    size = struct.calcsize(kind)
    at = min(_place(data, rng) // rng.choice((1, 2, 4)) * 2, max(len(data) - size, 0))
    if kind[1] in "fd":
        value: float = rng.choice((float("nan"), float("inf"), -1.0, 1e30, 0.0, -0.0))
    else:
        value = rng.choice(_WHOLE) & ((1 << 8 * size) - 1)
    return data[:at] + struct.pack(kind, value) + data[at + size :]


_Fault = Callable[[bytes, bytes, random.Random], bytes]
_FAULTS: tuple[_Fault, ...] = (
    _flip, _byte, _run, _cut, _without, _again, _swap, _token, _token, _lines, _columns, _encoding,
    _json, _json, _binary, _binary, _replace(_NUMBER, _number), _replace(_NUMBER, _number),
    _replace(_WORD, _word), _replace(_WORD, _word),
)  # fmt: skip


def bombs(size: int = MOST_BYTES) -> Iterator[tuple[str, bytes]]:
    """Name and bytes of inputs of at most `size` bytes, each of one kind of work."""
    for name, unit in _REPEATED.items():
        yield f"{name}, repeated", _filled(b"", unit, b"", size)
    for name, (head, unit, tail) in _FRAMED.items():
        yield name, _filled(head, unit, tail, size)
    yield "keys, each another", _counted(b"k%d=1\n", size)
    yield "headers, each another", _counted(b"[k%d]\n", size)
    yield "headers of eight parts", _counted(b"[a.b.c.d.e.f.g.h%d]\n", size)
    yield "keys of eight parts", _counted(b"a.b.c.d.e.f.g.h%d=1\n", size)
    yield "keys of an inline table", b"x={" + _counted(b"k%d=1,", size - 10) + b"k=1}"
    yield "keys below a deep header", b"[a.b.c.d.e.f.g]\n" + _counted(b"k%d=1\n", size - 30)
    yield "JSON keys, each another", b"{" + _counted(b'"k%d":1,', size - 10) + b'"k":1}'
    yield "lamp of many rows", b"nm,power\n" + _counted(b"%d,1\n", size - 20)
    nm = b"".join(b"%.4f,1\n" % (300 + k * 0.0066) for k in range(size // 11))
    yield "lamp of fine steps", b"nm,power\n" + nm
    angles = b"alpha_deg,beta_deg,gamma_deg,"
    yield "many bands", _wide(angles, b"%.2f,", 200, 0.07, 9900, b"%d,0,0," + b"1," * 9900, size)
    yield "bands beyond the cap", angles + _counted(b"%d,", size - 40)
    rows = b"# quantity: brdf\nalpha_deg,beta_deg,gamma_deg,400,500\n"
    yield "many short rows", _filled(rows, b"1,2,3,4,5\n", b"", size)
    yield "many rows, each another", rows + _counted(b"-9,2,%d,.1,.2\n", size - 80, 90)
    yield "rows of n/a", _filled(rows + b"1,2,3,1,1\n", b"1,2,3,na,na\n", b"", size)
    yield "comments among rows", _filled(rows, b"1,2,3,4,5\n# quantity: brdf\n", b"", size)
    yield "empty rows", _filled(rows + b"1,2,3,1,1\n", b",,,,\n", b"", size)
    yield "rows of averages", _filled(rows + b"1,2,3,1,1\n", b"mean,,,1,2\n", b"", size)
    again = rows.split(b"\n")[1] + b"\n"
    yield "the header again", _filled(rows + b"1,2,3,1,1\n", again, b"", size)
    yield "titles", _filled(b"", b"quantity of light: brdf and more words\n", b"", size)
    generic = b"theta_i_deg;phi_i_deg;theta_r_deg;phi_r_deg;R;G;B\n"
    yield "decimal commas", _filled(generic, b"1,5;0;2,5;0;0,1;0,2;0,3\n", b"", size)
    for name, number in (("digits", b"1"), ("zeros", b"0"), ("signs", b"-"), ("spaces", b" ")):
        yield f"a cell of {name}", rows + b"1,2,3," + number * (size - 80) + b",1\n"
        yield f"a heading of {name}", angles + b"400" + number * (size - 80) + b"\n1,2,3,4\n"
        yield f"a declaration of {name}", b"# quantity: " + number * (size - 80) + b"x\n" + rows
    yield "a TOML number of digits", b"[look]\nseed = " + b"7" * (size - 30) + b"\n"
    yield "a TOML number of hexadecimal digits", b"[look]\nseed = 0x" + b"f" * (size - 30) + b"\n"
    yield "a TOML fraction of digits", b"[look]\nsigma_n_deg = 0." + b"7" * (size - 40) + b"\n"
    yield "a JSON number of digits", b'{"format": "relgloss-material", "x": ' + b"7" * (size - 60)
    spaces = b"[" + b" " * (size - 200)
    yield "a name of a bracket and spaces", _MATERIAL.replace(b"NAME", spaces)
    yield "bands of a material", _MATERIAL.replace(b"[1, 1, 1]", b"[" + b"1," * (size // 3) + b"1]")


def _filled(head: bytes, unit: bytes, tail: bytes, size: int) -> bytes:
    return head + unit * ((size - len(head) - len(tail)) // max(len(unit), 1)) + tail


def _counted(form: bytes, size: int, wrap: int = 10**9) -> bytes:
    parts: list[bytes] = []
    length = k = 0
    while True:
        part = form % (k % wrap)
        length += len(part)
        if length > size:
            return b"".join(parts)
        parts.append(part)
        k += 1


def _wide(
    head: bytes, form: bytes, low: float, step: float, count: int, row: bytes, size: int
) -> bytes:
    text = b"# quantity: brdf\n" + head + b"".join(form % (low + step * k) for k in range(count))
    text = text[:-1] + b"\n"
    k = 0
    while len(text) + len(row) < size:
        text += row[:-1] % k + b"\n"
        k += 1
    return text


_MATERIAL = (
    b'{"format": "relgloss-material", "version": 1, "name": "NAME", "source": "made", "basis": '
    b'"rgb", "diffuse": {"model": "lambert", "albedo": [1, 1, 1]}, "specular": []}'
)
_REPEATED = {
    "zero byte": b"\0", "space": b" ", "line end": b"\n", "carriage return": b"\r", "comma": b",",
    "semicolon": b";", "tab": b"\t", "quote": b'"', "apostrophe": b"'", "digit": b"1",
    "letter": b"a", "bracket": b"[", "brace": b"{", "closing bracket": b"]", "dot": b".",
    "hash": b"#", "equals": b"=", "backslash": b"\\", "minus": b"-", "0xff": b"\xff",
    "letter and dot": b"a.", "letter, dot and space": b"a . ", "quoted part": b'"a".',
    "bracket pair": b"[]", "pair and comma": b"[],", "brace and key": b"{a=", "JSON key": b'{"a":',
    "digit and comma": b"1,", "quote and comma": b'",', "hash and line end": b"#\n",
    "letter and line end": b"a\n", "comma and line end": b",\n", "quoted cell": b'"a",',
    "cell and two spaces": b"a  ", "accented letter": "é".encode(), "emoji": "😀".encode(),
    "Latin-1 letter": b"abcdefgh\xe9", "wide letter": "a".encode("utf-16-le"),
    "wide comma": ",".encode("utf-16-le"), "less than": b"<", "tag": b"<a ", "percent": b"%",
    "assignment": b"a=1\n", "header": b"[a]\n", "header of an array": b"[[a]]\n",
    "triple quotes": b'"""\n', "number line": b"500,1\n", "date": b"1979-05-27\n",
    "escaped quote": b'\\"', "unicode escape": b"\\u0041", "sep": b"sep=,\n",
}  # fmt: skip
_FRAMED = {
    "TOML key of many parts": (b"[look]\n", b"a.", b"a=1\n"),
    "TOML key of parts and spaces": (b"[look]\n", b"a . ", b"a=1\n"),
    "TOML key of quoted parts": (b"[look]\n", b"'a'.\"b\".", b"a=1\n"),
    "TOML key of parts with quotes": (b"[look]\n", b'"\\"".', b"a=1\n"),
    "TOML key of empty parts": (b"[look]\n", b"''.", b"a=1\n"),
    "TOML header of many parts": (b"[", b"a.", b"a]\n"),
    "TOML header of an array, many parts": (b"[[", b"a.", b"a]]\n"),
    "TOML key in an inline table": (b"x = {y = 1, ", b"a.", b"a=1}\n"),
    "TOML key in an array's table": (b"x = [1, {", b"a.", b"a=1}]\n"),
    "TOML keys of many parts": (b"", b"a.b.c.d.e.f.g.h.i.j.k.l.m.n.o.p=1\n", b""),
    "TOML key after a string with a quote": (b"x = '\"'\n", b"a.", b"a=1\n"),
    "TOML key after a comment": (b"# \"\"\"\n", b"a.", b"a=1\n"),
    "TOML key after a long string": (b'x = """a\\"""" \n"""\n', b"a.", b"a=1\n"),
    "TOML nested arrays": (b"x = ", b"[", b""),
    "TOML nested inline tables": (b"x = ", b"{a=", b""),
    "TOML array": (b"x = [", b"1,", b"]\n"),
    "TOML array of arrays": (b"x = [", b"[],", b"]\n"),
    "TOML array of tables": (b"x = [", b"{},", b"]\n"),
    "TOML array of tables with keys": (b"x = [", b"{a=1},", b"]\n"),
    "TOML string of escapes": (b'x = "', b"\\n", b'"\n'),
    "TOML string": (b'x = "', b"a", b'"\n'),
    "TOML array of strings": (b"x = [", b"'',", b"]\n"),
    "TOML array of dates": (b"x = [", b"1979-05-27T07:32:00Z,", b"]\n"),
    "TOML array with line ends": (b"x = [", b"\n", b"]\n"),
    "TOML array with comments": (b"x = [", b"#\n", b"]\n"),
    "JSON nested arrays": (b'{"format": "relgloss-material", "x": ', b"[", b""),
    "JSON nested objects": (b'{"format": "relgloss-material", "x": ', b'{"a":', b""),
    "JSON array": (b'{"format": "relgloss-material", "x": [', b"1,", b"1]}"),
    "JSON array of arrays": (b'{"format": "relgloss-material", "x": [', b"[],", b"1]}"),
    "JSON array of objects": (b'{"format": "relgloss-material", "x": [', b'{"":0},', b"1]}"),
    "JSON key twice": (b'{"format": "relgloss-material", ', b'"x":1,', b'"x":1}'),
    "JSON string": (b'{"format": "relgloss-material", "name": "', b"a", b'"}'),
    "JSON string of surrogates": (b'{"format": "relgloss-material", "name": "', b"\\ud800", b'"}'),
    "CSV cells in quotes": (b"alpha_deg,beta_deg,gamma_deg,400,500\n", b'"1",', b"\n"),
    "CSV quote unclosed": (b'alpha_deg,beta_deg,gamma_deg,400,500\n1,2,3,"', b"1,", b"\n"),
    "CSV blank lines, then a header": (b"", b"\n", b"alpha_deg,beta_deg,gamma_deg,400,500\n"),
    "CSV comments, then a header": (b"", b"# a: b\n", b"alpha_deg,beta_deg,gamma_deg,400,500\n"),
    "CSV comments of other keys": (b"", b"#a:\n", b"alpha_deg,beta_deg,gamma_deg,400,500\n"),
    "CSV row of commas": (b"alpha_deg,beta_deg,gamma_deg,400,500\n1,2,3,4,5\n", b",", b"\n"),
    "CSV header of commas": (b"alpha_deg,beta_deg,gamma_deg,400,500", b",", b"\n1,2,3,4,5\n"),
    "lamp row of commas": (b"400,1\n500,1\n", b",", b"\n"),
    "lamp words": (b"400,1\n500,1\n600,1\n700,1\n", b"word\n", b""),
}  # fmt: skip
