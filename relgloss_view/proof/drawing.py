"""Drawing: everything that the page draws with and no slider changes, as JSON.

The page draws the stages of shaders/ as picture.gpu draws them, the whole model of each. What
depends on a slider (view, lamp, sigma_N, c) it works out itself, by twins that carry the same
names; every other number comes from here, ready made.

    {"definitions": [...], "numbers": {...}, "display": {...}, "stages": [...],
     "sides": {"reference": {...}, "test": {...}}}
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any, cast

from relgloss_view.base.errors import InputError
from relgloss_view.display.display import Display
from relgloss_view.material.spectra import illuminant
from relgloss_view.pack.shape import ANALYTIC, CURVED
from relgloss_view.picture import pair
from relgloss_view.picture.gpu.constants import definitions
from relgloss_view.picture.gpu.shader import OWN_VERTEX, VERTEX, stage_text
from relgloss_view.picture.gpu.uniforms import (
    ambient_uniforms,
    colour_uniforms,
    display_uniforms,
    material_uniforms,
)
from relgloss_view.picture.gpu.uploads import Uploads
from relgloss_view.picture.gpu.variant import Variant, tone_defines
from relgloss_view.picture.method import EXACT
from relgloss_view.picture.model import grain_field, light, pixel_sampling, silhouette, tone, view
from relgloss_view.picture.model.drawn import as_drawn
from relgloss_view.picture.model.lights import lamps_of, share_of
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.setup import FurtherLamp
from relgloss_view.proof.arrays import packed
from relgloss_view.proof.pack_drawing import pack_drawing, share_meshes
from relgloss_view.proof.uniform_numbers import uniform_numbers

#: Lamps that a page offers beside the scene's own.
LAMPS = ("HP5", "D65", "D50", "A", "FL2", "FL11")
#: Stages of every page, and the library whose functions check.js calls.
STAGES = (
    "shade.frag",
    "split.frag",
    "measure.frag",
    "reduce.frag",
    "tone.frag",
    "white.frag",
    "peak.frag",
    "evaluate.frag",
    "difference.glsl",
)
SMOOTH_STAGES = ("coverage.frag", "edge.frag")
GRAIN_STAGES = ("grain_field.frag",)
#: Libraries that are included only where a constant of pass 1 is not 0.
OPTIONAL = {"finishes.glsl": "FINISHES", "ambient.glsl": "AMBIENT", "lamp_size.glsl": "LAMP_SIZE"}
_INCLUDE = re.compile(r'^\s*#include\s+"([^"]+)"', re.M)


def page_display(display: Display) -> Display:
    """The display that a page draws for: sRGB, which browsers carry to the monitor's own colours.

    What says how pictures look stays: the surround, gamut, edges, dither, pixel pitch and viewing
    distance. Luminances, reflected light and profiles are those of the designer's monitor, which
    the page cannot know of the reader's.
    """
    return Display(
        gamut=display.gamut,
        background_lstar=display.background_lstar,
        pixel_pitch_mm=display.pixel_pitch_mm,
        viewing_distance_m=display.viewing_distance_m,
        edges=display.edges,
        dither=display.dither,
    )


def drawing_of(
    sides: Mapping[str, tuple[Scene, Look]], lamps: Iterable[str] = LAMPS
) -> dict[str, Any]:
    """What a page draws the pictures of a proof with.

    sides: scene and look of 'reference' and 'test'; their c and sigma_N do not matter, and their
    display is replaced by `page_display`. lamps: illuminants that the page offers beside the
    scenes' own; unknown ones are left out. Raises InputError where a scene's own is unknown.
    """
    scenes = {
        side: (as_drawn(scene.placed(display=page_display(scene.display)), look), look)
        for side, (scene, look) in sides.items()
    }
    own = dict.fromkeys(scene.lamp.illuminant for scene, _ in scenes.values())
    offered = [name for name in dict.fromkeys([*own, *lamps]) if name in own or _is_known(name)]
    first, _ = next(iter(scenes.values()))
    stages = [*STAGES, *(SMOOTH_STAGES if first.display.edges == "smooth" else ())]
    drawn = {side: _side(scene, look, offered) for side, (scene, look) in scenes.items()}
    if any("surface" in side for side in drawn.values()):
        share_meshes(drawn)
    if any(look.grain == "eye" for _, look in scenes.values()):
        stages += GRAIN_STAGES
    for side in drawn.values():
        stages += [name for name in side.pop("stages", ()) if name not in stages]
    return {
        "definitions": definitions(),
        "numbers": NUMBERS,
        "display": _display(first),
        "lamps": offered,
        "stages": stages,
        "one_form": len({scene.shape for scene, _ in scenes.values()}) == 1,
        "sides": drawn,
    }


def shaders_of(drawing: Mapping[str, Any]) -> dict[str, str]:
    """The texts of the shader files that a drawing needs, by name."""
    texts: dict[str, str] = {}
    sides = drawing["sides"].values()
    unread = set()
    for library, constant in OPTIONAL.items():
        variants = [variant["shade"] for side in sides for variant in side["variants"].values()]
        if not any(variant.get(constant, 0) for variant in variants):
            unread.add(library)

    def add(name: str) -> None:
        if name in texts or name in unread:
            return
        texts[name] = stage_text(name)
        for included in _INCLUDE.findall(texts[name]):
            add(included)

    for stage in drawing["stages"]:
        add(stage)
        if stage.endswith(".frag"):
            add(OWN_VERTEX.get(stage, VERTEX))
    return dict(sorted(texts.items()))


#: Numbers of the twins in page/js, by their names in Python.
NUMBERS: dict[str, Any] = {
    "WIDE": list(view.WIDE),
    "NARROW": view.NARROW,
    "EDGE_ON": view.EDGE_ON,
    "AFAR_RADII": view.AFAR_RADII,
    "FILL": view.FILL,
    "BOUNDS_MARGIN_PX": view.BOUNDS_MARGIN_PX,
    "ROUNDING": view.ROUNDING,
    "BOUNDS_EXCESS": view.BOUNDS_EXCESS,
    "GRAZING_COSINE": light.GRAZING_COSINE,
    "MAX_SAMPLES": pixel_sampling.MAX_SAMPLES,
    "STEP_SD": pixel_sampling.STEP_SD,
    "PIXELS_A_GRAIN": pixel_sampling.PIXELS_A_GRAIN,
    "FIELD_TILE": grain_field.FIELD_TILE,
    "CELL_STEPS": grain_field.CELL_STEPS,
    "EDGE_RAYS": silhouette.EDGE_RAYS,
    "TILE_PX": silhouette.TILE_PX,
    "CLIP_TOLERANCE": tone.CLIP_TOLERANCE,
    "NO_LOBE_LSTAR": tone.NO_LOBE_LSTAR,
    "OFF_OBJECT": tone.OFF_OBJECT,
    "SLACK": pair.SLACK,
    "RESERVE": pair.RESERVE,
    "UNSEEN": pair.UNSEEN,
}


def _is_known(name: str) -> bool:
    try:
        illuminant(name)
    except InputError:
        return False
    return True


def _side(scene: Scene, look: Look, lamps: Iterable[str]) -> dict[str, Any]:
    """One picture of the pair."""
    lit = {name: scene.placed(lamp=replace(scene.lamp, illuminant=name)) for name in lamps}
    visible = [lobe.s for material in scene.materials for lobe in material.visible_lobes()]
    ambient = ambient_uniforms(scene, look, EXACT)
    side: dict[str, Any] = {
        "shape": {
            "kind": scene.shape.kind,
            "analytic": scene.shape.kind in ANALYTIC,
            "curved": scene.shape.kind in CURVED,
            "half_extent_m": scene.shape.half_extent_m().tolist(),
            "outline_m": None,
            "curvature_per_m": 0.0,
        },
        "lamp": {"y_n": scene.lamp.y_n, "radius_m": scene.lamp.radius_m},
        "ambient": scene.lamp.ambient,
        "further_lamps": [
            {
                "position_m": lamp.position_m.tolist(),
                "radius_m": lamp.radius_m,
                "distance_m": lamp.distance_m,
                "share": share_of(lamp),
            }
            for lamp in lamps_of(scene.setup)
            if isinstance(lamp, FurtherLamp)
        ],
        "look": {
            name: getattr(look, name)
            for name in ("grain", "grain_px", "grain_mm", "grain_arcmin", "seed", "samples")
        },
        "own_sigma_n_deg": [],
        "narrowest_s": min(visible) if visible else None,
        "variants": _variants(scene, look),
        "albedo_rows": packed(ambient["albedo_rows"]) if ambient else None,
    }
    if scene.pack is None:
        side["material"] = uniform_numbers(material_uniforms(scene, look, EXACT))
        side["colours"] = {
            name: uniform_numbers(colour_uniforms(one, EXACT)) for name, one in lit.items()
        }
    if scene.pack is not None or scene.shape.kind not in ANALYTIC:
        side = merged(side, pack_drawing(scene, look, tuple(lamps)))
    return side


def merged(first: Mapping[str, Any], second: Mapping[str, Any]) -> dict[str, Any]:
    """Two nested dictionaries as one; where both hold a value, the second one's counts.

    >>> merged({"a": {"b": 1, "c": 2}}, {"a": {"b": 3}})
    {'a': {'b': 3, 'c': 2}}
    """
    joined = dict(first)
    for name, value in second.items():
        held = joined.get(name)
        nested = isinstance(held, Mapping) and isinstance(value, Mapping)
        joined[name] = merged(cast(Any, held), value) if nested else value
    return joined


def _variants(scene: Scene, look: Look) -> dict[str, Any]:
    """Constants of each stage: smooth or grainy, one sample a pixel or several.

    CAPS and AFAR depend on the view, and are the page's to set.
    """
    variants = {}
    for grain, sigma_n_deg in (("smooth", 0.0), ("grainy", 1.0)):
        for count, samples in (("one", 1), ("several", 2)):
            tried = look.with_entries(sigma_n_deg=sigma_n_deg)
            variant = Variant.of(scene, tried, samples)
            variants[f"{grain} {count}"] = {
                "targets": list(variant.targets),
                "splits": variant.splits,
                "surface": variant.surface,
                "reads_field": variant.reads_field,
                "has_noise": variant.noise != "none",
                "shade": variant.defines(),
                "split": variant.split_defines(),
                "white": variant.white_defines(),
                "shape": variant.shape_defines(),
                "surface_pass": variant.surface_defines(),
                "field": variant.field_defines(),
            }
    return variants


def _display(scene: Scene) -> dict[str, Any]:
    display = scene.display
    uploads = cast(Uploads, None)  # an sRGB display has no table or curve to upload
    return {
        "edges": display.edges,
        "pixel_arcmin": display.pixel_arcmin,
        "uniforms": uniform_numbers(display_uniforms(scene, uploads)),
        "tone": {
            "one": tone_defines(display, "tone.frag", 1),
            "several": tone_defines(display, "tone.frag", 2),
        },
        "edge": tone_defines(display, "edge.frag", 1),
    }
