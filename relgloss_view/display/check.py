"""Whether a display still shows what its file describes: new readings against the monitor."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.errors import InputError
from relgloss_view.base.words import listed
from relgloss_view.display.monitor import Monitor
from relgloss_view.display.readings import Readings
from relgloss_view.material.cielab import lab_from_xyz
from relgloss_view.material.difference import delta_e_2000

#: Tolerances of ISO 12646:2015 and Fogra's soft proofs come near: mean and largest dE2000.
GOOD_MEAN, GOOD_LARGEST = 2.0, 5.0
GOOD_LUMINANCE = 0.1  #: share of white's luminance
GOOD_WHITE_DE2000 = 2.0
GOOD_GAMMA = 0.1
GOOD_BLACK = 1.3  #: factor of the black's share of white, up or down
LEAST_BLACK = 2e-4  #: of white, below which blacks do not differ to an eye
MIDDLE = (0.2, 0.9)  #: digital values whose slope is the gamma


@dataclass(frozen=True, eq=False)
class DisplayCheck:
    """New readings of a display against its monitor.

    differences: (N,) dE2000 of each patch, both relative to their own white. mean, p95, largest: of
    them; worst: place of the largest. luminance_drift: share by which white became brighter; None
    where one of the two has no unit. white_shift: dE2000 between the two whites at equal
    luminance. white_xy: the new one. black_share: new black over new white; expected_black_share:
    the monitor's; None where it was not measured or is not known. gamma, expected_gamma: slope of
    the grays in logarithms; None where fewer than three were measured. verdict: "good" or "poor".
    sentences: what is right and what is not, each with the step that mends it.
    """

    differences: Array
    mean: float
    p95: float
    largest: float
    worst: str
    luminance_drift: float | None
    white_shift: float
    white_xy: tuple[float, float]
    black_share: float | None
    expected_black_share: float | None
    gamma: float | None
    expected_gamma: float | None
    verdict: str
    sentences: tuple[str, ...]


def check_display(monitor: Monitor, readings: Readings) -> DisplayCheck:
    """Compare a monitor with new readings. Raises InputError where white was not measured."""
    digital, xyz = readings.rgb, readings.xyz
    whites = np.all(digital >= 1.0 - 1e-6, axis=1)
    if not np.any(whites):
        raise InputError(
            f"{readings.source}: no patch of white; add one with R, G and B at their largest value"
        )
    white = np.median(xyz[whites], axis=0)
    if white.min() <= 0.0:
        raise InputError(f"{readings.source}: white reads no light; measure it again")
    expected, expected_white = monitor.xyz(digital), monitor.white
    differences = delta_e_2000(lab_from_xyz(xyz, white), lab_from_xyz(expected, expected_white))
    seen = lab_from_xyz(white / white[1], expected_white / expected_white[1])
    white_shift = float(delta_e_2000(seen, np.array([100.0, 0.0, 0.0])))
    drift = None
    if readings.absolute and monitor.luminance_cd_m2:
        drift = float(white[1] / monitor.luminance_cd_m2 - 1.0)
    dark = np.all(digital <= 1e-6, axis=1)
    black = float(max(np.median(xyz[dark, 1]), 0.0) / white[1]) if np.any(dark) else None
    expected_black = float(monitor.xyz(np.zeros((1, 3)))[0, 1]) if monitor.black_known else None
    gamma, expected_gamma = _gammas(digital, xyz[:, 1] / white[1], expected[:, 1], black or 0.0)
    worst = int(np.argmax(differences))
    faults = [
        *_of_colours(differences, readings.places[worst]),
        *_of_white(drift, white_shift),
        *_of_black(black, expected_black),
        *_of_gamma(gamma, expected_gamma),
    ]
    good = (
        f"The display shows what its file describes: {readings.count} patches differ by dE2000 "
        f"{differences.mean():.2f} in the mean and {differences.max():.2f} at most.",
    )
    total = float(white.sum())
    return DisplayCheck(
        differences,
        float(differences.mean()),
        float(np.percentile(differences, 95.0)),
        float(differences.max()),
        readings.places[worst],
        drift,
        white_shift,
        (float(white[0]) / total, float(white[1]) / total),
        black,
        expected_black,
        gamma,
        expected_gamma,
        "poor" if faults else "good",
        (*(faults or good), *_unknown(drift, monitor, black, expected_black)),
    )


def _gammas(
    digital: Array, y: Array, expected: Array, black: float
) -> tuple[float | None, float | None]:
    """Slope of log luminance, less black, over log digital value, of grays; new and expected."""
    level = digital.mean(axis=1)
    gray = (np.ptp(digital, axis=1) < 1e-6) & (level >= MIDDLE[0]) & (level <= MIDDLE[1])
    gray &= (y > black) & (expected > 0.0)
    if len(np.unique(level[gray])) < 3:
        return None, None
    x = np.log(level[gray])
    dark = float(expected.min()) if black else 0.0
    new = np.polyfit(x, np.log(y[gray] - black), 1)[0]
    old = np.polyfit(x, np.log(np.maximum(expected[gray] - dark, 1e-9)), 1)[0]
    return float(new), float(old)


def _of_colours(differences: Array, worst: str) -> list[str]:
    mean, largest = float(differences.mean()), float(differences.max())
    if mean <= GOOD_MEAN and largest <= GOOD_LARGEST:
        return []
    return [
        f"Colours are off by dE2000 {mean:.1f} in the mean and {largest:.1f} at most ({worst}); "
        f"{GOOD_MEAN:g} and {GOOD_LARGEST:g} are usual limits. Load the display's calibration, or "
        "measure it anew and make a new file: relgloss display READINGS -o monitor.toml"
    ]


def _of_white(drift: float | None, shift: float) -> list[str]:
    found = []
    if drift is not None and abs(drift) > GOOD_LUMINANCE:
        found.append(
            f"White is {100.0 * abs(drift):.0f} % {'brighter' if drift > 0.0 else 'darker'} than "
            "its file has it, so gloss would look different: set the display's brightness back, "
            "or measure it anew."
        )
    if shift > GOOD_WHITE_DE2000:
        found.append(
            f"The white point moved by dE2000 {shift:.1f}: set the display's colour temperature "
            "back, switch night modes off, or measure it anew."
        )
    return found


def _of_black(black: float | None, expected: float | None) -> list[str]:
    if black is None or expected is None:
        return []
    ratio = max(black, LEAST_BLACK) / max(expected, LEAST_BLACK)
    if 1.0 / GOOD_BLACK <= ratio <= GOOD_BLACK:
        return []
    return [
        f"Black is {100.0 * black:.2f} % of white and was {100.0 * expected:.2f} %: darken the "
        "room, set the display's black level back, or measure it anew."
    ]


def _of_gamma(gamma: float | None, expected: float | None) -> list[str]:
    if gamma is None or expected is None or abs(gamma - expected) <= GOOD_GAMMA:
        return []
    return [
        f"The gamma of grays is {gamma:.2f} and was {expected:.2f}: set the display's mode back, "
        "load its calibration, or measure it anew."
    ]


def _unknown(
    drift: float | None, monitor: Monitor, black: float | None, expected: float | None
) -> tuple[str, ...]:
    """What could not be compared."""
    missing = []
    if drift is None:
        missing.append("the luminance of white")
    if black is None or expected is None:
        missing.append("black")
    if not missing:
        return ()
    return (
        f"Not compared: {listed(missing)}. Either the readings or {monitor.name} do not hold it.",
    )
