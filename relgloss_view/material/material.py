"""Material: a diffuse part, up to two specular lobes and the evidence of the fit."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any, NamedTuple

import numpy as np

from relgloss_view.base import reading
from relgloss_view.base.arrays import Array
from relgloss_view.base.notebook import html_table, span
from relgloss_view.base.reading import printable, refuse
from relgloss_view.material import brdf
from relgloss_view.material.band_coverage import coverage_warnings
from relgloss_view.material.described import DescribedRecord
from relgloss_view.material.estimated import EstimateRecord
from relgloss_view.material.spectra import Illuminant, light_weights
from relgloss_view.measure.bands import Bands

DIFFUSE_MODELS = ("lambert", "oren-nayar", "eon")
ALBEDO_MAX = 4.0  # fluorescent papers pass 1; anything above this is a unit mistake
SIGMA_DEG_MAX = 57.29577951308232  # r = 1, the end of EON's range
STRENGTH_MAX = 1e6
INDEX_RANGE = (1.0, 10.0)
S_DEG_MAX = 40.0
#: A narrower lobe is drawn as wide as this: a point lamp in a mirror has no limit image.
S_DEG_DRAWN = 0.05
MAX_LOBES = 2
#: What a dielectric of index 1.5 reflects at normal incidence.
HEAD_ON = 0.04


class Quality(StrEnum):
    """What a fit may claim."""

    GOOD = "good"
    POOR = "poor"  #: no model of the ladder describes the sample
    UNIDENTIFIABLE = "unidentifiable"  #: the measurement leaves the lobe's width open


@dataclass(frozen=True)
class Diffuse:
    """The diffuse part of a material.

    model: 'lambert', 'oren-nayar' (Oren and Nayar 1995) or 'eon' (Portsmouth, Kutz, Hill 2025).
    albedo: one value a band, 0 to 4; fluorescent papers exceed 1.
    sigma_deg: roughness, degrees, 0 to 57.3.

    Raises InputError where a value is out of its range, as do Lobe, FitRecord and Material.
    """

    model: str
    albedo: tuple[float, ...]
    sigma_deg: float = 0.0  #: Oren-Nayar's slope sd; EON's r is this angle in radians

    def __post_init__(self) -> None:
        if self.model not in DIFFUSE_MODELS:
            refuse("model", f"one of {', '.join(DIFFUSE_MODELS)}", self.model)
        expected = f"an albedo, 0 to {ALBEDO_MAX:g}"
        albedo = reading.numbers_of(self.albedo, "albedo", expected, 0.0, ALBEDO_MAX)
        expected = f"an angle in degrees, 0 to {SIGMA_DEG_MAX:.1f}"
        sigma_deg = reading.number(self.sigma_deg, "sigma_deg", expected, 0.0, SIGMA_DEG_MAX)
        _settle(self, albedo=albedo, sigma_deg=sigma_deg)

    @property
    def sigma(self) -> float:
        """Roughness in radians."""
        return float(np.radians(self.sigma_deg))


class LobePart(NamedTuple):
    """A part of a lobe: one function of the directions times one spectrum."""

    fresnel: brdf.Fresnel  #: what stands for F in brdf.torrance_sparrow
    spectrum: Array  #: (B,), its factor in each band


@dataclass(frozen=True)
class Lobe:
    """A specular lobe (Torrance and Sparrow 1967) of a dielectric or of a metal.

    strength: one value a band, or a single value for all, 0 to 1,000,000; a metal has a single one.
    It is the share of the surface whose facets reflect: 1 for a smooth interface everywhere.
    s_deg: per-axis standard deviation of the facet normals, degrees, above 0 and at most 40.
    refractive_index: of a dielectric, 1 to 10; not used where the lobe is a metal's.
    f0: reflectance of a metal's facets at normal incidence, one value a band, or a single value for
    all, 0 to 1; None for a dielectric. F = (1 - w) F0 + w with w = (1 - cos)^5 (Schlick 1994): the
    colour of F0 head on, white at grazing incidence.
    """

    strength: tuple[float, ...]
    s_deg: float  #: per-axis standard deviation of the facet normals
    refractive_index: float = 1.5
    f0: tuple[float, ...] | None = None

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
        if self.f0 is None:
            return
        if len(strength) != 1:
            refuse("strength", "one number: a metal's colour is its f0", len(strength))
        _settle(self, f0=reading.numbers_of(self.f0, "f0", "a reflectance, 0 to 1", 0.0, 1.0))

    @property
    def is_metal(self) -> bool:
        """Whether the lobe is a metal's."""
        return self.f0 is not None

    @property
    def reflects(self) -> bool:
        """Whether the lobe reflects anything."""
        return any(self.strength) and (self.is_metal or self.refractive_index > 1.0)

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
        """Whether the width is the largest allowed, so that a fit has stopped there."""
        return self.s_deg > S_DEG_MAX * (1.0 - 1e-6)

    def per_band(self, count: int) -> Array:
        """The strength in each of `count` bands."""
        return np.broadcast_to(np.asarray(self.strength, dtype=np.float64), (count,)).copy()

    def parts(self, count: int) -> tuple[LobePart, ...]:
        """What the lobe is the sum of in `count` bands: one part of a dielectric, two of a metal.

        >>> [part.spectrum.tolist() for part in Lobe((0.5,), 5.0, f0=(0.9, 0.7, 0.4)).parts(3)]
        [[0.45, 0.35, 0.2], [0.5, 0.5, 0.5]]
        """
        strength = self.per_band(count)
        if self.f0 is None:
            return (LobePart(self.refractive_index, strength),)
        return (
            LobePart(brdf.MetalPart.FACING, strength * np.asarray(self.f0)),
            LobePart(brdf.MetalPart.GRAZING, strength),
        )

    @property
    def height(self) -> tuple[float, ...]:
        """By what lobes of one width are compared: the strength of the dielectric of index 1.5 that
        is as bright head on. A dielectric counts by its strength, whatever its index.
        """
        if self.f0 is None:
            return self.strength
        return tuple(self.strength[0] * f0 / HEAD_ON for f0 in self.f0)


