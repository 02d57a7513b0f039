"""PSD and PSB files: the merged picture, its transparency, alpha and spot channels.

Source: Adobe Photoshop File Formats Specification (November 2019).
"""

from __future__ import annotations

import os
import struct
from typing import BinaryIO

import numpy as np

from relgloss_view.base.arrays import AnyArray
from relgloss_view.base.errors import InputError
from relgloss_view.base.interruptions import checkpoint
from relgloss_view.base.reading import named
from relgloss_view.base.terminal import ProgressReport
from relgloss_view.pack.artwork.options import ArtworkOptions
from relgloss_view.pack.artwork.photoshop import SPOT, channel_names, parse_resources
from relgloss_view.pack.artwork.pictures import check_size, profile_for, size_mm
from relgloss_view.pack.artwork.raster import Raster

#: Colour modes of the header: spaces and how many channels are the colour's.
MODES = {1: ("GRAY", 1), 3: ("RGB", 3), 4: ("CMYK", 4), 8: ("GRAY", 1), 9: ("Lab", 3)}
MOST_CHANNELS = 56
MOST_RESOURCES = 100_000_000  #: bytes


def read_psd(
    file: BinaryIO, path: str | os.PathLike[str], options: ArtworkOptions, progress: ProgressReport
) -> Raster:
    """The merged picture. Raises InputError, or ValueError where the file is damaged."""
    head = file.read(26)
    version, channels, height, width, depth, mode = struct.unpack(">4xH6xHIIHH", head)
    if version not in (1, 2) or mode not in MODES or depth not in (8, 16):
        raise InputError(
            f"{named(path)}: a PSD of a mode or depth that is not read; save it as RGB, CMYK, Lab "
            "or gray of 8 or 16 bits"
        )
    space, own = MODES[mode]
    if not own <= channels <= MOST_CHANNELS:
        raise ValueError("channels")
    check_size(path, width, height, channels * depth // 8)
    _skip(file, _number(file, 4))
    size = _number(file, 4)
    if size > MOST_RESOURCES:
        raise ValueError("resources")
    resources = parse_resources(file.read(size))
    if not resources.merged:
        raise InputError(
            f"{named(path)}: this PSD holds no merged picture; save it with 'Maximize "
            "Compatibility'"
        )
    layers = _number(file, 4 if version == 1 else 8)
    begin = file.tell()
    transparent = False
    if layers >= (6 if version == 1 else 10) and channels > own:
        _number(file, 4 if version == 1 else 8)
        transparent = struct.unpack(">h", file.read(2))[0] < 0
    extra = channels - own
    transparent |= 0 < extra == len(resources.names) + 1
    file.seek(begin + layers)
    progress(0.3, "decoding")
    planes = _planes(file, channels, width, height, depth // 8, large=version == 2)
    colour = np.ascontiguousarray(np.stack(planes[:own], axis=2))
    top = np.iinfo(colour.dtype).max
    if space == "CMYK":
        colour = top - colour
    rest = planes[own:]
    alpha = rest.pop(0) if transparent else None
    if alpha is not None and space in ("RGB", "GRAY"):
        colour = _without_white(colour, alpha)
    names = resources.names[1:] if len(resources.names) > len(rest) else resources.names
    kinds = resources.kinds[1:] if len(resources.kinds) > len(rest) else resources.kinds
    plates = {}
    for k, name in enumerate(channel_names(names, len(rest), channels - len(rest) + 1)):
        plate = rest[k] if depth == 8 else np.rint(rest[k] / 257.0).astype(np.uint8)
        plates[name] = 255 - plate if k < len(kinds) and kinds[k] == SPOT else plate
    notes: list[str] = []
    profile = profile_for(path, space, resources.profile, options, notes)
    width_mm, height_mm = size_mm((width, height), resources.dpi, options)
    return Raster(
        colour,
        profile,
        alpha,
        plates=plates,
        width_mm=width_mm,
        height_mm=height_mm,
        notes=tuple(notes),
    )


def _number(file: BinaryIO, size: int) -> int:
    data = file.read(size)
    if len(data) < size:
        raise ValueError("cut off")
    return int.from_bytes(data, "big")


def _skip(file: BinaryIO, size: int) -> None:
    file.seek(size, os.SEEK_CUR)


def _planes(
    file: BinaryIO, channels: int, width: int, height: int, size: int, *, large: bool
) -> list[AnyArray]:
    """The channels (H, W), uint8 or uint16."""
    from PIL import Image

    compression = _number(file, 2)
    row = width * size
    planes: list[AnyArray] = []
    if compression == 1:
        kind = ">u4" if large else ">u2"
        count = channels * height
        table = file.read(count * (4 if large else 2))
        counts = np.frombuffer(table, kind, count).reshape(channels, height).sum(axis=1, dtype=int)
    elif compression != 0:
        raise ValueError("compressed in a way that is not read")
    for k in range(channels):
        checkpoint()
        length = int(counts[k]) if compression == 1 else row * height
        if length > 2 * row * height + 2 * height + 1024:
            raise ValueError("rows that are too long")
        data = file.read(length)
        if len(data) < length:
            raise ValueError("cut off")
        if compression == 1:
            data = Image.frombytes("L", (row, height), data, "packbits", "L").tobytes()
        values = np.frombuffer(data, np.uint8 if size == 1 else ">u2").reshape(height, width)
        planes.append(values.astype(np.uint8 if size == 1 else np.uint16, copy=False))
    return planes


def _without_white(colour: AnyArray, alpha: AnyArray) -> AnyArray:
    """Colours of a merged picture, which lie on white, without it."""
    top = float(np.iinfo(colour.dtype).max)
    share = (alpha.astype(np.float32) / np.float32(top))[..., None]
    plain = (colour - top * (1.0 - share)) / np.maximum(share, 1e-6)
    return np.asarray(np.rint(np.clip(plain, 0.0, top)).astype(colour.dtype))
