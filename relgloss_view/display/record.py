"""DisplayRecord: what is kept of the display that showed pictures, in numbers.

An analysis compares displays by it years later, without reading or evaluating a profile.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from functools import cached_property
from typing import Any

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.reading import printable
from relgloss_view.display.display import Display
from relgloss_view.display.model import DisplayModel

LEVELS = (0.0, 0.25, 0.5, 0.75, 1.0)  #: of each channel
#: (125, 3): the fixed digital values; blue changes fastest.
COLOURS = np.stack(np.meshgrid(LEVELS, LEVELS, LEVELS, indexing="ij"), axis=-1).reshape(-1, 3)
COLOURS.setflags(write=False)
BLACK, WHITE = 0, len(COLOURS) - 1  #: of COLOURS
DIGITS = 7  #: of a kept number: a hundredth of a step of 16 bits
#: Where a display came from: the command line, the study, the system, or nowhere.
OPTION, STUDY, SYSTEM, ASSUMED = "option", "study", "system", "assumed"
ORIGINS = {
    OPTION: "given with --display",
    STUDY: "of the study",
    SYSTEM: "of the system",
    ASSUMED: "assumed",
}
SOURCES = ("profile", "readings", "declared")  #: what a display is known by
LONGEST_NAME = 200
LARGEST = 1e6  #: of a number in a record


@dataclass(frozen=True)
class DisplayRecord:
    """A display as it was when it showed pictures.

    name: of the display. source: one of SOURCES. origin: one of ORIGINS. digest: SHA-256 of what
    its file states, "" without a file. luminance_cd_m2: of white, with reflected light; the usual
    one where luminance_known is false. black_cd_m2: at digital 0, with reflected light; 0 where
    black_known is false. white_xy, primaries_xy: CIE 1931. xyz: of
    COLOURS, relative to white at Y = 1, (125, 3) as one list.

    >>> record = DisplayRecord.of(Display(), ASSUMED)
    >>> record.name, record.luminance_known, record.white_xy
    ('sRGB', False, (0.3127, 0.329))
    """

    name: str
    source: str
    origin: str
    digest: str
    luminance_cd_m2: float
    luminance_known: bool
    black_cd_m2: float
    black_known: bool
    reflected_cd_m2: float
    white_xy: tuple[float, float]
    primaries_xy: tuple[tuple[float, float], ...]
    xyz: tuple[float, ...]

    @classmethod
    def of(cls, display: Display, origin: str, digest: str = "") -> DisplayRecord:
        """The record of the screen that stands before the observer; not that of `seen_on`."""
        model = DisplayModel.of(display)
        model = model if model.screen is None else model.screen
        monitor = model.monitor
        xyz = model.xyz(COLOURS)
        reflected = display.reflected_cd_m2
        if monitor is None:
            source, name = "declared", _declared_name(display)
        else:
            source, name = monitor.source, monitor.name
            reflected = reflected or monitor.reflected_cd_m2
        return cls(
            name=printable(name, LONGEST_NAME)[:LONGEST_NAME],
            source=source,
            origin=origin,
            digest=digest,
            luminance_cd_m2=_kept(float(model.luminance_cd_m2)),
            luminance_known=model.luminance_known,
            black_cd_m2=_kept(max(model.black_cd_m2, 0.0)),
            black_known=model.black_known,
            reflected_cd_m2=_kept(reflected),
            white_xy=_xy(model.white),
            primaries_xy=tuple(_xy(column) for column in model.xyz_from_rgb.T),
            xyz=tuple(_kept(v) for v in xyz.ravel()),
        )

    @cached_property
    def table(self) -> Array:
        """XYZ (125, 3) of COLOURS."""
        return np.array(self.xyz).reshape(-1, 3)

    @property
    def words(self) -> str:
        """The display in a line, for people.

        >>> DisplayRecord.of(Display(luminance_cd_m2=160.0), STUDY).words
        'sRGB (of the study), 160 cd/m2, black unknown'
        """
        light = f"{self.luminance_cd_m2:.3g} cd/m2" if self.luminance_known else "luminance unknown"
        dark = f"black {self.black_cd_m2:.3g} cd/m2" if self.black_known else "black unknown"
        return f"{printable(self.name, 60)} ({ORIGINS[self.origin]}), {light}, {dark}"

    def to_dict(self) -> dict[str, Any]:
        """As JSON holds it."""
        return {
            **asdict(self),
            "white_xy": list(self.white_xy),
            "primaries_xy": [v for xy in self.primaries_xy for v in xy],
            "xyz": list(self.xyz),
        }

    @classmethod
    def from_dict(cls, content: object) -> DisplayRecord:
        """The record of to_dict; ValueError for anything that no program has written."""
        if not isinstance(content, Mapping) or set(content) != set(cls.__dataclass_fields__):
            raise ValueError("display")
        values = dict(content)
        for name in ("name", "source", "origin", "digest"):
            if not isinstance(values[name], str) or len(values[name]) > LONGEST_NAME:
                raise ValueError("display")
        if values["origin"] not in ORIGINS or values["source"] not in SOURCES:
            raise ValueError("display")
        for name in ("luminance_known", "black_known"):
            if not isinstance(values[name], bool):
                raise ValueError("display")
        for name in ("luminance_cd_m2", "black_cd_m2", "reflected_cd_m2"):
            (values[name],) = _numbers([values[name]], 1)
        if values["luminance_cd_m2"] <= 0.0 or values["black_cd_m2"] < 0.0:
            raise ValueError("display")
        white, corners = _numbers(values["white_xy"], 2), _numbers(values["primaries_xy"], 6)
        values["white_xy"] = (white[0], white[1])
        values["primaries_xy"] = tuple(zip(corners[::2], corners[1::2], strict=True))
        values["xyz"] = _numbers(values["xyz"], COLOURS.size)
        if min(values["xyz"][3 * WHITE :]) <= 0.0:
            raise ValueError("display")
        return cls(**values)


def _declared_name(display: Display) -> str:
    """What a display is called that no file describes."""
    plain = Display()
    if display.transfer == "srgb":
        same = (display.primaries_xy, display.white_xy) == (plain.primaries_xy, plain.white_xy)
        return "sRGB" if same else "sRGB curve with declared primaries"
    return f"declared, gamma {display.gamma:g}"


def _xy(xyz: Array) -> tuple[float, float]:
    total = float(np.sum(xyz))
    if not total > 1e-9:  # of a channel that emits nothing
        return 0.0, 0.0
    return _kept(float(xyz[0]) / total), _kept(float(xyz[1]) / total)


def _kept(value: float) -> float:
    return float(f"{value:.{DIGITS}g}")


def _numbers(values: object, count: int) -> tuple[float, ...]:
    if not isinstance(values, list | tuple) or len(values) != count:
        raise ValueError("display")
    for value in values:
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise ValueError("display")
        if not (math.isfinite(value) and abs(value) <= LARGEST):
            raise ValueError("display")
    return tuple(float(value) for value in values)
