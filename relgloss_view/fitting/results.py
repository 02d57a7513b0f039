"""What a fit leaves behind, as types. Their fields are those of the material file's `fit`."""

from __future__ import annotations

from dataclasses import dataclass

from relgloss_view.material.material import Quality

#: A picture shows errors of this size: beyond them no model of the ladder describes the sample.
POOR_MEDIAN = 0.12
POOR_MEDIAN_NEAR = 0.30


@dataclass(frozen=True)
class Part:
    """The misfit of a part of the values."""

    median_relative_error: float | None  #: None where there is no value
    values: int


@dataclass(frozen=True)
class Residuals:
    """How far a fit is from its samples, in several metrics."""

    median_relative_error: float | None
    p90_relative_error: float
    rms_log_error: float
    near_mirror: Part
    far: Part
    near_mirror_deg: float
    cosine_weighted_rms: float  #: of the BRDF times the cosines (Ngan, Durand, Matusik 2005)
    cube_root_rms: float  #: of the cube roots of the same (Fores, Ferwerda, Gu 2012)
    samples: int
    values: int
    left_out: dict[str, int]  #: counts by reason
    values_not_positive: int
    channels_outside_gamut: list[int]
    aperture_sd_deg: list[float]

    @property
    def poor(self) -> bool:
        """Whether no model of the ladder describes the sample."""
        near, median = self.near_mirror.median_relative_error, self.median_relative_error
        return bool(
            (median is not None and median > POOR_MEDIAN)
            or (near is not None and near > POOR_MEDIAN_NEAR)
        )


@dataclass(frozen=True)
class StandardErrors:
    """Spread of the unknowns; None for those that the rung does not have."""

    method: str
    albedo_relative: float
    sigma_deg: float | None = None
    s_deg: list[float] | None = None
    strength: list[float] | None = None
    refractive_index: list[float] | None = None


@dataclass(frozen=True)
class WidthBounds:
    """Widths of the main lobe that fit as well; no lower one where the grid does not resolve it."""

    s_deg_lower: float | None
    s_deg_upper: float


@dataclass(frozen=True)
class IndexBounds:
    """How well samples separate the refractive index from the strength."""

    held: bool
    correlation_with_strength: float | None
    note: str = "index and strength hide behind one another; strengths are for this index"


@dataclass(frozen=True)
class NoLobeBounds:
    """The strongest lobe of each width that could hide in samples fitted without one.

    None where the samples would not show a lobe of that width at all.
    """

    s_deg: list[float]
    strength_upper: list[float | None]
    largest_strength_upper: float | None
    narrowest_seen_deg: float | None


@dataclass(frozen=True)
class Verdict:
    """What a fit may claim."""

    residuals: Residuals
    quality: Quality
    warnings: tuple[tuple[Quality, str], ...]  #: each with the quality that it makes
    width: WidthBounds | None  #: of the main lobe, where there is one
    index: IndexBounds | None
    no_lobe: NoLobeBounds | None  #: where there is no lobe


@dataclass(frozen=True)
class CandidateEvidence:
    """One rung that was tried. Errors are logarithmic, about relative."""

    name: str
    parameters: int
    loss: float
    error: float
    rms_log_error: float
    median_relative_error: float
    cv_mean: float  #: mean error on groups left out
    cv_se: float  #: its standard error
    behind_best: float
    behind_best_se: float
    aicc: float
    bic: float
    s_deg: list[float]
    strength: list[float]
    refractive_index: list[float]
    sigma_deg: float
    converged: bool
    verdict: str


@dataclass(frozen=True)
class GlossUse:
    """What a gloss meter reads from a fit and from its table, in gloss units."""

    angle_deg: float
    fit: float | None  #: None, with the reason, where the table allows no reading
    table: float | None
    table_error: float | None  #: standard error of the table's, from its noise
    reason: str


@dataclass(frozen=True)
class PictureUse:
    """Pictures of a cylinder drawn from a fit and from its table: 95th percentiles of dE2000.

    `beyond_noise`: what is left where twice the table's noise is taken from each pixel.
    """

    lamp_azimuth_deg: float
    highlight: float | None  #: None where nothing shines, or with the reason
    highlight_beyond_noise: float | None
    whole_object: float | None
    object_beyond_noise: float | None
    c: float | None  #: of both pictures: c_max of the table's own
    reason: str


@dataclass(frozen=True)
class PlaneUse:
    """One plane of incidence against the fit."""

    incidence_deg: float
    samples: int
    offset: float  #: its median of measured over fitted, minus 1
    mirror_error: float | None  #: of the light near the mirror direction; None without samples
    named: bool  #: whether it is off by more than the other planes let expect


@dataclass(frozen=True)
class TailUse:
    """How much of the measured light a fit explains, all samples and those near the mirror."""

    explained: float  #: share of all measured light
    mirror_explained: float | None  #: within `near_mirror_deg` of it; None without samples there
    p90: float  #: of the relative errors, above the floor of the instrument
    p99: float
    mirror_p90: float | None


@dataclass(frozen=True)
class UseJudgement:
    """A fit judged by what it is for: gloss numbers, pictures, and the light of each plane."""

    gloss: tuple[GlossUse, ...]
    pictures: tuple[PictureUse, ...]
    tail: TailUse | None  #: None, with the reason, where fit and table can't be compared
    planes: tuple[PlaneUse, ...]
    reason: str
    notes: tuple[str, ...]  #: what to know; the fit may still be good
    poor: tuple[str, ...]  #: why the fit is not good, one plain line each
