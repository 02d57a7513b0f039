"""Is what a fit claims true? One table read, fitted and held against its sample.

The rule. A material of quality "good" is false where
- a gloss reading above 2 units (20, 60, 75, 85 degrees) differs from the truth by more than 5 %,
  1 unit and 2.6 standard errors that the fit states (99 % of a normal distribution); stated errors
  excuse at most 25 %, so that a fit can't be right by claiming nothing;
- X, Y or Z of the highlight's top, as a cylinder shows it with lamps at 50 and 110 degrees,
  differs by more than 15 % and 2.6 standard errors, which excuse at most 45 %;
- an unknown lies at a limit of its search.
Gloss at an angle more than 10 degrees beyond the steepest mirror direction of the table is counted
apart ("beyond"): the fit extrapolates there.
"""

from __future__ import annotations

import time
import traceback
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.errors import InputError
from relgloss_view.base.temporaries import scratch_folder
from relgloss_view.bench.verdicts.faults import BY_NAME, Fault
from relgloss_view.bench.verdicts.samples import draw
from relgloss_view.bench.verdicts.tables import Table, make, sound_plan
from relgloss_view.bench.verdicts.truth import (
    METERS,
    PEAK_DEG,
    Truth,
    luminous_weights,
    truth_of,
)
from relgloss_view.fitting.fit import fit_material
from relgloss_view.gloss.meter.meter import specular_gloss
from relgloss_view.gloss.meter.uncertainty import fitted_steps, standard_error
from relgloss_view.material.material import Material, Quality
from relgloss_view.measure.readers import read_measurement
from relgloss_view.measure.table import Measurement

SMALLEST_GLOSS = 2.0
GLOSS_SHARE, GLOSS_UNITS, PEAK_SHARE = 0.05, 1.0, 0.15
STATED_ERRORS = 2.6
GLOSS_EXCUSED, PEAK_EXCUSED = 0.25, 0.45
BEYOND_DEG = 10.0

GOOD, FALSE_GOOD, BEYOND, HIDDEN = "good", "false good", "beyond", "hidden"
POOR, CAREFUL, FALSE_POOR = "rightly poor", "careful", "false poor"
REFUSED, CRASHED = "refused", "crashed"
CLASSES = (GOOD, FALSE_GOOD, BEYOND, HIDDEN, POOR, CAREFUL, FALSE_POOR, REFUSED, CRASHED)
SOUND = "sound"  #: the kind of tables without a fault


@dataclass(frozen=True)
class Outcome:
    """What became of one table."""

    kind: str
    index: int
    outcome: str  #: one of CLASSES
    quality: str  #: the fit's, or "" where there is none
    named: bool  #: whether a warning or message names the fault
    size: str  #: of the fault, for people
    grid: str
    sample: str
    fitted: str
    wrong: tuple[str, ...]  #: what differs from the truth, within the table's reach
    beyond: tuple[str, ...]  #: gloss readings that differ, beyond it
    warnings: tuple[str, ...]
    seconds: float
    numbers: dict[str, Any] = field(default_factory=dict)  #: true, fitted, stated error

    @property
    def severity(self) -> float:
        """The largest difference from the truth within reach, in units of what is allowed."""
        return float(self.numbers.get("severity", 0.0))


def table_of(seed: int, kind: str, index: int, fault: Fault | None) -> Table:
    """The table of a seed, kind and index; the same at every call."""
    key = (seed, _number(kind), index)
    rng = np.random.default_rng((*key, 0))
    if fault is None:
        plan = sound_plan(draw(rng), (*key, 2))
    else:
        setting = draw(rng, fault.grids, fault.s_range_deg, strict=fault.strict)
        troubled = np.random.default_rng((*key, 1))
        share = float(troubled.uniform())
        plan = fault.apply(sound_plan(setting, (*key, 2)), troubled, share)
    return make(plan, f"sample {seed}-{index}")


def _number(kind: str) -> int:
    """A number for a kind that does not change when kinds are added."""
    return sum((k + 1) * ord(letter) for k, letter in enumerate(kind))


