"""Files of packs that the window opens: pack files, artwork, meshes; by content where it says so.

No OpenGL, no window library: a thread of OpenJob does it.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

from relgloss_view.base.reading import read_beginning
from relgloss_view.pack.pack import Pack
from relgloss_view.pack.shape import Shape

PACK, ARTWORK, MESH = "pack file", "artwork", "mesh"
HEAD_BYTES = 64 * 1024
EXPECTED = "a pack file, an artwork or a mesh"
PACK_SUFFIXES = (".toml",)
ARTWORK_SUFFIXES = (".pdf", ".ai", ".png", ".jpg", ".jpeg", ".tif", ".tiff", ".psd")
MESH_SUFFIXES = (".glb", ".gltf", ".obj", ".ply")
#: First bytes of artwork: PDF, PNG, JPEG, TIFF of both byte orders and of 64 bits, Photoshop.
_ARTWORK_HEADS = (
    b"\x89PNG\r\n\x1a\n",
    b"\xff\xd8\xff",
    b"II*\x00",
    b"MM\x00*",
    b"II+\x00",
    b"MM\x00+",
    b"8BPS",
)
_PDF_WITHIN = 1024  #: bytes; readers of PDF look so far for its mark
_MESH_HEADS = (b"glTF", b"ply\n", b"ply\r")


def pack_kind(path: str | os.PathLike[str]) -> str | None:
    """PACK, ARTWORK or MESH; None for a file of another kind. InputError where it can't be read."""
    head = read_beginning(path, HEAD_BYTES, EXPECTED)
    suffix = Path(path).suffix.lower()
    if head.startswith(_ARTWORK_HEADS) or b"%PDF-" in head[:_PDF_WITHIN]:
        return ARTWORK
    if head.startswith(_MESH_HEADS) or suffix in (".gltf", ".obj"):
        return MESH
    lines = [line.strip() for line in head.lstrip(b"\xef\xbb\xbf").splitlines()]
    if any(line.startswith((b"[pack]", b"[[finish]]")) for line in lines):
        return PACK
    if suffix in ARTWORK_SUFFIXES:  # its reader reports what is wrong with it
        return ARTWORK
    return MESH if suffix in MESH_SUFFIXES else None


def opened_pack(path: str, progress: Callable[[float, str], None]) -> Pack:
    """The pack of a pack file; InputError where it can't be read."""
    from relgloss_view.pack.pack_file import read_pack

    return read_pack(path, progress)


def opened_artwork(path: str, progress: Callable[[float, str], None]) -> Pack:
    """An artwork on a can, with a finish for each plate that names one; InputError."""
    from relgloss_view.pack.quick import quick_pack

    return quick_pack(path, progress=progress)


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
