"""Drawing: one pass, ready to be drawn; the names of all passes; and what their drawing found."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any, NamedTuple

from relgloss_view.picture.frame import Scaling
from relgloss_view.picture.gpu.programs import Uniforms
from relgloss_view.picture.model.view import Box

PASSES = (
    "white",
    "grain",
    "shade",
    "split",
    "coverage",
    "tone",
    "edges",
    "light",
    "geometry",
    "counts",
    "overlay",
)


#: A part of a picture -> its tiles, and what reads the surface in each; see surface.py.
Tiles = Callable[[Box], Iterator[tuple[Box, Uniforms]]]


class Drawn(NamedTuple):
    """What the drawing of a picture found out."""

    scaling: Scaling
    white: float  #: Y_n before the lamp's power
    object_pixels: int  #: how many show any of the object
    l_s_max: float  #: largest L_s* of a pixel


class Drawing(NamedTuple):
    """A pass that is drawn on request, over the whole picture or over some of its rows."""

    name: str  #: of PASSES
    stage: str
    defines: Mapping[str, int | str]
    uniforms: Uniforms
    targets: tuple[str, ...]
    bounds: Box | None  #: of the object, where the pass draws nothing outside
    held: str  #: under which name it holds
    parts: tuple[Any, ...] = ()  #: what it holds as long as they are the same
    tiles: Tiles | None = None  #: of the surface that it reads

    @property
    def arguments(self) -> tuple[Any, ...]:
        """Those of Passes.draw."""
        return (*self[:6], self.tiles)
