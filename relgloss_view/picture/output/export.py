"""Frames to files: PNG for eyes, OpenEXR for numbers. Files appear whole or not at all."""

from __future__ import annotations

import json
import math
import os
from dataclasses import asdict
from functools import lru_cache
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from relgloss_view.base.errors import InputError
from relgloss_view.base.version import __version__
from relgloss_view.base.writing import whole_file
from relgloss_view.picture.displayed import Displayed
from relgloss_view.picture.frame import Frame
from relgloss_view.picture.model import tone
from relgloss_view.picture.model.pixel_sampling import sample_count
from relgloss_view.picture.output.png16 import write_png16
from relgloss_view.picture.scene.setup import Display

Digital = NDArray[np.uint8] | NDArray[np.uint16]

SUFFIXES = (".png", ".exr")
SPLIT = "split"  #: the operator whose picture a frame itself is
#: Layer name, attribute of Frame, channel names.
LAYERS = (
    ("diffuse", "diffuse", "XYZ"),
    ("specular", "specular", "XYZ"),
    ("N", "normal", "XYZ"),
    ("Np", "tilted_normal", "XYZ"),
    ("P", "point_m", "XYZ"),
    ("Lab", "lab", "LAB"),
)


def check_suffix(path: str | os.PathLike[str]) -> Path:
    """The path, if its ending names a format that is written; InputError otherwise."""
    file = Path(path)
    if file.suffix.lower() not in SUFFIXES:
        raise InputError(f"{file}: expected a name that ends in {' or '.join(SUFFIXES)}")
    return file


def save_frame(
    frame: Frame,
    path: str | os.PathLike[str],
    command: str = "",
    *,
    bits: int = 8,
    shown: Displayed | None = None,
) -> None:
    """Write a frame as PNG or OpenEXR, by the ending of its name.

    `command` is the command line that reproduces it; it goes into the file. `bits`, 8 or 16,
    are those of a channel of a PNG. `shown` is what another operator than the split shows of it.
    """
    file = check_suffix(path)
    if file.suffix.lower() == ".png":
        _save_png(frame, file, command, bits, shown)
    else:
        _save_exr(frame, file, command, shown)


def save_pair(
    frames: tuple[Frame, Frame],
    path: str | os.PathLike[str],
    commands: tuple[str, str],
    *,
    gap_px: int = 0,
    mirrored: bool = False,
    bits: int = 8,
    shown: tuple[Displayed | None, Displayed | None] = (None, None),
) -> None:
    """Write the reference and the test picture side by side as one PNG, as the window shows them.

    Both are of one size, for one display, with the surround between them. When mirrored they are
    swapped, and each is mirrored. `shown`: see save_frame.
    """
    file = Path(path)
    if file.suffix.lower() != ".png":
        raise InputError(f"{file}: expected a name that ends in .png, which holds both pictures")
    told = {
        "reference": parameters(frames[0], shown[0]),
        "test": parameters(frames[1], shown[1]),
        "gap_px": gap_px,
        "mirrored": mirrored,
    }
    display = frames[0].scene.display
    left, right = (digital(*both, bits) for both in zip(frames, shown, strict=True))
    if mirrored:
        left, right = right[:, ::-1], left[:, ::-1]
    model = tone.DisplayModel.of(display)
    surround = _quantised(np.array(tone.encode(np.array(model.background_light), model)), bits)
    gap = np.full((left.shape[0], gap_px, 3), surround, dtype=surround.dtype)
    text = _text(json.dumps(told), "\n".join(commands))
    save_rgb(np.concatenate([left, gap, right], axis=1), file, text, srgb=is_srgb(display))


def digital(frame: Frame, shown: Displayed | None, bits: int) -> Digital:
    """(H, W, 3), digital values of the display: the picture's own 8 bits, or its light in 16."""
    if bits == 8:
        return frame.display if shown is None else shown.digital
    light = (frame if shown is None else shown).light.astype(np.float64)
    return _quantised(tone.encode(light, tone.DisplayModel.of(frame.scene.display)), bits)


def parameters(frame: Frame, shown: Displayed | None = None) -> dict[str, Any]:
    """Everything that goes into a frame, but for the material's spectra, and what came out.

    `shown`: see save_frame. The counts are of the picture that is shown, c of the split's stages.
    """
    scene, look, scaling = frame.scene, frame.look, frame.scaling
    picture = shown or frame
    return {
        "sample": scene.material.name,
        "source": scene.material.source,
        "size": list(frame.size),
        "sigma_n_deg": look.sigma_n_deg,
        "c": scaling.c,
        "c_max": scaling.c_max,
        "c_max_eq4": scaling.c_max_eq4,
        "y_n_cd_m2": frame.y_n_cd_m2,
        "seed": look.seed,
        "samples": sample_count(scene, look, frame.size),
        "operator": shown.operator if shown else SPLIT,
        "operator_parameters": dict(shown.settings) if shown else {},
        "clip_count": picture.clip_count,
        "out_of_gamut_count": picture.out_of_gamut_count,
        "object_pixels": frame.object_pixels,
        "lamp_m": [round(float(v), 9) for v in scene.lamp.position_m],
        "eye_m": [round(float(v), 9) for v in scene.eye.position_m],
        **{name: asdict(getattr(scene, name)) for name in ("shape", "lamp", "eye", "display")},
        "look": asdict(look),
        "method": frame.method.differences(),
        "fit_quality": scene.material.fit.quality if scene.material.fit else None,
        "warnings": list(warnings(frame, shown)),
        "device": frame.device,
        "version": __version__,
    }


