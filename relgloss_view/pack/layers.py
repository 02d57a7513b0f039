"""Layers: artwork and shares of finishes as textures, composed before they are filtered.

"Later lies above": with m_f the mask of finish f, its share of the lobes is w_f = m_f times the
product of (1 - m_g) over the finishes g above it (Porter, Duff 1984, `over`, front to back). Its
share of the diffuse part is the same without varnishes, which have no diffuse part and hide none.
"""

from __future__ import annotations

import threading
import weakref
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from relgloss_view.base.arrays import Array, Bytes
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.base.room import Need, check_room
from relgloss_view.pack.artwork.artwork import Artwork, Halves
from relgloss_view.pack.label import Label, label_of
from relgloss_view.pack.masks import VARNISH, FinishMask, check_masks, mask_of
from relgloss_view.pack.measured import lobes_in_artwork
from relgloss_view.pack.pack import Pack

Singles = npt.NDArray[np.float32]

MOST_CHANNELS = 12
REST, ZERO = -1, -2  #: in place of a channel: what the others leave; nothing anywhere
HELD_ARTWORKS = 3  #: whose layers are kept
HELD = 4  #: layers of one artwork that are kept: both panes, and one step of undo
STRIP_TEXELS = 1 << 20  #: that are composed at a time


@dataclass(frozen=True, eq=False)
class Layers:
    """The textures of a pack. Two layers are equal where they are the same object.

    levels: (paint, channels) of each mip level, level 0 first. paint: (h, w, 4) float16, XYZ under
    D50 times alpha, and alpha. channels: (h, w, C) uint8, C at most MOST_CHANNELS, 255 is 1. Each
    level is half as large as the one before, rounded up, and the last is 1 x 1.
    specular_channel, diffuse_channel: per finish the channel of its share, REST or ZERO; exactly
    one finish takes the rest.
    part_finish, part_diffuse: per part of the form the finish whose lobes, and whose diffuse part,
    cover all of it in place of the channels; -1 where the channels decide. A part that is not
    printed never has -1; there paint is 0.
    outside_finish, outside_diffuse: the same where no artwork is.
    width_mm, height_mm: of the artwork, or of the label where there is none.
    notes: what a user should know of it, one sentence each.
    """

    levels: tuple[tuple[Halves, Bytes], ...]
    specular_channel: tuple[int, ...]
    diffuse_channel: tuple[int, ...]
    part_finish: tuple[int, ...]
    part_diffuse: tuple[int, ...]
    outside_finish: int
    outside_diffuse: int
    width_mm: float
    height_mm: float
    notes: tuple[str, ...] = ()
    #: what the layers were made of, so that no other object takes its identity
    made_of: tuple[object, ...] = ()

    @property
    def paint(self) -> Halves:
        """Colours of level 0, (H, W, 4)."""
        return self.levels[0][0]

    @property
    def channels(self) -> Bytes:
        """Shares of level 0, (H, W, C)."""
        return self.levels[0][1]

    @property
    def size_px(self) -> tuple[int, int]:
        """Width and height of level 0."""
        height, width = self.paint.shape[:2]
        return width, height

    def shares(self, channels: Array) -> tuple[Array, Array]:
        """Specular and diffuse shares (..., F) from values of the channels (..., C), 0 to 1."""
        return (
            _of_channels(channels, self.specular_channel),
            _of_channels(channels, self.diffuse_channel),
        )


def layers_of(pack: Pack) -> Layers:
    """The layers of a pack; the same object until artwork, masks or kinds of finishes change.

    Changes of sigma_N, k or a material keep it, but where the pack's colours were `measured` with
    the lobes in them. Raises InputError where a mask names what is not there, or memory is short.
    """
    label = label_of(pack.shape)
    lobes = lobes_in_artwork(pack)
    size_mm = _size_mm(pack, label)
    key = (
        tuple((f.kind == VARNISH, f.mask, f.invert) for f in pack.finishes),
        tuple((name, id(mask)) for name, mask in sorted(pack.masks.items())),
        (label.parts, label.printed, size_mm),
        None if lobes is None else lobes.tobytes(),
    )
    artwork = _NO_ARTWORK if pack.artwork is None else pack.artwork
    with _LOCK:
        layers = _HELD.get(artwork, {}).get(key)
    if layers is None:
        layers = _made(pack, label, size_mm, lobes)
    with _LOCK:  # another thread may have made the same meanwhile
        held = _HELD.pop(artwork, {})
        layers = held.pop(key, layers)
        held[key] = layers  # the last used one is the last
        while len(held) > HELD:
            del held[next(iter(held))]
        _HELD[artwork] = held
        while len(_HELD) > HELD_ARTWORKS:
            del _HELD[next(iter(_HELD))]
    return layers


