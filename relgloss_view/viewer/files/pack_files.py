"""Files of packs that the window opens: pack files, artwork, meshes; by content where it says so.

No OpenGL, no window library: a thread of OpenJob does it.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

from relgloss_view.pack.forms.mesh_files import MESH_SUFFIXES
from relgloss_view.pack.pack import Pack
from relgloss_view.pack.shape import Shape
from relgloss_view.picture.scene.file_kinds import likely_kind

MESH = "mesh"
ARTWORK_SUFFIXES = (".pdf", ".ai", ".eps", ".png", ".jpg", ".jpeg", ".tif", ".tiff", ".psd")
NO_PROFILE = "CMYK without a profile"  #: of the message where an artwork needs one


def file_kind(path: str | os.PathLike[str]) -> str:
    """MESH by the file's name, or the kind that its content shows; InputError for anything else."""
    return MESH if Path(path).suffix.lower() in MESH_SUFFIXES else likely_kind(path)


def opened_pack(path: str, progress: Callable[[float, str], None]) -> Pack:
    """The pack of a pack file; InputError where it can't be read."""
    from relgloss_view.pack.pack_file import read_pack

    return read_pack(path, progress)


def opened_artwork(path: str, progress: Callable[[float, str], None], profile: str = "") -> Pack:
    """An artwork on a can, with a finish for each plate that names one; InputError.

    profile: an ICC file, of the printing condition where the artwork is CMYK without one.
    """
    from relgloss_view.pack.quick import quick_pack

    return quick_pack(path, given={"profile": profile} if profile else None, progress=progress)


def opened_mesh(path: str, progress: Callable[[float, str], None]) -> Shape:
    """The form of a mesh file, which is read once and kept; InputError."""
    from relgloss_view.pack.forms import mesh_of

    progress(0.1, "reading the mesh")
    shape = Shape("mesh", file=str(Path(path).absolute()))
    mesh_of(shape)
    return shape


def mesh_notes(shape: Shape) -> tuple[str, ...]:
    """What a user should know of a form's mesh; none of an analytic form."""
    from relgloss_view.pack.forms import mesh_of

    mesh = mesh_of(shape)
    return () if mesh is None else mesh.notes
