"""Contrast gloss that keeps the gloss ratio of a sample to a reference, whatever the view.

Relative-glossiness matching (Ishii et al.): R = G_1 / G~_1 is seen on the reference, and a picture
of sample i shows the right gloss where G_i = R G~_i. G is the reading of a gloss meter. G~ is the
lightness that the highlight adds at its brightest place, c L_s* (eq. 2); grain enters by its mean.
It is linear in c, so a pair of c keeps its meaning in every view, and the proposal is the geometric
mean over poses of the lamp. Defined in docs/match.md.
"""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.gloss.meter.meter import specular_gloss
from relgloss_view.gloss.pose import pose_of
from relgloss_view.gloss.samples import DEFAULT_GLOSS, SampleLook, computed_gloss
from relgloss_view.material.material import Material
from relgloss_view.picture.model import tone
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.match import MOST_C, Match
from relgloss_view.picture.scene.sample import SAMPLES, load_sample
from relgloss_view.picture.scene.setup import Setup

PAPER = Setup()  #: the paper's geometry
#: Directions of the lamp, seen from the default eye, over which a proposal is the mean.
LAMPS_DEG = (20.0, 50.0, 80.0, 110.0)
SIGMAS_N_DEG = tuple(0.25 * k for k in range(13))  #: the paper's range, twice as fine
DEFAULT_REFERENCE = next(iter(SAMPLES))  #: cast-coated, as in the paper


def match_setups(setup: Setup | None = None) -> tuple[Setup, ...]:
    """The setups of a match: the paper's cylinder under LAMPS_DEG, or the one that is given."""
    if setup is not None:
        return (setup,)
    return tuple(Setup().with_entries("lamp", azimuth_deg=lamp) for lamp in LAMPS_DEG)


def full_c(material: Material, setup: Setup = PAPER) -> float:
    """c_max of a material in a setup, by default the paper's, without grain; 1 without a highlight.

    It is the limit for pictures of ever more pixels, so that no picture there has a smaller one.

    >>> round(full_c(load_sample("cast-coated")), 4)
    0.1403
    """
    extremes = pose_of(setup).extremes(material)
    return 1.0 if extremes.l_s_max < tone.NO_LOBE_LSTAR else extremes.smallest_ratio


def absolute_c(look: Look, material: Material, setup: Setup = PAPER) -> float:
    """c of a look; a share is of c_max in a setup, by default at the paper's geometry."""
    return look.c if look.c is not None else look.setting.c_fraction * full_c(material, setup)


def gloss_of(material: Material, gloss: str = DEFAULT_GLOSS) -> float:
    """The reading of a material, one of GLOSSES; 0 where a meter reads nothing."""
    angle = gloss.removeprefix("gloss-")
    if angle != gloss:
        return specular_gloss(material, float(angle))
    return computed_gloss(material)[gloss] or 0.0


@dataclass(frozen=True)
class Reference:
    """The reference of a match: its setting, and how bright its highlight is in each pose.

    >>> reference = Reference.default()
    >>> reference.sample.label, round(reference.c, 3), len(reference.setups)
    ('cast-coated', 0.14, 4)
    """

    sample: SampleLook
    c: float
    gloss: str  #: the reading whose ratio is kept, one of GLOSSES
    reading: float
    setups: tuple[Setup, ...]
    peaks: tuple[float | None, ...]  #: L_s* by setup; None where its highlight is not seen

    @classmethod
    def of(
        cls, sample: SampleLook, gloss: str = DEFAULT_GLOSS, setup: Setup | None = None
    ) -> Reference:
        """A reference at its look; a share of c_max is that at the paper's geometry.

        setup: match in this one alone. InputError where the sample has no gloss, or shows none.
        """
        name = printable(sample.label)
        if sample.pack is not None:
            raise InputError(f"{name}: a pack has several finishes, so it can't be the reference; "
                             "choose a paper or a material file as --reference")  # fmt: skip
        reading = gloss_of(sample.material, gloss)
        setups = match_setups(setup)
        peaks = tuple(_peak(s, sample.material, sample.look.sigma_n_deg) for s in setups)
        c = absolute_c(sample.look, sample.material)
        if reading <= 0.0 or c <= 0.0:
            raise InputError(f"{name}: has no gloss, so no ratio to it can be kept; choose another "
                             "--reference")  # fmt: skip
        if not sample.material.visible_lobes():
            raise InputError(f"{name}: has no highlight, because it has no specular lobe; choose "
                             "another --reference")  # fmt: skip
        if all(peak is None for peak in peaks):
            raise InputError(f"{name}: shows no gloss in this view, so no ratio to it can be kept; "
                             "turn the lamp, or choose another --reference")  # fmt: skip
        return cls(sample, c, gloss, reading, setups, peaks)

    @classmethod
    def default(cls) -> Reference:
        """Cast-coated, smooth, at its c_max at the paper's geometry."""
        name = DEFAULT_REFERENCE
        return cls.of(SampleLook(name, load_sample(name), Look().at(SAMPLES[name])))

    def as_numbers(self) -> dict[str, Any]:
        """The reference as JSON holds it."""
        return {
            "label": self.sample.label,
            "name": self.sample.material.name,
            "sigma_n_deg": self.sample.look.sigma_n_deg,
            "c": self.c,
            "gloss": self.reading,
            "shown": self.displayed_gloss,
        }

    def matched_look(self, sample: SampleLook, setup: Setup | None = None) -> SampleLook:
        """A sample at its look's sigma_N, with the c that keeps the ratio to this reference.

        setup: of the picture, in which the finishes of a pack keep their ratios.
        """
        if sample.pack is not None:
            from relgloss_view.gloss.pack_match import match_pack

            found = match_pack(self, sample.pack, setup=_on_form(sample, setup))
            look = sample.look.with_entries(c=found.c, sigma_n_deg=found.anchor.sigma_n_deg)
            return dataclasses.replace(sample, look=look, pack=found.pack)
        match = matched(self, sample.material, sample.look.sigma_n_deg)
        return dataclasses.replace(sample, look=sample.look.with_entries(c=match.test_c))

    @property
    def sample_at_c(self) -> SampleLook:
        """The sample with c itself in its look."""
        look = self.sample.look.with_entries(c=self.c)
        return dataclasses.replace(self.sample, look=look)

    @property
    def displayed_gloss(self) -> float:
        """What its highlight adds to L*, the mean over the poses; nothing is clipped."""
        return self.c * _mean([peak for peak in self.peaks if peak is not None])


