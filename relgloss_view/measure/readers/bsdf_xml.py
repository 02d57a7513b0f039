"""BSDF in XML, as WINDOW and Radiance's genBSDF write it: matrices or tensor trees of reflection.

A matrix holds the BSDF, in 1/sr, between the patches of two angle bases, averaged over both
patches. Azimuths of incidence are those of where the light goes, and azimuths of departure those of
where it leaves to, so a mirror's light lies on the diagonal: the lamp is at the patch's azimuth
plus 180 degrees.

Sources: BSDF-v1.7.7.xsd (LBNL) for the elements; Ward, Radiance's bsdf_m.c, for the directions.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import named, printable
from relgloss_view.base.xml import line_of, read_xml
from relgloss_view.measure.bands import FINEST_STEP_NM, WAVELENGTH_RANGE_NM, Bands
from relgloss_view.measure.gonio import spherical
from relgloss_view.measure.readers.assemble import assemble, one_channel
from relgloss_view.measure.readers.declared import MAX_APERTURE_SD_DEG, Declared
from relgloss_view.measure.readers.klems import Basis, known_bases, read_basis
from relgloss_view.measure.readers.options import ReadOptions
from relgloss_view.measure.readers.tensor_tree_file import tree_readings
from relgloss_view.measure.readers.tristimulus import rgb_of
from relgloss_view.measure.table import Measurement

EXPECTED = "a BSDF in XML (WINDOW, Radiance)"
MOST_BYTES = 64_000_000
#: Values of all matrices that are read; a spectrum of 80 bands in Klems's full basis has fewer.
MOST_VALUES = 2_000_000
LARGEST = 1e9  #: 1/sr; a perfect mirror seen through the smallest patch stays below
FRONT, BACK = "reflection front", "reflection back"
#: What `part` may be, and the direction that it chooses.
_PARTS = {"1": FRONT, "front": FRONT, FRONT: FRONT, "2": BACK, "back": BACK, BACK: BACK}
VISIBLE, CIE_X, CIE_Z = "visible", "cie-x", "cie-z"


@dataclass(frozen=True)
class Block:
    """A WavelengthDataBlock: which light goes where, and its element."""

    direction: str  #: in lower case, such as FRONT
    wavelength: str  #: in lower case; of numbers, nanometres
    element: Element

    @property
    def nanometres(self) -> float | None:
        """The wavelength, where it is one that reflectances have."""
        try:
            value = float(self.wavelength.removesuffix("nm").strip())
        except ValueError:
            return None
        return value if WAVELENGTH_RANGE_NM[0] <= value <= WAVELENGTH_RANGE_NM[1] else None


def read(path: Path, options: ReadOptions) -> Measurement:
    """Read the reflection of one surface of a BSDF XML file. Raises InputError.

    options: part is 'front', the default, or 'back'; a quantity replaces the BRDF.

    The patches blur the directions as apertures do, and are declared as such.
    """
    place = named(path)
    root = read_xml(path, EXPECTED, most_bytes=MOST_BYTES)
    layer, structure = _definition(root, place)
    blocks = list(_blocks(layer))
    surface, notes = _surface(blocks, options.part, place)
    if structure.startswith("tensortree"):
        return _read_trees(path, options, structure, surface, blocks, layer, notes)
    chosen, bands = _channels([b for b in blocks if b.direction == surface], place, surface)
    passed = _passed_over(blocks, chosen)
    if passed:
        notes.append(passed)

    bases = _bases(layer, place)
    matrices = [_Matrix(block.element, structure, bases, place) for block in chosen]
    first = matrices[0]
    if any((m.incident, m.outgoing) != (first.incident, first.outgoing) for m in matrices):
        raise InputError(f"{place}: the angle bases of {surface} differ between wavelengths")
    if len(matrices) * first.count > MOST_VALUES:
        raise InputError(
            f"{place}: {len(matrices)} matrices of {first.count} values; at most {MOST_VALUES} "
            "values are read: export fewer wavelengths"
        )
    readings = np.stack([m.values() for m in matrices], axis=-1)
    if bands is None and len(chosen) == 3:
        bands, readings, more = rgb_of(readings)
        notes += more
    elif bands is None:
        label = chosen[0].wavelength
        bands, readings, gray = one_channel(readings, "visible" if label == VISIBLE else label)
        notes.append(gray)

    angles = first.angles()
    # Light and value vary so much within a patch at the horizon that no direction stands for it.
    reach = first.incident.at_horizon()[None, :] | first.outgoing.at_horizon()[:, None]
    if not reach.all():
        angles, readings = angles[~reach.ravel()], readings[~reach.ravel()]
        notes.append(
            f"{int(reach.sum())} values of patches that reach the horizon are left out: an average "
            "there belongs to no direction"
        )
    spread = (round(first.incident.spread_deg(), 3), round(first.outgoing.spread_deg(), 3))
    notes.append(
        f"each value is an average over patches (angle basis {first.incident.name}): a highlight "
        f"narrower than {0.5 * float(np.hypot(*spread)):.2g} deg of the half-vector is not resolved"
    )
    facts = Declared.of_brdf(
        _name(layer, path),
        f"{_computed(layer)}{path.name}, BSDF XML (WINDOW, Radiance), {surface}",
        options,
        notes,
        (min(spread[0], MAX_APERTURE_SD_DEG), min(spread[1], MAX_APERTURE_SD_DEG)),
    )
    theta_i, phi_i, theta_r, phi_r = angles.T
    to_lamp, to_receiver = spherical(theta_i, phi_i + 180.0), spherical(theta_r, phi_r)
    measurement = assemble(path, facts, angles, bands, readings, (to_lamp, to_receiver), theta_i)
    unused = options.unused("gamma_s_deg", "angle_unit", "mirror")
    return replace(measurement, warnings=(*measurement.warnings, *unused))


def _read_trees(
    path: Path,
    options: ReadOptions,
    structure: str,
    surface: str,
    blocks: list[Block],
    layer: Element,
    notes: list[str],
) -> Measurement:
    """The measurement of a file of tensor trees."""
    first: dict[str, Element] = {}
    for block in blocks:
        if block.direction == surface:
            first.setdefault(block.wavelength, block.element)
    read = tree_readings(structure, first, named(path))
    aperture_sd_deg = min(round(read.cell_sd_deg, 3), MAX_APERTURE_SD_DEG)
    facts = Declared.of_brdf(
        _name(layer, path),
        f"{_computed(layer)}{path.name}, BSDF XML (tensor tree, Radiance), {surface}",
        options,
        (*notes, *read.notes),
        (aperture_sd_deg, aperture_sd_deg),
    )
    angles = np.concatenate([read.to_lamp, read.to_receiver], axis=1)
    measurement = assemble(
        path, facts, angles, read.bands, read.values, (read.to_lamp, read.to_receiver), read.group
    )
    unused = options.unused("gamma_s_deg", "angle_unit", "mirror")
    warnings = (*measurement.warnings, *unused)
    return replace(measurement, warnings=warnings, tabulated=True)


def _name(layer: Element, path: Path) -> str:
    name = printable((layer.findtext("Material/Name") or "").strip(), 200)
    return name or path.stem


def _computed(layer: Element) -> str:
    """What marks a table that relgloss computed from a model."""
    maker = (layer.findtext("Material/Manufacturer") or "").strip()
    return "synthetic (computed by relgloss), " if maker.startswith("relgloss ") else ""


def _definition(root: Element, place: str) -> tuple[Element, str]:
    """The layer that holds the data, and how it is laid out: 'columns', 'rows' or a tensor tree."""
    if root.tag != "WindowElement":
        raise InputError(f"{place}: the file begins with {printable(root.tag, 40)!r}; "
                         f"give {EXPECTED}")  # fmt: skip
    layers = [e for e in root.iter("Layer") if e.find("WavelengthData") is not None]
    if not layers:
        raise InputError(f"{place}: no WavelengthData; the file holds no BSDF")
    layer = layers[0]
    structure = (layer.findtext("DataDefinition/IncidentDataStructure") or "columns").strip()
    known = structure.lower() in ("columns", "rows")
    if not known and not structure.lower().startswith("tensortree"):
        raise InputError(
            f"{place}: IncidentDataStructure {printable(structure, 30)!r}; expected Columns, Rows, "
            "TensorTree3 or TensorTree4"
        )
    return layer, structure.lower()


def _blocks(layer: Element) -> Iterator[Block]:
    for data in layer.iterfind("WavelengthData"):
        wavelength = " ".join((data.findtext("Wavelength") or "").split()).lower()
        for element in data.iterfind("WavelengthDataBlock"):
            direction = " ".join((element.findtext("WavelengthDataDirection") or "").split())
            yield Block(direction.lower(), wavelength, element)


def _surface(blocks: list[Block], part: str | None, place: str) -> tuple[str, list[str]]:
    """The direction that is wanted, and notes."""
    there = list(dict.fromkeys(b.direction for b in blocks))
    surfaces = [d for d in (FRONT, BACK) if d in there]
    if not surfaces:
        listed = printable(", ".join(there) or "nothing", 120)
        raise InputError(
            f"{place}: the file holds no reflection ({listed}), and relgloss draws reflection; "
            "give the file of the whole system or of the reflection"
        )
    if part is None:
        if FRONT in surfaces:
            return FRONT, []
        return BACK, ["the file holds the reflection of the back only, which is read"]
    wanted = _PARTS.get(" ".join(part.lower().split()))
    if wanted is None:
        raise InputError(f"--part {printable(part, 40)!r}: expected front or back")
    if wanted not in surfaces:
        raise InputError(f"{place}: no {wanted}; the file holds {', '.join(surfaces)}")
    return wanted, []


def _channels(blocks: list[Block], place: str, surface: str) -> tuple[list[Block], Bands | None]:
    """The blocks that make the channels: a spectrum, X, Y and Z, or one; bands of a spectrum."""
    first: dict[str, Block] = {}
    for block in blocks:
        first.setdefault(block.wavelength, block)
    spectrum: list[tuple[float, Block]] = []
    for nm, block in sorted(
        ((b.nanometres or 0.0, b) for b in first.values() if b.nanometres), key=lambda x: x[0]
    ):
        if not spectrum or nm - spectrum[-1][0] >= FINEST_STEP_NM:
            spectrum.append((nm, block))
    if len(spectrum) >= 2:
        return [block for _, block in spectrum], Bands(tuple(nm for nm, _ in spectrum))
    if {VISIBLE, CIE_X, CIE_Z} <= first.keys():
        return [first[CIE_X], first[VISIBLE], first[CIE_Z]], None
    if VISIBLE in first:
        return [first[VISIBLE]], None
    if spectrum:
        return [spectrum[0][1]], None
    listed = printable(", ".join(first), 80)
    raise InputError(
        f"{place}: {surface} is given for {listed} only, which the eye does not see; export it for "
        "Visible, or for wavelengths in nanometres"
    )


def _passed_over(blocks: list[Block], chosen: list[Block]) -> str | None:
    """One sentence about the blocks that are not read."""
    used = {id(block) for block in chosen}
    rest: dict[str, list[str]] = {}
    for block in blocks:
        if id(block) not in used:
            rest.setdefault(block.wavelength or "no wavelength", []).append(block.direction)
    if not rest:
        return None
    parts = [
        f"{', '.join(dict.fromkeys(directions))} ({wavelength})"
        for wavelength, directions in list(rest.items())[:4]
    ]
    more = f" and {len(rest) - 4} more wavelengths" if len(rest) > 4 else ""
    return f"passed over: {printable('; '.join(parts), 300)}{more}"


def _bases(layer: Element, place: str) -> dict[str, Basis]:
    bases = known_bases()
    for element in layer.iterfind("DataDefinition/AngleBasis"):
        basis = read_basis(element, place)
        bases[basis.name.lower()] = basis
    return bases


class _Matrix:
    """The numbers of a block and the bases of their directions."""

    def __init__(self, block: Element, structure: str, bases: dict[str, Basis], place: str) -> None:
        self._where = f"{place}: line {line_of(block)}"
        kind = " ".join((block.findtext("ScatteringDataType") or "").split())
        if kind.lower() not in ("", "btdf", "brdf", "bsdf", "brtf", "brrf"):
            raise InputError(
                f"{self._where}: ScatteringDataType {printable(kind, 40)!r}; expected BRDF or "
                "BTDF, in 1/sr"
            )
        column = self._basis(block, "ColumnAngleBasis", bases)
        row = self._basis(block, "RowAngleBasis", bases)
        self._rows_are_incident = structure == "rows"
        if self._rows_are_incident and column != row:
            raise InputError(
                f"{self._where}: IncidentDataStructure Rows with two angle bases, which programs "
                "read in two ways; export it as Columns"
            )
        self.incident, self.outgoing = column, row
        self.count = column.count * row.count
        data = block.find("ScatteringData")
        self._text = (data.text or "") if data is not None else ""

    def angles(self) -> Array:
        """(N, 4): theta and phi of incidence, theta and phi of departure, degrees.

        The outgoing patch varies slowest.
        """
        theta_i, phi_i = self.incident.centres()
        theta_r, phi_r = self.outgoing.centres()
        n, m = len(theta_r), len(theta_i)
        return np.stack(
            [np.tile(theta_i, n), np.tile(phi_i, n), np.repeat(theta_r, m), np.repeat(phi_r, m)],
            axis=-1,
        )

    def values(self) -> Array:
        """(N,), 1/sr, in the order of `angles`."""
        words = self._text.replace(",", " ").split(None, self.count)
        if len(words) != self.count:
            few = "more" if len(words) > self.count else str(len(words))
            raise InputError(
                f"{self._where}: {few} values; the bases {self.incident.name} and "
                f"{self.outgoing.name} need {self.outgoing.count} x {self.incident.count}"
            )
        try:
            values = np.array(words, dtype=np.float64)
        except ValueError:
            wrong = next(w for w in words if not _is_number(w))
            raise InputError(
                f"{self._where}: found {printable(wrong, 30)!r} among the ScatteringData; "
                "expected numbers"
            ) from None
        if np.nanmax(np.abs(values), initial=0.0) > LARGEST:
            raise InputError(
                f"{self._where}: a value above {LARGEST:g}, which no BSDF reaches; correct it"
            )
        matrix = values.reshape(self.outgoing.count, self.incident.count)
        return np.asarray((matrix.T if self._rows_are_incident else matrix).ravel())

    def _basis(self, block: Element, tag: str, bases: dict[str, Basis]) -> Basis:
        name = " ".join((block.findtext(tag) or "").split())
        basis = bases.get(name.lower())
        if basis is None:
            raise InputError(
                f"{self._where}: {tag} {printable(name, 60)!r} is not defined in the file; "
                f"it defines {printable(', '.join(b.name for b in bases.values()), 120)}"
            )
        return basis


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True
