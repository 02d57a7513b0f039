"""Which code a picture needs: no noise where sigma_N is 0, no lobe where the material has none."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass

from relgloss_view.picture.scene import Display, Look, Scene
from relgloss_view.picture.view import Size, View

# The numbers that the shaders know these names by.
SHAPE_CODES = {"cylinder": 0, "sphere": 1, "plane": 2, "box": 3}
DIFFUSE_CODES = {"lambert": 0, "oren-nayar": 1, "eon": 2}
NOISE_CODES = {"none": 0, "paper": 1, "tangent": 2}
GRAIN_CODES = {"screen": 0, "surface": 1}
TRANSFER_CODES = {"srgb": 0, "gain-offset-gamma": 1}
GAMUT_CODES = {"chroma": 0, "clip": 1}

MAX_SAMPLES = 16
#: Samples of a Gaussian lobe this many standard deviations apart sum to its energy within
#: 2 exp(-2 pi^2 / 1.5^2) = 0.03 %, and half of it beside the peak still sees 75 % of it.
STEP_SD = 1.5


@dataclass(frozen=True)
class Plan:
    """The variant of pass 1 that a scene and a look need."""

    shape: str
    diffuse: str
    lobes: int
    noise: str = "none"
    noisy_diffuse: bool = True
    grain: str = "screen"
    sampled: bool = False  #: more than one sample a pixel

    @classmethod
    def of(cls, scene: Scene, look: Look, samples: int = 1) -> Plan:
        """The smallest variant that draws this exactly, at so many samples along a pixel's side."""
        diffuse = scene.material.diffuse
        smooth = cls(
            shape=scene.shape.kind,
            diffuse="lambert" if diffuse.sigma_deg == 0.0 else diffuse.model,
            lobes=len(scene.material.visible_lobes()),
            sampled=samples > 1,
        )
        if look.sigma_n_deg == 0.0:
            return smooth
        return dataclasses.replace(
            smooth,
            noise=look.noise_law,
            noisy_diffuse=look.noisy_lobes == "both",
            grain=look.grain,
        )

    @classmethod
    def of_perfect_diffuser(cls, scene: Scene, samples: int = 1) -> Plan:
        """The variant that draws the perfect diffuser in place of the object, for Y_n."""
        return cls(shape=scene.shape.kind, diffuse="lambert", lobes=0, sampled=samples > 1)

    def defines(self) -> dict[str, int]:
        """The constants of the shader variant."""
        return {
            "SHAPE": SHAPE_CODES[self.shape],
            "DIFFUSE_MODEL": DIFFUSE_CODES[self.diffuse],
            "LOBES": self.lobes,
            "NOISE": NOISE_CODES[self.noise],
            "NOISY_DIFFUSE": int(self.noisy_diffuse),
            "GRAIN": GRAIN_CODES[self.grain],
            "SAMPLED": int(self.sampled),
        }

    def geometry_defines(self) -> dict[str, int]:
        """The constants of the pass that draws normals and points."""
        return {name: self.defines()[name] for name in ("SHAPE", "NOISE", "GRAIN")}


def tone_defines(display: Display, stage: str, samples: int = 1) -> dict[str, int]:
    """The constants of a stage that shows colours."""
    defines = {"GAMUT": GAMUT_CODES[display.gamut]}
    if stage != "light.frag":  # which is linear
        defines["TRANSFER"] = TRANSFER_CODES[display.transfer]
    if stage == "tone.frag":
        defines["SAMPLED"] = int(samples > 1)
    return defines


def as_drawn(scene: Scene, look: Look) -> Scene:
    """The scene with the diffuse model that the look forces, if it forces one."""
    diffuse = scene.material.diffuse
    if look.diffuse_model in ("fitted", diffuse.model):
        return scene
    material = dataclasses.replace(
        scene.material, diffuse=dataclasses.replace(diffuse, model=look.diffuse_model)
    )
    return dataclasses.replace(scene, material=material)


def sample_count(scene: Scene, look: Look, size: Size) -> int:
    """Samples along each side of a pixel: those asked for, or what the narrowest lobe needs."""
    return samples_needed(scene, size) if look.samples is None else look.samples


def samples_needed(scene: Scene, size: Size) -> int:
    """Samples along each side of a pixel that keep the energy of the narrowest lobe.

    From one pixel to the next the half-vector turns against the normal by the surface's curvature
    and by the change of both directions. Taken at the highlight, where the normal stands halfway
    between eye and lamp.
    """
    lobes = scene.material.visible_lobes()
    if not lobes:
        return 1
    eye, lamp = scene.eye.distance_m, scene.lamp.distance_m
    half = scene.shape.half_extent_m()
    curved = scene.shape.kind in ("cylinder", "sphere")
    depth = max(eye - float(half[0] if curved else half[2]), 1e-3 * eye)
    footprint_m = View.of(scene, size).pixel_step * depth
    turn = 0.5 * footprint_m * (1.0 / depth + 1.0 / lamp)
    if curved:
        cosine = float(scene.eye.position_m @ scene.lamp.position_m) / (eye * lamp)
        cos_half = math.sqrt(max(0.5 * (1.0 + cosine), 0.01))
        turn += footprint_m / (float(half[0]) * cos_half)
    needed = turn / (STEP_SD * min(lobe.s for lobe in lobes))
    return max(1, min(MAX_SAMPLES, math.ceil(needed)))
