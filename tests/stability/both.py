"""The real shader and its twin on the same inputs, for the cases of failure."""

from __future__ import annotations

from typing import NamedTuple

import glsl
import numpy as np

from relgloss_view.material import brdf
from relgloss_view.material.approximations import plain_lobe
from relgloss_view.picture.gpu import constants

Z = np.array([0.0, 0.0, 1.0])


class Both(NamedTuple):
    """Values (N, k) of the shader in float32 and of its twin in float64."""

    shader: np.ndarray
    twin: np.ndarray


def direction(theta_deg, phi_deg=0.0):
    """Unit vectors (N, 3) at polar angles and azimuths about +z."""
    theta, phi = np.broadcast_arrays(np.radians(theta_deg), np.radians(phi_deg))
    sin = np.sin(theta)
    made = np.stack([sin * np.cos(phi), sin * np.sin(phi), np.cos(theta)], axis=-1)
    return np.atleast_2d(made)


def rows(*vectors):
    """(N, 3) each, of one length."""
    shape = np.broadcast_shapes(*(np.shape(v) for v in vectors))
    return [np.broadcast_to(v, shape).reshape(-1, 3) for v in vectors]


def lobe(ctx, n, i, o, s_deg, index=1.5):
    """Torrance-Sparrow of unit strength."""
    n, i, o = rows(n, i, o)
    s = float(np.radians(s_deg))
    numbers = ", ".join(repr(float(v)) for v in plain_lobe(s, index))
    body = (
        "Facing f = facing(n.xyz, i.xyz, o.xyz);"
        f"result = vec4(torrance_sparrow(f, Lobe({numbers})));"
    )
    shader = glsl.evaluate(ctx, ["brdf.glsl"], body, {"n": n, "i": i, "o": o})[:, 0]
    twin = brdf.torrance_sparrow(brdf.facing(n, i, o), s, index)
    return Both(shader.astype(np.float64), twin)


def diffuse(ctx, n, i, o, model, sigma):
    """The two shapes of a diffuse model, (N, 2); sigma in radians."""
    n, i, o = rows(n, i, o)
    name = constants.glsl_name("DIFFUSE", model)
    terms = ", ".join(repr(float(v)) for v in brdf.diffuse_terms(model, sigma))
    body = (
        "Facing f = facing(n.xyz, i.xyz, o.xyz);"
        f"result = vec4(diffuse_shapes({name}, f, vec4({terms})), 0, 0);"
    )
    shader = glsl.evaluate(ctx, ["brdf.glsl"], body, {"n": n, "i": i, "o": o})[:, :2]
    twin = np.stack(brdf.diffuse_shapes(model, brdf.facing(n, i, o), sigma), axis=-1)
    return Both(shader.astype(np.float64), twin)


def hemisphere(nodes=64, turns=64):
    """Directions (N, 3) over the upper hemisphere and the weights of an integral over them."""
    x, weight = np.polynomial.legendre.leggauss(nodes)
    mu = np.repeat(0.5 * (x + 1.0), turns)
    phi = np.tile((np.arange(turns) + 0.5) * 2.0 * np.pi / turns, nodes)
    sin = np.sqrt(1.0 - mu * mu)
    o = np.stack([sin * np.cos(phi), sin * np.sin(phi), mu], axis=-1)
    return o, np.repeat(0.5 * weight, turns) * 2.0 * np.pi / turns


def finite(*arrays):
    """Whether every value is a finite number."""
    return all(bool(np.all(np.isfinite(a))) for a in arrays)
