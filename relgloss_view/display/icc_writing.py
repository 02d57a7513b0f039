"""ICC: the colour profile of a display, so that other programs show its pictures right."""

from __future__ import annotations

import dataclasses
import struct
from functools import lru_cache

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.display.display import Display
from relgloss_view.display.model import DisplayModel
from relgloss_view.display.monitor import Curves, Monitor
from relgloss_view.display.read import monitor_of
from relgloss_view.material.cielab import bradford

VERSION = 0x04300000
DATE = (2026, 1, 1, 0, 0, 0)  #: fixed, so that the same display has the same bytes
D50_XYZ = np.array([0.9642, 1.0, 0.8249])  #: of the connection space (ICC.1:2010, 7.2.16)
RELATIVE_COLORIMETRIC = 1
CURVE_ENTRIES = 4096  #: of a sampled curve; 16 bits each


def is_srgb(display: Display) -> bool:
    """Whether digital values of a display are sRGB's."""
    standard = Display()
    return (display.transfer, display.primaries_xy, display.white_xy) == (
        standard.transfer,
        standard.primaries_xy,
        standard.white_xy,
    )


def profile_of(display: Display) -> bytes:
    """The ICC profile of the digital values of a display's pictures, as the screen emits them.

    It is the file that the display names, or one that is made: of what a display file describes, of
    gain, offset, gamma and flare, or of a declared black; otherwise it is sRGB's. Light that the
    screen reflects is the room's, and in no profile. `seen_on` changes digital values of this
    display, whose profile it is.

    >>> profile_of(Display(transfer="gain-offset-gamma"))[36:40]
    b'acsp'
    """
    if display.profile:
        monitor = monitor_of(display.profile)
        return monitor.icc if monitor.icc is not None else _made(_screen(display), monitor)
    plain = display.black_cd_m2 is None
    return srgb_profile() if is_srgb(display) and plain else matrix_profile(_screen(display))


def _screen(display: Display) -> Display:
    """What of a display a profile describes, and nothing else, so that made profiles are kept."""
    entries = [
        *("transfer", "gain", "offset", "gamma", "flare", "primaries_xy", "white_xy"),
        *("profile", "luminance_cd_m2", "black_cd_m2"),
    ]
    return Display(**{entry: getattr(display, entry) for entry in entries})


def profile_of_monitor(monitor: Monitor) -> bytes:
    """The profile of a monitor: its own, or matrix and curves of what its readings showed.

    Raises ValueError where light is not a curve a channel and there is no profile of its own.
    """
    if monitor.icc is not None:
        return monitor.icc
    if not isinstance(monitor.emission, Curves):
        raise ValueError("a look-up table is not written as a profile")
    nodes = np.linspace(0.0, 1.0, CURVE_ENTRIES)
    light = monitor.floor + (1.0 - monitor.floor) * monitor.emission.light(
        np.repeat(nodes[:, None], 3, axis=1)
    )
    curves = [_sampled(light[:, k]) for k in range(3)]
    return _matrix_and_curves(
        monitor.white, monitor.xyz_from_rgb, curves, monitor.name, monitor.luminance_cd_m2
    )


@lru_cache(maxsize=8)
def _made(screen: Display, monitor: Monitor) -> bytes:
    """The profile of a display file's monitor with what a scene declares beside it."""
    model = DisplayModel.of(screen)
    declared = dataclasses.replace(
        monitor,
        xyz_from_rgb=model.xyz_from_rgb,
        floor=model.floor,
        luminance_cd_m2=model.luminance_cd_m2 if model.luminance_known else None,
    )
    return profile_of_monitor(declared)


@lru_cache(maxsize=1)
def srgb_profile() -> bytes:
    """An sRGB ICC profile, the same bytes each time (its date field is fixed)."""
    from PIL import ImageCms

    data = bytearray(ImageCms.ImageCmsProfile(ImageCms.createProfile("sRGB")).tobytes())
    data[24:36] = struct.pack(">6H", *DATE)
    return bytes(data)


@lru_cache(maxsize=8)
def matrix_profile(display: Display) -> bytes:
    """A display profile of version 4.3: primaries and white by a matrix, transfer by a formula.

    display: one that no file describes; what it reflects is left out. Colorants are adapted to D50
    by Bradford's transform. Sources: ICC.1:2010 (ISO 15076-1), 8.4.3 for the tags, 9.2.23 for the
    luminance of white in cd/m2, 10.16 for the curves.
    """
    model = DisplayModel.of(_screen(display))
    curve = _curve(display, float(model.floor[0]))
    transfer = "sRGB curve" if display.transfer == "srgb" else f"gamma {display.gamma:g}"
    return _matrix_and_curves(
        model.white, model.xyz_from_rgb, [curve] * 3, transfer, display.luminance_cd_m2
    )


