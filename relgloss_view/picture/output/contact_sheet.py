"""Contact sheets: pictures in rows and columns on the neutral surround, each with its caption."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from relgloss_view.base.arrays import Bytes
from relgloss_view.display.display import Display
from relgloss_view.display.model import DisplayModel
from relgloss_view.picture.displayed import Displayed, shown_light
from relgloss_view.picture.frame import Frame
from relgloss_view.picture.model.tone import encode, neutral_digital
from relgloss_view.picture.output.lettering import Lettering

PAPER_GRAY = 119  #: sRGB of L* 50
#: Below each text: white itself has a contrast of 4.48 on L* 50. INK_GRAY has 6.9 on this one.
PLATE_GRAY = 84
INK_GRAY = 245
STRIP_PX = 3  #: of the surround between a picture and the plate below it


def gray_on(display: Display, gray: int) -> tuple[int, int, int]:
    """Digital values of a display that show the light of a gray of sRGB, 0 to 255.

    >>> gray_on(Display(), 119), gray_on(Display(transfer="gain-offset-gamma", gamma=1.8), 119)
    ((119, 119, 119), (100, 100, 100))
    """
    light = float(DisplayModel.of(Display()).light(np.full((1, 3), gray / 255.0))[0, 0])
    red, green, blue = (round(255.0 * v) for v in neutral_digital(light, DisplayModel.of(display)))
    return red, green, blue


def thumbnail(frame: Frame, longest_px: int, displayed: Displayed | None = None) -> Bytes:
    """The frame's picture shrunk by whole steps, averaged in light, where grain keeps its mean.

    displayed: the picture of another operator than the split.
    """
    step = max(1, -(-max(frame.size) // longest_px))
    if step == 1:
        return frame.display if displayed is None else displayed.digital
    width, height = (n // step * step for n in frame.size)
    light, _ = shown_light(frame, (frame if displayed is None else displayed).light)
    light = light[:height, :width]
    mean = np.zeros((height // step, width // step, 3))
    for y in range(step):
        for x in range(step):
            mean += light[y::step, x::step]
    mean /= step * step
    digital = encode(mean, DisplayModel.of(frame.scene.display))
    return np.asarray(np.floor(255.0 * digital + 0.5).astype(np.uint8))


def plate(
    pen: Any,
    box: tuple[float, float, float, float],
    display: Display | None = None,
) -> None:
    """Fill a box (left, top, right, bottom; pixels) below a text, with a Pillow ImageDraw.

    Pictures keep a strip of the surround between them and a plate.
    """
    left, top, right, bottom = box
    pen.rectangle(
        (math.floor(left), math.floor(top), math.ceil(right) - 1, math.ceil(bottom) - 1),
        fill=gray_on(display or Display(), PLATE_GRAY),
    )


def text_px(width_px: int) -> int:
    """Height of the letters on a sheet of pictures of a width."""
    return max(11, min(18, width_px // 14))


def gap_px(width_px: int) -> int:
    """Room between pictures of a width, and around them."""
    return max(8, width_px // 24)


def contact_sheet(
    rows: Sequence[Sequence[Bytes]],
    captions: Sequence[Sequence[str]],
    title: str = "",
    note: str = "",
    *,
    display: Display | None = None,
    strip_px: int = STRIP_PX,
) -> Bytes:
    """Equal-sized 8-bit pictures (H, W, 3) on one sheet; returns its pixels (H, W, 3).

    display: that the pictures are for; sRGB where none is given. The sheet has L* 50 on it, and
    text is light gray on darker plates, so that no colour is near a picture. strip_px: of the
    surround between a picture and the plate below it.
    """
    from PIL import Image, ImageDraw

    height, width = rows[0][0].shape[:2]
    letter_px = text_px(width)
    font, heading = Lettering(letter_px), Lettering(round(1.4 * letter_px))
    gap, caption_px = gap_px(width), round(1.9 * letter_px)
    top = round(3.2 * letter_px) if title else gap
    bottom = round(2.6 * letter_px) if note else gap
    columns = max(len(row) for row in rows)
    sheet = Image.new(
        "RGB",
        (
            gap + columns * (width + gap),
            top + len(rows) * (height + caption_px + gap) - gap + bottom,
        ),
        gray_on(display or Display(), PAPER_GRAY),
    )
    pen = ImageDraw.Draw(sheet)
    ink = gray_on(display or Display(), INK_GRAY)
    if title:
        plate(pen, (0, 0, sheet.width, top - gap), display)
    heading.draw(pen, (gap, (top - gap - 1.4 * letter_px) / 2), title, ink)
    for r, (row, texts) in enumerate(zip(rows, captions, strict=True)):
        for k, (picture, text) in enumerate(zip(row, texts, strict=True)):
            x, y = gap + k * (width + gap), top + r * (height + caption_px + gap)
            sheet.paste(Image.fromarray(np.ascontiguousarray(picture)), (x, y))
            if text:
                below = y + height + strip_px
                plate(pen, (x, below, x + width, y + height + caption_px), display)
            place = (x + width / 2, y + height + (strip_px + caption_px) / 2)
            font.draw(pen, place, text, ink, "mm")
    if note:
        plate(pen, (0, sheet.height - bottom + gap / 2, sheet.width, sheet.height), display)
    font.draw(pen, (gap, sheet.height - (bottom - gap / 2) / 2), note, ink, "lm")
    return np.asarray(sheet)
