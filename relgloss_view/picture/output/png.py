"""PNG: a picture for the eye, with its colour profile and the command that draws it again."""

from __future__ import annotations

import io
import json
import os
from pathlib import Path
from typing import BinaryIO

import numpy as np

from relgloss_view.base.arrays import Array, Digital
from relgloss_view.base.errors import InputError
from relgloss_view.base.version import PROGRAM
from relgloss_view.base.writing import whole_file
from relgloss_view.display.display import Display
from relgloss_view.display.icc_writing import profile_of
from relgloss_view.display.model import DisplayModel
from relgloss_view.picture.displayed import Displayed, shown_light
from relgloss_view.picture.frame import Frame
from relgloss_view.picture.model import tone
from relgloss_view.picture.output.parameters import parameters
from relgloss_view.picture.output.png16 import write_png16
from relgloss_view.picture.stages import parts_of

SOFTWARE = PROGRAM


def save_png(
    frame: Frame,
    path: str | os.PathLike[str],
    command: str,
    bits: int = 8,
    displayed: Displayed | None = None,
) -> None:
    """Write a frame as PNG; arguments as save_frame."""
    text = _text(json.dumps(parameters(frame, displayed)), command)
    save_rgb(digital(frame, displayed, bits), path, text, display=frame.scene.display)


def png_bytes(frame: Frame) -> bytes:
    """A PNG of 8 bits with the profile but without parameters, which needs only the pixels."""
    profile = profile_of(frame.scene.display)
    memory = io.BytesIO()
    write_png8(memory, frame.display, {"Software": SOFTWARE}, profile)
    return memory.getvalue()


def save_pair(
    frames: tuple[Frame, Frame],
    path: str | os.PathLike[str],
    commands: tuple[str, str],
    *,
    gap_px: int = 0,
    mirrored: bool = False,
    bits: int = 8,
    displayed: tuple[Displayed | None, Displayed | None] = (None, None),
) -> None:
    """Write the reference and the test picture side by side as one PNG, as the window shows them.

    frames: reference and test, of one size and for one display; the surround fills the gap.
    commands: the command line of each. gap_px: width of the gap. mirrored: swap the pictures and
    mirror each. bits, displayed: as save_frame, displayed one for each picture. Raises InputError
    where the name does not end in .png or the file can't be written.
    """
    file = Path(path)
    if file.suffix.lower() != ".png":
        raise InputError(f"{file}: expected a name that ends in .png, which holds both pictures")
    pair = {
        "reference": parameters(frames[0], displayed[0]),
        "test": parameters(frames[1], displayed[1]),
        "gap_px": gap_px,
        "mirrored": mirrored,
    }
    display = frames[0].scene.display
    left, right = (digital(*both, bits) for both in zip(frames, displayed, strict=True))
    if mirrored:
        left, right = right[:, ::-1], left[:, ::-1]
    surround = _quantised(tone.surround_digital(DisplayModel.of(display)), bits)
    gap = np.full((left.shape[0], gap_px, 3), surround, dtype=surround.dtype)
    text = _text(json.dumps(pair), "\n".join(commands))
    save_rgb(np.concatenate([left, gap, right], axis=1), file, text, display=display)


def digital(frame: Frame, displayed: Displayed | None, bits: int) -> Digital:
    """(H, W, 3), digital values of the display: the picture's own 8 bits, or its light in 16."""
    if bits == 8:
        return frame.display if displayed is None else displayed.digital
    model = DisplayModel.of(frame.scene.display)
    values = np.empty((frame.size[1], frame.size[0], 3), dtype=np.uint16)
    for part in parts_of(frame):
        light, _ = shown_light(
            part, part.light if displayed is None else displayed.light[part.rows]
        )
        rows = slice(part.first, part.first + part.own.stop - part.own.start)
        values[rows] = _quantised(tone.encode(light[part.own], model), bits)
    return values


def save_rgb(
    rgb: Digital,
    path: str | os.PathLike[str],
    text: dict[str, str],
    *,
    display: Display | None = None,
) -> None:
    """Write RGB (H, W, 3) of 8 or 16 bits as PNG with text chunks and the display's profile.

    display: whose digital values they are; sRGB where none is given.
    """
    profile = profile_of(display or Display())
    with whole_file(path) as temporary:
        if rgb.dtype == np.uint16:
            write_png16(temporary, rgb.astype(np.uint16, copy=False), text, profile)
        else:
            write_png8(temporary, rgb, text, profile)


def write_png8(
    file: Path | BinaryIO, rgb: Digital, text: dict[str, str], profile: bytes | None
) -> None:
    """Write RGB (H, W, 3) of 8 bits as PNG, with text chunks and an ICC profile if there is one."""
    from PIL import Image
    from PIL.PngImagePlugin import PngInfo

    info = PngInfo()
    for key, value in text.items():
        info.add_itxt(key, value)
    extra = {"icc_profile": profile} if profile else {}
    Image.fromarray(np.ascontiguousarray(rgb)).save(
        file, format="PNG", pnginfo=info, compress_level=4, **extra
    )


def _text(content: str, command: str) -> dict[str, str]:
    """The text chunks of a PNG; `content` is the JSON of its parameters."""
    texts = {"Software": SOFTWARE, "Parameters": content}
    return texts | ({"Command": command} if command else {})


def _quantised(values: Array, bits: int) -> Digital:
    """Digital values 0..1 as whole numbers, rounded as the display's 8 bits are."""
    whole = np.floor((2**bits - 1) * values + 0.5)
    if bits == 8:
        return np.asarray(whole.astype(np.uint8))
    return np.asarray(whole.astype(np.uint16))
