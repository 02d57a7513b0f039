"""What a page draws packs and forms of triangles with, beside drawing.py."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from relgloss_view.material.spectra import illuminant
from relgloss_view.pack import forms
from relgloss_view.pack.label import label_of
from relgloss_view.pack.layers import layers_of
from relgloss_view.pack.pack import Pack
from relgloss_view.pack.paint import paint_matrix
from relgloss_view.picture.gpu.finishes import RGB_OF_PAINT, finish_tables, ink_uniforms
from relgloss_view.picture.gpu.memory import MOST_TEXELS
from relgloss_view.picture.gpu.printed import MOST_LEVELS, part_rows, share_defines
from relgloss_view.picture.gpu.surface import print_uniforms
from relgloss_view.picture.gpu.targets import surface_targets
from relgloss_view.picture.gpu.triangles import WIDE
from relgloss_view.picture.gpu.uniforms import colour_uniforms, material_uniforms
from relgloss_view.picture.method import EXACT
from relgloss_view.picture.model.pixel_sampling import curvature
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.proof.arrays import packed
from relgloss_view.proof.layers_drawing import layers_drawing
from relgloss_view.proof.mesh_drawing import mesh_drawing
from relgloss_view.proof.uniform_numbers import uniform_numbers

MESH_STAGES = ("mesh.frag",)
MESH_EDGE_STAGES = ("mesh_edge.frag", "mesh_places.frag")


def pack_drawing(scene: Scene, look: Look, lamps: tuple[str, ...]) -> dict[str, Any]:
    """The entries of a side that its pack or its triangles need, merged over those of drawing.py.

    lamps: the illuminants that the page offers. `stages` lists further stages. Raises InputError.
    """
    mesh, pack = forms.mesh_of(scene.shape), scene.pack
    finishes = 0 if pack is None else len(pack.finishes)
    stages = ["surface.frag", *(MESH_STAGES if mesh is not None else ())]
    if mesh is not None and scene.display.edges == "smooth":
        stages += MESH_EDGE_STAGES
    surface: dict[str, Any] = {
        "finishes": finishes,
        "targets": list(surface_targets(finishes)),
        "mesh": None if mesh is None else mesh_drawing(mesh),
        "defines": {"FINISHES": finishes, "MESH_WIDE": WIDE},
        "most_texels": MOST_TEXELS,
        "printed": None,
    }
    side: dict[str, Any] = {"stages": stages, "surface": surface}
    if mesh is not None:
        side["shape"] = {"curvature_per_m": curvature(mesh)}
    if pack is None:
        return side
    return {
        **side,
        **_finishes(scene, pack, look, lamps),
        "surface": surface | _printed(pack, look),
    }


def share_meshes(sides: dict[str, Any]) -> None:
    """Write a mesh that both sides have once: the test's becomes 'reference'."""
    reference, test = (sides.get(name, {}).get("surface") for name in ("reference", "test"))
    if reference and test and test["mesh"] is not None and test["mesh"] == reference["mesh"]:
        test["mesh"] = "reference"


def _printed(pack: Pack, look: Look) -> dict[str, Any]:
    """Entries of `surface`: the layers, and where they lie."""
    layers, label = layers_of(pack), label_of(pack.shape)
    channels = layers.channels.shape[-1]
    constants = {
        "FINISHES": len(pack.finishes),
        "MESH_WIDE": WIDE,
        "CHANNELS": -(-channels // 4),
        **share_defines(layers),
    }
    uniforms = {**print_uniforms(pack, layers), **ink_uniforms(pack, look, EXACT)}
    return {
        "defines": constants,
        "printed": {
            **layers_drawing(pack, layers),
            "most_levels": MOST_LEVELS,
            "uniforms": uniform_numbers(uniforms),
            "part_table": packed(part_rows(layers, label.printed).astype(np.float32)),
        },
    }


def _finishes(scene: Scene, pack: Pack, look: Look, lamps: tuple[str, ...]) -> dict[str, Any]:
    """The finishes' numbers; the tables are constants of the shaders, by the lamp's spectrum."""
    colours = {}
    for name in lamps:
        lamp = illuminant(name)
        white = lamp.white_xyz()
        lit = scene.placed(lamp=replace(scene.lamp, illuminant=name))
        colours[name] = uniform_numbers(
            {
                **colour_uniforms(lit, EXACT),
                "paint_matrix": paint_matrix(pack.colour, lamp).T,  # columns first
                "lamp_xyz": white,
                "per_white": 1.0 / white,
            }
        )
    return {
        "own_sigma_n_deg": [finish.sigma_n_deg for finish in pack.finishes],
        "finish_k": [finish.k for finish in pack.finishes],
        "finish_tables": {
            name: finish_tables(pack, look, EXACT, name, blurred=False) for name in lamps
        },
        # No finish reads the base's numbers, but linkers of browsers keep their uniforms.
        "material": uniform_numbers({**material_uniforms(scene, look, EXACT), **RGB_OF_PAINT}),
        "colours": colours,
    }
