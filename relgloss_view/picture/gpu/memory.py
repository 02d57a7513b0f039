"""What a picture takes of the device's memory: the formula that `relgloss doctor` prints."""

from __future__ import annotations

from relgloss_view.picture.gpu import targets
from relgloss_view.picture.gpu.reduction import BLOCK, FIRST_BLOCK
from relgloss_view.picture.gpu.targets import (
    COVERAGE,
    GEOMETRY,
    GRAIN_FIELD,
    LIGHT,
    METAL_WEIGHTS,
    OVERLAY,
    SPLIT,
    TONE,
    WEIGHTS,
    XYZ,
)
from relgloss_view.picture.model.view import Size

FLOATS = 16  #: bytes of four float32
#: Two targets of floats for each FIRST_BLOCK x FIRST_BLOCK pixels, and the ever smaller steps.
REDUCTION = 2 * FLOATS / FIRST_BLOCK**2 * (1.0 + 1.0 / (BLOCK**2 - 1))
#: What is made of a picture when somebody asks for it.
ON_DEMAND = {
    "XYZ": XYZ,
    "float light": LIGHT,
    "normals": GEOMETRY,
    "overlay": OVERLAY,
    "grain of one size at the eye": GRAIN_FIELD,
}


def bytes_per_pixel(asked: tuple[str, ...] = ()) -> float:
    """Bytes of the device's memory for each pixel of a picture; `asked` names of ON_DEMAND."""
    names = [*WEIGHTS, *SPLIT, *TONE, *(name for group in asked for name in ON_DEMAND[group])]
    return REDUCTION + sum(targets.bytes_per_pixel(name) for name in names)


def device_bytes(size: Size, asked: tuple[str, ...] = ()) -> float:
    """Bytes of the device's memory that a picture of a size takes."""
    return size[0] * size[1] * bytes_per_pixel(asked)


def most_bytes_per_pixel(samples: int) -> float:
    """Bytes of the device's memory a pixel, of the variant that takes most, while it is written.

    samples: along a pixel's side. What is drawn on request is drawn in parts.
    """
    pass_one = XYZ if samples > 1 else METAL_WEIGHTS
    names = (*pass_one, *SPLIT, *TONE, *COVERAGE)
    return REDUCTION + sum(targets.bytes_per_pixel(name) for name in names)
