"""`fit --report` on made tables: any geometry, values and names end as a page, or as one line."""

from __future__ import annotations

import os
import warnings

import fit_cases
import numpy as np
import pytest
from PIL import Image

from relgloss_view.base.errors import RelglossError
from relgloss_view.fitting import curves, describe_fit, fit_material, write_fit_report
from relgloss_view.measure import gonio
from relgloss_view.measure.bands import RGB, Bands
from relgloss_view.measure.table import Measurement

#: Tables of the long run; RELGLOSS_FUZZ_TABLES=100000 for a night.
COUNT = int(os.environ.get("RELGLOSS_FUZZ_TABLES", "150"))
NAMES = (
    "plain", "a$b$_^{", "\\frac{x}{y}", "$\\undefined$", "\x1b[31m\x00\n", "x" * 10_000,
    "\u7d19\U0001f4a9", "$" * 7, "{}%s", "\u202eabc\u0301" * 30, "\ue000\uffff", "",
)  # fmt: skip


def geometry(kind, rng):
    """theta_i, theta_r, azimuth (180 on the mirror side), degrees."""
    n = int(rng.integers(12, 120))
    incidence, viewing, azimuth = rng.uniform(0, 85, (3, n))
    azimuth = rng.choice([0.0, 180.0], n)
    if kind == "in plane":
        incidence = rng.choice(rng.uniform(0, 85, int(rng.integers(1, 5))), n)
    elif kind == "anywhere":
        azimuth = rng.uniform(-180, 180, n)
    elif kind == "one incidence":
        incidence = np.full(n, rng.uniform(0, 80))
    elif kind == "head on":
        incidence = np.zeros(n)
    elif kind == "cones":
        incidence = viewing = np.repeat(rng.uniform(5, 70, 3), n)[:n]
        azimuth = np.linspace(-180, 180, n)
    elif kind == "retro side":
        azimuth = np.zeros(n)
    elif kind == "grid":
        incidence, viewing = rng.choice([10.0, 30, 50, 70], n), rng.choice([0.0, 30, 50, 75], n)
        azimuth = rng.choice([0.0, 90, 180], n)
    if rng.random() < 0.5:
        incidence, viewing = np.round(incidence), np.round(viewing)
    return incidence, viewing, azimuth


def values(kind, half_deg, bands, rng):
    """Radiance factors (N, B) of one kind, with noise or without."""
    shape = (len(half_deg), bands)
    value = np.full(shape, 0.4)
    if kind in ("white", "black"):
        value[:] = 1.0 if kind == "white" else rng.choice([1e-4, 1e-9, 0.0])
    elif kind == "glossy":
        lobe = np.exp(-np.square(half_deg / rng.uniform(0.3, 20.0)))
        value += rng.uniform(1.0, 3000.0) * lobe[:, None]
    elif kind == "scattered":
        value = 10.0 ** rng.uniform(-6.0, 4.0, shape)
    elif kind == "scale":
        value[:] = 10.0 ** rng.uniform(-9.0, 8.0)
    elif kind == "gaps":
        value[rng.random(shape) < rng.choice([0.02, 0.4])] = np.nan
    elif kind == "dead band":
        value[:, 0] = 0.0
    noise = rng.choice([0.0, 0.001, 0.02, 0.3])
    return value * np.exp(noise * rng.standard_normal(shape))


