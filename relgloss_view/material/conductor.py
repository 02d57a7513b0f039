"""Conductors: what gold, copper and aluminium reflect, and foils that are made of them.

A metal's lobe has the form of Schlick 1994, which needs the reflectance at normal incidence alone.
Here are the numbers that it comes from, and the exact reflectance that it is held against:
docs/light.md has the chart.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from relgloss_view.base.arrays import Array
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.material.material import Diffuse, Lobe, Material
from relgloss_view.measure.bands import Bands

#: Wavelength (nm), n and k. Gold and copper: Johnson and Christy 1972 (Phys. Rev. B 6, 4370);
#: aluminium: Rakic 1995 (Appl. Opt. 34, 4755); both as refractiveindex.info has them (CC0 1.0).
INDICES: dict[str, tuple[tuple[float, float, float], ...]] = {
    "gold": (
        *((367.9, 1.48, 1.895), (381.5, 1.46, 1.933), (397.4, 1.47, 1.952), (413.3, 1.46, 1.958)),
        *((430.5, 1.45, 1.948), (450.9, 1.38, 1.914), (471.4, 1.31, 1.849), (495.9, 1.04, 1.833)),
        *((520.9, 0.62, 2.081), (548.6, 0.43, 2.455), (582.1, 0.29, 2.863), (616.8, 0.21, 3.272)),
        *((659.5, 0.14, 3.697), (704.5, 0.13, 4.103), (756.0, 0.14, 4.542), (821.1, 0.16, 5.083)),
    ),
    "copper": (
        *((367.9, 1.36, 1.975), (381.5, 1.33, 2.045), (397.4, 1.32, 2.116), (413.3, 1.28, 2.207)),
        *((430.5, 1.25, 2.305), (450.9, 1.24, 2.397), (471.4, 1.25, 2.483), (495.9, 1.22, 2.564)),
        *((520.9, 1.18, 2.608), (548.6, 1.02, 2.577), (582.1, 0.70, 2.704), (616.8, 0.30, 3.205)),
        *((659.5, 0.22, 3.747), (704.5, 0.21, 4.205), (756.0, 0.24, 4.665), (821.1, 0.26, 5.180)),
    ),
    "aluminium": (
        *((364.66, 0.39877, 4.3957), (413.28, 0.52135, 5.0008), (442.80, 0.60790, 5.3676)),
        *((476.87, 0.72780, 5.7781), (516.60, 0.87340, 6.2418), (563.57, 1.0728, 6.7839)),
        *((619.93, 1.3660, 7.4052), (652.25, 1.5724, 7.7354), (688.81, 1.8301, 8.0601)),
        *((729.32, 2.1606, 8.3565), (774.91, 2.6154, 8.4914), (794.78, 2.7675, 8.3866)),
    ),
}
#: Bands of the foils below.
FOIL_BANDS = Bands(tuple(float(nm) for nm in range(390, 731, 10)))
#: Invented: a yellow lacquer passes all of the long wavelengths and this share of the short ones,
#: going from one to the other about an edge (nm) of some width (nm). Light passes it twice.
LACQUER_LEAST, LACQUER_EDGE_NM, LACQUER_WIDTH_NM = 0.5, 515.0, 22.0
#: Invented: per-axis sd of a cold foil's facets over board, and the share of it that is foil.
FOIL_S_DEG, FOIL_SHARE = 2.0, 0.9
FOILS = ("silver", "gold")


def index(metal: str, wavelengths_nm: ArrayLike) -> tuple[Array, Array]:
    """n and k of a metal, a key of INDICES, at wavelengths from 380 to 780 nm; (...) each.

    Linear between the entries. Raises InputError for another metal or wavelength.
    """
    if metal not in INDICES:
        raise InputError(f"metal {printable(metal, 60)!r}: expected one of {', '.join(INDICES)}")
    nm, n, k = np.array(INDICES[metal]).T
    asked = np.asarray(wavelengths_nm, dtype=np.float64)
    if not (np.all(asked >= 380.0) and np.all(asked <= 780.0)):
        raise InputError(f"wavelengths of {metal}: expected 380 to 780 nm")
    return np.interp(asked, nm, n), np.interp(asked, nm, k)


def fresnel_conductor(cos_d: ArrayLike, n: ArrayLike, k: ArrayLike) -> Array:
    """Unpolarised reflectance of a conductor of index n + i k in air, 0 to 1.

    cos_d: cosine of the angle between the light and the facet's normal. Fresnel's equations with
    a complex index (Born and Wolf 1999, section 14.2).

    >>> fresnel_conductor([1.0, 0.0], 0.2, 3.4).round(4).tolist()
    [0.9385, 1.0]
    """
    cosine = np.abs(np.asarray(cos_d, dtype=np.float64))
    squared = (np.asarray(n, dtype=np.float64) + 1j * np.asarray(k, dtype=np.float64)) ** 2
    inside = np.sqrt(squared - (1.0 - cosine**2))
    across = (cosine - inside) / (cosine + inside)
    within = (squared * cosine - inside) / (squared * cosine + inside)
    return np.asarray(0.5 * (np.abs(across) ** 2 + np.abs(within) ** 2))


def normal_reflectance(metal: str, wavelengths_nm: ArrayLike) -> Array:
    """Reflectance of a metal at normal incidence, the F0 of its lobe.

    >>> normal_reflectance("gold", [450.0, 650.0]).round(2).tolist()
    [0.41, 0.96]
    """
    return fresnel_conductor(1.0, *index(metal, wavelengths_nm))


def lacquer(wavelengths_nm: ArrayLike) -> Array:
    """Transmittance of the yellow lacquer of a gold foil, passed twice; invented."""
    step = (np.asarray(wavelengths_nm, dtype=np.float64) - LACQUER_EDGE_NM) / LACQUER_WIDTH_NM
    once = LACQUER_LEAST + (1.0 - LACQUER_LEAST) / (1.0 + np.exp(-step))
    return np.asarray(once * once)


def foil_material(name: str) -> Material:
    """A cold foil, 'silver' or 'gold': aluminium, bare or under a yellow lacquer; synthetic.

    Its facets reflect as aluminium does (Rakic 1995); the lacquer and the width of the lobe are
    invented. Raises InputError for another name.

    >>> foil_material("gold").synthetic
    True
    """
    if name not in FOILS:
        raise InputError(f"foil {printable(name, 60)!r}: expected one of {', '.join(FOILS)}")
    nm = np.asarray(FOIL_BANDS.centres_nm())
    f0 = normal_reflectance("aluminium", nm) * (lacquer(nm) if name == "gold" else 1.0)
    lobe = Lobe((FOIL_SHARE,), FOIL_S_DEG, f0=tuple(float(v) for v in np.round(f0, 4)))
    return Material(
        f"cold foil {name}",
        "aluminium (Rakic 1995)"
        + (" under an invented yellow lacquer" if name == "gold" else "")
        + ", invented lobe width",
        FOIL_BANDS,
        Diffuse("lambert", (0.0,) * FOIL_BANDS.count),
        (lobe,),
        synthetic=True,
    )
