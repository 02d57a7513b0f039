"""The canvas below the interface: the surround, and copies of the pictures upon it."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass, field

import numpy as np

from relgloss_view.base.arrays import Rgb
from relgloss_view.display.display import Display
from relgloss_view.display.model import DisplayModel
from relgloss_view.picture.model import tone
from relgloss_view.picture.model.view import Box, Size, View
from relgloss_view.viewer.drawing.arrangement import Arrangement, Rect
from relgloss_view.viewer.drawing.pair_renderer import SidePicture
from relgloss_view.viewer.state.state import DIFFERENCE, Presentation


@dataclass(frozen=True)
class Copy:
    """A box of a picture's framebuffer (by name; pixels from its lower left) and where it goes."""

    framebuffer: int
    box: Box
    place: Rect
    scaled: bool


@dataclass(frozen=True)
class Canvas:
    """The surround, and copies of pictures."""

    surround: list[Rect] = field(default_factory=list)
    copies: list[Copy] = field(default_factory=list)

    def moved(self, right: int, down: int) -> Canvas:
        """The same canvas elsewhere."""

        def move(rect: Rect) -> Rect:
            return rect[0] + right, rect[1] + down, rect[2], rect[3]

        copies = [dataclasses.replace(copy, place=move(copy.place)) for copy in self.copies]
        return Canvas([move(rect) for rect in self.surround], copies)


def surround_gray(display: Display) -> Rgb:
    """Digital values of the pictures' surround in the window, each 0 to 1, to the last of 8 bits.

    On a display of a profile its neutral gray takes three different ones.
    """
    encoded = tone.surround_digital(DisplayModel.of(display))
    red, green, blue = (np.round(255.0 * encoded) / 255.0).tolist()
    return red, green, blue


def canvas_of(
    pane: Size,
    presentation: Presentation,
    arrangement: Arrangement,
    pictures: dict[str, SidePicture],
    edge: int | None = None,
) -> Canvas:
    """Pictures where they are arranged in a pane, and the surround around them, in its pixels.

    edge: column that parts the reference from the test picture, where one lies over the other.
    """
    copies: list[Copy] = []
    for side, rect in arrangement.rects.items():
        if side not in pictures:
            continue
        clip = rect if edge is None else _wiped(rect, edge, side, mirrored=presentation.mirror)
        area = _common(_box(presentation, rect, pictures[side]), clip)
        if area[2] > 0 and area[3] > 0:
            copies.append(_copy(rect, area, pictures[side], mirrored=presentation.mirror))
    return Canvas(bare(pane, [copy.place for copy in copies]), copies)


def _wiped(rect: Rect, edge: int, side: str, *, mirrored: bool) -> Rect:
    """The part of a picture on its side of the wipe's edge."""
    left, top, width, height = rect
    if (side == "reference") != mirrored:
        return left, top, edge, height
    return left + edge, top, width - edge, height


def _box(presentation: Presentation, rect: Rect, picture: SidePicture) -> Rect:
    """The part of a picture's rectangle that can show the object; the rest is surround."""
    plain = presentation.overlay == "none" and presentation.compare != DIFFERENCE
    if picture.frame.scene.display.seen_on:  # whose surround is not this display's
        return rect
    if not (plain or presentation.haploscopic):
        return rect
    left, bottom, right, top = View.of(picture.frame.scene, picture.size).bounds
    scale_x, scale_y = rect[2] / picture.size[0], rect[3] / picture.size[1]
    if presentation.mirror:
        left, right = picture.size[0] - right, picture.size[0] - left
    # Whole pixels of the screen, so that what is beside them is filled to the edge.
    x = (math.floor(left * scale_x), math.ceil(right * scale_x))
    y = (
        math.floor((picture.size[1] - top) * scale_y),
        math.ceil((picture.size[1] - bottom) * scale_y),
    )
    return rect[0] + x[0], rect[1] + y[0], max(x[1] - x[0], 0), max(y[1] - y[0], 0)


def _common(a: Rect, b: Rect) -> Rect:
    """What two rectangles share."""
    left, top = max(a[0], b[0]), max(a[1], b[1])
    right, bottom = min(a[0] + a[2], b[0] + b[2]), min(a[1] + a[3], b[1] + b[3])
    return left, top, max(right - left, 0), max(bottom - top, 0)


def _copy(rect: Rect, area: Rect, picture: SidePicture, *, mirrored: bool) -> Copy:
    """What to copy from a picture to an area of the pane, and where in the picture it lies."""
    across, down = picture.size[0] / rect[2], picture.size[1] / rect[3]
    left, right = (round((x - rect[0]) * across) for x in (area[0], area[0] + area[2]))
    top, bottom = (round((y - rect[1]) * down) for y in (area[1], area[1] + area[3]))
    if mirrored:
        left, right = picture.size[0] - left, picture.size[0] - right
    if left == right:  # a sliver of a smaller picture still shows a pixel of it
        right = left + 1 if left < picture.size[0] else left - 1
    if top == bottom:
        bottom, top = (bottom + 1, top) if bottom < picture.size[1] else (bottom, top - 1)
    box = (left, picture.size[1] - bottom, right, picture.size[1] - top)
    return Copy(picture.framebuffer, box, area, scaled=picture.size != rect[2:])


def bare(pane: Size, covered: list[Rect]) -> list[Rect]:
    """The parts of a pane that no picture covers.

    covered: rectangles that share no column, or that are the same.
    """
    parts: list[Rect] = []
    width, height = pane
    reached = 0
    for left, top, wide, tall in sorted(covered):
        left, right = max(left, reached), min(left + wide, width)
        if right <= left:
            continue
        top, bottom = max(min(top, height), 0), max(min(top + tall, height), 0)
        parts.append((reached, 0, left - reached, height))
        parts.append((left, 0, right - left, top))
        parts.append((left, bottom, right - left, height - bottom))
        reached = right
    parts.append((reached, 0, width - reached, height))
    return [part for part in parts if part[2] > 0 and part[3] > 0]
