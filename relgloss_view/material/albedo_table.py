"""Albedo tables: what a material shows of a uniform surround, as functions of the eye's direction.

A surround of radiance L all around shows rho(theta_o) L on a surface. By reciprocity rho is the
directional albedo, the integral of f cos_i over the hemisphere of i (Nicodemus et al. 1977). The
shapes of the models are free of wavelength, so a material needs one table of numbers for each of
its diffuse shapes and for each part of its lobes, times its spectra. shaders/ambient.glsl reads the
same tables.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.material import brdf
from relgloss_view.material.brdf import Fresnel
from relgloss_view.material.material import Material

#: Steps of a table, even in sqrt(mu_o): albedos change fastest near the horizon. Between its
#: entries a table is linear: within 1e-3 of the integral but for the last 0.01 degrees above the
#: horizon, and within 1e-4 above mu_o = 0.1, for every width of a lobe.
STEPS = 256
POLAR, AZIMUTHS = 64, 64  #: nodes of the integrals; half a turn, by symmetry
REACH_SD = 7.0  #: a Gaussian beyond so many standard deviations holds 1e-11 of its volume
PART = 32  #: entries that are integrated at once


def cosines() -> Array:
    """mu_o of the entries of a table, (STEPS + 1,), from the horizon to the normal."""
    return np.linspace(0.0, 1.0, STEPS + 1) ** 2


def looked_up(table: Array, mu_o: Array) -> Array:
    """A table's value at cosines (...), from 0 below the horizon's; the twin of ambient.glsl's."""
    place = np.sqrt(np.clip(mu_o, 0.0, 1.0)) * STEPS
    return np.asarray(np.interp(place, np.arange(STEPS + 1.0), table))


@lru_cache(maxsize=64)
def diffuse_table(model: str, sigma: float) -> tuple[Array, Array]:
    """The albedos of a diffuse model's two shapes, (STEPS + 1,) each; sigma in radians."""
    if model == "lambert":
        return np.ones(STEPS + 1), np.zeros(STEPS + 1)
    if model == "eon":
        # The model's own fit (Portsmouth, Kutz, Hill 2025), within 2e-4 of the integrals: with it
        # the two shapes of an albedo of one add up to one exactly.
        first = brdf.fujii_albedo(cosines(), sigma)
        return _frozen(first), _frozen(1.0 - first)
    parts = [diffuse_albedo(model, sigma, mu) for mu in _parts()]
    first, second = (np.concatenate(shapes) for shapes in zip(*parts, strict=True))
    return _frozen(first), _frozen(second)


@lru_cache(maxsize=64)
def lobe_table(s: float, fresnel: Fresnel) -> Array:
    """The albedo of a lobe of unit strength, (STEPS + 1,); arguments as brdf.torrance_sparrow's."""
    return _frozen(np.concatenate([lobe_albedo(s, fresnel, mu) for mu in _parts()]))


def ambient_reflection(material: Material, mu_o: Array, lobe_mu_o: Array) -> tuple[Array, Array]:
    """What a material shows of a surround of radiance 1: diffuse and specular, (..., B) each.

    mu_o, lobe_mu_o: cosine of the angle to the eye, (...), of the surface that the diffuse part and
    the lobes see.
    """
    diffuse = material.diffuse
    first, second = diffuse_table(diffuse.model, diffuse.sigma)
    shown = looked_up(first, mu_o)[..., None] * np.asarray(diffuse.albedo)
    shown = shown + looked_up(second, mu_o)[..., None] * material.second_albedo()
    shine = np.zeros_like(shown)
    for lobe in material.visible_lobes():
        for part in lobe.parts(material.bands.count):
            albedo = looked_up(lobe_table(lobe.s, part.fresnel), lobe_mu_o)
            shine = shine + albedo[..., None] * part.spectrum
    return shown, shine


