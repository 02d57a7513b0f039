"""Check of a pack before anyone looks at it: plates, masks, overlaps, resolution, size, colours."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from relgloss_view.base.arrays import Array, Bytes
from relgloss_view.base.errors import InputError
from relgloss_view.base.icc.profile import D50
from relgloss_view.base.reading import printable, read_beginning
from relgloss_view.material.spectra import D65_XY, SRGB_PRIMARIES_XY, rgb_to_xyz_matrix
from relgloss_view.pack.artwork.artwork import REPAIRED
from relgloss_view.pack.label import SAME_GIRTH, label_of
from relgloss_view.pack.layers import layers_of
from relgloss_view.pack.masks import CHANNEL, PART, PLATE, mask_of, plate_of
from relgloss_view.pack.pack import Pack
from relgloss_view.pack.quick import plates_without_finish

EMPTY = 1e-4  #: a mask that covers less of the artwork is empty
OVERLAP = 1e-3  #: of the artwork, that is worth a line
SHORT_MM = 1.0  #: that the artwork may lack at an edge of the label
GAMUT = 1e-3  #: linear light by which a colour may leave 0 to 1
MANY_OUTSIDE = 0.02  #: of the artwork, that is worth a line
MOST_TEXELS = 1 << 20  #: that the shares are taken of


@dataclass(frozen=True)
class PlateCheck:
    """A plate of the artwork: its share of the area, and the finishes that are tied to it.

    coloured: it is an ink, whose colour the artwork shows.
    """

    name: str
    coverage: float
    finishes: tuple[str, ...]
    coloured: bool = False


@dataclass(frozen=True)
class FinishCheck:
    """A finish: the share of the artwork that its mask covers, and that its lobes are seen on.

    Both are None of a finish that lies on a part of the form alone.
    """

    name: str
    kind: str
    material: str
    mask: str
    coverage: float | None
    visible: float | None


@dataclass(frozen=True)
class PackCheck:
    """What a check found; shares are of the artwork's area, 0 to 1, sizes in millimetres."""

    name: str
    form: str
    parts: tuple[tuple[str, bool], ...]
    label_mm: tuple[float, float]
    artwork: str
    artwork_mm: tuple[float, float] | None
    artwork_px: tuple[int, int] | None
    artwork_px_per_mm: float | None
    picture_px_per_mm: float
    plates: tuple[PlateCheck, ...]
    finishes: tuple[FinishCheck, ...]
    overlaps: tuple[tuple[str, str, float], ...]
    outside_srgb: float | None
    missing_fonts: tuple[str, ...]
    notes: tuple[str, ...]
    warnings: tuple[str, ...]

    def as_json(self) -> dict[str, Any]:
        """The check as values for JSON."""
        return asdict(self)