def warnings(frame: Frame, shown: Displayed | None = None) -> tuple[str, ...]:
    """What there is to know about the picture that is shown; those about c only of the split's."""
    if shown is None:
        return frame.warnings
    of_c = frame.scaling.warnings
    return (*(text for text in frame.warnings if text not in of_c), *shown.warnings)


def save_rgb(
    rgb: Digital, path: str | os.PathLike[str], text: dict[str, str], *, srgb: bool = True
) -> None:
    """Write RGB (H, W, 3) of 8 or 16 bits as PNG with text chunks and, for sRGB, the profile."""
    profile = srgb_profile() if srgb else None
    with whole_file(path) as temporary:
        if rgb.dtype == np.uint16:
            write_png16(temporary, rgb.astype(np.uint16, copy=False), text, profile)
        else:
            _write_png8(temporary, rgb, text, profile)


@lru_cache(maxsize=1)
def srgb_profile() -> bytes:
    """An sRGB ICC profile, the same bytes each time (its date field is cleared)."""
    from PIL import ImageCms

    data = bytearray(ImageCms.ImageCmsProfile(ImageCms.createProfile("sRGB")).tobytes())
    data[24:36] = bytes((7, 234, 0, 1, 0, 1)) + bytes(6)  # 2026-01-01, big-endian words
    return bytes(data)


def _save_png(frame: Frame, file: Path, command: str, bits: int, shown: Displayed | None) -> None:
    text = _text(json.dumps(parameters(frame, shown)), command)
    save_rgb(digital(frame, shown, bits), file, text, srgb=is_srgb(frame.scene.display))


def _write_png8(file: Path, rgb: Digital, text: dict[str, str], profile: bytes | None) -> None:
    from PIL import Image
    from PIL.PngImagePlugin import PngInfo

    info = PngInfo()
    for key, value in text.items():
        info.add_itxt(key, value)
    extra = {"icc_profile": profile} if profile else {}
    Image.fromarray(np.ascontiguousarray(rgb)).save(
        file, format="PNG", pnginfo=info, compress_level=4, **extra
    )


def _text(told: str, command: str) -> dict[str, str]:
    """The text chunks of a PNG."""
    texts = {"Software": f"relgloss {__version__}", "Parameters": told}
    return texts | ({"Command": command} if command else {})


def _quantised(values: NDArray[np.float64], bits: int) -> Digital:
    """Digital values 0..1 as whole numbers, rounded as the display's 8 bits are."""
    whole = np.floor((2**bits - 1) * values + 0.5)
    if bits == 8:
        return np.asarray(whole.astype(np.uint8))
    return np.asarray(whole.astype(np.uint16))


def is_srgb(display: Display) -> bool:
    """Whether digital values of a display are sRGB's."""
    standard = Display()
    return (display.transfer, display.primaries_xy, display.white_xy) == (
        standard.transfer,
        standard.primaries_xy,
        standard.white_xy,
    )


def _save_exr(frame: Frame, file: Path, command: str, shown: Displayed | None) -> None:
    import OpenEXR

    channels: dict[str, NDArray[np.float32]] = {}

    def put(name: str, values: NDArray[Any]) -> None:
        channels[name] = np.ascontiguousarray(values, dtype=np.float32)

    light = (frame if shown is None else shown).light
    for k, name in enumerate("RGB"):
        put(name, light[..., k])
    put("A", frame.coverage)
    for layer, attribute, names in LAYERS:
        values = getattr(frame, attribute)
        for k, name in enumerate(names):
            put(f"{layer}.{name}", values[..., k])
    l_d, l_s = frame.split
    put("Ld.Y", l_d)
    put("Ls.Y", l_s)
    numbers = parameters(frame, shown)
    display = frame.scene.display
    header = {
        "compression": OpenEXR.ZIP_COMPRESSION,
        "type": OpenEXR.scanlineimage,
        "chromaticities": tuple(chain(*display.primaries_xy, display.white_xy)),
        "whiteLuminance": float(frame.y_n_cd_m2),
        "lamp_m": frame.scene.lamp.position_m.astype(np.float32),
        "eye_m": frame.scene.eye.position_m.astype(np.float32),
        "c": float(frame.c),
        "c_max": _number(frame.c_max),
        "c_max_eq4": _number(frame.scaling.c_max_eq4),
        "sigma_n_deg": float(frame.look.sigma_n_deg),
        "seed": frame.look.seed,
        "operator": numbers["operator"],
        "clip_count": numbers["clip_count"],
        "out_of_gamut_count": numbers["out_of_gamut_count"],
        "relgloss_version": __version__,  # EXR keeps "version" to itself
        "parameters": json.dumps(numbers),
        **({"command": command} if command else {}),
    }
    with whole_file(file) as temporary, OpenEXR.File(header, channels) as picture:
        try:
            picture.write(str(temporary))
        except RuntimeError as error:  # what OpenEXR raises where the disk is full
            raise InputError(f"{file}: can't be written ({error}); choose another place") from error


def _number(value: float | None) -> float:
    """An EXR attribute has no None: where there is no c_max it is NaN."""
    return math.nan if value is None else float(value)
