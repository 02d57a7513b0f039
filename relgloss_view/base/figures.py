"""Figures: one style for every plot, drawn without a window system, saved as the same bytes.

matplotlib is imported only where a figure is made, because it is slow to import.
"""

from __future__ import annotations

import contextlib
import logging
import os
import warnings
from collections.abc import Iterator, Mapping
from typing import Any

from relgloss_view.base.fonts import font_files

INK, MUTED, FAINT, ACCENT = "#1b1f24", "#66707a", "#d9dee3", "#b3261e"
WHITE = "white"
#: matplotlib's settings for every plot; a caller overrides single entries in `drawing`.
STYLE: dict[str, Any] = {
    "font.size": 8.0,
    "font.family": ["DejaVu Sans"],  # `drawing` adds fonts for letters that it lacks
    "axes.edgecolor": MUTED,
    "axes.labelcolor": INK,
    "axes.linewidth": 0.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.titlesize": 9.0,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.grid": True,
    "grid.color": FAINT,
    "grid.linewidth": 0.5,
    "xtick.color": MUTED,
    "ytick.color": MUTED,
    "legend.frameon": False,
    "legend.fontsize": 7.0,
    "text.parse_math": False,  # a name with two dollar signs is a name, and may be no formula
    "svg.hashsalt": "relgloss",  # identifiers in an SVG depend on its content alone
}


@contextlib.contextmanager
def drawing(overrides: Mapping[str, Any] | None = None) -> Iterator[None]:
    """Apply STYLE within the block; `overrides` are further settings by matplotlib's names."""
    from matplotlib import rc_context

    settings: Any = {**STYLE, **(overrides or {})}  # matplotlib types each name by itself
    settings["font.family"] = [*settings["font.family"], *_other_families()]
    # Fonts for other scripts come in one weight, and matplotlib reports every other asked of them.
    logging.getLogger("matplotlib.font_manager").setLevel(logging.ERROR)
    with rc_context(settings), warnings.catch_warnings():
        # A name in a script that no font here has shows boxes; that is no fault.
        warnings.filterwarnings("ignore", message="Glyph", category=UserWarning)
        yield


def _other_families() -> list[str]:
    """Fonts that hold other scripts than DejaVu Sans, made known to matplotlib, by name."""
    from matplotlib.font_manager import FontProperties, fontManager

    names = []
    for file in font_files()[1:]:
        present = [font.name for font in fontManager.ttflist if font.fname == file.path]
        if not present:
            fontManager.addfont(file.path)
            present = [FontProperties(fname=file.path).get_name()]
        names.append(present[0])
    return names


def new_figure(
    width_in: float, height_in: float, dpi: float, *, paper: str = WHITE, layout: Any = None
) -> Any:
    """A matplotlib figure of a size in inches, without a window system.

    `paper` is its background colour; `layout` is matplotlib's own, such as "constrained".
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width_in, height_in), dpi=dpi, facecolor=paper, layout=layout)
    FigureCanvasAgg(figure)
    return figure


def save_figure(figure: Any, path: str | os.PathLike[str], kind: str = "png") -> None:
    """Write a figure as "png" or "svg"; the same figure gives the same bytes.

    The writer's version and the date are left out. The caller puts the file in place.
    """
    metadata = {"png": {"Software": None}, "svg": {"Date": None}}[kind]
    figure.savefig(path, format=kind, metadata=metadata)
