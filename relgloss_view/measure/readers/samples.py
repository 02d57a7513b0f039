"""Spectra of named samples, as files of spectrophotometers hold them, and the choice of one."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from relgloss_view.base.arrays import Array
from relgloss_view.base.errors import InputError
from relgloss_view.measure.readers.aspecular import Aspecular
from relgloss_view.measure.spectrum import AT_45_0, SPHERE_EXCLUDED, SPHERE_INCLUDED

MOST_SAMPLES = 20_000
MOST_VALUES = 500_000  #: of all samples; a chart of 10,000 patches has 310,000
LONGEST_NAME = 60  #: characters
LONGEST_WORDS = 20_000  #: characters of titles in which a geometry is looked for

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
    angle: Aspecular | None = None  #: of a multi-angle instrument


@dataclass
class SampleFile:
    """The samples of a file and what was passed over in it."""

    samples: list[Sample] = field(default_factory=list)
    quantity: str | None = None  #: as declared, in the canonical spelling
    source: str = ""  #: the instrument or program that the file names
    notes: list[str] = field(default_factory=list)
    #: Names of samples of which the file holds a colour (CIELAB), and no spectrum
    colours: dict[str, tuple[float, float, float]] = field(default_factory=dict)


def geometry_of(words: str) -> str | None:
    """The geometry, one of measure.spectrum.GEOMETRIES, that words name; None where they do not.

    >>> geometry_of("0/45, M1"), geometry_of("45°a:0°"), geometry_of("d/8 SPIN"), geometry_of("d/8")
    ('45-0', '45-0', 'd-8-sci', None)
    """
    words = " ".join(words[:LONGEST_WORDS].split())
    if _SPHERE.search(words) or re.search(r"\bsc[ie]\b|\bsp(in|ex)\b", words, re.I):
        included, excluded = (bool(p.search(words)) for p in (_INCLUDED, _EXCLUDED))
        if included == excluded:
            return None
        return SPHERE_INCLUDED if included else SPHERE_EXCLUDED
    return AT_45_0 if _45_0.search(words) else None


def series(samples: Sequence[Sample]) -> dict[str, list[Sample]]:
    """Samples by their names, in the order of the file: the geometries of one share a name."""
    groups: dict[str, list[Sample]] = {}
    for sample in samples:
        groups.setdefault(sample.name, []).append(sample)
    return groups


def add_sample(path: Path, file: SampleFile, sample: Sample) -> None:
    """Append a sample; InputError where the file holds more than is read."""
    file.samples.append(sample)
    count = len(file.samples)
    if count > MOST_SAMPLES or count * len(sample.values) > MOST_VALUES:
        raise InputError(f"{path}: more than {count - 1} spectra; split the file")


def distinguish(result: SampleFile) -> None:
    """Samples of a single geometry that share a name get their number in the file beside it."""
    counts: dict[str, int] = {}
    for sample in result.samples:
        if sample.angle is None:
            counts[sample.name] = counts.get(sample.name, 0) + 1
    result.samples[:] = [
        replace(sample, name=f"{sample.name} ({k + 1})")
        if sample.angle is None and counts.get(sample.name, 0) > 1
        else sample
        for k, sample in enumerate(result.samples)
    ]