def check_pack(pack: Pack, picture_px_per_mm: float) -> PackCheck:
    """Look a pack over: plates, masks, overlaps, resolution, size and colours.

    picture_px_per_mm: of the picture where the object is nearest to the eye. Raises InputError
    where a part of the pack can't be read.

    >>> from relgloss_view.pack.quick import quick_pack
    >>> from PIL import Image
    >>> Image.new("RGB", (40, 20), "white").save("label.png")
    >>> check_pack(quick_pack("label.png", given={"width_mm": 207.3}), 4.0).warnings[-1][:44]
    'The artwork has 0.193 pixels per mm and the '
    """
    layers = layers_of(pack)
    label = label_of(pack.shape)
    label_mm = (1e3 * label.size_m[0], 1e3 * label.size_m[1])
    paint, channels = next(
        (level for level in layers.levels if level[0].shape[0] * level[0].shape[1] <= MOST_TEXELS),
        layers.levels[-1],
    )
    visible = np.mean(layers.shares(channels / 255.0)[0], axis=(0, 1))
    artwork = pack.artwork
    warnings: list[str] = []
    finishes = _finishes(pack, visible, warnings)
    plates = _plates(pack, warnings)
    overlaps = _overlaps(pack)
    outside = None
    density = None
    fonts: tuple[str, ...] = ()
    if artwork is not None:
        outside = outside_srgb(paint[..., :3].astype(np.float64), paint[..., 3].astype(np.float64))
        density = artwork.size_px[0] / (artwork.width_mm * pack.placement.scale)
        fonts = _fonts(pack)
        warnings += [REPAIRED] if REPAIRED in artwork.notes else []
        if any(label.printed):
            warnings += _sizes(pack, label_mm, label.around)
        else:
            warnings.append(
                "The mesh has no texture coordinates, so the artwork is not seen; unwrap it in the "
                "program that made it (UV), and export it again."
            )
        if density < picture_px_per_mm:
            warnings.append(
                f"The artwork has {density:.3g} pixels per mm and the picture "
                f"{picture_px_per_mm:.3g}, so it looks soft; give an artwork of more pixels, or a "
                "smaller --size."
            )
        if outside > MANY_OUTSIDE:
            warnings.append(
                f"{_percent(outside)} of the artwork has colours that an sRGB display can't show; "
                "they are drawn as the nearest that it can."
            )
    if fonts:
        names = printable(", ".join(fonts), 120)
        warnings.append(f"Fonts that are not embedded in the PDF: {names}; outline the text.")
    notes = (*pack.notes, *(() if artwork is None else artwork.notes), *layers.notes)
    return PackCheck(
        pack.name,
        pack.shape.kind,
        tuple(zip(label.parts, label.printed, strict=True)),
        label_mm,
        "" if artwork is None else artwork.file,
        None if artwork is None else (artwork.width_mm, artwork.height_mm),
        None if artwork is None else artwork.size_px,
        density,
        picture_px_per_mm,
        plates,
        finishes,
        overlaps,
        outside,
        fonts,
        tuple(note for note in notes if note != REPAIRED),
        tuple(warnings),
    )


def _finishes(pack: Pack, visible: Array, warnings: list[str]) -> tuple[FinishCheck, ...]:
    made = []
    for k, finish in enumerate(pack.finishes):
        on_part = finish.mask.startswith(PART)
        coverage = None if on_part else float(np.mean(mask_of(pack, finish).values) / 255.0)
        source = finish.source or finish.material.name
        seen = None if on_part else float(visible[k])
        made.append(FinishCheck(finish.name, finish.kind, source, finish.mask, coverage, seen))
        shown = printable(finish.name, 40)
        if coverage is not None and coverage < EMPTY:
            warnings.append(f"The mask of finish {shown!r} is empty, so the finish lies nowhere.")
        elif seen is not None and seen < EMPTY:
            warnings.append(f"Finish {shown!r} is covered by finishes above it everywhere.")
    return tuple(made)


def _plates(pack: Pack, warnings: list[str]) -> tuple[PlateCheck, ...]:
    if pack.artwork is None:
        return ()
    users: dict[int, list[str]] = {}
    for finish in pack.finishes:
        for prefix in (PLATE, CHANNEL):
            if finish.mask.startswith(prefix):
                plate = plate_of(pack, finish.mask.removeprefix(prefix), "")
                users.setdefault(id(plate), []).append(finish.name)
    plates = tuple(
        PlateCheck(
            name,
            float(np.mean(values) / 255.0),
            tuple(users.get(id(values), ())),
            name in pack.artwork.coloured,
        )
        for name, values in pack.artwork.plates.items()
    )
    used = (plate.name for plate in plates if plate.finishes)
    unknown, _ = plates_without_finish(pack.artwork, used)
    if unknown:
        names = printable(", ".join(unknown), 120)
        warnings.append(f"No finish is tied to these plates, so they are not drawn: {names}.")
    return plates


