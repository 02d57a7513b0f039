"""TIFF files of 8 and 16 bits with all their channels, of which Pillow keeps some, and 8 bits.

The bytes are unpacked by libtiff, through Pillow: a TIFF is put together whose single channel is
one byte wide and whose rows are the bytes of this file's rows. Everything else happens here:
predictor, byte order, planes, channels.

Source: TIFF revision 6.0 (1992); Adobe Photoshop TIFF Technical Notes (2002).
"""

from __future__ import annotations

import io
import os
import struct
from typing import Any, BinaryIO

import numpy as np

from relgloss_view.base.arrays import AnyArray
from relgloss_view.base.errors import InputError
from relgloss_view.base.interruptions import checkpoint
from relgloss_view.base.reading import named, read_opened
from relgloss_view.base.terminal import ProgressReport
from relgloss_view.pack.artwork.options import ArtworkOptions
from relgloss_view.pack.artwork.photoshop import MOST_CHANNELS, channel_names, parse_resources
from relgloss_view.pack.artwork.pictures import (
    check_size,
    profile_for,
    quiet_pillow,
    size_mm,
    turned,
)
from relgloss_view.pack.artwork.raster import Raster

EXPECTED = "a TIFF"
MOST_BYTES = 800_000_000
MOST_TAGS, MOST_VALUES = 4096, 1 << 20
#: none, LZW, deflate (two numbers), PackBits, Zstandard
COMPRESSIONS = (1, 5, 8, 32946, 32773, 50000)
#: Photometric interpretations: spaces and channels.
SPACES = {0: ("GRAY", 1), 1: ("GRAY", 1), 2: ("RGB", 3), 5: ("CMYK", 4), 8: ("Lab", 3),
          9: ("Lab", 3)}  # fmt: skip
_SIZES = {1: (1, "B"), 2: (1, "B"), 3: (2, "H"), 4: (4, "I"), 5: (8, "II"), 7: (1, "B")}
_ASSOCIATED, _SEPARATE = 1, 2

Tags = dict[int, tuple[Any, ...]]


def read_tiff(
    file: BinaryIO, path: str | os.PathLike[str], options: ArtworkOptions, progress: ProgressReport
) -> Raster | None:
    """The raster of the first page; None where it is of a kind that Pillow reads as well.

    Raises InputError, or ValueError where the file is damaged.
    """
    order = "<" if file.read(2) == b"II" else ">"
    tags = _tags(file, order)
    bits = set(tags.get(258, (1,)))
    photometric = tags.get(262, (1,))[0]
    per_pixel = tags.get(277, (1,))[0]
    plain = (
        bits in ({8}, {16})
        and photometric in SPACES
        and tags.get(259, (1,))[0] in COMPRESSIONS
        and tags.get(317, (1,))[0] in (1, 2)
        and set(tags.get(339, (1,))) == {1}
        and tags.get(266, (1,))[0] == 1
    )
    if not plain:
        return None
    space, own = SPACES[photometric]
    if tags.get(332, (1,))[0] != 1 and space == "CMYK":
        raise InputError(f"{named(path)}: a TIFF of other inks than CMYK; save it as CMYK")
    if not own <= per_pixel <= own + MOST_CHANNELS:
        raise ValueError("channels")
    width, height, size = tags[256][0], tags[257][0], bits.pop() // 8
    check_size(path, width, height, per_pixel * size)
    file.seek(0)
    data = read_opened(file, path, MOST_BYTES, "a smaller TIFF")
    progress(0.3, "decoding")
    values = _values(data, tags, order, size)
    resources = parse_resources(_bytes(tags.get(34377, ())))
    colour, alpha, associated, plates = _channels(values, photometric, tags, resources.names)
    notes: list[str] = []
    if _has_further_page(data, order):
        notes.append("The TIFF has several pages; the first is read.")
    profile = profile_for(path, space, _bytes(tags.get(34675, ())) or None, options, notes)
    width_mm, height_mm = size_mm((width, height), _dpi(tags), options)
    raster = Raster(
        colour,
        profile,
        alpha,
        associated,
        plates,
        width_mm,
        height_mm,
        notes=tuple(notes),
    )
    return turned(raster, tags.get(274, (1,))[0])


