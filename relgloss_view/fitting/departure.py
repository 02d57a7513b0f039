"""How far a table departs from its fit about a mirror direction, smoothed over noise.

The table and the fit are compared where the table has samples, the fit as the instrument saw it,
through its apertures. What is left is a ratio of measured to fitted light. It is smooth where the
light itself is steep, it holds neither the blur of the apertures nor Fresnel's reflectance, and so
it can be carried to directions that the table does not have: another incidence, a picture's pixel.
An isotropic reciprocal sample needs two angles for it: delta, between normal and half-vector, and
theta_d, between lamp and half-vector (Rusinkiewicz 1998). It is read by local linear regression
(Cleveland 1979), whose weights give the noise of the result too.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from relgloss_view.base.arrays import Array, Ints, Mask
from relgloss_view.fitting import curves
from relgloss_view.fitting.observations import FLOOR, FLOOR_OF_MEDIAN, usable_rows
from relgloss_view.gloss.meter.meter import luminous_weights
from relgloss_view.gloss.meter.table import INDEX
from relgloss_view.material import brdf
from relgloss_view.material.material import Material
from relgloss_view.material.spectra import illuminant, xyz_weights
from relgloss_view.measure.table import Measurement
from relgloss_view.picture.scene.setup import Lamp

#: Channels of a departure: luminance under a gloss meter's lamp; luminance and two ratios of colour
#: under a picture's. Noise of a colour is that of a ratio, in which most of the noise cancels.
METER, LUMINANCE, RED, BLUE = range(4)
#: Half-vectors closer than this, degrees, are one angle.
SAME_ANGLE_DEG = 0.2
#: ... unless a chain of such neighbours reaches farther than this.
LONGEST_LEVEL_DEG = 1.0
#: A smoothing window holds this many different angles, and its half width is at least this share
#: of the angle itself: far from the mirror direction light changes slowly.
ANGLES_IN_WINDOW, WINDOW_SHARE = 3, 0.25
#: Planes up to this far, degrees of theta_d, count for an incidence, the nearer the more.
FARTHEST_PLANE_DEG, NEAREST_PLANES_DEG = 20.0, 7.5
#: A plane this near, degrees, serves an incidence beyond it.
OWN_PLANE_DEG = 3.0
#: Half-vectors that tilt out of the plane by up to this, degrees or a share of delta, count for it.
ACROSS_DEG, ACROSS_SHARE = 8.0, 0.5
#: Where the samples about a mirror direction begin, degrees of delta, or the table has none.
MIRROR_DEG = 1.0
#: From the mirror direction to the first half-vector beside it facets may fall by this logarithm: a
#: Gaussian that falls by more (1.4 standard deviations) lies between the samples unseen. Farther
#: out, down to a tenth of the peak, they may fall by the second one.
STEEPEST_CORE, STEEPEST_FLANK = 1.0, 3.0
TENTH = float(np.log(10.0))
TOO_COARSE = "its half-vectors lie too far apart"
TO_SD = 1.4826  #: median absolute deviation to a Gaussian's sd
#: Places of a profile per unit of the root of delta: dense at the mirror direction.
PLACES = 40
#: Slopes are held by this share of the weight, where samples at one angle alone can't give them.
RIDGE = 1e-3
#: Sd that the samples of a plane share, before a table is seen, and the planes that this is worth:
#: a table of few planes hardly shows it.
PRESUMED_SPREAD, WORTH, FEWEST_PLANES = 0.02, 2.0, 4


@dataclass(frozen=True)
class Departures:
    """Samples of a table against a fit, one row each."""

    delta: Array  #: (N,), degrees between normal and half-vector
    across: Array  #: (N,), degrees of it across the plane of lamp and receiver
    theta_d: Array  #: (N,), degrees between lamp and half-vector
    log_ratio: Array  #: (N, 4), ln of measured over fitted; channels as above
    measured: Array  #: (N,), luminance factor
    fitted: Array  #: (N,), the same as the instrument would see the fit
    unit: Array  #: (N,), what facets of one density reflect there, relative
    cosines: Array  #: (N,), mu_i mu_o: what a sample counts as light that arrives and leaves
    group: Ints  #: (N,), plane or setting of the lamp, 0 .. G-1
    incidence: Array  #: (N,), degrees
    plane_spread: float  #: sd of the logarithm that planes have in common, but for smooth trends
    #: (N,), how many geometries of a larger table each stands for; None: itself
    counts: Array | None = None

    def counted(self, rows: Mask) -> Array | None:
        """Counts of the marked samples; None where each stands for itself."""
        return None if self.counts is None else self.counts[rows]


@dataclass(frozen=True)
class Profile:
    """The departure at one theta_d as a function of delta."""

    delta: Array  #: (Q,), degrees, from 0
    log_ratio: Array  #: (Q, 4)
    error: Array  #: (Q, 4), standard errors
    reach_deg: float  #: delta of the farthest sample
    coarse: str  #: why the table is too coarse for a narrow lobe; empty where it is not

    def at(self, delta_deg: Array, channel: int) -> Array:
        """The logarithm of measured over fitted at angles of any shape; the ends go on."""
        return np.interp(delta_deg, self.delta, self.log_ratio[:, channel])

    def error_at(self, delta_deg: Array, channel: int) -> Array:
        """Its standard error."""
        return np.interp(delta_deg, self.delta, self.error[:, channel])


def departures(
    measurement: Measurement, material: Material, predicted: Array | None = None
) -> Departures | str:
    """Compare a table with a fit, or the reason why that can't be done.

    predicted: (N, B), radiance factors of the fit at all rows of the table through the instrument
    as it was fitted; without it, through the apertures that the measurement declares.
    """
    rows = usable_rows(measurement)
    lamp, receiver = measurement.to_lamp[rows], measurement.to_receiver[rows]
    if predicted is None:
        seen = curves.seen(material, lamp, receiver, measurement.aperture_sd_deg)
    else:
        seen = predicted[rows]
    value = measurement.radiance_factor[rows]
    # A band without a value has the fit's: it adds no departure.
    # Zero is what an instrument fills in, below zero is noise.
    usable = np.isfinite(value) & ((value != 0.0) | measurement.bands.is_rgb)
    value = np.where(usable, value, seen)
    bands = measurement.bands
    folded = xyz_weights(bands, illuminant(Lamp().illuminant))
    weights = np.column_stack([luminous_weights(bands), folded[:, 1], folded[:, 0], folded[:, 2]])
    measured, fitted = value @ weights, seen @ weights
    typical = np.median(measured, axis=0)
    if np.any(typical <= 0.0):
        return "no luminance and colour follow from its bands"
    floor = np.clip(FLOOR_OF_MEDIAN * typical, 0.0, FLOOR * np.sum(weights, axis=0))
    log_ratio = np.log(np.maximum(measured, 0.0) + floor) - np.log(np.maximum(fitted, 0.0) + floor)
    log_ratio[:, RED:] -= log_ratio[:, LUMINANCE : LUMINANCE + 1]

    counts = None if measurement.stands_for is None else measurement.stands_for[rows]
    f = curves.facing(lamp, receiver)
    split = lamp - receiver
    length = np.linalg.norm(split, axis=1)
    along = np.where(length > 1e-9, split[:, 2] / np.maximum(length, 1e-9), 0.0)
    delta = np.degrees(np.sqrt(f.delta2))
    inside = np.degrees(np.arcsin(np.clip(np.abs(along), 0.0, 1.0)))
    _, group = np.unique(measurement.group[rows], return_inverse=True)
    theta_d = np.degrees(np.arccos(np.clip(f.cos_d, 0.0, 1.0)))
    return Departures(
        delta=delta,
        across=np.sqrt(np.maximum(delta**2 - inside**2, 0.0)),
        theta_d=theta_d,
        log_ratio=log_ratio,
        measured=measured[:, METER],
        fitted=fitted[:, METER],
        unit=brdf.fresnel_dielectric(f.cos_d, INDEX) * brdf.shadowing(f),
        cosines=f.mu_i * f.mu_o if counts is None else f.mu_i * f.mu_o * counts,
        group=group.astype(np.int64),
        incidence=np.degrees(np.arccos(np.clip(f.mu_i, 0.0, 1.0))),
        plane_spread=_plane_spread(log_ratio[:, METER], group, theta_d),
        counts=counts,
    )


def _plane_spread(log_ratio: Array, group: Ints, theta_d: Array) -> float:
    """Sd of what all samples of a plane share, from second differences along theta_d.

    Second differences let smooth trends go, such as a wrong refractive index gives: those are
    faults of the fit and no noise of the planes. The variance of one is 6 times that of a plane.
    """
    planes = np.unique(group)
    if len(planes) < FEWEST_PLANES:
        return PRESUMED_SPREAD
    level = np.array([np.median(log_ratio[group == k]) for k in planes])
    place = np.array([np.median(theta_d[group == k]) for k in planes])
    second = np.diff(level[np.argsort(place)], 2)
    seen2 = (TO_SD * float(np.median(np.abs(second)))) ** 2 / 6.0
    return float(
        np.sqrt((len(second) * seen2 + WORTH * PRESUMED_SPREAD**2) / (len(second) + WORTH))
    )


def profile(samples: Departures, theta_deg: float, largest_deg: float) -> Profile | str:
    """The departure about the mirror direction of an incidence, or why the table has none.

    theta_deg: theta_d, which is the incidence itself at the mirror direction. largest_deg: up to
    which delta it is wanted.
    """
    mirror = samples.delta <= MIRROR_DEG
    if not np.any(mirror):
        return "the table has no sample near a mirror direction"
    window = _window(samples.theta_d[mirror] - theta_deg)
    if window is None:
        nearest = samples.theta_d[mirror][np.argmin(np.abs(samples.theta_d[mirror] - theta_deg))]
        return (
            f"the table's mirror directions do not enclose {theta_deg:.0f} degrees of incidence "
            f"(the nearest is at {nearest:.0f})"
        )
    turn = (samples.theta_d - theta_deg) / window
    sideways = samples.across / np.maximum(ACROSS_DEG, ACROSS_SHARE * samples.delta)
    part = np.flatnonzero((np.abs(turn) < 1.0) & (sideways < 1.0))
    delta, log_ratio = samples.delta[part], samples.log_ratio[part]
    levels, number = _levels(delta)
    reach = float(levels[-1])
    places = np.linspace(0.0, np.sqrt(min(largest_deg, reach)), PLACES) ** 2
    half = _half_widths(levels, places)
    weight = _tricube(turn[part]) * _tricube(sideways[part])
    weight = weight * _tricube((delta - places[:, None]) / half[:, None])  # (Q, N)
    kernel = _equivalent_kernel(weight, delta**2 - places[:, None] ** 2, turn[part])
    mean = kernel @ log_ratio
    # The variance about the smooth curve, with the unknowns of each window taken out.
    fitted = np.stack([np.interp(delta, places, column) for column in mean.T], axis=1)
    freedom = np.maximum(1.0 - np.sum(kernel**2, axis=1), 0.2)
    share = weight / np.maximum(np.sum(weight, axis=1, keepdims=True), 1e-30)
    variance = (share @ (log_ratio - fitted) ** 2) / freedom[:, None]
    alone = np.sum(kernel**2, axis=1)[:, None] * variance
    planes = np.zeros((len(part), int(np.max(samples.group[part])) + 1))
    planes[np.arange(len(part)), samples.group[part]] = 1.0
    together = np.sum((kernel @ planes) ** 2, axis=1)[:, None] * samples.plane_spread**2
    together = together * np.array([1.0, 1.0, 0.0, 0.0])  # planes share a factor, not a colour
    return Profile(
        places, mean, np.sqrt(alone + together), reach, _coarse(samples, part, levels, number)
    )


def _window(offset: Array) -> float | None:
    """Half width in theta_d, degrees, for planes at some offsets from it; None where it is outside.

    It reaches a plane on both sides, beside one at theta_d itself: several planes let their noise
    be averaged and a trend be followed.
    """
    own = bool(np.min(np.abs(offset)) <= OWN_PLANE_DEG)
    sides = [
        float(np.min(side))
        for side in (-offset[offset < -SAME_ANGLE_DEG], offset[offset > SAME_ANGLE_DEG])
        if len(side) and np.min(side) <= FARTHEST_PLANE_DEG
    ]
    if len(sides) < 2 and not own:
        return None
    return 1.25 * max(NEAREST_PLANES_DEG, *sides, 0.0)


def _levels(delta: Array) -> tuple[Array, Ints]:
    """Different angles, increasing, and which of them each sample has."""
    order = np.argsort(delta)
    new = np.diff(delta[order], prepend=-np.inf) > SAME_ANGLE_DEG
    chain = np.cumsum(new) - 1
    first = delta[order][np.flatnonzero(new)]
    # A table whose angles lie without gaps is one chain: it is cut into pieces.
    past = delta[order] - first[chain]
    long = np.maximum.reduceat(past, np.flatnonzero(new)) > LONGEST_LEVEL_DEG
    piece = np.where(long[chain], np.floor(past / (2.0 * SAME_ANGLE_DEG)), 0.0)
    new[1:] |= np.diff(piece) > 0.0
    number = np.empty(len(delta), dtype=np.int64)
    number[order] = np.cumsum(new) - 1
    return np.bincount(number, delta) / np.bincount(number), number


def _half_widths(levels: Array, places: Array) -> Array:
    """Half widths in delta that hold a few angles each."""
    count = min(ANGLES_IN_WINDOW, len(levels))
    distance = np.sort(np.abs(levels - places[:, None]), axis=1)[:, count - 1]
    return np.asarray(np.maximum(1.2 * distance, WINDOW_SHARE * places) + SAME_ANGLE_DEG)


def _tricube(distance: Array) -> Array:
    return np.maximum(1.0 - np.minimum(np.abs(distance), 1.0) ** 3, 0.0) ** 3


def _equivalent_kernel(weight: Array, square: Array, turn: Array) -> Array:
    """(Q, N): what each sample adds to a local linear regression in delta^2 and theta_d."""
    columns = np.stack([np.ones_like(square), square, np.broadcast_to(turn, square.shape)], axis=1)
    scale = np.sqrt(np.maximum(np.einsum("qn,qin->qi", weight, columns**2), 1e-30))
    scale[:, 0] = np.sqrt(np.maximum(np.sum(weight, axis=1), 1e-30))
    columns = columns / scale[:, :, None]
    weighted = columns * weight[:, None, :]
    normal = weighted @ columns.transpose(0, 2, 1)
    normal[:, 1, 1] += RIDGE
    normal[:, 2, 2] += RIDGE
    first = np.zeros((len(weight), 3, 1))
    first[:, 0] = 1.0
    solved = np.linalg.solve(normal, first)[:, :, 0]
    return np.asarray(np.einsum("qi,qin->qn", solved, weighted) / scale[:, :1])


def _coarse(samples: Departures, part: Ints, levels: Array, number: Ints) -> str:
    """Why a lobe is narrower than the gaps between half-vectors, of the fit or of the table."""
    count = np.bincount(number)
    for light in (samples.measured[part], samples.fitted[part]):
        facets = np.maximum(light, 1e-6 * np.max(np.abs(light)) + 1e-30) / samples.unit[part]
        level = np.bincount(number, np.log(facets)) / count
        step = -np.diff(level)
        bright = level[:-1] > np.max(level[:2]) - TENTH
        allowed = np.where(np.arange(len(step)) == 0, STEEPEST_CORE, STEEPEST_FLANK)
        steep = np.flatnonzero(bright & (step > allowed))
        if len(steep):
            k = steep[0]
            near_deg = levels[k] if levels[k] > 0.5 * SAME_ANGLE_DEG else 0.0
            return (
                f"{TOO_COARSE}: from {near_deg:.2g} to {levels[k + 1]:.2g} degrees off the normal "
                f"the lobe falls by a factor of {np.exp(step[k]):.2g}"
            )
    return ""


def near(samples: Departures, degrees: float) -> Mask:
    """(N,), the samples whose half-vector lies within some degrees of the normal."""
    return np.asarray(samples.delta <= degrees)
