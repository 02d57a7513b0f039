"""OpenPBR surface 1.1 in numpy, as MaterialX 1.39 draws it: base, specular and coat.

The layers are those of the node graph NG_open_pbr_surface_surfaceshader (MaterialX 1.39.5, OpenPBR
1.1.1) and of its GLSL: exact Fresnel for dielectrics, Schlick with F82 for metals, GGX with Smith's
correlated shadowing and the energy compensation of Turquin 2019, EON for the base's diffuse part
(Portsmouth, Kutz, Hill 2025). Each layer dims what lies below by its albedo towards the eye.
Transmission, subsurface, fuzz, thin film, emission and anisotropy are not drawn.
"""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.exchange import ggx
from relgloss_view.material import brdf

Colour = tuple[float, float, float]
WHITE: Colour = (1.0, 1.0, 1.0)
#: Rational fit of the albedo of GGX towards the eye (mx_ggx_dir_albedo_analytic, MaterialX 1.39):
#: numerators and denominators of the parts of F0 and F90, by 1, x, y, xy, x^2, y^2, x^2 y, x y^2,
#: x^2 y^2 with x = mu_o, y = alpha.
_ALBEDO = np.array(
    [
        (0.1003, 0.9345, 1.0, 1.0),
        (-0.6303, -2.323, -1.765, 0.2281),
        (9.748, 2.229, 8.263, 15.94),
        (-2.038, -3.748, 11.53, -55.83),
        (29.34, 1.424, 28.96, 13.08),
        (-8.245, -0.7684, -7.507, 41.26),
        (-26.44, 1.436, -36.11, 54.9),
        (19.99, 0.2913, 15.86, 300.2),
        (-5.448, 0.6286, 33.37, -285.1),
    ]
)
EDGE = 1.0 / 7.0  #: cosine at which F82 is reached (Hoffman 2019)


