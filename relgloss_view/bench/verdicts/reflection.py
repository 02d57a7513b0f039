"""Samples whose reflection is known: facets of several shapes, interfaces of several kinds, bodies.

Written from the sources, without relgloss_view.material.brdf and without the fit's code, so that a
mistake there can't hide here. Directions are unit vectors (..., 3) away from the sample, in the
sample's frame (normal +z). Angles are radians unless their names end in _deg.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from relgloss_view.base.arrays import Array

#: Johnson and Christy 1972, Phys. Rev. B 6, 4370: wavelength in nm, then n and k of gold and
#: of copper, as the refractiveindex.info database lists them (CC0).
NOBLE_METALS = np.array(
    [
        (397.4, 1.47, 1.952, 1.32, 2.116),
        (413.3, 1.46, 1.958, 1.28, 2.207),
        (430.5, 1.45, 1.948, 1.25, 2.305),
        (450.9, 1.38, 1.914, 1.24, 2.397),
        (471.4, 1.31, 1.849, 1.25, 2.483),
        (495.9, 1.04, 1.833, 1.22, 2.564),
        (520.9, 0.62, 2.081, 1.18, 2.608),
        (548.6, 0.43, 2.455, 1.02, 2.577),
        (582.1, 0.29, 2.863, 0.70, 2.704),
        (616.8, 0.21, 3.272, 0.30, 3.205),
        (659.5, 0.14, 3.697, 0.22, 3.747),
        (704.5, 0.13, 4.103, 0.21, 4.205),
        (756.0, 0.14, 4.542, 0.24, 4.665),
    ]
)
SMALLEST = 1e-12
SHAPES = ("gaussian", "beckmann", "ggx", "anisotropic")


def metal_index(metal: str, wavelengths_nm: Array) -> Array:
    """Complex index n + ik of 'gold' or 'copper' at wavelengths (B,), nm, between the table's."""
    first = {"gold": 1, "copper": 3}[metal]
    table = NOBLE_METALS[:, 0], NOBLE_METALS[:, first], NOBLE_METALS[:, first + 1]
    n, k = (np.interp(wavelengths_nm, table[0], column) for column in table[1:])
    return np.asarray(n + 1j * k)


def interface(cos_in: Array, index: Array, outside: float = 1.0) -> tuple[Array, Array]:
    """Complex amplitudes r_s, r_p of an interface (Fresnel; Born and Wolf 1999, sec. 1.5 and 14.2).

    cos_in: cosine outside. index: of the inside, real or complex; `outside`: real.

    >>> r_s, _ = interface(np.array(1.0), np.array(1.5))
    >>> round(float(abs(r_s) ** 2), 6)
    0.04
    """
    ratio = (index / outside) ** 2
    inner = np.sqrt(ratio - (1.0 - cos_in**2) + 0j)
    return (cos_in - inner) / (cos_in + inner), (ratio * cos_in - inner) / (ratio * cos_in + inner)


@dataclass(frozen=True)
class Surface:
    """A facet's reflectance in each band: a dielectric or a metal, under a thin film or not."""

    index: Array  #: (B,), real or complex
    film_index: float = 1.0
    film_nm: float = 0.0  #: thickness; 0 for none
    wavelengths_nm: Array | None = None  #: (B,), needed with a film

    def reflectance(self, cos_in: Array, band: int | None = None) -> Array:
        """Unpolarised reflectance, (..., B), or (...,) of one band; 0 to 1.

        A film interferes after Airy's sum (Born and Wolf 1999, sec. 7.6).
        """
        bands = slice(None) if band is None else band
        index = self.index[bands]
        c = np.clip(cos_in if band is not None else cos_in[..., None], SMALLEST, 1.0)
        if self.film_nm <= 0.0:
            r_s, r_p = interface(c, index)
            return np.asarray(0.5 * (np.abs(r_s) ** 2 + np.abs(r_p) ** 2))
        assert self.wavelengths_nm is not None
        inside = np.sqrt(1.0 - (1.0 - c**2) / self.film_index**2)
        phase = 2.0 * np.pi * self.film_index * self.film_nm * inside / self.wavelengths_nm[bands]
        turn = np.exp(2j * phase)
        tops = interface(c, np.asarray(self.film_index))
        bottoms = interface(inside, index, self.film_index)
        both = [(t + b * turn) / (1.0 + t * b * turn) for t, b in zip(tops, bottoms, strict=True)]
        return np.asarray(0.5 * sum(np.abs(r) ** 2 for r in both))