class _NoArtwork:
    """Stands for the artwork of packs without one."""


_NO_ARTWORK = _NoArtwork()
_LOCK = threading.Lock()  #: the window composes in a thread, too
_HELD: weakref.WeakKeyDictionary[Artwork | _NoArtwork, dict[Any, Layers]] = (
    weakref.WeakKeyDictionary()
)


def _size_mm(pack: Pack, label: Label) -> tuple[float, float]:
    if pack.artwork is not None:
        return pack.artwork.width_mm, pack.artwork.height_mm
    return 1e3 * label.size_m[0], 1e3 * label.size_m[1]


def _made(pack: Pack, label: Label, size_mm: tuple[float, float], lobes: Array | None) -> Layers:
    check_masks(pack)
    masks = [mask_of(pack, finish) for finish in pack.finishes]
    stack = _Stack(tuple(f.kind == VARNISH for f in pack.finishes), label, masks)
    height, width = _resolution(pack, masks)
    count = len(stack.columns)
    # The levels together, and level 1 in float32 beside them.
    need = width * height * ((8 + count) * 4 / 3 + (16 + 4 * count) / 4)
    check_room(Need(need), "composing the pack's finishes", "use an artwork of fewer pixels")
    base = _level_0(pack, stack, (height, width), lobes)
    return Layers(
        tuple(_levels(base, stack)),
        tuple(stack.specular),
        tuple(stack.diffuse),
        *stack.covers(),
        width_mm=size_mm[0],
        height_mm=size_mm[1],
        notes=stack.notes(pack),
        made_of=tuple(pack.masks.values()),
    )


def _resolution(pack: Pack, masks: Sequence[FinishMask]) -> tuple[int, int]:
    """Rows and columns of level 0: the artwork's, or the largest mask's where there is none."""
    if pack.artwork is not None:
        width, height = pack.artwork.size_px
        return height, width
    shapes = [mask.values.shape for mask in masks]
    return max(shape[0] for shape in shapes), max(shape[1] for shape in shapes)


