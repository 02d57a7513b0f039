"""The built-in samples, and the settings that the paper's observers chose for theirs."""

from __future__ import annotations

from dataclasses import dataclass

from relgloss_view.base.errors import InputError
from relgloss_view.base.resources import asset
from relgloss_view.material.files import load_material
from relgloss_view.material.material import Material
from relgloss_view.picture.scene.look import Look


@dataclass(frozen=True)
class Matched:
    """A published optimum of the subjective evaluation (Ishii et al., "Results")."""

    sigma_n_deg: float
    c_fraction: float

    def look(self) -> Look:
        """The look with these settings."""
        return Look(sigma_n_deg=self.sigma_n_deg, c_fraction=self.c_fraction)


#: In order of gloss. The first is the paper's reference, by its own choice at sigma_N 0 and c_max.
SAMPLES = {
    "cast-coated": Matched(0.0, 6 / 6),
    "art-coated": Matched(0.0, 5 / 6),
    "matte-coated": Matched(2.0, 2 / 6),
    "uncoated": Matched(2.0, 1 / 6),
}
DEFAULT_SAMPLE = "matte-coated"


def load_sample(name: str) -> Material:
    """The fitted material of a built-in (synthetic) sample paper."""
    if name not in SAMPLES:
        raise InputError(f"sample {name!r}: expected one of {', '.join(SAMPLES)}")
    return load_material(asset("materials", f"{name}.json"))
