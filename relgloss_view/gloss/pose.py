"""Pose: where lamp and eye are about a form, and how bright a material's highlight is there.

The numbers belong to the pose and the material, not to a picture: they are the limits that pictures
of more and more pixels approach. Grain enters by the mean over its tilts (noise.mean_lobe).
"""

from __future__ import annotations

import math
import weakref
from functools import lru_cache

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.gloss.meter.meter import main_lobe
from relgloss_view.material import approximations, brdf
from relgloss_view.material.approximations import mean_lobe, plain_lobe
from relgloss_view.material.material import Material
from relgloss_view.material.spectra import illuminant
from relgloss_view.picture.frame import Extremes
from relgloss_view.picture.model import tone
from relgloss_view.picture.model.highlight import SIZE, Highlight, best_mirror
from relgloss_view.picture.model.light import front_white, lit_white
from relgloss_view.picture.model.sight import sight
from relgloss_view.picture.model.view import float32, view_of
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
        columns, rows = _places(view.bounds, self.highlight)
        hit, ray, _ = sight(setup.shape, view, columns, rows)
        ray, points, normals = ray[hit.found], hit.point_m[hit.found], hit.normal[hit.found]
        way = float32(setup.lamp.position_m) - points
        distance2 = np.maximum(np.sum(way * way, axis=-1), 1e-30)
        i = way / np.sqrt(distance2)[:, None]
        o = -ray / np.linalg.norm(ray, axis=-1, keepdims=True)
        self.facing = brdf.facing(normals, i, o)
        lit = np.maximum(self.facing.mu_i, 0.0) / distance2
        white = float(np.max(lit * (self.facing.mu_o > 0.0), initial=0.0))
        if setup.lamp.y_n == "front":
            white = front_white(setup, view)
        white = lit_white(white, setup)
        self._arriving = lit * (math.pi / white) if white > 0.0 else 0.0 * lit

    def peak(self, material: Material, sigma_n_deg: float = 0.0) -> float | None:
        """L_s* at the brightest place of a material's highlight; None where none is seen.

        The mirror's place must be within one width of the lobe with the highest peak, and the
        highlight visible: else what is seen is the skirt of a highlight that lies beside the
        object, which is no measure of gloss.
        """
        main = main_lobe(material)
        if self.highlight is None or main is None:
            return None
        width = math.hypot(material.specular[main].s_deg, sigma_n_deg)
        if self.highlight.tilt_deg > width:
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
        f, albedo = self.facing, np.asarray(material.diffuse.albedo)
        first, second = brdf.diffuse_shapes(material.diffuse.model, f, material.diffuse.sigma)
        diffuse = first * float(albedo @ weights)
        diffuse = diffuse + second * float(material.second_albedo() @ weights)
        specular = np.zeros_like(diffuse)
        sigma_n, bands = math.radians(sigma_n_deg), material.bands.count
        for lobe in material.specular:
            for part in lobe.parts(bands):
                if sigma_n > 0.0:
                    terms = mean_lobe(lobe.s, part.fresnel, sigma_n, "paper")
                    facets = "mean-gaussian"
                else:
                    terms, facets = plain_lobe(lobe.s, part.fresnel), "gaussian"
                reflected = approximations.torrance_sparrow(f, terms, "exact", "v-groove", facets)
                specular += reflected * float(part.spectrum @ weights)
        l_d, l_s = tone.split_lightness(self._arriving * diffuse, self._arriving * specular)
        return Extremes.over(l_d, l_s)


def _places(bounds: tuple[int, int, int, int], highlight: Highlight | None) -> tuple[Array, Array]:
    """Columns and rows of `SIZE`: an even grid, and finer and finer ones about the highlight."""
    left, bottom, right, top = bounds
    low = np.array([left, SIZE[1] - top], dtype=np.float64)
    high = np.array([right, SIZE[1] - bottom], dtype=np.float64)
    grids = [_grid(low, high, GRID)]
    if highlight is not None:
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
