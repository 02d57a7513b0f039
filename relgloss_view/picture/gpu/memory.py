"""What a picture takes of the device's memory: the formula that `relgloss doctor` prints."""

from __future__ import annotations

from relgloss_view.pack import forms
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
    TRIANGLE,
    WEIGHTS,
    XYZ,
    surface_targets,
)
from relgloss_view.picture.gpu.triangles import BYTES as TRIANGLE_BYTES
from relgloss_view.picture.model.view import Size
from relgloss_view.picture.scene.scene import Scene

MOST_TEXELS = 1 << 22  #: of a tile of the surface, see surface.py
LEVELS = 1.5  #: of an artwork's texels, with its mip levels side by side
TEXEL = 12.0  #: bytes of one on the device: its colour, and four shares
HOST_TEXEL = 16.0  #: and beside the device, while its levels are made
DEPTH = 4  #: bytes
#: Bytes a pixel while the silhouette of triangles is found: its depth, the coverage and their
#: copies. Measured, as the next one, of pictures of 4 and 36 megapixels.
SILHOUETTE = 22.0
LIBRARIES = 90e6  #: bytes that the reading of artwork leaves
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


def surface_bytes(scene: Scene, size: Size, samples: int = 1) -> float:
    """Bytes of what a picture is read from: its surface, its triangles, its artwork; 0 without.

    samples: along a pixel's side.
    """
    pack, mesh = scene.pack, forms.mesh_of(scene.shape)
    if pack is None and mesh is None:
        return 0.0
    names = (*surface_targets(0 if pack is None else len(pack.finishes)), *TRIANGLE)
    texels = min(float(size[0] * size[1] * samples**2), float(MOST_TEXELS))
    taken = texels * (sum(targets.bytes_per_pixel(name) for name in names) + DEPTH)
    if mesh is not None:
        taken += TRIANGLE_BYTES * len(mesh.triangles) + SILHOUETTE * size[0] * size[1]
    if pack is not None:
        taken += LIBRARIES
    if pack is not None and pack.artwork is not None:
        height, width = pack.artwork.xyz.shape[:2]
        taken += LEVELS * (TEXEL + HOST_TEXEL) * height * width
    return taken
