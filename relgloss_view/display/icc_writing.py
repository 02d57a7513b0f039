"""ICC: the colour profile of a display, so that other programs show its pictures right."""

from __future__ import annotations

import struct
from collections.abc import Callable, Sequence
from functools import lru_cache

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.display.display import Display
from relgloss_view.display.model import DisplayModel
from relgloss_view.display.monitor import Curves, Monitor
from relgloss_view.display.read import monitor_of
from relgloss_view.material.cielab import bradford

VERSION, OLD_VERSION = 0x04300000, 0x02400000
COPYRIGHT = "No copyright, use freely"
LONGEST_NAME = 200
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
    emission, floor = monitor.emission, monitor.floor
    return _sampled_profile(
        monitor.white,
        monitor.xyz_from_rgb,
        lambda digital: floor + (1.0 - floor) * emission.light(digital),
        monitor.name,
        monitor.luminance_cd_m2,
    )


@lru_cache(maxsize=8)
def _made(screen: Display, monitor: Monitor) -> bytes:
    """The profile of a display file's monitor, with what a scene declares beside it."""
    model = DisplayModel.emitted(screen)
    luminance = model.luminance_cd_m2 if model.luminance_known else None
    return _sampled_profile(model.white, model.xyz_from_rgb, model.light, monitor.name, luminance)


@lru_cache(maxsize=1)
def srgb_profile() -> bytes:
    """An sRGB ICC profile, the same bytes each time (its date field is fixed)."""
    from PIL import ImageCms

    data = bytearray(ImageCms.ImageCmsProfile(ImageCms.createProfile("sRGB")).tobytes())
    data[24:36] = struct.pack(">6H", *DATE)
    return bytes(data)


@lru_cache(maxsize=8)
def matrix_profile(display: Display) -> bytes:
    """A display profile of primaries and white by a matrix, and of transfer and black by curves.

    display: one that no file describes; what it reflects is left out. sRGB's curve is a formula, of
    version 4.3. Other ones are sampled, of version 2.4, which older programs read too (Argyll 2.3).
    """
    model = DisplayModel.emitted(_screen(display))
    name, luminance = f"gamma {display.gamma:g}", display.luminance_cd_m2
    if display.transfer == "srgb":
        curve = _srgb_curve(float(model.floor[0]))
        tags = _tags(model.white, model.xyz_from_rgb, (curve,) * 3, luminance)
        tags |= {b"desc": _text("relgloss display" + ", sRGB curve"), b"cprt": _text(COPYRIGHT)}
        return _profile(tags | {b"wtpt": _xyz(D50_XYZ)}, VERSION)
    return _sampled_profile(model.white, model.xyz_from_rgb, model.light, name, luminance)


def _sampled_profile(
    white: Array,
    xyz_from_rgb: Array,
    light_of: Callable[[Array], Array],
    name: str,
    luminance: float | None,
) -> bytes:
    """A profile of version 2.4, with a curve of CURVE_ENTRIES a channel; ICC.1:2001, 6.3.1.2.

    light_of: linear RGB (N, 3), black included, of digital values (N, 3).
    """
    nodes = np.linspace(0.0, 1.0, CURVE_ENTRIES)
    light = light_of(np.repeat(nodes[:, None], 3, axis=1))
    tags = _tags(white, xyz_from_rgb, [_sampled(light[:, k]) for k in range(3)], luminance)
    # The screen's own white, which version 2 has here, and version 4 in `chad` alone.
    tags[b"wtpt"] = _xyz(white)
    tags[b"desc"] = _old_text("relgloss display" + f", {name}")
    tags[b"cprt"] = b"text" + bytes(4) + COPYRIGHT.encode("ascii") + b"\0"
    return _profile(tags, OLD_VERSION)


def _tags(
    white: Array, xyz_from_rgb: Array, curves: Sequence[bytes], luminance: float | None
) -> dict[bytes, bytes]:
    """Colorants, adapted to D50 by Bradford's transform, curves, and the luminance of white.

    Sources: ICC.1:2010 (ISO 15076-1), 8.4.3 for the tags, 9.2.23 for cd/m2, 10.5 and 10.16 for the
    curves.
    """
    adaptation = adaptation_to_d50(white)
    colorants = adaptation @ xyz_from_rgb
    tags = {b"desc": b"", b"cprt": b"", b"wtpt": b""}  # in this order
    tags[b"chad"] = b"sf32" + bytes(4) + _fixed(adaptation.ravel())
    tags |= {name + b"XYZ": _xyz(colorants[:, k]) for k, name in enumerate((b"r", b"g", b"b"))}
    tags |= {name + b"TRC": curves[k] for k, name in enumerate((b"r", b"g", b"b"))}
    if luminance is not None:
        tags[b"lumi"] = _xyz(np.array([0.0, luminance, 0.0]))
    return tags


def adaptation_to_d50(white_xyz: Array) -> Array:
    """Matrix (3, 3) that carries XYZ under a white (3,) to XYZ under D50, by Bradford's transform.

    >>> bool(np.allclose(adaptation_to_d50(D50_XYZ), np.eye(3)))
    True
    """
    return bradford(white_xyz, D50_XYZ)


def _srgb_curve(floor: float) -> bytes:
    """sRGB's curve (IEC 61966-2-1:1999) over a neutral light, as a parametric one."""
    own = 1.0 - floor
    if not floor:
        return _parametric(3, (2.4, 1.0 / 1.055, 0.055 / 1.055, 1.0 / 12.92, 0.04045))
    scale = own ** (1.0 / 2.4) / 1.055
    numbers = (2.4, scale, 0.055 * scale, own / 12.92, 0.04045, floor, floor)
    return _parametric(4, numbers)


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


def _old_text(text: str) -> bytes:
    """Text as textDescriptionType, in ASCII; ICC.1:2001, 6.5.17."""
    data = text[:LONGEST_NAME].encode("ascii", "replace") + b"\0"
    return b"desc" + bytes(4) + struct.pack(">I", len(data)) + data + bytes(4 + 4 + 2 + 1 + 67)


def _profile(tags: dict[bytes, bytes], version: int) -> bytes:
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
        start + len(body), b"", version, b"mntr", b"RGB ", b"XYZ ", *DATE, b"acsp", b"", 0, b"",
        0, b"", RELATIVE_COLORIMETRIC, _fixed(D50_XYZ), b"", b"",
    )  # fmt: skip
    return header + struct.pack(">I", len(tags)) + table + body
