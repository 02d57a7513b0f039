"""Peak: the most memory that a picture takes until its file is written, estimated before.

The numbers of targets and arrays follow from the code; what libraries add was measured on Mesa's
llvmpipe. tests/picture/test_peak.py holds the estimates against what processes take.
"""

from __future__ import annotations

import os
from collections.abc import Sequence

from relgloss_view.base.room import MB, STACK, THREAD_ADDRESSES, Need, check_room, processors
from relgloss_view.picture.model.view import Size
from relgloss_view.picture.scene.scene import Scene

MOST_LLVMPIPE_THREADS = 32
#: What the driver's libraries, its compiler and the first picture take.
DRIVER = Need(110 * MB, 100 * MB, 320 * MB)
#: What the window takes beside its context: libraries, letters, two pictures.
WINDOW = Need(190 * MB, 200 * MB, 420 * MB)
RESERVE = 60 * MB  #: for what drivers and libraries take unasked, above the estimate
SMALL = 8 * MB  #: the reserve is for such
SMALLER = "give a smaller --size"
NO_ROOM = "raise the limit, or draw with --backend reference"

# Bytes a pixel beside the targets, by how the picture is used.
SHOWN = 4.0
#: Those of a grid wait for their files.
FILES = {"png": 17.0, "png16": 14.0, "exr": 4.0, "grid": 160.0}
OPERATOR = {"multiscale": 240.0}  #: with float64 pictures on the way
OTHER_OPERATOR = 120.0
CELL = 9.0  #: of a picture that a comparison keeps
PART = 100 * MB  #: of a part of a picture and of what is computed from it
PART_SHARE = 550.0  #: bytes a pixel, of a picture that is smaller than a part
CHUNK, CHUNK_SHARE = 420 * MB, 1400.0  #: the same of the reference, whose rows hold every band
REFERENCE = 56.0 + 14.0  #: diffuse and specular in float64; the silhouette


def context_need() -> Need:
    """What an OpenGL context takes, with the threads of a software driver."""
    named = os.environ.get("LP_NUM_THREADS", "")
    drawing = int(named) if named.isdecimal() else processors()
    threads = 1 + 2 * min(drawing, MOST_LLVMPIPE_THREADS)
    more = Need(0.0, threads * STACK, threads * THREAD_ADDRESSES)
    return DRIVER.plus(more)


def picture_bytes(
    size: Size,
    samples: int = 1,
    *,
    backend: str = "auto",
    uses: Sequence[str] = ("exr",),
    scene: Scene | None = None,
) -> float:
    """Bytes that a picture takes until its file is written, at most.

    samples: along a pixel's side. uses: names of FILES, and of operators, whose
    pictures may go to any file. scene: what is drawn, where it may be a pack or triangles.
    """
    pixels = float(size[0] * size[1])
    part, share, read = PART, PART_SHARE, 0.0
    if backend == "reference":
        held, part, share = REFERENCE, CHUNK, CHUNK_SHARE
    else:
        from relgloss_view.picture.gpu.memory import most_bytes_per_pixel, surface_bytes

        held = most_bytes_per_pixel(samples)
        if scene is not None:
            read = surface_bytes(scene, size, samples)
    held += max(_beside(use) for use in (*uses, "exr"))
    return pixels * held + min(part, share * pixels) + read


def _beside(use: str) -> float:
    """Bytes a pixel that a use takes beside the targets."""
    return FILES[use] if use in FILES else OPERATOR.get(use, OTHER_OPERATOR)


def check_picture(
    size: Size,
    samples: int = 1,
    *,
    backend: str = "auto",
    uses: Sequence[str] = ("exr",),
    opened: bool = False,
    kept: int = 0,
    scene: Scene | None = None,
    remedy: str = SMALLER,
) -> None:
    """Raise InputError where a picture needs more memory than there is; call it before drawing.

    size, samples, backend, uses, scene: as picture_bytes. opened: the context is open already.
    kept: number of pictures that a comparison keeps.
    """
    taken = picture_bytes(size, samples, backend=backend, uses=uses, scene=scene)
    need = Need(taken + RESERVE + kept * CELL * size[0] * size[1])
    if backend != "reference" and not opened:
        context = context_need()
        check_room(context.plus(Need(RESERVE)), "OpenGL", NO_ROOM)
        need = need.plus(context)
    check_room(need, f"a picture of {size[0]}x{size[1]} pixels", remedy)


def check_window() -> None:
    """Raise InputError where the window needs more memory than there is; call it before imports."""
    check_room(context_need().plus(WINDOW), "the window", "raise the limit")


def check_memory(size: Size, bytes_per_pixel: float) -> None:
    """Raise InputError where one target or array of a picture does not fit; small ones do."""
    taken = size[0] * size[1] * bytes_per_pixel
    if taken > SMALL:
        check_room(Need(taken + RESERVE), f"a picture of {size[0]}x{size[1]} pixels", SMALLER)
