"""Displayed: the picture that a tone mapping makes of a frame."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from relgloss_view.base.arrays import Array, Bytes, Floats, Mask
from relgloss_view.display.model import DisplayModel
from relgloss_view.picture.frame import Frame
from relgloss_view.picture.model import tone
from relgloss_view.picture.model.silhouette import smoothed
from relgloss_view.picture.stages import NEIGHBOURING_ROWS, Part

#: What is computed from one pixel of a picture on its way takes some 200 bytes.
PIXELS_AT_A_TIME = 1 << 16


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

    def for_display(self, frame: Frame) -> Displayed:
        """The same picture, its digital values with the frame's smooth silhouettes and dither."""
        display = frame.scene.display
        if frame.edges is None and display.dither == "none":
            return self
        digital = Digitised(frame)
        step = max(PIXELS_AT_A_TIME // frame.size[0], 1)
        for first in range(0, frame.size[1], step):
            digital.add(self.light[first : first + step])
        return dataclasses.replace(self, digital=digital.values)

    def without_light(self) -> Displayed:
        """The same to look at and to count; its light, most of its memory, is left out."""
        slim = dataclasses.replace(self, light=np.zeros((0, 0, 3)))
        _ = slim.clip_count, slim.out_of_gamut_count
        return slim

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
        light = tone.as_shown(self.light, self.display)
        return tone.lab_from_xyz(light @ self.display.xyz_from_rgb.T, self.display.white)


class Digitised:
    """The digital values of a frame's picture whose light comes some rows at a time, from the top.

    They have the frame's smooth silhouettes and dither. Of the light two rows are kept.
    """

    def __init__(self, frame: Frame) -> None:
        self.values: Bytes = np.empty((frame.size[1], frame.size[0], 3), dtype=np.uint8)
        self._frame = frame
        self._display = DisplayModel.of(frame.scene.display)
        self._dithered = frame.scene.display.dither == "ordered"
        self._done = 0  #: rows
        self._held: Array = np.zeros((0, frame.size[0], 3))
        self._first = 0  #: row of what is held

    def add(self, light: Array) -> None:
        """The next rows, linear display RGB (rows, W, 3) with the frame's samples."""
        held = np.concatenate([self._held, light]) if len(self._held) else light
        height, end = self._frame.size[1], self._first + len(held)
        last = end if end == height else end - NEIGHBOURING_ROWS
        if last > self._done:
            part = Part(self._frame, self._done, last)
            own = held[part.rows.start - self._first : part.rows.stop - self._first]
            picture, shows = shown_light(part, own)
            dithered = shows[part.own] if self._dithered else None
            steps = tone.digital_steps(picture[part.own], self._display, dithered, height - last)
            self.values[self._done : last] = steps
            self._done = last
        kept = max(self._done - NEIGHBOURING_ROWS - self._first, 0)
        self._held = held[kept:].copy()
        self._first += kept


def shown_light(frame: Frame | Part, light: Floats) -> tuple[Array, Mask]:
    """Linear light (H, W, 3) of a frame's picture as it is to show, and where it shows the object.

    light: with the frame's samples; smooth silhouettes are mixed in where the frame has them.
    """
    background = DisplayModel.of(frame.scene.display).background_rgb
    picture, on_object = np.asarray(light, dtype=np.float64), frame.on_object
    if frame.edges is None:
        return picture, on_object
    return smoothed(picture, on_object, frame.edges, background)


def cut_out(frame: Frame | Part, light: Floats) -> tuple[Array, Array]:
    """The object of a picture without its surround, for compositing: RGB (H, W, 3), A (H, W).

    light: linear, with the frame's samples, over the surround. A is the share of the pixel that the
    object covers, by smooth silhouettes where the frame has them. RGB is premultiplied by A (Porter
    and Duff 1984), so that RGB + (1 - A) times the surround's light is the picture as it shows.
    Where the object is black, RGB is the display's black, reflected light included.
    """
    display = DisplayModel.of(frame.scene.display)
    background = display.background_rgb
    on_object = frame.on_object
    share = np.where(on_object, frame.coverage, 0.0).astype(np.float64)
    shown = tone.as_shown(np.asarray(light, dtype=np.float64), display)
    over = shown - (1.0 - share[..., None]) * background
    picture = np.where(on_object[..., None], np.maximum(over, 0.0), 0.0)
    if frame.edges is None:
        return picture, share
    picture, shows = smoothed(picture, on_object, frame.edges, 0.0)
    column, row = frame.edges[:, 0].astype(np.int64), frame.edges[:, 1].astype(np.int64)
    share[row, column] = np.where(shows[row, column], frame.edges[:, 2], 0.0)
    return picture, share