@dataclass(frozen=True)
class CurvePoint:
    """The c that keeps the ratio at one sigma_N: the mean over the poses, and their range."""

    sigma_n_deg: float
    c: float | None  #: None where no pose shows both highlights
    low: float | None = None  #: c of the pose that proposes the smallest
    high: float | None = None
    refused: tuple[float, ...] = ()  #: lamp azimuths of the poses that do not show both, degrees

    @property
    def spread(self) -> float:
        """The largest c that a pose proposes over the smallest; 1 without any."""
        return self.high / self.low if self.low and self.high else 1.0


@dataclass(frozen=True)
class ComparedSetting:
    """A sample's own setting, compared with the curve."""

    sigma_n_deg: float
    c: float
    ratio: float | None  #: displayed gloss over the reference's; None where a highlight is not seen
    c_distance: float | None  #: c less the curve's at the same sigma_N; None where it has none
    sigma_n_distance_deg: float | None  #: sigma_N less the curve's nearest at the same c


@dataclass(frozen=True)
class MatchCurve:
    """The settings of one sample that keep its ratio to the reference."""

    sample: SampleLook
    reading: float  #: gloss of the material
    ratio: float  #: of it to the reference's
    full_c: float  #: c_max at the paper's geometry, of which shares are given
    curve: tuple[CurvePoint, ...]  #: by sigma_N
    grain_deg: float  #: the sigma_N that looks like the sample's own grain
    proposed: CurvePoint | None  #: the curve's nearest to it
    own_setting: ComparedSetting | None  #: None where the sample came without a setting


def matched_point(
    reference: Reference, material: Material, sigma_n_deg: float, reading: float | None = None
) -> CurvePoint:
    """The c at one sigma_N with which a material keeps its ratio of gloss to the reference.

    reading: of the gloss that is kept, where it is not that of the material itself.

    >>> point = matched_point(Reference.default(), load_sample("matte-coated"), 2.0)
    >>> round(point.c, 2), point.spread < 1.7
    (0.37, True)
    """
    if reading is None:
        reading = gloss_of(material, reference.gloss)
    wanted = reference.c * reading / reference.reading
    proposals, refused = [], []
    for setup, peak in zip(reference.setups, reference.peaks, strict=True):
        own = None if peak is None else _peak(setup, material, sigma_n_deg)
        if peak is None or own is None:
            refused.append(setup.lamp.azimuth_deg)
        else:
            proposals.append(wanted * peak / own)
    if not proposals:
        return CurvePoint(sigma_n_deg, None, refused=tuple(refused))
    return CurvePoint(sigma_n_deg, _mean(proposals), min(proposals), max(proposals), tuple(refused))


def matched(reference: Reference, material: Material, sigma_n_deg: float) -> Match:
    """The match of a pair; without a highlight on either side both have the reference's c.

    sigma_n_deg: graininess of the test picture, degrees.

    >>> match = matched(Reference.default(), load_sample("uncoated"), 2.0)
    >>> round(match.test_c, 2), round(match.ratio, 1)
    (0.35, 2.5)
    """
    point = matched_point(reference, material, sigma_n_deg)
    return Match(
        reference_c=reference.c,
        test_c=reference.c if point.c is None else min(point.c, MOST_C),
        reference_sigma_n_deg=reference.sample.look.sigma_n_deg,
        test_sigma_n_deg=sigma_n_deg,
        gloss=reference.gloss,
        spread=point.spread,
    )


