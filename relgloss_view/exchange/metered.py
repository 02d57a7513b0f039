"""Gloss units of any surface: the quadrature of what it sends into the windows of gloss meters."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.exchange.loss import Surface
from relgloss_view.gloss.meter.geometry import SOURCE_NODES, SPECULAR, Meter
from relgloss_view.gloss.meter.meter import luminous_weights, specular_gloss
from relgloss_view.material.material import Material
from relgloss_view.measure.bands import RGB


class Nodes(NamedTuple):
    """How finely a window is looked at."""

    window: int  #: on each side of the mirror direction, along each axis
    source: tuple[int, int]  #: in the plane, and over half of the breadth


FINE = Nodes(14, SOURCE_NODES)
#: For searches: within 2.5 % of a reading of the narrowest lobes, the same share for similar ones.
COARSE = Nodes(7, (3, 2))
#: The nodes are spread evenly in asinh(angle / this), radians: dense at the mirror direction,
#: so that a lobe of 0.1 degrees and one of 30 are both followed.
CORE = 2e-3


class Window(NamedTuple):
    """Directions of a meter, (N, 3) each, and the share of the light by solid angle and source."""

    i: Array
    o: Array
    weight: Array


def gloss_units(surface: Surface) -> dict[str, float]:
    """Readings at 20, 60, 75 and 85 degrees by key (ISO 2813, ASTM D523; TAPPI T 480).

    A Material is read by gloss.meter, any other surface by the quadrature here.
    """
    if isinstance(surface, Material):
        return {meter.key: specular_gloss(surface, angle) for angle, meter in _meters()}
    return {meter.key: reading(surface, meter) for _, meter in _meters()}


def reading(surface: Surface, meter: Meter, nodes: Nodes = FINE) -> float:
    """A surface's reading at a specular meter, in gloss units."""
    window = window_of(meter, nodes)
    bands = getattr(surface, "bands", RGB)
    total = sum(surface.evaluate(window.i, window.o)) @ luminous_weights(bands)
    return float(100.0 * np.sum(window.weight * total) / meter.mirror_flux(meter.glass))


def _meters() -> list[tuple[float, Meter]]:
    return sorted(SPECULAR.items())


@lru_cache(maxsize=16)
def window_of(meter: Meter, nodes: Nodes = FINE) -> Window:
    """The directions of a meter's window, dense about the mirror image of each source point."""
    [window] = meter.windows
    theta = np.radians(meter.angle_deg + window.offset_deg)
    axis = np.array([-np.sin(theta), 0.0, np.cos(theta)])
    along = np.array([-np.cos(theta), 0.0, -np.sin(theta)])
    across = np.array([0.0, 1.0, 0.0])
    to_source, share = _source(meter, nodes.source)
    mirror = to_source * np.array([-1.0, -1.0, 1.0])
    depth = mirror @ axis
    centre_x, centre_y = (mirror @ along) / depth, (mirror @ across) / depth
    half_x, half_y = (
        np.tan(0.5 * np.radians(angle)) for angle in (window.in_plane_deg, window.across_deg)
    )
    y, weight_y = _clustered(centre_y, np.full_like(centre_y, half_y), nodes.window)
    chord = np.sqrt(np.maximum(half_x**2 - y * y, 0.0)) if window.round else half_x + 0.0 * y
    x, weight_x = _clustered(np.broadcast_to(centre_x[:, None], y.shape), chord, nodes.window)
    y = np.broadcast_to(y[..., None], x.shape)
    o = axis + x[..., None] * along + y[..., None] * across
    o = o / np.linalg.norm(o, axis=-1, keepdims=True)
    weight = share[:, None, None] * weight_y[..., None] * weight_x * (1.0 + x * x + y * y) ** -1.5
    i = np.broadcast_to(to_source[:, None, None, :], o.shape)
    return Window(i.reshape(-1, 3), o.reshape(-1, 3), (weight * o[..., 2]).ravel())


def _source(meter: Meter, nodes: tuple[int, int]) -> tuple[Array, Array]:
    """Unit vectors to points of a meter's source image (S, 3), and their shares of its light.

    Readings are symmetric across the plane of incidence, so half of the breadth stands for all.
    """
    (x, weight_x), (y, weight_y) = (
        np.polynomial.legendre.leggauss(count) if angle > 0.0 else (np.zeros(1), np.full(1, 2.0))
        for count, angle in zip(nodes, meter.source_deg, strict=True)
    )
    half_x, half_y = (np.tan(0.5 * np.radians(angle)) for angle in meter.source_deg)
    theta = np.radians(meter.angle_deg)
    axis = np.array([np.sin(theta), 0.0, np.cos(theta)])
    along = np.array([np.cos(theta), 0.0, -np.sin(theta)])
    x, y = (
        part.ravel()[:, None]
        for part in np.meshgrid(half_x * x, 0.5 * half_y * (y + 1.0), indexing="ij")
    )
    to_source = axis + x * along + y * np.array([0.0, 1.0, 0.0])
    to_source = to_source / np.linalg.norm(to_source, axis=-1, keepdims=True)
    return to_source, 0.25 * np.outer(weight_x, weight_y).ravel()


def _clustered(centre: Array, half: Array, nodes: int) -> tuple[Array, Array]:
    """Places (..., 2 N) in [-half, half], dense at a centre within, and their weights."""
    node, weight = np.polynomial.legendre.leggauss(nodes)
    centre = np.clip(centre, -half, half)
    places, weights = [], []
    for end in (-half, half):
        reach = np.arcsinh((end - centre) / CORE)[..., None]
        u = 0.5 * reach * (node + 1.0)
        places.append(centre[..., None] + CORE * np.sinh(u))
        weights.append(0.5 * np.abs(reach) * weight * CORE * np.cosh(u))
    return np.concatenate(places, axis=-1), np.concatenate(weights, axis=-1)
