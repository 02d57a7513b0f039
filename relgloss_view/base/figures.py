"""Figures: one style for every plot, drawn without a window system, saved as the same bytes.

matplotlib is imported only where a figure is made, because it is slow to import. A user's own
settings of it (matplotlibrc) have no influence here.
"""

from __future__ import annotations

import atexit
import contextlib
import logging
import os
import sys
import warnings
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

from relgloss_view.base.fonts import font_files
from relgloss_view.base.interruptions import checkpoint
from relgloss_view.base.temporaries import scratch_folder

INK, MUTED, FAINT, ACCENT = "#1b1f24", "#66707a", "#d9dee3", "#b3261e"
WHITE = "white"
#: matplotlib's settings for every plot; a caller overrides single entries in `drawing`.
STYLE: dict[str, Any] = {
    "font.size": 8.0,
    "font.family": ["DejaVu Sans"],  # `drawing` adds fonts for letters that it lacks
    "text.parse_math": False,  # names from outside hold dollar signs; they are no formulas
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
    "svg.hashsalt": "relgloss",  # identifiers in an SVG depend on its content alone
}


def _settle_config() -> None:
    """Give matplotlib a folder for its list of fonts that goes with this program.

    Where the user's own can't be written it would make one, which a killed program leaves.
    """
    if "matplotlib" not in sys.modules and not _has_config():
        kept = contextlib.ExitStack()
        atexit.register(kept.close)
        os.environ["MPLCONFIGDIR"] = os.fspath(kept.enter_context(scratch_folder()))


def _has_config() -> bool:
    """Whether matplotlib finds folders that can be written, where it looks for them on Linux."""
    named = os.environ.get("MPLCONFIGDIR")
    try:
        places = [Path(named)] if named else [
            Path(os.environ.get(variable) or Path.home() / below, "matplotlib")
            for variable, below in (("XDG_CONFIG_HOME", ".config"), ("XDG_CACHE_HOME", ".cache"))
        ]  # fmt: skip
    except RuntimeError:  # there is no home
        return False
    for place in places:
        there = place.absolute()
        while not os.path.lexists(there):
            there = there.parent
        if not (there.is_dir() and os.access(there, os.W_OK | os.X_OK)):
            return False
    return True


@contextlib.contextmanager
def drawing(overrides: Mapping[str, Any] | None = None) -> Iterator[None]:
    """Apply STYLE within the block; `overrides` are further settings by matplotlib's names."""
    _settle_config()
    _load_matplotlib()
    from matplotlib import rc_context, rcdefaults, rcParams

    settings: Any = {**STYLE, **(overrides or {})}  # matplotlib types each name by itself
    settings["font.family"] = [*settings["font.family"], *_other_families()]
    with rc_context(), warnings.catch_warnings():
        rcdefaults()
        rcParams.update(settings)
        # A name in a script that no font here has shows boxes; that is no fault.
        warnings.filterwarnings("ignore", message="Glyph", category=UserWarning)
        yield


def _load_matplotlib() -> None:
    """Import it quietly, and whatever MPLBACKEND names: no backend with a window is used."""
    # Before the import, for matplotlib reports at length where its own folder can't be written.
    # Fonts for other scripts come in one weight, and it reports every other that is asked of them.
    for name in ("matplotlib", "matplotlib.font_manager"):
        logging.getLogger(name).setLevel(logging.ERROR)
    backend = os.environ.pop("MPLBACKEND", None)
    try:
        import matplotlib  # noqa: F401
    finally:
        if backend is not None:
            os.environ["MPLBACKEND"] = backend


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
    checkpoint()
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
    for axes in figure.axes:
        axes.draw = _with_checkpoint(axes.draw)
    figure.savefig(path, format=kind, metadata=metadata)


def _with_checkpoint(draw: Callable[..., None]) -> Callable[..., None]:
    """The drawing of axes, which matplotlib does in Python: an exception passes through."""

    def checked(*args: Any, **options: Any) -> None:
        checkpoint()
        draw(*args, **options)

    return checked
