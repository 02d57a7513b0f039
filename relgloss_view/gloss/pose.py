"""Pose: where lamp and eye are about a form, and how bright a material's highlight is there.

The numbers belong to the pose and the material, not to a picture: they are the limits that pictures
of more and more pixels approach. Grain enters by the mean over its tilts (noise.mean_lobe).
"""

from __future__ import annotations

import math
import weakref
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.gloss.meter.meter import main_lobe
from relgloss_view.material import approximations, brdf
from relgloss_view.material.albedo_table import ambient_reflection, surround
from relgloss_view.material.approximations import mean_lobe, plain_lobe
from relgloss_view.material.material import Material
from relgloss_view.material.spectra import illuminant
from relgloss_view.picture.frame import Extremes
from relgloss_view.picture.model import lights, tone
from relgloss_view.picture.model.highlight import SIZE, Highlight, best_mirror, each_lamp
from relgloss_view.picture.model.light import front_white, lamps_irradiance, lit_white
from relgloss_view.picture.model.sight import sight
from relgloss_view.picture.model.view import view_of
from relgloss_view.picture.scene.setup import Setup

GRID = 41  #: points along each side of the whole object
NEAR_GRID = 13  #: and of each of the ever smaller squares about the mirror's place
SQUARES = 8
LEAST_LSTAR = 1.0  #: L_s* of a highlight that counts as visible
NARROWER = (
    0.4  #: the last square is 0.4^8 = 0.0007 of the object: 0.04 degrees of a cylinder's turn
)


class Pose:
    """The points of a setup's object that count for its highlight, with their orientation.

    >>> from relgloss_view import load_sample
    >>> pose = Pose(Setup())
    >>> cast, matte = (pose.extremes(load_sample(n)) for n in ("cast-coated", "matte-coated"))
    >>> cast.l_s_max > matte.l_s_max
    True
    """

    def __init__(self, setup: Setup) -> None:
        self.setup = setup
        self._known: dict[int, dict[float, Extremes]] = {}  #: by material and sigma_N
        self.highlight: Highlight | None = best_mirror(setup)
        view = view_of(setup.shape, setup.eye, SIZE)
        highlights = [best_mirror(by_itself) for by_itself in each_lamp(setup)]
        seen = [highlight for highlight in highlights if highlight is not None]
        self._tilts_deg = [highlight.tilt_deg for highlight in seen]
        columns, rows = _places(view.bounds, seen)
        hit, ray, _ = sight(setup.shape, view, columns, rows)
        ray, points, normals = ray[hit.found], hit.point_m[hit.found], hit.normal[hit.found]
        o = -ray / np.linalg.norm(ray, axis=-1, keepdims=True)
        self._mu_o = np.sum(normals * o, axis=-1)
        lamps = list(lights.lit(setup, points))
        facings = [brdf.facing(normals, light.i, o) for light in lamps]
        lit = [
            np.maximum(f.mu_i, 0.0) / light.distance2
            for f, light in zip(facings, lamps, strict=True)
        ]
        white = float(np.max(sum(lit) * (self._mu_o > 0.0), initial=0.0))
        if setup.lamp.y_n == "front":
            white = front_white(setup, view)
        power = lamps_irradiance(lit_white(white, setup), setup)
        self._lights = [
            _Light(f, lights.across(normals, light.i, o, f), light.sin2_r, power * received)
            for f, light, received in zip(facings, lamps, lit, strict=True)
        ]

    def peak(self, material: Material, sigma_n_deg: float = 0.0) -> float | None:
        """L_s* at the brightest place of a material's highlight; None where none is seen.

        The mirror's place of one of the lamps must be within one width of the lobe with the
        highest peak, and the highlight visible: else what is seen is the skirt of a highlight that
        lies beside the object, which is no measure of gloss.
        """
        main = main_lobe(material)
        if not self._tilts_deg or main is None:
            return None
        width = math.hypot(material.specular[main].s_deg, sigma_n_deg)
        if min(self._tilts_deg) > width:
            return None
        brightest = self.extremes(material, sigma_n_deg).l_s_max
        return brightest if brightest >= LEAST_LSTAR else None

    def extremes(self, material: Material, sigma_n_deg: float = 0.0) -> Extremes:
        """Extremes of L_d* and L_s* over the object, as a picture without end of pixels has them.

        sigma_n_deg: of the grain, whose tilts are averaged in linear light (the paper's law).
        """
        known = self._known.get(id(material))
        if known is None:
            # A material is frozen but not hashable; its identity serves while it lives.
            known = self._known[id(material)] = {}
            weakref.finalize(material, self._known.pop, id(material), None)
        if sigma_n_deg not in known:
            known[sigma_n_deg] = self._extremes(material, sigma_n_deg)
        return known[sigma_n_deg]

    def _extremes(self, material: Material, sigma_n_deg: float) -> Extremes:
        weights = material.xyz_weights(illuminant(self.setup.lamp.illuminant))[:, 1]
        albedo, model = np.asarray(material.diffuse.albedo), material.diffuse.model
        diffuse, specular = np.zeros_like(self._mu_o), np.zeros_like(self._mu_o)
        for light in self._lights:
            first, second = brdf.diffuse_shapes(model, light.facing, material.diffuse.sigma)
            shapes = first * float(albedo @ weights)
            shapes = shapes + second * float(material.second_albedo() @ weights)
            diffuse += light.arriving * shapes
            specular += light.arriving * _shine(light, material, sigma_n_deg, weights)
        if self.setup.lamp.ambient > 0.0:
            body, lobes = (
                part @ weights for part in ambient_reflection(material, self._mu_o, self._mu_o)
            )
            shown = surround(body[..., None], lobes[..., None], body, lobes)
            diffuse += self.setup.lamp.ambient * shown[..., 0]
        return Extremes.over(*tone.split_lightness(diffuse, specular))


