"""What a gloss meter's apertures see: the flux from a source image through a receptor's window.

Directions are points of a plane at unit distance, where an aperture in the focal plane of a lens
is a plain rectangle or disc: x in the plane of incidence, y across it, both the tangents of angles
from the axis. The mirror image of the source lies in the middle of the window. All fluxes are
shares of the light that falls on the specimen.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import NamedTuple

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.material import brdf

#: Refractive index of the black glass that reads 100: ISO 2813 and ASTM D523; TAPPI T 480.
GLASS, PAPER_GLASS = 1.567, 1.540
#: A lobe narrower than this, in degrees, is a mirror to any meter; its square is still a number.
MIRROR_DEG = 1e-6
#: The quadrature follows a lobe this many standard deviations out; beyond lies exp(-21).
REACH_SD = 6.5
#: The reach is computed for small angles on the axis; across a window it differs by less than this.
REACH_MARGIN = 1.25
REACH_LARGEST = 1.2  #: rad; beyond it the window is the limit anyway
SOURCE_NODES = (
    6,
    4,
)  #: Gauss-Legendre, in the plane and over half of the breadth (it is symmetric)
WINDOW_NODES = 36  #: along each side; twice as many change no reading by 4e-5 of it

DIFFUSE_NODES = 12  #: the diffuse part hardly varies over a window

_UNREAD = np.zeros(())  #: in place of what a function does not read of an orientation
#: Facet normals per solid angle from squared angles to the normal, both of the same shape.
Density = Callable[[Array], Array]


@dataclass(frozen=True)
class Window:
    """A receptor's opening: full angles in and across the plane of incidence, in degrees."""

    in_plane_deg: float
    across_deg: float
    offset_deg: float = 0.0  #: from the mirror direction, away from the normal
    round: bool = False  #: a disc of diameter in_plane_deg


@dataclass(frozen=True)
class Meter:
    """A gloss meter: incidence, source image, windows, and the glass that it is set on."""

    key: str
    name: str
    standard: str
    angle_deg: float
    windows: tuple[Window, ...]
    source_deg: tuple[float, float] = (0.75, 2.5)  #: in and across the plane; (0, 0) is a point
    glass: float = GLASS

    @cached_property
    def source(self) -> tuple[Array, Array, Array]:
        """Points of the source image (S,), (S,) and their weights (S,), which sum to one."""
        half_x, half_y = (_tangent(0.5 * angle) for angle in self.source_deg)
        x, wx = _gauss(SOURCE_NODES[0]) if half_x > 0.0 else (np.zeros(1), np.full(1, 2.0))
        y, wy = _gauss(SOURCE_NODES[1]) if half_y > 0.0 else (np.zeros(1), np.full(1, 2.0))
        points = np.meshgrid(half_x * x, half_y * 0.5 * (y + 1.0), indexing="ij")
        return points[0].ravel(), points[1].ravel(), 0.25 * np.outer(wx, wy).ravel()

    @cached_property
    def to_source(self) -> Array:
        """Unit vectors to the points of the source, (S, 3)."""
        theta = np.radians(self.angle_deg)
        x, y, _ = self.source
        axis = np.array([np.sin(theta), 0.0, np.cos(theta)])
        along = np.array([np.cos(theta), 0.0, -np.sin(theta)])
        return _unit(axis + x[:, None] * along + y[:, None] * np.array([0.0, 1.0, 0.0]))

    def mirror_flux(self, index: float) -> float:
        """Share that a smooth dielectric sends into the specular window.

        A mirror's flux is the overlap of source image and window. Every source image here lies
        within its window, so what is left is Fresnel's reflectance averaged over the source.
        """
        _, _, weight = self.source
        return float(np.sum(weight * brdf.fresnel_dielectric(self.to_source[:, 2], index)))


