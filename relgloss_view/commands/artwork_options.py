"""Options of an artwork: its form, and how its file is read."""

from __future__ import annotations

import argparse
from typing import Any

from relgloss_view.pack.forms.mesh_files import MESH_SUFFIXES
from relgloss_view.pack.shape import SHAPES

FORMS = tuple(kind for kind in SHAPES if kind != "mesh")  #: that need no file
_EXPECTED = f"{', '.join(FORMS)}, or a mesh file ({', '.join(MESH_SUFFIXES)})"
#: How an artwork is read: type, metavar and help by the entry of a pack file.
ARTWORK_OPTIONS: dict[str, tuple[Any, str, str]] = {
    "profile": (str, "FILE.icc", "Colour profile of {} that has none, such as CMYK"),
    "page": (int, "N", "Page of {} that is a PDF (default 1)"),
    "dpi": (float, "DPI", "Resolution of {}"),
    "width_mm": (float, "MM", "Printed width of {} that is a picture"),
}


def add_artwork_options(parser: Any, artwork: str) -> None:
    """Declare --form and the options of ARTWORK_OPTIONS; artwork: how their help names it."""
    parser.add_argument(
        "--form",
        metavar="FORM|MESH",
        type=form_of_text,
        help=f"Form of {artwork}: {_EXPECTED} (default can)",
    )
    for name, (kind, metavar, text) in ARTWORK_OPTIONS.items():
        flag = f"--{name.replace('_', '-')}"
        parser.add_argument(flag, metavar=metavar, type=kind, help=text.format(artwork))


def form_of_text(text: str) -> str:
    """The form that an option names, for argparse: a kind of shape, or a mesh file."""
    if text in FORMS or text.lower().endswith(MESH_SUFFIXES):
        return text
    raise argparse.ArgumentTypeError(f"expected {_EXPECTED}, got {text!r}")


def artwork_entries(args: argparse.Namespace) -> dict[str, Any]:
    """How an artwork is read, as the entries of a pack file; those that were given."""
    values = {name: getattr(args, name) for name in ARTWORK_OPTIONS}
    return {name: value for name, value in values.items() if value is not None}
