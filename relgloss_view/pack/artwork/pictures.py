"""Pictures as rasters: PNG, JPEG and TIFF through Pillow, with sizes checked before decoding."""

from __future__ import annotations

import logging
import os
import threading
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np

from relgloss_view.base.arrays import AnyArray, Bytes, Digital
from relgloss_view.base.errors import InputError
from relgloss_view.base.icc.profile import (
    MOST_BYTES,
    Profile,
    lab_space,
    matrix_space,
    read_profile,
)
from relgloss_view.base.interruptions import checkpoint
from relgloss_view.base.reading import decoding, named, open_regular, read_bytes
from relgloss_view.base.room import Need, check_room
from relgloss_view.base.terminal import ProgressReport
from relgloss_view.pack.artwork.options import ArtworkOptions
from relgloss_view.pack.artwork.raster import MM_PER_INCH, Raster
from relgloss_view.pack.artwork.spaces import cicp_space, power_light, rgb_to_xyz, srgb

if TYPE_CHECKING:
    from PIL import Image

EXPECTED = "a picture (PNG, JPEG, TIFF or PSD) or a PDF"
MOST_DECODED = 600_000_000  #: bytes of a decoded picture
MOST_SIDE = 100_000  #: pixels
FORMATS = ("PNG", "JPEG", "TIFF")
#: EXIF orientations 2 to 8: whether rows and columns change places first, then which are reversed.
TURNS = {
    2: (False, False, True), 3: (False, True, True), 4: (False, True, False),
    5: (True, False, False), 6: (True, False, True), 7: (True, True, True), 8: (True, True, False),
}  # fmt: skip
ORIENTATION = 274
_SILENCE = threading.RLock()


def read_picture(
    path: str | os.PathLike[str], options: ArtworkOptions, progress: ProgressReport
) -> Raster:
    """The raster of a picture. Raises InputError with one line."""
    with open_regular(path, EXPECTED) as file, decoding(path, EXPECTED):
        head = file.read(4)
        file.seek(0)
        if head == b"8BPS":
            from relgloss_view.pack.artwork.psd import read_psd

            return read_psd(file, path, options, progress)
        if head in (b"II*\0", b"MM\0*"):
            from relgloss_view.pack.artwork.tiff import read_tiff

            raster = read_tiff(file, path, options, progress)
            if raster is not None:
                return raster
            file.seek(0)
        return _read(file, path, options, progress)


def check_size(path: str | os.PathLike[str], width: int, height: int, depth: int) -> None:
    """Raise InputError where a picture is too large; depth: bytes of a pixel."""
    if width < 1 or height < 1:
        raise InputError(f"{named(path)}: a picture without pixels; save it again")
    if max(width, height) > MOST_SIDE or width * height * depth > MOST_DECODED:
        raise InputError(
            f"{named(path)}: {width} x {height} pixels are too many; save it with at most "
            f"{MOST_DECODED // 1_000_000} MB of pixels"
        )
    need = 2.5 * width * height * depth + 100e6
    check_room(Need(need), f"{named(path)}: this picture", "save it smaller")


def profile_for(
    path: str | os.PathLike[str],
    space: str,
    embedded: bytes | None,
    options: ArtworkOptions,
    notes: list[str],
) -> Profile:
    """The profile of a picture's colours: its own, else that of the options, else sRGB with a note.

    space: a key of profile.CHANNELS. Raises InputError where CMYK has none.
    """
    if embedded:
        try:
            profile = read_profile(embedded)
        except ValueError as error:
            profile = None
            notes.append(f"The embedded profile is left out: it is {error}.")
        if profile is not None and profile.space == space:
            notes.append(f"Colours by the embedded profile {profile.description or space!r}.")
            return profile
        if profile is not None:
            notes.append(
                f"The embedded profile is left out: it is of {profile.space}, the picture is of "
                f"{space}."
            )
    if space == "Lab":
        return lab_space()
    if options.profile:
        profile = profile_of_file(options.profile)
        if profile.space == space:
            return profile
        if space == "CMYK":
            raise InputError(
                f"{named(options.profile)}: this profile is of {profile.space}; give one of CMYK"
            )
        notes.append(f"The given profile is of {profile.space}, so it is left out.")
    if space == "CMYK":
        raise InputError(
            f"{named(path)}: CMYK without a profile; name the ICC profile of its printing "
            "condition with --profile FILE.icc (in a pack file: profile)"
        )
    notes.append("The file has no colour profile; sRGB is taken.")
    return gray_of(srgb()) if space == "GRAY" else srgb()


