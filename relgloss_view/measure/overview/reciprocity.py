"""Reciprocity: whether the sample reads the same with lamp and receiver exchanged.

The BRDF of every sample without fluorescence is unchanged when lamp and receiver change places
(von Helmholtz 1867; Clarke and Parry 1985), and so is the radiance factor, pi times the BRDF. What
is not unchanged is the instrument's: a cosine that is left in, a lamp that fades, a zero of an
angle. The sample is taken as isotropic, so only the angle between both azimuths counts.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from relgloss_view.base.arrays import Array, Ints, Mask
from relgloss_view.measure.gonio import from_normal
from relgloss_view.measure.overview.polar import POLE_DEG, Polar

#: Readings below this hold more noise than sample: a thousandth of the perfect diffuser.
DARKEST = 1e-3
#: Angles are the same within these steps, degrees. Their edges are shifted, because instruments
#: count in round numbers, which must not lie on an edge.
STEP_DEG, AZIMUTH_STEP_DEG, SHIFT_DEG = 0.02, 0.05, 0.00713
#: Receivers nearer to each other than this are one.
SAME_DEG = 0.005
#: Between readings a value is interpolated where they are this near, degrees, and where cubic and
#: linear interpolation of the logarithm agree within TRUSTED: it can't be much farther off.
WIDEST_GAP_DEG, TRUSTED = 10.0, 0.01
#: Half-vectors nearer to the normal show the highlight of most samples, others the body, degrees.
NEAR_MIRROR_DEG = 10.0
#: Pairs of curves that are looked at: beyond, the table has enough pairs of readings.
MOST_CROSSINGS = 2e6

_PLANES = 4000  #: more than there are steps of azimuth
_APART = 1000.0  #: more than a curve of receiver angles spans


@dataclass(frozen=True)
class Reciprocity:
    """P pairs of readings with lamp and receiver exchanged."""

    lamp_deg: Array  #: (P,), the steeper of both angles from the normal
    receiver_deg: Array  #: (P,), the other one, positive on the mirror's side
    half_deg: Array  #: (P,), half-vector from the normal
    #: (P,), reading at this lamp and receiver less the one with both exchanged, over their mean
    difference: Array
    interpolated: int  #: in how many pairs one or both readings are interpolated

    @property
    def pairs(self) -> int:
        """Number of pairs."""
        return len(self.difference)

    def typical(self, share: float = 50.0, where: Mask | None = None) -> float | None:
        """A percentile of the difference's magnitude; None without any pair."""
        some = self.difference if where is None else self.difference[where]
        return float(np.percentile(np.abs(some), share)) if len(some) else None

    @property
    def bias(self) -> float | None:
        """Median of the difference with its sign; noise has none."""
        return float(np.median(self.difference)) if self.pairs else None

    @property
    def near_mirror(self) -> Mask:
        """(P,), pairs near the mirror direction."""
        return np.asarray(self.half_deg <= NEAR_MIRROR_DEG)


def reciprocity(polar: Polar, level: Array) -> Reciprocity:
    """Compare N readings with those of exchanged directions.

    polar: their angles. level: (N,), readings, those below DARKEST are not compared.

    Every two incidences of one plane give a pair on either side of the normal, where each reading
    is in the table or is interpolated along the receiver's angle between four neighbours (Lagrange,
    in the logarithm). Equal angles compare nothing.
    """
    rows = level > DARKEST
    polar, level = polar.subset(rows), np.log(level[rows])
    sites = _Sites.of(polar)
    curves = _Curves.of(sites, level)
    asked = sites.joined(curves.crossings()).steeper_first()
    (first, read), (second, read_too) = curves.at(asked), curves.at(asked.exchanged())
    known = np.isfinite(first) & np.isfinite(second)
    ratio = (first - second)[known]
    asked = asked.subset(known)
    return Reciprocity(
        asked.lamp_deg,
        asked.receiver_deg,
        asked.half_deg(),
        2.0 * np.tanh(0.5 * ratio),  # 2 (a - b) / (a + b) of a / b = exp(ratio)
        int(np.sum(~(read & read_too)[known])),
    )


