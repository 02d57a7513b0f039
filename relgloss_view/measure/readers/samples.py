"""Spectra of named samples, as files of spectrophotometers hold them, and the choice of one."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from relgloss_view.base.arrays import Array
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.measure.spectrum import AT_45_0, SPHERE_EXCLUDED, SPHERE_INCLUDED

MOST_SAMPLES = 20_000
MOST_VALUES = 5_000_000  #: of all samples: 40 MB
LISTED = 6  #: names that a message lists
LONGEST_NAME = 60  #: characters

_45_0 = re.compile(r"\b45\s*°?[acx]?\s*[/:-]\s*0\b|\b0\s*°?\s*[/:-]\s*45\s*°?[acx]?\b", re.I)
_SPHERE = re.compile(r"\bd[ie]?\s*[/:]\s*8|\b8\s*°?\s*[/:]\s*d|\bsphere\b|\bdiffuse_8", re.I)
_INCLUDED = re.compile(r"\b(sci|spin|rsin|di\s*[/:]\s*8|included?)\b", re.I)
_EXCLUDED = re.compile(r"\b(sce|spex|rsex|de\s*[/:]\s*8|excluded?)\b", re.I)


@dataclass(frozen=True)
class Sample:
    """One spectrum of a file, as it is written there."""

    name: str
    wavelengths_nm: Array  #: (B,)
    values: Array  #: (B,), NaN where nothing was read
    geometry: str = ""  #: the file's words for it
    percent: bool | None = None  #: whether the values are percent; None where nothing says so
    lab: tuple[float, float, float] | None = None  #: where the file holds it, too


@dataclass
class SampleFile:
    """The samples of a file and what was passed over in it."""

    samples: list[Sample] = field(default_factory=list)
    quantity: str | None = None  #: as declared, in the canonical spelling
    notes: list[str] = field(default_factory=list)


def geometry_of(words: str) -> str | None:
    """The geometry, one of measure.spectrum.GEOMETRIES, that words name; None where they do not.

    >>> geometry_of("0/45, M1"), geometry_of("45°a:0°"), geometry_of("d/8 SPIN"), geometry_of("d/8")
    ('45-0', '45-0', 'd-8-sci', None)
    """
    if _SPHERE.search(words) or re.search(r"\bsc[ie]\b|\bsp(in|ex)\b", words, re.I):
        included, excluded = (bool(p.search(words)) for p in (_INCLUDED, _EXCLUDED))
        if included == excluded:
            return None
        return SPHERE_INCLUDED if included else SPHERE_EXCLUDED
    return AT_45_0 if _45_0.search(words) else None


def chosen_part(path: Path, names: Sequence[str], part: str | None, kind: str = "sample") -> int:
    """The index of the wanted one of several samples; of one alone, where there is no other.

    part: a name in any case, or a number from 1. Raises InputError, which lists the first names,
    where nothing is wanted of several or what is wanted is not there.
    """
    if part is None:
        if len(names) == 1:
            return 0
        raise InputError(
            f"{path}: the file holds {len(names)} {kind}s; choose one by name or number with "
            f"--part: {_listed(names)}"
        )
    wanted = part.strip()
    for same in (str.strip, lambda text: " ".join(text.lower().split())):
        matches = [k for k, name in enumerate(names) if same(name) == same(wanted)]
        if len(matches) == 1:
            return matches[0]
        if len(matches) > 1:
            numbers = ", ".join(str(k + 1) for k in matches[:LISTED])
            raise InputError(
                f"{path}: {len(matches)} {kind}s have the name {printable(part, 40)!r}; choose "
                f"one by its number with --part ({numbers})"
            )
    if wanted.isascii() and wanted.isdecimal() and len(wanted) < 9:
        index = int(wanted) - 1
        if 0 <= index < len(names):
            return index
    raise InputError(
        f"{path}: no {kind} {printable(part, 40)!r} among {len(names)}: {_listed(names)}"
    )


def _listed(names: Sequence[str]) -> str:
    shown = [printable(name, LONGEST_NAME) for name in names[:LISTED]]
    more = f" and {len(names) - len(shown)} more" if len(names) > len(shown) else ""
    return f"{', '.join(shown)}{more}"
