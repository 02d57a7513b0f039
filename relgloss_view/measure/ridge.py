"""A check of the tilt gamma_s that a GCMS table declares against the ridge in its data."""

from __future__ import annotations

import numpy as np

from relgloss_view.base.arrays import Array

#: A ridge exceeds the declared tilt by at least this much, in natural logarithms. The diffuse part
#: alone varies less with tilt, and 3 % noise on a Lambertian sample did not reach it once in 4000
#: simulated tables of the paper's grid.
CLEAR = 0.10
#: ... and this many standard errors of the mean over the planes of incidence: the best of several
#: tilts is taken, and the error itself is estimated from a few planes.
CLEAR_ERRORS = 6.0
#: A rough diffuse surface brightens with tilt by less than this, and most at small incidence;
#: below it a ridge must rise with incidence, as every specular lobe does.
SURELY_SPECULAR = np.log(2.0)
#: With this few planes noise cannot be estimated, and only a ridge beyond doubt counts.
FEW_PLANES = 3
#: How a warning begins where nothing shows the tilt that a default assumes.
UNKNOWN_TILT = "gamma_s is not declared and the table cannot show it"


def check(
    angles_deg: Array, level: Array, gamma_s_deg: float, *, declared: bool = True
) -> str | None:
    """A warning where the data contradict gamma_s_deg, or None.

    angles_deg: (N, 3), alpha, beta and gamma of the samples that are used. level: (N,), their mean
    radiance factor over the bands. declared: False where gamma_s_deg is only the default.

    At beta = -alpha the half-vector leaves the normal by |gamma - gamma_s|, so the radiance factor
    peaks at the tilt nearest to gamma_s.
    """
    planes, tilts, profile = _mirror_profiles(angles_deg, level)
    if len(tilts) < 2:
        if declared:
            return None
        return (
            f"{UNKNOWN_TILT}: {gamma_s_deg:g} deg is "
            "assumed; add '# gamma_s_deg: ...' or give --gamma-s-deg"
        )
    ridge_deg = _ridge(planes, tilts, profile, gamma_s_deg)
    if ridge_deg is None:
        return None
    origin = "declared" if declared else "default"
    return (
        f"the mirror ridge lies at gamma = {ridge_deg:g} deg (the nearest tilt in the table), not "
        f"at the {origin} gamma_s = {gamma_s_deg:g} deg: give --gamma-s-deg {ridge_deg:g} or check "
        "the table"
    )


def _mirror_profiles(angles_deg: Array, level: Array) -> tuple[Array, Array, Array]:
    """|alpha| (P,), gamma (T,) and ln(level) (P, T) at beta = -alpha, NaN where unmeasured.

    Only tilts that are measured in at least half of the planes are compared.
    """
    mirror = (np.abs(angles_deg[:, 0] + angles_deg[:, 1]) < 1e-6) & (level > 0.0)
    alpha, gamma = angles_deg[mirror, 0], angles_deg[mirror, 2]
    planes, row = np.unique(alpha, return_inverse=True)
    tilts, column = np.unique(gamma, return_inverse=True)
    total, count = np.zeros((2, len(planes), len(tilts)))
    np.add.at(total, (row, column), np.log(level[mirror]))
    np.add.at(count, (row, column), 1.0)
    profile = np.where(count > 0.0, total / np.maximum(count, 1.0), np.nan)
    # A plane with one tilt, as in a scan across the mirror direction, compares nothing.
    several = (count > 0.0).sum(axis=1) >= 2
    planes, profile = planes[several], profile[several]
    common = np.isfinite(profile).sum(axis=0) >= max(1.0, 0.5 * len(planes))
    if not len(planes):
        common[:] = False
    return np.abs(planes), tilts[common], profile[:, common]


def _ridge(planes: Array, tilts: Array, profile: Array, gamma_s_deg: float) -> float | None:
    """The tilt whose readings clearly exceed those nearest to gamma_s_deg, or None."""
    distance = np.abs(tilts - gamma_s_deg)
    nearest = distance <= distance.min() + 1e-6
    largest_excess, ridge_deg = 0.0, None
    for k in np.flatnonzero(~nearest):
        excess = min(
            (_excess(planes, profile[:, k] - profile[:, n]) for n in np.flatnonzero(nearest)),
        )
        if excess > largest_excess:
            largest_excess, ridge_deg = excess, float(tilts[k])
    return ridge_deg


def _excess(planes: Array, ratio: Array) -> float:
    """Level of ln ratios (P,) above zero at high incidence; 0 where noise could explain it."""
    seen = np.isfinite(ratio)
    order = np.argsort(planes[seen], kind="stable")
    ratio = ratio[seen][order]
    if not len(ratio):
        return 0.0
    low, high = np.array_split(ratio, [len(ratio) // 2])
    level = float(np.median(high)) if len(high) > 2 else float(high.min())
    if len(ratio) <= FEW_PLANES:
        return level if level > SURELY_SPECULAR else 0.0
    if level < SURELY_SPECULAR and level < float(np.median(low)):
        return 0.0
    # Second differences see noise and not the smooth change with incidence: their variance is 6
    # times that of one ratio.
    noise = float(np.sqrt(np.mean(np.square(np.diff(ratio, 2))) / 6.0))
    error = noise / np.sqrt(len(high))
    return level if level > max(CLEAR, CLEAR_ERRORS * error) else 0.0
