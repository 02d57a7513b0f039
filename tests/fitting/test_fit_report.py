"""The report of a fit, as a picture and as text: the results and the doubts."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import fit_cases
import numpy as np
import pytest
from PIL import Image

from relgloss_view.fitting import describe_fit, fit_material, write_fit_report
from relgloss_view.material.material import Diffuse, Material
from relgloss_view.measure import gonio
from relgloss_view.measure.bands import RGB
from relgloss_view.measure.table import Measurement

GRID = fit_cases.GRID[np.isin(fit_cases.GRID[:, 0], (-60.0, -40.0, -20.0, 10.0, 30.0))]


@pytest.mark.parametrize("lobes", [(), ((2.5, 0.9),)])
@pytest.mark.parametrize("rgb", [False, True])
def test_a_page_is_written(lobes: tuple[tuple[float, object], ...], rgb: bool, tmp_path) -> None:
    value = fit_cases.truth(lobes, 0.2, albedo=(0.05, 0.3, 0.5), grid=GRID)
    measurement = fit_cases.measured(value, grid=GRID)
    if rgb:
        measurement = replace(measurement, bands=RGB, gamma_s_deg=None)
    material = fit_material(measurement, model="lobe" if rgb else "auto")
    write_fit_report(material, measurement, tmp_path / "page.png")
    assert [p.name for p in tmp_path.iterdir()] == ["page.png"]
    with Image.open(tmp_path / "page.png") as page:
        assert page.width >= 1500
        assert page.height >= 1000
        pixels = np.asarray(page.convert("L"))
    assert 0.01 < np.mean(pixels < 128) < 0.3  # drawn on, not drowned


def test_a_page_of_a_table_whose_dead_band_was_left_out(tmp_path) -> None:
    value = fit_cases.truth(((2.5, 0.9),), albedo=(0.3,) * 12, grid=GRID)
    value[:, 5] = 1e-4
    measurement = fit_cases.measured(value, noise=0.01, grid=GRID)
    material = fit_material(measurement, model="lobe")
    assert material.bands.count == 11  # control: the fit and the table differ in their bands
    write_fit_report(material, measurement, tmp_path / "page.png")
    assert (tmp_path / "page.png").stat().st_size > 10_000


def directions(kind: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """theta_i, theta_r and azimuth (180 on the mirror side), degrees, of tables with gaps."""
    receivers = np.arange(0.0, 80.0, 5.0)
    rows = {
        "in plane": [(a, b, p) for a in (0, 20, 40) for b in receivers for p in (0, 180)],
        "one incidence": [(45, b, p) for b in receivers for p in (0, 180)],
        "retro side": [(a, b, 0) for a in (10, 30, 50) for b in receivers if abs(a - b) > 8],
        "no mirror pair": [(a, b, p) for a in (10, 30) for b in receivers for p in (0, 90, 180)
                           if p != 180 or abs(a - b) > 8],
        "cones": [(a, a, p) for a in (10, 30, 50) for p in range(0, 181, 10)],
    }[kind]  # fmt: skip
    incidence, viewing, azimuth = np.array(rows, dtype=np.float64).T
    return incidence, viewing, azimuth


@pytest.mark.parametrize(
    "kind", ["in plane", "one incidence", "retro side", "no mirror pair", "cones"]
)
@pytest.mark.parametrize("noise", [pytest.param(0.0, marks=pytest.mark.slow), 0.02])
def test_a_page_of_every_table_that_fit_takes(kind: str, noise: float, tmp_path) -> None:
    """A slice that the table does not have is words; a fit without any error has an axis."""
    incidence, viewing, azimuth = directions(kind)
    lamp = gonio.spherical(incidence, np.full_like(incidence, 180.0))
    receiver = gonio.spherical(viewing, 180.0 - azimuth)
    value = np.full((len(lamp), 3), 0.4)
    value *= np.exp(noise * np.random.default_rng(0).standard_normal(value.shape))
    reasons = np.full(len(lamp), "")
    group = incidence.astype(np.int64)
    table = Measurement("case", "test", lamp, receiver, RGB, value, reasons, group)
    material = fit_material(table)
    write_fit_report(material, table, tmp_path / "page.png")
    assert (tmp_path / "page.png").stat().st_size > 20_000
    assert "quality" in describe_fit(material)


def test_the_text_holds_the_evidence() -> None:
    measurement = fit_cases.measured(fit_cases.truth(((2.5, 0.9),), grid=GRID), grid=GRID)
    measurement = replace(measurement, warnings=("the ridge lies elsewhere",))
    material = fit_material(measurement)
    assert material.fit is not None
    text = describe_fit(material)
    for part in ("[synthetic]", "* lobe", "two-lobes", "sigma", "quality    good", "ridge lies"):
        assert part in text, text
    rows = [line for line in text.splitlines() if not line.startswith("  warning")]
    assert all(len(line) < 130 for line in rows)


def test_names_are_not_formulas_nor_commands(tmp_path) -> None:
    """A dollar sign is not mathematics, a control character no command, a script no fault."""
    measurement = fit_cases.measured(fit_cases.truth(grid=GRID), grid=GRID)
    name = "5 $ a$_^{ \x1b[31m red\n紙 " + 300 * "x"
    measurement = replace(measurement, name=name, source=name, warnings=(name,))
    material = fit_material(measurement, model="lambert")
    write_fit_report(material, measurement, tmp_path / "page.png")
    text = describe_fit(material)
    assert "\x1b" not in text
    assert all(len(line) < 320 for line in text.splitlines())
    assert text.splitlines()[1].startswith("  source")


def test_a_given_material_has_no_evidence(tmp_path) -> None:
    material = Material("card", "given", RGB, Diffuse("lambert", (0.5, 0.5, 0.5)))
    assert "not fitted" in describe_fit(material)
    measurement = fit_cases.measured(fit_cases.truth(grid=GRID), grid=GRID)
    with pytest.raises(ValueError, match="not fitted"):
        write_fit_report(material, measurement, tmp_path / "page.png")


def test_plotting_is_imported_only_for_the_report() -> None:
    code = (
        "import sys, relgloss_view.fitting; "
        "assert 'matplotlib' not in sys.modules and 'scipy' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", code], check=True, cwd=Path(__file__).parent)


def test_a_width_at_its_limit_claims_no_error() -> None:
    """A fit that stopped at the widest lobe has no spread there; "+- 0" would promise exactness."""
    from relgloss_view.fitting.describe import width_error
    from relgloss_view.picture.scene.sample import load_sample

    material = load_sample("uncoated")
    assert material.specular[1].s_deg == 40.0
    assert width_error(material, 1, "se ") == "at the limit"
    assert width_error(material, 0, "se ").startswith("se 0.")
