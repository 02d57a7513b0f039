"""A material in the factors of glTF: the search of refit.py over what glTF can hold."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.exchange.gltf_brdf import WHITE, Colour, GltfSurface
from relgloss_view.exchange.refit import (
    LEAST_ROUGHNESS,
    NARROWEST,
    Refit,
    as_colour,
    colour_notes,
    linear_rgb,
    roughness_of,
)
from relgloss_view.exchange.ways import Family, Unknown, ways_to_show
from relgloss_view.gloss.meter.meter import main_lobe
from relgloss_view.material.material import Lobe, Material

#: What F0 may be, in multiples of 0.04.
MOST_SPECULAR = 10.0
#: Roughness of the body that a Lambertian one stands for without a note, degrees.
SMOOTH_DEG = 10.0
KEPT = 32


def refit_gltf(material: Material, *, keeps_body: bool = False) -> Refit:
    """The glTF factors that show a material's picture and read its gloss.

    keeps_body: the base colour of a dielectric is the material's albedo as it is, as that of an
    artwork is; else it is searched for with the rest.

    >>> from relgloss_view import load_sample
    >>> refit_gltf(load_sample("uncoated")).loss.de2000_p95 < 3.0
    True
    """
    # Found by the object: equal materials are the same work, and hashing spectra is not.
    return _refitted(_Held(material), keeps_body)


class _Held:
    """A material by its identity, held so that no other one takes it."""

    def __init__(self, material: Material) -> None:
        self.material = material

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Held) and self.material == other.material

    def __hash__(self) -> int:
        one = self.material
        return hash((one.name, one.diffuse, one.specular))


@lru_cache(maxsize=KEPT)
def _refitted(held: _Held, keeps_body: bool) -> Refit:
    material = held.material
    best, *others = ways_to_show(material, families(material, keeps_body))
    return Refit(best.surface, best.name, best.loss, tuple(others), _notes(material))


def _notes(material: Material) -> tuple[str, ...]:
    notes = colour_notes(material)
    if material.diffuse.model != "lambert" and material.diffuse.sigma_deg > SMOOTH_DEG:
        notes += (
            f"the roughness of the body ({material.diffuse.sigma_deg:.0f} degrees) is left out; "
            "glTF has a Lambertian one",
        )
    return notes


def families(material: Material, keeps_body: bool) -> tuple[Family, ...]:
    """Ways of glTF to show a material: one lobe, or one below a clear coat."""
    main = main_lobe(material)
    body = _rgb(material.diffuse.albedo, material)
    fixed: Colour = as_colour(body)
    open_body = (
        () if keeps_body else tuple(Unknown(min(float(v) / 0.95, 0.99), 0.0, 1.0) for v in body)
    )
    first = len(open_body)

    def base(x: Array) -> Colour:
        return fixed if keeps_body else as_colour(x[:3])

    if main is None:
        unknowns = open_body or (Unknown(0.001, 0.0, 1.0),)
        return (
            Family(
                "diffuse part alone",
                unknowns,
                lambda x: GltfSurface(base(x), 0.0, 1.0, specular=0.0),
            ),
        )
    lobe = material.specular[main]
    rough = roughness_of(lobe)
    if lobe.is_metal:
        return _metals(material, lobe, rough)
    hue = _hue(lobe, material)
    wide = max((roughness_of(one) for one in material.visible_lobes()), default=rough)

    def one(x: Array) -> GltfSurface:
        weight, roughness, f0 = (float(v) for v in x[first : first + 3])
        colour = as_colour(np.asarray(hue) * f0)
        return GltfSurface(base(x), 0.0, roughness, 1.5, weight, colour)

    def two(x: Array) -> GltfSurface:
        weight, roughness, coat, coat_roughness, f0 = (float(v) for v in x[first : first + 5])
        colour = as_colour(np.asarray(hue) * f0)
        return GltfSurface(base(x), 0.0, roughness, 1.5, weight, colour, coat, coat_roughness)

    strength = max(lobe.strength)
    least = max(NARROWEST * rough, LEAST_ROUGHNESS)
    start = Unknown(rough, least, 1.0)
    coated = (
        Unknown(0.1, 0.0, 1.0),
        Unknown(max(wide, min(1.0, 2.0 * rough)), least, 1.0),
        Unknown(min(0.9, strength), 0.0, 1.0),
        start,
        Unknown(1.0, 0.0, MOST_SPECULAR),
    )
    below = (
        Unknown(0.7, 0.0, 1.0),
        start,
        Unknown(0.1, 0.0, 1.0),
        start._replace(start=max(0.8 * rough, least)),
        Unknown(1.0, 0.0, MOST_SPECULAR),
    )
    alone = (
        Unknown(min(0.9, strength), 0.0, 1.0),
        start,
        Unknown(max(1.0, strength), 0.0, MOST_SPECULAR),
    )
    return (
        Family("specular alone", (*open_body, *alone), one),
        Family("clear coat above a wide specular lobe", (*open_body, *coated), two),
        Family("specular below a narrow clear coat", (*open_body, *below), two),
    )


def _metals(material: Material, lobe: Lobe, rough: float) -> tuple[Family, ...]:
    least = max(NARROWEST * rough, LEAST_ROUGHNESS)
    f0 = np.clip(_rgb(lobe.f0 or (1.0,), material) * min(lobe.strength[0], 1.0), 0.01, 0.99)
    alone = (
        *(Unknown(float(v), 0.0, 1.0) for v in f0),
        Unknown(0.97, 0.0, 1.0),
        Unknown(rough, least, 1.0),
    )
    coat = (Unknown(0.2, 0.0, 1.0), Unknown(max(0.9 * rough, least), least, 1.0))

    def one(x: Array) -> GltfSurface:
        return GltfSurface(as_colour(x[:3]), float(x[3]), float(x[4]))

    def two(x: Array) -> GltfSurface:
        return GltfSurface(
            as_colour(x[:3]),
            float(x[3]),
            float(x[4]),
            clearcoat=float(x[5]),
            clearcoat_roughness=float(x[6]),
        )

    return (
        Family("metal alone", alone, one),
        Family("metal below a clear coat", (*alone, *coat), two),
    )


def _rgb(spectrum: tuple[float, ...], material: Material) -> Array:
    values = np.broadcast_to(np.asarray(spectrum), (material.bands.count,))
    return np.clip(linear_rgb(values, material), 0.0, 1.0)


def _hue(lobe: Lobe, material: Material) -> Colour:
    """The colour of a dielectric's lobe, its largest channel 1."""
    if len(set(lobe.strength)) == 1:
        return WHITE
    rgb = _rgb(tuple(np.asarray(lobe.strength) / max(lobe.strength)), material)
    return as_colour(rgb / max(float(np.max(rgb)), 1e-6))
