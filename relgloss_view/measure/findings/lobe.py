"""The core of the highlight as the readings draw it: its width in and across the plane.

Facets lean as a function of the half-vector alone (Torrance, Sparrow 1967), so the logarithm of
their density is a function of the half-vector's angle, and of its azimuth where the sample is
anisotropic (Ward 1992): of a Gaussian it is -(x^2 / s_x^2 + y^2 / s_y^2) / 2.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from relgloss_view.base.arrays import Array, Mask
from relgloss_view.measure.findings.finding import ANISOTROPY, APERTURE, COVERAGE, Finding
from relgloss_view.measure.findings.rows import Rows
from relgloss_view.measure.table import Measurement

#: Shares of the highest density above which rows belong to the core, and to the whole lobe.
CORE, LOBE = 0.3, 0.05
#: Readings must exceed the body by this share for their excess to mean something.
ABOVE_BODY = 0.15
FEWEST = 6
#: Core over blur. A Gaussian aperture alone makes a core of 1, and one below is impossible; a disc
#: alone makes 1.5 to 1.9. Where the blur has so many degrees, cores up to the number beside it are
#: in doubt: of usual instruments, of wide apertures, and of those that few instruments have.
IMPOSSIBLE = 0.85
IN_DOUBT = ((0.0, 1.35), (0.45, 2.0), (0.6, 3.2))
#: Without a declared aperture, a core this narrow may be the instrument's, degrees.
NARROW_DEG = 0.6
#: Anisotropy: ratio of widths that is named, that is serious, and its certainty.
RATIO, SERIOUS_RATIO, ERRORS, GAIN = 1.25, 1.5, 6.0, 1.6
#: Beyond these body, shadowing and grazing incidence draw the shape as much as the facets do.
WIDEST_DEG, STEEPEST_DEG, WIDEST_NARROW_DEG = 30.0, 66.0, 14.0
BROAD_DEG, BROAD_RATIO = 9.0, 2.2  #: and from this narrow width on they need this ratio
#: Shares of the narrow width's square that may be the apertures', and the ratio beyond the first.
FREE_OF_BLUR, MOST_BLUR, BLURRED_RATIO = 0.25, 0.6, 1.8
#: A lobe whose nearest row to the mirror direction lies this many widths away is misplaced.
AWAY = 2.5
#: With no row this near to a mirror direction a highlight may be missed, degrees.
NEAREST_DEG = 1.5
RULE = "disc: diameter / 4; solid angle omega: diameter = 2 acos(1 - omega / 2 pi)"


@dataclass(frozen=True)
class Lobe:
    """The highlight's core."""

    width_deg: float  #: per-axis deviation of the half-vector in the plane of incidence, as read
    rows: Mask  #: (N,), of the whole lobe
    height: float  #: density at its top, in the units of Rows.facets


def lobe_of(rows: Rows) -> Lobe | None:
    """The core of the highlight, None where the rows do not resolve it."""
    height, clear = _height(rows)
    core = clear & (rows.facets > CORE * height)
    in_plane = core & (np.abs(rows.half[:, 1]) < 0.02)
    some = in_plane if np.sum(in_plane) >= FEWEST else core
    if np.sum(some) < FEWEST:
        return None
    x = np.square(rows.delta_deg[some])
    slope, _ = _within(rows.group[some], np.log(rows.facets[some]), x[:, None])
    if slope is None or not slope[0] < 0.0:
        return None
    return Lobe(float(np.sqrt(-0.5 / slope[0])), clear & (rows.facets > LOBE * height), height)


def _height(rows: Rows) -> tuple[float, Mask]:
    clear = rows.kept & (rows.level > (1.0 + ABOVE_BODY) * rows.body_level)
    if not np.any(clear):
        return 0.0, clear
    top = np.sort(rows.facets[clear])[-3:]
    return float(np.median(top)), clear


def _within(
    group: np.ndarray, y: Array, columns: Array
) -> tuple[Array | None, tuple[float, Array]]:
    """Coefficients of y on columns with an offset for each group; sum of squares, covariance."""
    number = np.unique(group, return_inverse=True)[1]
    count = np.bincount(number)
    y = y - (np.bincount(number, y) / count)[number]
    centred = np.column_stack([c - (np.bincount(number, c) / count)[number] for c in columns.T])
    free = len(y) - len(count) - centred.shape[1]
    if free < 2 or np.linalg.matrix_rank(centred, tol=1e-8) < centred.shape[1]:
        return None, (0.0, np.zeros(0))
    solution, *_ = np.linalg.lstsq(centred, y, rcond=None)
    squares = float(np.sum(np.square(y - centred @ solution)))
    covariance = np.linalg.pinv(centred.T @ centred) * squares / free
    return solution, (squares, covariance)


def aperture(measurement: Measurement, rows: Rows, lobe: Lobe | None) -> list[Finding]:
    """Findings where the width that is seen is the instrument's, or less than that."""
    if measurement.tabulated or lobe is None:
        return []
    e_i, e_o = measurement.aperture_sd_deg
    blur = 0.5 * float(np.hypot(e_i, e_o))
    width = lobe.width_deg
    if blur == 0.0:
        if width > NARROW_DEG:
            return []
        return [
            Finding(
                APERTURE,
                f"the highlight is as narrow as instruments are (deviation {width:.2g} deg of the "
                "half-vector) and no aperture is declared: add '# aperture_sd_deg: LAMP, RECEIVER' "
                f"({RULE})",
                False,
            )
        ]
    declared = f"({e_i:g}, {e_o:g} deg)"
    if width < IMPOSSIBLE * blur:
        return [
            Finding(
                APERTURE,
                f"the declared apertures {declared} blur every highlight to {blur:.2g} deg of the "
                f"half-vector, but one of {width:.2g} deg is seen: was the full angle declared? "
                f"Divide it by 4 ({RULE})",
                True,
            )
        ]
    if width > blur * max(most for least, most in IN_DOUBT if blur >= least):
        return []
    return [
        Finding(
            APERTURE,
            f"the declared apertures {declared} are wide beside the highlight ({width:.2g} deg of "
            "the half-vector), whose width and height are uncertain: measure with a smaller "
            f"receiver; if the full angle is declared, divide it by 4 ({RULE})",
            True,
        )
    ]


