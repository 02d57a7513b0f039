"""Proxy: a few pixels of a picture in float64, drawn by any method, and the error of the method.

The pixels are those of the picture itself, so that each has its own grain. They are denser about
the highlight and at the silhouette, where methods fail first and which an even grid of so few would
miss. Each has a weight: the area that it represents.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.display.model import DisplayModel
from relgloss_view.material import approximations, brdf
from relgloss_view.material.approximations import mean_lobe, plain_lobe
from relgloss_view.material.spectra import illuminant
from relgloss_view.picture.frame import Extremes, Scaling
from relgloss_view.picture.gpu.variant import Variant
from relgloss_view.picture.method import EXACT, Method
from relgloss_view.picture.model import tone
from relgloss_view.picture.model.difference import delta_e_2000
from relgloss_view.picture.model.drawn import as_drawn, drawn_lobes
from relgloss_view.picture.model.grain import grain_normal
from relgloss_view.picture.model.light import front_white, lit_white
from relgloss_view.picture.model.view import Size, View, float32
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.quality.sampling import meet, places

GAMUT_MARGIN = 0.002  #: of linear RGB
GRAIN_SHARES = (0.0, 0.01, 0.03, 0.1, 0.2, 0.4, 0.7, 1.0)  #: of a mirroring grain's highlight
HIGHLIGHT_LSTAR = 1.0  #: L_s* from which a pixel belongs to the highlight


@dataclass(frozen=True)
class Deviation:
    """CIEDE2000 of what a method draws: its 95th percentiles by area, and its largest."""

    object_p95: float
    highlight_p95: float
    largest: float


@dataclass(frozen=True)
class ProxyPicture:
    """The proxy's pixels as a method draws them."""

    lab: Array  #: (N, 3), of what the display shows
    l_s: Array  #: (N,), before scaling


