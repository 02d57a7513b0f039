"""Small tables with a known lobe, by formulas written down here, to test what tables show."""

from __future__ import annotations

import numpy as np

from relgloss_view.measure import gonio, table
from relgloss_view.measure import screening as screen
from relgloss_view.measure.bands import Bands
from relgloss_view.measure.table import Measurement

NM = (450.0, 500.0, 550.0, 600.0, 650.0)
BODY = np.array([0.2, 0.3, 0.45, 0.4, 0.35])


def in_plane(incidences=(15, 30, 45, 60, 70)):
    """Generic angles of receiver scans, finer around the mirror direction, (N, 4) degrees."""
    rows = []
    for i in incidences:
        receivers = [*np.arange(-75.0, 75.1, 5.0), *(i + np.arange(-6.0, 6.1, 1.0))]
        rows += [
            (i, 180.0, abs(r), 0.0 if r >= 0 else 180.0)
            for r in receivers
            if abs(r) <= 78.0 and abs(r + i) > 5.0
        ]
    return np.array(list(dict.fromkeys(rows)))


def rings(incidences=(5, 20, 40, 55, 68), deltas=(0, 0.7, 1.5, 2.5, 4, 6, 9, 14, 20, 30, 42)):
    """Generic angles with half-vectors in rings, (N, 4) degrees."""
    rows = []
    for i in incidences:
        lamp = gonio.spherical(i, 180.0)
        for delta in deltas:
            for turn in np.arange(0.0, 360.0, 30.0) if delta else (0.0,):
                h = gonio.spherical(delta, turn)
                o = 2.0 * (lamp @ h) * h - lamp
                theta = np.degrees(np.arccos(np.clip(o[2], -1.0, 1.0)))
                if theta <= 80.0:
                    rows.append((i, 180.0, theta, np.degrees(np.arctan2(o[1], o[0])) % 360.0))
    return np.array(rows)


def gcms():
    """The paper's grid, (N, 3) degrees."""
    return gonio.gcms4_grid()


def directions(angles, gamma_s=15.0):
    """To lamp and to receiver of generic (N, 4) or GCMS (N, 3) angles."""
    if angles.shape[1] == 3:
        return gonio.gcms_directions(*angles.T, gamma_s)
    return gonio.spherical(*angles.T[:2]), gonio.spherical(*angles.T[2:])


def factors(i, o, s_deg=3.0, strength=1.0, body=BODY, ratio=1.0, azimuth_deg=0.0, colour=None):
    """Radiance factors of Gaussian facets under Schlick's Fresnel term, over a matte body.

    ratio: of the deviations along and across azimuth_deg (Ward 1992). colour: function of the
    facets' cosine (N,) that gives the highlight's colour (N, B).
    """
    half = (i + o) / np.linalg.norm(i + o, axis=1)[:, None]
    cos_d = np.sum(i * half, axis=1)
    x, y = half[:, 0] / half[:, 2], half[:, 1] / half[:, 2]
    c, s = np.cos(np.radians(azimuth_deg)), np.sin(np.radians(azimuth_deg))
    along, across = (x * c + y * s) / np.sqrt(ratio), (y * c - x * s) * np.sqrt(ratio)
    sd = np.radians(s_deg)
    facets = np.exp(-(along**2 + across**2) / (2 * sd * sd)) / (2 * np.pi * sd * sd)
    fresnel = 0.04 + 0.96 * (1 - cos_d) ** 5
    groove = np.minimum(1.0, 2 * half[:, 2] * np.minimum(i[:, 2], o[:, 2]) / cos_d)
    lobe = strength * np.pi * facets * fresnel * groove / (4 * i[:, 2] * o[:, 2])
    shade = np.ones((len(i), len(body))) if colour is None else colour(cos_d)
    return body + lobe[:, None] * shade


def noisy(values, group, seed=0, plane=0.02, sample=0.01, reading=0.002):
    """Values with noise common to a plane, to a sample, and a reading's own."""
    rng = np.random.default_rng(seed)
    planes = np.unique(group, return_inverse=True)[1]
    shared = np.exp(plane * rng.standard_normal(planes.max() + 1))[planes]
    own = np.exp(sample * rng.standard_normal(len(values)))
    return values * (shared * own)[:, None] * np.exp(reading * rng.standard_normal(values.shape))


def measured(angles, values, *, gamma_s=15.0, aperture=(0.3, 0.3), bands=NM, flip=False):
    """The measurement as a reader makes it. flip: the receiver as recorded to the other side."""
    declared = angles.astype(float).copy()
    is_gcms = angles.shape[1] == 3
    if flip and is_gcms:
        declared[:, 1] *= -1.0
    elif flip:
        declared[:, 3] += 180.0
    i, o = directions(declared, gamma_s)
    group = np.rint(np.abs(angles[:, 0]) if not is_gcms else angles[:, 0]).astype(np.int64)
    return Measurement(
        name="sample",
        source="synthetic",
        to_lamp=i,
        to_receiver=o,
        bands=Bands(tuple(bands)),
        radiance_factor=values,
        reasons=screen.reasons(i, o, values, arms_occlude=is_gcms),
        group=group,
        aperture_sd_deg=aperture,
        gamma_s_deg=gamma_s if is_gcms else None,
    )


def sample(grid=in_plane, seed=0, noise=True, gamma_s=15.0, declared_gamma_s=15.0, **lobe):
    """A measurement of `factors` on a grid. Further arguments: of factors and measured."""
    facts = {k: lobe.pop(k) for k in ("aperture", "flip", "bands") if k in lobe}
    angles = grid()
    i, o = directions(angles, gamma_s)
    values = factors(i, o, **lobe)
    if noise:
        values = noisy(values, angles[:, 0], seed)
    return measured(angles, values, gamma_s=declared_gamma_s, **facts)


__all__ = ["BODY", "NM", "directions", "factors", "gcms", "in_plane", "measured", "noisy",
           "rings", "sample", "table"]  # fmt: skip