@lru_cache(maxsize=512)
def gaussian_peak(s: float) -> float:
    """Peak of exp(-delta^2 / 2 s^2) per solid angle whose projected area is one."""
    delta = np.linspace(0.0, min(0.5 * np.pi, 12.0 * s), 20001)
    integrand = np.exp(-0.5 * (delta / s) ** 2) * np.cos(delta) * np.sin(delta)
    return float(1.0 / (2.0 * np.pi * np.trapezoid(integrand, delta)))


def facets(h: Array, shape: str, s: float, ratio: float = 1.0, azimuth: float = 0.0) -> Array:
    """Facets per solid angle, 1/sr, of half-vectors h (..., 3); projected area one.

    shape: 'gaussian' in the facet's angle (Torrance, Sparrow 1967); 'beckmann', Gaussian in slopes,
    and 'ggx' with its long tails (Walter et al. 2007), both of width alpha = sqrt(2) s; or
    'anisotropic': Gaussian slopes of deviations s sqrt(ratio) along the azimuth and s / sqrt(ratio)
    across it (Ward 1992).
    """
    cosine = np.clip(h[..., 2], SMALLEST, 1.0)
    sine = np.hypot(h[..., 0], h[..., 1])
    if shape == "gaussian":
        delta = np.arctan2(sine, cosine)
        return np.asarray(gaussian_peak(s) * np.exp(-np.minimum(0.5 * (delta / s) ** 2, 300.0)))
    tangent2, alpha2 = (sine / cosine) ** 2, 2.0 * s * s
    if shape == "ggx":
        return np.asarray(alpha2 / (np.pi * cosine**4 * (alpha2 + tangent2) ** 2))
    if shape == "anisotropic":
        along = (h[..., 0] * np.cos(azimuth) + h[..., 1] * np.sin(azimuth)) / cosine
        across = (h[..., 1] * np.cos(azimuth) - h[..., 0] * np.sin(azimuth)) / cosine
        tangent2 = along**2 / ratio + across**2 * ratio
    exponent = np.minimum(tangent2 / alpha2, 300.0)
    return np.asarray(np.exp(-exponent) / (np.pi * alpha2 * cosine**4))


def smith(cosine: Array, shape: str, s: float) -> Array:
    """Share of facets that a direction sees (Smith 1967; forms of Walter et al. 2007)."""
    c = np.clip(cosine, SMALLEST, 1.0)
    tangent = np.maximum(np.sqrt(1.0 - c**2) / c, SMALLEST)
    alpha = np.sqrt(2.0) * s
    if shape == "ggx":
        return np.asarray(2.0 / (1.0 + np.sqrt(1.0 + (alpha * tangent) ** 2)))
    a = 1.0 / (alpha * tangent)
    rational = (3.535 * a + 2.181 * a * a) / (1.0 + 2.276 * a + 2.577 * a * a)
    return np.asarray(np.where(a < 1.6, rational, 1.0))


def grooves(h: Array, i: Array, o: Array, cos_d: Array) -> Array:
    """Shadowing of V-grooves (Torrance, Sparrow 1967; form of Cook, Torrance 1982)."""
    lowest = np.minimum(i[..., 2], o[..., 2])
    return np.asarray(np.minimum(1.0, 2.0 * h[..., 2] * lowest / np.maximum(cos_d, SMALLEST)))


@dataclass(frozen=True)
class Highlight:
    """A lobe of facets with an interface."""

    shape: str
    s_deg: float  #: per-axis deviation; geometric mean of both where anisotropic
    strength: Array  #: (B,)
    surface: Surface
    ratio: float = 1.0  #: of the deviations along and across `azimuth_deg`
    azimuth_deg: float = 0.0
    smith: bool = False  #: shadowing after Smith 1967; else V-grooves

    @property
    def _middle(self) -> int:
        return len(self.strength) // 2

    def mean(self, i: Array, o: Array) -> Array:
        """BRDF in 1/sr, (...,), of unit strength in the middle band."""
        mirror, cos_d = self.without_fresnel(i, o)
        return np.asarray(mirror * self.surface.reflectance(cos_d, self._middle))

    def without_fresnel(self, i: Array, o: Array) -> tuple[Array, Array]:
        """BRDF in 1/sr, (...,), of facets that reflect all; and the cosine at which they do."""
        total = i + o
        length = np.maximum(np.linalg.norm(total, axis=-1), SMALLEST)
        h, cos_d = total / length[..., None], 0.5 * length
        s = float(np.radians(self.s_deg))
        d = facets(h, self.shape, s, self.ratio, float(np.radians(self.azimuth_deg)))
        if self.smith:
            g = smith(i[..., 2], self.shape, s) * smith(o[..., 2], self.shape, s)
        else:
            g = grooves(h, i, o, cos_d)
        above = (i[..., 2] > 0.0) & (o[..., 2] > 0.0)
        below = 4.0 * np.maximum(i[..., 2] * o[..., 2], SMALLEST)
        return np.where(above, d * g / below, 0.0), cos_d

    def colour(self, i: Array, o: Array) -> Array:
        """What `mean` has to be multiplied with in each band, (..., B)."""
        cos_d = 0.5 * np.linalg.norm(i + o, axis=-1)
        middle = np.maximum(self.surface.reflectance(cos_d, self._middle), SMALLEST)
        return np.asarray(self.strength * self.surface.reflectance(cos_d) / middle[..., None])