def profile_of_file(path: str | os.PathLike[str]) -> Profile:
    """The profile of a file; InputError with one line."""
    data = read_bytes(path, MOST_BYTES, "an ICC profile (.icc)")
    try:
        return read_profile(data)
    except ValueError as error:
        raise InputError(f"{named(path)}: {error}; give an ICC profile (.icc)") from None


def gray_of(rgb: Profile) -> Profile:
    """Gray values as those of an RGB space whose three channels are equal."""
    white = rgb.after(np.ones((1, 3)))
    return Profile(
        "GRAY", rgb.description, False, rgb.white, rgb.curves[:1], None, lambda v: v * white
    )


@contextmanager
def quiet_pillow() -> Iterator[None]:
    """Pillow without its own limit of pixels, which check_size holds, and without its warnings.

    libtiff prints on standard error itself, so that is turned away meanwhile. All of it belongs to
    the process, so one thread at a time has it.
    """
    from PIL import Image

    logger = logging.getLogger("PIL")
    if not logger.handlers:
        logger.addHandler(logging.NullHandler())
    with _SILENCE:
        most = Image.MAX_IMAGE_PIXELS
        Image.MAX_IMAGE_PIXELS = None
        try:
            with warnings.catch_warnings(), _quiet_libraries():
                warnings.simplefilter("ignore")
                yield
        finally:
            Image.MAX_IMAGE_PIXELS = most


@contextmanager
def _quiet_libraries() -> Iterator[None]:
    """Standard error of the process, on which C libraries print, led to the null device."""
    try:
        kept = os.dup(2)
    except OSError:  # there is none
        yield
        return
    try:
        null = os.open(os.devnull, os.O_WRONLY)
        os.dup2(null, 2)
        os.close(null)
        yield
    finally:
        os.dup2(kept, 2)
        os.close(kept)


def _read(
    file: BinaryIO, path: str | os.PathLike[str], options: ArtworkOptions, progress: ProgressReport
) -> Raster:
    from PIL import Image, UnidentifiedImageError

    with quiet_pillow():
        try:
            image = Image.open(file, formats=FORMATS)
        except UnidentifiedImageError:
            raise InputError(
                f"{named(path)}: no picture that can be read, or a damaged one; give {EXPECTED}"
            ) from None
        check_size(path, *image.size, 2 * len(image.getbands()))
        if image.mode == "F":
            raise InputError(
                f"{named(path)}: a picture of floating point numbers; save it with 16 bits"
            )
        checkpoint()
        progress(0.2, "decoding")
        samples, alpha, space = _samples(image, file)
    notes: list[str] = []
    profile = _named_space(image, file, space, path)
    if profile is None:
        profile = profile_for(path, space, image.info.get("icc_profile"), options, notes)
    width_mm, height_mm = _size_mm(image, options)
    raster = Raster(
        samples, profile, alpha, width_mm=width_mm, height_mm=height_mm, notes=tuple(notes)
    )
    return turned(raster, orientation_of(image))


def turned_values(values: AnyArray, orientation: object) -> AnyArray:
    """Values (H, W, ...) as an EXIF orientation asks to show them."""
    swap, rows, columns = TURNS.get(orientation, (False, False, False))  # type: ignore[call-overload]
    out = np.swapaxes(values, 0, 1) if swap else values
    return np.ascontiguousarray(out[:: -1 if rows else 1, :: -1 if columns else 1])


