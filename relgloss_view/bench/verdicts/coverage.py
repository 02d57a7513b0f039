"""Do the stated standard errors hold? Tables whose truth lies inside the fit's own model.

One or two lobes of facets Gaussian in angle behind V-grooves, an Oren-Nayar body, apertures that
are Gaussian: only the noise of instrument.noisy keeps a fit from the truth. Each stated error makes
an interval of 68 % and one of 95 %; the share of them that hold the truth should be that.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.errors import InputError
from relgloss_view.base.temporaries import scratch_folder
from relgloss_view.base.terminal import Column, table
from relgloss_view.bench.verdicts.instrument import GRIDS
from relgloss_view.bench.verdicts.judging import peak_of
from relgloss_view.bench.verdicts.reflection import Body, Highlight, Surface, TrueSample
from relgloss_view.bench.verdicts.samples import draw
from relgloss_view.bench.verdicts.tables import Table, make, sound_plan
from relgloss_view.bench.verdicts.truth import gloss, luminous_weights, peak
from relgloss_view.fitting.fit import fit_material
from relgloss_view.gloss.meter.meter import specular_gloss
from relgloss_view.gloss.meter.uncertainty import fitted_steps, standard_error
from relgloss_view.material.material import Material, Quality
from relgloss_view.measure.readers import read_measurement

INTERVALS = ((0.68, 0.9945), (0.95, 1.96))  #: share of a normal distribution, half width in sd
NUMBERS = (
    "s_deg", "strength", "second s_deg", "second strength", "albedo", "sigma_deg",
    "refractive_index", "peak", "gloss 60", "gloss 20",
)  # fmt: skip


@dataclass(frozen=True)
class Trial:
    """One table: each number's error in units of its stated standard error."""

    quality: str
    lobes: tuple[int, int]  #: true, fitted
    scores: dict[str, float]  #: (fitted - true) / stated, where an error is stated
    #: (true, fitted, stated) of the same, and of numbers without a stated error, which have 0
    numbers: dict[str, tuple[float, float, float]]
    seconds: float


def inside_table(seed: int, index: int) -> Table:
    """A table of a sample that the fit's model holds."""
    rng = np.random.default_rng((seed, index, 10))
    setting = draw(rng, GRIDS, (0.5, 12.0))
    first = setting.sample.highlights[0]
    bands = setting.sample.wavelengths_nm
    n = 1.5 if rng.uniform() < 0.5 else float(rng.uniform(1.4, 1.6))
    surface = Surface(np.full(len(bands), n))
    lobes = [replace(first, shape="gaussian", surface=surface)]
    if rng.uniform() < 0.4:
        wide = min(first.s_deg * float(rng.uniform(3.0, 5.0)), 25.0)
        weak = first.strength * float(rng.uniform(0.1, 0.4))
        lobes.append(Highlight("gaussian", wide, weak, surface))
    body = Body(setting.sample.body.albedo, float(rng.uniform(0.05, 0.3)))
    sample = TrueSample(bands, body, tuple(lobes))
    plan = sound_plan(replace(setting, sample=sample), (seed, index, 11))
    return make(replace(plan, soft=True), f"inside {seed}-{index}")


def trial(seed: int, index: int) -> Trial:
    """Fit the table of a seed and an index, and compare."""
    made = inside_table(seed, index)
    with scratch_folder() as folder:
        path = folder / "table.csv"
        made.write(path)
        try:
            material = fit_material(read_measurement(path))
        except InputError:
            return Trial("refused", (len(made.sample.highlights), 0), {}, {}, 0.0)
    assert material.fit is not None
    sample = made.sample
    numbers = dict(_numbers(material, sample))
    scores = {
        name: (fitted - true) / error
        for name, (true, fitted, error) in numbers.items()
        if error > 0.0
    }
    return Trial(
        str(material.fit.quality),
        (len(sample.highlights), len(material.specular)),
        scores,
        numbers,
        material.fit.seconds,
    )