def surround(diffuse: Array, lobes: Array, luminance: Array, lobes_luminance: Array) -> Array:
    """What a surface shows of a surround of radiance 1, (..., B): of both parts' albedos (..., B).

    luminance, lobes_luminance: those of the albedos, (...). No surface shows more of a uniform
    surround than the perfect diffuser. Diffuse part and lobes are added up as if neither shaded the
    other; where that would show more, at the silhouette of a white print, the lobes give way.
    """
    room = np.clip((1.0 - luminance) / np.maximum(lobes_luminance, 1e-9), 0.0, 1.0)
    return np.asarray(diffuse + room[..., None] * lobes)


def diffuse_albedo(model: str, sigma: float, mu_o: Array) -> tuple[Array, Array]:
    """The integrals of a diffuse model's two shapes at cosines (M,), by Gauss-Legendre nodes.

    The polar integral is cut at mu_o, where a shape may have a kink.
    """
    x, weight = np.polynomial.legendre.leggauss(POLAR // 2)
    low, high = (
        0.5 * (x + 1.0) * mu_o[:, None],
        mu_o[:, None] + 0.5 * (x + 1.0) * (1.0 - mu_o[:, None]),
    )
    mu = np.concatenate([low, high], axis=1)
    area = np.concatenate(
        [0.5 * weight * mu_o[:, None], 0.5 * weight * (1.0 - mu_o[:, None])], axis=1
    )
    i, o = _around(mu), _in_plane(mu_o)[:, None, None, :]
    shapes = brdf.diffuse_shapes(model, brdf.facing(np.array([0.0, 0.0, 1.0]), i, o), sigma)
    first, second = (
        2.0 * np.pi * np.sum(area * mu * shape.mean(axis=-1), axis=-1) for shape in shapes
    )
    return first, second


def lobe_albedo(s: float, fresnel: Fresnel, mu_o: Array) -> Array:
    """The integral of a lobe of unit strength at cosines (M,), over its half-vectors.

    There it is smooth however narrow: dw_i = 4 (o.h) dw_h (Torrance, Sparrow 1967).
    """
    x, weight = np.polynomial.legendre.leggauss(POLAR)
    reach = min(REACH_SD * s, 0.5 * np.pi)
    delta = 0.5 * reach * (x + 1.0)
    h = _around(np.cos(delta)[None, :])
    o = _in_plane(mu_o)[:, None, None, :]
    oh = np.sum(h * o, axis=-1)
    i = 2.0 * oh[..., None] * h - o
    f = brdf.facing(np.array([0.0, 0.0, 1.0]), i, o)
    value = brdf.torrance_sparrow(f, s, fresnel) * np.maximum(f.mu_i, 0.0)
    value = np.where(oh > 0.0, 4.0 * oh * value, 0.0)
    # The mean over half a turn, and 2 pi of it; half the interval is the nodes' own.
    area = np.pi * reach * weight * np.sin(delta)
    return np.asarray(np.sum(area * value.mean(axis=-1), axis=-1))


def _parts() -> list[Array]:
    mu = np.maximum(cosines(), 1e-9)
    return [mu[k : k + PART] for k in range(0, len(mu), PART)]


def _in_plane(mu: Array) -> Array:
    """Unit vectors of cosines (M,) in the plane of x and z, (M, 3)."""
    sine = np.sqrt(np.maximum((1.0 - mu) * (1.0 + mu), 0.0))
    return np.stack([sine, 0.0 * mu, mu], axis=-1)


def _around(mu: Array) -> Array:
    """Unit vectors of cosines (M, P) at azimuths of half a turn, (M, P, A, 3)."""
    phi = (np.arange(AZIMUTHS) + 0.5) * np.pi / AZIMUTHS
    sine = np.sqrt(np.maximum((1.0 - mu) * (1.0 + mu), 0.0))[..., None]
    z = np.broadcast_to(mu[..., None], (*mu.shape, AZIMUTHS))
    return np.stack([sine * np.cos(phi), sine * np.sin(phi), z], axis=-1)


def _frozen(table: Array) -> Array:
    table.setflags(write=False)
    return table
