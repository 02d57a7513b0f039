"""Mask files: a gray picture that shows where a finish lies."""

from __future__ import annotations

import os

import numpy as np

from relgloss_view.base.arrays import Bytes
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import decoding, named, open_regular
from relgloss_view.base.room import Need, check_room

EXPECTED = "a gray picture (PNG, TIFF or JPEG)"
FORMATS = ("PNG", "TIFF", "JPEG")
MOST_PIXELS = 1 << 28
_MODES = {"1", "L", "I;16", "I;16B", "I;16L", "I", "P", "LA", "RGB", "RGBA", "CMYK"}


def read_mask(path: str | os.PathLike[str]) -> Bytes:
    """The values of a mask picture, (h, w) uint8: white, 255, where the finish lies.

    A coloured picture counts by its luma; where it is transparent, nothing lies. Raises InputError.
    """
    import PIL.Image as pillow

    with open_regular(path, EXPECTED) as file, decoding(path, EXPECTED):
        try:
            picture = pillow.open(file, formats=FORMATS)
        except (pillow.DecompressionBombError, pillow.UnidentifiedImageError):
            raise InputError(f"{named(path)}: no such picture; give {EXPECTED}") from None
        width, height = picture.size
        if width * height > MOST_PIXELS:
            raise InputError(
                f"{named(path)}: {width} x {height} pixels are more than {MOST_PIXELS}; "
                "give a smaller picture"
            )
        check_room(Need(8.0 * width * height), "the mask", "give a smaller picture")
        if picture.mode not in _MODES:
            raise InputError(
                f"{named(path)}: its pixels are {picture.mode}; give {EXPECTED} of 8 or 16 bits"
            )
        return _values(picture)


def _values(picture) -> Bytes:  # type: ignore[no-untyped-def]
    if picture.mode.startswith("I"):
        wide = np.asarray(picture).astype(np.float64)
        return np.asarray(np.rint(np.clip(wide / 257.0, 0.0, 255.0)), dtype=np.uint8)
    if picture.mode in ("P", "LA", "RGBA") or "transparency" in picture.info:
        both = np.asarray(picture.convert("RGBA").convert("LA"), dtype=np.float64)
        return np.asarray(np.rint(both[..., 0] * both[..., 1] / 255.0), dtype=np.uint8)
    return np.array(picture.convert("L"), dtype=np.uint8)
