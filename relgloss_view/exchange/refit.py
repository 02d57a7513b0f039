"""Refit: the parameters of another program's model that show a material's picture.

A renamed width shows another highlight: GGX has longer tails than a Gaussian, and Smith's shadowing
takes more at grazing angles than V-grooves do. So the parameters are searched for (ways.py), for
one lobe and for two, and the way that loses least is taken.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.exchange import ggx, judge
from relgloss_view.exchange.loss import LAMP, Loss, Surface
from relgloss_view.exchange.openpbr import Colour, OpenPbr
from relgloss_view.exchange.ways import Family, Unknown, Way, ways_to_show
from relgloss_view.gloss.meter.meter import main_lobe
from relgloss_view.material.material import Lobe, Material
from relgloss_view.material.spectra import illuminant, xyz_weights
from relgloss_view.measure.bands import RGB

BEHIND_DEG = 110.0  #: azimuth of the lamp of a second look at what is lost
COAT_INDEX = 1.5
#: Index of a base below a coat of COAT_INDEX whose border reflects as glass in air does.
BELOW_INDEX = COAT_INDEX * 1.5
#: A second lobe is at least this share of the main one's roughness: a narrower one would gain gloss
#: units by a mirror image of the lamp that no sample shows.
NARROWEST = 0.6
LEAST_ROUGHNESS = math.sqrt(ggx.LEAST_ALPHA)


@dataclass(frozen=True)
class Refit:
    """A surface that stands for a material: the best of several ways, and the others' losses."""

    surface: Surface
    way: str  #: for people, such as 'specular and coat'
    loss: Loss
    others: tuple[Way, ...] = ()
    notes: tuple[str, ...] = ()  #: what the model cannot hold, one sentence each

    @property
    def lines(self) -> tuple[str, ...]:
        """What the loss means, its numbers, the ways that lose more, and notes; one line each."""
        taken = (self.loss.verdict, f"fitted with {self.way}: {self.loss.words}")
        passed = ", ".join(
            f"{way.name} (dE2000 {way.loss.de2000_p95:.1f}, up to "
            f"{way.loss.largest_gloss_units:.1f} gloss units)"
            for way in self.others
        )
        return (*taken, *((f"tried, and loses more: {passed}",) if passed else ()), *self.notes)


def said_once(named: Iterable[tuple[str, Iterable[str]]]) -> list[str]:
    """Lines of several materials, each after its name; equal ones once, after all their names.

    >>> said_once([("lid", ["dull", "flat"]), ("label", ["white"]), ("base", ["dull", "flat"])])
    ['lid, base: dull', 'lid, base: flat', 'label: white']
    """
    names: dict[tuple[str, ...], list[str]] = {}
    for name, lines in named:
        names.setdefault(tuple(lines), []).append(name)
    return [f"{', '.join(names[lines])}: {line}" for lines in names for line in lines]


def linear_rgb(spectrum: Array, material: Material) -> Array:
    """Linear sRGB (3,) of a spectrum of a material's bands under D65; below 0 where sRGB lacks it.

    >>> from relgloss_view import load_sample
    >>> linear_rgb(np.ones(35), load_sample("uncoated")).round(3).tolist()
    [1.0, 1.0, 1.0]
    """
    lamp = illuminant(LAMP)
    xyz = np.asarray(spectrum) @ material.xyz_weights(lamp)
    return np.asarray(np.linalg.solve(xyz_weights(RGB, lamp).T, xyz))


def colour_notes(material: Material) -> tuple[str, ...]:
    """What of a material's colour linear sRGB from 0 to 1 cannot hold."""
    rgb = linear_rgb(np.asarray(material.diffuse.albedo), material)
    notes = []
    if np.min(rgb) < -1e-3:
        notes.append(
            f"the colour lies outside sRGB (linear {', '.join(f'{v:.3f}' for v in rgb)}); "
            "what is below 0 is written as 0"
        )
    if np.max(rgb) > 1.0:
        notes.append(
            f"the albedo is above 1 (linear {', '.join(f'{v:.3f}' for v in rgb)}), as of a "
            "fluorescent paper; it is written as 1"
        )
    return tuple(notes)


def refit_openpbr(material: Material) -> Refit:
    """The OpenPBR surface that shows a material's picture (OpenPBR 1.1, MaterialX 1.39).

    >>> from relgloss_view import load_sample
    >>> refit_openpbr(load_sample("uncoated")).loss.de2000_p95 < 3.0
    True
    """
    return refit_with(material, openpbr_families(material))


def refit_with(material: Material, families: tuple[Family, ...]) -> Refit:
    """The best of several ways to show a material."""
    best, *others = ways_to_show(material, families)
    notes = (*colour_notes(material), *_turned(material, best.surface))
    return Refit(best.surface, best.name, best.loss, tuple(others), notes)


def _turned(material: Material, surface: Surface) -> tuple[str, ...]:
    """The loss under a lamp from behind, where grazing reflection differs most."""
    points = judge.points_of(BEHIND_DEG)
    picture = judge.picture_of(judge.seen(material, points))
    p95, largest = judge.difference(picture, judge.seen(surface, points))
    return (
        f"under a lamp from behind (azimuth {BEHIND_DEG:g} degrees): highlight dE2000 p95 "
        f"{p95:.1f}, largest {largest:.1f}",
    )


