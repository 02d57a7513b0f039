"""What lies under a pixel of a pack's picture: the place on its label, finishes, colours."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.material.cielab import lab_from_xyz
from relgloss_view.pack.label import label_of
from relgloss_view.pack.pack import Pack
from relgloss_view.picture.model.sight import meet_view, sight
from relgloss_view.picture.model.surface import surface_of
from relgloss_view.picture.model.view import Size, View
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.viewer.state.packs import Mm, artwork_place

Lab = tuple[float, float, float]


@dataclass(frozen=True)
class Picked:
    """A point of a pack.

    label_mm: to the right and up from the label's centre. part: of the form. shares: of the
    specular part by the name of the finish, largest first; they sum to 1. plates: the value of each
    plate there, 0 to 1. artwork_mm: from the artwork's centre; None where the part has no artwork
    on it. lab: of the artwork under D50; None where nothing is printed.
    """

    label_mm: Mm
    part: str
    shares: dict[str, float]
    plates: dict[str, float]
    artwork_mm: Mm | None = None
    lab: Lab | None = None

    @property
    def finish(self) -> str:
        """The name of the finish with the largest share."""
        return next(iter(self.shares))


def label_place(scene: Scene, size: Size, at: tuple[float, float]) -> tuple[Mm, int] | None:
    """The place on the label, mm, and the number of the part under a place of a picture.

    at: pixels from the left and from the top, fractional. None off the object.
    """
    view = View.of(scene, size)
    columns, rows = (np.array([value - 0.5]) for value in at)
    hit = meet_view(scene.shape, view, columns, rows)
    if not hit.found[0]:
        return None
    x, y = (1e3 * float(value) for value in hit.surface_m[0])
    return (x, y), int(hit.face[0])


def pick(scene: Scene, size: Size, at: tuple[float, float]) -> Picked | None:
    """What lies at a place of a pack's picture; None off the object. Raises InputError."""
    pack = scene.pack
    if pack is None:
        return None
    view = View.of(scene, size)
    columns, rows = (np.array([value - 0.5]) for value in at)
    seen = sight(scene.shape, view, columns, rows)
    hit = seen.hit
    if not hit.found[0]:
        return None
    surface = surface_of(pack, view, seen)
    names = [finish.name for finish in pack.finishes]
    shares = np.asarray(surface.specular_shares, dtype=np.float64)[0]
    ordered = sorted(zip(names, shares.tolist(), strict=True), key=lambda one: -one[1])
    x, y = (1e3 * float(value) for value in hit.surface_m[0])
    label, face = label_of(scene.shape), int(hit.face[0])
    paint = np.asarray(surface.paint, dtype=np.float64)[0]
    place = None
    if label.printed[face] and pack.artwork is not None:
        girth = 1e3 * label.size_m[0] if label.around else None
        place = nearest_artwork_place(pack, (x, y), girth)
    return Picked(
        (x, y),
        label.parts[face],
        dict(ordered),
        {} if place is None else plate_values(pack, place),
        place,
        _lab(paint),
    )


def nearest_artwork_place(pack: Pack, label_mm: Mm, girth_mm: float | None) -> Mm:
    """The place on the artwork; around a form, that of the copy which is nearest."""
    if girth_mm:
        offset = pack.placement.offset_x_mm
        turns = round((label_mm[0] - offset) / girth_mm)
        label_mm = label_mm[0] - girth_mm * turns, label_mm[1]
    return artwork_place(pack.placement, label_mm)


def plate_values(pack: Pack, place_mm: Mm) -> dict[str, float]:
    """The value of each plate of the artwork at a place of it, 0 to 1; none outside."""
    artwork = pack.artwork
    if artwork is None:
        return {}
    width, height = artwork.size_px
    column = int(np.floor((place_mm[0] / artwork.width_mm + 0.5) * width))
    row = int(np.floor((0.5 - place_mm[1] / artwork.height_mm) * height))
    if not (0 <= column < width and 0 <= row < height):
        return {}
    return {name: float(plate[row, column]) / 255.0 for name, plate in artwork.plates.items()}


def _lab(paint: Array) -> Lab | None:
    """Lab under D50 of premultiplied paint; None where hardly anything is printed."""
    from relgloss_view.base.icc.profile import D50

    if paint[3] < 0.5 / 255.0:
        return None
    lightness, a, b = (float(v) for v in lab_from_xyz(paint[:3] / paint[3], D50))
    return lightness, a, b
