"""The formats of other programs: what is written by the ending of a file, and what is read.

A format is one line of FORMATS or READERS. Its module is imported when it is used.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import named, printable, read_beginning
from relgloss_view.exchange.loss import Loss
from relgloss_view.material.material import Material
from relgloss_view.pack.pack import Pack
from relgloss_view.pack.shape import Shape

MOST_PX = 4096  #: the longest side of a texture where nobody asks for another
#: Directions of BSDF XML: of Radiance, and of WINDOW.
BASES = TREE, KLEMS = "tensor-tree", "klems"
HEAD_BYTES = 4096  #: by which a file's format is recognised


@dataclass(frozen=True)
class ExportOptions:
    """What a user asks for beside the format; a writer ignores what it has no use for.

    shape: the form of a plain material, where the format holds one. most_px: the longest side of
    textures, pixels. grid: of CSV tables, `gcms`, `in-plane`, `in-plane:STEP` (degrees) or a file
    of directions. basis: of BSDF XML, one of BASES; None for the first. bare: without the material
    itself, its gloss and the losses: a file for somebody else would hold measured numbers.
    """

    shape: Shape | None = None
    most_px: int = MOST_PX
    grid: str | None = None
    basis: str | None = None
    bare: bool = False


@dataclass(frozen=True)
class Exported:
    """What was written.

    lines: one sentence each, of what was carried and lost, as the file holds them too. losses: by
    the name of the material, or of a pack's finish; empty where the format holds the model itself.
    """

    lines: tuple[str, ...]
    losses: dict[str, Loss]

    @property
    def is_small(self) -> bool:
        """Whether nobody has to be warned of a loss."""
        return all(loss.is_small for loss in self.losses.values())


#: Writes a material, or a pack where the format takes one, into a file that appears whole.
Writer = Callable[[Material | Pack, Path, ExportOptions], Exported]
#: Reads the part of a name, or the only one, as a described material; InputError lists the parts.
Reader = Callable[[Path, str | None], Material]


class Format(NamedTuple):
    """A format that is written."""

    name: str  #: for people
    writer: str  #: 'module:function' below relgloss_view.exchange
    takes_packs: bool = False
    holds_own: bool = False  #: whether its files hold the material itself, unless they are bare
    options: tuple[str, ...] = ()  #: of the command, that it has a use for, beside --bare

    def write(self, what: Material | Pack, path: Path, options: ExportOptions) -> Exported:
        """Write a material or a pack; InputError where the format takes no packs."""
        if isinstance(what, Pack) and not self.takes_packs:
            raise InputError(
                f"{named(path)}: {self.name} holds one material; give a material or a sample, "
                "not a pack"
            )
        if options.bare and not self.holds_own:
            raise InputError(
                f"{named(path)}: {self.name} is a table of the material's numbers and can't be "
                "written --bare; choose .glb or .mtlx"
            )
        write: Writer = _function(self.writer)
        return write(what, path, options)


class ReadFormat(NamedTuple):
    """A format that is read."""

    name: str
    recognised: Callable[[bytes], bool]  #: from a file's beginning
    reader: str  #: as Format.writer

    def read(self, path: Path, part: str | None) -> Material:
        """Read a material; see Reader."""
        read: Reader = _function(self.reader)
        return read(path, part)


def _is_gltf(head: bytes) -> bool:
    """Whether a file begins as glTF: as a .glb, or as JSON with one of glTF's words."""
    words = (b'"asset"', b'"accessors"', b'"bufferViews"', b'"extensionsUsed"', b'"materials"')
    is_object = head.lstrip(b"\xef\xbb\xbf \t\r\n").startswith(b"{")
    return head.startswith(b"glTF") or (is_object and any(word in head for word in words))


#: What is written, by the ending of the file's name.
FORMATS: dict[str, Format] = {
    ".mtlx": Format(
        "MaterialX (OpenPBR surface)", "materialx:write", takes_packs=True, holds_own=True
    ),
    ".glb": Format("glTF 2.0", "gltf:write", True, True, options=("form", "pixels")),
    ".binary": Format("MERL binary", "merl:write"),
    ".csv": Format("CSV of directions and values", "csv_out:write", options=("grid",)),
    ".xml": Format("BSDF XML (Radiance, WINDOW)", "bsdf_xml:write", options=("basis",)),
}
#: What is read, by its beginning.
READERS: tuple[ReadFormat, ...] = (
    ReadFormat("MaterialX", lambda head: b"<materialx" in head, "materialx_reading:read"),
    ReadFormat("glTF 2.0", _is_gltf, "gltf_reading:read_gltf"),
)


def format_of(path: Path) -> Format:
    """The format of a file to be written; InputError lists the endings."""
    lower = path.name.lower()
    for ending, known in sorted(FORMATS.items(), key=lambda item: -len(item[0])):
        if lower.endswith(ending):
            return known
    raise InputError(f"{named(path)}: expected a name that ends with one of {endings()}")


def endings() -> str:
    """The endings of what is written, for messages.

    >>> ".mtlx" in endings()
    True
    """
    return ", ".join(f"{ending} ({known.name})" for ending, known in FORMATS.items())


def reader_of(path: Path) -> ReadFormat:
    """The format of a file to be read; InputError where none is recognised."""
    names = " or ".join(known.name for known in READERS)
    head = read_beginning(path, HEAD_BYTES, f"a material of {names}")
    for known in READERS:
        if known.recognised(head):
            return known
    raise InputError(
        f"{named(path)}: begins with {printable(head[:20].decode('utf-8', 'replace'), 20)!r}; "
        f"expected a material of {names}"
    )


def _function(place: str) -> Any:
    module, _, name = place.partition(":")
    return getattr(importlib.import_module(f"relgloss_view.exchange.{module}"), name)