def orientation_of(image: Image.Image) -> object:
    """The EXIF orientation of a picture; 1 is upright."""
    if image.format == "PNG" and "exif" not in image.info:
        return 1
    return image.getexif().get(ORIENTATION, 1)


def turned(raster: Raster, orientation: object) -> Raster:
    """The raster as an EXIF orientation asks to show it."""
    if orientation not in TURNS:
        return raster
    swap = TURNS[orientation][0]

    def turn(values: AnyArray) -> AnyArray:
        return turned_values(values, orientation)

    width_mm, height_mm = raster.width_mm, raster.height_mm
    return Raster(
        turn(raster.samples),
        raster.profile,
        None if raster.alpha is None else turn(raster.alpha),
        raster.premultiplied,
        {name: turn(plate) for name, plate in raster.plates.items()},
        height_mm if swap else width_mm,
        width_mm if swap else height_mm,
        notes=raster.notes,
    )


def _samples(image: Image.Image, file: BinaryIO) -> tuple[Digital, Digital | None, str]:
    """Samples, alpha and colour space of an opened picture, 16 bits where it has them."""
    deep = _deep_samples(image, file)
    if deep is not None:
        channels = deep.shape[2]
        alpha = deep[..., -1] if channels in (2, 4) else None
        samples = np.ascontiguousarray(deep[..., : 3 if channels > 2 else 1])
        return samples, alpha, "RGB" if channels > 2 else "GRAY"
    image.load()
    mode = image.mode
    if mode in ("I;16", "I;16B", "I;16L", "I;16N", "I"):
        values = np.asarray(image)
        if mode == "I" and (values.min() < 0 or values.max() > 65535):
            raise ValueError("a picture of 32 bits")
        values = values.astype(np.uint16)
        return values[..., None], transparency16(image, values), "GRAY"
    if mode == "CMYK":
        values = np.asarray(image)
        # Pillow takes Adobe's way of writing CMYK in a JPEG, inverted, for every JPEG.
        if image.format in ("JPEG", "MPO") and "adobe" not in image.info:
            values = 255 - values
        return values, None, "CMYK"
    if mode == "LAB":
        values = np.asarray(image).copy()
        values[..., 1:] ^= 0x80  # Pillow holds a* and b* as signed bytes
        return values, None, "Lab"
    transparent = "transparency" in image.info
    if mode in ("1", "L") and not transparent:
        return np.asarray(image.convert("L"))[..., None], None, "GRAY"
    if mode in ("L", "LA", "La", "1"):
        values = np.asarray(image.convert("LA"))
        return np.ascontiguousarray(values[..., :1]), values[..., 1], "GRAY"
    if mode in ("RGBA", "RGBa", "PA") or transparent:
        values = np.asarray(image.convert("RGBA"))
        return np.ascontiguousarray(values[..., :3]), values[..., 3], "RGB"
    return np.asarray(image.convert("RGB")), None, "RGB"


def transparency16(image: Image.Image, values: AnyArray) -> Bytes | None:
    """Alpha of a gray picture of 16 bits whose one value is transparent; None without one."""
    clear = image.info.get("transparency")
    return np.where(values == clear, 0, 255).astype(np.uint8) if isinstance(clear, int) else None


def _deep_samples(image: Image.Image, file: BinaryIO) -> AnyArray | None:
    """All 16 bits of a PNG of RGB or with alpha, of which Pillow keeps the upper 8; None else.

    The decoder runs twice: with the pairs of bytes as they are, which gives the upper bytes, and
    with their order changed, which gives the lower ones.
    """
    tiles: Any = getattr(image, "tile", None)
    if image.format != "PNG" or not tiles:
        return None
    tile = tiles[0]
    rawmode = tile.args if isinstance(tile.args, str) else tile.args[0]
    others = {"RGB;16B": "RGB;16L", "RGBA;16B": "RGBA;16L"}
    if rawmode == "LA;16B":  # four bytes a pixel, as RGBA has
        data = _decoded_as(file, "RGBA")
        return data.view(">u2").astype(np.uint16)
    if rawmode not in others or "transparency" in image.info:
        return None
    high = _decoded_as(file, rawmode).astype(np.uint16)
    return (high << 8) | _decoded_as(file, others[rawmode])


