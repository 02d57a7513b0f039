"""MaterialX documents of other programs: their surfaces as described materials.

Read are the shading models of the standard library: OpenPBR surface, Autodesk's standard surface,
glTF PBR and USD preview surface. Inputs are followed through node graphs as far as these come to
one value, with the means of pictures; what else an input comes from is not carried over, and is
named. Only pictures are opened beside the file, in its own folder and below.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import named, printable
from relgloss_view.base.xml import line_of, read_xml
from relgloss_view.exchange import materialx_models as models
from relgloss_view.exchange.materialx import OWN_DIGEST, OWN_MATERIAL
from relgloss_view.exchange.materialx_nodes import input_of
from relgloss_view.exchange.materialx_values import Values
from relgloss_view.exchange.own import own_material
from relgloss_view.exchange.refit_lobes import refit_lobes
from relgloss_view.material.material import Material

EXPECTED = "a MaterialX document (.mtlx)"
MOST_BYTES = 8 * 1024 * 1024
MOST_LISTED = 12  #: names of a message
MOST_PARTS = 10_000
INCLUDE = "an XInclude of another file is not followed"


def read(path: Path, part: str | None) -> Material:
    """A material of a document by its name, or the only one. See formats.Reader.

    Raises InputError for a document without a material that is read here, with several and no
    `part`, or with values that no surface has.
    """
    root = read_xml(path, EXPECTED, most_bytes=MOST_BYTES)
    if root.tag != "materialx":
        raise InputError(f"{named(path)}: the root is {printable(root.tag, 40)!r}, not materialx")
    material = _chosen(path, root, part)
    shader = _shader(path, root, material)
    name = material.get("name", "material")
    place = f"{named(path)}: {printable(name, 60)}"
    values = Values.of(root, shader, place, path.parent)
    stated = values.stated()
    own = own_material(material.get(OWN_MATERIAL), material.get(OWN_DIGEST), stated)
    if own is not None:
        return own
    model = models.MODELS[shader.tag]
    surface, not_carried = model.surface(values)
    if any(element.tag == "include" for element in root):
        not_carried = (*not_carried, INCLUDE)
    if input_of(material, "displacementshader") is not None:
        not_carried = (*not_carried, "displacement")
    return refit_lobes(
        surface,
        name=printable(name, 60),
        source=f"described by {path.name} ({model.name}); not measured",
        model=model.name,
        parameters={key: _listed(value) for key, value in stated.items()},
        not_carried=not_carried,
        **models.starting_points(surface),
    )


def _listed(value: Any) -> Any:
    return list(value) if isinstance(value, tuple) else value


def _chosen(path: Path, root: Element, part: str | None) -> Element:
    """The surfacematerial of a name, or the only one; a shader alone counts as one too."""
    found = {e.get("name", ""): e for e in root if e.tag == "surfacematerial"}
    if not found:
        found = {e.get("name", ""): e for e in root if e.tag in models.MODELS}
    if not found and any(e.tag == "shaderref" for e in root.iter()):
        raise InputError(
            f"{named(path)}: MaterialX {printable(root.get('version'), 10)}, which names its "
            "surfaces by shaderref; expected 1.38 or later: MaterialX itself, and programs that "
            "use it, read it and save it as such"
        )
    if not found:
        known = ", ".join(models.MODELS)
        included = f"; {INCLUDE}" if any(e.tag == "include" for e in root) else ""
        raise InputError(
            f"{named(path)}: no surfacematerial and no surface of {known} in the file{included}"
        )
    names = ", ".join(printable(name, 40) for name in list(found)[:MOST_LISTED])
    more = f" and {len(found) - MOST_LISTED} more" if len(found) > MOST_LISTED else ""
    if part is None:
        if len(found) > 1:
            raise InputError(
                f"{named(path)}: {len(found)} materials; name one with --part: {names}{more}"
            )
        return next(iter(found.values()))
    if part not in found:
        raise InputError(
            f"{named(path)}: no material {printable(part, 60)!r}; expected one of {names}{more}"
        )
    return found[part]


def _shader(path: Path, root: Element, material: Element) -> Element:
    """The surface shader that a surfacematerial uses."""
    if material.tag in models.MODELS:
        return material
    place = f"{named(path)}: line {line_of(material)}"
    used = input_of(material, "surfaceshader")
    target = None if used is None else used.get("nodename")
    shader = next((e for e in root if e.get("name") == target), None) if target else None
    if shader is None and used is not None and used.get("nodegraph"):
        graph = next((e for e in root if e.get("name") == used.get("nodegraph")), None)
        inside = [] if graph is None else [e for e in graph if e.tag in models.MODELS]
        shader = inside[0] if len(inside) == 1 else None
    if shader is None:
        raise InputError(
            f"{place}: the surfaceshader of {printable(material.get('name'), 60)} is not in the "
            "file"
        )
    if shader.tag not in models.MODELS:
        raise InputError(
            f"{named(path)}: line {line_of(shader)}: surface {printable(shader.tag, 40)!r}; "
            f"expected one of {', '.join(models.MODELS)}"
        )
    return shader
