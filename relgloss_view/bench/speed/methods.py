"""The ways of drawing that the chart compares with the exact one.

A further way is an entry of WAYS: a name, a group, a label, and what builds the Method and the Look
of a scene.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from dataclasses import dataclass

from relgloss_view.picture.method import EXACT, FIRST_PASS, Method
from relgloss_view.picture.model.view import Size
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.quality.planner import advise

#: Scene, its look and the picture's size -> how it is drawn.
Builder = Callable[[Scene, Look, Size], tuple[Method, Look]]

DEFAULT, AUTO, EVERYTHING = "default", "auto", "everything"
#: In the chart's order.
GROUPS = {
    "default": "default: everything exact",
    "auto": "quality auto",
    "diffuse": "diffuse model",
    "lobes": "specular lobes",
    "fresnel": "Fresnel",
    "shadowing": "shadowing G",
    "facets": "facets D",
    "lamp": "lamp",
    "grain": "grain",
    "samples": "samples a pixel",
    "numbers": "numbers",
    "c_max": "c_max",
    "combined": "combinations",
}


@dataclass(frozen=True)
class Way:
    """One way of drawing. `build` gives its method and look for a scene, a look and a size."""

    name: str
    group: str
    label: str
    build: Builder
    grainy: bool = False  #: compared under grain, sigma_N at least scenes.GRAINY_DEG
    own_c: bool = False  #: drawn with the c it finds, for c_max is what differs
    quick: bool = False  #: part of --quick
    charted: bool = True  #: what draws the same as another way would hide it

    def __post_init__(self) -> None:
        if self.group not in GROUPS:
            raise ValueError(f"{self.name}: no group {self.group!r}")


def method(**fields: object) -> Builder:
    """What draws every scene by one method that differs from the exact one in these fields."""
    chosen = dataclasses.replace(EXACT, **fields)  # type: ignore[arg-type]
    return lambda scene, look, size: (chosen, look)


def sampled(samples: int, **fields: object) -> Builder:
    """The same with so many samples along each side of a pixel."""
    chosen = dataclasses.replace(EXACT, **fields)  # type: ignore[arg-type]
    return lambda scene, look, size: (chosen, dataclasses.replace(look, samples=samples))


def planned(scene: Scene, look: Look, size: Size) -> tuple[Method, Look]:
    """What quality auto takes for a scene."""
    return advise(scene, look, size).method, look


def everything(scene: Scene, look: Look, size: Size) -> tuple[Method, Look]:
    """What draws all that a scene may have, whether this one has it or not."""
    forced = {
        "lobes": 2,
        "caps": True,
        "noise": look.noise_law,
        "grain": look.grain,
        "noisy_diffuse": look.noisy_lobes == "both",
        "writes": "xyz",
    }
    return Method(variant=tuple(forced.items())), look


def band_by_band(scene: Scene, look: Look, size: Size) -> tuple[Method, Look]:
    """What sums the spectra in each pixel."""
    return Method(variant=(("bands", scene.material.bands.count),)), look


CHEAPEST = {
    "diffuse": "lambert",
    "lobes": 1,
    "fresnel": "constant",
    "shadowing": "none",
    "facets": "beckmann",
    "noise": "none",
    "lamp": "distant",
    "variant": (("cube_root", "table"),),
}
GAME = {
    "diffuse": "lambert",
    "lobes": 1,
    "fresnel": "schlick",
    "facets": "ggx",
    "lamp": "distant",
}

WAYS: list[Way] = [
    Way(DEFAULT, "default", "default", method(), quick=True),
    Way(AUTO, "auto", "quality auto", planned, quick=True),
    Way(
        EVERYTHING,
        "default",
        "everything, needed or not",
        everything,
        quick=True,
        charted=False,
    ),
    Way("lambert", "diffuse", "Lambert", method(diffuse="lambert"), quick=True),
    Way("qualitative", "diffuse", "qualitative Oren-Nayar", method(diffuse="qualitative")),
    Way("eon", "diffuse", "EON", method(diffuse="eon"), quick=True),
    Way("oren-nayar", "diffuse", "full Oren-Nayar", method(diffuse="oren-nayar"), charted=False),
    Way("lobes-0", "lobes", "no lobe", method(lobes=0), quick=True),
    Way("lobes-1", "lobes", "1 lobe", method(lobes=1), quick=True),
    Way("schlick", "fresnel", "Schlick", method(fresnel="schlick"), quick=True),
    Way("constant-f", "fresnel", "constant F", method(fresnel="constant"), quick=True),
    Way("no-g", "shadowing", "no G", method(shadowing="none"), quick=True),
    Way("beckmann", "facets", "Beckmann", method(facets="beckmann")),
    Way("ggx", "facets", "GGX", method(facets="ggx"), quick=True),
    Way("distant", "lamp", "distant lamp", method(lamp="distant"), quick=True),
    Way("grain-drawn", "grain", "grain on both", method(), grainy=True, charted=False),
    Way("grain-specular", "grain", "grain on lobes only", method(noise="specular"), grainy=True),
    Way("grain-mean", "grain", "mean of the grain", method(noise="mean"), grainy=True, quick=True),
    Way("grain-none", "grain", "no grain", method(noise="none"), grainy=True, quick=True),
    Way("samples-4", "samples", "4 samples", sampled(2), quick=True),
    Way("samples-16", "samples", "16 samples", sampled(4)),
    Way("bands", "numbers", "band by band", band_by_band, quick=True),
    Way("float16", "numbers", "float16", method(targets="float16"), quick=True),
    Way("root-power", "numbers", "root by pow", method(variant=(("cube_root", "power"),))),
    Way("root-table", "numbers", "root by table", method(variant=(("cube_root", "table"),))),
    Way("xyz-twice", "numbers", "XYZ in both targets", method(variant=(("writes", "xyz"),))),
    Way("split-first", "numbers", "split with pass 1", method(split=FIRST_PASS), quick=True),
    Way("gamut-clip", "numbers", "RGB clipped", method(gamut="clip")),
    Way("c-sparse", "c_max", "c_max of every 4th", method(c_max="sparse"), own_c=True),
    Way("c-eq4", "c_max", "c_max by eq. 4", method(c_max="eq4"), own_c=True, quick=True),
    Way("c-once", "c_max", "c_max without grain", method(c_max="once"), own_c=True, grainy=True),
    Way("lean", "combined", "EON, no G", method(diffuse="eon", shadowing="none")),
    Way(
        "leaner",
        "combined",
        "Lambert, 1 lobe, no G",
        method(diffuse="lambert", lobes=1, shadowing="none"),
    ),
    Way("game", "combined", "Lambert, GGX, Schlick, distant", method(**GAME)),
    Way("cheapest", "combined", "cheapest of everything", method(**CHEAPEST), quick=True),
    Way(
        "mean-4", "combined", "mean of the grain, 4 samples", sampled(2, noise="mean"), grainy=True
    ),
]


def ways(*, quick: bool) -> tuple[Way, ...]:
    """The ways that a run draws."""
    return tuple(way for way in WAYS if way.quick or not quick)
