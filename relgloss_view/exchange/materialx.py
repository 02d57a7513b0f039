"""MaterialX documents: a material, or the finishes of a pack, as OpenPBR surfaces.

Version 1.39 of MaterialX, version 1.1 of OpenPBR. Colours are linear sRGB, `lin_rec709`.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, NamedTuple
from xml.sax.saxutils import quoteattr

from relgloss_view.base.version import __version__
from relgloss_view.base.visible import visible
from relgloss_view.base.writing import whole_file
from relgloss_view.exchange.formats import Exported, ExportOptions
from relgloss_view.exchange.openpbr import OpenPbr
from relgloss_view.exchange.own import own_numbers, rounded
from relgloss_view.exchange.refit import Refit, refit_openpbr, said_once
from relgloss_view.material.material import Material
from relgloss_view.pack.pack import Pack

VERSION = "1.39"
COLOUR_SPACE = "lin_rec709"
NODE = "open_pbr_surface"
#: Attributes of a material that hold our own numbers.
OWN_MATERIAL, OWN_DIGEST, OWN_LOSS = "relgloss_material", "relgloss_digest", "relgloss_loss"
LONGEST_NAME = 60
PACK_NOTE = (
    "MaterialX holds the materials of the finishes; form, artwork and masks of the pack are not "
    "carried: write a .glb for them"
)


class _Part(NamedTuple):
    """One material of a document."""

    name: str
    material: Material
    refit: Refit


def write(what: Material | Pack, path: Path, options: ExportOptions) -> Exported:
    """Write a material, or each finish of a pack, as OpenPBR surfaces. See formats.Writer."""
    if isinstance(what, Pack):
        named = [(finish.name, finish.material) for finish in what.finishes]
        notes: tuple[str, ...] = (PACK_NOTE,)
    else:
        named, notes = [(what.name, what)], ()
    parts, taken = [], set[str]()
    for name, material in named:
        parts.append(_Part(_identifier(name, taken), material, refit_openpbr(material)))
    with whole_file(path) as temporary:
        temporary.write_text(_document(parts, options.bare), encoding="utf-8", newline="\n")
    lines = said_once((part.name, part.refit.lines) for part in parts)
    return Exported((*lines, *notes), {part.name: part.refit.loss for part in parts})


def parameters_of(surface: OpenPbr) -> dict[str, Any]:
    """The parameters that a document states, rounded as it states them."""
    return {
        name: rounded(value) if isinstance(value, float) else tuple(rounded(v) for v in value)
        for name, value in surface.changed().items()
    }


def _document(parts: list[_Part], bare: bool) -> str:
    lines = [
        '<?xml version="1.0" encoding="utf-8"?>',
        f'<materialx version="{VERSION}" colorspace="{COLOUR_SPACE}">',
    ]
    for part in parts:
        lines += _material(part, bare)
    return "\n".join([*lines, "</materialx>", ""])


def _material(part: _Part, bare: bool) -> list[str]:
    surface = part.refit.surface
    assert isinstance(surface, OpenPbr)
    parameters = parameters_of(surface)
    own = own_numbers(part.material, parameters)
    loss = part.refit.loss
    words = f"{part.material.name}, by relgloss {__version__}"
    mine = ""
    if not bare:
        words += f"; {'; '.join(part.refit.lines[:2])}"
        words = words if loss.is_small else f"WARNING: {words}"
        mine = (
            f" {OWN_DIGEST}={quoteattr(own['digest'])} {OWN_LOSS}={quoteattr(loss.words)} "
            f"{OWN_MATERIAL}={quoteattr(own['material'])}"
        )
    shader = f"{part.name}_surface"
    lines = [f'  <{NODE} name="{shader}" type="surfaceshader" doc={quoteattr(words)}>']
    for name, value in parameters.items():
        kind = "float" if isinstance(value, float) else "color3"
        text = f"{value:.6g}" if kind == "float" else ", ".join(f"{v:.6g}" for v in value)
        lines.append(f'    <input name="{name}" type="{kind}" value="{text}" />')
    lines += [
        f"  </{NODE}>",
        f'  <surfacematerial name="{part.name}" type="material" doc={quoteattr(words)}{mine}>',
        f'    <input name="surfaceshader" type="surfaceshader" nodename="{shader}" />',
        "  </surfacematerial>",
    ]
    return [visible(line) for line in lines]  # XML 1.0 forbids what nobody sees


def _identifier(name: str, taken: set[str]) -> str:
    """A name that MaterialX allows (letters, digits, _), and that is not yet taken; it is noted.

    >>> _identifier("matte-coated, green ink", set())
    'matte_coated_green_ink'
    """
    words = "".join(c if c.isascii() and c.isalnum() else " " for c in name).split()
    plain = "_".join(words)[:LONGEST_NAME] or "material"
    plain = f"m_{plain}" if plain[0].isdigit() else plain
    unique, count = plain, 2
    while unique in taken:
        unique, count = f"{plain}_{count}", count + 1
    taken.add(unique)
    return unique