class _Light(NamedTuple):
    """One lamp at the points of a pose."""

    facing: brdf.Facing
    across: Array
    sin2_r: Array | float
    arriving: Array  #: irradiance over pi times that of Y_n


def _shine(light: _Light, material: Material, sigma_n_deg: float, weights: Array) -> Array:
    """What the lobes reflect of a lamp's light, the tilts of grain averaged."""
    specular = np.zeros_like(light.arriving)
    sigma_n, sized = math.radians(sigma_n_deg), not isinstance(light.sin2_r, float)
    for lobe in material.specular:
        for part in lobe.parts(material.bands.count):
            f, peak = light.facing, np.asarray(1.0)
            if sigma_n > 0.0:
                terms = mean_lobe(lobe.s, part.fresnel, sigma_n, "paper")
                facets = "mean-gaussian"
                if sized:
                    terms = lights.widened(terms, f.cos_d, light.sin2_r)
            else:
                terms, facets = plain_lobe(lobe.s, part.fresnel), "gaussian"
                if sized:
                    delta2, peak = lights.spread_by_lamp(
                        f, terms.sharpness, light.across, light.sin2_r
                    )
                    f = f._replace(delta2=delta2)
            reflected = approximations.torrance_sparrow(f, terms, "exact", "v-groove", facets)
            specular += peak * reflected * float(part.spectrum @ weights)
    return specular


def _places(bounds: tuple[int, int, int, int], highlights: list[Highlight]) -> tuple[Array, Array]:
    """Columns and rows of `SIZE`: an even grid, and finer and finer ones about the highlights."""
    left, bottom, right, top = bounds
    low = np.array([left, SIZE[1] - top], dtype=np.float64)
    high = np.array([right, SIZE[1] - bottom], dtype=np.float64)
    grids = [_grid(low, high, GRID)]
    for highlight in highlights:
        centre = np.array(highlight.place) * SIZE
        half = 0.5 * (high - low)
        for k in range(1, SQUARES + 1):
            reach = NARROWER**k * half
            grids.append(_grid(centre - reach, centre + reach, NEAR_GRID))
    columns, rows = np.concatenate(grids, axis=1) - 0.5
    return columns, rows


def _grid(low: Array, high: Array, count: int) -> Array:
    axes = (np.linspace(a, b, count) for a, b in zip(low, high, strict=True))
    return np.stack([axis.ravel() for axis in np.meshgrid(*axes)])


@lru_cache(maxsize=64)
def pose_of(setup: Setup) -> Pose:
    """The pose of a setup; the same object for an equal setup."""
    return Pose(setup)