def _decoded_as(file: BinaryIO, rawmode: str) -> AnyArray:
    from PIL import Image

    file.seek(0)
    with Image.open(file, formats=("PNG",)) as again:
        tile: Any = again.tile[0]
        args = rawmode if isinstance(tile.args, str) else (rawmode, *tile.args[1:])
        again.tile = [tile._replace(args=args)]
        again.load()
        return np.array(again)


def _named_space(
    image: Image.Image, file: BinaryIO, space: str, path: str | os.PathLike[str]
) -> Profile | None:
    """The space that a PNG names by other chunks than a profile; None where it names none."""
    if image.format != "PNG" or space not in ("RGB", "GRAY"):
        return None
    info = image.info
    cicp = _cicp(file)
    rgb: Profile | None = None
    if cicp is not None:
        try:
            rgb = cicp_space(cicp[0], cicp[1])
        except ValueError as error:
            raise InputError(f"{named(path)}: {error}; save it as sRGB") from None
    elif "icc_profile" in info:
        return None
    elif "srgb" in info:
        rgb = srgb()
    elif "gamma" in info and 0.1 < info["gamma"] < 10.0:
        corners = info.get("chromaticity")
        srgb_like = abs(info["gamma"] - 0.45455) < 1e-4
        matrix = srgb().after(np.eye(3)).T
        if corners and len(corners) == 8:
            white, *rest = [tuple(corners[k : k + 2]) for k in range(0, 8, 2)]
            try:
                matrix = rgb_to_xyz((*rest, white))
            except ValueError:
                matrix = srgb().after(np.eye(3)).T
        rgb = matrix_space("gAMA", matrix, power_light(1.0 / info["gamma"]))
        if srgb_like and not corners:
            rgb = None  # what programs write that mean sRGB
    if rgb is None:
        return None
    return gray_of(rgb) if space == "GRAY" else rgb


def _cicp(file: BinaryIO) -> tuple[int, int] | None:
    """Primaries and transfer of the chunk cICP, which comes before the pixels."""
    file.seek(0)
    head = file.read(1 << 16)
    at = 8
    while at + 12 <= len(head):
        size, kind = int.from_bytes(head[at : at + 4], "big"), head[at + 4 : at + 8]
        if kind == b"IDAT":
            return None
        if kind == b"cICP" and size == 4:
            return head[at + 8], head[at + 9]
        at += 12 + size
    return None


def _size_mm(image: Image.Image, options: ArtworkOptions) -> tuple[float, float]:
    """Printed size by the options' or the file's resolution; zeros without one."""
    dpi = image.info.get("dpi")
    try:
        across, down = (float(dpi[0]), float(dpi[1])) if dpi else (0.0, 0.0)
    except (TypeError, ValueError, IndexError, ZeroDivisionError):
        across, down = 0.0, 0.0
    return size_mm(image.size, (across, down), options)


def size_mm(
    size: tuple[int, int], dpi: tuple[float, float], options: ArtworkOptions
) -> tuple[float, float]:
    """Width and height, mm, by a resolution; zeros where it is none (1 dpi stands for that)."""
    if options.dpi is not None:
        dpi = (options.dpi, options.dpi)
    if not all(2.0 <= d <= 1e5 for d in dpi):
        return 0.0, 0.0
    return size[0] * MM_PER_INCH / dpi[0], size[1] * MM_PER_INCH / dpi[1]
