"""Material: what the sample is. A diffuse part, up to two specular lobes, the fit's evidence."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from relgloss_view.bands import Bands
from relgloss_view.material import brdf

Array = NDArray[np.float64]

DIFFUSE_MODELS = ("lambert", "oren-nayar", "eon")
QUALITIES = ("good", "poor", "unidentifiable")
S_DEG_RANGE = (0.05, 40.0)
SIGMA_DEG_MAX = 57.29577951308232  # r = 1, the end of EON's range
MAX_LOBES = 2


@dataclass(frozen=True)
class Diffuse:
    """Diffuse part: `model` one of DIFFUSE_MODELS, `albedo` one value a band."""

    model: str
    albedo: tuple[float, ...]
    sigma_deg: float = 0.0  #: Oren-Nayar's slope sd; EON's r is this angle in radians

    @property
    def sigma(self) -> float:
        """Roughness in radians."""
        return float(np.radians(self.sigma_deg))


@dataclass(frozen=True)
class Lobe:
    """A Torrance-Sparrow lobe. `strength` has one value a band, or a single value for all."""

    strength: tuple[float, ...]
    s_deg: float  #: per-axis standard deviation of the facet normals
    refractive_index: float = 1.5

    @property
    def s(self) -> float:
        """Facet standard deviation in radians."""
        return float(np.radians(self.s_deg))

    def per_band(self, count: int) -> Array:
        """The strength in each of `count` bands."""
        return np.broadcast_to(np.asarray(self.strength, dtype=np.float64), (count,)).copy()


@dataclass(frozen=True)
class FitRecord:
    """The evidence behind a fitted material; every field goes into the file as it is."""

    candidates: tuple[dict[str, Any], ...] = ()
    chosen: str = ""
    residuals: dict[str, Any] = field(default_factory=dict)
    quality: str = "good"
    warnings: tuple[str, ...] = ()
    seed: int = 0
    seconds: float = 0.0
    standard_errors: dict[str, Any] = field(default_factory=dict)
    bounds: dict[str, Any] = field(default_factory=dict)
    convention: str = "f_s = k F D G / (4 cos_i cos_o), D normalised to unit projected area"


@dataclass(frozen=True)
class Material:
    """f_r(i, o, band) in 1/sr = diffuse + sum of lobes."""

    name: str
    source: str
    bands: Bands
    diffuse: Diffuse
    specular: tuple[Lobe, ...] = ()
    fit: FitRecord | None = None

    def visible_lobes(self) -> tuple[Lobe, ...]:
        """The lobes that reflect anything."""
        return tuple(lobe for lobe in self.specular if any(lobe.strength))

    @property
    def synthetic(self) -> bool:
        """Whether the source says that nothing was measured."""
        return "synthetic" in self.source.lower()

    @property
    def warnings(self) -> tuple[str, ...]:
        """What a picture of this material must say about it."""
        return self.fit.warnings if self.fit else ()

    def second_albedo(self) -> Array:
        """(B,), the albedo of the diffuse model's second shape (see brdf.second_albedo)."""
        return brdf.second_albedo(self.diffuse.model, self.diffuse.albedo, self.diffuse.sigma)

    def evaluate(self, i: Array, o: Array) -> tuple[Array, Array]:
        """Diffuse and specular BRDF in 1/sr, each (..., B), for directions in the sample frame."""
        normal = np.broadcast_to(np.array([0.0, 0.0, 1.0]), np.broadcast_shapes(i.shape, o.shape))
        return self.evaluate_facing(brdf.facing(normal, i, o))

    def evaluate_facing(self, f: brdf.Facing) -> tuple[Array, Array]:
        """Diffuse and specular BRDF in 1/sr, each (..., B)."""
        first, second = brdf.diffuse_shapes(self.diffuse.model, f, self.diffuse.sigma)
        diffuse = first[..., None] * np.asarray(self.diffuse.albedo)
        diffuse = diffuse + second[..., None] * self.second_albedo()
        specular = np.zeros_like(diffuse)
        for lobe in self.specular:
            shape = brdf.torrance_sparrow(f, lobe.s, lobe.refractive_index)
            specular = specular + shape[..., None] * lobe.per_band(self.bands.count)
        return diffuse, specular
