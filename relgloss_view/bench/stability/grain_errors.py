"""How far what is drawn without single grains, or under a simpler lamp, is from what they show.

The terms are those of model_errors.py; the truth is in float64, averaged over the tilt.
"""

from __future__ import annotations

import math
from functools import lru_cache

import moderngl
import numpy as np
from numpy.typing import ArrayLike

from relgloss_view.base.arrays import Array
from relgloss_view.bench.stability.model_errors import (
    INDEX,
    LOBE_BODY,
    LOWEST_COSINE,
    REACH_SD,
    Facings,
    exact_lobe,
    facings,
    shader_values,
    share_of_peak,
)
from relgloss_view.material import approximations, brdf
from relgloss_view.picture.gpu import constants
from relgloss_view.picture.model import noise, tone

LARGEST_TILT_SD = 5.0  #: of the quadrature over the tilt
#: Diffuse albedos and strengths of lobes that c_max is tried on.
PAPERS = ((0.1, 1.0), (0.3, 1.0), (0.3, 0.3), (0.6, 1.0))
GRAIN_STEPS = 7  #: normals along each direction of a cell


def tilts(sigma: float, ratio: float) -> tuple[Array, Array]:
    """Tilt angles (K, 2) of the paper's law and their weights (K,), fine enough for lobes of
    width sigma / ratio.
    """
    count, turns = 24 + int(12.0 * ratio), 16 + int(24.0 * ratio)
    x, weight = np.polynomial.legendre.leggauss(count)
    g = 0.5 * LARGEST_TILT_SD * (x + 1.0)
    density = weight * np.exp(-0.5 * g * g)
    phi = 2.0 * np.pi * (np.arange(turns) + 0.5) / turns
    angles = sigma * g[:, None, None] * np.stack([np.cos(phi), np.sin(phi)], axis=-1)
    weights = np.repeat(density / (np.sum(density) * turns), turns)
    return angles.reshape(-1, 2), weights


def grain_errors(
    ctx: moderngl.Context, s_deg: ArrayLike, ratio: ArrayLike, incidence_deg: float
) -> tuple[Array, Array]:
    """Errors of the lobe's mean as the shader draws it, and of no grain at all; sigma_N = ratio s.

    That of no grain is the root mean square over the grains, as a share of the mean's peak.
    """
    s, q = np.broadcast_arrays(np.asarray(s_deg, dtype=np.float64), ratio)
    pairs = zip(s.ravel().tolist(), q.ravel().tolist(), strict=True)
    f, mean, rms = _grainy(tuple(pairs), incidence_deg)
    lobes = [
        approximations.mean_lobe(math.radians(a), INDEX, math.radians(a * b), "paper")
        for a, b in zip(s.ravel().tolist(), q.ravel().tolist(), strict=True)
    ]
    defines = {"FACETS": constants.code("FACETS", "mean-gaussian")}
    drawn = shader_values(ctx, LOBE_BODY, f, defines, lobe=np.array(lobes))[..., 0]
    peak = np.max(np.where(f.met, mean, 0.0), axis=-1)
    single = np.max(np.where(f.met, rms, 0.0), axis=-1) / np.where(peak > 0.0, peak, 1.0)
    return share_of_peak(drawn, mean, f.met).reshape(s.shape), single.reshape(s.shape)


@lru_cache(maxsize=16)
def _grainy(
    cells: tuple[tuple[float, float], ...], incidence_deg: float
) -> tuple[Facings, Array, Array]:
    """Normals of cells (s in degrees, sigma_N / s), what their grains show in the mean, and by how
    much they differ from the smooth surface (rms), each (C, N).
    """
    s, q = np.array(cells).T
    wide = np.minimum(s * np.hypot(1.0, q) * 4.0, REACH_SD * s + 20.0)
    f = facings(np.full(s.shape, incidence_deg), wide, GRAIN_STEPS)
    smooth = exact_lobe(f, s)
    mean, rms = np.zeros(smooth.shape), np.zeros(smooth.shape)
    for c, (width, ratio) in enumerate(cells):
        angles, weights = tilts(math.radians(width * ratio), ratio)
        n, i, o = (np.broadcast_to(v[c][:, None], (len(f.n[c]), len(angles), 3)) for v in f[:3])
        tilted = noise.tilted(n, np.broadcast_to(angles, (len(f.n[c]), *angles.shape)))
        seen = np.minimum(np.sum(tilted * i, axis=-1), np.sum(tilted * o, axis=-1)) > 0.0
        value = exact_lobe(Facings(tilted, i, o, seen), np.full(tilted.shape[:1], width))
        mean[c] = value @ weights
        rms[c] = np.sqrt(np.square(value - smooth[c][:, None]) @ weights)
    return f, mean, rms


