"""Text on sheets: Pillow's own font, and behind it those for letters that it lacks."""

from __future__ import annotations

import functools
import io
from typing import Any

from relgloss_view.base import fonts
from relgloss_view.base.fonts import font_files


class Lettering:
    """A font of one size that draws names in any script for which there is a font.

    Text that Pillow's own font holds is drawn as that font alone draws it, pixel for pixel.
    """

    def __init__(self, size: float) -> None:
        """size: in pixels. Raises InputError where RELGLOSS_FONTS names a file that is no font."""
        from PIL import ImageFont

        self.size = size
        self._first: Any = ImageFont.load_default(size)

    def length(self, text: str) -> float:
        """Width of a line of text, pixels."""
        return float(sum(font.getlength(part) for font, part in self._parts(text)))

    def draw(
        self, pen: Any, place: tuple[float, float], text: str, ink: Any, anchor: str = "la"
    ) -> None:
        """Write a line with a Pillow ImageDraw; `anchor` as Pillow's, the first letter l or m."""
        parts = self._parts(text)
        if all(font is self._first for font, _ in parts):
            pen.text(place, text, fill=ink, font=self._first, anchor=anchor)
            return
        x, y = place
        if anchor[0] == "m":
            x -= 0.5 * self.length(text)
        # All parts stand on the base line that the first font would give the whole line.
        ascent, descent = self._first.getmetrics()
        base = y + (ascent if anchor[1] == "a" else 0.5 * (ascent - descent))
        for font, part in parts:
            pen.text((x, base), part, fill=ink, font=font, anchor="ls")
            x += font.getlength(part)

    def _parts(self, text: str) -> list[tuple[Any, str]]:
        """The text in parts, each with the font that draws it.

        Pillow's own font has few letters beyond ASCII. A text that needs others is drawn without
        it: two fonts in one word look like a fault.
        """
        from PIL import ImageFont

        files = () if text.isascii() else font_files()
        if not files or _held_by_the_first().issuperset(map(ord, text)):
            return [(self._first, text)]
        parts = fonts.runs(text, [file.characters for file in files])
        return [
            (ImageFont.truetype(files[k].path, self.size, index=files[k].index), part)
            for k, part in parts
        ]


@functools.cache
def _held_by_the_first() -> frozenset[int]:
    """The characters of Pillow's own font, which comes without a path."""
    from fontTools.ttLib import TTFont
    from PIL import ImageFont

    font: Any = ImageFont.load_default(12)
    data = font.path.getvalue() if isinstance(font.path, io.BytesIO) else b""
    if not data:
        return frozenset(range(0x20, 0x7F))
    return frozenset(TTFont(io.BytesIO(data))["cmap"].getBestCmap())
