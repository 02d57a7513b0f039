"""Ward Larson, Rushmeier and Piatko 1997: the histogram equalised, but never beyond visibility."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.parameters import choice, parameter
from relgloss_view.operators.operator import SceneLight
from relgloss_view.operators.point import Curve, PointOperator

BINS = 100
TRIMMED_SHARE = 0.025  #: of the samples may be above the ceiling when the loop ends
DARKEST_CD_M2 = 1e-7  #: below it nothing is seen
TOP_MARGIN = math.log(1.01)  #: so that the brightest sample falls into the last bin


def visible_difference(adaptation_cd_m2: Array) -> Array:
    """Just noticeable luminance difference in cd/m2, rods and cones (Ferwerda et al. 1996).

    Joined into one function as Ward Larson et al. 1997 do.
    """
    log = np.log10(np.maximum(adaptation_cd_m2, 1e-12))
    rods = np.maximum(0.405 * log + 1.6, 0.0) ** 2.18 - 2.86
    cones = np.maximum(0.249 * log + 0.65, 0.0) ** 2.7 - 0.72
    regions = [log < -3.94, log < -1.44, log < -0.0184, log < 1.9]
    log_difference = np.select(
        regions, [np.full(log.shape, -2.86), rods, log - 0.395, cones], log - 1.255
    )
    return np.asarray(10.0**log_difference)


@dataclass(frozen=True)
class ToneCurve:
    """Log luminance of the scene to a share of the display's log range."""

    low: float  #: natural log cd/m2 of the darkest sample
    high: float
    cumulative: Array  #: (BINS + 1,), 0 to 1

    def share(self, log_luminance: Array) -> Array:
        """0 at and below the darkest sample, 1 at and above the brightest."""
        places = np.linspace(self.low, self.high, BINS + 1)
        return np.asarray(np.interp(log_luminance, places, self.cumulative))


def adjusted_curve(
    samples: Array, weights: Array, display_log: tuple[float, float], *, human: bool
) -> ToneCurve | None:
    """The curve of a scene's adaptation luminances, log cd/m2 (N,); None where a factor serves.

    Counts above the ceiling are cut until few are. The linear ceiling forbids a display contrast
    above the scene's; the human one a contrast more visible than in the scene (Ward Larson et al.
    1997). Where the display holds the whole range, a factor alone does it.
    """
    low, high = float(np.min(samples)), float(np.max(samples)) + TOP_MARGIN
    range_log = display_log[1] - display_log[0]
    if high - low <= range_log:
        return None
    counts, edges = np.histogram(samples, BINS, (low, high), weights=weights)
    counts = counts.astype(np.float64)
    middles, width, total = 0.5 * (edges[1:] + edges[:-1]), (high - low) / BINS, np.sum(counts)
    while True:
        left = float(np.sum(counts))
        if left <= TRIMMED_SHARE * total:
            return None
        curve = ToneCurve(low, high, np.concatenate([[0.0], np.cumsum(counts) / left]))
        ceiling = np.full(BINS, left * width / range_log)
        if human:
            displayed = np.exp(display_log[0] + range_log * curve.share(middles))
            seen = np.exp(middles)
            ceiling *= visible_difference(displayed) / visible_difference(seen) * seen / displayed
        above = np.maximum(counts - ceiling, 0.0)
        if np.sum(above) <= TRIMMED_SHARE * total:
            return curve
        counts = counts - above


def foveal_samples(light: SceneLight) -> tuple[Array, Array]:
    """Mean luminance of the object in squares of one degree, cd/m2, and their pixels on it."""
    side = max(1, round(light.pixels_per_degree))
    luminance = light.luminance
    share = np.where(luminance > 0.0, light.coverage.astype(np.float64), 0.0)
    rows, columns = (np.arange(0, n, side) for n in share.shape)

    def sums(values: Array) -> Array:
        return np.asarray(np.add.reduceat(np.add.reduceat(values, rows, 0), columns, 1))

    held = sums(share)
    some = held > 0.0
    return sums(share * luminance)[some] / held[some], held[some]


@dataclass(frozen=True)
class WardHistogram(PointOperator):
    """Equalises log luminance under a ceiling; without the paper's glare, acuity and colour loss.

    The curve is that of the author's program (Radiance, pcond): its display is drawn from black,
    and where the display holds the scene's range the log mean goes to the middle of the display's.
    The adaptation samples are means of one degree, as in the paper, of the object alone;
    pixels brighter than the brightest mean are white. 'pixels' takes each pixel, so that highlights
    narrower than a degree are samples too, as later versions of the program do.
    """

    name: ClassVar[str] = "ward-histogram"
    title: ClassVar[str] = "Ward, histogram adjustment"
    meaning: ClassVar[str] = "spends the display's range where the scene has pixels, to a ceiling"
    source: ClassVar[str] = (
        "Ward Larson, Rushmeier and Piatko 1997, IEEE Trans. Visualization and Computer Graphics 3"
    )

    contrast: float = parameter(100.0, 2.0, 1e6, "", "contrast of the display, white over black")
    ceiling: str = choice(
        "linear",
        ("linear", "human"),
        "largest contrast: the scene's own, or the one that the eye sees in it",
    )
    samples: str = choice(
        "foveal",
        ("foveal", "pixels"),
        "samples that the eye adapts to: means of one degree, or pixels",
    )

    def curve(self, luminance: Array, light: SceneLight) -> Curve:
        """See PointOperator."""
        if self.samples == "foveal":
            adaptation, weights = foveal_samples(light)
        else:
            whole = light.luminance
            lit = light.on_object & (whole > 0.0)
            adaptation, weights = whole[lit], light.coverage[lit].astype(np.float64)
        samples = np.log(np.maximum(adaptation, DARKEST_CD_M2))
        white = self.white_cd_m2(light)
        top = math.log(white)
        display_log = (top - math.log(self.contrast), top)
        human = self.ceiling == "human"
        tone_curve = adjusted_curve(samples, weights, display_log, human=human)
        if tone_curve is None:
            factor = self._factor(samples, weights, display_log) / white
            return lambda luminance: luminance * factor

        def shown(luminance: Array) -> Array:
            share = tone_curve.share(np.log(np.maximum(luminance, DARKEST_CD_M2)))
            # The display's black is shown as nothing, as the author's program does.
            luminance_out = (
                np.exp((share - 1.0) * (display_log[1] - display_log[0])) - 1.0 / self.contrast
            )
            return np.asarray(luminance_out / (1.0 - 1.0 / self.contrast))

        return shown

    def _factor(self, samples: Array, weights: Array, display_log: tuple[float, float]) -> float:
        """Display luminance over scene luminance."""
        middle = math.exp(0.5 * sum(display_log))
        mean = math.exp(float(np.average(samples, weights=weights)))
        if self.ceiling == "human":
            seen = visible_difference(np.array([middle, mean]))
            return float(seen[0] / seen[1])
        return middle / mean