def _tags(file: BinaryIO, order: str) -> Tags:
    file.seek(4)
    (at,) = struct.unpack(order + "I", file.read(4))
    file.seek(at)
    (count,) = struct.unpack(order + "H", file.read(2))
    if count > MOST_TAGS:
        raise ValueError("tags")
    table = file.read(12 * count)
    tags: Tags = {}
    for number, kind, length, value in struct.iter_unpack(order + "HHI4s", table):
        if kind not in _SIZES:
            continue
        size, form = _SIZES[kind]
        most = 64 << 20 if form == "B" else MOST_VALUES
        if length > most:
            raise ValueError("a tag of too many values")
        if size * length > 4:
            file.seek(struct.unpack(order + "I", value)[0])
            value = file.read(size * length)
            if len(value) < size * length:
                raise ValueError("a tag that is cut off")
        tags[number] = (
            (value[:length],)
            if form == "B" and number in (34377, 34675)
            else struct.unpack(f"{order}{length * len(form)}{form[0]}", value[: size * length])
        )
        if not tags[number]:
            del tags[number]
    return tags


def _has_further_page(data: bytes, order: str) -> bool:
    """Whether a second picture follows that is no thumbnail of the first (NewSubfileType)."""
    (at,) = struct.unpack_from(order + "I", data, 4)
    (count,) = struct.unpack_from(order + "H", data, at)
    try:
        (following,) = struct.unpack_from(order + "I", data, at + 2 + 12 * count)
        if not following:
            return False
        (entries,) = struct.unpack_from(order + "H", data, following)
        for k in range(min(entries, MOST_TAGS)):
            number, kind, _, value = struct.unpack_from(
                order + "HHI4s", data, following + 2 + 12 * k
            )
            if number == 254 and kind == 4:
                return not struct.unpack(order + "I", value)[0] & 1
    except struct.error:  # nothing follows that could be read
        return False
    return True


def _bytes(value: tuple[Any, ...]) -> bytes:
    return value[0] if value and isinstance(value[0], bytes) else bytes(value)


def _dpi(tags: Tags) -> tuple[float, float]:
    unit = {2: 1.0, 3: 2.54}.get(tags.get(296, (2,))[0], 0.0)
    pairs = [tags.get(number, (0, 1)) for number in (282, 283)]
    across, down = (p[0] / p[1] * unit if len(p) > 1 and p[1] else 0.0 for p in pairs)
    return across, down


