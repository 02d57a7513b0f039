"""Numbers of a displayed picture: how glossy it looks, and what became of the body's colour.

Defined in docs/operators.md. Which pixels count follows from the scene alone, so that they are the
same for every operator.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from relgloss_view.base.arrays import Array, Mask
from relgloss_view.base.interruptions import checkpoint
from relgloss_view.display.display import Display
from relgloss_view.display.model import DisplayModel
from relgloss_view.gloss import eye
from relgloss_view.material.cielab import lightness as lightness_of
from relgloss_view.operators.clip import Clip
from relgloss_view.operators.operator import Displayed, SceneLight
from relgloss_view.picture.frame import Frame
from relgloss_view.picture.model.difference import delta_e_2000

BRIGHT_QUANTILE = 0.99
HIGHLIGHT_LSTAR = 1.0  #: a highlight adds at least this much to L*, the body at most
HIGHLIGHT_GRAINS = 2.0  #: sd of the mean over grains by which highlight and body are parted
LIT_LSTAR = 1.0  #: below this L_d* there is no body colour to speak of
EYE_SD_DEG = 1.0 / 30.0  #: two arc minutes, a little more than the eye blurs
COVERING_LSTAR = 0.1  #: a peak contrast below this is no highlight that could cover anything
EDGE_GRAINS = 4.0  #: sd of the mean over grains that leaves edges; see tests/gloss/test_measures.py
GRAIN_REACH_DEG = 0.08  #: of the filter of graininess
BLUR_REACH = 3.0  #: standard deviations of a filter that must lie on the object
ORDER_TIE_LSTAR = 1.0  #: contrast glosses this close are a tie


@dataclass(frozen=True)
class Regions:
    """Which pixels of a picture show what, (H, W) each."""

    whole: Mask  #: the object covers all of the pixel
    body: Mask  #: diffuse, lit
    highlight: Mask  #: specular
    pixels_per_degree: float  #: of the drawn object, seen from the scene's eye
    grain_px: float  #: side of a grain, at least a pixel
    screen_pixels_per_degree: float = 60.0 / Display().pixel_arcmin  #: at the observer's eye
    grainy: bool = False  #: whether sigma_N is above 0

    @classmethod
    def of(cls, frame: Frame) -> Regions:
        """The regions of a frame; an L_s* of `HIGHLIGHT_LSTAR` parts body and highlight.

        It is a mean over a few grains: a dark grain in a highlight belongs to the highlight.
        """
        from scipy.ndimage import gaussian_filter

        whole = frame.coverage >= 1.0
        l_d, l_s = frame.split
        scale = SceneLight.of(frame).pixels_per_degree
        look, distance_m = frame.look, frame.scene.eye.distance_m
        pixel_arcmin = frame.scene.display.pixel_arcmin
        if look.grain == "screen":
            grain = float(look.grain_px)
        elif look.grain == "eye":
            grain = look.grain_arcmin / pixel_arcmin
        else:
            grain = math.degrees(math.atan(1e-3 * look.grain_mm / distance_m)) * scale
        grain = max(grain, 1.0)
        specular = gaussian_filter(np.asarray(l_s, dtype=np.float64), HIGHLIGHT_GRAINS * grain)
        shines = specular >= HIGHLIGHT_LSTAR
        body = whole & ~shines & (l_d >= LIT_LSTAR)
        grainy = any(sigma_n_deg > 0.0 for _, sigma_n_deg in frame.scene.parts(look))
        return cls(whole, body, whole & shines, scale, grain, 60.0 / pixel_arcmin, grainy)


@dataclass(frozen=True)
class Measures:
    """Numbers of one displayed picture; None where it has no pixel that they could be taken of."""

    contrast_gloss: float | None  #: L*
    peak_contrast: float | None  #: L*
    graininess: float | None  #: L*
    sharpness: float | None  #: L* per degree
    coverage: float | None  #: of the object's pixels
    clipped_share: float | None  #: of the object's pixels
    body_difference: float | None  #: CIEDE2000, median
    highlight: float | None = None  #: L*


def measure(frame: Frame, picture: Displayed) -> Measures:
    """All measures of what an operator made of a frame."""
    checkpoint()
    regions = Regions.of(frame)
    lightness = picture.lab[..., 0]
    on_object = frame.on_object
    return Measures(
        contrast_gloss(lightness, regions),
        peak_contrast(lightness, regions),
        graininess(lightness, regions),
        sharpness(lightness, regions),
        coverage(lightness, regions),
        float(np.mean(picture.clipped[on_object])) if np.any(on_object) else None,
        body_difference(picture, Clip().draw(frame), regions),
        highlight(lightness, frame, regions),
    )


def highlight(lightness: Array, frame: Frame, regions: Regions) -> float | None:
    """What the highlight adds to L* at its brightest pixel: L* less the diffuse part's.

    Of the split that is c L_s* (Ishii et al., eq. 2), whose ratio a match keeps. A diffuse part
    that is darker than the display's black is seen as that black, which is no highlight.
    """
    if not np.any(regions.whole):
        return None
    display = DisplayModel.of(frame.scene.display)
    black = lightness_of(display.xyz_from_rgb[1] @ display.darkest)
    body = np.maximum(frame.split[0], black)
    return float(np.max((lightness - body)[regions.whole]))


def contrast_gloss(lightness: Array, regions: Regions) -> float | None:
    """99th percentile of L* over the object less its median.

    Hunter's contrast gloss is highlight against surroundings; here as a difference of L*, since
    Ferwerda, Pellacini and Greenberg 2001 found it to follow a difference of cube roots. It does
    not see a highlight on less than a hundredth of the object; peak_contrast does.
    """
    if not np.any(regions.whole):
        return None
    low, high = np.quantile(lightness[regions.whole], (0.5, BRIGHT_QUANTILE))
    return float(high - low)


def peak_contrast(lightness: Array, regions: Regions) -> float | None:
    """Largest L* over the object, as sharp as the eye sees it, less the median.

    The same contrast of the highlight's peak, however small the highlight is.
    """
    from scipy.ndimage import gaussian_filter

    sd = EYE_SD_DEG * regions.pixels_per_degree
    inside = _away_from_edges(regions.whole, regions.whole, BLUR_REACH * sd)
    if not np.any(inside):
        return None
    blurred = gaussian_filter(lightness, sd, mode="nearest")
    return float(np.max(blurred[inside]) - np.median(lightness[regions.whole]))


def graininess(lightness: Array, regions: Regions) -> float | None:
    """Grain of the highlights as an observer sees it on the display, L*.

    It is the standard deviation of independent grains of 1.5 minutes of arc, the paper's pixel,
    that look as strong: L* is weighted by the eye's sensitivity to contrast (Mannos and Sakrison
    1974) with the display's pixel pitch and viewing distance. What varies along one axis only, as
    an upright highlight does, is no grain (after Immerkaer 1996).
    """
    scale = regions.screen_pixels_per_degree
    reach = GRAIN_REACH_DEG * scale
    inside = _away_from_edges(regions.highlight, regions.whole, reach)
    if not np.any(inside):
        return None
    seen = eye.seen_grain(eye.filled(lightness, regions.whole), scale)
    return float(np.sqrt(np.mean(seen[inside] ** 2))) / eye.reference_deviation()


def grain_deviation(lightness: Array, regions: Regions) -> float | None:
    """Standard deviation of L* from grain to grain, over the highlights, however small they are.

    It is taken around the grains' frequency: the band lies about one cycle in two grains, along
    both axes at once. What varies along one axis only, as an upright highlight does, is no grain
    (after Immerkaer 1996, whose mask does the same at one pixel). Normalised so that independent
    grains give their standard deviation, also where they are no whole number of pixels.
    """
    inside = _away_from_edges(regions.highlight, regions.whole, 2.0 * regions.grain_px)
    if not np.any(inside):
        return None
    band = lightness
    for axis in (0, 1):
        band = _grain_band(band, regions.grain_px, axis)
    deviation = float(np.sqrt(np.mean(band[inside] ** 2)))
    return deviation / _grain_response(regions.grain_px)


def _grain_response(grain_px: float) -> float:
    """Variance along one axis that the band leaves of independent grains of variance one.

    A grain whose side is no whole number of pixels covers sometimes one pixel more than at other
    times.
    """
    count = 200
    ends = np.floor(grain_px * np.arange(count + 1) + 0.5).astype(int)
    lengths = np.diff(ends)
    power = 0.0
    for length in np.unique(lengths):
        one = np.zeros(length + 2 * (8 * math.ceil(grain_px) + 1))
        start = (len(one) - length) // 2
        one[start : start + length] = 1.0
        power += np.sum(lengths == length) * float(np.sum(_grain_band(one, grain_px, 0) ** 2))
    return power / float(ends[-1] - ends[0])


def _grain_band(values: Array, grain_px: float, axis: int) -> Array:
    from scipy.ndimage import gaussian_filter1d

    fine, coarse = (
        gaussian_filter1d(values, share * grain_px, axis=axis, mode="nearest")
        for share in (0.35, 0.7)
    )
    return np.asarray(fine - coarse)


def sharpness(lightness: Array, regions: Regions) -> float | None:
    """Largest slope of L* in and beside the highlights, in L* per degree of the eye's field.

    The picture is blurred by two arc minutes first, since a slope finer than that is not seen and
    depends on where pixels fall. Where the surface has grain, the blur spans some grains: a grain's
    slopes point all ways and cancel, an edge's do not. So grain does not pass for sharpness.
    """
    from scipy.ndimage import binary_dilation, gaussian_filter

    sd = EYE_SD_DEG * regions.pixels_per_degree
    if regions.grainy:
        sd = max(sd, EDGE_GRAINS * regions.grain_px)
    reach = max(1, math.ceil(BLUR_REACH * sd))
    near = binary_dilation(regions.highlight, iterations=reach)
    inside = _away_from_edges(near & regions.whole, regions.whole, BLUR_REACH * sd)
    if not (np.any(inside) and min(lightness.shape) > 1):
        return None
    down, right = np.gradient(gaussian_filter(lightness, sd, mode="nearest"))
    return float(np.max(np.hypot(down, right)[inside])) * regions.pixels_per_degree


def coverage(lightness: Array, regions: Regions) -> float | None:
    """Share of the object's pixels that are as bright as the highlight's flank or brighter.

    The flank lies halfway between the median L* and the peak as the eye sees it. Marlow, Kim and
    Anderson 2012: gloss follows contrast, sharpness and coverage of highlights.
    """
    from scipy.ndimage import gaussian_filter

    contrast = peak_contrast(lightness, regions)
    if contrast is None or contrast < COVERING_LSTAR:
        return None if contrast is None else 0.0
    blurred = gaussian_filter(lightness, EYE_SD_DEG * regions.pixels_per_degree, mode="nearest")
    flank = float(np.median(lightness[regions.whole])) + 0.5 * contrast
    return float(np.mean(blurred[regions.whole] >= flank))


def _away_from_edges(region: Mask, whole: Mask, reach_px: float) -> Mask:
    """The part of a region where a filter of this reach sees nothing but the object."""
    from scipy.ndimage import binary_erosion

    steps = max(1, math.ceil(reach_px))
    return np.asarray(region & binary_erosion(whole, iterations=steps))


def body_difference(picture: Displayed, colorimetric: Displayed, regions: Regions) -> float | None:
    """Median CIEDE2000 difference of the body from its colorimetric reproduction, both as shown."""
    if not np.any(regions.body):
        return None
    difference = delta_e_2000(picture.lab[regions.body], colorimetric.lab[regions.body])
    return float(np.median(difference))


def ranks(values: Mapping[str, float], tie: float = 0.0) -> dict[str, int]:
    """Rank of each value, 0 the largest; neighbours in the order closer than `tie` share one.

    The names come in order of rank.
    """
    names = sorted(values, key=lambda name: -values[name])
    by_name: dict[str, int] = {}
    rank = 0
    for k, name in enumerate(names):
        if k and (gap := values[names[k - 1]] - values[name]) > 0.0 and gap >= tie:
            rank = k
        by_name[name] = rank
    return by_name


@dataclass(frozen=True)
class Agreement:
    """How two orders of the same things agree."""

    tau: float | None  #: Kendall's tau-b, 1 the same order; None where one of them is all ties
    same: bool  #: no pair that differs in truth is exchanged or tied


def agreement(displayed: Mapping[str, float], truth: Mapping[str, float], tie: float) -> Agreement:
    """Whether displayed values have the order of the true ones; `tie` is of the displayed."""
    from scipy.stats import kendalltau

    names = list(truth)
    first, second = ranks(displayed, tie), ranks(truth)
    pairs = [(first[name], second[name]) for name in names]
    if len({a for a, _ in pairs}) < 2 or len({b for _, b in pairs}) < 2:
        return Agreement(None, False)
    tau = float(kendalltau(*zip(*pairs, strict=True)).statistic)
    same = all((a[0] < b[0]) == (a[1] < b[1]) for a in pairs for b in pairs if a[1] != b[1])
    return Agreement(tau, same)
