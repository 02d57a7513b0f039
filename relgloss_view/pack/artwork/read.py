"""Read a file of artwork, whatever its kind; its content decides, not its name."""

from __future__ import annotations

import os
import time

from relgloss_view.base.errors import InputError
from relgloss_view.base.interruptions import checkpoint
from relgloss_view.base.reading import named, open_regular, read_beginning
from relgloss_view.base.terminal import ProgressReport, no_progress
from relgloss_view.pack.artwork.artwork import Artwork
from relgloss_view.pack.artwork.options import ArtworkOptions
from relgloss_view.pack.artwork.raster import to_artwork

EXPECTED = "artwork (PDF, PNG, JPEG, TIFF or PSD)"
SETTLED_S = 0.3  #: a file that was changed less long ago may still be being written
USUAL = ArtworkOptions()
_HEAD = 1024  #: bytes in which a PDF's mark may lie


def read_artwork(
    path: str | os.PathLike[str],
    options: ArtworkOptions = USUAL,
    progress: ProgressReport = no_progress,
) -> Artwork:
    """The artwork of a picture (PNG, JPEG, TIFF, PSD) or of a page of a PDF.

    Colours go through the profile of the file, else of the options; RGB without one is sRGB. The
    steps have checkpoints. Raises InputError with one line.

    >>> from PIL import Image
    >>> Image.new("RGB", (40, 20), "white").save("label.png")
    >>> read_artwork("label.png", ArtworkOptions(width_mm=80.0)).height_mm
    40.0
    """
    checkpoint()
    progress(0.0, "reading")
    before = stamp_of(path)
    head = read_beginning(path, _HEAD, EXPECTED)
    if not head:
        raise InputError(f"{named(path)}: an empty file; give {EXPECTED}")
    if b"%PDF-" in head or head.startswith((b"%!PS", b"\xc5\xd0\xd3\xc6", b"\x04%!PS")):
        from relgloss_view.pack.artwork.pdf import read_pdf as read
    else:
        from relgloss_view.pack.artwork.pictures import read_picture as read
    raster = read(path, options, lambda share, text: progress(0.6 * share, text))
    artwork = to_artwork(
        raster,
        options,
        os.fspath(path),
        before,
        lambda share, text: progress(0.6 + 0.4 * share, text),
    )
    progress(1.0, "done")
    return artwork


def stamp_of(path: str | os.PathLike[str]) -> tuple[int, int]:
    """Time of a file's last change, ns, and its bytes; InputError where it can't be read."""
    with open_regular(path, EXPECTED) as file:
        status = os.fstat(file.fileno())
    return status.st_mtime_ns, status.st_size


def changed(artwork: Artwork) -> bool:
    """Whether the file of an artwork was edited since, and is no longer being written.

    False while it is away, as programs that save it remove it for a moment; and where its last
    change is so fresh that more may come. Cheap: asked again with each frame.
    """
    if not artwork.file:
        return False
    try:
        status = os.stat(artwork.file)
    except (OSError, ValueError):
        return False
    if (status.st_mtime_ns, status.st_size) == artwork.stamp:
        return False
    return abs(time.time() - status.st_mtime) > SETTLED_S or status.st_mtime > time.time() + 1.0
