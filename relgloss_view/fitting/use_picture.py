"""The picture of a fit against the picture of its table: the default cylinder, lit from a side.

A cylinder under a lamp and an eye at its own height shows one theta_d, nearly, over its whole
width, and all angles delta between normal and half-vector. So the table's own picture follows from
its departure at that theta_d (relgloss_view.fitting.departure) on the light of the fit. Half the
height is enough: the other half mirrors it. Each place stands for the same area of the picture.
"""

from __future__ import annotations

import dataclasses
from functools import lru_cache

import numpy as np

from relgloss_view.base.arrays import Array, Mask
from relgloss_view.fitting.departure import (
    BLUE,
    LUMINANCE,
    RED,
    Departures,
    Profile,
    profile,
)
from relgloss_view.fitting.results import PictureUse
from relgloss_view.material import brdf
from relgloss_view.material.material import Material
from relgloss_view.material.spectra import illuminant, xyz_weights
from relgloss_view.picture.model import shape, tone
from relgloss_view.picture.model.difference import delta_e_2000
from relgloss_view.picture.model.view import view_of
from relgloss_view.picture.scene.setup import Lamp, Setup

LAMPS_DEG = (50.0, 110.0)  #: azimuths: a highlight at a quarter of the way, and one at grazing
SIZE = (320, 320)  #: pixels; every column of a few rows is drawn
ROWS = (0.05, 0.25, 0.5, 0.75, 0.95)  #: of half the object's height
HIGHLIGHT_LSTAR = 1.0  #: L_s* from which a pixel belongs to the highlight
PERCENTILE = 95.0
#: dE2000 beyond which two pictures are not of one sample.
POOR_DELTA_E = 6.0


def picture_uses(material: Material, samples: Departures | str) -> tuple[PictureUse, ...]:
    """One row for each lamp."""
    return tuple(_use(material, samples, azimuth) for azimuth in LAMPS_DEG)


def poor_picture(use: PictureUse) -> bool:
    """Whether a fit's picture is not the table's, by more than noise explains."""
    values = (use.highlight_beyond_noise, use.object_beyond_noise)
    return any(value is not None and value > POOR_DELTA_E for value in values)


def _use(material: Material, samples: Departures | str, azimuth: float) -> PictureUse:
    empty = PictureUse(azimuth, None, None, None, None, None, "")
    if isinstance(samples, str):
        return dataclasses.replace(empty, reason=samples)
    f, arriving, theta_d = _places(azimuth)
    delta = np.degrees(np.sqrt(f.delta2))
    departure = profile(samples, theta_d, float(np.max(delta)))
    if isinstance(departure, str):
        return dataclasses.replace(empty, reason=departure)
    if departure.coarse:
        return dataclasses.replace(empty, reason=departure.coarse)
    lamp = illuminant(Lamp().illuminant)
    weights = xyz_weights(material.bands, lamp)
    diffuse, specular = (
        arriving[:, None] * (part @ weights) for part in material.evaluate_facing(f)
    )
    seen = delta <= departure.reach_deg
    if not np.any(seen):
        return dataclasses.replace(empty, reason="the table shows no half-vector but the normal")
    pictures = _Pictures(diffuse[seen], specular[seen], delta[seen], departure, lamp.white_xyz())
    return pictures.compared(azimuth)


@lru_cache(maxsize=4)
def _places(azimuth: float) -> tuple[brdf.Facing, Array, float]:
    """Places of the picture: their orientation, the light that arrives, theta_d at the highlight.

    The light is relative to the perfect diffuser's largest, as in a picture.
    """
    setup = Setup(lamp=Lamp(azimuth_deg=azimuth))
    view = view_of(setup.shape, setup.eye, SIZE)
    half = 0.5 * SIZE[1]
    left, bottom, right, top = view.bounds
    columns = np.arange(left, right, dtype=np.float64)
    rows = half - 0.5 - np.array(ROWS) * 0.5 * (top - bottom)
    ray = view.rays_at(columns[None, :] + 0.0 * rows[:, None], rows[:, None] + 0.0 * columns)
    hit = shape.meet(setup.shape.kind, view.eye_m, ray, setup.shape.half_extent_m())
    to_lamp = setup.lamp.position_m - hit.point_m
    distance2 = np.sum(to_lamp * to_lamp, axis=-1)
    i = to_lamp / np.sqrt(distance2)[..., None]
    o = -ray / np.linalg.norm(ray, axis=-1, keepdims=True)
    f = brdf.facing(hit.normal, i, o)
    lit = hit.found & (f.mu_i > 0.0) & (f.mu_o > 0.0)
    f = brdf.Facing(*(part[lit] for part in f))
    arriving = np.maximum(f.mu_i, 0.0) / distance2[lit]
    at_highlight = float(f.cos_d[np.argmin(f.delta2)])
    return f, np.pi * arriving / np.max(arriving), float(np.degrees(np.arccos(at_highlight)))


class _Pictures:
    """The two pictures of one lamp, pixel by pixel, with the same c."""

    def __init__(
        self, diffuse: Array, specular: Array, delta: Array, departure: Profile, white: Array
    ) -> None:
        self._diffuse, self._specular, self._white = diffuse, specular, white
        self._log = [departure.at(delta, channel) for channel in (LUMINANCE, RED, BLUE)]
        self._error = [departure.error_at(delta, channel) for channel in (LUMINANCE, RED, BLUE)]
        self._split = self._table(*self._log)
        l_d, l_s = self._split[:, 0], self._split[:, 1]
        # c_max of the table's own picture: its brightest pixel just fits the display. Above 1 it
        # would exaggerate, and noise with it.
        self.c = float(np.clip(np.min(tone.largest_c(l_d, l_s)), 0.0, 1.0))

    def _table(self, luminance: Array, red: Array, blue: Array) -> Array:
        """The split of the fit's light times a departure."""
        factor = np.exp(np.stack([luminance + red, luminance, luminance + blue], axis=1))
        total = (self._diffuse + self._specular) * factor
        # What exceeds the fit's own body colour is gloss; what falls short of it is the body's.
        diffuse = np.minimum(self._diffuse, total)
        return tone.split_lab(diffuse, total - diffuse, self._white)

    def compared(self, azimuth: float) -> PictureUse:
        """dE2000 over the highlight and over the object, with and without what noise explains."""
        fit_split = tone.split_lab(self._diffuse, self._specular, self._white)
        table = tone.scaled_lab(self._split, self.c)
        difference = delta_e_2000(tone.scaled_lab(fit_split, self.c), table)
        noise2 = np.zeros_like(difference)
        for channel in range(3):
            moved = list(self._log)
            moved[channel] = moved[channel] + self._error[channel]
            noise2 += delta_e_2000(tone.scaled_lab(self._table(*moved), self.c), table) ** 2
        beyond = np.maximum(difference - 2.0 * np.sqrt(noise2), 0.0)
        highlight = np.maximum(self._split[:, 1], fit_split[:, 1]) > HIGHLIGHT_LSTAR

        def p95(values: Array, pixels: Mask) -> float | None:
            return float(np.percentile(values[pixels], PERCENTILE)) if np.any(pixels) else None

        everywhere = np.ones(len(difference), dtype=bool)
        return PictureUse(
            lamp_azimuth_deg=azimuth,
            highlight=p95(difference, highlight),
            highlight_beyond_noise=p95(beyond, highlight),
            whole_object=p95(difference, everywhere),
            object_beyond_noise=p95(beyond, everywhere),
            c=self.c,
            reason="",
        )