class _Stack:
    """The order of the finishes: which of them need a channel, and which cover whole parts."""

    def __init__(
        self, varnishes: tuple[bool, ...], label: Label, masks: Sequence[FinishMask]
    ) -> None:
        self.varnishes, self.label = varnishes, label
        printed = [part for part, prints in zip(label.parts, label.printed, strict=True) if prints]
        # A part that is all that is printed is everywhere on the artwork.
        self.masks = [
            mask._replace(values=np.full((1, 1), 255, dtype=np.uint8))
            if mask.part and printed == [mask.part]
            else mask
            for mask in masks
        ]
        self.whole_part = printed[0] if len(printed) == 1 else ""
        #: columns of shares: (finish, whether of the diffuse part), from the top downwards
        self.columns: list[tuple[int, bool]] = []
        self.specular = self._placed(False)
        self.diffuse = self._placed(True)
        if len(self.columns) > MOST_CHANNELS:
            raise InputError(
                f"pack: the masks of its finishes need {len(self.columns)} channels, and there are "
                f"{MOST_CHANNELS}; use fewer finishes, or put the varnish below some of them"
            )

    def _placed(self, diffuse: bool) -> list[int]:
        """The channel of each finish's share, from the topmost downwards."""
        places = [ZERO] * len(self.masks)
        shared = True  # with the specular share, until a varnish lies above
        for k in reversed(range(len(self.masks))):
            if diffuse and self.varnishes[k]:
                shared = shared and self.specular[k] == ZERO
                continue
            values = self.masks[k].values
            if values.shape == (1, 1) and values[0, 0] == 255:
                places[k] = REST
                return places
            if not values.any():
                continue
            if diffuse and shared:
                places[k] = self.specular[k]
            else:
                places[k] = len(self.columns)
                self.columns.append((k, diffuse))
        raise AssertionError("the first finish lies everywhere")

    def groups(self) -> list[list[int]]:
        """Channels whose values add up to at most 1, from the topmost finish downwards."""
        return [[c for c in reversed(places) if c >= 0] for places in (self.specular, self.diffuse)]

    def covers(self) -> tuple[tuple[int, ...], tuple[int, ...], int, int]:
        """part_finish, part_diffuse, outside_finish and outside_diffuse of Layers."""
        finishes, diffuses = [], []
        for part, prints in zip(self.label.parts, self.label.printed, strict=True):
            if not prints:
                finishes.append(self._top(part, False))
                diffuses.append(self._top(part, True))
                continue
            own = [k for k, m in enumerate(self.masks) if m.part == part != self.whole_part]
            finishes.append(own[-1] if own else -1)
            opaque = [k for k in own if not self.varnishes[k]]
            diffuses.append(opaque[-1] if opaque else -1)
        return tuple(finishes), tuple(diffuses), self._top("", False), self._top("", True)

    def _top(self, part: str, diffuse: bool) -> int:
        """The finish on top where no artwork is: on a part, or beside the artwork on the label."""
        top = 0
        for k, mask in enumerate(self.masks):
            inside = bool(part or self.whole_part) and mask.part == (part or self.whole_part)
            if (mask.outside or inside) and not (diffuse and self.varnishes[k]):
                top = k
        return top

    def notes(self, pack: Pack) -> tuple[str, ...]:
        """A finish of one printed part among several hides what lies above it there."""
        notes = []
        for k, mask in enumerate(self.masks[:-1]):
            prints = mask.part in [
                p for p, y in zip(self.label.parts, self.label.printed, strict=True) if y
            ]
            above = [f.name for f, m in zip(pack.finishes, self.masks, strict=True) if not m.part]
            above = [n for n in above if n in [f.name for f in pack.finishes[k + 1 :]]]
            if prints and mask.part != self.whole_part and above:
                notes.append(
                    f"finish {printable(pack.finishes[k].name, 60)!r} covers all of part "
                    f"{printable(mask.part, 40)}, so {printable(', '.join(above), 80)} is not "
                    "drawn there."
                )
        return tuple(notes)

    def composed(self, masks: Sequence[Singles]) -> Singles:
        """Shares (h, w, C) from the masks' values (h, w) each, or (1, 1), 0 to 1."""
        shape = np.broadcast_shapes(*(mask.shape for mask in masks))
        shares = np.zeros((*shape, len(self.columns)), dtype=np.float32)
        for diffuse in (False, True):
            left = np.ones(shape, dtype=np.float32)
            for k in reversed(range(len(masks))):
                if diffuse and self.varnishes[k]:
                    continue
                if (k, diffuse) in self.columns:
                    shares[..., self.columns.index((k, diffuse))] = left * masks[k]
                left = left * (np.float32(1.0) - masks[k])
        return shares


