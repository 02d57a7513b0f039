"""Slices through a measurement for the report: mirror plane, ridge, tilt."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from relgloss_view.base.arrays import Array, Ints, Mask
from relgloss_view.fitting import curves
from relgloss_view.material.material import Material
from relgloss_view.measure.table import Measurement

_ANGLE_DEG = 0.3  #: angles nearer than this are the same
_ASIDE_DEG = 0.6  #: how far a half-vector of the mirror plane may lie beside it
_DIGITS = 1  #: of an angle that stands for its neighbours, well within _ANGLE_DEG


@dataclass(frozen=True)
class Slices:
    """The usable samples of a measurement and the fit at the same directions."""

    value: Array  #: (N, B), zero where there is none
    compared: Ints  #: (M,), the samples whose residuals are drawn
    fitted: Array  #: (M, B)
    incidence_deg: Array  #: (N,)
    receiver_deg: Array  #: (N,), positive on the mirror side
    half_deg: Array  #: (N,), half-vector from the normal
    difference_deg: Array  #: (N,), half of the angle between lamp and receiver
    planar: Mask  #: (N,), lamp, normal and receiver in one plane
    band: int  #: the one that is drawn
    label: str
    goniometer: bool  #: the sample tilts; otherwise the receiver goes around
    aperture_sd_deg: tuple[float, float]

    def incidences(self) -> Array:
        """Angles of incidence in the mirror plane that have a sample near the mirror direction."""
        near = self.planar & (np.abs(self.receiver_deg - self.incidence_deg) < 1.5)
        angles, _ = _common(self.incidence_deg[near])
        return angles[angles > 0.0] if np.any(angles > 0.0) else angles

    def plane(self, incidence_deg: float) -> tuple[Array, Array]:
        """Receiver angles and measured values in the mirror plane."""
        rows = self.planar & (np.abs(self.incidence_deg - incidence_deg) < _ANGLE_DEG)
        rows &= self.value[:, self.band] > 0.0
        return self.receiver_deg[rows], self.value[rows, self.band]

    @property
    def tilt_label(self) -> str:
        """What tilt_angles are."""
        return "mirror pair, sample tilted" if self.goniometer else "both polar angles, azimuth"

    def _tilt_key(self) -> Array:
        return self.difference_deg if self.goniometer else self.incidence_deg

    def _symmetric(self) -> Mask:
        return np.abs(self.incidence_deg - np.abs(self.receiver_deg)) < _ANGLE_DEG

    def tilt_angles(self) -> Array:
        """Angles for which samples leave the mirror direction across the plane."""
        angles, count = _common(self._tilt_key()[self._symmetric() & ~self.planar])
        return angles[(count >= 2) & (angles > 0.0)]

    def tilt(self, theta_deg: float) -> tuple[Array, Array]:
        """Half-vector angles and measured values across the plane."""
        rows = self._symmetric() & (np.abs(self._tilt_key() - theta_deg) < _ANGLE_DEG)
        rows &= self.value[:, self.band] > 0.0
        return self.half_deg[rows], self.value[rows, self.band]

    def tilt_directions(self, theta_deg: float) -> tuple[Array, Array]:
        """Directions of the fitted curve beside `tilt`."""
        if self.goniometer:
            return curves.tilted(theta_deg, np.linspace(0.0, 46.0, 185))
        return curves.around(theta_deg, np.linspace(0.0, 180.0, 361))

    def residuals(self) -> tuple[Array, Array]:
        """Half-vector angles and fitted over measured minus one in percent, all bands."""
        value = self.value[self.compared]
        seen = value > 0.0
        half = np.broadcast_to(self.half_deg[self.compared, None], seen.shape)[seen]
        return half, 100.0 * (self.fitted[seen] / value[seen] - 1.0)


def prepare(
    material: Material, measurement: Measurement, rows: Mask, most_residuals: int = 60_000
) -> Slices:
    """Slices of the marked samples, in the band of green light or the brightest one.

    most_residuals: of all bands, that are computed: those of samples picked evenly.
    """
    lamp, receiver = measurement.to_lamp[rows], measurement.to_receiver[rows]
    value = np.nan_to_num(measurement.radiance_factor[rows], nan=0.0, posinf=0.0, neginf=0.0)
    f = curves.facing(lamp, receiver)
    incidence, outgoing = (np.degrees(np.arccos(np.clip(m, 0.0, 1.0))) for m in (f.mu_i, f.mu_o))
    side = np.where(f.t > 0.0, -1.0, 1.0)
    sines = np.sin(np.radians(incidence)) * np.sin(np.radians(outgoing))
    bands = measurement.bands
    band = 1 if bands.is_rgb else int(np.argmin(np.abs(bands.centres_nm() - 540.0)))
    half, receiver_deg = np.degrees(np.sqrt(f.delta2)), side * outgoing
    aside2 = half**2 - 0.25 * (incidence - receiver_deg) ** 2
    count = min(max(most_residuals // bands.count, 1), len(value))
    compared = np.linspace(0, len(value) - 1, count).astype(np.int64)
    return Slices(
        value=np.maximum(value, 0.0),
        compared=compared,
        fitted=curves.seen(
            material, lamp[compared], receiver[compared], measurement.aperture_sd_deg
        ),
        incidence_deg=incidence,
        receiver_deg=receiver_deg,
        half_deg=half,
        difference_deg=np.degrees(np.arccos(np.clip(f.cos_d, 0.0, 1.0))),
        planar=np.asarray((np.abs(np.abs(f.t) - sines) < 1e-4) & (aside2 < _ASIDE_DEG**2)),
        band=band,
        label=bands.labels[band],
        goniometer=measurement.gamma_s_deg is not None,
        aperture_sd_deg=measurement.aperture_sd_deg,
    )


def _common(angles_deg: Array) -> tuple[Array, Ints]:
    """The commonest angle of each whole degree, (K,), and how many angles there are near it.

    A table may be measured at 41.38 degrees and nowhere near 41.
    """
    near, count = np.unique(np.round(angles_deg, _DIGITS), return_counts=True)
    _, first = np.unique(np.round(near), return_index=True)
    runs = list(itertools.pairwise([*first.tolist(), len(near)]))
    picked = np.array([a + int(np.argmax(count[a:b])) for a, b in runs], dtype=np.int64)
    total = [int(np.sum(count[a:b])) for a, b in runs]
    return near[picked], np.array(total, dtype=np.int64)


def some(values: Array, count: int) -> list[float]:
    """At most `count` of the values, evenly picked, the ends included."""
    if len(values) <= count:
        return [float(v) for v in values]
    return [
        float(values[k])
        for k in np.unique(np.linspace(0, len(values) - 1, count).round()).astype(int)
    ]


def receiver_angles(incidences: list[float], material: Material) -> Array:
    """Receiver angles for smooth curves: dense where a lobe peaks."""
    width = min([lobe.s_deg for lobe in material.specular], default=40.0)
    fine = np.linspace(-4.0, 4.0, 81) * max(width, 0.05)
    parts = [np.linspace(-80.0, 80.0, 321), *(i + fine for i in incidences)]
    angles = np.unique(np.concatenate(parts))
    return np.asarray(angles[np.abs(angles) <= 80.0])
