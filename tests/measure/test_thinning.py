"""Large tables: the part that stands for the whole, and fits of it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import relgloss_view.fitting.fit as fit
from relgloss_view.base.arrays import Array
from relgloss_view.fitting import descent, problem
from relgloss_view.fitting.curves import seen
from relgloss_view.fitting.describe import describe_fit
from relgloss_view.fitting.selection import selected, words
from relgloss_view.material.material import Diffuse, Lobe, Material
from relgloss_view.measure.bands import RGB
from relgloss_view.measure.gonio import spherical
from relgloss_view.measure.table import KEPT, OCCLUDED, Measurement
from relgloss_view.measure.thinning import mean, percentile, thinned

TRUTH = Material(
    "known", "synthetic", RGB, Diffuse("oren-nayar", (0.2, 0.4, 0.6), 10.0), (Lobe((0.6,), 2.0),)
)


def dense_table(
    incidences: int = 8,
    receivers: int = 41,
    azimuths: int = 21,
    truth: Material = TRUTH,
    seed: int = 1,
) -> Measurement:
    grid = np.meshgrid(
        np.linspace(5.0, 75.0, incidences),
        np.linspace(0.0, 80.0, receivers),
        np.linspace(0.0, 180.0, azimuths),
        indexing="ij",
    )
    theta_i, theta_r, phi = (axis.ravel() for axis in grid)
    lamp, receiver = spherical(theta_i, np.zeros_like(theta_i)), spherical(theta_r, phi)
    noise = np.random.default_rng(seed).normal(0.0, 0.02, (len(lamp), 3))
    return Measurement(
        "dense", "synthetic", lamp, receiver, RGB,
        seen(truth, lamp, receiver, (0.3, 0.3)) * np.exp(noise),
        np.full(len(lamp), KEPT, dtype=object), np.rint(theta_i).astype(np.int64), (0.3, 0.3),
    )  # fmt: skip


def test_a_part_counts_for_all_and_keeps_the_highlight() -> None:
    table = dense_table()
    rows, counts = thinned(table.to_lamp, table.to_receiver, table.group, 1500)
    assert len(rows) <= 1500
    assert counts.sum() == len(table.group)
    assert np.all(np.diff(rows) > 0)
    assert counts.min() == 1.0
    total = table.to_lamp + table.to_receiver
    delta = np.degrees(np.arctan2(np.hypot(total[:, 0], total[:, 1]), total[:, 2]))
    assert np.all(np.isin(np.flatnonzero(delta < 1.0), rows))
    # Sums are estimated; without the counts they are not.
    value = table.radiance_factor[:, 1]
    assert mean(value[rows], counts) == pytest.approx(value.mean(), rel=0.02)
    assert mean(value[rows]) > 1.2 * value.mean()


def test_percentiles_count_what_a_row_stands_for() -> None:
    values = np.random.default_rng(2).random(50)
    counts = np.arange(1.0, 51.0)
    repeated = np.repeat(values, counts.astype(int))
    for percent in (10.0, 50.0, 90.0):
        expected = np.percentile(repeated, percent, method="inverted_cdf")
        assert percentile(values, percent, counts) == expected


def test_small_tables_are_fitted_as_they_are() -> None:
    table = dense_table(4, 9, 5)
    assert selected(table, 0) is table
    assert words(table) == ""


@pytest.mark.slow
def test_a_part_gives_the_fit_of_the_whole(monkeypatch: pytest.MonkeyPatch) -> None:
    table = dense_table()
    reasons = table.reasons.copy()
    reasons[:7] = OCCLUDED
    table = replace(table, reasons=reasons)
    monkeypatch.setattr(fit, "selected", lambda m, seed: m)
    whole = fit.fit_material(table, model="lobe", free_index=False, free_errors=False)
    monkeypatch.setattr(
        fit, "selected", lambda m, seed, most=1500: selected(m, seed, min(most, 10_000))
    )
    part = fit.fit_material(table, model="lobe", free_index=False, free_errors=False)
    assert part.fit is not None
    assert whole.fit is not None
    error = whole.fit.standard_errors["s_deg"][0]
    assert abs(part.specular[0].s_deg - whole.specular[0].s_deg) < 0.1 * error
    assert part.specular[0].s_deg == pytest.approx(2.0, rel=0.01)
    assert part.fit.residuals["left_out"] == whole.fit.residuals["left_out"] != {}
    assert "of 6881 geometries" in describe_fit(part)
    # The errors are those of the whole: refits without each plane, or one step for each.
    assert part.fit.standard_errors["method"] == whole.fit.standard_errors["method"]
    for name in ("s_deg", "strength", "sigma_deg", "albedo_relative"):
        ratio = np.divide(part.fit.standard_errors[name], whole.fit.standard_errors[name])
        assert np.all(np.abs(ratio - 1.0) < 0.05), name
    assert "of 6881 geometries" not in describe_fit(whole)


KINDS = {
    "narrow": (Lobe((0.6,), 1.0),),
    "broad": (Lobe((0.6,), 6.0),),
    "two": (Lobe((0.4,), 2.0), Lobe((0.3,), 9.0)),
}


def numbers(made: Material) -> tuple[Array, Array]:
    """Albedo, sigma, widths and strengths of a fit, and their standard errors."""
    assert made.fit is not None
    se, lobes = made.fit.standard_errors, made.specular
    albedo = float(np.mean(made.diffuse.albedo))
    value = [albedo, made.diffuse.sigma_deg, *(lobe.s_deg for lobe in lobes)]
    value += [float(np.mean(lobe.strength)) for lobe in lobes]
    error = [se["albedo_relative"] * albedo, se["sigma_deg"], *se["s_deg"], *se["strength"]]
    return np.array(value), np.array(error)


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_a_part_stands_for_30_000_geometries(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    truth = replace(TRUTH, specular=KINDS[kind])
    table = dense_table(25, 40, 30, truth)
    monkeypatch.setattr(fit, "selected", lambda m, seed, most=0: m)
    whole, error = numbers(fit.fit_material(table))
    for seed in range(3):
        monkeypatch.setattr(
            fit, "selected", lambda m, _, most=6000, seed=seed: selected(m, seed, most)
        )
        part, part_error = numbers(fit.fit_material(table))
        assert np.all(np.abs(part - whole) < 0.1 * error)
        assert np.all(np.abs(part_error / error - 1.0) < 0.05)

    def without_the_highlight(m: Measurement, seed: int, most: int = 0) -> Measurement:
        total = m.to_lamp + m.to_receiver
        far = np.hypot(total[:, 0], total[:, 1]) > np.tan(np.radians(3.0)) * total[:, 2]
        return selected(replace(m, reasons=np.where(far, m.reasons, OCCLUDED)), seed, 6000)

    # Control: a part that drops the stratum of the highlight, and is all that is fitted.
    monkeypatch.setattr(fit, "selected", without_the_highlight)
    control = fit.fit_material(table)
    same = len(control.specular) == len(KINDS[kind])
    assert not same or np.any(np.abs(numbers(control)[0] - whole) > error)


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_standard_errors_after_the_last_refinement_cover_the_truth(
    kind: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """20 tables of 8,000 geometries, 2,000 of which choose the model; noise is all their error."""
    lobes = KINDS[kind]
    known = np.array([0.4, 10.0, *(q.s_deg for q in lobes), *(q.strength[0] for q in lobes)])
    monkeypatch.setattr("relgloss_view.fitting.spread._shared_states", lambda *_: ())
    monkeypatch.setattr(fit, "selected", lambda m, seed, most=2000: selected(m, seed, most))

    def deviations(tables: int) -> Array:
        """Root mean squares of deviations from the truth, in standard errors."""
        found = []
        for seed in range(tables):
            table = dense_table(20, 20, 20, replace(TRUTH, specular=lobes), 100 + seed)
            model = "two-lobes" if kind == "two" else "lobe"
            value, error = numbers(
                fit.fit_material(table, model=model, free_index=False, free_errors=False)
            )
            found.append((value - known) / error)
        return np.asarray(np.sqrt(np.mean(np.square(found), axis=0)))

    rms = deviations(20)
    assert np.all((rms > 0.5) & (rms < 1.5)), rms
    # Control: the errors of the part alone are too wide for the diffuse part of the whole.
    monkeypatch.setattr(
        "relgloss_view.fitting.spread.without_each_group",
        lambda candidate, _: candidate.fold_states,
    )
    assert np.all(deviations(8)[:2] < 0.6)


@pytest.mark.slow
def test_blocks_change_no_number(monkeypatch: pytest.MonkeyPatch) -> None:
    table = dense_table(4, 13, 7)

    def fitted() -> list[float]:
        made = fit.fit_material(table, model="two-lobes", free_errors=False)
        return [*made.diffuse.albedo, *(lobe.s_deg for lobe in made.specular)]

    before = fitted()
    monkeypatch.setattr(descent, "AT_ONCE", 1)
    monkeypatch.setattr("relgloss_view.fitting.ladder.AT_ONCE", 1)
    monkeypatch.setattr("relgloss_view.fitting.search.AT_ONCE", 1)
    assert fitted() == pytest.approx(before, rel=1e-9)
    monkeypatch.setattr(problem, "SAMPLES_AT_ONCE", 50)
    assert fitted() == pytest.approx(before, rel=1e-6)
