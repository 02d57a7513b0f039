"""Random sound samples: coated and uncoated papers with inks, each on an instrument."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.bench.verdicts import instrument
from relgloss_view.bench.verdicts.instrument import Grid
from relgloss_view.bench.verdicts.reflection import Body, Highlight, Surface, TrueSample

S_RANGE_DEG = (0.4, 20.0)
STRENGTH_RANGE = (0.3, 1.2)
INDEX_RANGE = (1.4, 1.6)
APERTURE_RANGE_DEG = (0.2, 0.6)
SIGMA_MAX = 0.3
BAND_COUNTS = (5, 7, 16, 31, 35)
#: Cauchy's second constant of printing varnishes, micrometres squared.
DISPERSION = 0.004
#: Ink -> reflectance in blue, green and red, joined smoothly: invented, of the usual sizes.
INKS = {
    "paper": (0.82, 0.85, 0.86),
    "cyan": (0.5, 0.3, 0.05),
    "magenta": (0.25, 0.06, 0.7),
    "yellow": (0.06, 0.65, 0.8),
    "black": (0.03, 0.03, 0.03),
    "green": (0.08, 0.3, 0.06),
    "gray": (0.35, 0.36, 0.37),
    "red": (0.05, 0.06, 0.6),
}

GridMaker = Callable[[np.random.Generator, float], Grid]


@dataclass(frozen=True)
class Setting:
    """A sample on an instrument, as both really are."""

    sample: TrueSample
    grid: Grid
    aperture_sd_deg: tuple[float, float]
    ink: str


def spectrum(levels: Sequence[float], wavelengths_nm: Array) -> Array:
    """A smooth reflectance (B,) with given levels in blue, green and red."""
    to_green = 1.0 / (1.0 + np.exp(-(wavelengths_nm - 490.0) / 12.0))
    to_red = 1.0 / (1.0 + np.exp(-(wavelengths_nm - 590.0) / 12.0))
    blue, green, red = levels
    return np.asarray(blue + (green - blue) * to_green + (red - green) * to_red)


def dielectric(index: float, wavelengths_nm: Array) -> Surface:
    """An interface of an index at 550 nm, with Cauchy's dispersion n = A + B / lambda^2."""
    micrometres = wavelengths_nm / 1000.0
    return Surface(index + DISPERSION * (micrometres**-2 - 0.55**-2))


def draw(
    rng: np.random.Generator,
    grids: Sequence[GridMaker] = instrument.GRIDS,
    s_range_deg: tuple[float, float] = S_RANGE_DEG,
    *,
    strict: bool = True,
) -> Setting:
    """A sound sample on a grid that resolves its highlight.

    grids: those to choose from. strict: the main lobe is at least as wide as the grid resolves;
    else any width of the range is taken.
    """
    maker = grids[int(rng.integers(len(grids)))]
    pair = (float(rng.uniform(*APERTURE_RANGE_DEG)), float(rng.uniform(*APERTURE_RANGE_DEG)))
    low, high = np.log(s_range_deg)
    share = float(rng.uniform())
    grid = maker(rng, float(np.exp(low + share * (high - low))))
    if strict:
        low = max(low, float(np.log(min(grid.finest_s_deg, s_range_deg[1]))))
    s_deg = float(np.exp(low + share * (high - low)))
    if maker is instrument.half_vector_grid:
        grid = maker(rng, s_deg)
    bands = np.round(np.linspace(400.0, 700.0, int(rng.choice(BAND_COUNTS))), 1)
    ink = str(rng.choice(list(INKS)))
    levels = [float(np.clip(x * rng.uniform(0.85, 1.1), 0.02, 0.92)) for x in INKS[ink]]
    surface = dielectric(float(rng.uniform(*INDEX_RANGE)), bands)
    strength = float(np.exp(rng.uniform(*np.log(STRENGTH_RANGE))))
    main = Highlight(
        str(rng.choice(["gaussian", "beckmann"])), s_deg, np.full(len(bands), strength), surface
    )
    lobes = [main]
    if rng.uniform() < 0.6:
        broad = min(s_deg * float(rng.uniform(2.5, 6.0)), 28.0)
        weak = np.full(len(bands), strength * float(rng.uniform(0.02, 0.12)))
        shape = str(rng.choice(["ggx", "beckmann"]))
        lobes.append(Highlight(shape, broad, weak, surface, smith=True))
    body = Body(spectrum(levels, bands), float(rng.uniform(0.0, SIGMA_MAX)))
    return Setting(TrueSample(bands, body, tuple(lobes)), grid, pair, ink)
