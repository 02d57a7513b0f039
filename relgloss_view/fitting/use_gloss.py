"""Gloss of a fit against gloss of its table: what a meter reads from each.

The fit's light goes through the meter's window. The same light times the table's departure from
the fit (relgloss_view.fitting.departure) is what the table has there, freed of its apertures and
carried to the meter's own incidence from the planes on both sides of it.

The window and the source image count by their difference alone: a receiver at the point w of the
window sees the point s of the source through facets that tilt by (w - s)_x / 2 in the plane and by
(w - s)_y / (2 cos theta) across it. The share of pairs with a difference is the overlap of the two
rectangles moved by it, a product of two trapezoids.
"""

from __future__ import annotations

import dataclasses

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.fitting.departure import METER, Departures, profile
from relgloss_view.fitting.results import GlossUse
from relgloss_view.gloss.meter.geometry import SPECULAR, Meter
from relgloss_view.gloss.meter.meter import luminous_weights, specular_gloss
from relgloss_view.material import brdf
from relgloss_view.material.material import Material

#: A fit's gloss may differ from its table's by this share and so many of the table's standard
#: errors.
GLOSS_SHARE, GLOSS_ERRORS = 0.035, 2.0
#: The standard error counts up to here: no noise excuses more.
LARGEST_ERROR = 0.05
#: A reading with a larger standard error, as a share, is none.
UNREADABLE = 0.25
#: Gloss below this many units is that of a matte sheet, where a meter's own unit counts.
GLOSS_UNITS = 0.5
RINGS, SPOKES = 48, 12  #: places in a window: radii, dense at its middle, and azimuths of a half


def gloss_uses(material: Material, samples: Departures | str) -> tuple[GlossUse, ...]:
    """One row for each specular meter: 20, 60, 75 and 85 degrees."""
    return tuple(_use(material, samples, meter) for _, meter in sorted(SPECULAR.items()))


def _use(material: Material, samples: Departures | str, meter: Meter) -> GlossUse:
    empty = GlossUse(meter.angle_deg, None, None, None, "")
    if isinstance(samples, str):
        return dataclasses.replace(empty, reason=samples)
    delta, flux = window_light(material, meter)
    departure = profile(samples, meter.angle_deg, float(np.max(delta)))
    if isinstance(departure, str):
        return dataclasses.replace(empty, reason=departure)
    total = float(np.sum(flux))
    if total <= 0.0:
        return dataclasses.replace(empty, reason="the fit reflects nothing there")
    if departure.coarse:
        return dataclasses.replace(empty, reason=departure.coarse)
    beyond = float(np.sum(flux[delta > departure.reach_deg])) / total
    if beyond > GLOSS_SHARE:
        reason = (
            f"its half-vectors end {departure.reach_deg:.2g} degrees from the normal, and "
            f"{beyond:.0%} of the reading lies beyond"
        )
        return dataclasses.replace(empty, reason=reason)
    share = flux / total
    factor = float(np.sum(share * np.exp(departure.at(delta, METER))))
    # Errors of neighbouring angles go together: they are added, not their squares.
    error = float(np.sum(share * departure.error_at(delta, METER)))
    if error > UNREADABLE:
        reason = f"its samples near {meter.angle_deg:g} degrees of incidence differ by {error:.0%}"
        return dataclasses.replace(empty, reason=reason)
    fit = specular_gloss(material, meter.angle_deg)
    return GlossUse(meter.angle_deg, fit, fit * factor, fit * factor * error, "")


def poor_gloss(use: GlossUse) -> bool:
    """Whether a fit's gloss is not the table's, by more than noise explains."""
    if use.fit is None or use.table is None or use.table_error is None:
        return False
    allowed = GLOSS_SHARE + GLOSS_ERRORS * min(use.table_error / use.table, LARGEST_ERROR)
    return abs(use.fit - use.table) > max(allowed * use.table, GLOSS_UNITS)


def window_light(material: Material, meter: Meter) -> tuple[Array, Array]:
    """Where a meter's light comes from: angles delta (K,), degrees, and light there (K,), relative.

    The fit's luminous light over all pairs of a source point and a window point.
    """
    (window,) = meter.windows
    theta = np.radians(meter.angle_deg)
    wide, tall = (np.radians(a) for a in (window.in_plane_deg, window.across_deg))
    source = np.radians(np.array(meter.source_deg))
    farthest = 0.5 * float(np.hypot(wide + source[0], tall + source[1]))
    edge = (np.arange(RINGS) + 0.5) / RINGS
    radius = (farthest * edge**3)[:, None]
    ring = 3.0 * farthest * edge[:, None] ** 2 * radius  # r dr
    turn = (np.arange(2 * SPOKES) + 0.5)[None, :] * np.pi / (2 * SPOKES)
    x, y = radius * np.cos(turn), radius * np.sin(turn)
    if window.round:
        share = ((x**2 + y**2) <= (0.5 * wide) ** 2).astype(np.float64)
    else:
        share = _overlap(x, wide, source[0]) * _overlap(y, tall, source[1])
    lit = share > 0.0
    x, y, weight = x[lit], y[lit], (ring * share)[lit]
    to_lamp = np.array([np.sin(theta), 0.0, np.cos(theta)])
    axis = np.array([-np.sin(theta), 0.0, np.cos(theta)])
    along = np.array([-np.cos(theta), 0.0, -np.sin(theta)])
    o = axis + x[:, None] * along + y[:, None] * np.array([0.0, 1.0, 0.0])
    o /= np.linalg.norm(o, axis=1)[:, None]
    i = np.broadcast_to(to_lamp, o.shape)
    f = brdf.facing(np.broadcast_to(np.array([0.0, 0.0, 1.0]), o.shape), i, o)
    diffuse, specular = material.evaluate_facing(f)
    light = (diffuse + specular) @ luminous_weights(material.bands) * np.maximum(f.mu_o, 0.0)
    return np.degrees(np.sqrt(f.delta2)), light * weight


def _overlap(moved: Array, window: float, source: float) -> Array:
    """The length that a window and a source share when one moves past the other."""
    longest = min(window, source) if source > 0.0 else 1.0
    if source <= 0.0:
        return (np.abs(moved) <= 0.5 * window).astype(np.float64)
    return np.clip(0.5 * (window + source) - np.abs(moved), 0.0, longest)
