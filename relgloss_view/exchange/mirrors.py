"""Mirrors of descriptions: lobes that can be drawn, in place of a roughness of 0."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable
from typing import Any, TypeVar

#: Its facets are about as wide as the narrowest lobe that is drawn here (S_DEG_DRAWN).
LEAST_ROUGHNESS = 0.0324
S = TypeVar("S")


def drawable(surface: S, roughnesses: Iterable[str]) -> tuple[S, list[str]]:
    """A surface with lobes that can be drawn: a point lamp in a mirror has no limit image.

    surface: a frozen dataclass; roughnesses: the names of those of its lobes that count. With it
    comes a line for each that is changed.
    """
    lines: list[str] = []
    changed: dict[str, Any] = {}
    for name in roughnesses:
        value = getattr(surface, name)
        if value < LEAST_ROUGHNESS:
            changed[name] = LEAST_ROUGHNESS
            lines.append(f"{name} {value:g}: a mirror, drawn with {LEAST_ROUGHNESS:.3g}")
    made: Any = dataclasses.replace(surface, **changed)  # type: ignore[type-var]
    return made, lines
