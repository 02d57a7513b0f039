"""Materials that tests draw: plausible papers with known numbers, no fit between."""

from __future__ import annotations

import numpy as np

from relgloss_view.material.material import Diffuse, Lobe, Material
from relgloss_view.measure.bands import Bands

WAVELENGTHS_NM = tuple(float(w) for w in range(390, 731, 10))
#: s_deg, strength, Oren-Nayar sigma (rad): the ranges of printing papers, glossy to uncoated.
PAPERS = {
    "cast": (0.7, 1.0, 0.05),
    "art": (2.5, 1.0, 0.05),
    "matte": (6.0, 1.0, 0.1),
    "uncoated": (15.0, 0.9, 0.2),
}


def green_albedo() -> tuple[float, ...]:
    """A green solid, one peak at 525 nm."""
    wavelengths = np.array(WAVELENGTHS_NM)
    return tuple(0.06 + 0.30 * np.exp(-(((wavelengths - 525.0) / 45.0) ** 2)))


def paper(name: str, model: str = "oren-nayar") -> Material:
    """A synthetic paper with a main and a weak broad lobe."""
    s_deg, strength, sigma = PAPERS[name]
    return Material(
        name,
        "synthetic",
        Bands(WAVELENGTHS_NM),
        Diffuse(model, green_albedo(), float(np.degrees(sigma))),
        (Lobe((strength,), s_deg), Lobe((0.05,), min(3.0 * s_deg, 30.0))),
        synthetic=True,
    )


def flat(albedo: float = 0.5, lobes: tuple[Lobe, ...] = ()) -> Material:
    """A gray Lambert material."""
    bands = Bands(WAVELENGTHS_NM)
    diffuse = Diffuse("lambert", (albedo,) * bands.count)
    return Material("flat", "synthetic", bands, diffuse, lobes, synthetic=True)
