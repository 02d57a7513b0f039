"""Settings whose displayed gloss stands to a reference picture's as the materials' glosses do.

Relative-glossiness matching (Ishii et al.): R = G_1 / G~_1 is seen on the reference, and a picture
of sample i shows it right where G_i = R G~_i. Here the G are computed: G of the materials by a
gloss meter's geometry, G~ of the pictures by a contrast. Defined in docs/match.md.
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
from relgloss_view.gloss.comparison import Case, computed_gloss
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


class ShownGloss:
    """The gloss that the split shows of a frame, as a function of c."""

    def __init__(self, frame: Frame, measure: str) -> None:
        self.c_max = frame.c_max
        self._lightness = tuple(np.asarray(part, dtype=np.float64) for part in frame.split)
        self._regions = Regions.of(frame)
        self._measure = MEASURES[measure]
        self._without = self._measured(0.0)

    def __call__(self, c: float) -> float:
        """The measure less that of c = 0: a body without highlight has no gloss. L*."""
        return self._measured(c) - self._without

    def _measured(self, c: float) -> float:
        l_d, l_s = self._lightness
        found = self._measure(np.minimum(l_d + c * l_s, 100.0), self._regions)
        if found is None:
            raise InputError("too little of the object is seen to measure its gloss")
        return found


@dataclass(frozen=True)
class Point:
    """A place of the curve: what c gives the wanted gloss at a sigma_N."""

    sigma_n_deg: float
    c: float | None  #: None where no c up to c_max gives it
    c_max: float | None
    most: float  #: gloss shown at c_max, L*

    @property
    def c_fraction(self) -> float | None:
        """c as a share of c_max."""
        return None if self.c is None or not self.c_max else self.c / self.c_max


@dataclass(frozen=True)
class Present:
    """A setting that is there already, against the curve."""

    sigma_n_deg: float
    c: float
    c_fraction: float | None
    shown: float  #: gloss, L*
    c_distance: float | None  #: c less the curve's at the same sigma_N; None where that has none
    fraction_distance: float | None  #: the same in shares of c_max
    sigma_n_distance_deg: float | None  #: sigma_N less the curve's nearest at the same c


@dataclass(frozen=True)
class Reference:
    """The reference picture and what it shows."""

    case: Case
    gloss: float  #: of the material
    shown: float  #: of the picture, L*
    c: float


@dataclass(frozen=True)
class Match:
    """The settings of one sample that keep its ratio to the reference."""

    case: Case
    gloss: float  #: of the material
    wanted: float  #: of the picture, L*
    curve: tuple[Point, ...]
    grain_deg: float  #: the sigma_N that the sample's own grain is taken to have
    proposed: Point | None  #: the curve's nearest to it
    present: Present | None


def reference_of(
    renderer: FrameRenderer, case: Case, scene: Scene, size: tuple[int, int], gloss: str, by: str
) -> Reference:
    """Draw the reference picture and take its gloss; InputError where it shows or has none."""
    frame = _drawn(renderer, case, scene, size, case.look.sigma_n_deg)
    real, shown = computed_gloss(case.material)[gloss], ShownGloss(frame, by)(frame.c)
    if not real or shown <= 0.0:
        raise InputError(
            f"{printable(case.label)}: shows no gloss, so no ratio to it can be kept; choose "
            "another --reference"
        )
    return Reference(case, real, shown, frame.c)


def match(
    renderer: FrameRenderer,
    reference: Reference,
    case: Case,
    scene: Scene,
    size: tuple[int, int],
    *,
    gloss: str,
    by: str,
    grain_deg: float,
    settled: bool,
    progress: ProgressReport = no_progress,
) -> Match:
    """The curve of a sample; with `settled` its look is a setting to be held against the curve."""
    real = computed_gloss(case.material)[gloss] or 0.0
    wanted = reference.shown * real / reference.gloss
    look = case.look
    sigmas = sorted({*SIGMAS_N_DEG, grain_deg, *([look.sigma_n_deg] if settled else [])})
    curve, present = [], None
    for k, sigma in enumerate(sigmas):
        progress(k / len(sigmas), f"{case.label}, sigma_N {sigma:g}")
        frame = _drawn(renderer, case, scene, size, sigma)
        shown = ShownGloss(frame, by)
        curve.append(_point(sigma, shown, wanted))
        if settled and sigma == look.sigma_n_deg:
            present = (frame.c, shown(frame.c), curve[-1])
    solved = [point for point in curve if point.c is not None]
    proposed = min(solved, key=lambda p: abs(p.sigma_n_deg - grain_deg), default=None)
    found = None if present is None else _present(*present, curve)
    return Match(case, real, wanted, tuple(curve), grain_deg, proposed, found)


def _drawn(
    renderer: FrameRenderer, case: Case, scene: Scene, size: tuple[int, int], sigma_n_deg: float
) -> Frame:
    look = dataclasses.replace(case.look, sigma_n_deg=sigma_n_deg)
    return renderer.render(dataclasses.replace(scene, material=case.material), look, size)


def _point(sigma_n_deg: float, shown: ShownGloss, wanted: float) -> Point:
    from scipy.optimize import brentq

    c_max = shown.c_max
    if not c_max:
        return Point(sigma_n_deg, None, c_max, 0.0)
    most = shown(c_max)
    if wanted > most:
        return Point(sigma_n_deg, None, c_max, most)
    if wanted <= 0.0:
        return Point(sigma_n_deg, 0.0, c_max, most)
    c = brentq(lambda c: shown(c) - wanted, 0.0, c_max, xtol=C_TOLERANCE * c_max)
    return Point(sigma_n_deg, float(c), c_max, most)


def _present(c: float, shown: float, at_it: Point, curve: Sequence[Point]) -> Present:
    """The distances of a setting from the curve, along c and along sigma_N."""
    fraction = c / at_it.c_max if at_it.c_max else None
    along = None if at_it.c is None else c - at_it.c
    share = None if along is None or not at_it.c_max else along / at_it.c_max
    crossings = _crossings(curve, c)
    sigma = at_it.sigma_n_deg
    across = [sigma - crossing for crossing in crossings]
    nearest = min(across, key=abs, default=None)
    return Present(sigma, c, fraction, shown, along, share, nearest)


def _crossings(curve: Sequence[Point], c: float) -> list[float]:
    """The sigma_N at which the curve has this c, between neighbours on a straight line."""
    found = []
    for a, b in itertools.pairwise(curve):
        if a.c is None or b.c is None or (a.c - c) * (b.c - c) > 0.0:
            continue
        share = 0.0 if a.c == b.c else (c - a.c) / (b.c - a.c)
        found.append(a.sigma_n_deg + share * (b.sigma_n_deg - a.sigma_n_deg))
    return found


def as_numbers(
    reference: Reference, matches: Sequence[Match], gloss: str, by: str
) -> dict[str, Any]:
    """Matches as JSON holds them."""
    return {
        "gloss": gloss,
        "measure": by,
        "reference": {
            "label": reference.case.label,
            "name": reference.case.material.name,
            "sigma_n_deg": reference.case.look.sigma_n_deg,
            "c": reference.c,
            "gloss": reference.gloss,
            "shown": reference.shown,
        },
        "samples": [
            {
                "label": m.case.label,
                "name": m.case.material.name,
                "source": m.case.material.source,
                "gloss": m.gloss,
                "ratio": m.gloss / reference.gloss,
                "wanted": m.wanted,
                "curve": [_as_numbers(p) for p in m.curve],
                "grain_deg": m.grain_deg,
                "proposed": None if m.proposed is None else _as_numbers(m.proposed),
                "present": None if m.present is None else dataclasses.asdict(m.present),
                "warnings": list(m.case.material.warnings),
            }
            for m in matches
        ],
    }


def _as_numbers(point: Point) -> dict[str, Any]:
    return {**dataclasses.asdict(point), "c_fraction": point.c_fraction}