def judge_one(seed: int, kind: str, index: int, keep: str | None = None) -> Outcome:
    """Make, read, fit and judge a table. keep: folder for the CSV of a false "good"."""
    fault = BY_NAME.get(kind)
    table = table_of(seed, kind, index, fault)
    outcome = judge(table, kind, index, fault)
    if keep is not None and outcome.outcome in (FALSE_GOOD, FALSE_POOR, CRASHED):
        table.write(Path(keep) / f"{kind.replace(' ', '-')}-{seed}-{index}.csv")
    return outcome


def judge(table: Table, kind: str, index: int, fault: Fault | None) -> Outcome:
    """Read, fit and judge a table."""
    sample, plan = table.sample, table.plan
    lobes = "; ".join(
        f"{h.shape} s {h.s_deg:.2f} k {h.strength.mean():.3f}" for h in sample.highlights
    )
    facts: dict[str, Any] = {
        "kind": kind,
        "index": index,
        "size": plan.note,
        "grid": plan.setting.grid.name,
        "sample": f"{plan.setting.ink}, {len(sample.wavelengths_nm)} bands; {lobes}",
    }
    began = time.perf_counter()
    try:
        with scratch_folder() as folder:
            path = folder / "table.csv"
            table.write(path)
            measurement = read_measurement(path)
        material = fit_material(measurement)
    except InputError as error:
        message = (str(error).rpartition("table.csv")[2],)
        named = fault is not None and fault.named_in(message)
        return Outcome(outcome=REFUSED, quality="", named=named, fitted="", wrong=(), beyond=(),
                       warnings=message, seconds=time.perf_counter() - began, **facts)  # fmt: skip
    except Exception:  # a crash of the program under test is a result of the test
        message = (traceback.format_exc(limit=-3),)
        return Outcome(outcome=CRASHED, quality="", named=False, fitted="", wrong=(), beyond=(),
                       warnings=message, seconds=time.perf_counter() - began, **facts)  # fmt: skip
    seconds = time.perf_counter() - began
    truth = truth_of(sample, plan.azimuths_deg)
    wrong, beyond, numbers = compare(material, measurement, truth, sample.wavelengths_nm)
    texts = tuple(
        dict.fromkeys((*measurement.warnings, *material.warnings, *measurement.left_out()))
    )
    quality = Quality.POOR if material.fit is None else material.fit.quality
    fitted = "; ".join(
        f"s {lobe.s_deg:.2f} k {np.mean(lobe.strength):.3f} n {lobe.refractive_index:.2f}"
        for lobe in material.specular
    )
    return Outcome(
        outcome=classify(quality, wrong, beyond, sound=fault is None, visible=plan.visible),
        quality=str(quality), named=fault is not None and fault.named_in(texts), fitted=fitted,
        wrong=wrong, beyond=beyond, warnings=texts, seconds=seconds, numbers=numbers, **facts,
    )  # fmt: skip


def classify(
    quality: Quality,
    wrong: tuple[str, ...],
    beyond: tuple[str, ...],
    *,
    sound: bool,
    visible: bool = True,
) -> str:
    """The class of a fitted table.

    >>> classify(Quality.GOOD, ("gloss 60",), (), sound=True)
    'false good'
    """
    if quality == Quality.GOOD:
        if wrong:
            return FALSE_GOOD if visible else HIDDEN
        return BEYOND if beyond else GOOD
    if sound:
        return FALSE_POOR
    return POOR if wrong or beyond else CAREFUL


