"""The picture of an item, opened: sheet, page, search and window read it here."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING

from relgloss_view.catalogue.recipe import MOST_THUMBNAIL_PX

if TYPE_CHECKING:
    from PIL.Image import Image


def opened_thumbnail(png: bytes | None) -> Image | None:
    """A thumbnail as an image of R, G, B, 8 bits each; None without one or where it is damaged.

    A picture with a side of more than MOST_THUMBNAIL_PX pixels is none that a build writes, and is
    not unpacked.

    >>> opened_thumbnail(None) is None, opened_thumbnail(b"no PNG") is None
    (True, True)
    """
    if not png:
        return None
    from PIL import Image, UnidentifiedImageError

    try:
        with Image.open(io.BytesIO(png), formats=("PNG",)) as image:
            return None if max(image.size) > MOST_THUMBNAIL_PX else image.convert("RGB")
    except (UnidentifiedImageError, OSError, ValueError, SyntaxError, Image.DecompressionBombError):
        return None