def diffuse_grain_errors(sigma_n_deg: ArrayLike) -> tuple[Array, Array]:
    """Errors of a smooth Lambert surface for a grainy one: of the mean, and root mean square.

    Shares of the brightest, at any angle of incidence.
    """
    theta = np.radians(np.linspace(0.0, 89.0, 45))
    n = np.broadcast_to([0.0, 0.0, 1.0], (45, 1, 3))
    i = np.stack([np.sin(theta), 0.0 * theta, np.cos(theta)], axis=-1)[:, None]
    results = []
    for sigma in np.radians(np.atleast_1d(np.asarray(sigma_n_deg, dtype=np.float64))):
        angles, weights = tilts(float(sigma), 1.0)
        tilted = noise.tilted(np.broadcast_to(n, (45, len(angles), 3)), angles)
        mu = np.maximum(np.sum(tilted * i, axis=-1), 0.0)
        off = mu - np.cos(theta)[:, None]
        results.append((np.max(np.abs(off @ weights)), np.sqrt(np.max(np.square(off) @ weights))))
    mean, rms = np.array(results).T
    return mean, rms


def distant_error(s_deg: ArrayLike, angle_deg: ArrayLike) -> Array:
    """Error of a distant lamp for a sphere that spans `angle` as the lamp sees it; cells broadcast.

    angle is that between the lamp's directions from the sphere's centre and from its side; lamp and
    eye stand 60 degrees apart. Each picture is relative to its own perfect diffuser (Y_n).
    """
    s, angle = np.broadcast_arrays(np.asarray(s_deg, dtype=np.float64), angle_deg)
    size = np.sin(np.radians(angle))[..., None]  # radius over the lamp's distance
    theta = np.radians(30.0)
    lamp = np.array([np.sin(theta), 0.0, np.cos(theta)])
    eye = lamp * (-1.0, 1.0, 1.0)
    reach = np.radians(np.minimum(REACH_SD * s, 59.0))[..., None] * np.linspace(-1, 1, 161)
    n = np.stack([np.sin(reach), 0.0 * reach, np.cos(reach)], axis=-1)
    way = lamp - size[..., None] * n
    distance = np.linalg.norm(way, axis=-1, keepdims=True)
    values = []
    nearest = (1.0 - size) ** -2  # of the sphere's points: its perfect diffuser's largest
    lit = distance[..., 0] ** -2 / nearest
    for i, falloff in ((way / distance, lit), (lamp + 0.0 * n, np.ones(1))):
        g = brdf.facing(n, i, eye + 0.0 * n)
        sharp = np.minimum(g.delta2 / (2.0 * np.radians(s)[..., None] ** 2), brdf.LARGEST_EXPONENT)
        lobe = np.exp(-sharp) * brdf.fresnel_dielectric(g.cos_d, INDEX) * brdf.shadowing(g)
        values.append(np.where(g.mu_i > 0.0, lobe * g.mu_i, 0.0) * falloff)
    met = np.sum(n * eye, axis=-1) > LOWEST_COSINE
    return share_of_peak(values[1], values[0], met)


def c_max_error(s_deg: ArrayLike, incidence_deg: ArrayLike) -> Array:
    """By what share eq. 4, taken at the brightest pixel, is above the exact c_max; cells broadcast.

    The largest of several papers that show a highlight at all.
    """
    s, theta = np.broadcast_arrays(np.asarray(s_deg, dtype=np.float64), incidence_deg)
    f = facings(theta, np.minimum(REACH_SD * s, 90.0), 241)
    lobe, lit = np.pi * exact_lobe(f, s), np.maximum(np.sum(f.n * f.i, axis=-1), 0.0)
    worst = np.zeros(s.shape)
    for albedo, strength in PAPERS:
        l_d, l_s = tone.split_lightness(albedo * lit, strength * lobe)
        l_d, l_s = (np.where(f.met, v, 0.0) for v in (l_d, l_s))
        exact = np.min(np.where(f.met, tone.largest_c(l_d, l_s), 1e30), axis=-1)
        top = np.argmax(l_d + l_s, axis=-1)[..., None]
        d, sp = (np.take_along_axis(v, top, axis=-1)[..., 0] for v in (l_d, l_s))
        shown = np.max(l_s, axis=-1) >= tone.NO_LOBE_LSTAR
        eq4 = (100.0 - d) / np.maximum(sp, 1e-6)
        worst = np.maximum(worst, np.where(shown, eq4 / exact - 1.0, 0.0))
    return worst


def once_error(ratio: ArrayLike) -> Array:
    """By what share c_max of the smooth surface is off on a flat one with grain, sigma_N = ratio s.

    The half-vector stands three lobe widths off the normal, and some grain leans three sigma_N
    towards it: a dark diffuse part, where L_s* is proportional to the lobe.
    """
    q = np.asarray(ratio, dtype=np.float64)
    return np.asarray(np.exp(0.5 * (9.0 - np.square(3.0 - 3.0 * q))) - 1.0)