def match_curve(
    reference: Reference, sample: SampleLook, *, grain_deg: float, compare_setting: bool
) -> MatchCurve:
    """The curve of a sample, and its proposal: the point nearest to `grain_deg`, in degrees.

    With `compare_setting` the sample's look is a setting that is compared with the curve.
    """
    material, own_sigma = sample.material, sample.look.sigma_n_deg
    reading = gloss_of(material, reference.gloss)
    sigmas = sorted({*SIGMAS_N_DEG, grain_deg, *([own_sigma] if compare_setting else [])})
    curve = tuple(matched_point(reference, material, sigma) for sigma in sigmas)
    solved = [point for point in curve if point.c is not None]
    return MatchCurve(
        sample=sample,
        reading=reading,
        ratio=reading / reference.reading,
        full_c=full_c(material),
        curve=curve,
        grain_deg=grain_deg,
        proposed=min(solved, key=lambda p: abs(p.sigma_n_deg - grain_deg), default=None),
        own_setting=_compared(reference, sample, curve) if compare_setting else None,
    )


def _on_form(sample: SampleLook, setup: Setup | None) -> Setup | None:
    """A setup with the form of a sample's pack."""
    if setup is None or sample.pack is None:
        return setup
    return dataclasses.replace(setup, shape=sample.pack.shape)


def _peak(setup: Setup, material: Material, sigma_n_deg: float) -> float | None:
    """L_s* at the highlight's brightest place; None where the highlight is not seen."""
    return pose_of(setup).peak(material, sigma_n_deg)


def _mean(values: Sequence[float]) -> float:
    """The geometric mean, since ratios are kept."""
    if min(values) <= 0.0:
        return 0.0
    return float(np.exp(np.mean(np.log(values))))


def _compared(
    reference: Reference, sample: SampleLook, curve: Sequence[CurvePoint]
) -> ComparedSetting:
    """The distances of a setting from the curve, along c and along sigma_N."""
    sigma, c = sample.look.sigma_n_deg, absolute_c(sample.look, sample.material)
    at_it = next(point for point in curve if point.sigma_n_deg == sigma)
    ratio = None
    if at_it.c:
        ratio = c / at_it.c * gloss_of(sample.material, reference.gloss) / reference.reading
    return ComparedSetting(
        sigma_n_deg=sigma,
        c=c,
        ratio=ratio,
        c_distance=None if at_it.c is None else c - at_it.c,
        sigma_n_distance_deg=min(
            (sigma - crossing for crossing in _crossings(curve, c)), key=abs, default=None
        ),
    )


def _crossings(curve: Sequence[CurvePoint], c: float) -> list[float]:
    """The sigma_N at which the curve has this c, between neighbours on a straight line."""
    crossings = []
    for a, b in itertools.pairwise(curve):
        if a.c is None or b.c is None or (a.c - c) * (b.c - c) > 0.0:
            continue
        share = 0.0 if a.c == b.c else (c - a.c) / (b.c - a.c)
        crossings.append(a.sigma_n_deg + share * (b.sigma_n_deg - a.sigma_n_deg))
    return crossings


def own_sigma_n_deg(name: str | None) -> float:
    """The graininess of a sample as far as it is known: that of the published setting, or 0."""
    return SAMPLES[name].sigma_n_deg if name in SAMPLES else 0.0


def as_numbers(reference: Reference, curves: Sequence[MatchCurve]) -> dict[str, Any]:
    """The reference and its matches as JSON holds them."""
    return {
        "gloss": reference.gloss,
        "lamp_azimuths_deg": [setup.lamp.azimuth_deg for setup in reference.setups],
        "reference": reference.as_numbers(),
        "samples": [
            {
                "label": m.sample.label,
                "name": m.sample.material.name,
                "source": m.sample.material.source,
                "gloss": m.reading,
                "ratio": m.ratio,
                "wanted": m.ratio * reference.displayed_gloss,
                "full_c": m.full_c,
                "curve": [_point_numbers(p, m.full_c) for p in m.curve],
                "grain_deg": m.grain_deg,
                "proposed": None if m.proposed is None else _point_numbers(m.proposed, m.full_c),
                "present": None if m.own_setting is None else dataclasses.asdict(m.own_setting),
                "warnings": list(m.sample.material.warnings),
            }
            for m in curves
        ],
    }


def _point_numbers(point: CurvePoint, full: float) -> dict[str, Any]:
    share = None if point.c is None else point.c / full
    return {
        **dataclasses.asdict(point),
        "refused": list(point.refused),
        "c_fraction": share,
        "spread": point.spread,
    }
