"""Parameters: dataclass fields that declare their range, unit and meaning once.

Files, options and controls of the window all take their limits from these declarations.
"""

from __future__ import annotations

import dataclasses
import numbers
from dataclasses import dataclass, field
from typing import Any, ClassVar

from relgloss_view.base.reading import number, refuse


@dataclass(frozen=True)
class Range:
    """The values that a parameter may take, and its meaning."""

    low: float
    high: float
    unit: str
    meaning: str


def parameter(
    default: float | None,
    low: float,
    high: float,
    unit: str,
    meaning: str,
    *,
    option: str | None = None,
    label: str = "",
    later: bool = False,
) -> Any:
    """A dataclass field for a number of a declared range, `low` to `high` in `unit`.

    Where the default is None, the entry may be left out. `option` is its flag on the command line,
    `label` its name in the window: a plain word, and the symbol behind it. later: files were
    written before there was such a field; at its default it is not written.
    """
    limits = Range(low, high, unit, meaning)
    return _ranged(default, limits, option, label, optional=default is None, later=later)


def whole_number(
    default: int,
    low: int,
    high: int,
    unit: str,
    meaning: str,
    *,
    optional: bool = False,
    option: str | None = None,
    label: str = "",
) -> Any:
    """A dataclass field that takes whole numbers of a declared range; None too, if optional."""
    limits = Range(low, high, unit, meaning)
    return _ranged(default, limits, option, label, whole=True, optional=optional)


def _ranged(
    default: float | None, limits: Range, option: str | None, label: str, **flags: bool
) -> Any:
    metadata = {"range": limits, "option": option, "label": label, **flags}
    return field(default=default, metadata=metadata)


def choice(
    default: str,
    options: tuple[str, ...],
    meaning: str,
    *,
    option: str | None = None,
    label: str = "",
    later: bool = False,
) -> Any:
    """A dataclass field that takes one of a few names.

    later: files were written before there was such a field; at its default it is not written.
    """
    metadata = {"options": options, "meaning": meaning, "option": option, "label": label}
    return field(default=default, metadata=metadata | {"later": later})


def file_name(default: str, meaning: str, *, option: str | None = None, label: str = "") -> Any:
    """A dataclass field for the name of a file; "" is none, and is not written to files.

    Readers look for the file beside the file that names it.
    """
    metadata = {"file": True, "meaning": meaning, "option": option, "label": label, "later": True}
    return field(default=default, metadata=metadata)


def switch(default: bool, meaning: str, *, label: str = "") -> Any:
    """A dataclass field that is on or off."""
    metadata = {"switch": True, "meaning": meaning, "label": label}
    return field(default=default, metadata=metadata)


class Checked:
    """Checks every declared range when a value is made.

    TABLE: the name of the values' table in files and messages; "" where it is the class's own.
    """

    TABLE: ClassVar[str] = ""

    def __post_init__(self) -> None:
        for f in dataclasses.fields(self):  # type: ignore[arg-type]
            value = getattr(self, f.name)
            place = f"{self.TABLE or type(self).__name__.lower()}.{f.name}"
            allowed = f.metadata.get("range")
            if allowed is not None and not (value is None and f.metadata.get("optional", False)):
                _check_range(place, value, allowed, whole=f.metadata.get("whole", False))
            options = f.metadata.get("options")
            if options is not None and value not in options:
                refuse(place, f"one of {', '.join(options)}", value)
            if f.metadata.get("file") and not isinstance(value, str):
                refuse(place, "the name of a file", value)
            if f.metadata.get("switch") and not isinstance(value, bool):
                refuse(place, "true or false", value)


def _check_range(place: str, value: object, allowed: Range, *, whole: bool) -> None:
    unit = f" {allowed.unit}" if allowed.unit else ""
    expected = f"{allowed.low:.10g} to {allowed.high:.10g}{unit}"
    if whole and not isinstance(value, numbers.Integral):
        refuse(place, f"a whole number, {expected}", value)
    number(value, place, expected, allowed.low, allowed.high)
