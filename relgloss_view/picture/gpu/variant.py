"""Plan: which code a picture needs: no noise where sigma_N is 0, no lobe where there is none."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np

from relgloss_view.material import approximations
from relgloss_view.picture import method
from relgloss_view.picture.model.drawn import drawn_diffuse, drawn_facets, drawn_lobes
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.setup import Display

# The numbers that the shaders know these names by.
SHAPE_CODES = {"cylinder": 0, "sphere": 1, "plane": 2, "box": 3}
DIFFUSE_CODES = {"lambert": 0, "oren-nayar": 1, "eon": 2, "qualitative": 3}
NOISE_CODES = {"none": 0, "paper": 1, "tangent": 2}
GRAIN_CODES = {"screen": 0, "surface": 1}
TRANSFER_CODES = {"srgb": 0, "gain-offset-gamma": 1}
GAMUT_CODES = {"chroma": 0, "clip": 1}

FRESNEL_CODES = {name: k for k, name in enumerate(approximations.FRESNEL)}
SHADOWING_CODES = {name: k for k, name in enumerate(approximations.SHADOWING)}
FACET_CODES = {name: k for k, name in enumerate(approximations.FACETS)}
LAMP_CODES = {name: k for k, name in enumerate(method.LAMPS)}
CUBE_ROOT_CODES = {name: k for k, name in enumerate(method.CUBE_ROOTS)}
PART_CODES = {"split": 0, "xyz": 1, "all": 2}


@dataclass(frozen=True)
class Plan:
    """The variant of pass 1 that a scene and a look need."""

    shape: str
    diffuse: str
    lobes: int
    caps: bool = True  #: of a cylinder, which the eye may see
    noise: str = "none"
    noisy_diffuse: bool = True
    grain: str = "screen"
    sampled: bool = False  #: more than one sample a pixel
    fresnel: str = "exact"
    shadowing: str = "v-groove"
    facets: str = "gaussian"
    lamp: str = "point"
    bands: int = 0  #: drawn one by one; 0 where they are folded into XYZ
    cube_root: str = "householder"
    parts: str = "all"  #: that pass 1 keeps

    @classmethod
    def of(
        cls, scene: Scene, look: Look, samples: int = 1, chosen: method.Method = method.EXACT
    ) -> Plan:
        """The smallest variant that draws this, at so many samples along a pixel's side.

        Exactly, unless the chosen method says otherwise.
        """
        grainy = look.sigma_n_deg > 0.0
        lobes = len(drawn_lobes(scene.material, chosen))
        smooth = cls(
            shape=scene.shape.kind,
            diffuse=drawn_diffuse(scene.material, chosen),
            lobes=lobes,
            caps=_sees_a_cap(scene),
            sampled=samples > 1,
            fresnel=chosen.fresnel if lobes else "exact",
            shadowing=chosen.shadowing if lobes else "v-groove",
            facets=drawn_facets(look, chosen) if lobes else "gaussian",
            lamp=chosen.lamp,
            bands=scene.material.bands.count if chosen.bands == "each" else 0,
            cube_root=chosen.cube_root,
            parts="all" if samples > 1 else chosen.kept,  # XYZ holds the share of a pixel
        )
        if chosen.absent == "drawn":
            smooth = dataclasses.replace(smooth, lobes=2, caps=True, parts="all")
            grainy = True
        if not grainy or chosen.noise in ("mean", "none"):
            return smooth
        return dataclasses.replace(
            smooth,
            noise=look.noise_law,
            noisy_diffuse=look.noisy_lobes == "both" and chosen.noise == "drawn",
            grain=look.grain,
        )

    def defines(self) -> dict[str, int]:
        """The constants of the shader variant."""
        return {
            **self.shape_defines(),
            "DIFFUSE_MODEL": DIFFUSE_CODES[self.diffuse],
            "LOBES": self.lobes,
            "NOISE": NOISE_CODES[self.noise],
            "NOISY_DIFFUSE": int(self.noisy_diffuse),
            "GRAIN": GRAIN_CODES[self.grain],
            "SAMPLED": int(self.sampled),
            "FRESNEL": FRESNEL_CODES[self.fresnel],
            "SHADOWING": SHADOWING_CODES[self.shadowing],
            "FACETS": FACET_CODES[self.facets],
            "LAMP": LAMP_CODES[self.lamp],
            "BANDS": self.bands,
            "CUBE_ROOT": CUBE_ROOT_CODES[self.cube_root],
            "PARTS": PART_CODES[self.parts],
        }

    def shape_defines(self) -> dict[str, int]:
        """The constants of what meets the object."""
        return {"SHAPE": SHAPE_CODES[self.shape], "CAPS": int(self.caps)}

    def white_defines(self) -> dict[str, int]:
        """The constants of the pass that draws the perfect diffuser, for Y_n."""
        return {
            **self.shape_defines(),
            "SAMPLED": int(self.sampled),
            "LAMP": LAMP_CODES[self.lamp],
        }

    def geometry_defines(self) -> dict[str, int]:
        """The constants of the pass that draws normals and points."""
        return {name: self.defines()[name] for name in ("SHAPE", "CAPS", "NOISE", "GRAIN")}


def _sees_a_cap(scene: Scene) -> bool:
    """Whether the eye stands above or below a cylinder; compared as the shader would."""
    eye, half = scene.eye.position_m[1], scene.shape.half_extent_m()[1]
    return scene.shape.kind == "cylinder" and bool(np.float32(abs(eye)) > np.float32(half))


def tone_defines(
    display: Display, stage: str, samples: int = 1, chosen: method.Method = method.EXACT
) -> dict[str, int]:
    """The constants of a stage that shows colours."""
    gamut = display.gamut if chosen.gamut == "as asked" else chosen.gamut
    defines = {"GAMUT": GAMUT_CODES[gamut]}
    if stage != "light.frag":  # which is linear
        defines["TRANSFER"] = TRANSFER_CODES[display.transfer]
    if stage != "overlay.frag":
        defines["SAMPLED"] = int(samples > 1)
    return defines
