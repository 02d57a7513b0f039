"""The mean of a picture file: what stands for a texture where a material has one value."""

from __future__ import annotations

import io
import math
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.errors import InputError

MOST_PIXELS = 16384 * 16384  #: of a texture
MEAN_PX = 512  #: to which a texture is made smaller for its mean
#: What Pillow has to begin with, and the format that it may then be.
_BEGINNINGS = ((b"\x89PNG\r\n\x1a\n", "PNG"), (b"\xff\xd8\xff", "JPEG"), (b"RIFF", "WEBP"))

#: Linear light of stored values, 0 to 1; None where the numbers are no colours.
Curve = Callable[[Array], Array]


def picture_mean(data: bytes, curve: Curve | None) -> Array:
    """The mean (4,) of red, green, blue and alpha of a PNG, JPEG or WebP file, from 0 to 1.

    curve: of red, green and blue. A gray picture has three equal channels. Raises InputError for
    another format, a broken file or one of too many pixels.
    """
    kind = next((name for start, name in _BEGINNINGS if data.startswith(start)), None)
    if kind is None or (kind == "WEBP" and data[8:12] != b"WEBP"):
        raise InputError("a texture is neither PNG nor JPEG nor WebP; export it again")
    channels = _channels(data, kind)
    if curve is None:
        return np.asarray(channels.mean(axis=0))
    return np.append(curve(channels[:, :3]).mean(axis=0), channels[:, 3].mean())


def _channels(data: bytes, kind: str) -> Array:
    """Some of the pixels, evenly taken, (N, 4), 0 to 1."""
    from PIL import Image

    try:
        with _without_warnings(), Image.open(io.BytesIO(data), formats=(kind,)) as image:
            if image.width * image.height > MOST_PIXELS:
                raise InputError("a texture has too many pixels; export smaller ones")
            image.draft("RGB", (MEAN_PX, MEAN_PX))
            # Gray of 16 bits, which Pillow would cut at 255 in place of scaling it.
            deep = image.mode.startswith("I")
            step = max(1, int(math.sqrt(image.width * image.height) / (2 * MEAN_PX)))
            size = (max(1, image.width // step), max(1, image.height // step))
            # Made smaller before all pixels have four channels, which may be gigabytes.
            some = image.resize(size, Image.Resampling.NEAREST) if step > 1 else image
            pixels = np.asarray(some if deep else some.convert("RGBA"))
    except (OSError, SyntaxError, ValueError, Image.DecompressionBombError) as error:
        raise InputError("a texture is broken; export it again") from error
    if deep:
        gray = np.clip(pixels.ravel() / 65535.0, 0.0, 1.0)
        return np.stack([gray, gray, gray, np.ones_like(gray)], axis=-1)
    return np.asarray(pixels.reshape(-1, 4) / 255.0)


@contextmanager
def _without_warnings() -> Iterator[None]:
    """Pillow prints one of a picture of many pixels; MOST_PIXELS is what counts here."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        yield
