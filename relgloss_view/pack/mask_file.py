"""Mask files: a gray picture that shows where a finish lies."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import numpy as np

from relgloss_view.base.arrays import Bytes
from relgloss_view.base.errors import InputError
from relgloss_view.base.interruptions import checkpoint
from relgloss_view.base.reading import decoding, named, open_regular
from relgloss_view.pack.artwork.pictures import (
    check_size,
    orientation_of,
    quiet_pillow,
    transparency16,
    turned_values,
)

if TYPE_CHECKING:
    from PIL import Image

EXPECTED = "a gray picture (PNG, TIFF or JPEG)"
FORMATS = ("PNG", "TIFF", "JPEG")
AT_ONCE = 1 << 22  #: pixels that are converted together
_MODES = {"1", "L", "I;16", "I;16B", "I;16L", "I", "P", "LA", "RGB", "RGBA", "CMYK"}


def read_mask(path: str | os.PathLike[str]) -> Bytes:
    """The values of a mask picture, (h, w) uint8: white, 255, where the finish lies.

    A coloured picture counts by its luma; where it is transparent, nothing lies. It is turned as
    its EXIF orientation asks, as an artwork is. Raises InputError.
    """
    from PIL import Image, UnidentifiedImageError

    with open_regular(path, EXPECTED) as file, decoding(path, EXPECTED), quiet_pillow():
        try:
            picture = Image.open(file, formats=FORMATS)
        except UnidentifiedImageError:
            raise InputError(f"{named(path)}: no such picture; give {EXPECTED}") from None
        if picture.mode not in _MODES:
            raise InputError(
                f"{named(path)}: its pixels are {picture.mode}; give {EXPECTED} of 8 or 16 bits"
            )
        check_size(path, *picture.size, len(picture.getbands()))
        picture.load()
        width, height = picture.size
        values = np.empty((height, width), np.uint8)
        step = max(AT_ONCE // width, 1)
        for top in range(0, height, step):
            checkpoint()
            bottom = min(top + step, height)
            values[top:bottom] = _values(picture, top, bottom)
        return np.asarray(turned_values(values, orientation_of(picture)), np.uint8)


def _values(picture: Image.Image, top: int, bottom: int) -> Bytes:
    """The values of some rows."""
    part = picture.crop((0, top, picture.width, bottom))
    if picture.mode.startswith("I"):
        wide = np.asarray(part)
        gray: Bytes = np.rint(np.clip(wide / np.float32(257.0), 0.0, 255.0)).astype(np.uint8)
        clear = transparency16(picture, wide)
        return gray if clear is None else np.minimum(gray, clear)
    if picture.mode in ("P", "LA", "RGBA") or "transparency" in picture.info:
        both = np.asarray(part.convert("RGBA").convert("LA"), dtype=np.float32)
        return np.asarray(np.rint(both[..., 0] * both[..., 1] / np.float32(255.0)), np.uint8)
    return np.array(part.convert("L"), dtype=np.uint8)
