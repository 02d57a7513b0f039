"""The stored pictures of a proof: what a page shows where nothing can be drawn."""

from __future__ import annotations

import base64
import io
from collections.abc import Mapping

from relgloss_view.base.arrays import Bytes, Floats
from relgloss_view.base.interruptions import checkpoint

MOST_BYTES = 120_000  #: of both pictures together, as base64
BLOCK = 16  #: pixels of a side, over which a stored picture is compared
#: Digital values of 255 that the mean of a block may be off: twice the 13 that the lowest quality
#: changes on a carton's edges. Cast-coated and matte paper differ by 49 and more.
MOST_OFF = 26.0
QUALITIES = (84, 80, 74, 68, 60, 50, 40, 30, 20)


def webp(rgb: Bytes, quality: int) -> bytes:
    """RGB (H, W, 3) as a WebP of this quality, 0 to 100."""
    from PIL import Image

    memory = io.BytesIO()
    Image.fromarray(rgb).save(memory, "WEBP", quality=quality, method=4)
    return memory.getvalue()


def is_shown(coded: object, rgb: Bytes) -> bool:
    """Whether a stored picture shows what was drawn, (H, W, 3): compressing changes it little.

    coded: base64 of WebP, or a table {"type", "base64"}. What can't be decoded shows nothing.
    """
    import numpy as np
    from PIL import Image

    data = coded if isinstance(coded, str) else coded["base64"] if isinstance(coded, dict) else ""
    try:
        with Image.open(io.BytesIO(base64.b64decode(data)), formats=("WEBP", "PNG")) as picture:
            if picture.size != (rgb.shape[1], rgb.shape[0]):
                return False
            kept = np.asarray(picture.convert("RGB"))
    except (OSError, SyntaxError, ValueError):
        return False
    return bool(np.max(np.abs(_blocks(kept) - _blocks(rgb))) <= MOST_OFF)


def _blocks(rgb: Bytes) -> Floats:
    """Means of BLOCK by BLOCK pixels, (h, w, 3); a rest at the edges is left out."""
    import numpy as np

    rows, columns = (max(n // BLOCK, 1) for n in rgb.shape[:2])
    cut = rgb[: rows * BLOCK, : columns * BLOCK].astype(np.float64)
    down, across = (min(BLOCK, n) for n in rgb.shape[:2])
    means: Floats = cut.reshape(rows, down, columns, across, 3).mean(axis=(1, 3))
    return means


def stored(
    pictures: Mapping[str, Bytes], most_bytes: int = MOST_BYTES
) -> tuple[dict[str, str], int]:
    """Pictures as base64 of WebP, and their quality: the best that keeps them small enough.

    Where none does, the lowest is taken: grain can hardly be compressed.
    """
    coded: dict[str, str] = {}
    for quality in QUALITIES:
        checkpoint()
        coded = {
            name: base64.b64encode(webp(rgb, quality)).decode("ascii")
            for name, rgb in pictures.items()
        }
        if sum(map(len, coded.values())) <= most_bytes:
            break
    return coded, quality
