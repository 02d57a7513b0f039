"""Declarations of a text table or of the caller: quantity, unit, gamma_s, apertures, saturation."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.measure import quantity as quantities
from relgloss_view.measure.gonio import GAMMA_S_DEG
from relgloss_view.measure.readers.csv_table import TextTable
from relgloss_view.measure.readers.headings import (
    DEGREES,
    RADIANS,
    angle_heading,
    unit_of,
    value_quantity,
)
from relgloss_view.measure.readers.options import ReadOptions

MAX_APERTURE_SD_DEG = 45.0
#: Where the mirror direction lies: beta = -alpha or opposite azimuths, or on the lamp's side.
OPPOSITE, SAME_SIDE = "opposite", "same-side"
MIRRORS = (SAME_SIDE, OPPOSITE)
#: Percent of a perfect diffuser that some reading of any sample exceeds.
LEAST_PERCENT = 2.0
MAX_TEXT = 2000  #: characters of a name or a source


@dataclass(frozen=True)
class Declared:
    """The facts about a table that are not in its numbers."""

    name: str
    source: str
    quantity: str
    quantity_insisted: bool = False  #: True where the caller gave it, whatever the file declares
    angle_unit: str | None = None  #: RADIANS or DEGREES; None where nobody declares it
    gamma_s_deg: float = GAMMA_S_DEG
    gamma_s_declared: bool = False  #: False where gamma_s_deg is the default
    aperture_sd_deg: tuple[float, float] = (0.0, 0.0)
    saturation: float | None = None
    warnings: tuple[str, ...] = ()

    @classmethod
    def of_brdf(
        cls,
        name: str,
        source: str,
        options: ReadOptions,
        notes: Sequence[str],
        aperture_sd_deg: tuple[float, float] = (0.0, 0.0),
    ) -> Declared:
        """The facts of a format of BRDFs in 1/sr, which the caller may call another quantity.

        Raises InputError for a word that is no quantity.
        """
        return cls(
            name=name,
            source=source,
            quantity=options.quantity_or(quantities.BRDF),
            quantity_insisted=options.quantity is not None,
            aperture_sd_deg=aperture_sd_deg,
            warnings=tuple(notes),
        )


def declared(table: TextTable, options: ReadOptions) -> Declared:
    """The facts from the file's comments; an option of the caller replaces the comment.

    Raises InputError where neither declares the quantity or a value is out of its range.
    """
    warnings = list(table.notes)
    chosen = _quantity(table, options.quantity, warnings)
    gamma_s, is_declared = _gamma_s(table, options.gamma_s_deg, warnings)

    aperture = (0.0, 0.0)
    if "aperture_sd_deg" in table.comments:
        lamp, *rest = _numbers(table, "aperture_sd_deg", (1, 2), 0.0, MAX_APERTURE_SD_DEG)
        aperture = (lamp, rest[0] if rest else lamp)

    saturation = None
    if "saturation" in table.comments:
        (saturation,) = _numbers(table, "saturation", (1,), 0.0, math.inf)

    return Declared(
        name=_comment(table, "name") or table.path.stem,
        source=_comment(table, "source") or table.path.name,
        quantity=chosen,
        quantity_insisted=options.quantity is not None,
        angle_unit=_angle_unit(table, options.angle_unit, warnings),
        gamma_s_deg=gamma_s,
        gamma_s_declared=is_declared,
        aperture_sd_deg=aperture,
        saturation=saturation,
        warnings=tuple(warnings),
    )


def same_side(table: TextTable, argument: str | None = None) -> bool:
    """Whether the mirror direction is on the lamp's side, as the caller or the file declares.

    Raises InputError for a word that is neither.
    """
    where, word = "--mirror", argument
    if word is None:
        line, word = table.comments.get("mirror", (0, OPPOSITE))
        where = f"{table.path}: line {line}"
    return is_same_side(word, where)


def is_same_side(word: str, where: str) -> bool:
    """Whether a word is 'same-side' and not 'opposite'; InputError, naming `where`, if neither."""
    word = "-".join(word.lower().replace("_", " ").replace("-", " ").split())
    if word not in MIRRORS:
        raise InputError(f"{where}: {printable(word, 40)!r}; expected {' or '.join(MIRRORS)}")
    return word == SAME_SIDE


def check_angle(value: float, where: str, limit_deg: float = 90.0) -> float:
    """Return a finite angle within +-limit_deg; raises InputError, naming `where`."""
    if not (math.isfinite(value) and abs(value) <= limit_deg):
        raise InputError(f"{where}: {value:g} deg is not between -{limit_deg:g} and {limit_deg:g}")
    return float(value)


def _quantity(table: TextTable, argument: str | None, warnings: list[str]) -> str:
    in_file = None
    if "quantity" in table.comments:
        line, text = table.comments["quantity"]
        in_file = quantities.canonical_quantity(text, f"{table.path}: line {line}")
    if argument is not None:
        chosen = quantities.canonical_quantity(argument, "--quantity")
        if in_file not in (None, chosen):
            warnings.append(f"the file declares quantity {in_file}, but it is read as {chosen}")
        return chosen
    heading = value_quantity(table.heading) if table.heading else None
    if in_file is None and heading:
        in_file = heading
    if table.percent:
        return _in_percent(table, in_file, warnings)
    if in_file is None:
        raise InputError(
            f"{table.path}: the quantity of the numbers is not declared; add the line "
            "'# quantity: radiance-factor' (or brdf, brdf-cos, radiance-factor-percent) on top, "
            "or pass --quantity"
        )
    if heading and heading != in_file:
        warnings.append(
            f"the heading {printable(table.heading, 30)!r} names another quantity than the "
            f"declared {in_file}, which is taken"
        )
    return in_file


def _in_percent(table: TextTable, in_file: str | None, warnings: list[str]) -> str:
    """The quantity where headings, units or cells have percent. InputError where that is not so."""
    percent, factor = quantities.RADIANCE_FACTOR_PERCENT, quantities.RADIANCE_FACTOR
    if in_file not in (None, percent, factor):
        raise InputError(
            f"{table.path}: the numbers are in percent, but the file declares quantity {in_file}; "
            f"correct the one or the other, or pass --quantity"
        )
    if in_file == percent:
        return percent
    names = [name.lower() for name in table.columns]
    readings = [k for k, name in enumerate(names) if angle_heading(name) is None]
    values = table.values[:, readings]
    most = float(np.max(values, initial=0.0, where=np.isfinite(values)))
    if most <= LEAST_PERCENT:
        raise InputError(
            f"{table.path}: the headings or units have percent, but no number is above {most:.3g}; "
            f"pass --quantity {percent} if they are percent, --quantity {factor} if 1 is white"
        )
    warnings.append(f"the numbers have percent: they are read as {percent}")
    return percent


def _angle_unit(table: TextTable, argument: str | None, warnings: list[str]) -> str | None:
    in_file = None
    if "angle_unit" in table.comments:
        line, text = table.comments["angle_unit"]
        in_file = canonical_unit(text, f"{table.path}: line {line}")
    if argument is None:
        return in_file
    chosen = canonical_unit(argument, "--angle-unit")
    if in_file not in (None, chosen):
        warnings.append(f"the file declares angles in {in_file}, but they are read as {chosen}")
    return chosen


def canonical_unit(text: str, where: str) -> str:
    """'degrees' or 'radians'; InputError, naming `where`, for any other unit of angles."""
    unit = unit_of(text)
    if unit is None:
        raise InputError(
            f"{where}: unknown unit of angle {printable(text, 40)!r}; give {DEGREES} or {RADIANS}"
        )
    return unit


def _gamma_s(table: TextTable, argument: float | None, warnings: list[str]) -> tuple[float, bool]:
    in_file = None
    if "gamma_s_deg" in table.comments:
        (in_file,) = _numbers(table, "gamma_s_deg", (1,), -90.0, 90.0)
    if argument is not None:
        chosen = check_angle(argument, "--gamma-s-deg")
        if in_file is not None and chosen != in_file:
            warnings.append(
                f"the file declares gamma_s_deg {in_file:g}, but it is read with {chosen:g}"
            )
        return chosen, True
    if in_file is not None:
        return in_file, True
    return GAMMA_S_DEG, False


def _comment(table: TextTable, key: str) -> str:
    # Escape sequences of a file must not reach a terminal through a name.
    return printable(table.comments.get(key, (0, ""))[1], MAX_TEXT)


def _numbers(
    table: TextTable, key: str, counts: tuple[int, ...], low: float, high: float
) -> list[float]:
    """The finite numbers of a comment, low to high each; `counts` lists how many are allowed."""
    line, text = table.comments[key]
    if ";" in text or "\t" in text:  # as a spreadsheet splits the two numbers
        words = [word.replace(",", ".") for word in text.replace(";", " ").split()]
    elif table.decimal_comma and counts == (1,):
        words = [text.replace(",", ".")]
    else:
        words = text.replace(",", " ").split()
    try:
        numbers = [float(word) for word in words]
    except ValueError:
        numbers = []
    fine = all(math.isfinite(x) and low <= x <= high for x in numbers)
    if len(numbers) not in counts or not fine:
        expected = " or ".join(str(c) for c in counts)
        limit = f" from {low:g} to {high:g}" if math.isfinite(high) else f" of at least {low:g}"
        raise InputError(
            f"{table.path}: line {line}: '# {key}: {printable(text, 40)}', expected {expected} "
            f"number{'s' if counts[-1] > 1 else ''}{limit}; correct it or remove the line"
        )
    return numbers
