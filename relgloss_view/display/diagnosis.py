"""What readings of a display show beside the fit: its faults, the file's, and the reading's.

`refuse_unusable` looks at the readings alone, before a fit that could not be one. `diagnose` names
what a fit must not pass over in silence.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.errors import InputError
from relgloss_view.base.words import listed
from relgloss_view.display.candidates import Fitted
from relgloss_view.display.faults import (
    CHANNELS,
    additivity,
    clipped,
    crushed,
    drift,
    exchanged,
)
from relgloss_view.display.fitted_monitor import DARK
from relgloss_view.display.readings import FULL_SCALES, Readings, white_of

if TYPE_CHECKING:
    from relgloss_view.display.fit import DisplayFit

MOST_PATCHES = 10_000
FEWEST_COLOURS = 8  #: different digital values; fewer carry no matrix, black and curves
FEW_COLOURS = 30
PURE = 0.1  #: another channel's light beside that of a primary, as digital value
USUAL_WHITES = (50.0, 3000.0)  #: cd/m2; of a monitor to work at
FOOT_LAMBERT_WHITES = (10.0, 50.0)
WHITE_XY = ((0.22, 0.42), (0.22, 0.45))  #: of 3,500 K to beyond 20,000 K and what lies beside
NOISY = 0.03  #: share of a reading, by which a meter that is fit for it is not off


@dataclass(frozen=True)
class Finding:
    """A warning: a whole sentence with the step that mends it; grave: whether the fit is poor."""

    text: str
    grave: bool = True


def refuse_unusable(readings: Readings) -> None:
    """Raise InputError where the readings can't carry a model: one line with the remedy."""
    digital, xyz, source = readings.rgb, readings.xyz, readings.source
    if readings.count > MOST_PATCHES:
        raise InputError(f"{source}: more than {MOST_PATCHES} patches; measure fewer")
    colours = np.unique(digital.round(6), axis=0)
    if len(colours) < FEWEST_COLOURS:
        raise InputError(
            f"{source}: {len(colours)} different colours; a model needs at least {FEWEST_COLOURS}, "
            "and a good one about 100: measure more patches"
        )
    top = float(np.abs(xyz).max())
    if not 0.0 < top < 1e9:
        raise InputError(f"{source}: X, Y and Z up to {top:g}; expected the light of a display")
    below = xyz < -0.02 * float(np.max(xyz[:, 1]))
    if np.any(below):
        k = int(np.argmax(below.any(axis=1)))
        raise InputError(
            f"{source}: {readings.places[k]}: X, Y, Z = {_numbers(xyz[k])}; light is not below 0. "
            "Where the columns hold CIELAB, export XYZ"
        )
    if np.all(np.ptp(colours, axis=1) < 1e-6):
        raise InputError(
            f"{source}: all patches are gray, so that nothing shows the primaries; measure red, "
            "green and blue ramps too"
        )
    design = np.concatenate([np.ones((len(digital), 1)), digital**2.2], axis=1)
    if np.linalg.matrix_rank(design, tol=1e-3 * np.sqrt(len(design))) < 4:
        raise InputError(
            f"{source}: R, G and B do not change apart from each other, so that nothing shows the "
            "primaries; measure red, green and blue ramps too"
        )
    _refuse_other_columns(readings)


def _refuse_other_columns(readings: Readings) -> None:
    """Raise InputError where X, Y and Z are something else."""
    xyz, source = readings.xyz, readings.source
    bright = xyz[int(np.argmax(readings.rgb.sum(axis=1)))]
    if bright[1] <= 0.0 or white_of(xyz, readings.rgb) <= 0.0:
        raise InputError(
            f"{source}: white has X, Y, Z = {_numbers(bright)}, without luminance; the columns "
            "hold something else, such as CIELAB: export XYZ"
        )
    lit = xyz[xyz[:, 1] > 0.01 * xyz[:, 1].max()]
    if np.all(lit[:, :2] <= 1.0) and np.all(lit[:, 0] + lit[:, 1] <= 1.001) and bright[2] > 1.5:
        raise InputError(
            f"{source}: X and Y stay below 1 beside Z up to {bright[2]:g}: these are x, y and Y; "
            "name the columns x, y, Y"
        )
    if np.corrcoef(readings.rgb.sum(axis=1), np.cbrt(np.maximum(xyz[:, 1], 0.0)))[0, 1] < 0.2:
        raise InputError(
            f"{source}: the readings do not rise with R, G and B; the rows or the columns are in "
            "another order than the patches were shown"
        )


