"""Carry a pack: its artwork, masks, materials and mesh as files that any program reads exactly.

An artwork may be a PDF of plates, or larger than a page can show. What goes along is its colours as
they are printed, in 8 bits a channel of an RGB space whose profile is in the file, and the masks of
the finishes as gray pictures on the same pixels.
"""

from __future__ import annotations

import base64
import dataclasses
import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import numpy as np

from relgloss_view.base.arrays import AnyArray, Array, Bytes, Floats
from relgloss_view.base.errors import InputError
from relgloss_view.base.icc.profile import D50, Profile, read_profile
from relgloss_view.base.interruptions import checkpoint
from relgloss_view.base.json_files import parse_json
from relgloss_view.base.reading import named, read_bytes
from relgloss_view.base.terminal import ProgressReport, no_progress
from relgloss_view.display.display import Display
from relgloss_view.display.icc_writing import profile_of
from relgloss_view.material.cielab import lab_from_xyz
from relgloss_view.material.difference import delta_e_2000
from relgloss_view.material.files import save_material
from relgloss_view.material.material import Material
from relgloss_view.pack.artwork.artwork import Artwork
from relgloss_view.pack.artwork.raster import MM_PER_INCH, area_means
from relgloss_view.pack.finish import Finish
from relgloss_view.pack.layers import layers_of, resampled_mask
from relgloss_view.pack.masks import ARTWORK, EVERYWHERE, PART, mask_of
from relgloss_view.pack.measured import AT_45_0, lobes_in_artwork
from relgloss_view.pack.pack import MEASURED, Pack
from relgloss_view.pack.pack_file import read_pack, write_pack
from relgloss_view.picture.model.tone import srgb_encode

#: Spaces of carried artwork, from the smallest; all have sRGB's curve, of fine steps in the dark.
SPACES: dict[str, tuple[tuple[float, float], ...]] = {
    "sRGB": Display().primaries_xy,
    "Display P3": ((0.680, 0.320), (0.265, 0.690), (0.150, 0.060)),
    "Adobe RGB's primaries": ((0.64, 0.33), (0.21, 0.71), (0.15, 0.06)),
    "Rec. 2020's primaries": ((0.708, 0.292), (0.170, 0.797), (0.131, 0.046)),
}
#: Linear light beyond a space that counts as inside it: the half floats of an artwork are as rough.
NEARLY = 1e-3
MATERIALS = "materials"  #: the folder of material files, within that of the others
ROWS = 64  #: that are coded together
BODY, _ = MEASURED
MOST_MESH_BYTES = 16 << 20
_SAME_SHAPE = 1e-4  #: of height over width, as pixels and as millimetres


@dataclass(frozen=True)
class Rounding:
    """What 8 bits change of an artwork's colours: dE2000 under D50, where anything is printed."""

    largest: float = 0.0
    mean: float = 0.0
    clipped: float = 0.0  #: share of the pixels whose colour the space does not hold


@dataclass(frozen=True)
class Coded:
    """An artwork in 8 bits. rgba: (H, W, 3 or 4). icc: the profile of its space."""

    rgba: Bytes
    icc: bytes
    space: str
    rounding: Rounding = field(default_factory=Rounding)


def carried_pack(
    pack: Pack,
    folder: Path,
    side: str,
    most_px: int,
    progress: ProgressReport = no_progress,
) -> tuple[Pack, tuple[str, ...]]:
    """A pack whose artwork, masks, materials and mesh lie in a folder, and notes of what changed.

    side: begins the files' names. most_px: of the artwork's longer side; a larger one is scaled
    down by areas in linear light. Colours that were measured 45/0 become those of the print's body.
    Raises InputError where a file can't be read.
    """
    notes: list[str] = []
    shape = pack.shape
    if shape.file:
        shape = dataclasses.replace(shape, file=carried_mesh(shape.file, folder, f"{side}-form"))
    small = _scaled(pack, most_px, notes)
    finishes, masks = _finishes(small, folder, side, most_px)
    entries: dict[str, Any] = {"artwork": None, "artwork_file": "", "artwork_entries": ()}
    if small.artwork is not None:
        progress(0.3, "coding the artwork")
        file = folder / f"{side}-artwork.png"
        coded = _coded(small, notes)
        _write(file, coded.rgba, small.artwork, coded.icc)
        entries = {
            "artwork": dataclasses.replace(small.artwork, file=str(file), plates={}),
            "artwork_file": file.name,
            "artwork_entries": (("width_mm", small.artwork.width_mm), ("intent", "relative")),
        }
    entries |= {"shape": shape, "finishes": finishes, "masks": masks}
    carried = dataclasses.replace(pack, file="", measured=BODY, notes=(), **entries)
    # As a file of its own: masks are named from the folder of the pack's file.
    own = folder / f"{side}-pack.toml"
    write_pack(own, carried)
    return read_pack(own), tuple(notes)


