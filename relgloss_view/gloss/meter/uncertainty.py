"""How far the standard errors of a fit move a number that is computed from its material.

The fit writes no covariances, so each fitted number is moved alone and the effects are added as if
independent. Where two of them hide behind one another, as width and strength may, that is too much.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Iterator

from relgloss_view.base.reading import number, numbers_of
from relgloss_view.material.material import (
    ALBEDO_MAX,
    INDEX_RANGE,
    S_DEG_MAX,
    SIGMA_DEG_MAX,
    STRENGTH_MAX,
    Diffuse,
    Lobe,
    Material,
)

PLACE = "fit.standard_errors"
LARGEST = 1e9
NARROWEST_DEG = 1e-6  #: a width goes down to here, where a lobe is a mirror

#: Two materials on both sides of the fitted one, and what turns the difference of a number between
#: them into its change for one standard error.
Step = tuple[Material, Material, float]


def fitted_steps(material: Material) -> tuple[Step, ...] | None:
    """Each fitted number moved by its standard error both ways; None where the fit gives no errors.

    Raises InputError where the fit's errors are no numbers.
    """
    errors = material.fit.standard_errors if material.fit else {}
    lobes = len(material.specular)
    if "albedo_relative" not in errors:
        return None
    expected = f"a standard error, 0 to {LARGEST:g}"
    single = {
        name: number(errors.get(name, 0.0), f"{PLACE}.{name}", expected, 0.0, LARGEST)
        for name in ("albedo_relative", "sigma_deg")
    }
    several = {
        name: numbers_of(errors.get(name, ()), f"{PLACE}.{name}", expected, 0.0, LARGEST)
        for name in ("s_deg", "strength", "refractive_index")
    }
    if len(several["s_deg"]) < lobes or len(several["strength"]) < lobes:
        return None
    steps = list(_diffuse_steps(material, single["albedo_relative"], single["sigma_deg"]))
    held = (0.0,) * lobes
    index = several["refractive_index"] if len(several["refractive_index"]) >= lobes else held
    for k in range(lobes):
        steps += _lobe_steps(material, k, several["s_deg"][k], several["strength"][k], index[k])
    return tuple(steps)


def standard_error(
    number_of: Callable[[Material], float | None], steps: tuple[Step, ...] | None
) -> float | None:
    """The delta method's error of a number, by differences over the errors themselves."""
    if steps is None:
        return None
    ends = [(number_of(a), number_of(b), scale) for a, b, scale in steps]
    return math.sqrt(sum((scale * ((b or 0.0) - (a or 0.0))) ** 2 for a, b, scale in ends))


def _diffuse_steps(material: Material, albedo: float, sigma_deg: float) -> Iterator[Step]:
    diffuse = material.diffuse

    def scaled(factor: float) -> Material:
        values = tuple(min(factor * value, ALBEDO_MAX) for value in diffuse.albedo)
        return changed(dataclasses.replace(diffuse, albedo=values))

    def changed(part: Diffuse) -> Material:
        return dataclasses.replace(material, diffuse=part)

    yield from _step(scaled, 1.0, albedo, 0.0, 2.0)
    yield from _step(
        lambda x: changed(dataclasses.replace(diffuse, sigma_deg=x)),
        diffuse.sigma_deg, sigma_deg, 0.0, SIGMA_DEG_MAX,
    )  # fmt: skip


def _lobe_steps(
    material: Material, k: int, s_deg: float, strength: float, index: float
) -> Iterator[Step]:
    lobe = material.specular[k]

    def changed(part: Lobe) -> Material:
        lobes = (*material.specular[:k], part, *material.specular[k + 1 :])
        return dataclasses.replace(material, specular=lobes)

    def scaled(factor: float) -> Material:
        values = tuple(min(factor * value, STRENGTH_MAX) for value in lobe.strength)
        return changed(dataclasses.replace(lobe, strength=values))

    if not lobe.at_the_limit:  # such a width has no error: the fit could go no further
        low, high = min(NARROWEST_DEG, lobe.s_deg), S_DEG_MAX
        yield from _step(
            lambda x: changed(dataclasses.replace(lobe, s_deg=x)), lobe.s_deg, s_deg, low, high
        )
    mean = math.fsum(lobe.strength) / len(lobe.strength)
    if mean > 0.0:  # the error is that of the mean over the bands
        yield from _step(scaled, 1.0, strength / mean, 0.0, 2.0)
    if lobe.is_metal:  # the strength scales the reflectance of all bands
        return
    yield from _step(
        lambda x: changed(dataclasses.replace(lobe, refractive_index=x)),
        lobe.refractive_index, index, *INDEX_RANGE,
    )  # fmt: skip


def _step(
    change: Callable[[float], Material], value: float, error: float, low: float, high: float
) -> Iterator[Step]:
    """The value moved by its error within its range; nothing where the error is zero."""
    a, b = max(value - error, low), min(value + error, high)
    if b > a:
        yield change(a), change(b), error / (b - a)
