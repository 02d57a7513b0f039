"""What a reading at 85 degrees shows: facets alone, or more.

Seen near grazing, roughness is small against the wavelength: its path differences are in proportion
to the cosine of the incidence (Rayleigh's criterion; Beckmann and Spizzichino 1963), so many
surfaces mirror there as smoother ones do. A lobe of facets has no such effect. How smooth a surface
becomes depends on heights that no gloss meter reports, so a reading at 85 degrees lies anywhere
from what the facets give to what a smooth surface of the same index gives.

It is common: the Master Painters Institute's level 4 asks for 20 to 35 units at 60 degrees and 35
or more at 85, and of its eggshell latexes most read below 5 at 60 degrees and nearly all above 10
at 85 (Wendt 2003, PaintPRO 5(5)); facets give 21 to 35, and at most 7.
"""

from __future__ import annotations

import math

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.gloss.meter.geometry import SPECULAR
from relgloss_view.material import brdf

GRAZING_DEG = 85.0
#: What is believed before the reading: in a quarter of the prints facets alone; else anything from
#: there up to a smooth surface.
FACETS_ALONE = 0.25
#: From this probability on a reading is taken to hold more than facets give.
CLEARLY = 0.9
NEAR_SMOOTH = 0.05  #: errors; a range from facets to smooth that is narrower counts as this wide


def smooth_units(index: Array) -> Array:
    """The reading (N,) of smooth surfaces at 85 degrees, gloss units (Fresnel; ISO 2813)."""
    meter = SPECULAR[round(GRAZING_DEG)]
    cos = math.cos(math.radians(GRAZING_DEG))
    glass = float(brdf.fresnel_dielectric(cos, meter.glass))
    return np.asarray(100.0 / glass * brdf.fresnel_dielectric(cos, index))


def parts(value: float, error: float, facets: Array, smooth: Array) -> tuple[Array, Array]:
    """The likelihood (N,) of a reading by facets alone, and by surfaces that mirror more.

    value, error: of the reading. facets, smooth: what facets and smooth surfaces read. Both parts
    carry what is believed beforehand, and are shares of the largest likelihood of a Gaussian.
    """
    from scipy.special import ndtr

    low = (value - facets) / error
    width = np.maximum((smooth - facets) / error, NEAR_SMOOTH)
    alone = FACETS_ALONE * np.exp(-0.5 * low * low)
    # An even density from facets to smooth, blurred by the reading's error; of the two equal
    # differences the one of small numbers.
    high = low - width
    inside = np.where(high > 0.0, ndtr(-high) - ndtr(-low), ndtr(low) - ndtr(high))
    more = math.sqrt(2.0 * math.pi) * inside / width
    return alone, (1.0 - FACETS_ALONE) * more


def beyond(value: float, error: float, facets: Array, smooth: Array) -> Array:
    """How far (N,) a reading lies outside the range from facets to smooth, in errors."""
    above = np.maximum(value - np.maximum(smooth, facets), 0.0)
    return np.asarray((above - np.maximum(facets - value, 0.0)) / error)