def _matrix_and_curves(
    white: Array, xyz_from_rgb: Array, curves: list[bytes], name: str, luminance: float | None
) -> bytes:
    adaptation = adaptation_to_d50(white)
    colorants = adaptation @ xyz_from_rgb
    tags = {
        b"desc": _text(f"relgloss display, {name}"),
        b"cprt": _text("No copyright, use freely"),
        b"wtpt": _xyz(D50_XYZ),
        b"chad": b"sf32" + bytes(4) + _fixed(adaptation.ravel()),
        b"rXYZ": _xyz(colorants[:, 0]),
        b"gXYZ": _xyz(colorants[:, 1]),
        b"bXYZ": _xyz(colorants[:, 2]),
        b"rTRC": curves[0],
        b"gTRC": curves[1],
        b"bTRC": curves[2],
    }
    if luminance is not None:
        tags[b"lumi"] = _xyz(np.array([0.0, luminance, 0.0]))
    return _profile(tags)


def adaptation_to_d50(white_xyz: Array) -> Array:
    """Matrix (3, 3) that carries XYZ under a white (3,) to XYZ under D50, by Bradford's transform.

    >>> bool(np.allclose(adaptation_to_d50(D50_XYZ), np.eye(3)))
    True
    """
    return bradford(white_xyz, D50_XYZ)


def _curve(display: Display, floor: float) -> bytes:
    """Light of digital values as a parametric curve: of type 3 for sRGB, otherwise of type 4.

    floor: the neutral light under it, below 0 where a declared black is darker than the curve's.
    """
    own = 1.0 - floor
    if display.transfer == "srgb":  # IEC 61966-2-1:1999
        numbers = (1.0 / 1.055, 0.055 / 1.055, 1.0 / 12.92, 0.04045)
        if not floor:
            return _parametric(3, (2.4, *numbers))
        scale, slope = own ** (1.0 / 2.4), own * numbers[2]
        bent = (2.4, scale * numbers[0], scale * numbers[1], slope, numbers[3])
        return _parametric(4, (*bent, floor, floor))
    gain, offset, gamma, flare = display.gain, display.offset, display.gamma, display.flare
    white = (gain + offset) ** gamma + flare
    scale = (own / white) ** (1.0 / gamma) if floor else white ** (-1.0 / gamma)
    dark = max(-offset / gain, 0.0)  # below it the display shows its flare alone
    shown = floor + own * flare / white
    return _parametric(4, (gamma, scale * gain, scale * offset, 0.0, dark, shown, shown))


def _sampled(light: Array) -> bytes:
    """Light (n,) of evenly spaced digital values as a curve of 16 bits, which can't be below 0."""
    whole = np.floor(65535.0 * np.clip(light, 0.0, 1.0) + 0.5).astype(">u2")
    return b"curv" + bytes(4) + struct.pack(">I", len(whole)) + whole.tobytes()


def _parametric(kind: int, numbers: tuple[float, ...]) -> bytes:
    return b"para" + bytes(4) + struct.pack(">HH", kind, 0) + _fixed(np.array(numbers))


def _xyz(xyz: Array) -> bytes:
    return b"XYZ " + bytes(4) + _fixed(xyz)


def _fixed(numbers: Array) -> bytes:
    """Signed numbers of 16 bits before and after the point."""
    whole = np.round(65536.0 * numbers).astype(np.int64)
    return struct.pack(f">{len(whole)}i", *whole.tolist())


def _text(text: str) -> bytes:
    """Text in English, as multiLocalizedUnicodeType."""
    data = text.encode("utf-16-be")
    return b"mluc" + bytes(4) + struct.pack(">II2s2sII", 1, 12, b"en", b"US", len(data), 28) + data


def _profile(tags: dict[bytes, bytes]) -> bytes:
    """Header, table and data of a profile; equal data are written once."""
    table, body, places = b"", b"", {}
    start = 128 + 4 + 12 * len(tags)
    for name, data in tags.items():
        if data not in places:
            places[data] = start + len(body)
            body += data + bytes(-len(data) % 4)
        table += struct.pack(">4sII", name, places[data], len(data))
    header = struct.pack(
        ">I4sI4s4s4s6H4s4sI4sI8sI12s4s44s",
        start + len(body), b"", VERSION, b"mntr", b"RGB ", b"XYZ ", *DATE, b"acsp", b"", 0, b"",
        0, b"", RELATIVE_COLORIMETRIC, _fixed(D50_XYZ), b"", b"",
    )  # fmt: skip
    return header + struct.pack(">I", len(tags)) + table + body
