"""How far the standard errors of a fit move a number that is computed from its material.

The delta method: each fitted number is moved by its error, and the effects are joined by the
correlations that the fit keeps, of the samples' noise and of errors of the instrument that the
samples leave open. Files of older fits hold standard errors alone; their effects are added as if
independent, which is too much where two of them hide behind one another, as width and strength may.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Iterator, Mapping
from typing import Any, NamedTuple

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.reading import number, numbers_of, refuse
from relgloss_view.material.material import (
    ALBEDO_MAX,
    INDEX_RANGE,
    S_DEG_MAX,
    SIGMA_DEG_MAX,
    STRENGTH_MAX,
    Diffuse,
    FitRecord,
    Lobe,
    Material,
)

PLACE, COVARIANCE = "fit.standard_errors", "fit.covariance"
LARGEST = 1e9
NARROWEST_DEG = 1e-6  #: a width goes down to here, where a lobe is a mirror


class Step(NamedTuple):
    """Two materials on both sides of the fitted one."""

    below: Material
    above: Material
    scale: float  #: turns the difference of a number between them into its change for one error
    name: str  #: of the number that moves, as in the fit's covariance


@dataclasses.dataclass(frozen=True)
class Steps:
    """Each of M fitted numbers moved both ways by its error, and their correlations."""

    steps: tuple[Step, ...]
    correlation: Array  #: (M, M)


def fitted_steps(material: Material) -> Steps | None:
    """Each fitted number moved by its standard error both ways; None where the fit gives no errors.

    Raises InputError where the fit's errors are no numbers.
    """
    fit = material.fit
    if fit is None:
        return None
    names, matrix = _covariance(fit)
    sd = dict(zip(names, np.sqrt(np.diag(matrix)).tolist(), strict=True))
    steps = _steps(material, _with_covariance(fit.standard_errors, sd, len(material.specular)))
    if steps is None:
        return None
    correlation = np.eye(len(steps))
    kept = [k for k, step in enumerate(steps) if sd.get(step.name, 0.0) > 0.0]
    places = [names.index(steps[k].name) for k in kept]
    size = np.array([sd[names[place]] for place in places])
    correlation[np.ix_(kept, kept)] = matrix[np.ix_(places, places)] / np.outer(size, size)
    return Steps(steps, correlation)


def _covariance(fit: FitRecord) -> tuple[list[str], Array]:
    """Names (M,) and the sum of the covariances (M, M) that a fit keeps; empty where it has none.

    Raises InputError where they are no matrices of that size.
    """
    names = fit.covariance.get("names", [])
    if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
        refuse(f"{COVARIANCE}.names", "a list of texts", names)
    total = np.zeros((len(names), len(names)))
    for part in ("samples", "priors"):
        rows = fit.covariance.get(part, [[0.0] * len(names)] * len(names))
        expected = f"{len(names)} rows of {len(names)} numbers"
        if not isinstance(rows, list) or len(rows) != len(names):
            refuse(f"{COVARIANCE}.{part}", expected, rows)
        for k, row in enumerate(rows):
            values = numbers_of(row, f"{COVARIANCE}.{part}[{k}]", expected, -LARGEST, LARGEST)
            if len(values) != len(names):
                refuse(f"{COVARIANCE}.{part}[{k}]", expected, row)
            total[k] += values
        if np.any(np.diag(total) < 0.0):
            refuse(f"{COVARIANCE}.{part}", "variances of at least 0", rows)
    return names, total


def _with_covariance(
    errors: Mapping[str, Any], sd: Mapping[str, float], lobes: int
) -> dict[str, Any]:
    """The standard errors, with those of the covariance where it has them."""
    result = dict(errors)
    for name in ("albedo_relative", "sigma_deg"):
        if name in sd:
            result[name] = sd[name]
    for name in ("s_deg", "strength", "refractive_index"):
        each = [sd.get(f"{name}.{j}") for j in range(1, lobes + 1)]
        if lobes and all(value is not None for value in each):
            result[name] = each
    return result


def _steps(material: Material, errors: Mapping[str, Any]) -> tuple[Step, ...] | None:
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
    number_of: Callable[[Material], float | None], steps: Steps | None
) -> float | None:
    """The delta method's error of a number, by differences over the errors themselves."""
    if steps is None:
        return None
    change = np.array(
        [
            step.scale * ((number_of(step.above) or 0.0) - (number_of(step.below) or 0.0))
            for step in steps.steps
        ]
    )
    return math.sqrt(max(float(change @ steps.correlation @ change), 0.0))


def _diffuse_steps(material: Material, albedo: float, sigma_deg: float) -> Iterator[Step]:
    diffuse = material.diffuse

    def scaled(factor: float) -> Material:
        values = tuple(min(factor * value, ALBEDO_MAX) for value in diffuse.albedo)
        return changed(dataclasses.replace(diffuse, albedo=values))

    def changed(part: Diffuse) -> Material:
        return dataclasses.replace(material, diffuse=part)

    yield from _step("albedo_relative", scaled, 1.0, albedo, 0.0, 2.0)
    yield from _step(
        "sigma_deg",
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
            f"s_deg.{k + 1}",
            lambda x: changed(dataclasses.replace(lobe, s_deg=x)),
            lobe.s_deg, s_deg, low, high,
        )  # fmt: skip
    mean = math.fsum(lobe.strength) / len(lobe.strength)
    if mean > 0.0:  # the error is that of the mean over the bands
        yield from _step(f"strength.{k + 1}", scaled, 1.0, strength / mean, 0.0, 2.0)
    if lobe.is_metal:  # the strength scales the reflectance of all bands
        return
    yield from _step(
        f"refractive_index.{k + 1}",
        lambda x: changed(dataclasses.replace(lobe, refractive_index=x)),
        lobe.refractive_index, index, *INDEX_RANGE,
    )  # fmt: skip


def _step(
    name: str,
    change: Callable[[float], Material],
    value: float,
    error: float,
    low: float,
    high: float,
) -> Iterator[Step]:
    """The value moved by its error within its range; nothing where the error is zero."""
    a, b = max(value - error, low), min(value + error, high)
    if b > a:
        yield Step(change(a), change(b), error / (b - a), name)
