"""One cell of a table: a number, nothing, or a text with the step that mends it."""

from __future__ import annotations

import re

from relgloss_view.base.errors import InputError
from relgloss_view.base.two_columns import says_nothing

NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", re.ASCII)
_COMMA_NUMBER = re.compile(r"[+-]?(\d+,?\d*|,\d+)([eE][+-]?\d+)?", re.ASCII)
_FORTRAN = re.compile(r"[+-]?(\d+[.,]?\d*|[.,]\d+)[dD][+-]?\d+", re.ASCII)
#: Signs that typesetters and spreadsheets put for a minus before a digit.
_MINUS = re.compile(r"^[\u2010-\u2014\u2212\ufe58\ufe63\uff0d](?=[\d.,])")
#: Marks without a shape: of byte order, where files were joined, and of writing direction.
_UNSEEN = "\ufeff\u200b\u200e\u200f"
#: A cell that a spreadsheet keeps as text: '0.5 or ="0.5".
_AS_TEXT = re.compile(r"""['\u2019](?=[\d+.,\u2010-\u2014\u2212-])(.*)|="+([^"=]*)"*""")
_THOUSANDS = re.compile(r"[+-]?\d{1,3}([ ,.'’\u00a0\u202f]\d{3})+([.,]\d+)?", re.ASCII)
_WITH_UNIT = re.compile(
    r"([+-]?(\d+[.,]?\d*|[.,]\d+)([eE][+-]?\d+)?)\s*([^\W\d_].*|[^\x00-\x7f].*|\[.*|1\s*/\s*sr)|.*\d\s*°.*"
)
#: Months begin so in English and its neighbours: 'Mar', 'März', 'Okt', 'déc'.
_MONTH = (
    r"(jan|feb|f[ée]v|mar|mär|mrz|apr|avr|ma[iy]|ju[nli]|jul|aug|ao[uû]|sep|o[ck]t|nov|d[eé][cz])"
)
_DATE = re.compile(
    rf"\d{{1,4}}[./ -]+({_MONTH}\w{{0,6}}[./ -]*(\d{{2,4}})?|\d{{1,2}}[./-]\d{{1,4}})"
    rf"|{_MONTH}\w{{0,6}}[./ -]+\d{{2,4}}",
    re.IGNORECASE,
)
#: No number is as long, and expressions that try every way to split digits stay quick.
LONGEST = 400
#: No reading comes near: a mirror-like lobe of 0.1 degrees at grazing incidence reaches 1e5.
MAX_MAGNITUDE = 1e12

PERCENT = "radiance-factor-percent"
__all__ = ["PERCENT", "is_number", "number", "says_nothing"]


def number(cell: str, decimal_comma: bool = False) -> float | None:
    """The number in a cell; None where it says nothing. Raises InputError: the remedy alone.

    decimal_comma: the numbers of the table have decimal commas.

    >>> number(" 0.5 "), number("0,5", decimal_comma=True), number("n/a"), number("1.0D-03")
    (0.5, 0.5, None, 0.001)
    >>> number("1,234.5")
    Traceback (most recent call last):
    ...
    relgloss_view.base.errors.InputError: write the number without thousands separators
    """
    text = _plain(cell)
    if len(text) > LONGEST:
        raise InputError("write a number with a decimal point, or leave the field empty")
    if NUMBER.fullmatch(text):
        return float(text)
    if says_nothing(text):
        return None
    if decimal_comma and _COMMA_NUMBER.fullmatch(text):
        return float(text.replace(",", "."))
    if _FORTRAN.fullmatch(text) and (decimal_comma or "," not in text):
        return float(text.lower().replace("d", "e").replace(",", "."))
    raise InputError(_remedy(text))


def reading(cell: str, decimal_comma: bool = False) -> float:
    """The number in a cell, NaN where it says nothing. Raises InputError: the remedy alone.

    >>> reading("1e999")
    Traceback (most recent call last):
    ...
    relgloss_view.base.errors.InputError: it is beyond any reading; correct it or leave it empty
    """
    value = number(cell, decimal_comma)
    if value is None:
        return float("nan")
    if not abs(value) <= MAX_MAGNITUDE:
        raise InputError("it is beyond any reading; correct it or leave it empty")
    return value


def is_number(cell: str) -> bool:
    """Whether a cell holds a number with decimal point or comma."""
    text = _plain(cell)
    if len(text) > LONGEST:
        return False
    return bool(NUMBER.fullmatch(text) or _COMMA_NUMBER.fullmatch(text))


def _plain(cell: str) -> str:
    """A cell with an ASCII minus, without what a spreadsheet marks a text with."""
    text = cell.strip().strip(_UNSEEN)
    if text.isascii() and text[:1] not in ("'", "="):
        return text
    if len(text) <= LONGEST:
        marked = _AS_TEXT.fullmatch(text)
        if marked:
            text = (marked[1] if marked[1] is not None else marked[2]).strip()
    return _MINUS.sub("-", text)


def _remedy(text: str) -> str:
    low = text.lower().lstrip("+-")
    if low in ("inf", "infinity", "1.#inf", "overflow", "over", "ovf"):
        return "leave the field empty where nothing was read"
    if _COMMA_NUMBER.fullmatch(text) and not re.fullmatch(r"[+-]?[1-9]\d{0,2},\d{3}", text):
        return "write a number with a decimal point, as the other numbers have"
    if _THOUSANDS.fullmatch(text):
        return "write the number without thousands separators"
    if re.fullmatch(r"#+", text):
        return "widen the column in the spreadsheet, so that it saves numbers"
    if text.startswith("="):
        return "save the values of the spreadsheet and not its formulas"
    if text.endswith("%"):
        return f"write the number without %, and '# quantity: {PERCENT}' on top"
    if _DATE.fullmatch(text):
        return "a spreadsheet has made a date of a number; format the cells as numbers"
    if "0x" not in low and _WITH_UNIT.fullmatch(text):
        return "write a number without its unit"
    return "write a number with a decimal point, or leave the field empty"