def put_material(material: Material, folder: Path, stem: str) -> str:
    """Write a material among the files; its path."""
    file = folder / MATERIALS / f"{stem}.json"
    save_material(material, file)
    return str(file)


def _scaled(pack: Pack, most_px: int, notes: list[str]) -> Pack:
    """The pack with an artwork of at most so many pixels, its plates on the same ones."""
    artwork = pack.artwork
    if artwork is None or max(artwork.size_px) <= most_px:
        return pack
    width, height = artwork.size_px
    share = most_px / max(width, height)
    columns, rows = max(round(width * share), 1), max(round(height * share), 1)
    notes.append(
        f"The artwork of {width} x {height} pixels goes along with {columns} x {rows}; "
        "--artwork-px sets how many."
    )
    edges = np.linspace(0.0, height, rows + 1)

    def reduced(values: AnyArray) -> Floats:
        checkpoint()
        made = np.empty((rows, columns, *values.shape[2:]), np.float32)
        for first in range(0, rows, ROWS):
            last = min(first + ROWS, rows)
            top, bottom = int(edges[first]), min(int(np.ceil(edges[last])), height)
            part = values[top:bottom].astype(np.float32)
            made[first:last] = area_means(part, edges[first : last + 1] - top, columns)
        return made

    small = dataclasses.replace(
        artwork,
        xyz=reduced(artwork.xyz).astype(np.float16),
        alpha=None if artwork.alpha is None else reduced(artwork.alpha).astype(np.float16),
        plates={
            name: np.rint(reduced(plate)).astype(np.uint8) for name, plate in artwork.plates.items()
        },
    )
    return dataclasses.replace(pack, artwork=small)


def _finishes(
    pack: Pack, folder: Path, side: str, most_px: int
) -> tuple[tuple[Finish, ...], dict[str, Bytes]]:
    """The finishes with materials and masks in the folder, and the masks by their files."""
    size = _mask_size(pack, most_px)
    files: dict[tuple[tuple[int, ...], bytes], str] = {}
    masks: dict[str, Bytes] = {}
    finishes = []
    for k, finish in enumerate(pack.finishes, start=1):
        source = put_material(finish.material, folder, f"{side}-finish-{k}")
        mask = finish.mask
        if mask not in ("", ARTWORK, EVERYWHERE) and not mask.startswith(PART):
            found = mask_of(pack, dataclasses.replace(finish, invert=False))
            values = np.ascontiguousarray(
                found.values if size is None else resampled_mask(found.values, size)
            )
            key = (values.shape, values.tobytes())
            if key not in files:
                file = folder / f"{side}-mask-{len(files) + 1}.png"
                _write(file, values)
                files[key] = str(file)
            mask = files[key]
            masks[mask] = values
        finishes.append(dataclasses.replace(finish, source=source, mask=mask))
    return tuple(finishes), masks


def _mask_size(pack: Pack, most_px: int) -> tuple[int, int] | None:
    """Rows and columns of carried masks: the artwork's; None for each its own."""
    if pack.artwork is not None:
        width, height = pack.artwork.size_px
        return height, width
    if not pack.masks:
        return None
    height = max(mask.shape[0] for mask in pack.masks.values())
    width = max(mask.shape[1] for mask in pack.masks.values())
    if max(height, width) <= most_px:
        return None
    share = most_px / max(height, width)
    return max(round(height * share), 1), max(round(width * share), 1)


def _coded(pack: Pack, notes: list[str]) -> Coded:
    """The artwork in 8 bits, with the notes that belong to it."""
    if lobes_in_artwork(pack) is not None:
        notes.append(
            "The artwork's colours were measured 45/0 on the finished surface; they go along as "
            "those of the print's body, so the pictures stay the same."
        )
    elif pack.measured == AT_45_0:
        notes.append("The artwork's colours hold no lobes, so they go along as the body's.")
    coded = coded_paint(
        layers_of(pack).paint, pack.artwork is not None and _has_alpha(pack.artwork)
    )
    rounding = coded.rounding
    words = (
        f"The artwork's colours go along in 8 bits of {coded.space}: dE2000 of the rounding "
        f"{rounding.mean:.2f} on average, {rounding.largest:.2f} at most"
    )
    if rounding.clipped:
        words += f"; {100.0 * rounding.clipped:.2g} % of the pixels lie outside that space"
    notes.append(words + ".")
    return coded


def _has_alpha(artwork: Artwork) -> bool:
    return artwork.alpha is not None


