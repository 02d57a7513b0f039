"""The pictures of a pack's glTF materials: what is printed, and the factors of the finishes.

Each texel of the label is filtered as the program's own pictures filter a pixel of that size, so
seams, turns and offsets of the artwork are the same. Factors are means by the shares of the
finishes; where one finish lies alone, as nearly everywhere, that is exact.
"""

from __future__ import annotations

import io
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from relgloss_view.base.arrays import Array, Bytes, Ints
from relgloss_view.base.interruptions import checkpoint
from relgloss_view.base.room import Need, check_room
from relgloss_view.exchange.gltf_brdf import GltfSurface
from relgloss_view.exchange.refit import linear_rgb
from relgloss_view.material.cielab import srgb_decoded, srgb_encoded
from relgloss_view.material.material import Material
from relgloss_view.pack.label import Label
from relgloss_view.pack.layers import Layers, layers_of
from relgloss_view.pack.pack import Pack
from relgloss_view.pack.paint import paint_from_rgb
from relgloss_view.picture.model.surface import ArtworkPlace, printed_at

TEXELS_AT_ONCE = 1 << 18
#: A picture of what is printed becomes a JPEG where its PNG is larger.
MOST_PNG_BYTES = 4 * 1024 * 1024
JPEG_QUALITY = 95
#: Scales among which the one is taken that puts all values nearest to steps of 1/255.
SCALES = 400
LEAST_SHARE = 0.5 / 255.0
#: Where the label's texels are this near to the artwork's, the artwork is taken as it is.
SAME_TEXEL = 0.5
#: Colours that are further than this outside sRGB are counted, in linear light.
OUTSIDE = 0.002

#: The factors of a surface that are one number each.
SCALARS = ("roughness", "metallic", "specular", "clearcoat", "clearcoat_roughness")


@dataclass(frozen=True)
class Maps:
    """The pictures of one group of parts, as 8-bit arrays (H, W, C) that share their size.

    colour: sRGB, (H, W, 3); None where it is the same everywhere, as `surface` states it.
    values: by factor, (H, W) of 0 to 255 that multiply the factor of `surface`; of factors that
    differ between places. tint: (H, W, 3), sRGB, of the specular colour, where that differs.
    surface: the factors. finishes: numbers of those that lie anywhere.
    outside: share of the texels whose colour lies outside sRGB.
    """

    colour: Bytes | None
    values: dict[str, Bytes]
    tint: Bytes | None
    surface: GltfSurface
    finishes: tuple[int, ...]
    outside: float


def texture_size(pack: Pack, label: Label, most_px: int) -> tuple[int, int]:
    """Columns and rows of a picture of the label: as fine as the artwork, at most `most_px`."""
    layers = layers_of(pack)
    width, height = layers.size_px
    scale = pack.placement.scale
    fineness = max(1e3 * width / layers.width_mm, 1e3 * height / layers.height_mm) / scale
    sides = np.array(label.size_m) * fineness
    sides = sides * min(1.0, most_px / float(np.max(sides)))
    columns, rows = (max(1, int(side + 0.5)) for side in sides)
    return columns, rows


def maps_of(
    pack: Pack, label: Label, part: int, surfaces: list[GltfSurface], size: tuple[int, int]
) -> Maps:
    """The pictures of a printed part. surfaces: of the finishes. size: columns and rows.

    Raises InputError where memory is short.
    """
    layers = layers_of(pack)
    check_room(
        Need(size[0] * size[1] * 16.0), "drawing the textures", "ask for smaller ones (--pixels)"
    )
    texels = _Texels(pack, layers, label, part, surfaces, size)
    return texels.maps()


