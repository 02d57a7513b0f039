"""Settings that give the same gloss ratio to a reference picture as the materials have.

Relative-glossiness matching (Ishii et al.): R = G_1 / G~_1 is seen on the reference, and a picture
of sample i shows the right gloss where G_i = R G~_i. Here all four are computed: the G of the
materials as a gloss meter would read them, the G~ of the pictures by a contrast. Defined in
docs/match.md.
"""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.base.terminal import ProgressReport, no_progress
from relgloss_view.gloss.samples import DEFAULT_GLOSS, SampleLook, computed_gloss
from relgloss_view.gloss.shown import Regions, contrast_gloss, peak_contrast
from relgloss_view.picture.frame import Frame
from relgloss_view.picture.scene.scene import Scene

if TYPE_CHECKING:
    from relgloss_view.quality.backends import FrameRenderer

SIGMAS_N_DEG = tuple(0.25 * k for k in range(13))  #: the paper's range, twice as fine
MEASURES: dict[str, Callable[[Array, Regions], float | None]] = {
    "peak-contrast": peak_contrast,
    "contrast-gloss": contrast_gloss,
}
DEFAULT_MEASURE = "peak-contrast"  #: the other does not see narrow highlights
C_TOLERANCE = 1e-4  #: of c_max


@dataclass(frozen=True)
class Criterion:
    """The two glosses whose ratios are held equal: of the materials and of their pictures."""

    gloss: str = DEFAULT_GLOSS  #: of a material, one of GLOSSES
    measure: str = DEFAULT_MEASURE  #: of a picture, one of MEASURES

    @property
    def measure_words(self) -> str:
        """The measure as people read it."""
        return self.measure.replace("-", " ")


class DisplayedGloss:
    """The gloss that the split displays of a frame, in L*, as a function of c."""

    def __init__(self, frame: Frame, measure: str) -> None:
        self.c_max = frame.c_max
        self._lightness = tuple(np.asarray(part, dtype=np.float64) for part in frame.split)
        self._regions = Regions.of(frame)
        self._measure = MEASURES[measure]
        self._of_body = self._measured(0.0)

    def __call__(self, c: float) -> float:
        """The measure less that of c = 0, because a body without a highlight has no gloss."""
        return self._measured(c) - self._of_body

    def _measured(self, c: float) -> float:
        l_d, l_s = self._lightness
        contrast = self._measure(np.minimum(l_d + c * l_s, 100.0), self._regions)
        if contrast is None:
            raise InputError("too little of the object is seen to measure its gloss")
        return contrast


@dataclass(frozen=True)
class CurvePoint:
    """The c that gives the wanted gloss at one sigma_N."""

    sigma_n_deg: float
    c: float | None  #: None where no c up to c_max gives it
    c_max: float | None
    most: float  #: displayed gloss at c_max, L*

    @property
    def c_fraction(self) -> float | None:
        """c as a share of c_max."""
        return None if self.c is None or not self.c_max else self.c / self.c_max


@dataclass(frozen=True)
class ComparedSetting:
    """A sample's own setting, compared with the curve."""

    sigma_n_deg: float
    c: float
    c_fraction: float | None
    displayed_gloss: float  #: L*
    c_distance: float | None  #: c less the curve's at the same sigma_N; None where it has none
    fraction_distance: float | None  #: the same in shares of c_max
    sigma_n_distance_deg: float | None  #: sigma_N less the curve's nearest at the same c


@dataclass(frozen=True)
class Reference:
    """The reference picture and its gloss, by the criterion that every match to it uses."""

    sample: SampleLook
    criterion: Criterion
    gloss: float  #: of the material
    displayed_gloss: float  #: of the picture, L*
    c: float


@dataclass(frozen=True)
class Match:
    """The settings of one sample that keep its ratio to the reference."""

    sample: SampleLook
    gloss: float  #: of the material
    wanted: float  #: displayed gloss that keeps the ratio, L*
    curve: tuple[CurvePoint, ...]  #: by sigma_N
    grain_deg: float  #: the sigma_N that looks like the sample's own grain
    proposed: CurvePoint | None  #: the curve's nearest to it
    own_setting: ComparedSetting | None  #: None where the sample came without a setting


def reference_of(
    renderer: FrameRenderer,
    sample: SampleLook,
    scene: Scene,
    size: tuple[int, int],
    criterion: Criterion,
) -> Reference:
    """Draw the reference picture and measure it; InputError where it or its material has no gloss.

    `scene` gives all but the material; `size` is (width, height) in pixels.
    """
    frame = _drawn(renderer, sample, scene, size, sample.look.sigma_n_deg)
    real = computed_gloss(sample.material)[criterion.gloss]
    displayed = DisplayedGloss(frame, criterion.measure)(frame.c)
    if not real or displayed <= 0.0:
        raise InputError(
            f"{printable(sample.label)}: shows no gloss, so no ratio to it can be kept; choose "
            "another --reference"
        )
    return Reference(sample, criterion, real, displayed, frame.c)


