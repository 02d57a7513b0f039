"""The strip of categories below the pictures: for the hand on the mouse, gone when it rests."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

from imgui_bundle import ImVec2, imgui

from relgloss_view.base.arrays import Rgb
from relgloss_view.experiment.design.study import ALWAYS, ON_DEMAND
from relgloss_view.picture.model.view import Size
from relgloss_view.viewer.shell.theme import coloured
from relgloss_view.viewer.trials.ink import Ink

REST_S, FADE_S = 1.5, 0.3  #: from the last movement until it fades, and how long that takes
FADE_STEP_S = 1.0 / 30.0
STILL_PX = 3.0  #: a mouse that has not left this circle rests
FIELD_HEIGHT = 2.9  #: in sizes of the text
FIELD_WIDTH, GAP = (5.0, 12.0), 0.25  #: of a field at least and at most, and between two
NAMES, MOST_LINES = (0.8, 0.68, 0.56), 2  #: sizes that names may have, and lines
LINE, ROUNDING = 1.12, 0.2  #: from line to line, and of a field's corners, in sizes of the text
_FLAGS = (
    imgui.WindowFlags_.no_decoration
    | imgui.WindowFlags_.no_background
    | imgui.WindowFlags_.no_move
    | imgui.WindowFlags_.no_nav
    | imgui.WindowFlags_.no_saved_settings
)


class CategoryStrip:
    """Shows the strip when it is wanted, and takes clicks on it."""

    def __init__(self, when: str, clock: Callable[[], float]) -> None:
        """when: one of study.STRIP_TIMES."""
        self._when = when
        self._clock = clock
        self._moved_s = -math.inf
        self._at: tuple[float, float] | None = None

    def look(self) -> None:
        """See what the mouse does in this frame of a trial."""
        mouse = imgui.get_mouse_pos()
        here = (float(mouse.x), float(mouse.y))
        clicked = any(imgui.is_mouse_down(button) for button in range(3))
        if not imgui.is_mouse_pos_valid(mouse):
            return
        if self._at is None:
            self._at = here
        if clicked or math.dist(self._at, here) > STILL_PX:
            self._at, self._moved_s = here, self._clock()

    def hide(self) -> None:
        """Let it be gone until the mouse moves again."""
        self._moved_s, self._at = -math.inf, None

    @property
    def alpha(self) -> float:
        """How much of it shows, 0 to 1."""
        if self._when == ALWAYS:
            return 1.0
        if self._when != ON_DEMAND:
            return 0.0
        rested = self._clock() - self._moved_s - REST_S
        return min(max(1.0 - rested / FADE_S, 0.0), 1.0)

    def wait_s(self) -> float | None:
        """Until it changes by itself; None where it does not."""
        if self._when != ON_DEMAND or self.alpha == 0.0:
            return None
        return max(self._moved_s + REST_S - self._clock(), FADE_STEP_S)

    def show(
        self, categories: Sequence[str], ink: Ink, window: Size, top: float, text_px: float
    ) -> int | None:
        """Draw the strip at a height; returns the category that was clicked."""
        alpha = self.alpha
        if alpha <= 0.0:
            return None
        gap = round(GAP * text_px)
        size = ImVec2(_field_px(categories, window[0], text_px), round(FIELD_HEIGHT * text_px))
        px, names = _names(categories, size.x - 0.4 * text_px, text_px)
        width = len(categories) * (size.x + gap) - gap
        imgui.set_next_window_pos(ImVec2(round(0.5 * (window[0] - width)), round(top)))
        imgui.set_next_window_size(ImVec2(width, size.y))
        imgui.push_style_var(imgui.StyleVar_.window_padding, ImVec2(0.0, 0.0))
        imgui.push_style_var(imgui.StyleVar_.window_min_size, ImVec2(1.0, 1.0))
        imgui.push_style_var(imgui.StyleVar_.item_spacing, ImVec2(gap, 0.0))
        imgui.begin("##strip", None, _FLAGS)
        clicked = None
        for k, name in enumerate(names):
            if k:
                imgui.same_line()
            if imgui.invisible_button(f"{k + 1}", size):
                clicked = k
            _draw_field([(str(k + 1), round(text_px)), *((line, px) for line in name)], ink, alpha)
        imgui.end()
        imgui.pop_style_var(3)
        return clicked


def _field_px(categories: Sequence[str], window_px: int, text_px: float) -> float:
    """Width of a field: all are alike, as wide as the longest name or as there is room for."""
    imgui.push_font(None, round(NAMES[0] * text_px))
    longest = max(imgui.calc_text_size(name).x for name in categories) + text_px
    imgui.pop_font()
    wanted = min(max(longest, FIELD_WIDTH[0] * text_px), FIELD_WIDTH[1] * text_px)
    share = 0.96 * window_px / len(categories) - GAP * text_px
    return float(max(int(min(wanted, share)), 1))


def _names(
    categories: Sequence[str], room: float, text_px: float
) -> tuple[int, list[tuple[str, ...]]]:
    """Size of the names, and each in lines that fit; no lines where no size is small enough."""
    for share in NAMES:
        px = round(share * text_px)
        imgui.push_font(None, px)
        names = [_broken(name, room) for name in categories]
        fits = all(imgui.calc_text_size(line).x <= room for name in names for line in name)
        imgui.pop_font()
        if fits and max(len(name) for name in names) <= MOST_LINES:
            return px, names
    return 1, [() for _ in categories]


def _broken(text: str, room: float) -> tuple[str, ...]:
    """A text in lines of at most a width, in the present font; a word is never broken."""
    lines: list[str] = []
    for word in text.split():
        longer = f"{lines[-1]} {word}" if lines else word
        if lines and imgui.calc_text_size(longer).x <= room:
            lines[-1] = longer
        else:
            lines.append(word)
    return tuple(lines)


def _draw_field(lines: Sequence[tuple[str, int]], ink: Ink, alpha: float) -> None:
    """Draw the last item as a field with lines of text, each with its size, in its middle."""
    shade = ink.field
    if imgui.is_item_active():
        shade = ink.pressed
    elif imgui.is_item_hovered():
        shade = ink.hovered
    low, high = imgui.get_item_rect_min(), imgui.get_item_rect_max()
    painter = imgui.get_window_draw_list()
    painter.add_rect_filled(low, high, _colour(shade, alpha), ROUNDING * lines[0][1])
    y = 0.5 * (low.y + high.y - LINE * sum(px for _, px in lines))
    for text, px in lines:
        imgui.push_font(None, px)
        wide = imgui.calc_text_size(text).x
        place = ImVec2(round(0.5 * (low.x + high.x - wide)), round(y))
        painter.add_text(imgui.get_font(), px, place, _colour(ink.text, alpha), text)
        imgui.pop_font()
        y += LINE * px


def _colour(shade: Rgb, alpha: float) -> int:
    return int(imgui.color_convert_float4_to_u32(coloured(shade, alpha)))