def _numbers(
    material: Material, sample: TrueSample
) -> list[tuple[str, tuple[float, float, float]]]:
    """Name, and (true, fitted, stated error), of each number that both have."""
    assert material.fit is not None
    errors: dict[str, Any] = material.fit.standard_errors
    found = []
    true_lobes = sorted(sample.highlights, key=lambda h: h.s_deg)
    order = np.argsort([lobe.s_deg for lobe in material.specular])
    if len(true_lobes) == len(order):
        for k, (truth, j) in enumerate(zip(true_lobes, order, strict=True)):
            lobe, prefix = material.specular[j], "second " if k else ""
            n = float(truth.surface.index[0].real)
            error = _stated(errors, "s_deg", int(j))
            found.append((f"{prefix}s_deg", (truth.s_deg, lobe.s_deg, error)))
            freed = _stated(errors, "refractive_index", int(j))
            # With the index held at another value than the true one the strength makes up for it.
            if freed > 0.0 or abs(lobe.refractive_index - n) < 1e-9:
                k_true, k_fit = float(truth.strength.mean()), float(np.mean(lobe.strength))
                error = _stated(errors, "strength", int(j))
                found.append((f"{prefix}strength", (k_true, k_fit, error)))
            if freed > 0.0 and not k:
                found.append(("refractive_index", (n, lobe.refractive_index, freed)))
    ratio = float(np.sum(material.diffuse.albedo) / np.sum(sample.body.albedo))
    found.append(("albedo", (1.0, ratio, float(errors.get("albedo_relative") or 0.0))))
    sigma = float(np.degrees(sample.body.sigma))
    stated = float(errors.get("sigma_deg") or 0.0)
    found.append(("sigma_deg", (sigma, material.diffuse.sigma_deg, stated)))
    steps = fitted_steps(material)
    weights: Array = luminous_weights(sample.wavelengths_nm)

    def top(m: Material) -> float:
        return float(peak_of(m, 25.0, weights)[1])

    stated = standard_error(top, steps) or 0.0
    found.append(("peak", (float(peak(sample, 25.0)[1]), top(material), stated)))
    for angle in (60, 20):
        stated = standard_error(partial(specular_gloss, angle_deg=angle), steps) or 0.0
        values = gloss(sample, angle), specular_gloss(material, angle), stated
        found.append((f"gloss {angle}", values))
    return found


def _stated(errors: dict[str, Any], name: str, lobe: int) -> float:
    values = errors.get(name) or []
    return float(values[lobe] or 0.0) if lobe < len(values) else 0.0


COLUMNS = (
    Column("number", 18, left=True),
    Column("fits", 5),
    Column("no error", 8),
    Column("68 %", 6),
    Column("95 %", 6),
    Column("median", 7),
    Column("rms", 7),
)


def summary(trials: Sequence[Trial]) -> str:
    """Shares of intervals that hold the truth, over the fits called good."""
    good = [t for t in trials if t.quality == Quality.GOOD]
    lines = [
        f"{len(good)} of {len(trials)} fits are good; "
        f"{sum(t.lobes[0] == t.lobes[1] for t in trials)} have the true number of lobes",
    ]
    rows: list[tuple[str, ...]] = []
    for name in NUMBERS:
        scores = np.array([t.scores[name] for t in good if name in t.scores])
        without = sum(name in t.numbers and name not in t.scores for t in good)
        if not len(scores):
            rows.append((name, "0", str(without), "", "", "", ""))
            continue
        shares = [f"{100 * np.mean(np.abs(scores) <= half):.0f}" for _, half in INTERVALS]
        spread = f"{np.median(scores):+.2f}", f"{np.sqrt(np.mean(scores**2)):.2f}"
        rows.append((name, str(len(scores)), str(without), *shares, *spread))
    return "\n".join([*lines, table(COLUMNS, rows)])


def as_json(trials: Sequence[Trial]) -> list[dict[str, Any]]:
    """All numbers, for a file."""
    return [
        {"quality": t.quality, "lobes": t.lobes, "scores": t.scores, "numbers": t.numbers}
        for t in trials
    ]
