"""A material in few channels: its BRDF folded into linear sRGB, XYZ or any weights of its bands.

The shapes of the models are free of wavelength, so a fold of the spectra is exact, and tables of
millions of directions need three numbers each instead of a spectrum.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.exchange.loss import LAMP, Surface
from relgloss_view.material import brdf
from relgloss_view.material.material import Material
from relgloss_view.material.spectra import illuminant, xyz_weights
from relgloss_view.measure.bands import RGB


@dataclass(frozen=True)
class Folded:
    """A material whose spectra are folded into C channels."""

    material: Material
    weights: Array  #: (B, C)

    def brdf(self, i: Array, o: Array) -> Array:
        """BRDF (M, C) in 1/sr of unit vectors (M, 3), zero below the horizon."""
        mu_i, mu_o = i[:, 2], o[:, 2]
        t = i[:, 0] * o[:, 0] + i[:, 1] * o[:, 1]
        half = i + o
        level = half[:, 0] ** 2 + half[:, 1] ** 2
        cos_d = 0.5 * np.sqrt(level + half[:, 2] ** 2)
        delta = np.arctan2(np.sqrt(level), half[:, 2])
        f = brdf.Facing(mu_i, mu_o, t, cos_d, delta * delta)
        body, count = self.material.diffuse, self.material.bands.count
        first, second = brdf.diffuse_shapes(body.model, f, body.sigma)
        total = np.outer(first, np.asarray(body.albedo) @ self.weights)
        total += np.outer(second, self.material.second_albedo() @ self.weights)
        for lobe in self.material.visible_lobes():
            for part in lobe.parts(count):
                shape = brdf.torrance_sparrow(f, lobe.s, part.fresnel)
                total += np.outer(shape, part.spectrum @ self.weights)
        return total


def in_rgb(material: Material) -> Folded:
    """In linear sRGB under D65; a channel below 0 where sRGB lacks the colour."""
    lamp = illuminant(LAMP)
    xyz = material.xyz_weights(lamp)
    return Folded(material, xyz @ np.linalg.inv(xyz_weights(RGB, lamp)))


def in_xyz(material: Material) -> Folded:
    """In CIE XYZ under D65, Y = 1 of the perfect diffuser's radiance factor."""
    return Folded(material, material.xyz_weights(illuminant(LAMP)))


def metal_notes(material: Material) -> tuple[str, ...]:
    """How a table of a metal comes back: a fit has to find the metal again."""
    if not any(lobe.is_metal for lobe in material.visible_lobes()):
        return ()
    return (
        "a table does not state that this is a metal: relgloss fit finds it by its brightness; "
        "compare the gloss of both",
    )


@dataclass(frozen=True)
class TableSurface(Surface):
    """The surface of a table, of which the judge needs the sum of both parts alone.

    values: linear sRGB BRDF (M, 3) of unit vectors (M, 3) each; what was not measured counts as 0.
    """

    values: Callable[[Array, Array], Array]

    def evaluate(self, i: Array, o: Array) -> tuple[Array, Array]:
        """Nothing diffuse, and the table's value."""
        i, o = np.broadcast_arrays(i, o)
        found = self.values(i.reshape(-1, 3), o.reshape(-1, 3)).reshape(*i.shape[:-1], 3)
        total = np.nan_to_num(found, nan=0.0)
        return np.zeros_like(total), total