def _values(data: bytes, tags: Tags, order: str, size: int) -> AnyArray:
    """All samples, (H, W, channels)."""
    width, height, count = tags[256][0], tags[257][0], tags.get(277, (1,))[0]
    planar = tags.get(284, (1,))[0] == 2 and count > 1
    tiled = 322 in tags
    if tiled:
        across, rows = tags[322][0], tags[323][0]
        offsets, lengths = tags[324], tags[325]
        if not (16 <= across <= 65536 and 16 <= rows <= 65536):
            raise ValueError("tiles")
    else:
        across, rows = width, min(tags.get(278, (height,))[0], height)
        offsets = tags[273]
        lengths = tags.get(279, ()) or (len(data),)
    if rows < 1:
        raise ValueError("rows of a strip")
    columns, lines = -(-width // across), -(-height // rows)
    each = columns * lines
    planes = count if planar else 1
    if len(offsets) != each * planes or len(lengths) != each * planes:
        raise ValueError("parts")
    inside = 1 if planar else count
    padded = (columns * across, lines * rows if tiled else height)
    if padded[0] * padded[1] * inside > 4 * width * height * inside + (1 << 24):
        raise ValueError("tiles that are larger than the picture")
    out = np.empty((height, width, count), np.uint8 if size == 1 else np.uint16)
    for k in range(planes):
        checkpoint()
        part = slice(k * each, (k + 1) * each)
        raw = _unpacked(
            data, order, (padded[0] * inside * size, padded[1]), (across * inside * size, rows),
            offsets[part], lengths[part], tags.get(259, (1,))[0], tiled=tiled,
        )  # fmt: skip
        samples = raw.view("u1" if size == 1 else f"{order}u2")
        samples = samples.reshape(padded[1], columns, across, inside)
        if tags.get(317, (1,))[0] == 2:
            samples = np.cumsum(samples, axis=2, dtype=out.dtype)
        samples = samples.reshape(padded[1], padded[0], inside)[:height, :width]
        out[..., k : k + inside] = samples
    return out


def _unpacked(
    data: bytes,
    order: str,
    size: tuple[int, int],
    part: tuple[int, int],
    offsets: tuple[int, ...],
    lengths: tuple[int, ...],
    compression: int,
    *,
    tiled: bool,
) -> AnyArray:
    """The bytes of a file's parts as a picture of one channel, (rows, bytes of a row)."""
    from PIL import Image

    columns, rows = size
    if max(offsets) + 1 > len(data):
        raise ValueError("parts beyond the end")
    if compression == 1:
        return _plain(data, size, part, offsets, lengths)
    entries: list[tuple[int, tuple[int, ...]]] = [
        (256, (columns,)), (257, (rows,)), (258, (8,)), (259, (compression,)), (262, (1,)),
        (277, (1,)),
    ]  # fmt: skip
    if tiled:
        entries += [(322, (part[0],)), (323, (part[1],)), (324, offsets), (325, lengths)]
    else:
        entries += [(273, offsets), (278, (part[1],)), (279, lengths)]
    entries.sort()
    start = (len(data) + 1) // 2 * 2
    after = start + 2 + 12 * len(entries) + 4
    table, rest = struct.pack(order + "H", len(entries)), b""
    for number, values in entries:
        packed = struct.pack(f"{order}{len(values)}I", *values)
        if number in (258, 259, 262, 277):
            table += struct.pack(order + "HHIHH", number, 3, 1, values[0], 0)
        elif len(packed) == 4:
            table += struct.pack(order + "HHI", number, 4, 1) + packed
        else:
            place = struct.pack(order + "I", after + len(rest))
            table += struct.pack(order + "HHI", number, 4, len(values)) + place
            rest += packed
    head = data[:4] + struct.pack(order + "I", start)
    pad = bytes(start - len(data))
    whole = b"".join((head, memoryview(data)[8:], pad, table, bytes(4), rest))
    with quiet_pillow(), Image.open(io.BytesIO(whole), formats=("TIFF",)) as image:
        return np.array(image).ravel()


def _plain(
    data: bytes,
    size: tuple[int, int],
    part: tuple[int, int],
    offsets: tuple[int, ...],
    lengths: tuple[int, ...],
) -> AnyArray:
    columns, rows = size
    out = np.empty((rows, columns), np.uint8)
    across = columns // part[0]
    for k, (offset, length) in enumerate(zip(offsets, lengths, strict=True)):
        y, x = k // across * part[1], k % across * part[0]
        high = min(part[1], rows - y)
        wanted = high * part[0]
        if length < wanted or offset + wanted > len(data):
            raise ValueError("a part that is cut off")
        block = np.frombuffer(data, np.uint8, wanted, offset)
        out[y : y + high, x : x + part[0]] = block.reshape(high, part[0])
    return out.ravel()


def _channels(
    values: AnyArray, photometric: int, tags: Tags, names: tuple[str, ...]
) -> tuple[AnyArray, AnyArray | None, bool, dict[str, AnyArray]]:
    """Colour, alpha, whether it is multiplied in, and plates."""
    own = SPACES[photometric][1]
    top = np.iinfo(values.dtype).max
    colour = np.ascontiguousarray(values[..., :own])
    if photometric == 0:
        colour = top - colour
    if photometric == 8:  # a* and b* are signed
        colour[..., 1:] ^= (top + 1) // 2
    if photometric in (8, 9) and top == 65535:  # 256 a unit
        scaled = colour[..., 1:] * (65535.0 / 65280.0)
        colour[..., 1:] = np.rint(np.minimum(scaled, 65535.0))
    extra = values.shape[2] - own
    listed = tags.get(338, ())
    meanings = [int(v) for v in (*listed, *(0,) * extra)][:extra]
    alpha_at = next((k for k, v in enumerate(meanings) if v in (_ASSOCIATED, _SEPARATE)), None)
    alpha, associated = None, False
    rest = list(range(extra))
    if alpha_at is not None:
        alpha = np.ascontiguousarray(values[..., own + alpha_at])
        associated = meanings[alpha_at] == _ASSOCIATED
        rest.remove(alpha_at)
    if len(names) > len(rest):
        names = names[len(names) - len(rest) :]
    plates = {}
    for k, name in zip(rest, channel_names(names, len(rest), own + 1), strict=True):
        plate = values[..., own + k]
        plate = plate if top == 255 else np.rint(plate / 257.0)
        plates[name] = np.ascontiguousarray(plate, np.uint8)
    return colour, alpha, associated, plates