def match(
    renderer: FrameRenderer,
    reference: Reference,
    sample: SampleLook,
    scene: Scene,
    size: tuple[int, int],
    *,
    grain_deg: float,
    compare_setting: bool,
    progress: ProgressReport = no_progress,
) -> Match:
    """The curve of a sample, and its proposal: the point nearest to `grain_deg`, in degrees.

    With `compare_setting` the sample's look is a setting that is compared with the curve. `scene`
    and `size` as for reference_of.
    """
    criterion = reference.criterion
    real = computed_gloss(sample.material)[criterion.gloss] or 0.0
    wanted = reference.displayed_gloss * real / reference.gloss
    own_sigma = sample.look.sigma_n_deg
    sigmas = sorted({*SIGMAS_N_DEG, grain_deg, *([own_sigma] if compare_setting else [])})
    curve, own = [], None
    for k, sigma in enumerate(sigmas):
        progress(k / len(sigmas), f"{sample.label}, sigma_N {sigma:g}")
        frame = _drawn(renderer, sample, scene, size, sigma)
        displayed = DisplayedGloss(frame, criterion.measure)
        curve.append(_point(sigma, displayed, wanted))
        if compare_setting and sigma == own_sigma:
            own = (frame.c, displayed(frame.c), curve[-1])
    solved = [point for point in curve if point.c is not None]
    proposed = min(solved, key=lambda p: abs(p.sigma_n_deg - grain_deg), default=None)
    own_setting = None if own is None else _compared(*own, curve)
    return Match(
        sample=sample,
        gloss=real,
        wanted=wanted,
        curve=tuple(curve),
        grain_deg=grain_deg,
        proposed=proposed,
        own_setting=own_setting,
    )


def _drawn(
    renderer: FrameRenderer,
    sample: SampleLook,
    scene: Scene,
    size: tuple[int, int],
    sigma_n_deg: float,
) -> Frame:
    look = dataclasses.replace(sample.look, sigma_n_deg=sigma_n_deg)
    return renderer.render(dataclasses.replace(scene, material=sample.material), look, size)


def _point(sigma_n_deg: float, displayed: DisplayedGloss, wanted: float) -> CurvePoint:
    from scipy.optimize import brentq

    c_max = displayed.c_max
    if not c_max:
        return CurvePoint(sigma_n_deg, None, c_max, 0.0)
    most = displayed(c_max)
    if wanted > most:
        return CurvePoint(sigma_n_deg, None, c_max, most)
    if wanted <= 0.0:
        return CurvePoint(sigma_n_deg, 0.0, c_max, most)
    c = brentq(lambda c: displayed(c) - wanted, 0.0, c_max, xtol=C_TOLERANCE * c_max)
    return CurvePoint(sigma_n_deg, float(c), c_max, most)


def _compared(
    c: float, displayed_gloss: float, at_it: CurvePoint, curve: Sequence[CurvePoint]
) -> ComparedSetting:
    """The distances of a setting from the curve, along c and along sigma_N."""
    fraction = c / at_it.c_max if at_it.c_max else None
    along = None if at_it.c is None else c - at_it.c
    share = None if along is None or not at_it.c_max else along / at_it.c_max
    sigma = at_it.sigma_n_deg
    across = [sigma - crossing for crossing in _crossings(curve, c)]
    nearest = min(across, key=abs, default=None)
    return ComparedSetting(
        sigma_n_deg=sigma,
        c=c,
        c_fraction=fraction,
        displayed_gloss=displayed_gloss,
        c_distance=along,
        fraction_distance=share,
        sigma_n_distance_deg=nearest,
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


def as_numbers(reference: Reference, matches: Sequence[Match]) -> dict[str, Any]:
    """The reference and its matches as JSON holds them."""
    return {
        "gloss": reference.criterion.gloss,
        "measure": reference.criterion.measure,
        "reference": {
            "label": reference.sample.label,
            "name": reference.sample.material.name,
            "sigma_n_deg": reference.sample.look.sigma_n_deg,
            "c": reference.c,
            "gloss": reference.gloss,
            "shown": reference.displayed_gloss,
        },
        "samples": [
            {
                "label": m.sample.label,
                "name": m.sample.material.name,
                "source": m.sample.material.source,
                "gloss": m.gloss,
                "ratio": m.gloss / reference.gloss,
                "wanted": m.wanted,
                "curve": [_point_numbers(p) for p in m.curve],
                "grain_deg": m.grain_deg,
                "proposed": None if m.proposed is None else _point_numbers(m.proposed),
                "present": None if m.own_setting is None else _setting_numbers(m.own_setting),
                "warnings": list(m.sample.material.warnings),
            }
            for m in matches
        ],
    }


def _point_numbers(point: CurvePoint) -> dict[str, Any]:
    return {**dataclasses.asdict(point), "c_fraction": point.c_fraction}


def _setting_numbers(setting: ComparedSetting) -> dict[str, Any]:
    numbers = dataclasses.asdict(setting)
    return {"shown" if key == "displayed_gloss" else key: v for key, v in numbers.items()}