@dataclass(frozen=True)
class OpenPbr:
    """Parameters by the names of the specification; each of its default where it is left out.

    >>> surface = OpenPbr(base_color=(0.5, 0.5, 0.5), specular_weight=0.0)
    >>> up = np.array([0.0, 0.0, 1.0])
    >>> diffuse, specular = surface.evaluate(up, up)
    >>> diffuse.round(4).tolist(), specular.tolist()  # 0.5 / pi, a little dimmed
    ([0.1589, 0.1589, 0.1589], [0.0, 0.0, 0.0])
    """

    base_weight: float = 1.0
    base_color: Colour = (0.8, 0.8, 0.8)
    base_diffuse_roughness: float = 0.0
    base_metalness: float = 0.0
    specular_weight: float = 1.0
    specular_color: Colour = WHITE
    specular_roughness: float = 0.3
    specular_ior: float = 1.5
    coat_weight: float = 0.0
    coat_color: Colour = WHITE
    coat_roughness: float = 0.0
    coat_ior: float = 1.6
    coat_darkening: float = 1.0

    def evaluate(self, i: Array, o: Array) -> tuple[Array, Array]:
        """See Surface: linear sRGB, (..., 3) each."""
        t = ggx.turn(i, o)
        metal = self.base_metalness
        diffuse = np.zeros((*t.mu_i.shape, 3))
        specular = np.zeros((*t.mu_i.shape, 3))
        alpha = self.base_alpha
        if metal < 1.0:
            top, passed = dielectric(t, alpha, self.base_index, self.lobe_weight)
            specular += (1.0 - metal) * top[..., None] * np.asarray(self.specular_color)
            diffuse += (1.0 - metal) * passed[..., None] * self._body(i, o)
        if metal > 0.0:
            specular += metal * self._metal(t, alpha)
        below = self._darkening() * self._tint()
        diffuse, specular = diffuse * below, specular * below
        if self.coat_weight > 0.0:
            coat_alpha = max(self.coat_roughness**2, ggx.LEAST_ALPHA)
            top, passed = dielectric(t, coat_alpha, self.coat_ior, self.coat_weight)
            diffuse = diffuse * passed[..., None]
            specular = specular * passed[..., None] + top[..., None]
        above = t.above[..., None]
        return np.where(above, diffuse, 0.0), np.where(above, specular, 0.0)

    @property
    def base_alpha(self) -> float:
        """Width of the base's lobe, which a rough coat makes wider (OpenPBR 1.1, coat)."""
        r, coat = self.specular_roughness, self.coat_roughness
        rougher = math.sqrt(math.sqrt(min(1.0, 2.0 * coat**4 + r**4)))
        r = r + self.coat_weight * (rougher - r)
        return max(r * r, ggx.LEAST_ALPHA)

    @property
    def base_index(self) -> float:
        """Refractive index of the base under its coat, with the specular weight on its F0."""
        below = self.specular_ior / self.coat_ior
        below = below if below > 1.0 else 1.0 / below
        index = self.specular_ior + self.coat_weight * (below - self.specular_ior)
        epsilon = math.copysign(
            math.sqrt(min(max(self.specular_weight * ggx.head_on(index), 0.0), 0.99999)),
            index - 1.0,
        )
        return (1.0 + epsilon) / (1.0 - epsilon)

    @property
    def lobe_weight(self) -> float:
        """Of the base's dielectric lobe, beside its index, which holds the specular weight."""
        return 1.0

    def _body(self, i: Array, o: Array) -> Array:
        normal = np.broadcast_to(np.array([0.0, 0.0, 1.0]), np.broadcast_shapes(i.shape, o.shape))
        zeros = np.zeros(normal.shape[:-1])
        mu_i, mu_o = (np.broadcast_to(v[..., 2], zeros.shape) for v in (i, o))
        tangential = np.sum(i * o, axis=-1) - mu_i * mu_o
        f = brdf.Facing(mu_i, mu_o, tangential, zeros, zeros)
        first, second = brdf.eon(f, self.base_diffuse_roughness)
        rho = np.asarray(self.base_color)
        multiple = brdf.second_albedo("eon", rho, self.base_diffuse_roughness)
        return np.asarray(
            self.base_weight * (first[..., None] * rho + second[..., None] * multiple)
        )

    def _metal(self, t: ggx.Turn, alpha: float) -> Array:
        f0 = self.base_weight * np.asarray(self.base_color)
        x = np.minimum(t.cos_d, 1.0)[..., None]
        edge = f0 + (1.0 - f0) * (1.0 - EDGE) ** 5
        lack = edge * (1.0 - np.asarray(self.specular_color)) / (EDGE * (1.0 - EDGE) ** 6)
        bent = f0 + (1.0 - f0) * (1.0 - x) ** 5 - lack * x * (1.0 - x) ** 6
        fresnel = np.maximum(bent, 0.0)  # black in both colours, the formula takes light away
        single = ggx.density(t.cos_h, alpha) * ggx.shadowing(t, alpha)
        whole = albedo(t.mu_o, alpha, 1.0)
        more = 1.0 + fresnel * ((1.0 - whole) / whole)[..., None]
        return np.asarray(self.specular_weight * single[..., None] * fresnel * more)

    def _darkening(self) -> Array:
        """What the coat's inner reflections take from the base (OpenPBR 1.1, coat darkening)."""
        inner = 1.0 - (1.0 - ggx.head_on(self.coat_ior)) / self.coat_ior**2
        base = np.asarray(self.base_color)
        reflected = base + self.base_metalness * (base * self.specular_weight - base)
        full = (1.0 - inner) / (1.0 - reflected * inner)
        return np.asarray(1.0 + self.coat_weight * self.coat_darkening * (full - 1.0))

    def _tint(self) -> Array:
        return np.asarray(1.0 + self.coat_weight * (np.asarray(self.coat_color) - 1.0))

    def changed(self) -> dict[str, float | Colour]:
        """The parameters that differ from their defaults, by name."""
        default = OpenPbr()
        return {
            field.name: getattr(self, field.name)
            for field in dataclasses.fields(self)
            if getattr(self, field.name) != getattr(default, field.name)
        }


def albedo(mu_o: Array, alpha: float, f0: float, f90: float = 1.0) -> Array:
    """Albedo of GGX facets towards the eye, by the fit of MaterialX 1.39.

    >>> round(float(albedo(np.array(1.0), 0.1, 0.04)), 3)
    0.042
    """
    x, y = mu_o, alpha
    terms = (1.0, x, y, x * y, x * x, y * y, x * x * y, x * y * y, x * x * y * y)
    top_a, top_b, low_a, low_b = (
        sum(term * coefficient for term, coefficient in zip(terms, column, strict=True))
        for column in _ALBEDO.T
    )
    first = np.clip(top_a / low_a, 0.0, 1.0)
    second = np.clip(top_b / low_b, 0.0, 1.0)
    return np.asarray(f0 * first + f90 * second)


def dielectric(t: ggx.Turn, alpha: float, index: float, weight: float = 1.0) -> tuple[Array, Array]:
    """The lobe of a dielectric layer, 1/sr, and the share of light that it leaves to what is below.

    Both as MaterialX 1.39's mx_dielectric_bsdf.
    """
    fresnel = brdf.fresnel_dielectric(np.minimum(t.cos_d, 1.0), max(index, 1.0))
    whole = albedo(t.mu_o, alpha, 1.0)
    more = 1.0 + fresnel * (1.0 - whole) / whole
    single = ggx.density(t.cos_h, alpha) * ggx.shadowing(t, alpha)
    # The fit of the albedo can lie a little above 1 for a mirror.
    passed = np.maximum(1.0 - weight * more * albedo(t.mu_o, alpha, ggx.head_on(index)), 0.0)
    return weight * single * fresnel * more, passed