@dataclass(frozen=True)
class FitRecord:
    """The evidence behind a fitted material; all of it goes into the file."""

    candidates: tuple[dict[str, Any], ...] = ()
    chosen: str = ""
    residuals: dict[str, Any] = field(default_factory=dict)
    quality: Quality = Quality.GOOD
    warnings: tuple[str, ...] = ()
    seed: int = 0
    seconds: float = 0.0
    standard_errors: dict[str, Any] = field(default_factory=dict)
    bounds: dict[str, Any] = field(default_factory=dict)
    #: Gloss, pictures and planes of the fit against those of its table; empty in older files.
    judgement: dict[str, Any] = field(default_factory=dict)
    #: `peak` and `c_max` (fitting.derived): `value`, `standard_error`
    derived: dict[str, Any] = field(default_factory=dict)
    convention: str = "f_s = k F D G / (4 cos_i cos_o), D normalised to unit projected area"
    #: Those of the warnings that explain the quality.
    grounds: tuple[str, ...] = field(default=(), compare=False)
    #: `names` of M fitted numbers and their covariances (M, M): what the `samples`' noise does,
    #: and what `priors` leave open, of the instrument's errors and of a held refractive index
    covariance: dict[str, Any] = field(default_factory=dict)
    #: Errors of the instrument that the fit found, by name: `value`, `standard_error`, `unit`
    instrument: dict[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if self.quality not in list(Quality):
            refuse("quality", f"one of {', '.join(Quality)}", self.quality)
        _settle(self, quality=Quality(self.quality))
        for k, warning in enumerate(self.warnings):
            reading.text(warning, f"warnings[{k}]")
        for k, ground in enumerate(self.grounds):
            reading.text(ground, f"grounds[{k}]")


#: The warning of a quality that no warning explains.
_UNEXPLAINED = {
    Quality.POOR: "the fit is poor: the model does not describe this sample well",
    Quality.UNIDENTIFIABLE: (
        "the fit is unidentifiable: the measurement leaves the lobe's width open"
    ),
}


@dataclass(frozen=True)
class Material:
    """Reflection of a sample: f_r(i, o, band) in 1/sr = diffuse + sum of the lobes.

    name, source: texts. bands: shared by the albedo and the strengths. specular: at most two lobes.
    fit: the evidence, where the material was fitted. `fit_material` makes one from a measurement,
    `load_material` reads one. Raises InputError where the parts do not fit together.

    >>> from relgloss_view.measure.bands import RGB
    >>> gray = Material("gray", "by hand", RGB, Diffuse("lambert", (0.2, 0.2, 0.2)))
    >>> up = np.array([0.0, 0.0, 1.0])
    >>> diffuse, specular = gray.evaluate(up, up)
    >>> diffuse.round(5).tolist(), specular.tolist()  # 0.2 / pi, and nothing specular
    ([0.06366, 0.06366, 0.06366], [0.0, 0.0, 0.0])
    """

    name: str
    source: str
    bands: Bands
    diffuse: Diffuse
    specular: tuple[Lobe, ...] = ()
    fit: FitRecord | None = None
    synthetic: bool = False  #: computed from invented parameters, not measured
    hypothetical: bool = False  #: made from another material by changing it
    estimate: EstimateRecord | None = None  #: where it was estimated from a few readings
    described: DescribedRecord | None = None  #: where another program's parameters describe it

    def __post_init__(self) -> None:
        reading.text(self.name, "name")
        reading.text(self.source, "source")
        count = self.bands.count
        if len(self.diffuse.albedo) != count:
            refuse("diffuse.albedo", f"{count} values, one a band", len(self.diffuse.albedo))
        if len(self.specular) > MAX_LOBES:
            refuse("specular", f"a list of at most {MAX_LOBES} lobes", len(self.specular))
        for k, lobe in enumerate(self.specular):
            if len(lobe.strength) not in (1, count):
                place, expected = f"specular[{k}].strength", f"one number, or {count}, one a band"
                refuse(place, expected, len(lobe.strength))
            if lobe.f0 is not None and len(lobe.f0) not in (1, count):
                refuse(f"specular[{k}].f0", f"one number, or {count}, one a band", len(lobe.f0))

    def visible_lobes(self) -> tuple[Lobe, ...]:
        """The lobes that reflect anything."""
        return tuple(lobe for lobe in self.specular if lobe.reflects)

    @property
    def warnings(self) -> tuple[str, ...]:
        """The warnings that go with every picture of this material."""
        texts = list(self.fit.warnings) if self.fit else []
        texts += self.estimate.warnings if self.estimate else ()
        texts += self.described.warnings if self.described else ()
        if self.fit and self.fit.quality != Quality.GOOD and not self.fit.grounds:
            texts.append(_UNEXPLAINED[self.fit.quality])
        for k, lobe in enumerate(self.specular):
            if lobe.too_narrow:
                texts.append(
                    f"specular[{k}].s_deg = {lobe.s_deg:g} is narrower than {S_DEG_DRAWN:g} "
                    f"degrees, where a point lamp has no limit image; drawn as {S_DEG_DRAWN:g}"
                )
        return (*texts, *coverage_warnings(self.bands))

    def second_albedo(self) -> Array:
        """(B,), the albedo of the diffuse model's second shape (see brdf.second_albedo)."""
        return brdf.second_albedo(self.diffuse.model, self.diffuse.albedo, self.diffuse.sigma)

    def xyz_weights(self, lamp: Illuminant) -> Array:
        """Weights (B, 3) that fold this material's spectra into XYZ under a lamp, none below zero.

        They are spectra.xyz_weights of its bands, but for spectra that those make negative; see
        spectra.light_weights. The same weights serve every diffuse model and each lobe.
        """
        rho = np.asarray(self.diffuse.albedo)
        multiple = brdf.second_albedo("eon", rho, self.diffuse.sigma)
        count = self.bands.count
        strengths = [p.spectrum for lobe in self.specular for p in lobe.parts(count)]
        return light_weights([rho, rho * rho, multiple, *strengths], self.bands, lamp)

    def evaluate(self, i: Array, o: Array) -> tuple[Array, Array]:
        """Diffuse and specular BRDF in 1/sr, each (..., B).

        i, o: unit vectors (..., 3) to the lamp and to the eye, in the sample frame (normal +z).
        """
        normal = np.broadcast_to(np.array([0.0, 0.0, 1.0]), np.broadcast_shapes(i.shape, o.shape))
        return self.evaluate_facing(brdf.facing(normal, i, o))

    def evaluate_facing(self, f: brdf.Facing) -> tuple[Array, Array]:
        """Diffuse and specular BRDF in 1/sr, each (..., B), for an orientation from brdf.facing."""
        first, second = brdf.diffuse_shapes(self.diffuse.model, f, self.diffuse.sigma)
        diffuse = first[..., None] * np.asarray(self.diffuse.albedo)
        diffuse = diffuse + second[..., None] * self.second_albedo()
        specular = np.zeros_like(diffuse)
        for lobe in self.specular:
            for part in lobe.parts(self.bands.count):
                shape = brdf.torrance_sparrow(f, lobe.s, part.fresnel)
                specular = specular + shape[..., None] * part.spectrum
        return diffuse, specular

    def __repr__(self) -> str:
        lobes = f"{len(self.specular)} lobe{'' if len(self.specular) == 1 else 's'}"
        return (
            f"<Material {printable(self.name, 60)!r}{f', {self.marks}' if self.marks else ''}: "
            f"{self.bands.words}, {self.diffuse.model} and {lobes}, {self.evidence_words}>"
        )

    def _repr_html_(self) -> str:
        """The table that a notebook shows."""
        diffuse = self.diffuse
        rows = [
            ("source", self.source),
            ("synthetic", "yes, nothing was measured" if self.synthetic else "no"),
            *([("hypothetical", "yes, made from another material")] if self.hypothetical else []),
            *([("estimated", "yes, from a few readings")] if self.estimate else []),
            *([("described", f"yes, as {self.described.model}")] if self.described else []),
            ("quality", self.evidence_words),
            ("bands", self.bands.words),
            ("diffuse: model", diffuse.model),
            ("diffuse: albedo", span(diffuse.albedo)),
            ("diffuse: roughness sigma", f"{diffuse.sigma_deg:.4g} deg"),
        ]
        for k, lobe in enumerate(self.specular, 1):
            rows += [
                (f"lobe {k}: strength", span(lobe.strength)),
                (f"lobe {k}: width s", f"{lobe.s_deg:.4g} deg"),
                (f"lobe {k}: refractive index", f"{lobe.refractive_index:.4g}")
                if lobe.f0 is None
                else (f"lobe {k}: metal, F0", span(lobe.f0)),
            ]
        return html_table(f"Material: {self.name}", rows, self.warnings)

    @property
    def marks(self) -> str:
        """What a caption must state of the material's origin: '', 'synthetic', 'estimated',
        'described'.
        """
        marks = [
            ("synthetic", self.synthetic),
            ("estimated", self.estimate is not None),
            ("described", self.described is not None),
        ]
        return ", ".join(word for word, holds in marks if holds)

    @property
    def evidence_words(self) -> str:
        """What the material rests on: 'fit good', 'estimated', 'described, not measured' or 'not
        fitted', for captions.
        """
        if self.estimate:
            return self.estimate.words
        if self.described:
            return "described, not measured"
        return f"fit {self.fit.quality}" if self.fit else "not fitted"


def _settle(checked: object, **values: object) -> None:
    """Put checked values of their plain types into a frozen dataclass."""
    for name, value in values.items():
        object.__setattr__(checked, name, value)
