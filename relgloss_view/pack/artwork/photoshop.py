"""Image resources of Photoshop, in PSD files and in a tag of TIFF: names and kinds of channels.

Source: Adobe Photoshop File Formats Specification (November 2019), "Image Resources Section".
"""

from __future__ import annotations

import struct
from dataclasses import dataclass

from relgloss_view.base.reading import printable

MOST_RESOURCES = 10_000
MOST_CHANNELS = 60  #: beyond the colour's own
SPOT = 2  #: a channel's kind: values are inverted, 0 where all of it prints
_NAMES, _UNICODE_NAMES, _KINDS, _NEW_KINDS = 1006, 1045, 1007, 1077
_RESOLUTION, _PROFILE, _VERSION = 1005, 1039, 1057


@dataclass(frozen=True)
class Resources:
    """What is used of them. names, kinds: of the channels beyond the colour's own."""

    names: tuple[str, ...] = ()
    kinds: tuple[int, ...] = ()
    profile: bytes | None = None
    dpi: tuple[float, float] = (0.0, 0.0)
    merged: bool = True  #: whether the merged picture is a real one


def parse_resources(data: bytes) -> Resources:
    """The resources of a section. What is damaged or unknown counts as absent."""
    found: dict[int, bytes] = {}
    at = 0
    for _ in range(MOST_RESOURCES):
        if at + 12 > len(data) or data[at : at + 4] not in (b"8BIM", b"MeSa"):
            break
        (number,) = struct.unpack_from(">H", data, at + 4)
        at += 6 + (data[at + 6] + 2) // 2 * 2
        if at + 4 > len(data):
            break
        (size,) = struct.unpack_from(">I", data, at)
        found.setdefault(number, data[at + 4 : at + 4 + size])
        at += 4 + (size + 1) // 2 * 2
    names = _unicode_names(found.get(_UNICODE_NAMES, b"")) or _names(found.get(_NAMES, b""))
    resolution = found.get(_RESOLUTION, b"")
    dpi = (0.0, 0.0)
    if len(resolution) >= 16:
        across, down = (struct.unpack_from(">I", resolution, k)[0] / 65536.0 for k in (0, 8))
        dpi = (across, down)
    version = found.get(_VERSION, b"")
    return Resources(
        names, _kinds(found), found.get(_PROFILE), dpi, len(version) < 5 or version[4] != 0
    )


def channel_names(names: tuple[str, ...], count: int, first: int) -> list[str]:
    """A name for each of `count` channels, unique; `first`: number of the first in the file."""
    made: list[str] = []
    for k in range(count):
        name = printable(names[k], 100) if k < len(names) and names[k].strip() else ""
        name = name or f"Channel {first + k}"
        made.append(name if name not in made else f"{name} {first + k}")
    return made


def _names(data: bytes) -> tuple[str, ...]:
    names: list[str] = []
    at = 0
    while at < len(data) and len(names) < MOST_CHANNELS:
        size = data[at]
        names.append(data[at + 1 : at + 1 + size].decode("latin-1"))
        at += 1 + size
    return tuple(names)


def _unicode_names(data: bytes) -> tuple[str, ...]:
    names: list[str] = []
    at = 0
    while at + 4 <= len(data) and len(names) < MOST_CHANNELS:
        size = 2 * struct.unpack_from(">I", data, at)[0]
        text = data[at + 4 : at + 4 + size].decode("utf-16-be", "replace")
        names.append(text.rstrip("\0"))
        at += 4 + size
    return tuple(names)


def _kinds(found: dict[int, bytes]) -> tuple[int, ...]:
    new, old = found.get(_NEW_KINDS, b""), found.get(_KINDS, b"")
    if new:
        return tuple(new[4 + 12 :: 13][:MOST_CHANNELS])
    return tuple(old[12::14][:MOST_CHANNELS])
