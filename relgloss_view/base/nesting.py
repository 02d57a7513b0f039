"""How much work a TOML or JSON text asks for, counted in one pass before a decoder begins.

A short text can ask for much: tomllib takes time with the cube of the parts of a dotted key (7 s
and 2.4 GB for 40 kB of `a.a.a = 1`), every table and key takes about a kilobyte, and brackets
within brackets exhaust the stack. What is counted here never exceeds what the text holds: a text
within the caps is left to the decoder, whatever it is.

Sources of the grammars: TOML 1.0.0 (toml.io), RFC 8259 (JSON).
"""

from __future__ import annotations

import re

from relgloss_view.base.errors import InputError

MOST_PARTS = 8  #: of a dotted key; no file of this program has more than 3
MOST_PARTS_IN_ALL = 60_000  #: of all keys and headers
MOST_TABLES = 5_000  #: headers; 500 presets have as many
MOST_VALUES = 100_000  #: entries of lists and inline tables
MOST_DEPTH = 32  #: of brackets in brackets
MOST_DIGITS = 1_000  #: of a number
MOST_JSON_VALUES = 500_000

_DIGITS = "0123456789+-"
_TOML = re.compile(r"\"\"\"|'''|[\"'#\[\]{},=.\n]|[^\s\"'#\[\]{},=.]+")
_TRIPLE = re.compile(r'"""|\\')
_SINGLE = re.compile(r'["\\\n]')
_JSON = re.compile(r'["\[\]{}]')
_JSON_STRING = re.compile(r'["\\]')


def check_toml(text: str) -> None:
    """InputError, which names the line, where a TOML text asks for more work than any file here.

    Text that is no TOML passes: the decoder stops where the grammar ends, and so does the count.

    >>> check_toml("x = [1.5, {a.b = 'a.b.c.d.e.f.g.h.i.j'}]  # " + "a." * 50)
    >>> check_toml("[look]\\n" + "a . 'b'." * 50 + "c = 1")
    Traceback (most recent call last):
    ...
    relgloss_view.base.errors.InputError: line 2: a key of more than 8 parts
    """
    position = depth = parts = parts_in_all = tables = values = 0
    after_dot, line_begins = False, True
    while (found := _TOML.search(text, position)) is not None:
        token, position = found[0], found.end()
        first = token[0]
        if first not in "\"'#[]{},=.\n" or (first in "\"'" and len(token) == 1):
            # A part of a key, a number or a string of one line.
            if first in "\"'":
                position = _end_of_string(text, position, first)
                if position < 0:
                    return  # the string does not end
            elif len(token) > MOST_DIGITS and first in _DIGITS:
                raise _fault(text, position, f"a number has too many digits, beyond {MOST_DIGITS}")
            parts = parts + 1 if after_dot else 1
            if parts > MOST_PARTS:
                raise _fault(text, position, f"a key of more than {MOST_PARTS} parts")
            after_dot = line_begins = False
            continue
        if first == ".":
            after_dot = True
            continue
        if first == "#":
            position = text.find("\n", position)
            if position < 0:
                return
        elif first == "\n":
            line_begins = True
        elif first in "[{":
            depth += 1
            tables += line_begins and depth == 1
            if depth > MOST_DEPTH:
                raise _fault(text, position, "lists or tables are nested too deeply")
            if tables > MOST_TABLES:
                raise _fault(text, position, f"more than {MOST_TABLES} tables")
        elif first in "]}":
            depth -= 1
            parts_in_all += parts
            if depth < 0:
                return
        elif first == ",":
            values += 1
            if values > MOST_VALUES:
                raise _fault(text, position, f"more than {MOST_VALUES} entries in lists")
        elif first == "=":
            parts_in_all += parts
        else:  # three quotes
            position = _end_of_text(text, position, token)
            if position < 0:
                return
        if parts_in_all > MOST_PARTS_IN_ALL:
            raise _fault(text, position, f"more than {MOST_PARTS_IN_ALL} parts of keys")
        parts, after_dot = 0, False
        line_begins = first == "\n" or (line_begins and first == "[")


def check_json(text: str, most_values: int = MOST_JSON_VALUES) -> None:
    """InputError, which names the line, where a JSON text is nested deeply or has too many values.

    >>> check_json('{"a": [1, "[[[["]}')
    >>> check_json("[" * 100)
    Traceback (most recent call last):
    ...
    relgloss_view.base.errors.InputError: line 1: lists or objects are nested too deeply
    """
    position = depth = values = 0
    while (found := _JSON.search(text, position)) is not None:
        values += text.count(",", position, found.start())
        if values > most_values:
            raise _fault(text, position, f"more than {most_values} values")
        position = found.end()
        if found[0] == '"':
            while (mark := _JSON_STRING.search(text, position)) is not None:
                position = mark.end() + (mark[0] == "\\")
                if mark[0] == '"':
                    break
            else:
                return
        else:
            depth += 1 if found[0] in "[{" else -1
            if depth > MOST_DEPTH:
                raise _fault(text, position, "lists or objects are nested too deeply")
            if depth < 0:
                return


def _end_of_string(text: str, position: int, quote: str) -> int:
    """Where a string of one line ends, behind its quote; -1 where it does not."""
    if quote == "'":
        end = text.find("'", position)
        return -1 if end < 0 or text.find("\n", position, end) >= 0 else end + 1
    while (mark := _SINGLE.search(text, position)) is not None:
        if mark[0] == "\n":
            return -1
        if mark[0] == '"':
            return mark.end()
        position = mark.end() + 1
    return -1


def _end_of_text(text: str, position: int, quotes: str) -> int:
    """Where a string of several lines ends, behind its quotes; -1 where it does not.

    Up to two quotes right before the three belong to the string.
    """
    if quotes == "'''":
        end = text.find(quotes, position)
        if end < 0:
            return -1
        position = end + 3
    else:
        while (mark := _TRIPLE.search(text, position)) is not None:
            position = mark.end() + (mark[0] == "\\")
            if mark[0] == quotes:
                break
        else:
            return -1
    for _ in range(2):
        if text.startswith(quotes[0], position):
            position += 1
    return position


def _fault(text: str, position: int, what: str) -> InputError:
    return InputError(f"line {text.count(chr(10), 0, position) + 1}: {what}")