def openpbr_families(material: Material) -> tuple[Family, ...]:
    """Ways of OpenPBR to show a material: one lobe or two, dielectric or metal."""
    lobes = material.visible_lobes()
    main = main_lobe(material)
    if main is None:
        return (_body_alone(material),)
    narrow = material.specular[main]
    rough = roughness_of(narrow)
    if narrow.is_metal:
        return _metals(material, narrow, rough)
    wide = next((roughness_of(lobe) for lobe in lobes if lobe is not narrow), min(1.0, 2.0 * rough))
    body = _body(material)
    least = NARROWEST * rough
    lobe = Unknown(rough, least, 1.0)
    weight = Unknown(min(0.9, max(narrow.strength)), 0.0, 1.0)

    def one(x: Array) -> OpenPbr:
        return OpenPbr(
            **_base(x),
            specular_weight=float(x[4]),
            specular_roughness=float(x[5]),
            specular_ior=float(x[6]),
        )

    def two(x: Array) -> OpenPbr:
        return OpenPbr(
            **_base(x),
            specular_weight=float(x[4]),
            specular_roughness=float(x[5]),
            specular_ior=BELOW_INDEX,
            coat_weight=float(x[6]),
            coat_roughness=float(x[7]),
            coat_ior=float(x[8]),
            coat_darkening=0.0,
        )

    index = Unknown(narrow.refractive_index, 1.05, 3.0)
    coat = (Unknown(0.95, 0.0, 1.0), lobe, Unknown(COAT_INDEX, 1.05, 2.2))
    below = (Unknown(0.1, 0.0, 1.0), Unknown(wide, least, 1.0))
    weak_coat = (Unknown(0.1, 0.0, 1.0), Unknown(0.8 * rough, least, 1.0), coat[2])
    return (
        Family("specular alone", (*body, weight, lobe, index), one),
        Family("coat above a wide specular lobe", (*body, *below, *coat), two),
        Family("specular below a narrow coat", (*body, weight, lobe, *weak_coat), two),
    )


def _metals(material: Material, lobe: Lobe, rough: float) -> tuple[Family, ...]:
    f0 = np.clip(spread_f0(lobe, material), 0.01, 0.99)
    open_ones = (
        *(Unknown(float(v), 0.0, 1.0) for v in f0),
        Unknown(0.95, 0.0, 1.0),
        Unknown(min(0.9, lobe.strength[0]), 0.0, 1.0),
        Unknown(rough, NARROWEST * rough, 1.0),
    )

    def one(x: Array) -> OpenPbr:
        return OpenPbr(
            base_color=as_colour(x),
            base_metalness=float(x[3]),
            specular_weight=float(x[4]),
            specular_roughness=float(x[5]),
        )

    def two(x: Array) -> OpenPbr:
        return OpenPbr(
            base_color=as_colour(x),
            base_metalness=float(x[3]),
            specular_weight=float(x[4]),
            specular_roughness=float(x[5]),
            coat_weight=float(x[6]),
            coat_roughness=float(x[7]),
            coat_ior=float(x[8]),
            coat_darkening=0.0,
        )

    coat = (
        Unknown(0.2, 0.0, 1.0),
        Unknown(0.9 * rough, NARROWEST * rough, 1.0),
        Unknown(1.6, 1.05, 3.0),
    )
    return (
        Family("metal alone", open_ones, one),
        Family("metal below a coat", (*open_ones, *coat), two),
    )


def _body_alone(material: Material) -> Family:
    return Family(
        "diffuse part alone",
        _body(material),
        lambda x: OpenPbr(**_base(x), specular_weight=0.0),
    )


def _body(material: Material) -> tuple[Unknown, ...]:
    """The unknowns of the diffuse part: a colour, and EON's roughness."""
    rough = {"lambert": 0.02, "eon": material.diffuse.sigma}.get(
        material.diffuse.model, 1.5 * material.diffuse.sigma
    )
    return (*body_colour(material), Unknown(min(rough, 0.9), 0.0, 1.0))


def body_colour(material: Material) -> tuple[Unknown, ...]:
    """The unknowns of the diffuse part's colour; layers above it dim it a little."""
    rgb = np.clip(linear_rgb(np.asarray(material.diffuse.albedo), material) / 0.95, 0.005, 0.99)
    return tuple(Unknown(float(v), 0.0, 1.0) for v in rgb)


def _base(x: Array) -> dict[str, Any]:
    return {"base_color": as_colour(x), "base_diffuse_roughness": float(x[3])}


def as_colour(x: Array) -> Colour:
    """The first three of some numbers as a colour."""
    red, green, blue = (float(v) for v in x[:3])
    return red, green, blue


def roughness_of(lobe: Lobe) -> float:
    """Roughness, the root of alpha, of GGX facets that look about as wide."""
    return min(max(math.sqrt(ggx.ALPHA_PER_S * lobe.s), LEAST_ROUGHNESS), 1.0)


def spread_f0(lobe: Lobe, material: Material) -> Array:
    """Linear sRGB (3,) of a metal lobe's F0."""
    bands = np.broadcast_to(np.asarray(lobe.f0 or (1.0,)), (material.bands.count,))
    return linear_rgb(bands, material)
