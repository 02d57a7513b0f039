"""CxF3 (ISO 17972-1): spectra of samples in XML, each with the specification of its measurement."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.base.xml import line_of, read_xml
from relgloss_view.measure.readers import multi_angle
from relgloss_view.measure.readers.aspecular import (
    USUAL_LAMP_DEG,
    Aspecular,
    is_possible,
    split_aspecular,
)
from relgloss_view.measure.readers.options import ReadOptions
from relgloss_view.measure.readers.samples import (
    LONGEST_NAME,
    Sample,
    SampleFile,
    add_sample,
    distinguish,
)
from relgloss_view.measure.table import Measurement

EXPECTED = "a CxF file of measured spectra"
MAX_BYTES = 64 * 1024 * 1024
MOST_BANDS = 2_000
_SPECTRA = ("ReflectanceSpectrum", "CustomSpectrum")
_OTHER = ("Transmittance", "Emissive")
#: Numbers of bands that instruments write with 10 nm steps from a start: 400 to 700, 380 to 730.
_USUAL_STEP_NM, _USUAL_END_NM = 10.0, (680.0, 780.0)


@dataclass
class _Specification:
    """What a ColorSpecification states about its measurements."""

    kind: str = ""  #: MeasurementType
    start_nm: float | None = None
    step_nm: float | None = None
    geometry: str = ""  #: words
    angles: list[tuple[str, Aspecular]] = field(default_factory=list)  #: by their notation
    condition: str = ""  #: such as M1


def read(path: Path, options: ReadOptions) -> Measurement:
    """The multi-angle readings of one sample. Raises InputError, as multi_angle.measurement."""
    return multi_angle.measurement(path, read_samples(path), options)


def read_samples(path: Path) -> SampleFile:
    """All samples of a CxF file that have a reflectance spectrum.

    Raises InputError that names the line.
    """
    root = read_xml(path, EXPECTED, most_bytes=MAX_BYTES)
    if root.tag != "CxF":
        raise InputError(f"{path}: the outer element is {root.tag[:30]!r}, expected 'CxF'")
    result = SampleFile(source=_text(root, "FileInformation/Creator"))
    specifications = {
        element.get("Id", ""): _specification(path, element)
        for element in root.iter("ColorSpecification")
    }
    passed_over = 0
    for element in root.iter("Object"):
        passed_over += _object(path, element, specifications, result)
    if passed_over:
        result.notes.append(
            f"passed over {passed_over} spectra that are no reflectance"
            if passed_over > 1
            else "passed over a spectrum that is no reflectance"
        )
    distinguish(result)
    if not result.samples and not result.colours:
        raise InputError(
            f"{path}: no object with a ReflectanceSpectrum or a ColorCIELab; export the measured "
            "spectra with it"
        )
    return result


def _text(element: Element, place: str) -> str:
    return (element.findtext(place) or "").strip()[:200]


def _specification(path: Path, element: Element) -> _Specification:
    measured = element.find("MeasurementSpec")
    result = _Specification()
    if measured is None:
        return result
    result.kind = _text(measured, "MeasurementType")
    wavelengths = measured.find("WavelengthRange")
    if wavelengths is not None:
        result.start_nm = _attribute(path, wavelengths, "StartWL")
        result.step_nm = _attribute(path, wavelengths, "Increment")
    result.condition = _text(measured, "Device/DeviceIllumination")
    choice = measured.find("GeometryChoice")
    if choice is None:
        return result
    sphere = _text(choice, "SphereGeometry")
    single = choice.find("SingleAngle")
    if sphere:
        result.geometry = f"sphere {sphere.replace('_', ' ')}"
    elif single is not None:
        lamp = _number(path, single, "IlluminationAngle")
        receiver = _number(path, single, "MeasurementAngle")
        if lamp is not None and receiver is not None:
            result.geometry = f"{lamp:g}/{receiver:g}"
    else:
        result.geometry = _text(choice, "UnknownGeometry")
    for angle in choice.iter("BRDFAngle"):
        result.angles.append(_angle(path, angle))
    return result


def _angle(path: Path, element: Element) -> tuple[str, Aspecular]:
    notation = element.get("Notation", "").strip()
    named, _ = split_aspecular(notation, whole=True)
    lamp = _number(path, element, "IlluminationAngle")
    aspecular = _number(path, element, "Aspecular")
    azimuth = _number(path, element, "Azimuth")
    if aspecular is None and named is not None:
        return notation, named
    if aspecular is None:
        raise InputError(f"{path}: line {line_of(element)}: a BRDFAngle without Aspecular")
    geometry = Aspecular(USUAL_LAMP_DEG if lamp is None else lamp, aspecular, azimuth or 0.0)
    if not is_possible(geometry):
        raise InputError(
            f"{path}: line {line_of(element)}: no instrument measures at the illumination angle "
            f"{geometry.lamp_deg:g}, aspecular {geometry.aspecular_deg:g}; correct the BRDFAngle"
        )
    return notation or geometry.words, geometry


def _object(
    path: Path, element: Element, specifications: dict[str, _Specification], result: SampleFile
) -> int:
    """Take the spectra of an object; returns how many are no reflectance."""
    name = element.get("Name") or element.get("Id") or f"object {len(result.samples) + 1}"
    name = printable(name, LONGEST_NAME)
    spectra = [child for parent in element for child in parent if child.tag in _SPECTRA]
    sound, other = [], 0
    for spectrum in spectra:
        specification = specifications.get(spectrum.get("ColorSpecification", ""))
        if specification is None:
            specification = _Specification()
        if any(word in specification.kind for word in _OTHER):
            other += 1
        else:
            sound.append((spectrum, specification))
    other += sum(
        child.tag in ("TransmittanceSpectrum", "EmissiveSpectrum")
        for parent in element
        for child in parent
    )
    angles = _angles(path, sound)
    flat = sum(angle is None for angle in angles)
    for (spectrum, specification), angle in zip(sound, angles, strict=True):
        nm, values = _values(path, spectrum, specification)
        own = spectrum.get("Name", "") or specification.condition
        own = own or spectrum.get("ColorSpecification", "")
        label = name if angle is not None or flat == 1 else f"{name}, {own}"
        words = f"{specification.geometry} {specification.condition}".strip()
        add_sample(
            path, result, Sample(printable(label, LONGEST_NAME), nm, values, words, False, angle)
        )
    if not sound:
        lab = element.find("ColorValues/ColorCIELab")
        if lab is not None:
            axes = [_number(path, lab, axis) for axis in "LAB"]
            if all(axis is not None for axis in axes):
                lightness, a, b = (axis or 0.0 for axis in axes)
                result.colours.setdefault(name, (lightness, a, b))
    return other


def _angles(path: Path, spectra: list[tuple[Element, _Specification]]) -> list[Aspecular | None]:
    """The geometry of each spectrum: of its specification, by name, or by its turn."""
    turns: dict[int, int] = {}
    counts: dict[int, int] = {}
    for _, specification in spectra:
        counts[id(specification)] = counts.get(id(specification), 0) + 1
    result: list[Aspecular | None] = []
    for spectrum, specification in spectra:
        own, _ = split_aspecular(spectrum.get("Name", "") or specification.geometry)
        listed = specification.angles
        turn = turns.get(id(specification), 0)
        turns[id(specification)] = turn + 1
        if not listed:
            result.append(own)
            continue
        wanted = spectrum.get("Name", "").strip().lower()
        named = [angle for notation, angle in listed if notation.lower() == wanted]
        if len(named) == 1:
            result.append(named[0])
        elif own is not None:
            result.append(own)
        elif counts[id(specification)] == len(listed):
            result.append(listed[turn][1])
        elif len(listed) == 1:
            result.append(listed[0][1])
        else:
            raise InputError(
                f"{path}: line {line_of(spectrum)}: which of {len(listed)} angles this spectrum "
                "belongs to is not stated; export it with its Name, or with a ColorSpecification "
                "for each angle"
            )
    return result


def _values(path: Path, spectrum: Element, specification: _Specification) -> tuple[Array, Array]:
    place = f"{path}: line {line_of(spectrum)}"
    if spectrum.tag == "CustomSpectrum":
        points = spectrum.findall("SpectralPoint")[: MOST_BANDS + 1]
        nm = [_attribute(path, point, "WL") for point in points]
        values = [_float(place, point.text or "") for point in points]
        if any(v is None for v in nm) or not nm:
            raise InputError(f"{place}: a spectrum with a point that has no WL")
        wavelengths = np.array([v for v in nm if v is not None])
    else:
        values = [_float(place, word) for word in (spectrum.text or "").split()[: MOST_BANDS + 1]]
        start = _attribute(path, spectrum, "StartWL")
        start = specification.start_nm if start is None else start
        step = specification.step_nm
        count = len(values)
        if start is not None and step is None:
            end = start + _USUAL_STEP_NM * (count - 1)
            if _USUAL_END_NM[0] <= end <= _USUAL_END_NM[1]:
                step = _USUAL_STEP_NM
        if start is None or step is None or not (0.0 < step < 1000.0 and 0.0 < start < 10_000.0):
            raise InputError(
                f"{place}: the wavelengths of the spectrum are not stated; its ColorSpecification "
                "needs a WavelengthRange with StartWL and Increment"
            )
        wavelengths = start + step * np.arange(count)
    if not 1 <= len(values) <= MOST_BANDS:
        raise InputError(f"{place}: a spectrum of {len(values)} values, expected 2 to {MOST_BANDS}")
    return wavelengths, np.array(values)


def _attribute(path: Path, element: Element, name: str) -> float | None:
    text = element.get(name)
    return None if text is None else _finite(f"{path}: line {line_of(element)}: {name}", text)


def _number(path: Path, element: Element, name: str) -> float | None:
    text = element.findtext(name)
    return None if text is None else _finite(f"{path}: line {line_of(element)}: {name}", text)


def _finite(place: str, text: str) -> float:
    value = _float(place, text)
    if not math.isfinite(value):
        raise InputError(f"{place}: found {printable(text, 30)!r}, expected a number")
    return value


def _float(place: str, text: str) -> float:
    text = text.strip()
    if text.lower() == "nan":
        return math.nan
    try:
        value = float(text) if text.isascii() and "_" not in text and len(text) < 60 else math.inf
    except ValueError:
        value = math.inf
    if not abs(value) < 1e12:
        raise InputError(f"{place}: found {printable(text, 30)!r}, expected a number")
    return value
