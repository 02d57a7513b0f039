"""SSDD, surface scattering distribution data: the file format of libbsdf (Kimura, version 0.2).

Source: libbsdf, doc/SsddFileFormatSpecification.md (2023-08-14). A file has up to four blocks of
lines 'NAME value' with a table below: BRDF, BTDF, specular reflectance and transmittance. The BRDF
is read; relgloss has no use for the others.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from relgloss_view.base.arrays import Array, Ints
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.measure.bands import Bands
from relgloss_view.measure.gonio import from_normal, spherical
from relgloss_view.measure.quantity import BRDF
from relgloss_view.measure.readers import half_difference
from relgloss_view.measure.readers.assemble import assemble, one_channel
from relgloss_view.measure.readers.declared import Declared
from relgloss_view.measure.readers.options import ReadOptions
from relgloss_view.measure.readers.ssdd_blocks import Block, read_blocks
from relgloss_view.measure.readers.tristimulus import readable_rgb, srgb_from_xyz
from relgloss_view.measure.table import Measurement

SPHERICAL, SPECULAR, HALF_DIFFERENCE = (
    f"{word}_coordinate_system" for word in ("spherical", "specular", "half_difference")
)
#: The largest angle of each list of parameters, degrees, by the kind of coordinates.
LARGEST_DEG = {
    SPHERICAL: (90.0, 360.0, 90.0, 360.0),
    SPECULAR: (90.0, 360.0, 180.0, 360.0),
    HALF_DIFFERENCE: (90.0, 360.0, 90.0, 360.0),
}
ROUNDING_DEG = 1e-3  #: writers print 90 degrees from float32 radians
#: Directions that are kept of a table: generated ones have a million, and a fit needs no more.
MOST_SAMPLES = 150_000
MAX_NUMBERS = 20_000_000
MAX_TEXT = 10_000_000  #: numbers of a table in text, which takes longer
MAX_DIRECTIONS = 3_000_000


@dataclass(frozen=True)
class _Grid:
    """The nodes that are kept: for each of the four lists its angles and their places."""

    angles: tuple[Array, ...]
    places: tuple[Ints, ...]
    sizes: tuple[int, ...]

    @property
    def count(self) -> int:
        return math.prod(self.sizes)

    def rows(self) -> Ints:
        """The places of the kept nodes in the table, (M,); the first list runs fastest."""
        strides = np.cumprod([1, *self.sizes[:3]])
        steps = [places * stride for places, stride in zip(self.places, strides, strict=True)]
        return np.asarray(_outer(*reversed(steps)).sum(axis=0))

    def columns(self) -> tuple[Array, ...]:
        """The four angles of the kept nodes, degrees, (M,) each."""
        return tuple(reversed(_outer(*reversed(self.angles))))


def _outer(*lists: Array | Ints) -> Array:
    return np.stack([axis.ravel() for axis in np.meshgrid(*lists, indexing="ij")])


def read(path: Path, options: ReadOptions) -> Measurement:
    """Read the BRDF of an .ssdd file. Raises InputError.

    Azimuths are counted as libbsdf does: 0 is the lamp's own, so that the mirror direction of
    spherical coordinates is at an azimuth difference of 180 degrees, and the azimuth 0 about the
    mirror direction points to the normal's side.
    """
    blocks, data = read_blocks(path)
    block = _brdf(path, blocks)
    kind = _kind(path, block)
    labels, wavelengths = _channels(path, block)
    warnings = _passed_over(blocks, block)
    grid = _grid(path, block, kind, len(labels))
    if not block.binary and grid.count * len(labels) > MAX_TEXT:
        raise InputError(
            f"{path}: a text table of {grid.count * len(labels)} numbers, at most {MAX_TEXT} are "
            "read; save it with 'DATA binary', or thin out its lists"
        )
    values = block.numbers(data, grid.count, len(labels))
    grid, thinned = _thinned(grid)
    rows = grid.rows()
    with np.errstate(invalid="ignore"):  # a signalling NaN, which counts as empty
        readings = np.asarray(values[rows], dtype=np.float64)
    del values
    columns = grid.columns()
    fresh = _distinct(columns, readings)
    rows, readings = rows[fresh], readings[fresh]
    columns = tuple(column[fresh] for column in columns)
    lamp, receiver = _directions(path, block, kind, columns)
    warnings += thinned + _turned(grid)
    bands, readings, remarks = _bands(path, block, wavelengths, readings, labels)
    measurement = assemble(
        path,
        Declared(
            name=block.text("NAME") or path.stem,
            source=_source(path, block),
            quantity=options.quantity_or(BRDF),
            quantity_insisted=options.quantity is not None,
            warnings=(*warnings, *remarks),
        ),
        np.stack(columns, axis=1),
        bands,
        readings,
        (lamp, receiver),
        np.rint(from_normal(lamp)),
    )
    unused = options.unused("gamma_s_deg", "angle_unit", "mirror", "part")
    return replace(
        measurement,
        warnings=(*measurement.warnings, *unused),
        synthetic=measurement.synthetic or block.text("SOURCE_TYPE").lower() == "generated",
    )


def _brdf(path: Path, blocks: list[Block]) -> Block:
    for block in blocks:
        if block.kind == "brdf":
            return block
    held = " and ".join(block.kind.replace("_", " ") for block in blocks)
    raise InputError(
        f"{path}: the file holds no BRDF but {held}; give one with a block 'DATA_TYPE brdf'"
    )


def _passed_over(blocks: list[Block], chosen: Block) -> tuple[str, ...]:
    others = [b.kind.replace("_", " ") for b in blocks if b is not chosen]
    if not others:
        return ()
    return (f"the BRDF of the file is read; passed over: {', '.join(others)}",)


def _kind(path: Path, block: Block) -> str:
    kind = block.text("PARAM_TYPE").lower()
    if kind not in LARGEST_DEG:
        raise InputError(
            f"{path}: PARAM_TYPE {printable(kind, 60)!r}; read are {', '.join(LARGEST_DEG)}"
        )
    for reduction in block.text("REDUCTION_TYPE").lower().split():
        # Both leave out nodes that symmetry repeats, and a fit of an isotropic material needs none.
        if reduction not in ("bilateral_symmetry", "reciprocity"):
            raise InputError(
                f"{path}: REDUCTION_TYPE {printable(reduction, 60)!r}; "
                "expected bilateral_symmetry or reciprocity"
            )
    return kind


def _channels(path: Path, block: Block) -> tuple[tuple[str, ...], Array]:
    """Labels of the channels, and their wavelengths, empty where they have none."""
    model = block.text("COLOR_MODEL").lower()
    none = np.zeros(0)
    if model == "monochrome":
        return ("monochrome",), none
    if model in ("rgb", "xyz"):
        return tuple(model.upper()), none
    if model != "spectrum":
        raise InputError(
            f"{path}: COLOR_MODEL {printable(model, 40)!r}; "
            "expected monochrome, rgb, xyz or spectrum"
        )
    wavelengths = block.list("WAVELENGTH_LIST")
    return tuple(f"{nm:g} nm" for nm in wavelengths), wavelengths


def _bands(
    path: Path, block: Block, wavelengths: Array, readings: Array, labels: tuple[str, ...]
) -> tuple[Bands, Array, tuple[str, ...]]:
    if len(labels) == 1:
        bands, readings, gray = one_channel(readings, labels[0])
        return bands, readings, (gray,)
    if len(wavelengths):
        try:
            return Bands(tuple(wavelengths.tolist())), readings, ()
        except InputError as error:
            raise InputError(f"{path}: WAVELENGTH_LIST: {error}") from None
    if block.text("COLOR_MODEL").lower() == "xyz":
        readings = srgb_from_xyz(readings)
    return readable_rgb(readings)


def _source(path: Path, block: Block) -> str:
    parts = [path.name, "SSDD file of libbsdf"]
    parts += [block.text("DEVICE"), block.text("SOURCE_TYPE").lower()]
    parts.append(block.text("MEASUREMENT_DATE") or block.text("CREATION_DATE"))
    model = block.text("COLOR_MODEL").lower()
    if model == "rgb":
        parts.append("channels taken as linear sRGB")
    if model == "xyz":
        parts.append("XYZ taken as under D65")
    return ", ".join(part for part in parts if part)


def _grid(path: Path, block: Block, kind: str, channels: int) -> _Grid:
    lists = []
    for k, largest in enumerate(LARGEST_DEG[kind]):
        name = f"PARAM{k}_LIST"
        if k == 1 and not block.text(name):
            angles = np.zeros(1)  # as the specification has it for isotropic data
        else:
            angles = block.list(name)
        if angles.min() < -ROUNDING_DEG or angles.max() > largest + ROUNDING_DEG:
            raise InputError(
                f"{path}: {name} spans {angles.min():g} to {angles.max():g}, expected 0 to "
                f"{largest:g} degrees; correct the angles"
            )
        if (np.diff(angles) <= 0.0).any():
            raise InputError(f"{path}: {name} does not increase; correct the angles")
        lists.append(np.clip(angles, 0.0, largest))
    sizes = tuple(map(len, lists))
    count = math.prod(sizes)
    if count > MAX_DIRECTIONS or count * channels > MAX_NUMBERS:
        raise InputError(
            f"{path}: the table has {' x '.join(map(str, sizes))} directions and {channels} "
            f"channels; at most {MAX_DIRECTIONS} and {MAX_NUMBERS} numbers are read: thin out its "
            "lists"
        )
    return _Grid(tuple(lists), tuple(np.arange(size) for size in sizes), sizes)


def _thinned(grid: _Grid) -> tuple[_Grid, tuple[str, ...]]:
    """The grid with at most MOST_SAMPLES nodes, and a warning where any are left out.

    The azimuth about the half-vector or the mirror direction goes first, because a table is
    smoothest along it; then the lamp's azimuth, and then the polar angles.
    """
    places, angles = list(grid.places), list(grid.angles)
    for axis in (3, 1, 0, 2):
        count = math.prod(map(len, places))
        if count <= MOST_SAMPLES:
            break
        size = len(places[axis])
        keep = max(size * MOST_SAMPLES // count, min(size, 5 if axis == 3 else 1))
        chosen = np.unique(np.rint(np.linspace(0, size - 1, keep)).astype(np.int64))
        places[axis], angles[axis] = places[axis][chosen], angles[axis][chosen]
    if all(len(p) == size for p, size in zip(places, grid.sizes, strict=True)):
        return grid, ()
    kept = " x ".join(map(str, map(len, places)))
    return _Grid(tuple(angles), tuple(places), grid.sizes), (
        f"the table has {' x '.join(map(str, grid.sizes))} directions; {kept} of them, evenly "
        "spread, are read",
    )


def _distinct(columns: tuple[Array, ...], readings: Array) -> Ints:
    """Places of the nodes without those that repeat one: azimuths about a pole, and 360 degrees.

    Repetitions whose readings differ are kept, and reported as contradictions.
    """
    theta_0, phi_1, theta_2, phi_3 = columns
    turn_3 = np.where(theta_2 == 0.0, 0.0, phi_3 % 360.0)
    keys = np.stack([theta_0, phi_1 % 360.0, theta_2, turn_3], axis=1)
    order = np.lexsort(keys.T)
    before, behind = order[:-1], order[1:]
    repeats = (keys[before] == keys[behind]).all(axis=1)
    repeats[repeats] = (readings[before[repeats]] == readings[behind[repeats]]).all(axis=1)
    kept = np.full(len(keys), True)
    kept[behind[repeats]] = False
    return np.flatnonzero(kept)


def _turned(grid: _Grid) -> tuple[str, ...]:
    azimuths = len(np.unique(grid.angles[1] % 360.0))
    if azimuths == 1:
        return ()
    return (
        f"the table has {azimuths} azimuths of the sample: they are fitted together, as of an "
        "isotropic material",
    )


def _directions(
    path: Path, block: Block, kind: str, columns: tuple[Array, ...]
) -> tuple[Array, Array]:
    """Unit vectors to lamp and receiver, (N, 3) each, of the four angles, (N,) each."""
    angle_0, angle_1, angle_2, angle_3 = columns
    if kind == HALF_DIFFERENCE:
        return half_difference.to_directions(angle_0, angle_1, angle_2, angle_3)
    lamp = spherical(angle_0, angle_1)
    if kind == SPHERICAL:
        return lamp, spherical(angle_2, angle_3)
    mirror = angle_0
    if block.text("PARAM4_LIST"):
        offsets, tabulated = block.list("PARAM4_LIST"), block.list("PARAM0_LIST")
        if len(offsets) != len(tabulated):
            raise InputError(
                f"{path}: PARAM4_LIST has {len(offsets)} offsets for {len(tabulated)} polar angles "
                "of PARAM0_LIST; give one for each"
            )
        if np.abs(offsets).max() > 90.0 + ROUNDING_DEG:
            raise InputError(f"{path}: PARAM4_LIST: an offset beyond 90 degrees; correct it")
        mirror = angle_0 + np.interp(angle_0, np.clip(tabulated, 0.0, 90.0), offsets)
    tilt, turn = np.radians(mirror), np.radians(angle_1)
    about = spherical(angle_2, angle_3)  # in the mirror direction's frame
    x = np.cos(tilt) * about[:, 0] - np.sin(tilt) * about[:, 2]
    z = np.sin(tilt) * about[:, 0] + np.cos(tilt) * about[:, 2]
    receiver = np.stack(
        [
            np.cos(turn) * x - np.sin(turn) * about[:, 1],
            np.sin(turn) * x + np.cos(turn) * about[:, 1],
            z,
        ],
        axis=1,
    )
    return lamp, receiver