def coverage(measurement: Measurement, rows: Rows, lobe: Lobe | None) -> list[Finding]:
    """Findings where no row lies near a mirror direction."""
    nearest = float(np.min(rows.delta_deg[rows.kept], initial=90.0))
    steepest = rows.kept & (rows.delta_deg < nearest + 1.0)
    if lobe is not None and nearest > max(AWAY * lobe.width_deg, 1.0):
        top = int(np.argmax(np.where(rows.kept, rows.facets, -np.inf)))
        remedy = "check the azimuths"
        if measurement.gamma_s_deg is not None:
            tilt = np.degrees(np.arctan2(-rows.to_lamp[top, 1], rows.to_lamp[top, 2]))
            remedy = f"give --gamma-s-deg {measurement.gamma_s_deg + tilt:g} or check the table"
        return [
            Finding(
                COVERAGE,
                f"the readings peak {rows.delta_deg[top]:.1f} deg from the mirror direction, in a "
                f"lobe only {lobe.width_deg:.1f} deg wide, and no row lies nearer: the mirror "
                f"direction is elsewhere; {remedy}",
                True,
            )
        ]
    if nearest < NEAREST_DEG or len(rows) < FEWEST:
        return []
    flank = float(np.max(rows.level[steepest])) > 1.5 * rows.body_level
    text = f"no row lies within {nearest:.1f} deg of a mirror direction (angle of the half-vector)"
    if flank:
        return [Finding(COVERAGE, f"{text}: the highlight is known by its flanks alone", False)]
    return [
        Finding(
            COVERAGE,
            f"{text}, and none shows a flank: a highlight may be missing, or the receiver is "
            "counted to the other side (--mirror same-side); measure across the mirror direction "
            "before gloss is read from this table",
            True,
        )
    ]


def anisotropy(measurement: Measurement, rows: Rows, lobe: Lobe | None) -> list[Finding]:
    """A finding where the width depends on the azimuth of the half-vector in the sample's frame."""
    if measurement.tabulated or lobe is None or np.sum(lobe.rows) < 3 * FEWEST:
        return []
    if np.min(rows.delta_deg[rows.kept]) > lobe.width_deg:
        return []
    near = lobe.rows & (rows.delta_deg < WIDEST_DEG) & (rows.incidence_deg < STEEPEST_DEG)
    if np.sum(near) < 2 * FEWEST:
        return []
    some = rows.subset(near)
    h = np.degrees(some.half[:, :2] / some.half[:, 2:])
    squared = np.sum(np.square(h), axis=1)
    scale = max(float(np.mean(squared)), 1e-9)
    x, y = h[:, 0] / np.sqrt(scale), h[:, 1] / np.sqrt(scale)
    if np.mean(y**2) < 0.02 or np.mean(x**2) < 0.02:
        return []
    u = x**2 + y**2
    log_density = np.log(some.facets)
    # Any isotropic shape, and what the growth with incidence leaves along the plane.
    shape = [u, np.sqrt(u), u**1.5, u**2, x, x * some.cos_d]
    turned = [x**2 - y**2, 2.0 * x * y]
    same, (squares, _) = _within(some.group, log_density, np.column_stack(shape))
    both, (less, covariance) = _within(some.group, log_density, np.column_stack([*shape, *turned]))
    plain, _ = _within(some.group, log_density, np.column_stack([u, *turned]))
    if same is None or both is None or plain is None or plain[0] >= 0.0:
        return []
    part = both[-2:]
    errors = float(np.sqrt(part @ np.linalg.pinv(covariance[-2:, -2:]) @ part))
    share = min(float(np.hypot(*part)) / -float(plain[0]), 0.95)
    gain = squares / max(less, 1e-12)
    slopes = -2.0 * plain[0] * np.array([1.0 - share, 1.0 + share]) / scale
    wide, narrow = 1.0 / np.sqrt(slopes)
    blur = 0.25 * float(np.sum(np.square(measurement.aperture_sd_deg)))
    blur /= float(np.mean(np.square(some.cos_d)))  # across the plane apertures blur more
    if blur > MOST_BLUR * narrow**2 or narrow > WIDEST_NARROW_DEG:
        return []
    least = RATIO if blur < FREE_OF_BLUR * narrow**2 else BLURRED_RATIO
    if narrow > BROAD_DEG:
        least = BROAD_RATIO
    ratio = float(np.sqrt((wide**2 - blur) / (narrow**2 - blur)))
    if ratio < least or errors < ERRORS or gain < GAIN:
        return []
    towards = float(np.degrees(0.5 * np.arctan2(part[1], part[0]))) % 180.0
    serious = ratio > SERIOUS_RATIO
    return [
        Finding(
            ANISOTROPY,
            f"the sample is anisotropic: its highlight is {_degrees(wide)} wide at azimuth "
            f"{towards:.0f} deg and {narrow:.2g} deg across it. The models here are isotropic: "
            "fit a table of each orientation, and turn the sample between them",
            serious,
        )
    ]


def _degrees(width: float) -> str:
    """A width for people; beyond what the rows hold only that it is wide."""
    return f"{width:.2g} deg" if width < WIDEST_DEG else f"more than {WIDEST_DEG:g} deg"