def coded_paint(paint: Floats, has_alpha: bool) -> Coded:
    """Colours as 8 bits of the smallest of SPACES that holds them all, else of the largest.

    paint: (H, W, 4), XYZ under D50 times alpha, and alpha.
    """
    spaces = [(name, _profile(name)) for name in SPACES]
    inverses = [np.linalg.inv(_matrix(profile)) for _, (_, profile) in spaces]
    first = 0
    for strip in _strips(paint):
        xyz, _ = _plain(strip)
        while first < len(spaces) - 1 and _outside(xyz @ inverses[first].T).any():
            first += 1
    name, (icc, profile) = spaces[first]
    rgba = np.empty((*paint.shape[:2], 4 if has_alpha else 3), np.uint8)
    largest, total, printed, clipped = 0.0, 0.0, 0, 0
    for k, strip in enumerate(_strips(paint)):
        checkpoint()
        xyz, alpha = _plain(strip)
        light = xyz @ inverses[first].T
        rgb = np.rint(255.0 * srgb_encode(np.clip(light, 0.0, 1.0))).astype(np.uint8)
        rows = rgba[k * ROWS : k * ROWS + len(strip)]
        rows[..., :3] = rgb
        if has_alpha:
            rows[..., 3] = np.rint(255.0 * np.clip(alpha, 0.0, 1.0))
        seen = alpha > 0.5 / 255.0
        before = lab_from_xyz(xyz[seen], D50)
        after = lab_from_xyz(decoded(rgb[seen], profile), D50)
        if len(before):
            errors = delta_e_2000(before, after)
            largest, total = max(largest, float(np.max(errors))), total + float(np.sum(errors))
            printed += len(errors)
            clipped += int(np.sum(_outside(light[seen])))
    rounding = Rounding(largest, total / max(printed, 1), clipped / max(printed, 1))
    return Coded(rgba, icc, name, rounding)


def decoded(rgb: Bytes, profile: Profile) -> Array:
    """XYZ under D50, (..., 3), of 8-bit values, by the profile's curves and matrix in float64."""
    values = np.arange(256.0) / 255.0
    tables = [np.asarray(curve(values), np.float64) for curve in profile.curves]
    light = np.stack([table[rgb[..., k]] for k, table in enumerate(tables)], axis=-1)
    return np.asarray(light @ _matrix(profile).T)


def _profile(name: str) -> tuple[bytes, Profile]:
    icc = profile_of(Display(primaries_xy=SPACES[name]))
    return icc, read_profile(icc)


def _matrix(profile: Profile) -> Array:
    assert profile.matrix is not None
    return profile.matrix


def _strips(paint: Floats) -> list[Array]:
    return [paint[k : k + ROWS].astype(np.float64) for k in range(0, len(paint), ROWS)]


def _plain(paint: Array) -> tuple[Array, Array]:
    """XYZ that is not times alpha, black where nothing is printed, and alpha."""
    alpha = paint[..., 3]
    return paint[..., :3] / np.maximum(alpha, 1e-6)[..., None], alpha


def _outside(light: Array) -> Array:
    return np.asarray(((light < -NEARLY) | (light > 1.0 + NEARLY)).any(axis=-1))


def _write(file: Path, values: Bytes, artwork: Artwork | None = None, icc: bytes = b"") -> None:
    """Write 8-bit values as PNG, without anything that names a person or a place."""
    from PIL import Image

    extra: dict[str, Any] = {"icc_profile": icc} if icc else {}
    if artwork is not None:
        height, width = values.shape[:2]
        tall = artwork.height_mm / artwork.width_mm
        if abs(tall * width / height - 1.0) > _SAME_SHAPE:  # pixels that are not square
            across, down = width / artwork.width_mm, height / artwork.height_mm
            extra["dpi"] = (across * MM_PER_INCH, down * MM_PER_INCH)
    Image.fromarray(values).save(file, "PNG", optimize=True, **extra)


def carried_mesh(name: str, folder: Path, stem: str) -> str:
    """A mesh file in the folder, and its path there; a .gltf with its buffers inside.

    Raises InputError where it is too large to be sent.
    """
    source = Path(name)
    suffix = source.suffix.lower()
    expected = f"a mesh of at most {MOST_MESH_BYTES >> 20} MB"
    data = read_bytes(source, MOST_MESH_BYTES, expected)
    if suffix == ".gltf":
        data = _with_buffers(data, source, expected)
    file = folder / f"{stem}{suffix}"
    file.write_bytes(data)
    return str(file)


def _with_buffers(data: bytes, source: Path, expected: str) -> bytes:
    """The JSON of a .gltf with the files that it names inside, and without pictures."""
    content = parse_json(data.decode("utf-8-sig"))
    for buffer in content.get("buffers", []):
        uri = buffer.get("uri", "")
        if uri and uri[:5].lower() != "data:":
            held = read_bytes(source.parent / unquote(uri), MOST_MESH_BYTES, expected)
            coded = base64.b64encode(held).decode("ascii")
            buffer["uri"] = f"data:application/octet-stream;base64,{coded}"
    for entry in ("images", "textures", "samplers"):
        content.pop(entry, None)
    written = json.dumps(content, separators=(",", ":")).encode("utf-8")
    if len(written) > MOST_MESH_BYTES:
        raise InputError(f"{named(source)}: larger than {MOST_MESH_BYTES} bytes; give {expected}")
    return written
