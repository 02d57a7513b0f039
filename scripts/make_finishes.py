"""Make the built-in finishes of packs: assets/finishes/*.json. Invented surfaces, none measured.

The gloss of each lies in the range that makers of varnishes, foils and boards publish
(docs/packs.md, "Built-in finishes"). The width of each main lobe is found with the project's own
gloss meter, so that the finish reads the stated gloss units at the stated angle.

    python scripts/make_finishes.py

It draws no random number: the same program gives the same files, byte for byte.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from relgloss_view.gloss.meter.meter import lobe_width_for
from relgloss_view.material.conductor import foil_material
from relgloss_view.material.files import save_material
from relgloss_view.material.material import Diffuse, Lobe, Material
from relgloss_view.measure.bands import Bands

Array = NDArray[np.float64]

FOLDER = Path(__file__).resolve().parents[1] / "assets" / "finishes"
SOURCE = "synthetic (relgloss scripts/make_finishes.py), invented within published ranges"
WAVELENGTHS_NM = np.arange(390.0, 731.0, 10.0)


def sigmoid(x: Array) -> Array:
    """Logistic step from 0 to 1."""
    return np.asarray(1.0 / (1.0 + np.exp(-x)))


def white(level: float, yellowness: float = 0.06) -> Array:
    """A white surface that absorbs a little in the blue."""
    return np.asarray(level * (1.0 - yellowness * sigmoid((450.0 - WAVELENGTHS_NM) / 22.0)))


def kraft() -> Array:
    """Unbleached board: lignin absorbs ever more towards the blue."""
    return np.asarray(0.10 + 0.42 * sigmoid((WAVELENGTHS_NM - 585.0) / 58.0))


def foil_f0(name: str) -> Array:
    """Reflectance at normal incidence of a foil: aluminium (Rakic 1995), bare or lacquered."""
    (lobe,) = foil_material(name).specular
    return np.asarray(lobe.f0)


@dataclass(frozen=True)
class Invented:
    """One finish. The main lobe's width follows from its gloss."""

    slug: str
    name: str
    albedo: Array
    sigma_deg: float  #: of the diffuse part, Oren-Nayar
    angle_deg: float
    gloss: float  #: gloss units at that angle
    strength: float
    index: float = 1.5
    f0: Array | None = None  #: of a metal
    #: (strength, s_deg) of a broad second lobe; of a foil: its grain under a press
    broad: tuple[float, float] | None = None


INVENTED = (
    Invented("gloss-varnish", "gloss varnish", white(0.82), 5.0, 60.0, 85.0, 1.0),
    Invented("satin-varnish", "satin varnish", white(0.82), 8.0, 60.0, 38.0, 1.0),
    Invented("matt-varnish", "matt varnish", white(0.82), 12.0, 60.0, 10.0, 1.0),
    Invented("soft-touch", "soft-touch varnish", white(0.82), 18.0, 60.0, 3.0, 0.9, 1.48),
    Invented(
        "cold-foil-silver", "cold foil, silver", np.full(35, 0.02), 0.0,
        20.0, 700.0, 0.86, f0=foil_f0("silver"), broad=(0.10, 6.0),
    ),
    Invented(
        "cold-foil-gold", "cold foil, gold", np.full(35, 0.02), 0.0,
        20.0, 520.0, 0.86, f0=foil_f0("gold"), broad=(0.10, 6.0),
    ),
    Invented("bare-board", "bare board, coated", white(0.80, 0.08), 12.0, 75.0, 38.0, 0.9),
    Invented("uncoated-label", "uncoated label paper", white(0.84, 0.04), 18.0, 75.0, 8.0, 0.8),
    Invented("kraft", "kraft board", kraft(), 22.0, 75.0, 5.0, 0.7, 1.48),
)  # fmt: skip


def material_of(invented: Invented) -> Material:
    """The material of one finish."""
    bands = Bands(tuple(WAVELENGTHS_NM.tolist()))
    model = "oren-nayar" if invented.sigma_deg > 0.0 else "lambert"
    diffuse = Diffuse(model, tuple(np.round(invented.albedo, 5).tolist()), invented.sigma_deg)
    f0 = None if invented.f0 is None else tuple(np.round(invented.f0, 5).tolist())
    lobes = [Lobe((invented.strength,), 2.0, invented.index, f0)]
    if invented.broad is not None:
        strength, s_deg = invented.broad
        lobes.append(Lobe((strength,), s_deg, invented.index, f0))
    material = Material(invented.name, SOURCE, bands, diffuse, tuple(lobes), synthetic=True)
    width = lobe_width_for(material, invented.angle_deg, invented.gloss)
    lobes[0] = dataclasses.replace(lobes[0], s_deg=round(width, 3))
    return dataclasses.replace(material, specular=tuple(lobes))


def main() -> None:
    FOLDER.mkdir(parents=True, exist_ok=True)
    for invented in INVENTED:
        material = material_of(invented)
        save_material(material, FOLDER / f"{invented.slug}.json")
        widths = ", ".join(f"{lobe.s_deg:g}" for lobe in material.specular)
        print(f"{invented.slug}: s = {widths} degrees")


if __name__ == "__main__":
    main()