#: The specular meters, by their angle. Apertures of ISO 2813 and ASTM D523; TAPPI T 480 and ISO
#: 8254-1 send a converging beam to the middle of a round window, so the source image is a point.
SPECULAR = {
    20: Meter("gloss-20", "specular gloss, 20 deg", "ISO 2813, ASTM D523", 20, (Window(1.8, 3.6),)),
    60: Meter(
        "gloss-60", "specular gloss, 60 deg", "ISO 2813, ASTM D523", 60, (Window(4.4, 11.7),)
    ),
    85: Meter("gloss-85", "specular gloss, 85 deg", "ISO 2813, ASTM D523", 85, (Window(4.0, 6.0),)),
    75: Meter(
        key="gloss-75",
        name="paper gloss, 75 deg",
        standard="TAPPI T 480, ISO 8254-1",
        angle_deg=75,
        windows=(Window(11.4, 11.4, round=True),),
        source_deg=(0.0, 0.0),
        glass=PAPER_GLASS,
    ),
}
#: ASTM E430 method B: the windows beside the one of 20 degrees, at 18.1 and 21.9 degrees.
HAZE = Meter(
    "haze",
    "reflection haze, 20 deg",
    "ASTM E430 B",
    20,
    (Window(1.8, 3.6, -1.9), Window(1.8, 3.6, 1.9)),
)
#: ASTM E430 method A: 0.3 degrees beside the mirror direction of 30 degrees, against it.
DISTINCTNESS = Meter(
    "doi",
    "distinctness of image, 30 deg",
    "ASTM E430 A",
    30,
    (
        Window(0.1, 0.1, round=True),
        Window(0.1, 0.1, -0.3, round=True),
        Window(0.1, 0.1, 0.3, round=True),
    ),
    (0.0, 0.0),
)


class Nodes(NamedTuple):
    """The nodes of a window's integral, of any shape, and what a lobe needs of each."""

    delta2: Array  #: squared angle between normal and half-vector, rad^2
    cos_d: Array  #: cosine at the facet
    weight: Array  #: source's share, solid angle, shadowing and cos_o over 4, so a flux sums D F


def facet_flux(
    meter: Meter,
    window: Window,
    density: Density,
    index: brdf.Fresnel,
    s: float | None = None,
    nodes: int = WINDOW_NODES,
) -> float:
    """Share that facets of a given density send into a window (Torrance, Sparrow 1967).

    f cos_o = D F G / (4 cos_i) is integrated over the window and averaged over the source. s, the
    facets' standard deviation in radians, keeps the nodes where the lobe is; without it they cover
    the window.
    """
    f, weight = _directions(meter, window, s, nodes)
    value = 0.25 * density(f.delta2) * brdf.reflectance(f.cos_d, index)
    return float(np.sum(weight * value * brdf.shadowing(f) * f.mu_o))


def nodes_of(meter: Meter, window: Window, s: float | None) -> Nodes:
    """The nodes (S, N, N) that a lobe of facet sd s (radians) is summed over.

    They are those of `facet_flux`, without vectors: the specimen lies level and the window's plane
    is spanned by unit vectors at right angles, so every angle has its own formula. Without s they
    cover the window.
    """
    plane = _plane(meter, window, s, WINDOW_NODES)
    sin, cos = _slope(meter.angle_deg + window.offset_deg)
    i_x, i_y, i_z = (meter.to_source[:, k, None, None] for k in range(3))
    x, y = plane.x, plane.y[..., None]
    shorter = 1.0 / np.sqrt(1.0 + x * x + y * y)
    mu_o = (cos - sin * x) * shorter
    half_x, half_y, half_z = i_x - (sin + cos * x) * shorter, i_y + y * shorter, i_z + mu_o
    level = half_x * half_x + half_y * half_y
    cos_d = 0.5 * np.sqrt(level + half_z * half_z)
    delta = np.arctan2(np.sqrt(level), half_z)
    weight = plane.area * (shorter * shorter * shorter) * mu_o
    weight *= 0.25 * meter.source[2][:, None, None]
    f = brdf.Facing(i_z, mu_o, _UNREAD, cos_d, _UNREAD)
    return Nodes(delta * delta, cos_d, weight * brdf.shadowing(f))


def diffuse_nodes(meter: Meter, window: Window) -> tuple[brdf.Facing, Array]:
    """The orientations (P,) over which a diffuse part is summed, and their weights (P,)."""
    f, weight = _directions(meter, window, None, DIFFUSE_NODES)
    return brdf.Facing(*(part.ravel() for part in f)), (weight * f.mu_o).ravel()


def farthest_deg(meter: Meter, window: Window) -> float:
    """The largest angle between normal and half-vector that a window sees, in degrees."""
    f, _ = _directions(meter, window, None, WINDOW_NODES)
    return float(np.degrees(np.sqrt(np.max(f.delta2))))


