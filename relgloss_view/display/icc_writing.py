"""ICC: the colour profile of a declared display, so that other programs show its pictures right."""

from __future__ import annotations

import struct
from functools import lru_cache

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.display.display import Display
from relgloss_view.display.read import monitor_of
from relgloss_view.material.cielab import bradford
from relgloss_view.material.spectra import rgb_to_xyz_matrix, white_from_xy

VERSION = 0x04300000
DATE = (2026, 1, 1, 0, 0, 0)  #: fixed, so that the same display has the same bytes
D50_XYZ = np.array([0.9642, 1.0, 0.8249])  #: of the connection space (ICC.1:2010, 7.2.16)
RELATIVE_COLORIMETRIC = 1


def is_srgb(display: Display) -> bool:
    """Whether digital values of a display are sRGB's."""
    standard = Display()
    return (display.transfer, display.primaries_xy, display.white_xy) == (
        standard.transfer,
        standard.primaries_xy,
        standard.white_xy,
    )


def profile_of(display: Display) -> bytes:
    """The ICC profile of a display's digital values: sRGB's, or one of three curves and a matrix.

    >>> profile_of(Display(transfer="gain-offset-gamma"))[36:40]
    b'acsp'
    """
    if display.profile:
        own = monitor_of(display.profile).icc
        if own is not None:
            return own
    return srgb_profile() if is_srgb(display) else matrix_profile(display)


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

    Colorants are adapted to D50 by Bradford's transform. Sources: ICC.1:2010 (ISO 15076-1), 8.4.3
    for the tags, 10.16 for the curves.
    """
    adaptation = adaptation_to_d50(white_from_xy(display.white_xy))
    colorants = adaptation @ rgb_to_xyz_matrix(display.primaries_xy, display.white_xy)
    curve = _curve(display)
    transfer = "sRGB curve" if display.transfer == "srgb" else f"gamma {display.gamma:g}"
    tags = {
        b"desc": _text("relgloss display, " + transfer),
        b"cprt": _text("No copyright, use freely"),
        b"wtpt": _xyz(D50_XYZ),
        b"chad": b"sf32" + bytes(4) + _fixed(adaptation.ravel()),
        b"rXYZ": _xyz(colorants[:, 0]),
        b"gXYZ": _xyz(colorants[:, 1]),
        b"bXYZ": _xyz(colorants[:, 2]),
        b"rTRC": curve,
        b"gTRC": curve,
        b"bTRC": curve,
    }
    return _profile(tags)


def adaptation_to_d50(white_xyz: Array) -> Array:
    """Matrix (3, 3) that carries XYZ under a white (3,) to XYZ under D50, by Bradford's transform.

    >>> bool(np.allclose(adaptation_to_d50(D50_XYZ), np.eye(3)))
    True
    """
    return bradford(white_xyz, D50_XYZ)


def _curve(display: Display) -> bytes:
    """Light of digital values as a parametric curve: of type 3 for sRGB, otherwise of type 4."""
    if display.transfer == "srgb":  # IEC 61966-2-1:1999
        return _parametric(3, (2.4, 1.0 / 1.055, 0.055 / 1.055, 1.0 / 12.92, 0.04045))
    gain, offset, gamma, flare = display.gain, display.offset, display.gamma, display.flare
    white = (gain + offset) ** gamma + flare
    scale = white ** (-1.0 / gamma)
    dark = max(-offset / gain, 0.0)  # below it the display shows its flare alone
    shown = flare / white
    return _parametric(4, (gamma, scale * gain, scale * offset, 0.0, dark, shown, shown))


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
