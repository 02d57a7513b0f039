"""Which code a picture needs: no noise where sigma_N is 0, no lobe where the material has none."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

from relgloss_view.picture.scene import Look, Scene

# The numbers that the shaders know these names by.
SHAPE_CODES = {"cylinder": 0, "sphere": 1, "plane": 2, "box": 3}
DIFFUSE_CODES = {"lambert": 0, "oren-nayar": 1, "eon": 2}
NOISE_CODES = {"none": 0, "paper": 1, "tangent": 2}
GRAIN_CODES = {"screen": 0, "surface": 1}
TRANSFER_CODES = {"srgb": 0, "gain-offset-gamma": 1}


@dataclass(frozen=True)
class Plan:
    """The variant of pass 1 that a scene and a look need."""

    shape: str
    diffuse: str
    lobes: int
    noise: str = "none"
    noisy_diffuse: bool = True
    grain: str = "screen"
    samples: int = 1

    @classmethod
    def of(cls, scene: Scene, look: Look) -> Plan:
        """The smallest variant that draws this exactly."""
        diffuse = scene.material.diffuse
        smooth = cls(
            shape=scene.shape.kind,
            diffuse="lambert" if diffuse.sigma_deg == 0.0 else diffuse.model,
            lobes=len(scene.material.visible_lobes()),
            samples=look.samples,
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
    def of_perfect_diffuser(cls, scene: Scene, look: Look) -> Plan:
        """The variant that draws the perfect diffuser in place of the object, for Y_n."""
        return cls(shape=scene.shape.kind, diffuse="lambert", lobes=0, samples=look.samples)

    def defines(self) -> dict[str, int]:
        """The constants of the shader variant."""
        return {
            "SHAPE": SHAPE_CODES[self.shape],
            "DIFFUSE_MODEL": DIFFUSE_CODES[self.diffuse],
            "LOBES": self.lobes,
            "NOISE": NOISE_CODES[self.noise],
            "NOISY_DIFFUSE": int(self.noisy_diffuse),
            "GRAIN": GRAIN_CODES[self.grain],
            "SAMPLES": self.samples,
        }
