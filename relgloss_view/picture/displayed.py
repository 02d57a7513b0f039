"""Displayed: the picture that a tone mapping makes of a frame."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from relgloss_view.base.arrays import Array, Bytes, Mask
from relgloss_view.picture.model import tone
from relgloss_view.picture.model.tone import DisplayModel


@dataclass(frozen=True)
class Displayed:
    """The picture of an operator. Arrays are (H, W, ...); the surround fills the rest."""

    operator: str  #: its name in the registry
    light: Array  #: (H, W, 3), linear display RGB, 0 to 1
    digital: Bytes  #: (H, W, 3), digital values of the display
    clipped: Mask  #: where light above the display's white is cut
    out_of_gamut: Mask  #: where a colour that the display can't show is changed
    display: DisplayModel
    warnings: tuple[str, ...] = ()
    settings: Mapping[str, Any] = field(default_factory=dict)  #: the operator's parameters

    @cached_property
    def clip_count(self) -> int:
        """Number of clipped pixels."""
        return int(np.sum(self.clipped))

    @cached_property
    def out_of_gamut_count(self) -> int:
        """Number of pixels out of gamut."""
        return int(np.sum(self.out_of_gamut))

    @cached_property
    def lab(self) -> Array:
        """(H, W, 3), L*, a*, b* of the displayed picture, relative to the display's white."""
        return tone.lab_from_xyz(self.light @ self.display.xyz_from_rgb.T, self.display.white)
