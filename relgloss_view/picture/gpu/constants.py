"""Constants of the shaders: each named choice has one number, which Python alone assigns.

shader.py writes them at the head of every stage as TABLE_NAME, such as NOISE_PAPER, so that neither
GLSL nor Python repeats a number.
"""

from __future__ import annotations

import re
from collections.abc import Mapping

from relgloss_view.display.display import DITHERS, GAMUTS, TRANSFERS
from relgloss_view.material import approximations
from relgloss_view.pack.shape import ANALYTIC
from relgloss_view.picture import method
from relgloss_view.picture.scene.look import GRAINS, NOISE_LAWS

#: What pass 1 writes: the weights of the shapes, XYZ, the split of L*, or the last two.
WRITES = ("weights", "xyz", "split", "xyz and split")
#: Where a pixel's point, normal and finishes come from: its ray, or what surface.frag wrote.
SURFACES = ("met", "read")
OVERLAYS = (
    "clipped",
    "out of gamut",
    "cut by this display",
    "lightness",
    "diffuse only",
    "specular only",
    "normals",
)

OF_FILES = ("curves", "table")  #: transfers that a profile or a display file has

#: The names of each table, in the order of their numbers.
NAMES: Mapping[str, tuple[str, ...]] = {
    "SHAPE": (*ANALYTIC, "triangles"),
    "SURFACE": SURFACES,
    "DIFFUSE": ("lambert", "oren-nayar", "eon", "qualitative"),
    "NOISE": ("none", *NOISE_LAWS),
    "GRAIN": GRAINS,
    "FRESNEL": approximations.FRESNEL,
    "SHADOWING": approximations.SHADOWING,
    "FACETS": approximations.FACETS,
    "LAMP": method.LAMPS,
    "CUBE_ROOT": ("householder", "power", "table"),
    "WRITES": WRITES,
    "GAMUT": GAMUTS,
    "TRANSFER": (*TRANSFERS, *OF_FILES),
    "DITHER": DITHERS,
    "OVERLAY": OVERLAYS,
}


def code(table: str, name: str) -> int:
    """The number of a name in a table; ValueError for a name that it lacks."""
    return NAMES[table].index(name)


def glsl_name(table: str, name: str) -> str:
    """How the shaders call a name: NOISE_PAPER, SHADOWING_V_GROOVE."""
    return f"{table}_{re.sub('[^A-Z0-9]', '_', name.upper())}"


def definitions() -> list[str]:
    """The lines that define every constant."""
    return [
        f"#define {glsl_name(table, name)} {number}"
        for table, names in NAMES.items()
        for number, name in enumerate(names)
    ]
