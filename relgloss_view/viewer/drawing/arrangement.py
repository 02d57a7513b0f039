"""Where the pictures are in their pane, how large they are drawn, and which eye that takes."""

from __future__ import annotations

import math
from dataclasses import dataclass

from relgloss_view.picture.model.view import MAX_PIXELS, MAX_SIDE_PX, Size, at_one_scale
from relgloss_view.picture.scene.setup import Eye
from relgloss_view.viewer.drawing.camera import life_sized
from relgloss_view.viewer.state.state import (
    DIFFERENCE,
    SIDE_BY_SIDE,
    SIDES,
    WIPE,
    Presentation,
    State,
)

Rect = tuple[int, int, int, int]  #: left, top, width, height in pixels of the pane


@dataclass(frozen=True)
class Arrangement:
    """Rectangles of the pictures in a pane, and the size that both are drawn at.

    A rectangle larger than `size` shows a picture that was too large to be drawn in full.
    """

    size: Size
    rects: dict[str, Rect]  #: by side, from left to right

    @property
    def gap_px(self) -> int | None:
        """Between the pictures where they are side by side; otherwise None."""
        (left, _, width, _), *others = self.rects.values()
        gap = others[0][0] - left - width if others else -1
        return gap if gap >= 0 else None

    @property
    def complete(self) -> bool:
        """Whether each pixel of a picture is a pixel of the screen."""
        return all(rect[2:] == self.size for rect in self.rects.values())


def arranged(
    pane: Size, presentation: Presentation, *, largest: Size | None = None
) -> Arrangement | None:
    """Arrange the pictures in a pane; None where there is no room for a pixel.

    largest: what the device can draw, width and height.
    """
    width, height = pane
    mode = SIDE_BY_SIDE if presentation.haploscopic else presentation.compare
    sides = _in_order(presentation)
    if mode == SIDE_BY_SIDE:
        gap = int(min(presentation.gap_px, max(width - 2, 0)))
        each = (width - gap) // 2
        rects = {sides[0]: (0, 0, each, height), sides[1]: (each + gap, 0, each, height)}
    elif mode == WIPE:
        each = width
        rects = dict.fromkeys(sides, (0, 0, width, height))
    else:
        each = width
        side = "test" if mode == DIFFERENCE or presentation.flipped else "reference"
        rects = {side: (0, 0, width, height)}
    if each < 1 or height < 1:
        return None
    return Arrangement(drawable((each, height), largest), rects)


def centred(pane: Size, size: Size, presentation: Presentation) -> Arrangement | None:
    """Two pictures of one size side by side in the middle of a pane; None where they don't fit."""
    gap = int(presentation.gap_px)
    left, top = (pane[0] - 2 * size[0] - gap) // 2, (pane[1] - size[1]) // 2
    if left < 0 or top < 0:
        return None
    first, second = _in_order(presentation)
    rects = {first: (left, top, *size), second: (left + size[0] + gap, top, *size)}
    return Arrangement(size, rects)


def _in_order(presentation: Presentation) -> list[str]:
    """The sides from left to right."""
    return ["test", "reference"] if presentation.mirror else ["reference", "test"]


def drawable(size: Size, largest: Size | None = None) -> Size:
    """The largest picture of the same proportions that can be drawn, at most `size`."""
    side_limit = min(MAX_SIDE_PX, *(largest or (MAX_SIDE_PX,)))
    scale = min(1.0, side_limit / max(size), math.sqrt(MAX_PIXELS / (size[0] * size[1])))
    if scale == 1.0:
        return size
    width, height = (max(1, int(side * scale + 1e-9)) for side in size)  # against rounding
    return width, height


def seen_by(state: State, size: Size, pixel_pitch_m: float | None) -> Eye:
    """The eye that a picture is drawn with: at life size the monitor decides its angle.

    Otherwise both objects are at one scale: beside a pack its reference is as large as it would be.
    """
    if state.presentation.life_size and pixel_pitch_m:
        return life_sized(state.setup.eye, pixel_pitch_m, size)
    return at_one_scale((state.scene(side).shape for side in SIDES), state.setup.eye, size)


def as_shown(state: State, size: Size, pixel_pitch_m: float | None) -> State:
    """The state with the eye that pictures of this size are drawn with."""
    eye = seen_by(state, size, pixel_pitch_m)
    return state if eye == state.setup.eye else state.placed(eye=eye)
