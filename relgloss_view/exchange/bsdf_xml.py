"""BSDF in XML out: tensor trees for Radiance, which keep the gloss, or Klems's patches for WINDOW.

A tree is isotropic, of rank 3, and is cut where the lobe is (exchange.grow). Colour goes beside the
luminance as CIE u' and v', relative to a perfect diffuser that is white in Radiance, which has the
equal-energy white. The file states what is lost in a comment.

Sources: BSDF-v1.7.7.xsd (LBNL) for the elements; Ward, Radiance's bsdf_t.c and bsdf_m.c, for what
they mean; Klems 1994 (ASHRAE Transactions 100) for the patches.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from xml.sax.saxutils import escape

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.base.version import PROGRAM
from relgloss_view.base.writing import whole_file
from relgloss_view.exchange.channels import TableSurface, in_xyz, metal_notes
from relgloss_view.exchange.formats import KLEMS, TREE, Exported, ExportOptions
from relgloss_view.exchange.grow import Grown, collapsed, grow
from relgloss_view.exchange.judge import compare
from relgloss_view.exchange.klems_out import Patches
from relgloss_view.exchange.loss import LAMP
from relgloss_view.material.material import Material
from relgloss_view.material.spectra import illuminant
from relgloss_view.measure.readers.shirley_chiu import coordinates
from relgloss_view.measure.readers.tensor_tree import RADIANCE_WHITE, Tree, uv_of, xyz_of
from relgloss_view.measure.readers.tristimulus import SRGB_FROM_XYZ
from relgloss_view.pack.pack import Pack

DEEPEST_LEVEL = 11  #: a smallest cell of 1/1024 in the sine of an angle
MOST_LEAVES = 2_000_000  #: of a tree; about 12 MB
#: Chromaticities closer than this are one: a twentieth of what an eye tells apart in u'v' is 2e-4,
#: and a highlight's own mixture of body and lobe changes a hundred times as much.
UV_WITHIN = 1e-3
LONGEST_TEXT = 400  #: characters of a name or a comment
NEUTRAL_WITHIN = 5e-4  #: u'v' of a neutral, whose file has the luminance alone

_HEAD = """<?xml version="1.0" encoding="UTF-8"?>
<WindowElement xmlns="http://windows.lbl.gov" \
xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" \
xsi:schemaLocation="http://windows.lbl.gov/BSDF-v1.4.xsd">
{comment}<WindowElementType>System</WindowElementType>
<FileType>BSDF</FileType>
<Optical>
<Layer>
<Material>
<Name>{name}</Name>
<Manufacturer>{maker}</Manufacturer>
<DeviceType>Other</DeviceType>
</Material>
<DataDefinition>
<IncidentDataStructure>{structure}</IncidentDataStructure>
{basis}</DataDefinition>
"""
_TAIL = "</Layer>\n</Optical>\n</WindowElement>\n"


def write(what: Material | Pack, path: Path, options: ExportOptions) -> Exported:
    """Write a material; see exchange.formats.Writer."""
    assert isinstance(what, Material)  # Format.write refuses packs
    basis = options.basis or TREE
    if basis == TREE:
        blocks, surface, lines = _trees(what)
        structure, definition = "TensorTree3", ""
    elif basis == KLEMS:
        patches = Patches.of(what)
        blocks, surface, lines = patches.blocks(), patches.surface(), patches.lines()
        structure, definition = "Columns", patches.definition()
    else:
        raise InputError(
            f"--basis {printable(basis, 20)}: expected {TREE} (Radiance) or {KLEMS} (WINDOW)"
        )
    loss = compare(what, surface)
    lines = (loss.verdict, f"in the file: {loss.words}", *lines, *metal_notes(what))
    head = _HEAD.format(
        comment="".join(f"<!-- {_comment(line)} -->\n" for line in (f"{PROGRAM}", *lines)),
        name=escape(printable(what.name, LONGEST_TEXT)),
        maker=escape(PROGRAM),
        structure=structure,
        basis=definition,
    )
    with whole_file(path) as temporary, temporary.open("w", encoding="utf-8", newline="\n") as file:
        file.write(head)
        for block in blocks:
            file.write(block)
        file.write(_TAIL)
    return Exported(lines, {what.name: loss})


def _trees(material: Material) -> tuple[list[str], TableSurface, tuple[str, ...]]:
    grown, u, v = trees_of(material)
    trees = (
        {"Visible": grown} if u is None or v is None else {"Visible": grown, "CIE-u": u, "CIE-v": v}
    )
    blocks = [_tree_block(wavelength, tree) for wavelength, tree in trees.items()]
    cells = len(grown.values)
    lines = (
        f"carried: the BRDF in {cells} cells of directions down to {2 * grown.smallest:.2g} in the "
        "sine of the angle (tensor tree, Radiance), for the side that surface normals face",
        f"carried: the colour under {LAMP} relative to a white diffuser"
        if len(trees) > 1
        else "carried: the luminance; the material is neutral",
        "lost: the spectrum, the model and the evidence of the fit",
    )
    return blocks, TableSurface(tree_values(grown, u, v)), lines


def trees_of(material: Material) -> tuple[Tree, Tree | None, Tree | None]:
    """Luminance, u' and v' of a material's BRDF; no u' and v' where it is neutral."""
    folded = in_xyz(material)
    white = illuminant(LAMP).white_xyz()

    def luminance_first(i: Array, o: Array) -> Array:
        return folded.brdf(i, o)[:, [1, 0, 2]]

    grown: Grown = grow(luminance_first, DEEPEST_LEVEL, MOST_LEAVES)
    xyz = grown.values[:, [1, 0, 2]] / white * RADIANCE_WHITE
    dark = xyz[:, 1] <= 0.0
    xyz[dark] = RADIANCE_WHITE
    u, v = uv_of(xyz)
    luminance = Tree(3, grown.levels, np.maximum(grown.values[:, 0], 0.0))
    neutral_u, neutral_v = uv_of(RADIANCE_WHITE[None])
    if max(np.max(np.abs(u - neutral_u)), np.max(np.abs(v - neutral_v))) < NEUTRAL_WITHIN:
        return luminance, None, None
    weights = np.maximum(grown.values[:, 0], 1e-9)
    u_tree, v_tree = (
        Tree(3, *collapsed(grown.levels, part, weights, UV_WITHIN)) for part in (u, v)
    )
    return luminance, u_tree, v_tree


