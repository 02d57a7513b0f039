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

from relgloss_view import __version__
from relgloss_view.atomic import whole_file
from relgloss_view.errors import InputError
from relgloss_view.picture.frame import Frame
from relgloss_view.picture.plan import sample_count
from relgloss_view.picture.scene import Display

SUFFIXES = (".png", ".exr")
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


def save_frame(frame: Frame, path: str | os.PathLike[str], command: str = "") -> None:
    """Write a frame as PNG or OpenEXR, by the ending of its name.

    `command` is the command line that reproduces it; it goes into the file.
    """
    file = check_suffix(path)
    if file.suffix.lower() == ".png":
        _save_png(frame, file, command)
    else:
        _save_exr(frame, file, command)


def parameters(frame: Frame) -> dict[str, Any]:
    """Everything that goes into a frame, but for the material's spectra, and what came out."""
    scene, look, scaling = frame.scene, frame.look, frame.scaling
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
        "clip_count": frame.clip_count,
        "out_of_gamut_count": frame.out_of_gamut_count,
        "object_pixels": int(np.sum(frame.on_object)),
        "lamp_m": [round(float(v), 9) for v in scene.lamp.position_m],
        "eye_m": [round(float(v), 9) for v in scene.eye.position_m],
        **{name: asdict(getattr(scene, name)) for name in ("shape", "lamp", "eye", "display")},
        "look": asdict(look),
        "fit_quality": scene.material.fit.quality if scene.material.fit else None,
        "warnings": list(frame.warnings),
        "device": frame.device,
        "version": __version__,
    }


def save_rgb(
    rgb: NDArray[np.uint8], path: str | os.PathLike[str], text: dict[str, str], *, srgb: bool = True
) -> None:
    """Write 8-bit RGB (H, W, 3) as PNG with text chunks and, for sRGB, the profile."""
    from PIL import Image
    from PIL.PngImagePlugin import PngInfo

    info = PngInfo()
    for key, value in text.items():
        info.add_itxt(key, value)
    profile = {"icc_profile": srgb_profile()} if srgb else {}
    with whole_file(path) as temporary:
        Image.fromarray(np.ascontiguousarray(rgb)).save(
            temporary, format="PNG", pnginfo=info, compress_level=4, **profile
        )


@lru_cache(maxsize=1)
def srgb_profile() -> bytes:
    """An sRGB ICC profile, the same bytes each time (its date field is cleared)."""
    from PIL import ImageCms

    data = bytearray(ImageCms.ImageCmsProfile(ImageCms.createProfile("sRGB")).tobytes())
    data[24:36] = bytes((7, 234, 0, 1, 0, 1)) + bytes(6)  # 2026-01-01, big-endian words
    return bytes(data)


def _save_png(frame: Frame, file: Path, command: str) -> None:
    text = {
        "Software": f"relgloss {__version__}",
        "Parameters": json.dumps(parameters(frame)),
        **({"Command": command} if command else {}),
    }
    display, standard = frame.scene.display, Display()
    is_srgb = (display.transfer, display.primaries_xy, display.white_xy) == (
        standard.transfer,
        standard.primaries_xy,
        standard.white_xy,
    )
    save_rgb(frame.display, file, text, srgb=is_srgb)


def _save_exr(frame: Frame, file: Path, command: str) -> None:
    import OpenEXR

    channels: dict[str, NDArray[np.float32]] = {}

    def put(name: str, values: NDArray[Any]) -> None:
        channels[name] = np.ascontiguousarray(values, dtype=np.float32)

    for k, name in enumerate("RGB"):
        put(name, frame.light[..., k])
    put("A", frame.coverage)
    for layer, attribute, names in LAYERS:
        values = getattr(frame, attribute)
        for k, name in enumerate(names):
            put(f"{layer}.{name}", values[..., k])
    l_d, l_s = frame.split
    put("Ld.Y", l_d)
    put("Ls.Y", l_s)
    numbers = parameters(frame)
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
