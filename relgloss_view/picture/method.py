"""Method: how much of the model a picture is drawn with. The default draws everything exactly."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

from relgloss_view.base.parameters import Checked, choice, whole_number
from relgloss_view.material.approximations import FRESNEL, SHADOWING

DIFFUSE = ("fitted", "oren-nayar", "eon", "qualitative", "lambert")
FACETS = ("gaussian", "beckmann", "ggx")
NOISE = ("drawn", "specular", "mean", "none")
LAMPS = ("point", "distant")
BANDS = ("folded", "each")
CUBE_ROOTS = ("householder", "power", "table")
TARGETS = ("float32", "float16")
C_MAX = ("exact", "sparse", "eq4", "once")
GAMUTS = ("as asked", "clip")
KEPT = ("split", "all")
ABSENT = ("left out", "drawn")


@dataclass(frozen=True)
class Method(Checked):
    """One choice a stage. What a scene does not have is never drawn, whatever is chosen here."""

    diffuse: str = choice("fitted", DIFFUSE, "the diffuse reflection")
    lobes: int = whole_number(2, 0, 2, "", "specular lobes drawn, the strongest first")
    fresnel: str = choice("exact", FRESNEL, "a facet's reflectance")
    shadowing: str = choice("v-groove", SHADOWING, "of facets by facets")
    facets: str = choice("gaussian", FACETS, "how the facets' angles are distributed")
    noise: str = choice("drawn", NOISE, "the grain: as asked, on lobes only, its mean, or none")
    lamp: str = choice("point", LAMPS, "the lamp at its place, or far off in its direction")
    bands: str = choice("folded", BANDS, "spectra folded into XYZ first, or band by band")
    cube_root: str = choice("householder", CUBE_ROOTS, "of CIELAB")
    targets: str = choice("float32", TARGETS, "numbers between the passes")
    c_max: str = choice(
        "exact", C_MAX, "over all pixels, a quarter of them, eq. 4, or the picture without grain"
    )
    gamut: str = choice("as asked", GAMUTS, "clip, where no colour is out of gamut, costs less")
    absent: str = choice(
        "left out", ABSENT, "what a scene does not have: grain of none, a second lobe, unseen caps"
    )
    kept: str = choice("split", KEPT, "what pass 1 keeps: XYZ too, or only when it is asked for")

    def differences(self) -> dict[str, str | int]:
        """The stages that are not drawn exactly, and how they are."""
        return {
            f.name: getattr(self, f.name)
            for f in dataclasses.fields(self)
            if f.name != "kept" and getattr(self, f.name) != f.default
        }


EXACT = Method()
