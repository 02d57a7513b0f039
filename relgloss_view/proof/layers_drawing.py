"""The layers of a pack as a page takes them: by its own PNG files, decoded by js/layers.js.

Paint follows from the samples of the artwork's file by curves and a matrix, bit for bit as
pack/artwork/raster.py has it. A channel that is one of the pack's masks is named by its file;
others, composed of several masks, come as gray PNGs. What no curve and matrix give comes whole.
"""

from __future__ import annotations

import base64
import io
from pathlib import Path, PurePath
from typing import Any

import numpy as np

from relgloss_view.base.arrays import Array, Bytes
from relgloss_view.pack.artwork.options import ArtworkOptions
from relgloss_view.pack.artwork.raster import AT_ONCE, Raster
from relgloss_view.pack.layers import Layers
from relgloss_view.pack.measured import lobes_in_artwork
from relgloss_view.pack.pack import Pack
from relgloss_view.proof.arrays import packed

PNG = b"\x89PNG\r\n\x1a\n"
#: Names of a file's chunks that change its samples, and that js/png.js does not follow.
OTHER_CHUNKS = (b"eXIf", b"acTL")
PALETTE = 3  #: colour type


def layers_drawing(pack: Pack, layers: Layers) -> dict[str, Any]:
    """The layers of a pack as JSON."""
    width, height = layers.size_px
    return {
        "size_px": [width, height],
        "paint": _paint(pack, layers),
        "channels": [_channel(pack, layers, k) for k in range(layers.channels.shape[-1])],
        "groups": _groups(pack, layers),
    }


def _groups(pack: Pack, layers: Layers) -> list[list[int]]:
    """Channels whose values add up to at most 1, from the topmost finish downwards."""
    places = (layers.specular_channel, layers.diffuse_channel)
    return [[c for c in reversed(group) if c >= 0] for group in places]


def _channel(pack: Pack, layers: Layers, number: int) -> dict[str, Any]:
    values = layers.channels[..., number]
    for finish in pack.finishes:
        mask = pack.masks.get(finish.mask)
        if mask is None or mask.shape != values.shape:
            continue
        for inverted in (False, True):
            if np.array_equal(values, 255 - mask if inverted else mask):
                return {"file": finish.mask, "inverted": inverted}
    return {"png": base64.b64encode(_gray_png(values)).decode("ascii")}


def _gray_png(values: Bytes) -> bytes:
    from PIL import Image

    file = io.BytesIO()
    Image.fromarray(np.ascontiguousarray(values)).save(file, "PNG", optimize=True)
    return file.getvalue()


def _paint(pack: Pack, layers: Layers) -> dict[str, Any] | None:
    """How paint follows from the artwork's file; {'values': ...} where it is carried; None of none.

    curves: light of each sample's value, a row a channel. matrix: from light to XYZ, a row a
    channel. rows: of samples that are converted together. lobes: XYZ that is taken off by finish.
    """
    if pack.artwork is None:
        return None
    raster = _raster(pack)
    steps = None if raster is None else _steps(raster)
    if raster is None or steps is None:
        return {"values": packed(layers.paint.view(np.uint16))}
    curves, matrix = steps
    intent = str(dict(pack.artwork_entries).get("intent", "auto"))
    lobes = lobes_in_artwork(pack)
    return {
        "file": PurePath(pack.artwork.file).name,
        "curves": packed(curves),
        "matrix": matrix.ravel().tolist(),
        "scale": raster.profile.scale(intent).astype(np.float32).tolist(),
        "rows": max(AT_ONCE // raster.size_px[0], 1),
        "lobes": None if lobes is None else lobes.astype(np.float32).ravel().tolist(),
        "specular_channel": list(layers.specular_channel),
    }


def _raster(pack: Pack) -> Raster | None:
    """The artwork's file as it is read, where the page can read it too."""
    from relgloss_view.pack.artwork.pictures import read_picture

    assert pack.artwork is not None
    path = Path(pack.artwork.file)
    if not pack.artwork.file or not path.is_file() or not is_plain_png(path.read_bytes()):
        return None
    given = {k: v for k, v in pack.artwork_entries if k in ArtworkOptions.__dataclass_fields__}
    raster = read_picture(path, ArtworkOptions(**given), lambda share, text: None)
    return raster if raster.size_px == pack.artwork.size_px and not raster.inks else None


def is_plain_png(data: bytes) -> bool:
    """Whether js/png.js decodes a file: a PNG without interlace and without a transparent colour.

    Palettes may have transparent entries.
    """
    if not data.startswith(PNG) or len(data) < 33 or data[28]:
        return False
    at, clear = 8, (b"tRNS",) if data[25] != PALETTE else ()
    while at + 8 <= len(data):
        kind = data[at + 4 : at + 8]
        if kind in (*OTHER_CHUNKS, *clear):
            return False
        at += 12 + int.from_bytes(data[at : at + 4], "big")
    return True


def _steps(raster: Raster) -> tuple[Array, Array] | None:
    """Curves (channels, values) and matrix (channels, 3), both float32; None where they don't do.

    As raster.Conversion has them.
    """
    profile = raster.profile
    if profile.grid is not None or profile.space not in ("RGB", "GRAY"):
        return None
    one = np.eye(profile.channels, dtype=np.float32)
    matrix = np.asarray(profile.after(one))
    half = np.asarray(profile.after(np.float32(0.5) * one))
    if not np.array_equal(half, np.float32(0.5) * matrix) or matrix.shape[-1] != 3:
        return None
    top = float(np.iinfo(raster.samples.dtype).max)
    values = np.arange(top + 1.0) / top
    curves = [np.asarray(curve(values), np.float64) for curve in profile.curves]
    return np.stack(curves).astype(np.float32), matrix.astype(np.float32)
