"""Body: what the reference's points reflect, of one material or of a pack's finishes, as XYZ."""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.material import brdf
from relgloss_view.material.albedo_table import (
    ambient_reflection,
    diffuse_table,
    looked_up,
    surround,
)
from relgloss_view.material.brdf import Facing
from relgloss_view.material.material import Material
from relgloss_view.material.spectra import illuminant
from relgloss_view.pack.pack import Pack
from relgloss_view.pack.paint import paint_matrix, second_paint
from relgloss_view.picture.model import lights
from relgloss_view.picture.model.drawn import in_model
from relgloss_view.picture.model.lights import Arriving
from relgloss_view.picture.model.surface import Surface
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.scene import Scene


class Body(Protocol):
    """The reflection at points (...): BRDFs as XYZ relative to the perfect diffuser's, 1/sr."""

    bands: int  #: that are held at once

    def diffuse(self, f: Facing) -> Array:
        """(..., 3), of the diffuse part."""

    def specular(self, f: Facing, n: Array, light: Arriving, o: Array) -> Array:
        """(..., 3), of the lobes; n: the normals that f is of."""

    def ambient(self, mu_o: Array, lobe_mu_o: Array) -> Array:
        """(..., 3), what both together show of a uniform surround of radiance 1."""


class MaterialBody:
    """One material everywhere."""

    def __init__(self, scene: Scene) -> None:
        self._material = scene.material
        self._weights = scene.material.xyz_weights(illuminant(scene.lamp.illuminant))
        self.bands = scene.material.bands.count

    def diffuse(self, f: Facing) -> Array:
        """See Body."""
        return np.asarray(self._material.evaluate_facing(f)[0] @ self._weights)

    def specular(self, f: Facing, n: Array, light: Arriving, o: Array) -> Array:
        """See Body."""
        return np.asarray(lights.reflected(self._material, f, n, light, o) @ self._weights)

    def ambient(self, mu_o: Array, lobe_mu_o: Array) -> Array:
        """See Body."""
        diffuse, specular = ambient_reflection(self._material, mu_o, lobe_mu_o)
        return _surround(diffuse @ self._weights, specular @ self._weights)


class _Drawn(NamedTuple):
    """A finish as it is drawn."""

    inked: bool
    material: Material
    weights: Array  #: (B, 3), of its spectra


class PackBody:
    """The finishes of a pack, each by its share: f = sum of w_f f_f.

    The diffuse part of an ink is the artwork's colour; where nothing is printed, the albedo of the
    base finish's material shows, in the ink's own diffuse model.
    """

    def __init__(self, pack: Pack, scene: Scene, look: Look) -> None:
        lamp = illuminant(scene.lamp.illuminant)
        materials = [in_model(finish.material, look) for finish in pack.finishes]
        self._finishes = [
            _Drawn(finish.kind == "ink", material, material.xyz_weights(lamp))
            for finish, material in zip(pack.finishes, materials, strict=True)
        ]
        self._matrix = paint_matrix(pack.colour, lamp)
        self._own = [finish.sigma_n_deg for finish in pack.finishes]
        self._k = np.array([finish.k for finish in pack.finishes])
        self._sigma_n_deg = look.sigma_n_deg
        self.bands = max(drawn.material.bands.count for drawn in self._finishes)
        self._surface: Surface | None = None

    def put_at(self, surface: Surface) -> None:
        """The next questions are about the points of a surface."""
        self._surface = surface

    def sigma_n_deg(self) -> Array:
        """(...), sigma_N of each point."""
        own = [self._sigma_n_deg if sigma is None else sigma for sigma in self._own]
        return np.asarray(self._at().specular_shares @ np.array(own))

    def gloss_factor(self) -> Array:
        """(...), k of each point."""
        return np.asarray(self._at().specular_shares @ self._k)

    def diffuse(self, f: Facing) -> Array:
        """See Body."""
        surface = self._at()
        total = np.zeros((*f.mu_i.shape, 3))
        for k, drawn in enumerate(self._finishes):
            share = surface.diffuse_shares[..., k, None]
            if not np.any(share):
                continue
            model = drawn.material.diffuse
            if drawn.inked:
                first, second = brdf.diffuse_shapes(model.model, f, model.sigma)
                total += share * self._inked(drawn, first, second)
            else:
                total += share * (drawn.material.evaluate_facing(f)[0] @ drawn.weights)
        return total

    def specular(self, f: Facing, n: Array, light: Arriving, o: Array) -> Array:
        """See Body."""
        surface = self._at()
        total = np.zeros((*f.mu_i.shape, 3))
        for k, drawn in enumerate(self._finishes):
            share = surface.specular_shares[..., k, None]
            if np.any(share):
                total += share * (lights.reflected(drawn.material, f, n, light, o) @ drawn.weights)
        return total

    def ambient(self, mu_o: Array, lobe_mu_o: Array) -> Array:
        """See Body."""
        surface = self._at()
        diffuse, specular = np.zeros((*mu_o.shape, 3)), np.zeros((*mu_o.shape, 3))
        for k, drawn in enumerate(self._finishes):
            body, lobes = ambient_reflection(drawn.material, mu_o, lobe_mu_o)
            specular += surface.specular_shares[..., k, None] * (lobes @ drawn.weights)
            model = drawn.material.diffuse
            if drawn.inked:
                first, second = diffuse_table(model.model, model.sigma)
                shown = self._inked(drawn, looked_up(first, mu_o), looked_up(second, mu_o))
            else:
                shown = body @ drawn.weights
            diffuse += surface.diffuse_shares[..., k, None] * shown
        return _surround(diffuse, specular)

    def _inked(self, drawn: _Drawn, first: Array, second: Array) -> Array:
        """Two diffuse shapes of an ink, times the albedos of the artwork and of the bare base."""
        paint = self._at().paint
        printed, alpha = paint[..., :3], paint[..., 3]
        model, base = drawn.material.diffuse, self._finishes[0]
        bare = np.asarray(base.material.diffuse.albedo)
        bare_second = brdf.second_albedo(model.model, bare, model.sigma)
        seconds = second_paint(model.model, model.sigma, printed, alpha)
        shown = (1.0 - alpha)[..., None]
        albedo = printed @ self._matrix.T + shown * (bare @ base.weights)
        multiple = seconds @ self._matrix.T + shown * (bare_second @ base.weights)
        return np.asarray(first[..., None] * albedo + second[..., None] * multiple)

    def _at(self) -> Surface:
        assert self._surface is not None
        return self._surface


def _surround(diffuse: Array, lobes: Array) -> Array:
    """albedo_table.surround of XYZ (..., 3)."""
    return surround(diffuse, lobes, diffuse[..., 1], lobes[..., 1])
