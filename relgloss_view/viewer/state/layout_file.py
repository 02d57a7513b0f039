"""The window's layout, kept between runs: its size, its panels, the size of its text."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.toml import read_toml, write_toml

MAX_BYTES = 256 * 1024
EXPECTED = "a window layout (TOML)"
DEFAULT_SIZE = (1280, 800)
SMALLEST, LARGEST = 64, 8192  #: pixels a side of a window that is kept
FONT_SCALES = (0.75, 1.0, 1.25, 1.5, 2.0, 3.0)


@dataclass(frozen=True)
class WindowLayout:
    """Sizes are in pixels; `docking` is ImGui's own text."""

    size: tuple[int, int] = DEFAULT_SIZE
    font_scale: float = 1.0
    closed: tuple[str, ...] | None = None  #: titles of panels that don't show; None as at first
    hidden: bool = False
    docking: str = ""
    catalogue: str = ""  #: folder of the one that was open last


def load_layout(path: str | os.PathLike[str]) -> WindowLayout:
    """Read a layout; one that is damaged or missing is the first start's."""
    try:
        content = read_toml(path, MAX_BYTES, EXPECTED)
    except InputError:
        return WindowLayout()
    standard = WindowLayout()
    size = content.get("size")
    scale = content.get("font_scale")
    docking = content.get("docking")
    catalogue = content.get("catalogue")
    return WindowLayout(
        size=(size[0], size[1]) if size is not None and _is_size(size) else standard.size,
        font_scale=float(scale) if scale in FONT_SCALES else 1.0,
        closed=_titles(content.get("closed")),
        hidden=content.get("hidden") is True,
        docking=docking if isinstance(docking, str) else "",
        catalogue=catalogue if isinstance(catalogue, str) else "",
    )


def save_layout(path: str | os.PathLike[str], layout: WindowLayout) -> None:
    """Write a layout, whole or not at all. Raises InputError where that fails."""
    content: dict[str, Any] = {
        "size": list(layout.size),
        "font_scale": layout.font_scale,
        "hidden": layout.hidden,
        "docking": layout.docking,
        "catalogue": layout.catalogue,
    }
    if layout.closed is not None:
        content["closed"] = list(layout.closed)
    write_toml(path, content)


def _titles(value: object) -> tuple[str, ...] | None:
    """The titles in a list, which may be empty; None for whatever has no title in it."""
    if not isinstance(value, list):
        return None
    titles = tuple(title for title in value if isinstance(title, str))
    return titles if titles or not value else None


def _is_size(value: object) -> bool:
    return (
        isinstance(value, list)
        and len(value) == 2
        and all(type(side) is int and SMALLEST <= side <= LARGEST for side in value)
    )
