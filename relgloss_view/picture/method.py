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
TARGETS = ("float32", "float16")
C_MAX = ("exact", "sparse", "eq4", "once")
GAMUTS = ("as asked", "clip")
SECOND_PASS, FIRST_PASS = "second pass", "first pass"
SPLITS = (SECOND_PASS, FIRST_PASS)


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
    targets: str = choice("float32", TARGETS, "numbers of the split between the passes")
    c_max: str = choice(
        "exact", C_MAX, "over all pixels, a quarter of them, eq. 4, or the picture without grain"
    )
    gamut: str = choice("as asked", GAMUTS, "clip, where no colour is out of gamut, costs less")
    split: str = choice(
        SECOND_PASS, SPLITS, "where L* is split; both draw the same within float32's rounding"
    )
    #: Entries of the shader variant that take the place of those the picture needs: the bench
    #: charts what they cost.
    variant: tuple[tuple[str, object], ...] = ()

    def differences(self) -> dict[str, str | int]:
        """The stages that are not drawn exactly, and how they are drawn."""
        return {
            f.name: getattr(self, f.name)
            for f in dataclasses.fields(self)
            if f.name not in ("split", "variant") and getattr(self, f.name) != f.default
        }


EXACT = Method()