def _overlaps(pack: Pack) -> tuple[tuple[str, str, float], ...]:
    """Pairs of finishes above the base whose masks overlap, with the share of the area."""
    masks: list[tuple[str, Bytes]] = [
        (finish.name, mask_of(pack, finish).values)
        for finish in pack.finishes[1:]
        if not finish.mask.startswith(PART)
    ]
    found = []
    for k, (name, mask) in enumerate(masks):
        for other, above in masks[k + 1 :]:
            if mask.shape != above.shape and 1 not in (mask.size, above.size):
                continue  # pictures of other sizes: the layers resample them
            rows = max(mask.shape[0], above.shape[0])
            columns = max(mask.shape[1], above.shape[1])
            total = 0.0
            step = max(1, MOST_TEXELS // columns)
            for first in range(0, rows, step):
                part, over = (
                    one if one.size == 1 else one[first : first + step] for one in (mask, above)
                )
                product = part.astype(np.float32) * over
                height = min(step, rows - first)
                total += float(np.mean(product, dtype=np.float64)) * height * columns
            share = total / (255.0**2 * rows * columns)
            if share > OVERLAP:
                found.append((name, other, share))
    return tuple(found)


def outside_srgb(xyz: Array, alpha: Array) -> float:
    """The share of printed texels whose colour under D50 no sRGB display shows.

    xyz: (h, w, 3), times alpha (h, w). White is the display's white, as in the pictures: XYZ of
    D50 goes to the display's D65 by the ratio of the whites (von Kries in XYZ).
    """
    printed = alpha > 0.5
    if not printed.any():
        return 0.0
    colour = xyz[printed] / alpha[printed][:, None]
    matrix = rgb_to_xyz_matrix(SRGB_PRIMARIES_XY, D65_XY)
    colour = colour / D50 * matrix.sum(axis=1)
    rgb = colour @ np.linalg.inv(matrix).T
    return float(np.mean(np.any((rgb < -GAMUT) | (rgb > 1.0 + GAMUT), axis=-1)))


def placement_notes(pack: Pack) -> tuple[str, ...]:
    """How the artwork's size was chosen, and where it does not fit the label, a sentence each."""
    label = label_of(pack.shape)
    if pack.artwork is None or not any(label.printed):
        return ()
    width_m, height_m = label.size_m
    return (*pack.artwork.notes, *_sizes(pack, (1e3 * width_m, 1e3 * height_m), label.around))


def _sizes(pack: Pack, label_mm: tuple[float, float], around: bool) -> list[str]:
    """Where the artwork is short of the label, or does not meet itself around the form."""
    assert pack.artwork is not None
    scale, turn = pack.placement.scale, math.radians(pack.placement.turn_deg)
    width, height = pack.artwork.width_mm * scale, pack.artwork.height_mm * scale
    across = abs(width * math.cos(turn)) + abs(height * math.sin(turn))
    along = abs(width * math.sin(turn)) + abs(height * math.cos(turn))
    lines = []
    offsets = (pack.placement.offset_x_mm, pack.placement.offset_y_mm)
    names = (("width", across), ("height", along))
    for (word, size), whole, offset in zip(names, label_mm, offsets, strict=True):
        if around and word == "width":
            # A net of sharp edges is longer than the rounded carton, and the seam lies at an edge.
            allowed = SHORT_MM / whole if pack.shape.kind == "carton" else SAME_GIRTH
            if abs(size / whole - 1.0) > allowed:
                more = "overlaps itself" if size > whole else "leaves a gap"
                lines.append(
                    f"The artwork is {size:.4g} mm wide and the label {whole:.4g} mm around, so it "
                    f"{more} at the back."
                )
            continue
        short = 0.5 * whole + abs(offset) - 0.5 * size
        if short > SHORT_MM:
            lines.append(
                f"The artwork is {size:.4g} mm in {word} and the label {whole:.4g} mm, so "
                f"{short:.3g} mm at an edge are not printed."
            )
        elif size > whole + 2.0 * SHORT_MM:
            lines.append(
                f"The artwork is {size:.4g} mm in {word} and the label {whole:.4g} mm: the rest is "
                "bleed, and is not seen."
            )
    return lines


def _fonts(pack: Pack) -> tuple[str, ...]:
    """Names of fonts that a PDF names and does not hold."""
    assert pack.artwork is not None
    if not pack.artwork.file:
        return ()
    try:
        if b"%PDF-" not in read_beginning(pack.artwork.file, 1024, "artwork"):
            return ()
        from relgloss_view.pack.artwork.pdf import missing_fonts

        return missing_fonts(pack.artwork.file, int(dict(pack.artwork_entries).get("page", 1)))
    except InputError:  # the file has gone since it was read
        return ()


def _percent(share: float) -> str:
    return f"{100.0 * share:.3g} %"