def diagnose(
    readings: Readings, fit: DisplayFit, kept: Array, fine: Fitted, whitening: Array
) -> list[Finding]:
    """All findings. kept: patches that were fitted. fine: the finest candidate. whitening: of
    the kept patches."""
    digital, xyz = readings.rgb[kept], readings.xyz[kept]
    unsteady = fit.noise.digital
    return [
        *_of_channels(fit),
        *_of_additivity(fit.model, digital, xyz, whitening, unsteady),
        *_of_ends(digital, xyz, whitening, unsteady, fine),
        *_of_unit(readings, fit),
        *_of_white(fit),
        *_of_coverage(readings),
        *_of_repeats(readings, fit, kept),
    ]


def _of_channels(fit: DisplayFit) -> list[Finding]:
    order = exchanged(fit.model.matrix)
    if order == (0, 1, 2):
        return []
    pairs = [f"{CHANNELS[k]} shows {CHANNELS[order[k]]}" for k in range(3) if order[k] != k]
    return [
        Finding(
            f"Channels are exchanged: {listed(pairs)}. Every hue would be wrong: put the columns "
            "R, G, B and X, Y, Z in order, or check the display's cable and settings, and measure "
            "again."
        )
    ]


def _of_additivity(
    model: Fitted, digital: Array, xyz: Array, whitening: Array, unsteady: float
) -> list[Finding]:
    found = additivity(model, digital, xyz, whitening, unsteady)
    if found is None:
        return []
    colour, share = found
    if share < 0.0:
        why = (
            f"The channels do not add: {colour} is about {-100.0 * share:.0f} % darker than its "
            "channels alone together, as OLED and HDR displays are that limit their power"
        )
        mend = "switch brightness limiting, HDR and local dimming off, or show small patches"
    else:
        why = (
            f"The channels do not add: {colour} is about {100.0 * share:.0f} % brighter than "
            "its channels alone together, as displays with a white subpixel (RGBW) and vivid modes "
            "are"
        )
        mend = "choose the display's sRGB or reference mode"
    return [
        Finding(
            f"{why}. No model of channels fits it, and highlights would be wrong: {mend}, and "
            "measure again; else use a look-up-table profile."
        )
    ]


def _of_ends(
    digital: Array, xyz: Array, whitening: Array, unsteady: float, fine: Fitted
) -> list[Finding]:
    findings = []
    tops = clipped(digital, xyz, whitening, unsteady, fine)
    if tops:
        level = min(tops.values())
        findings.append(
            Finding(
                f"Whites are clipped: above {100.0 * level:.0f} % of the scale of "
                f"{listed([CHANNELS[k] for k in tops])} the light stays the same. "
                "Highlights lose their steps: lower the display's contrast setting, or set its "
                "input range to full (0 to 255), and measure again."
            )
        )
    bottoms = crushed(digital, xyz, whitening, unsteady, fine)
    if bottoms:
        level = max(bottoms.values())
        findings.append(
            Finding(
                f"Blacks are crushed: below {100.0 * level:.0f} % of the scale of "
                f"{listed([CHANNELS[k] for k in bottoms])} no light is added. Dark "
                "tones are lost: raise the display's brightness (black level) setting, or set "
                "its input range to full (0 to 255), and measure again."
            )
        )
    return findings


def _of_unit(readings: Readings, fit: DisplayFit) -> list[Finding]:
    findings = []
    white = fit.luminance_cd_m2
    top = float(readings.rgb.max())
    bottom = float(readings.rgb.min())
    if top < 0.97:
        video = bottom > 0.03
        findings.append(
            Finding(
                f"The largest digital value is {100.0 * top:.0f} % of the scale that was taken"
                + (
                    f", the smallest {100.0 * bottom:.0f} %, as video levels have it"
                    if video
                    else ""
                )
                + ": R, G and B may be in another unit, of "
                + listed([f"{s:g}" for s in FULL_SCALES], "or")
                + ". White and gamma would be wrong: write the scale into the headings, such as "
                "R (0-255), and measure white too."
            )
        )
    if white is None:
        return findings
    low, high = FOOT_LAMBERT_WHITES
    if not readings.unit_declared and low <= white < high:
        findings.append(
            Finding(
                f"White has {white:.3g}, which is dark for a monitor in cd/m2 (nits): as "
                f"foot-lamberts it would be {3.426 * white:.0f} cd/m2. The luminance is at risk: "
                "write the unit, cd/m2 or fL, into the heading of Y."
            )
        )
    elif not USUAL_WHITES[0] <= white <= USUAL_WHITES[1]:
        findings.append(
            Finding(
                f"White has {white:.3g} cd/m2; monitors have {USUAL_WHITES[0]:g} to "
                f"{USUAL_WHITES[1]:g}. The readings may be in another unit, and the luminance is "
                "at risk: export X, Y and Z in cd/m2, or write the unit into the heading of Y.",
                grave=not 5.0 <= white <= 20000.0,
            )
        )
    return findings