class _Texels:
    def __init__(
        self,
        pack: Pack,
        layers: Layers,
        label: Label,
        part: int,
        surfaces: list[GltfSurface],
        size: tuple[int, int],
    ) -> None:
        self.pack, self.layers, self.label, self.part = pack, layers, label, part
        self.surfaces, self.columns, self.rows = surfaces, *size
        self.metal = np.array([surface.metallic > 0.5 for surface in surfaces])
        self.own = np.array([own_colour(finish.material) for finish in pack.finishes])
        self.facing = np.array([surface.base_color for surface in surfaces])
        self.as_it_is = self._lies_as_it_is()

    def maps(self) -> Maps:
        colour = np.zeros((self.rows, self.columns, 3), dtype=np.uint8)
        shares = np.zeros((self.rows, self.columns, len(self.surfaces)), dtype=np.uint8)
        outside = 0
        step = max(1, TEXELS_AT_ONCE // self.columns)
        for first in range(0, self.rows, step):
            checkpoint()
            rows = np.arange(first, min(first + step, self.rows))
            linear, specular = self._strip(rows)
            outside += int(np.sum(np.any((linear < -OUTSIDE) | (linear > 1.0 + OUTSIDE), -1)))
            colour[rows] = encoded(linear).reshape(len(rows), self.columns, 3)
            shares[rows] = np.rint(255.0 * specular).reshape(len(rows), self.columns, -1)
        present = tuple(k for k in range(len(self.surfaces)) if np.any(shares[..., k] > 0))
        values: dict[str, Bytes] = {}
        factors: dict[str, Any] = {}
        for name in SCALARS:
            of_finish = self._values(name, present)
            factors[name] = float(of_finish[present[0]])
            if np.ptp(of_finish[list(present)]) > 0.0:
                factors[name] = scale_of(of_finish[list(present)])
                values[name] = _mixed(shares, of_finish / factors[name])
        tints = np.array([surface.specular_color for surface in self.surfaces])
        tint = None
        factors["specular_color"] = self.surfaces[present[0]].specular_color
        if np.ptp(tints[list(present)], axis=0).max() > 0.0:
            most = float(tints[list(present)].max())
            factors["specular_color"] = (most, most, most)
            mixed = np.stack([_mixed(shares, tints[:, k] / most) for k in range(3)], axis=-1)
            tint = encoded(mixed / 255.0)
        one = bool(np.all(colour == colour[0, 0]))
        base = linear_of(colour[0, 0]) if one else (1.0, 1.0, 1.0)
        surface = GltfSurface(base_color=base, **factors)
        return Maps(
            None if one else colour,
            values,
            tint,
            surface,
            present,
            outside / (self.rows * self.columns),
        )

    def _strip(self, rows: Ints) -> tuple[Array, Array]:
        """Base colour in linear sRGB (N, 3), and specular shares (N, F), of rows of texels."""
        if self.as_it_is:
            paint = self.layers.paint[rows].reshape(-1, 4).astype(np.float64)
            channels = self.layers.channels[rows].reshape(len(paint), -1) / 255.0
            specular, diffuse = self.layers.shares(channels)
        else:
            paint, specular, diffuse = self._filtered(rows)
        return self._coloured(paint, specular, diffuse), specular

    def _lies_as_it_is(self) -> bool:
        """Whether the label's texels are those of the artwork, so that nothing is filtered."""
        covered = max(self.layers.part_finish[self.part], self.layers.part_diffuse[self.part])
        if covered >= 0 or (self.columns, self.rows) != self.layers.size_px:
            return False
        place = ArtworkPlace.of(self.pack.placement, self.layers, self.label)
        width, height = self.label.size_m
        size = np.array([self.columns, self.rows], dtype=np.float64)
        # Of the outermost texels: the whole turns of a label that goes around are no matter.
        inside = 0.5 - 0.5 / size
        signs = np.array([(-1.0, 1.0), (1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)])
        corners = place.of_label(signs * inside * (width, height))
        expected = 0.5 + signs * inside * (1.0, -1.0)
        return bool(np.all(np.abs(corners - expected) * size <= SAME_TEXEL))

    def _filtered(self, rows: Ints) -> tuple[Array, Array, Array]:
        """Paint (N, 4), specular and diffuse shares (N, F) each, as a picture's pixels see them."""
        width, height = self.label.size_m
        x = ((np.arange(self.columns) + 0.5) / self.columns - 0.5) * width
        y = (0.5 - (rows + 0.5) / self.rows) * height
        label_m = np.stack(np.broadcast_arrays(x, y[:, None]), axis=-1).reshape(-1, 2)
        right = np.broadcast_to([width / self.columns, 0.0], label_m.shape)
        down = np.broadcast_to([0.0, -height / self.rows], label_m.shape)
        part = np.full(len(label_m), self.part)
        paint, (specular, diffuse) = printed_at(
            self.pack, self.layers, self.label, part, label_m, (right, down)
        )
        return paint, specular, diffuse

    def _coloured(self, paint: Array, specular: Array, diffuse: Array) -> Array:
        """Base colours (N, 3), linear sRGB: of metals their F0, of others the body."""
        printed = paint[:, :3] @ _rgb_from_paint().T + (1.0 - paint[:, 3:]) * self.own[0]
        body = np.zeros((len(paint), 3))
        # A metal's diffuse part lies open only where something else has its lobes.
        shown = np.where(self.metal, np.maximum(diffuse - specular, 0.0), diffuse)
        for k, finish in enumerate(self.pack.finishes):
            its = self.own[k] if finish.kind in ("stock", "foil") else printed
            if self.pack.artwork is None and k == 0:
                its = self.own[0]
            body += shown[:, k, None] * its
        total = np.sum(shown, axis=1)
        metals = specular * self.metal
        metallic = np.sum(metals, axis=1)
        facing = metals @ self.facing
        open_body = np.where(total > LEAST_SHARE, (1.0 - metallic) / np.maximum(total, 1e-9), 0.0)
        linear = facing + open_body[:, None] * body
        covered = metallic + np.where(total > LEAST_SHARE, 1.0 - metallic, 0.0)
        return np.asarray(linear / np.maximum(covered, 1e-9)[:, None])

    def _values(self, name: str, present: tuple[int, ...]) -> Array:
        """A factor of each finish; of a coat that is not there, the other coats' roughness."""
        values = np.array([float(getattr(surface, name)) for surface in self.surfaces])
        if name == "clearcoat_roughness":
            coats = np.array([surface.clearcoat for surface in self.surfaces])
            lying = [k for k in present if coats[k] > 0.0]
            if lying:
                values[coats == 0.0] = values[max(lying, key=lambda k: float(coats[k]))]
        return values


def own_colour(material: Material) -> Array:
    """Linear sRGB (3,) of a material's albedo under D65."""
    return linear_rgb(np.asarray(material.diffuse.albedo), material)


def scale_of(values: Array) -> float:
    """The factor, at most 1, with which values become steps of 1/255 of it with the least error.

    >>> scale = scale_of(np.array([0.121, 0.4]))
    >>> steps = np.rint(255.0 * np.array([0.121, 0.4]) / scale)
    >>> bool(np.all(np.abs(steps * scale / 255.0 / [0.121, 0.4] - 1.0) < 0.003))
    True
    """
    values = values[values > 0.0]
    largest = float(np.max(values))
    scales = largest * np.linspace(1.0, max(1.0, min(1.0 / largest, 2.0)), SCALES)
    steps = np.maximum(np.rint(255.0 * values / scales[:, None]), 1.0)
    error = np.max(np.abs(steps * scales[:, None] / 255.0 / values - 1.0), axis=1)
    return float(scales[np.argmin(error)])


def _mixed(shares: Bytes, of_finish: Array) -> Bytes:
    """Means (H, W) of values of the finishes by their shares, 0 to 1 becoming 0 to 255."""
    total = np.zeros(shares.shape[:2], dtype=np.float32)
    weight = np.zeros(shares.shape[:2], dtype=np.float32)
    for k, value in enumerate(of_finish):
        total += shares[..., k] * np.float32(value)
        weight += shares[..., k]
    mean = total / np.maximum(weight, np.float32(1.0))
    return np.rint(255.0 * np.clip(mean, 0.0, 1.0)).astype(np.uint8)


@lru_cache(maxsize=1)
def _rgb_from_paint() -> Array:
    return np.asarray(np.linalg.inv(paint_from_rgb()))


@lru_cache(maxsize=1)
def _curve() -> Bytes:
    return np.rint(255.0 * srgb_encoded(np.arange(65536) / 65535.0)).astype(np.uint8)


def encoded(linear: Array) -> Bytes:
    """sRGB of 8 bits of linear values 0 to 1; what lies outside is cut."""
    return _curve()[np.rint(65535.0 * np.clip(linear, 0.0, 1.0)).astype(np.uint16)]


def linear_of(value: Bytes) -> tuple[float, float, float]:
    """Linear values of an sRGB colour of 8 bits (3,)."""
    red, green, blue = (float(v) for v in srgb_decoded(value / 255.0))
    return red, green, blue


def image_file(picture: Bytes, *, may_be_jpeg: bool = False) -> bytes:
    """A PNG of 8-bit channels (H, W, 3 or 4); a JPEG of colours whose PNG would be large."""
    from PIL import Image

    image = Image.fromarray(np.ascontiguousarray(picture))
    file = io.BytesIO()
    image.save(file, "PNG", compress_level=6)
    if may_be_jpeg and file.tell() > MOST_PNG_BYTES:
        file = io.BytesIO()
        image.save(file, "JPEG", quality=JPEG_QUALITY, subsampling=0, optimize=True)
    return file.getvalue()
