"""Material: what the sample is. A diffuse part, up to two specular lobes, the fit's evidence."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from relgloss_view.base import reading
from relgloss_view.base.reading import fault
from relgloss_view.material import brdf
from relgloss_view.measure.bands import Bands

Array = NDArray[np.float64]

DIFFUSE_MODELS = ("lambert", "oren-nayar", "eon")
QUALITIES = ("good", "poor", "unidentifiable")
ALBEDO_MAX = 4.0  # fluorescent papers pass 1; anything above this is a unit mistake
SIGMA_DEG_MAX = 57.29577951308232  # r = 1, the end of EON's range
STRENGTH_MAX = 1e6
INDEX_RANGE = (1.0, 10.0)
S_DEG_MAX = 40.0
#: A narrower lobe is drawn as wide as this: a point lamp in a mirror has no limit image.
S_DEG_DRAWN = 0.05
MAX_LOBES = 2


@dataclass(frozen=True)
class Diffuse:
    """Diffuse part: `model` one of DIFFUSE_MODELS, `albedo` one value a band.

    Raises InputError where a value is out of its range, as do Lobe, FitRecord and Material.
    """

    model: str
    albedo: tuple[float, ...]
    sigma_deg: float = 0.0  #: Oren-Nayar's slope sd; EON's r is this angle in radians

    def __post_init__(self) -> None:
        if self.model not in DIFFUSE_MODELS:
            fault("model", f"one of {', '.join(DIFFUSE_MODELS)}", self.model)
        expected = f"an albedo, 0 to {ALBEDO_MAX:g}"
        albedo = reading.numbers_of(self.albedo, "albedo", expected, 0.0, ALBEDO_MAX)
        expected = f"an angle in degrees, 0 to {SIGMA_DEG_MAX:.1f}"
        sigma_deg = reading.number(self.sigma_deg, "sigma_deg", expected, 0.0, SIGMA_DEG_MAX)
        _settle(self, albedo=albedo, sigma_deg=sigma_deg)

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

    def __post_init__(self) -> None:
        expected = f"a number from 0 to {STRENGTH_MAX:g}"
        strength = reading.numbers_of(self.strength, "strength", expected, 0.0, STRENGTH_MAX)
        low, high = INDEX_RANGE
        expected = f"a refractive index, {low:g} to {high:g}"
        index = reading.number(self.refractive_index, "refractive_index", expected, low, high)
        expected = f"a lobe width above 0 and at most {S_DEG_MAX:g} degrees"
        above_zero = math.nextafter(0.0, 1.0)
        s_deg = reading.number(self.s_deg, "s_deg", expected, above_zero, S_DEG_MAX)
        _settle(self, strength=strength, refractive_index=index, s_deg=s_deg)

    @property
    def s(self) -> float:
        """Facet standard deviation in radians, as it is drawn: at least S_DEG_DRAWN."""
        return float(np.radians(max(self.s_deg, S_DEG_DRAWN)))

    @property
    def too_narrow(self) -> bool:
        """Whether the lobe is drawn wider than it is."""
        return self.s_deg < S_DEG_DRAWN * (1.0 - 1e-9)

    @property
    def at_the_limit(self) -> bool:
        """Whether the width is the widest there is, so that a fit has stopped there."""
        return self.s_deg > S_DEG_MAX * (1.0 - 1e-6)

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

    def __post_init__(self) -> None:
        if self.quality not in QUALITIES:
            fault("quality", f"one of {', '.join(QUALITIES)}", self.quality)
        for k, warning in enumerate(self.warnings):
            reading.text(warning, f"warnings[{k}]")


#: Words of a warning that says a quality already, and the warning where none does.
_SAYS = {"poor": ("poor", "no model describes"), "unidentifiable": ("unidentifiable",)}
_SAYS_BY_ITSELF = {
    "poor": "the fit is poor: the model does not describe this sample well",
    "unidentifiable": "the fit is unidentifiable: the measurement does not tell the lobe's width",
}


@dataclass(frozen=True)
class Material:
    """f_r(i, o, band) in 1/sr = diffuse + sum of lobes."""

    name: str
    source: str
    bands: Bands
    diffuse: Diffuse
    specular: tuple[Lobe, ...] = ()
    fit: FitRecord | None = None

    def __post_init__(self) -> None:
        reading.text(self.name, "name")
        reading.text(self.source, "source")
        count = self.bands.count
        if len(self.diffuse.albedo) != count:
            fault("diffuse.albedo", f"{count} values, one a band", len(self.diffuse.albedo))
        if len(self.specular) > MAX_LOBES:
            fault("specular", f"a list of at most {MAX_LOBES} lobes", len(self.specular))
        for k, lobe in enumerate(self.specular):
            if len(lobe.strength) not in (1, count):
                place, expected = f"specular[{k}].strength", f"one number, or {count}, one a band"
                fault(place, expected, len(lobe.strength))

    def visible_lobes(self) -> tuple[Lobe, ...]:
        """The lobes that reflect anything."""
        return tuple(
            lobe for lobe in self.specular if any(lobe.strength) and lobe.refractive_index > 1.0
        )

    @property
    def synthetic(self) -> bool:
        """Whether the source says that nothing was measured."""
        return self.source.strip().lower().startswith("synthetic")

    @property
    def hypothetical(self) -> bool:
        """Whether the source says that it was made up from another material."""
        return "hypothetical" in self.source.partition(":")[0].lower()

    @property
    def warnings(self) -> tuple[str, ...]:
        """What a picture of this material must say about it."""
        told = list(self.fit.warnings) if self.fit else []
        quality = self.fit.quality if self.fit else "good"
        if quality != "good" and not any(sign in t for t in told for sign in _SAYS[quality]):
            told.append(_SAYS_BY_ITSELF[quality])
        for k, lobe in enumerate(self.specular):
            if lobe.too_narrow:
                told.append(
                    f"specular[{k}].s_deg = {lobe.s_deg:g} is narrower than {S_DEG_DRAWN:g} "
                    f"degrees, where a point lamp has no limit image; drawn as {S_DEG_DRAWN:g}"
                )
        return tuple(told)

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


def _settle(checked: object, **values: object) -> None:
    """Put checked values, plain floats, into a frozen dataclass."""
    for name, value in values.items():
        object.__setattr__(checked, name, value)