def _of_white(fit: DisplayFit) -> list[Finding]:
    findings = []
    x, y = fit.white_xy
    (x_low, x_high), (y_low, y_high) = WHITE_XY
    if not (x_low <= x <= x_high and y_low <= y <= y_high):
        findings.append(
            Finding(
                f"White is at x = {x:.3f}, y = {y:.3f}, which no display is set to. Every colour "
                "would be wrong: check that the columns are X, Y and Z in this order, in one unit."
            )
        )
    wrong = [
        CHANNELS[k]
        for k, (x, y) in enumerate(fit.primaries_xy)
        if x < -0.02 or y < -0.02 or x + y > 1.03
    ]
    if wrong:
        findings.append(
            Finding(
                f"No light has the chromaticity that {listed(wrong)} comes out with. The gamut "
                "would be wrong: check the columns and their unit, and measure again."
            )
        )
    return findings


def _of_coverage(readings: Readings) -> list[Finding]:
    digital = readings.rgb
    findings = []
    count = len(np.unique(digital.round(6), axis=0))
    if count < FEW_COLOURS:
        findings.append(
            Finding(
                f"Only {count} different colours were measured: the curves between them are a "
                f"guess. Measure about 100 (targen -d3 -f100), at least {FEW_COLOURS}."
            )
        )
    if not np.any(np.all(digital <= DARK, axis=1)):
        findings.append(
            Finding(
                "Black was not measured: contrast and dark tones are a guess. Add a patch of R = G "
                "= B = 0 and measure again."
            )
        )
    if not np.any(np.all(digital >= 1.0 - DARK, axis=1)):
        findings.append(
            Finding(
                "White was not measured: the luminance is extrapolated. Add a patch with R, G and "
                "B at their largest value and measure again."
            )
        )
    missing = [
        CHANNELS[k]
        for k in range(3)
        if not np.any((digital[:, k] >= 0.5) & np.all(np.delete(digital, k, 1) <= PURE, axis=1))
    ]
    if missing:
        findings.append(
            Finding(
                f"The primary {listed(missing)} was not measured alone: the gamut is extrapolated. "
                "Add patches of pure red, green and blue and measure again.",
                grave=len(missing) == 3,
            )
        )
    return findings


def _of_repeats(readings: Readings, fit: DisplayFit, kept: Array) -> list[Finding]:
    findings = []
    digital, xyz = readings.rgb[kept], readings.xyz[kept]
    change = drift(fit.model, digital, xyz, fit.noise.digital)
    if change is not None:
        findings.append(
            Finding(
                f"The display {'brightened' if change > 0.0 else 'dimmed'} by "
                f"{100.0 * abs(change):.1f} % from the first patch to the last. The luminance is "
                "at risk: let the display warm up for half an hour and measure again."
            )
        )
    if fit.misread:
        findings.append(
            Finding(
                f"Readings that are not like the others were left out: {listed(fit.misread)}. "
                "Measure these patches again, or delete them.",
                grave=False,
            )
        )
    scatter = max(fit.noise.share, fit.noise.mixed)
    if scatter > NOISY:
        findings.append(
            Finding(
                f"The readings scatter by {100.0 * scatter:.0f} % around every model: either the "
                "instrument is unsteady or the display is no display of three channels. Fix the "
                "instrument to the screen, darken the room and measure again."
            )
        )
    apart = _repeats_apart(readings)
    if apart is not None and change is None:
        share, places = apart
        if share > 6.0 * max(scatter, 0.005):
            findings.append(
                Finding(
                    f"Patches of the same digital values read {100.0 * share:.0f} % apart: "
                    f"{listed(places)}. One of the readings is wrong, or the display changes: let "
                    "it warm up, and measure again."
                )
            )
    return findings


def _repeats_apart(readings: Readings) -> tuple[float, tuple[str, str]] | None:
    """The largest difference of Y of patches with the same digital values, as a share, and where.

    Patches darker than a hundredth of white are passed over.
    """
    _, group = np.unique(readings.rgb.round(6), axis=0, return_inverse=True)
    y, largest = readings.xyz[:, 1], None
    group = np.asarray(group).ravel()
    order = np.argsort(group, kind="stable")
    for _, same in itertools.groupby(order.tolist(), key=lambda k: int(group[k])):
        members = list(same)
        if len(members) < 2 or y[members].max() < 0.01 * y.max():
            continue
        low, high = members[int(np.argmin(y[members]))], members[int(np.argmax(y[members]))]
        share = float((y[high] - y[low]) / y[high])
        if largest is None or share > largest[0]:
            largest = share, (readings.places[low], readings.places[high])
    return largest


def _numbers(xyz: Array) -> str:
    return ", ".join(f"{v:.4g}" for v in xyz)
