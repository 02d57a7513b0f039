"""A material in another colour: its lobes stay, its diffuse part gives the colour at 45/0.

The colour is that of spectrophotometers for print (ISO 13655:2017): lamp at 45 degrees, receiver
along the normal, CIE 1931 observer (2 degrees), by default under D50. What the lobes send there is
part of the reading.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from relgloss_view.base.arrays import Array
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable, text
from relgloss_view.material import brdf
from relgloss_view.material.cielab import lab_from_xyz, xyz_from_lab
from relgloss_view.material.material import Lobe, Material
from relgloss_view.material.reflectance import (
    check_lab,
    nearest_lightness,
    possible,
    xyz_to_spectrum,
)
from relgloss_view.material.spectra import illuminant as lamp_of
from relgloss_view.material.spectra import xyz_weights
from relgloss_view.measure.bands import SRGB, WIDE_RGB, Bands

DEFAULT_ILLUMINANT = "D50"  #: of ISO 13655
BISECTIONS = 60


@dataclass(frozen=True)
class Colour:
    """The colour of a sample as a spectrophotometer reads it, in place of its own.

    lab: L*, a*, b* at 45/0 for the CIE 1931 observer (2 degrees). lab_illuminant: the lamp of these
    numbers, by name or file; D50 is that of ISO 13655. Raises InputError where a value is out of
    range.

    >>> Colour((50, 60, 20)).words
    'Lab 50 60 20'
    """

    lab: tuple[float, float, float] = dataclasses.field(
        metadata={
            "option": "--lab",
            "label": "Colour (L, a, b)",
            "meaning": "colour of the sample at 45/0 (D50, 2 degrees) as CIELAB L,a,b: the diffuse "
            "part changes, the highlight stays",
        }
    )
    lab_illuminant: str = dataclasses.field(
        default=DEFAULT_ILLUMINANT,
        metadata={
            "option": "--lab-illuminant",
            "label": "Lamp of the colour",
            "meaning": f"lamp of --lab, a name or a file (default {DEFAULT_ILLUMINANT})",
        },
    )

    def __post_init__(self) -> None:
        lab = check_lab(self.lab)
        object.__setattr__(self, "lab", tuple(lab.tolist()))
        lamp_of(text(self.lab_illuminant, "lab_illuminant"))

    @property
    def words(self) -> str:
        """The colour as people read it."""
        lamp = self.lab_illuminant
        under = "" if lamp == DEFAULT_ILLUMINANT else f" under {printable(lamp, 60)}"
        return "Lab " + " ".join(f"{value:.4g}" for value in self.lab) + under


def colour_of(material: Material, illuminant: str = DEFAULT_ILLUMINANT) -> Array:
    """L*, a*, b* (3,) of a material at 45/0 under a lamp, CIE 1931 observer (2 degrees).

    >>> from relgloss_view.material.material import Diffuse
    >>> from relgloss_view.measure.bands import RGB
    >>> gray = Material("gray", "by hand", RGB, Diffuse("lambert", (0.2, 0.2, 0.2)))
    >>> np.abs(colour_of(gray).round(2)).tolist()
    [51.84, 0.0, 0.0]
    """
    lamp = lamp_of(illuminant)
    diffuse, specular = material.evaluate_facing(_at_45_0())
    xyz = np.pi * (diffuse + specular) @ xyz_weights(material.bands, lamp)
    return lab_from_xyz(xyz, lamp.white_xyz())


def recoloured(material: Material, colour: Colour, name: str | None = None) -> Material:
    """The material with the diffuse part that gives a colour at 45/0; its lobes are the same.

    The diffuse part's radiance factor is the smooth spectrum of reflectance.xyz_to_spectrum for the
    colour less the lobes' own light; the albedo follows from it in each band. A material of linear
    sRGB becomes one of Rec. 2020 where the colour needs that. name: the first part of its name, in
    place of the material's own, which may hold that of an ink. Raises InputError where no diffuse
    part gives the colour, with the nearest possible lightness.
    """
    lamp = lamp_of(colour.lab_illuminant)
    white = lamp.white_xyz()

    def wanted(basis: Material, lab: ArrayLike) -> tuple[Array, Array]:
        """XYZ that the diffuse part has to give, per unit of its lightest, and the weights."""
        weights = xyz_weights(basis.bands, lamp)
        _, specular = basis.evaluate_facing(_at_45_0())
        left = xyz_from_lab(np.asarray(lab, dtype=np.float64), white) - np.pi * specular @ weights
        return left / _lightest(basis), weights

    for basis in _bases(material):
        xyz, weights = wanted(basis, colour.lab)
        factor = xyz_to_spectrum(xyz, basis.bands, weights)
        if factor is None:
            continue
        albedo = _albedo_of(basis, factor * _lightest(basis))
        return _named(basis, colour, tuple(albedo.tolist()), name or material.name)

    def fits(lab: Array) -> bool:
        xyz, weights = wanted(basis, lab)
        return possible(xyz, basis.bands, weights)

    raise InputError(_refusal(material, colour, basis.bands, fits))


def _at_45_0() -> brdf.Facing:
    up = np.array([0.0, 0.0, 1.0])
    return brdf.facing(up, np.array([math.sqrt(0.5), 0.0, math.sqrt(0.5)]), up)


def _lightest(material: Material) -> float:
    """The radiance factor of the diffuse part at 45/0 where its albedo is 1."""
    first, second = _shapes(material)
    return float(np.pi * (first + second * _second(material, np.ones(1))[0]))


def _albedo_of(material: Material, factor: Array) -> Array:
    """The albedos (B,), 0 to 1, of radiance factors (B,): they rise together, so by bisection."""
    first, second = _shapes(material)
    low, high = np.zeros_like(factor), np.ones_like(factor)
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        below = np.pi * (first * middle + second * _second(material, middle)) < factor
        low, high = np.where(below, middle, low), np.where(below, high, middle)
    return np.asarray(0.5 * (low + high))


def _shapes(material: Material) -> tuple[float, float]:
    """The two shapes of the diffuse model at 45/0, 1/sr."""
    diffuse = material.diffuse
    first, second = brdf.diffuse_shapes(diffuse.model, _at_45_0(), diffuse.sigma)
    return float(first), float(second)


def _second(material: Material, albedo: Array) -> Array:
    return brdf.second_albedo(material.diffuse.model, albedo, material.diffuse.sigma)


def _bases(material: Material) -> tuple[Material, ...]:
    """The material in its own bands and, if these are linear sRGB, in the wider Rec. 2020."""
    bands = material.bands
    if not bands.is_rgb or bands.primaries != SRGB:
        return (material,)
    lamp = lamp_of(DEFAULT_ILLUMINANT)  # any: both triples have the same white
    matrix = xyz_weights(bands, lamp) @ np.linalg.inv(xyz_weights(WIDE_RGB, lamp))

    def wide(values: tuple[float, ...]) -> tuple[float, ...]:
        if len(set(values)) == 1:  # a gray is the same
            return values
        return tuple(np.maximum(np.asarray(values) @ matrix, 0.0).tolist())

    def lobe(one: Lobe) -> Lobe:
        f0 = None if one.f0 is None else wide(one.f0)
        return dataclasses.replace(one, strength=wide(one.strength), f0=f0)

    diffuse = dataclasses.replace(material.diffuse, albedo=wide(material.diffuse.albedo))
    lobes = tuple(lobe(one) for one in material.specular)
    changed = dataclasses.replace(material, bands=WIDE_RGB, diffuse=diffuse, specular=lobes)
    return (material, changed)


def _named(material: Material, colour: Colour, albedo: tuple[float, ...], name: str) -> Material:
    kind = "synthetic, hypothetical" if material.synthetic else "hypothetical"
    fit = material.fit
    if fit is not None:  # its quality and warnings are those of the lobes; these are of the colour
        fit = dataclasses.replace(fit, derived={}, judgement={}, covariance={})
    estimate = material.estimate
    return dataclasses.replace(
        material,
        name=f"{name}, colour {colour.words}",
        source=f"{kind}: diffuse part changed to {colour.words} at 45/0; made from {material.name} "
        f"({material.source})",
        diffuse=dataclasses.replace(material.diffuse, albedo=albedo),
        fit=fit,
        estimate=None if estimate is None else estimate.for_another_body(),
        hypothetical=True,
    )


def _refusal(
    material: Material, colour: Colour, bands: Bands, fits: Callable[[Array], bool]
) -> str:
    """The sentence that refuses a colour which no diffuse part gives."""
    name = printable(material.name, 60)
    words = f"lab {', '.join(f'{value:g}' for value in colour.lab)}: {name} can't have this colour "
    words += f"under {printable(colour.lab_illuminant, 60)}"
    near = nearest_lightness(np.array(colour.lab), fits)
    if near is None:
        gamut = f" in its {bands.words}" if bands.is_rgb else ""
        return f"{words}{gamut}, whatever its lightness; use a and b nearer to 0"
    if near < colour.lab[0]:
        limit = f"L can be at most {math.floor(10.0 * near) / 10.0:g}"
        return f"{words}; with these a and b, {limit}"
    limit = f"L must be at least {math.ceil(10.0 * near) / 10.0:g}"
    return f"{words}; with these a and b, and with the highlight's own light, {limit}"
