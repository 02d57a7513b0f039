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
    closed: tuple[str, ...] = ()  #: titles of panels that don't show
    hidden: bool = False
    docking: str = ""


def load_layout(path: str | os.PathLike[str]) -> WindowLayout:
    """Read a layout; one that is damaged or missing is the first start's."""
    try:
        content = read_toml(path, MAX_BYTES, EXPECTED)
    except InputError:
        return WindowLayout()
    standard = WindowLayout()
    size = content.get("size")
    scale = content.get("font_scale")
    closed = content.get("closed")
    docking = content.get("docking")
    return WindowLayout(
        size=(size[0], size[1]) if size is not None and _is_size(size) else standard.size,
        font_scale=float(scale) if scale in FONT_SCALES else 1.0,
        closed=tuple(t for t in closed if isinstance(t, str)) if isinstance(closed, list) else (),
        hidden=content.get("hidden") is True,
        docking=docking if isinstance(docking, str) else "",
    )


def save_layout(path: str | os.PathLike[str], layout: WindowLayout) -> None:
    """Write a layout, whole or not at all. Raises InputError where that fails."""
    content: dict[str, Any] = {
        "size": list(layout.size),
        "font_scale": layout.font_scale,
        "closed": list(layout.closed),
        "hidden": layout.hidden,
        "docking": layout.docking,
    }
    write_toml(path, content)


def _is_size(value: object) -> bool:
    return (
        isinstance(value, list)
        and len(value) == 2
        and all(type(side) is int and SMALLEST <= side <= LARGEST for side in value)
    )