@dataclass(frozen=True)
class _Sites:
    """Geometries of an isotropic sample: receivers on curves through the normal."""

    lamp_deg: Array  #: (N,), from the normal
    receiver_deg: Array  #: (N,), positive on the mirror's side
    plane_deg: Array  #: (N,), 0 to 90: azimuth of the receiver's curve from the plane of incidence

    @classmethod
    def of(cls, polar: Polar) -> _Sites:
        """Those of readings. Without an azimuth a geometry belongs to the plane of incidence."""
        pole = np.minimum(polar.lamp_deg, polar.receiver_deg) < POLE_DEG
        plane = np.where(pole, 0.0, polar.out_of_plane_deg)
        return cls(polar.lamp_deg, polar.signed_receiver_deg, plane)

    def subset(self, rows: Mask | Ints) -> _Sites:
        return _Sites(self.lamp_deg[rows], self.receiver_deg[rows], self.plane_deg[rows])

    def joined(self, other: _Sites) -> _Sites:
        parts = zip(self._columns, other._columns, strict=True)
        return _Sites(*(np.concatenate(pair) for pair in parts))

    @property
    def _columns(self) -> tuple[Array, Array, Array]:
        return self.lamp_deg, self.receiver_deg, self.plane_deg

    def exchanged(self) -> _Sites:
        """With lamp and receiver in each other's place."""
        side = np.where(self.receiver_deg < 0.0, -1.0, 1.0)
        return _Sites(np.abs(self.receiver_deg), side * self.lamp_deg, self.plane_deg)

    def steeper_first(self) -> _Sites:
        """Each pair of exchanged geometries once, with the lamp at the larger angle."""
        turned = self.exchanged()
        swap = np.abs(self.receiver_deg) > self.lamp_deg
        pairs = zip(turned._columns, self._columns, strict=True)
        steep = _Sites(*(np.where(swap, a, b) for a, b in pairs))
        steep = steep.subset(steep.lamp_deg - np.abs(steep.receiver_deg) > STEP_DEG)
        numbers = [_step(x, STEP_DEG) for x in steep._columns]
        order = np.lexsort(numbers)
        new = np.ones(len(order), dtype=bool)
        new[1:] = np.any([np.diff(n[order]) != 0 for n in numbers], axis=0)
        return steep.subset(order[new])

    def curves(self) -> Ints:
        """(N,), a number for each incidence and plane."""
        planes = _step(self.plane_deg, AZIMUTH_STEP_DEG)
        return _step(self.lamp_deg, STEP_DEG) * _PLANES + planes

    def half_deg(self) -> Array:
        """(N,), half-vector from the normal."""
        lamp, receiver, plane = (np.radians(x) for x in self._columns)
        total = np.stack(
            [
                np.sin(receiver) * np.cos(plane) - np.sin(lamp),
                np.sin(receiver) * np.sin(plane),
                np.cos(receiver) + np.cos(lamp),
            ],
            axis=1,
        )
        return from_normal(total)


def _step(angle_deg: Array, step_deg: float) -> Ints:
    return np.floor((angle_deg + SHIFT_DEG) / step_deg).astype(np.int64)