def _directions(
    meter: Meter, window: Window, s: float | None, nodes: int
) -> tuple[brdf.Facing, Array]:
    """The orientation of the specimen to source and window nodes, (S, N, N), and their weights.

    The weights hold the source's share and the solid angle. The nodes of x fill a chord of the
    window; across a disc y = c + h sin(t), which makes the ends of the chords smooth.
    """
    sin, cos = _slope(meter.angle_deg + window.offset_deg)
    axis, along = np.array([-sin, 0.0, cos]), np.array([-cos, 0.0, -sin])
    across = np.array([0.0, 1.0, 0.0])
    plane = _plane(meter, window, s, nodes)
    x, y = plane.x, np.broadcast_to(plane.y[..., None], plane.x.shape)
    o = axis + x[..., None] * along + y[..., None] * across
    solid_angle = plane.area * (1.0 + x * x + y * y) ** -1.5
    i = np.broadcast_to(meter.to_source[:, None, None, :], o.shape)
    normal = np.broadcast_to(np.array([0.0, 0.0, 1.0]), o.shape)
    return brdf.facing(normal, i, _unit(o)), meter.source[2][:, None, None] * solid_angle


class _Plane(NamedTuple):
    """Nodes of the window's plane at unit distance."""

    x: Array  #: (S, N, N)
    y: Array  #: (S, N)
    area: Array  #: (S, N, N)


def _plane(meter: Meter, window: Window, s: float | None, nodes: int) -> _Plane:
    centre_x, centre_y = _mirrored(meter, window)
    half_x, half_y = _tangent(0.5 * window.in_plane_deg), _tangent(0.5 * window.across_deg)
    reach_x, reach_y = (np.inf, np.inf) if s is None else reach_of(meter, s)
    node, node_weight = _gauss(nodes)

    middle, half = _clip(centre_y, reach_y, half_y)  # (S,)
    turn = 0.5 * np.pi * node
    place, stretch = (np.sin(turn), 0.5 * np.pi * np.cos(turn)) if window.round else (node, 1.0)
    y = middle[:, None] + half[:, None] * place  # (S, N)
    weight_y = half[:, None] * (node_weight * stretch)
    chord = np.sqrt(np.maximum(half_x**2 - y * y, 0.0)) if window.round else half_x + 0.0 * y
    middle, half = _clip(centre_x[:, None], reach_x, chord)  # (S, N)
    x = middle[..., None] + half[..., None] * node  # (S, N, N)
    return _Plane(x, y, weight_y[..., None] * half[..., None] * node_weight)


def _mirrored(meter: Meter, window: Window) -> tuple[Array, Array]:
    """Where the source's mirror image lies in the window's plane, x and y, (S,) each."""
    sin, cos = _slope(meter.angle_deg + window.offset_deg)
    mirror = meter.to_source * np.array([-1.0, -1.0, 1.0])
    depth = mirror @ np.array([-sin, 0.0, cos])
    return mirror @ np.array([-cos, 0.0, -sin]) / depth, mirror[:, 1] / depth


def reach_of(meter: Meter, s: float) -> tuple[float, float]:
    """How far from the mirror image a lobe of facet sd s (radians) is followed, x and y."""
    reach_x = REACH_MARGIN * np.tan(min(2.0 * REACH_SD * s, REACH_LARGEST))
    tilt = np.tan(min(REACH_SD * s, REACH_LARGEST))
    return float(reach_x), float(REACH_MARGIN * 2.0 * np.cos(np.radians(meter.angle_deg)) * tilt)


@lru_cache(maxsize=32)
def spread_of(meter: Meter, window: Window) -> tuple[float, float]:
    """The farthest that a window's edge lies from a point of the mirror image, x and y."""
    centre_x, centre_y = _mirrored(meter, window)
    half_x, half_y = _tangent(0.5 * window.in_plane_deg), _tangent(0.5 * window.across_deg)
    return half_x + float(np.max(np.abs(centre_x))), half_y + float(np.max(np.abs(centre_y)))


def _slope(angle_deg: float) -> tuple[float, float]:
    return float(np.sin(np.radians(angle_deg))), float(np.cos(np.radians(angle_deg)))


def _clip(centre: Array, reach: float, limit: Array | float) -> tuple[Array, Array]:
    """Middle and half length of [centre - reach, centre + reach] within +-limit; 0 where empty."""
    low = np.clip(centre - reach, -np.asarray(limit), limit)
    high = np.clip(centre + reach, -np.asarray(limit), limit)
    return 0.5 * (low + high), 0.5 * (high - low)


def _tangent(angle_deg: float) -> float:
    return float(np.tan(np.radians(angle_deg)))


def _unit(v: Array) -> Array:
    return np.asarray(v / np.linalg.norm(v, axis=-1, keepdims=True))


@lru_cache(maxsize=8)
def _gauss(count: int) -> tuple[Array, Array]:
    return np.polynomial.legendre.leggauss(count)