def _level_0(
    pack: Pack, stack: _Stack, size: tuple[int, int], lobes: Array | None
) -> tuple[Halves, Bytes]:
    """Paint and channels at the artwork's resolution, composed in strips of rows."""
    height, width = size
    paint = np.zeros((height, width, 4), dtype=np.float16)
    channels = np.zeros((height, width, len(stack.columns)), dtype=np.uint8)
    grids = [resampled_mask(mask.values, size) for mask in stack.masks]
    if pack.artwork is not None:
        paint[..., :3] = pack.artwork.xyz
        paint[..., 3] = 1.0 if pack.artwork.alpha is None else pack.artwork.alpha
    step = max(1, STRIP_TEXELS // width)
    for first in range(0, height if grids else 0, step):
        rows = slice(first, min(first + step, height))
        parts = [_rows(grid, rows) for grid in grids]
        if stack.columns:
            shares = np.broadcast_to(
                stack.composed(parts), (rows.stop - first, width, len(stack.columns))
            )
            channels[rows] = _quantised(shares, stack.groups())
        if lobes is not None:
            shares = _of_channels(channels[rows] / np.float32(255.0), tuple(stack.specular))
            strip = paint[rows].astype(np.float32)
            taken = strip[..., :3] - strip[..., 3:] * (shares @ lobes.astype(np.float32))
            paint[rows, :, :3] = np.maximum(taken, 0.0)
    return paint, channels


def _rows(grid: Bytes, rows: slice) -> Singles:
    part = grid if grid.shape == (1, 1) else grid[rows]
    return part.astype(np.float32) / np.float32(255.0)


def resampled_mask(values: Bytes, size: tuple[int, int]) -> Bytes:
    """A mask on the artwork's pixels: areas where it is finer, straight lines where coarser."""
    if values.shape in (size, (1, 1)):
        return values
    from PIL import Image

    height, width = size
    finer = values.shape[0] >= height and values.shape[1] >= width
    method = Image.Resampling.BOX if finer else Image.Resampling.BILINEAR
    return np.asarray(Image.fromarray(values).resize((width, height), method))


def _levels(base: tuple[Halves, Bytes], stack: _Stack) -> Iterator[tuple[Halves, Bytes]]:
    """Level 0 and all below it; area averages in float32, of float32 from level 1 on."""
    yield base
    paint: npt.NDArray[Any] = base[0]
    shares: npt.NDArray[Any] = base[1]
    scale = np.float32(1.0 / 255.0)
    while max(paint.shape[:2]) > 1:
        paint, shares = halved(paint), halved(shares) * scale
        scale = np.float32(1.0)
        yield paint.astype(np.float16), _quantised(shares, stack.groups())


def halved(texels: npt.NDArray[Any]) -> Singles:
    """Texels (h, w, n) at half the size, each side rounded up: means of equal areas, float32.

    >>> halved(np.array([[[0.0], [3.0], [6.0]]])).ravel().tolist()  # of 1.5 texels each
    [1.0, 5.0]
    """
    rows = _halved_rows(texels)
    return np.swapaxes(_halved_rows(np.swapaxes(rows, 0, 1)), 0, 1)


def _halved_rows(texels: npt.NDArray[Any]) -> Singles:
    height = texels.shape[0]
    if height == 1:
        return texels.astype(np.float32)
    if height % 2 == 0:
        pairs = texels[0::2].astype(np.float32) + texels[1::2].astype(np.float32)
        return np.asarray(np.float32(0.5) * pairs, dtype=np.float32)
    count = (height + 1) // 2
    size = height / count  # of a new texel, 1.5 to 2 old ones
    first = np.arange(count) * size
    begin = np.floor(first).astype(np.int64)
    mean = np.zeros((count, *texels.shape[1:]), dtype=np.float32)
    for k in range(3):
        at = begin + k
        covered = np.clip(np.minimum(at + 1.0, first + size) - np.maximum(at, first), 0.0, 1.0)
        weight = (covered / size).astype(np.float32).reshape(-1, *[1] * (texels.ndim - 1))
        mean += weight * texels[np.minimum(at, height - 1)]
    return mean


def _quantised(shares: Singles, groups: Sequence[Sequence[int]]) -> Bytes:
    """Shares (..., C) in steps of 1/255, each group of channels adding up to at most 1.

    The running sums are rounded, from the top downwards, so that no share is off by more than 1.
    """
    steps = np.zeros(shares.shape, dtype=np.uint8)
    for group in groups:
        total = np.zeros(shares.shape[:-1], dtype=np.float32)
        before = np.zeros(shares.shape[:-1], dtype=np.int16)
        for channel in group:
            total = total + shares[..., channel]
            now = np.rint(np.minimum(total, np.float32(1.0)) * np.float32(255.0)).astype(np.int16)
            steps[..., channel] = now - before
            before = now
    return steps


def _of_channels(channels: npt.NDArray[Any], places: tuple[int, ...]) -> npt.NDArray[Any]:
    """Shares (..., F) of finishes from values (..., C), the rest where one takes it."""
    shares = np.zeros((*channels.shape[:-1], len(places)), dtype=channels.dtype)
    for k, channel in enumerate(places):
        if channel >= 0:
            shares[..., k] = channels[..., channel]
    rest = 1.0 - np.sum(shares, axis=-1)
    shares[..., places.index(REST)] = np.maximum(rest, 0.0)
    return shares