class Proxy:
    """The pixels of one scene, look and size that meet the object."""

    def __init__(self, scene: Scene, look: Look, size: Size) -> None:
        self.scene, self.look = as_drawn(scene, look), look
        self._view = View.of(scene, size)
        columns, rows, self.area = places(self.scene, self._view)
        self._pixel = np.stack([columns, rows], axis=-1).astype(np.int64)
        self._hit, self._o = meet(self.scene, self._view, columns, rows)
        self._errors: dict[Method, Deviation] = {}
        self._facings: dict[tuple[str, bool], tuple[brdf.Facing, Array]] = {}

    @property
    def empty(self) -> bool:
        """Whether no pixel meets the object."""
        return len(self.area) == 0

    @cached_property
    def exact(self) -> ProxyPicture:
        """As the whole model draws it."""
        return self.draw(EXACT)

    def error(self, method: Method) -> Deviation:
        """What a method gets wrong in this picture."""
        if method not in self._errors:
            self._errors[method] = self._measured(method)
        return self._errors[method]

    @property
    def dark(self) -> bool:
        """Whether no pixel is lit."""
        facing, arriving = self._facing("point", tilted=False)
        return not np.any((facing.mu_i > 0.0) & (facing.mu_o > 0.0) & (arriving > 0.0))

    def _measured(self, method: Method) -> Deviation:
        if self.empty:
            return Deviation(0.0, 0.0, 0.0)
        difference = delta_e_2000(self.exact.lab, self.draw(method).lab)
        highlight = self.exact.l_s > HIGHLIGHT_LSTAR
        return Deviation(
            _p95(difference, self.area),
            _p95(difference[highlight], self.area[highlight]),
            float(np.max(difference, initial=0.0)),
        )

    def draw(self, method: Method) -> ProxyPicture:
        """The pixels by a method. Raises InputError where no c can show them (Scaling.of)."""
        split, c = self._scaled(*self._light(method), method)
        display = DisplayModel.of(self.scene.display)
        if method.gamut != "as asked":
            display = dataclasses.replace(display, gamut=method.gamut)
        rgb = tone.as_shown(tone.display_rgb(tone.scaled_lab(split, c), display)[0], display)
        return ProxyPicture(
            tone.lab_from_xyz(rgb @ display.xyz_from_rgb.T, display.white), split[:, 1]
        )

    def leaves_gamut(self, method: Method) -> bool:
        """Whether the display can't show some colours by a method, or only just.

        Grain makes few pixels far brighter than these may be; so under grain each is tried with no
        highlight at all, with that of a grain that mirrors the lamp, and between.
        """
        diffuse, specular = self._light(method)
        _, c = self._scaled(diffuse, specular, method)
        tried = [specular]
        if Variant.of(self.scene, self.look, 1, method).noise != "none":
            _, mirrored = self._light(method, mirrored=True)
            tried += [share * mirrored for share in GRAIN_SHARES]
        display = DisplayModel.of(self.scene.display)
        white = illuminant(self.scene.lamp.illuminant).white_xyz()
        for light in tried:
            lab = tone.scaled_lab(tone.split_lab(diffuse, light, white), c)
            lab[:, 0] = np.clip(lab[:, 0], 0.0, 100.0)
            rgb = tone.xyz_from_lab(lab, display.white) @ display.rgb_from_xyz.T
            if np.any(rgb < -tone.GAMUT_TOLERANCE) or np.any(rgb > 1.0 - GAMUT_MARGIN):
                return True
        return False

    def _light(self, method: Method, *, mirrored: bool = False) -> tuple[Array, Array]:
        """Diffuse and specular XYZ, (N, 3) each; `mirrored`: each grain faces the half-vector."""
        scene, look = self.scene, self.look
        variant = Variant.of(scene, look, 1, method)
        material, lamp = scene.material, illuminant(scene.lamp.illuminant)
        weights = material.xyz_weights(lamp)
        smooth, arriving = self._facing(variant.lamp, tilted=False)
        white = float(np.max(np.maximum(smooth.mu_i, 0.0) * arriving * (smooth.mu_o > 0.0)))
        if scene.lamp.y_n == "front":
            white = front_white(scene.setup, self._view)
        white = lit_white(white, scene.setup)
        arriving = arriving * (np.pi / white) if white > 0.0 else 0.0 * arriving
        grain = self._facing(variant.lamp, tilted=variant.noise != "none")[0]
        under = grain if variant.noisy_diffuse else smooth
        grain = grain._replace(delta2=0.0 * grain.delta2) if mirrored else grain

        albedo, sigma = np.asarray(material.diffuse.albedo), material.diffuse.sigma
        second = brdf.second_albedo(variant.diffuse, albedo, sigma)
        shapes = brdf.diffuse_shapes(variant.diffuse, under, sigma)
        diffuse = shapes[0][:, None] * (albedo @ weights) + shapes[1][:, None] * (second @ weights)
        diffuse *= (arriving * np.maximum(under.mu_i, 0.0))[:, None]
        specular = np.zeros_like(diffuse)
        for lobe in drawn_lobes(material, method):
            for part in lobe.parts(material.bands.count):
                terms = plain_lobe(lobe.s, part.fresnel)
                if variant.facets == "mean-gaussian":
                    sigma_n = float(np.radians(look.sigma_n_deg))
                    terms = mean_lobe(lobe.s, part.fresnel, sigma_n, look.noise_law)
                reflected = approximations.torrance_sparrow(
                    grain, terms, variant.fresnel, variant.shadowing, variant.facets
                )
                specular += reflected[:, None] * (part.spectrum @ weights)
        specular *= (arriving * np.maximum(grain.mu_i, 0.0))[:, None]
        return diffuse, specular

    def _scaled(self, diffuse: Array, specular: Array, method: Method) -> tuple[Array, float]:
        """(L_d*, L_s*, a*, b*), (N, 4), and the c that scales them."""
        white = illuminant(self.scene.lamp.illuminant).white_xyz()
        split = tone.split_lab(diffuse, specular, white)
        if method.targets == "float16":
            split = split.astype(np.float16).astype(np.float64)
        counted = np.ones(len(split), dtype=bool)
        if method.c_max == "sparse":
            left, bottom, *_ = self._view.bounds
            up = self._view.size[1] - 1 - self._pixel[:, 1]
            counted = ((self._pixel[:, 0] - left) % 2 == 0) & ((up - bottom) % 2 == 0)
        extremes = Extremes.over(*split[counted, :2].T)
        scaling = Scaling.of(self.look, extremes, eq4=method.c_max == "eq4")
        return split, scaling.c

    def _facing(self, lamp: str, *, tilted: bool) -> tuple[brdf.Facing, Array]:
        """How the points stand to lamp and eye, and one over the squared distance to the lamp."""
        key = lamp, tilted
        if key not in self._facings:
            normal = self._hit.normal
            if tilted:
                normal = grain_normal(self.scene, self.look, self._hit, self._o, self._pixel)
            origin = 0.0 if lamp == "distant" else self._hit.point_m
            way = float32(self.scene.lamp.position_m) - origin
            distance2 = np.maximum(np.sum(way * way, axis=-1, keepdims=True), 1e-30)
            i = np.broadcast_to(way / np.sqrt(distance2), normal.shape)
            per_distance2 = np.broadcast_to(1.0 / distance2[..., 0], normal.shape[:1])
            self._facings[key] = brdf.facing(normal, i, self._o), per_distance2
        return self._facings[key]


def _p95(values: Array, area: Array) -> float:
    """95th percentile by area; 0 of nothing."""
    if len(values) == 0:
        return 0.0
    order = np.argsort(values)
    share = np.cumsum(area[order])
    return float(values[order][np.searchsorted(share, 0.95 * share[-1])])
