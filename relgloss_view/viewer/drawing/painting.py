"""What is painted below the interface: the surround, and the pictures upon it."""

from __future__ import annotations

import math

import numpy as np

from relgloss_view.picture.model import tone
from relgloss_view.picture.model.tone import DisplayModel
from relgloss_view.picture.model.view import Size, View
from relgloss_view.picture.scene.setup import Display
from relgloss_view.viewer.drawing.arrangement import Arrangement, Canvas, Copy, Rect, bare
from relgloss_view.viewer.drawing.pictures import Shown
from relgloss_view.viewer.state.state import DIFFERENCE, Presentation


def surround_gray(display: Display) -> float:
    """Gray of the pictures' surround as the window shows it, 0 to 1, to the last of 8 bits."""
    model = DisplayModel.of(display)
    encoded = tone.encode(np.array(model.background_light), model)
    return float(np.round(255.0 * encoded)) / 255.0


def painted(
    pane: Size,
    presentation: Presentation,
    arrangement: Arrangement,
    shown: dict[str, Shown],
    edge: int | None = None,
) -> Canvas:
    """Pictures where they are arranged in a pane, and the surround around them, in its pixels.

    edge: column that parts the reference from the test picture, where one lies over the other.
    """
    copies: list[Copy] = []
    for side, rect in arrangement.rects.items():
        if side not in shown:
            continue
        clip = rect if edge is None else _wiped(rect, edge, side, mirrored=presentation.mirror)
        area = _common(_box(presentation, rect, shown[side]), clip)
        if area[2] > 0 and area[3] > 0:
            copies.append(_copy(rect, area, shown[side], mirrored=presentation.mirror))
    return Canvas(bare(pane, [copy.place for copy in copies]), copies)


def _wiped(rect: Rect, edge: int, side: str, *, mirrored: bool) -> Rect:
    """The part of a picture on its side of the wipe's edge."""
    left, top, width, height = rect
    if (side == "reference") != mirrored:
        return left, top, edge, height
    return left + edge, top, width - edge, height


def _box(presentation: Presentation, rect: Rect, shown: Shown) -> Rect:
    """The part of a picture's rectangle that can show the object; the rest is surround."""
    plain = presentation.overlay == "none" and presentation.compare != DIFFERENCE
    if not (plain or presentation.haploscopic):
        return rect
    left, bottom, right, top = View.of(shown.frame.scene, shown.size).bounds
    scale_x, scale_y = rect[2] / shown.size[0], rect[3] / shown.size[1]
    if presentation.mirror:
        left, right = shown.size[0] - right, shown.size[0] - left
    # Whole pixels of the screen, so that what is beside them is filled to the edge.
    x = (math.floor(left * scale_x), math.ceil(right * scale_x))
    y = (math.floor((shown.size[1] - top) * scale_y), math.ceil((shown.size[1] - bottom) * scale_y))
    return rect[0] + x[0], rect[1] + y[0], max(x[1] - x[0], 0), max(y[1] - y[0], 0)


def _common(a: Rect, b: Rect) -> Rect:
    """What two rectangles share."""
    left, top = max(a[0], b[0]), max(a[1], b[1])
    right, bottom = min(a[0] + a[2], b[0] + b[2]), min(a[1] + a[3], b[1] + b[3])
    return left, top, max(right - left, 0), max(bottom - top, 0)


def _copy(rect: Rect, area: Rect, shown: Shown, *, mirrored: bool) -> Copy:
    """What to copy from a picture to an area of the pane, and where in the picture it lies."""
    across, down = shown.size[0] / rect[2], shown.size[1] / rect[3]
    left, right = (round((x - rect[0]) * across) for x in (area[0], area[0] + area[2]))
    top, bottom = (round((y - rect[1]) * down) for y in (area[1], area[1] + area[3]))
    if mirrored:
        left, right = shown.size[0] - left, shown.size[0] - right
    if left == right:  # a sliver of a smaller picture still shows a pixel of it
        right = left + 1 if left < shown.size[0] else left - 1
    if top == bottom:
        bottom, top = (bottom + 1, top) if bottom < shown.size[1] else (bottom, top - 1)
    box = (left, shown.size[1] - bottom, right, shown.size[1] - top)
    return Copy(shown.framebuffer, box, area, scaled=shown.size != rect[2:])