@dataclass(frozen=True)
class Body:
    """What comes back from below the interface."""

    albedo: Array  #: (B,)
    sigma: float = 0.0  #: slope angle's deviation, radians (Oren, Nayar 1995)
    through_index: float = 1.0  #: above 1: light passes an interface of this index both ways

    def mean(self, i: Array, o: Array) -> tuple[Array, Array]:
        """The full model of Oren and Nayar 1995, 1/sr: the parts for rho and for rho squared.

        Through an interface both are multiplied with the transmittances of both directions, which
        darkens grazing angles (Ashikhmin, Shirley 2000 call for the same), 1 at normal incidence.
        """
        theta_i, theta_o = (np.arccos(np.clip(d[..., 2], -1.0, 1.0)) for d in (i, o))
        phi = np.arctan2(i[..., 1], i[..., 0]) - np.arctan2(o[..., 1], o[..., 0])
        cos_phi = np.cos(phi)
        a, b = np.maximum(theta_i, theta_o), np.minimum(theta_i, theta_o)
        s2 = self.sigma**2
        c1 = 1.0 - 0.5 * s2 / (s2 + 0.33)
        k = s2 / (s2 + 0.09)
        c2 = 0.45 * k * (np.sin(a) - np.where(cos_phi >= 0.0, 0.0, (2.0 * b / np.pi) ** 3))
        c3 = 0.125 * k * (4.0 * a * b / np.pi**2) ** 2
        grazing = 0.5 * np.pi - 1e-6
        tan_b, tan_mean = np.tan(np.minimum(b, grazing)), np.tan(np.minimum(0.5 * (a + b), grazing))
        first = (c1 + cos_phi * c2 * tan_b + (1.0 - np.abs(cos_phi)) * c3 * tan_mean) / np.pi
        second = 0.17 * s2 / (s2 + 0.13) * (1.0 - cos_phi * (2.0 * b / np.pi) ** 2) / np.pi
        above = (i[..., 2] > 0.0) & (o[..., 2] > 0.0)
        passed = above * np.ones_like(first)
        if self.through_index > 1.0:
            index = np.asarray(self.through_index)
            normal = 1.0 - ((self.through_index - 1.0) / (self.through_index + 1.0)) ** 2
            for direction in (i, o):
                r_s, r_p = interface(np.clip(direction[..., 2], SMALLEST, 1.0), index)
                lost = 0.5 * (np.abs(r_s) ** 2 + np.abs(r_p) ** 2)
                passed = passed * (1.0 - lost) / normal
        return np.maximum(first, 0.0) * passed, second * passed


@dataclass(frozen=True)
class Retro:
    """A peak around the direction to the lamp, as beads and cat's eyes have it."""

    height: float  #: radiance factor at its top
    sd_deg: float

    def mean(self, i: Array, o: Array) -> Array:
        """BRDF in 1/sr."""
        apart = 2.0 * np.arcsin(np.clip(0.5 * np.linalg.norm(i - o, axis=-1), 0.0, 1.0))
        exponent = np.minimum(0.5 * (apart / np.radians(self.sd_deg)) ** 2, 300.0)
        above = (i[..., 2] > 0.0) & (o[..., 2] > 0.0)
        return np.where(above, self.height / np.pi * np.exp(-exponent), 0.0)


@dataclass(frozen=True)
class TrueSample:
    """A sample whose reflection is known exactly."""

    wavelengths_nm: Array  #: (B,)
    body: Body
    highlights: tuple[Highlight, ...] = ()
    retro: Retro | None = None

    def brdf(self, i: Array, o: Array) -> Array:
        """1/sr, (..., B)."""
        first, second = self.body.mean(i, o)
        rho = self.body.albedo
        value = first[..., None] * rho + second[..., None] * rho**2
        for lobe in self.highlights:
            value = value + lobe.mean(i, o)[..., None] * lobe.colour(i, o)
        if self.retro is not None:
            value = value + self.retro.mean(i, o)[..., None]
        return np.asarray(value)

    @property
    def narrowest_deg(self) -> float:
        """The smallest width of a highlight in any direction, degrees; 30 where there is none."""
        widths = [h.s_deg / np.sqrt(max(h.ratio, 1.0 / h.ratio)) for h in self.highlights]
        return float(min(widths, default=30.0))
