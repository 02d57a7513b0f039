"""What all plots of a report share: paper, ink, words that fit, and files that are always alike."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from relgloss_view.base import figures
from relgloss_view.base.figures import INK

DPI = 130
PAPER = "#f4f4f4"  #: of plots: bright, and gray enough to stand on the page
MARK, TRUTH, GOOD = "#d55e00", "#7a3b78", "#1f5f95"  #: Okabe and Ito's vermilion; purple, blue
#: Closeness: one hue, told apart by lightness alone.
SHADES = ("#ffffff", "#cfdfec", "#8fb8d6", "#4b8bbb", "#1d5c93")
UNJUDGED, HATCH = "#e4e4e4", "#b4b4b4"  #: of settings that nobody judged
DASHES = (0, (3.2, 1.6))
HEAD_PT, TEXT_PT, SMALL_PT = 13.0, 9.0, 8.0
LINE = 1.35  #: height of a line, in its letters' size


@contextlib.contextmanager
def drawing() -> Iterator[None]:
    """Within it, figures look alike and nothing from outside is mathematics."""
    style = {
        "font.size": TEXT_PT,
        "text.parse_math": False,
        "axes.grid": False,
        "axes.facecolor": PAPER,
        "hatch.linewidth": 0.6,
    }
    with figures.drawing(style):
        yield


def new_figure(width_in: float, height_in: float) -> Any:
    """A figure of the report, without a window system."""
    return figures.new_figure(width_in, height_in, dpi=DPI, paper=PAPER)


def save(figure: Any, path: Path) -> None:
    """As PNG; the same figure gives the same bytes."""
    figures.save_figure(figure, path)


def axes_at(figure: Any, x_in: float, y_in: float, width_in: float, height_in: float) -> Any:
    """Axes at a place in inches, y from the top."""
    across, down = figure.get_size_inches()
    return figure.add_axes(
        (x_in / across, 1.0 - (y_in + height_in) / down, width_in / across, height_in / down)
    )


def write(
    figure: Any,
    place_in: tuple[float, float],
    text: str,
    width_in: float,
    *,
    size: float = TEXT_PT,
    most: int = 1,
    **style: Any,
) -> float:
    """Lines of text from a place in inches, y from the top; where the next may begin."""
    x, y = place_in
    across, down = figure.get_size_inches()
    lines = fitted(text, width_in, size, most, style.get("weight", "normal"))
    step = LINE * size / 72.0
    for k, line in enumerate(lines):
        figure.text(
            x / across, 1.0 - (y + k * step) / down, line,
            **{"fontsize": size, "color": INK, "va": "top", **style},
        )  # fmt: skip
    return y + len(lines) * step


def height_of(text: str, width_in: float, size: float, most: int) -> float:
    """What `write` takes, in inches."""
    return len(fitted(text, width_in, size, most)) * LINE * size / 72.0


def fitted(text: str, width_in: float, size: float, most: int, weight: str = "normal") -> list[str]:
    """Text as at most so many lines that fit a width; what is left out shows as '...'."""
    from matplotlib.backends.backend_agg import RendererAgg
    from matplotlib.font_manager import FontProperties

    renderer: Any = RendererAgg(1, 1, DPI)  # type: ignore[no-untyped-call]
    font = FontProperties(size=size, weight=weight)

    def fits(line: str) -> bool:
        width: float = renderer.get_text_width_height_descent(line, font, ismath=False)[0]
        return width <= width_in * DPI

    lines: list[str] = [""]
    for word in text.split():
        longer = f"{lines[-1]} {word}".strip()
        if fits(longer):
            lines[-1] = longer
            continue
        if lines[-1]:
            lines.append("")
        for letter in word:  # one by one: a word may be longer than a line
            if lines[-1] and not fits(lines[-1] + letter):
                lines.append("")
            lines[-1] += letter
    if len(lines) > most:
        last = lines[most - 1]
        while last and not fits(f"{last}..."):
            last = last[:-1]
        lines = [*lines[: most - 1], f"{last.rstrip()}..."]
    return lines


def shades() -> Any:
    """Far to close, as matplotlib's map of colours."""
    from matplotlib.colors import LinearSegmentedColormap

    return LinearSegmentedColormap.from_list("closeness", SHADES)


def bare(axes: Any) -> None:
    """No frame and no tick marks: what is drawn has its own edges."""
    for spine in axes.spines.values():
        spine.set_visible(False)
    axes.tick_params(length=0)


def thinned(count: int, room_in: float, each_in: float) -> list[int]:
    """Which labels of an axis have room: all, or every second, third, ..."""
    every = max(1, math.ceil(count * each_in / room_in))
    return list(range(0, count, every))