@dataclass(frozen=True)
class _Curves:
    """Readings as functions of the receiver's angle, all curves one behind the other."""

    names: Ints  #: (C,), of the curves, increasing
    lamp_deg: Array  #: (C,)
    plane_deg: Array  #: (C,)
    curve: Ints  #: (M,), the curve of each node
    site: Array  #: (M,), increasing: number of the curve times _APART plus the receiver's angle
    value: Array  #: (M,)

    @classmethod
    def of(cls, sites: _Sites, values: Array) -> _Curves:
        """Nodes of readings (N,); readings of one geometry are averaged."""
        names, first, curve = np.unique(sites.curves(), return_index=True, return_inverse=True)
        site = curve * _APART + sites.receiver_deg
        order = np.argsort(site, kind="stable")
        site, curve, values = site[order], curve[order], values[order]
        new = np.ones(len(site), dtype=bool)
        new[1:] = np.diff(site) > SAME_DEG
        node = np.cumsum(new) - 1
        count = np.bincount(node) if len(node) else np.zeros(0)
        mean = [np.bincount(node, x) / count for x in (site, values)]
        lamp, plane = sites.lamp_deg[first], sites.plane_deg[first]
        return cls(names, lamp, plane, curve[new], mean[0], mean[1])

    def crossings(self) -> _Sites:
        """The geometries that two curves of a plane share when lamp and receiver are exchanged.

        Of curves that are long enough to be interpolated, and none where they are too many.
        """
        nodes = np.bincount(self.curve, minlength=len(self.names))
        long = np.flatnonzero(nodes >= 4)
        planes, plane, count = np.unique(
            self.names[long] % _PLANES, return_inverse=True, return_counts=True
        )
        if float(np.sum(np.square(count, dtype=np.float64))) > MOST_CROSSINGS:
            long, planes = long[:0], planes[:0]
        members = [long[plane == k] for k in range(len(planes))]
        one = np.concatenate([np.repeat(m, len(m)) for m in members] or [long])
        other = np.concatenate([np.tile(m, len(m)) for m in members] or [long])
        lamp, receiver, plane_deg = self.lamp_deg[one], self.lamp_deg[other], self.plane_deg[one]
        sides = _Sites(lamp, receiver, plane_deg), _Sites(lamp, -receiver, plane_deg)
        return sides[0].joined(sides[1])

    def at(self, sites: _Sites) -> tuple[Array, Mask]:
        """Values (N,) at places on curves, NaN where none can be known, and whether one was read.

        Everything is looked up at once: a table may have as many curves as rows.
        """
        keys = sites.curves()
        result, is_read = np.full(len(keys), np.nan), np.zeros(len(keys), dtype=bool)
        if not len(self.names):
            return result, is_read
        curve = np.minimum(np.searchsorted(self.names, keys), len(self.names) - 1)
        known = self.names[curve] == keys
        place = curve * _APART + sites.receiver_deg
        above = np.searchsorted(self.site, place)
        for node in (above - 1, above):
            inside = known & (node >= 0) & (node < len(self.site))
            node = np.clip(node, 0, len(self.site) - 1)
            same = inside & (np.abs(self.site[node] - place) < SAME_DEG)
            result[same], is_read[same] = self.value[node[same]], True
        open_ = known & ~is_read & (above >= 2) & (above + 1 < len(self.site))
        rows = np.flatnonzero(open_)
        nodes = above[rows, None] + np.arange(-2, 2)
        x, y = self.site[nodes], self.value[nodes]
        fine = np.all(self.curve[nodes] == curve[rows, None], axis=1)
        fine &= np.all(np.diff(x, axis=1) < WIDEST_GAP_DEG, axis=1)
        rows, x, y = rows[fine], x[fine], y[fine]
        cubic = _lagrange(x, y, place[rows])
        linear = _lagrange(x[:, 1:3], y[:, 1:3], place[rows])
        trusted = np.abs(cubic - linear) < TRUSTED
        result[rows[trusted]] = cubic[trusted]
        return result, is_read


def _lagrange(x: Array, y: Array, at: Array) -> Array:
    """Values (N,) at places (N,) of polynomials through nodes x, y (N, K)."""
    total = np.zeros(len(at))
    for k in range(x.shape[1]):
        others = np.delete(x, k, axis=1)
        weights = (at[:, None] - others) / (x[:, k, None] - others)
        total += y[:, k] * np.prod(weights, axis=1)
    return total
