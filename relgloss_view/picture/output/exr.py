"""OpenEXR: a frame with every stage as layers, for programs that compute with it.

R, G, B and A are the object without its surround, premultiplied, as the format's documentation
asks (OpenEXR, "Technical Introduction": premultiplied is the rule), so that the picture can be laid
over another one.
"""

from __future__ import annotations

import json
import math
import os
from itertools import chain
from typing import Any

import numpy as np
from numpy.typing import NDArray

from relgloss_view.base.arrays import AnyArray
from relgloss_view.base.version import __version__
from relgloss_view.base.writing import whole_file
from relgloss_view.display.model import DisplayModel
from relgloss_view.material.spectra import xy_of
from relgloss_view.picture.displayed import Displayed, cut_out
from relgloss_view.picture.frame import Frame
from relgloss_view.picture.output.exr_parts import PartsWriter
from relgloss_view.picture.output.parameters import parameters
from relgloss_view.picture.stages import Part, parts_of

XYZ = ("X", "Y", "Z")
#: Layer name, attribute of Frame, channel names. No layer has a channel "A": viewers take it for
#: that layer's alpha.
LAYERS = (
    ("diffuse", "diffuse", XYZ),
    ("specular", "specular", XYZ),
    ("N", "normal", XYZ),
    ("Np", "tilted_normal", XYZ),
    ("P", "point_m", XYZ),
    ("Lab", "lab", ("L", "a_star", "b_star")),
)


def save_exr(
    frame: Frame, path: str | os.PathLike[str], command: str, displayed: Displayed | None
) -> None:
    """Write a frame as OpenEXR, scan lines, ZIP, float32; arguments as save_frame.

    Layers and attributes are listed in docs/files.md. Raises InputError where the file can't be
    written.
    """
    header = _header(frame, command, displayed)
    with whole_file(path) as temporary, open(temporary, "w+b") as file:
        writer = PartsWriter(file, temporary, frame.size)
        for part in parts_of(frame):
            writer.write(header, _channels(part, displayed))
        writer.close()


def _channels(part: Part, displayed: Displayed | None) -> dict[str, NDArray[np.float32]]:
    """The channels of a part's own rows."""
    channels: dict[str, NDArray[np.float32]] = {}

    def put(name: str, values: AnyArray) -> None:
        channels[name] = np.ascontiguousarray(values[part.own], dtype=np.float32)

    rgb, alpha = cut_out(part, part.light if displayed is None else displayed.light[part.rows])
    for k, name in enumerate("RGB"):
        put(name, rgb[..., k])
    put("A", alpha)
    put("samples.Y", part.coverage)
    for layer, attribute, names in LAYERS:
        values = getattr(part, attribute)
        for k, name in enumerate(names):
            put(f"{layer}.{name}", values[..., k])
    l_d, l_s = part.unscaled_split
    put("Ld.Y", l_d)
    put("Ls.Y", l_s)
    if part.scene.pack is not None:
        put("k.Y", part.gloss_factor)
    return channels


def _header(frame: Frame, command: str, displayed: Displayed | None) -> dict[str, Any]:
    """The attributes of the file."""
    import OpenEXR

    numbers = parameters(frame, displayed)
    display, model = frame.scene.display, DisplayModel.of(frame.scene.display)
    primaries, white = display.primaries_xy, display.white_xy
    if model.monitor is not None:
        primaries = tuple(xy_of(column) for column in model.xyz_from_rgb.T)
        white = xy_of(model.white)
    luminance = model.luminance_cd_m2 if model.luminance_known else None
    return {
        "compression": OpenEXR.ZIP_COMPRESSION,
        "type": OpenEXR.scanlineimage,
        "chromaticities": tuple(chain(*primaries, white)),
        "whiteLuminance": float(frame.y_n_cd_m2),
        "display_cd_m2": _number(luminance),
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


def _number(value: float | None) -> float:
    """An EXR attribute has no None: where there is no c_max it is NaN."""
    return math.nan if value is None else float(value)
