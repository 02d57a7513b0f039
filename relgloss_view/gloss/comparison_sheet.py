"""A comparison as one picture: a column for each sample, a row for each operator."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from relgloss_view.base.arrays import Bytes
from relgloss_view.display.display import Display
from relgloss_view.gloss.comparison import (
    BROKEN,
    KEPT,
    NONE,
    TIED,
    Cell,
    Comparison,
    DrawnSample,
    OperatorRow,
)
from relgloss_view.gloss.samples import gloss_words
from relgloss_view.picture.output.contact_sheet import INK_GRAY, PAPER_GRAY, gray_on, plate
from relgloss_view.picture.output.lettering import Lettering

MUTED_GRAY = 208
LINE_GRAY = 140
PLATE_EDGE_PX = 6  #: that a plate is wider than its text on each side
NO_BREAK = "\u00a0"  #: a space at which no line ends
MEASURES = {
    "highlight": "what the highlight adds",
    "peak_contrast": "peak contrast",
    "contrast_gloss": "99th percentile",
}
VERDICTS = {
    KEPT: "order kept",
    TIED: "order tied",
    BROKEN: "order broken",
    NONE: "no order",
}


def number(value: float | None, digits: int = 1) -> str:
    """A number of a table; a dash where there is none."""
    return "-" if value is None else f"{value:.{digits}f}"


def percent(share: float | None) -> float | None:
    """A share in percent; None where there is no share."""
    return None if share is None else 100.0 * share


def body_words(row: OperatorRow) -> str:
    """Whether the body's colour is kept, and how far it moved at most."""
    if row.body_difference is None:
        return "no body to judge the colour of"
    verdict = "kept" if row.body_kept else "drifts"
    return f"body colour {verdict}: dE2000 up to {row.body_difference:.2f}"


@dataclass
class _Pen:
    """Writes lines downwards from a place, wrapped to a width, on a plate of that width."""

    draw: Any
    x: float
    y: float
    width: float
    display: Display

    def write(self, text: str, font: Lettering, gray: int = INK_GRAY) -> None:
        ink = gray_on(self.display, gray)
        for line in self._wrapped(text, font):
            self._plate(1.35 * font.size)
            font.draw(self.draw, (self.x, self.y), line.replace(NO_BREAK, " "), ink)
            self.y += 1.35 * font.size

    def skip(self, pixels: float) -> None:
        self._plate(pixels)
        self.y += pixels

    def _plate(self, tall: float) -> None:
        """The plate below the next pixels; it hides nothing of the lines above."""
        left, right = self.x - PLATE_EDGE_PX, self.x + self.width + PLATE_EDGE_PX
        plate(self.draw, (left, math.ceil(self.y), right, self.y + tall), self.display)

    def _wrapped(self, text: str, font: Lettering) -> list[str]:
        lines: list[str] = []
        for word in text.split(" "):
            longer = f"{lines[-1]} {word}" if lines else word
            if lines and font.length(longer) <= self.width:
                lines[-1] = longer
            else:
                lines.append(word)
        return lines


def comparison_sheet(comparison: Comparison, title: str, note: str) -> Bytes:
    """The sheet's pixels (H, W, 3); text is gray, so that no colour is near a picture."""
    from PIL import Image, ImageDraw

    display = comparison.display
    height, width = _size(comparison)
    text_px = max(12, min(18, width // 20))
    head_px = round(1.6 * text_px)
    small, large, head = (Lettering(k) for k in (text_px, 1.2 * text_px, head_px))
    cell = max(width, round(14 * text_px))
    gap, side = 2 * text_px, round(20 * text_px)
    line = 1.35 * text_px
    top, caption = round(3.4 * head_px + 5.2 * line), round(4.6 * line)
    row_height = max(height + caption, round(13 * line)) + gap
    sheet = Image.new(
        "RGB",
        (
            round(gap + side + len(comparison.samples) * (cell + gap) + gap),
            round(top + len(comparison.rows) * row_height + 2 * line),
        ),
        gray_on(display, PAPER_GRAY),
    )
    draw, rule = ImageDraw.Draw(sheet), gray_on(display, LINE_GRAY)
    _Pen(draw, gap, 0.8 * head_px, sheet.width - 2 * gap, display).write(title, head)
    x_of = [2 * gap + side + k * (cell + gap) for k in range(len(comparison.samples))]
    for x, drawn in zip(x_of, comparison.samples, strict=True):
        _heading(_Pen(draw, x, 2.9 * head_px, cell, display), drawn, comparison, (large, small))
    for n, row in enumerate(comparison.rows):
        y = top + n * row_height
        draw.line((gap, y - 0.5 * gap, sheet.width - gap, y - 0.5 * gap), fill=rule)
        _operator(_Pen(draw, gap, y, side, display), row, (large, small))
        for x, drawn in zip(x_of, comparison.samples, strict=True):
            content = row.cells[drawn.sample.label]
            sheet.paste(Image.fromarray(content.picture), (round(x), round(y)))
            _caption(_Pen(draw, x, y + height + 0.3 * line, cell, display), content, small)
    _Pen(draw, gap, sheet.height - 1.7 * line, sheet.width - 2 * gap, display).write(
        note, small, MUTED_GRAY
    )
    return np.asarray(sheet)


def _size(comparison: Comparison) -> tuple[int, int]:
    """Height and width of the largest picture."""
    shapes = [cell.picture.shape for row in comparison.rows for cell in row.cells.values()]
    return max(s[0] for s in shapes), max(s[1] for s in shapes)


def _heading(
    pen: _Pen, drawn: DrawnSample, comparison: Comparison, fonts: tuple[Lettering, Lettering]
) -> None:
    large, small = fonts
    look = drawn.sample.look
    pen.write(drawn.sample.label, large)
    gloss = number(drawn.gloss[comparison.gloss], 3 if comparison.gloss[-1] == "s" else 1)
    pen.write(f"{gloss_words(comparison.gloss)}: {gloss}", small, MUTED_GRAY)
    share = "" if drawn.c_max is None else f" = {drawn.c / drawn.c_max:.3g} c_max"
    pen.write(f"sigma_N {look.sigma_n_deg:g} deg", small, MUTED_GRAY)
    pen.write(f"c {drawn.c:.3g}{share} (split)", small, MUTED_GRAY)


def _operator(pen: _Pen, row: OperatorRow, fonts: tuple[Lettering, Lettering]) -> None:
    large, small = fonts
    pen.write(row.operator.label, large)
    pen.write(row.operator.meaning, small, MUTED_GRAY)
    for name, words in MEASURES.items():
        order = row.orders[name]
        tau = "" if order.tau is None else f" (tau {order.tau:.2f})"
        pen.skip(0.5 * small.size)
        pen.write(f"{words}: {VERDICTS[order.verdict]}{tau}", small)
        if order.ranks:
            order_words = order.words.replace(" >", f"{NO_BREAK}>").replace(" =", f"{NO_BREAK}=")
            pen.write(order_words, small, MUTED_GRAY)
    pen.skip(0.5 * small.size)
    pen.write(body_words(row), small)


def _caption(pen: _Pen, cell: Cell, small: Lettering) -> None:
    m = cell.measures
    pen.write(
        f"peak {number(m.peak_contrast)}, p99 {number(m.contrast_gloss)}, "
        f"grain {number(m.graininess)}",
        small,
    )
    pen.write(
        f"sharp {number(m.sharpness, 0)}/deg, clipped {number(percent(m.clipped_share))} %",
        small,
        MUTED_GRAY,
    )
    pen.write(f"body dE2000 {number(m.body_difference, 2)}", small, MUTED_GRAY)
