"""Look: what is tuned by eye, with its ranges."""

from __future__ import annotations

from dataclasses import dataclass

from relgloss_view.base.errors import InputError
from relgloss_view.base.parameters import Checked, choice, parameter, whole_number
from relgloss_view.material.material import DIFFUSE_MODELS

GRAINS = ("screen", "surface")
NOISE_LAWS = ("paper", "tangent")
QUALITIES = ("exact", "auto")
NOISY_LOBES = ("both", "specular")


@dataclass(frozen=True)
class Look(Checked):
    """What is tuned by eye: graininess sigma_N and the scaling c of the specular L*.

    c is given either as a value or as a fraction of the exact c_max; both None means c_max.
    """

    sigma_n_deg: float = parameter(
        0.0, 0.0, 10.0, "deg", "graininess: standard deviation of the tilt of the surface normal"
    )
    c: float | None = parameter(
        None, 0.0, 1e4, "", "contrast gloss: scales the specular part of L*"
    )
    c_fraction: float | None = parameter(
        None, 0.0, 10.0, "", "contrast gloss as a share of c_max, the most that the display shows"
    )
    grain: str = choice("screen", GRAINS, "what a grain is fixed to")
    grain_px: int = whole_number(1, 1, 1024, "px", "side of a screen grain")
    grain_mm: float = parameter(0.2, 0.001, 100.0, "mm", "side of a surface grain")
    noise_law: str = choice("paper", NOISE_LAWS, "distribution of the tilt")
    noisy_lobes: str = choice("both", NOISY_LOBES, "which reflections see the tilt")
    seed: int = whole_number(0, 0, 2**31 - 1, "", "of the grain")
    #: None takes as many as the narrowest lobe needs. One samples the pixel's centre, so that
    #: each number of a picture can be computed again from the point and normal that go with it.
    samples: int | None = whole_number(
        1, 1, 16, "", "samples along each side of a pixel", optional=True
    )
    diffuse_model: str = choice("fitted", ("fitted", *DIFFUSE_MODELS), "draws the diffuse part")
    quality: str = choice("exact", QUALITIES, "draws the whole model, or what this scene needs")

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.c is not None and self.c_fraction is not None:
            raise InputError("look: give c or c_fraction, not both")