def compare(
    material: Material, measurement: Measurement, truth: Truth, wavelengths_nm: Array
) -> tuple[tuple[str, ...], tuple[str, ...], dict[str, Any]]:
    """What differs from the truth within the table's reach and beyond it, and all numbers."""
    steps = fitted_steps(material)
    reach = _reach_deg(measurement, material)
    wrong: list[str] = at_limits(material)
    beyond: list[str] = []
    excesses: list[float] = []
    numbers: dict[str, Any] = {"reach_deg": round(reach, 1)}
    for angle in METERS:
        fitted = specular_gloss(material, angle)
        error = standard_error(partial(specular_gloss, angle_deg=angle), steps) or 0.0
        right = truth.gloss[angle]
        numbers[f"gloss-{angle}"] = ([round(float(r), 3) for r in right], fitted, error)
        excess, off = max((gloss_excess(fitted, float(r), error), float(r)) for r in right)
        within = angle <= reach + BEYOND_DEG
        if within:
            excesses.append(excess)
        if excess > 1.0:
            (wrong if within else beyond).append(f"gloss {angle}: {fitted:.1f} for {off:.1f}")
    weights = luminous_weights(wavelengths_nm)
    if len(weights) != material.bands.count:  # a band was left out
        weights = luminous_weights(material.bands.centres_nm())
    for incidence in PEAK_DEG:
        top = peak_of(material, incidence, weights)
        error = standard_error(_luminance_at(incidence, weights), steps) or 0.0
        allowed = max(PEAK_SHARE, min(STATED_ERRORS * error / max(top[1], 1e-9), PEAK_EXCUSED))
        numbers[f"peak-{incidence:g}"] = (
            [[round(float(x), 4) for x in p] for p in truth.peak[incidence]], top.tolist(), error
        )  # fmt: skip
        farthest = max(truth.peak[incidence], key=lambda p: float(np.max(np.abs(top / p - 1.0))))
        excesses.append(float(np.max(np.abs(top / farthest - 1.0))) / allowed)
        if excesses[-1] > 1.0:
            parts = ", ".join(f"{100 * x:+.0f}" for x in top / farthest - 1.0)
            wrong.append(f"peak at {incidence:g}: XYZ {parts} %")
    numbers["severity"] = max(excesses)
    return tuple(wrong), tuple(beyond), numbers


def gloss_excess(fitted: float, right: float, error: float) -> float:
    """How far a gloss reading is from the truth, in units of what the rule allows.

    >>> gloss_excess(63.0, 60.0, 0.1), gloss_excess(1.9, 0.1, 0.0)
    (1.0, 0.0)
    """
    if max(right, fitted) < SMALLEST_GLOSS:
        return 0.0
    excused = min(STATED_ERRORS * error, GLOSS_EXCUSED * right)
    return abs(fitted - right) / max(GLOSS_SHARE * right, GLOSS_UNITS, excused)


def peak_of(material: Material, incidence_deg: float, weights: Array) -> Array:
    """XYZ (3,) of the material in the mirror direction, relative to a perfect diffuser."""
    theta = np.radians(incidence_deg)
    i = np.array([-np.sin(theta), 0.0, np.cos(theta)])
    o = np.array([np.sin(theta), 0.0, np.cos(theta)])
    diffuse, specular = material.evaluate(i, o)
    return np.asarray(np.pi * (diffuse + specular) @ weights)


def _luminance_at(incidence_deg: float, weights: Array) -> Callable[[Material], float]:
    return lambda material: float(peak_of(material, incidence_deg, weights)[1])


def _reach_deg(measurement: Measurement, material: Material) -> float:
    """The steepest incidence at which the table sees the mirror direction, degrees."""
    kept = measurement.kept
    h = measurement.to_lamp[kept] + measurement.to_receiver[kept]
    length = np.maximum(np.linalg.norm(h, axis=1), 1e-12)
    delta = np.degrees(np.arccos(np.clip(h[:, 2] / length, -1.0, 1.0)))
    width = max((lobe.s_deg for lobe in material.specular[:1]), default=5.0)
    near = delta <= 1.0 + min(width, 10.0)
    incidence = np.degrees(np.arccos(np.clip(0.5 * length, 0.0, 1.0)))
    return float(np.max(incidence[near], initial=0.0))


def at_limits(material: Material) -> list[str]:
    """Unknowns of a fit at the limits within which it searches."""
    found = []
    for k, lobe in enumerate(material.specular, 1):
        if not 0.0501 < lobe.s_deg < 39.9:
            found.append(f"lobe {k}: width at a limit ({lobe.s_deg:.3g})")
        if not 1.005 < lobe.refractive_index < 7.9:
            found.append(f"lobe {k}: index at a limit ({lobe.refractive_index:.3g})")
    if max(material.diffuse.albedo) > 3.99:
        found.append("albedo at its limit")
    return found