def made_table(seed):
    """A table, and its kinds in words."""
    rng = np.random.default_rng(seed)
    places = ("in plane", "anywhere", "one incidence", "head on", "cones", "retro side", "grid")
    sorts = ("white", "black", "flat", "glossy", "scattered", "scale", "gaps", "dead band")
    place, sort = str(rng.choice(places)), str(rng.choice(sorts))
    wavelengths = {
        "rgb": None,
        "two": (450.0, 650.0),
        "ordinary": tuple(np.arange(390.0, 731.0, 10.0)),
        "400": tuple(np.linspace(380.0, 780.0, 400)),
        "uneven": tuple(np.sort(rng.choice(np.arange(300.0, 1000.0), 7, replace=False))),
    }
    channels = str(rng.choice([*wavelengths], p=[0.4, 0.2, 0.25, 0.05, 0.1]))
    bands = RGB if channels == "rgb" else Bands(wavelengths[channels])
    incidence, viewing, azimuth = geometry(place, rng)
    lamp = gonio.spherical(incidence, np.full_like(incidence, 180.0))
    receiver = gonio.spherical(viewing, 180.0 - azimuth)
    half = lamp + receiver
    half /= np.linalg.norm(half, axis=1, keepdims=True)
    half_deg = np.degrees(np.arccos(np.clip(half[:, 2], 0.0, 1.0)))
    value = values(sort, half_deg, bands.count, rng)
    group = np.unique(np.round(incidence), return_inverse=True)[1].astype(np.int64)
    name, source = (str(rng.choice(np.array(NAMES, dtype=object))) for _ in range(2))
    reasons = np.full(len(lamp), "")
    table = Measurement(name or "x", source, lamp, receiver, bands, value, reasons, group)
    return table, f"{place}, {sort}, {channels}"


def page_of(seed, path, model):
    """Whether a page was drawn; False where the fit refuses the table in one line."""
    table, _ = made_table(seed)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            material = fit_material(table, model=model)
        except RelglossError as error:
            assert "\n" not in str(error)
            return False
        write_fit_report(material, table, path)
        assert describe_fit(material)
    with Image.open(path) as page:
        assert page.width > 1500
    return True


def test_a_few_made_tables(tmp_path):
    drawn = [page_of(seed, tmp_path / "page.png", "lambert") for seed in range(3)]
    assert sum(drawn) >= 2


@pytest.mark.slow
def test_many_made_tables(tmp_path):
    failed, drawn = {}, 0
    for seed in range(1000, 1000 + COUNT):
        model = ("auto", "lambert", "lobe", "rough")[seed % 4]
        try:
            drawn += page_of(seed, tmp_path / "page.png", model)
        except Exception as error:
            failed[seed, made_table(seed)[1], model] = repr(error)[:200]
    assert not failed
    assert drawn > 0.5 * COUNT


@pytest.mark.parametrize("kind", ["no number", "some of each"])
def test_predictions_that_are_no_numbers(tmp_path, monkeypatch, kind):
    """The page has its points without its lines."""
    grid = fit_cases.GRID[fit_cases.GRID[:, 0] == -40.0]
    table = fit_cases.measured(fit_cases.truth(grid=grid), grid=grid)
    material = fit_material(table, model="lambert")
    seen = curves.seen

    def broken(*args):
        value = np.array(seen(*args))
        parts = {
            "no number": [np.nan, np.nan],
            "some of each": [np.nan, -np.inf],
        }[kind]
        value[::2], value[1::2] = parts
        return value

    monkeypatch.setattr(curves, "seen", broken)
    write_fit_report(material, table, tmp_path / "page.png")
    assert (tmp_path / "page.png").stat().st_size > 20_000


def test_scattered_gaps_leave_bands_to_search_on():
    """No row is whole in any run of bands, so one band stands for each run; control: no gaps."""
    from relgloss_view.fitting.observations import compress, prepare

    rng = np.random.default_rng(3)
    n = 60
    lamp = gonio.spherical(rng.uniform(5.0, 70.0, n), np.full(n, 180.0))
    receiver = gonio.spherical(rng.uniform(0.0, 70.0, n), np.zeros(n))
    bands = Bands(tuple(np.arange(390.0, 731.0, 10.0)))
    value = 0.3 * np.exp(0.01 * rng.standard_normal((n, bands.count)))
    group = np.arange(n) % 6
    whole = Measurement("a", "", lamp, receiver, bands, value, np.full(n, ""), group)
    gaps = np.where(rng.random(value.shape) < 0.5, np.nan, value)
    broken = Measurement("a", "", lamp, receiver, bands, gaps, np.full(n, ""), group)
    assert np.all(compress(prepare(whole)).weight > 0.0)
    kept = compress(prepare(broken)).weight > 0.0
    assert np.all(np.mean(kept, axis=0) > 0.4)
    a, b = (fit_material(table, model="lambert") for table in (whole, broken))
    np.testing.assert_allclose(b.diffuse.albedo, a.diffuse.albedo, rtol=0.02)