def tree_values(y: Tree, u: Tree | None, v: Tree | None) -> Callable[[Array, Array], Array]:
    """Linear sRGB of trees at unit vectors (M, 3) each."""
    white = illuminant(LAMP).white_xyz()

    def values(i: Array, o: Array) -> Array:
        places = coordinates(i, o, y.rank)
        luminance = y.at(places)
        if u is None or v is None:
            return np.repeat(luminance[:, None], 3, axis=1)
        xyz = xyz_of(luminance, u.at(places), v.at(places)) / RADIANCE_WHITE * white
        return np.asarray(xyz @ SRGB_FROM_XYZ.T)

    return values


def _tree_block(wavelength: str, tree: Tree) -> str:
    # What Radiance calls the front, z > 0, WINDOW calls the back (bsdf_t.c).
    return (
        "<WavelengthData>\n<LayerNumber>System</LayerNumber>\n"
        f'<Wavelength unit="Integral">{wavelength}</Wavelength>\n'
        "<SourceSpectrum>CIE Illuminant D65 1nm.ssp</SourceSpectrum>\n"
        "<DetectorSpectrum>ASTM E308 1931 Y.dsp</DetectorSpectrum>\n"
        "<WavelengthDataBlock>\n"
        "<WavelengthDataDirection>Reflection Back</WavelengthDataDirection>\n"
        "<AngleBasis>LBNL/Shirley-Chiu</AngleBasis>\n"
        "<ScatteringDataType>BRDF</ScatteringDataType>\n"
        f"<ScatteringData>\n{tree.text()}</ScatteringData>\n"
        "</WavelengthDataBlock>\n</WavelengthData>\n"
    )


def _comment(line: str) -> str:
    """A line within an XML comment, where two hyphens end it.

    >>> _comment("one --- two")
    'one - - - two'
    """
    text = escape(printable(line, LONGEST_TEXT))
    return text.replace("--", "- -").replace("--", "- -")  # three of them leave a second pair
