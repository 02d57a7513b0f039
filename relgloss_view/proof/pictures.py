"""The stored pictures of a proof: what a page shows where nothing can be drawn."""

from __future__ import annotations

import base64
import io
from collections.abc import Mapping

from relgloss_view.base.arrays import Bytes
from relgloss_view.base.interruptions import checkpoint

MOST_BYTES = 120_000  #: of both pictures together, as base64
QUALITIES = (92, 88, 84, 80, 74, 68, 60, 50, 40, 30, 20)


def webp(rgb: Bytes, quality: int) -> bytes:
    """RGB (H, W, 3) as a WebP of this quality, 0 to 100."""
    from PIL import Image

    memory = io.BytesIO()
    Image.fromarray(rgb).save(memory, "WEBP", quality=quality, method=4)
    return memory.getvalue()


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
