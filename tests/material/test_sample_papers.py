"""The four synthetic papers: as the script makes them, and as the fit finds them."""

from __future__ import annotations

import importlib.util
import json
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from relgloss_view.fitting import describe_fit, fit_material
from relgloss_view.material.files import load_material
from relgloss_view.measure import gonio
from relgloss_view.measure.readers import read_measurement

ROOT = Path(__file__).resolve().parents[2]
PAPERS = ROOT / "assets" / "papers"
NAMES = ("cast-coated", "art-coated", "matte-coated", "uncoated")
TRUTH = json.loads((PAPERS / "truth.json").read_text(encoding="utf-8"))["papers"]


@pytest.fixture(scope="module")
def script() -> ModuleType:
    path = ROOT / "scripts" / "make_sample_papers.py"
    spec = importlib.util.spec_from_file_location("make_sample_papers", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # dataclasses look their module up
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("name", NAMES)
def test_a_table_is_small_and_says_what_it_is(name: str) -> None:
    path = PAPERS / f"{name}.csv"
    assert path.stat().st_size < 400_000
    measurement = read_measurement(path)
    assert "synthetic" in measurement.source
    assert measurement.radiance_factor.shape == (997, 35)
    assert measurement.aperture_sd_deg == (0.3, 0.4)
    assert not measurement.warnings


def test_the_script_makes_the_same_table(script: ModuleType, tmp_path: Path) -> None:
    paper = script.PAPERS[2]
    script.write_csv(paper, tmp_path / "again.csv")
    made = np.loadtxt(tmp_path / "again.csv", delimiter=",", skiprows=6)
    kept = np.loadtxt(PAPERS / f"{paper.name}.csv", delimiter=",", skiprows=6)
    # Another libm may turn the last of four digits.
    np.testing.assert_allclose(made, kept, rtol=2e-3)


def test_the_aperture_quadrature_has_converged(script: ModuleType) -> None:
    """Cast-coated at the ridge is the hardest: its lobe is hardly wider than the blur at 70 deg."""
    angles = gonio.gcms4_grid()
    ridge = (angles[:, 2] == 15.0) & (np.abs(angles[:, 0] + angles[:, 1]) <= 1.0)
    lamp, receiver = gonio.gcms_directions(*angles[ridge].T)
    few, many = (script.blurred_shapes(script.PAPERS[0], lamp, receiver, k)[2] for k in (5, 7))
    np.testing.assert_allclose(few, many, rtol=2e-3)


@pytest.mark.parametrize("name", NAMES)
def test_the_fit_finds_what_made_the_paper(name: str) -> None:
    material = fit_material(read_measurement(PAPERS / f"{name}.csv"))
    truth, main = TRUTH[name], material.specular[0]
    assert main.s_deg == pytest.approx(truth["s_deg"], rel=0.03), describe_fit(material)
    assert material.diffuse.sigma == pytest.approx(truth["sigma_rad"], abs=0.03)
    # The main lobe and the broad one that was put in, no more.
    assert len(material.specular) <= 2
    for other in material.specular[1:]:
        assert other.s_deg > 2.0 * main.s_deg
        assert np.mean(other.strength) < 0.2 * np.mean(main.strength)
    assert material.fit is not None
    assert material.fit.quality == "good"
    assert material.synthetic
    np.testing.assert_allclose(material.diffuse.albedo, truth["albedo"], rtol=0.05)
    kept = load_material(ROOT / "assets" / "materials" / f"{name}.json")
    # The kept files were fitted without errors of the instrument, and drawn scenes rest on them.
    assert kept.specular[0].s_deg == pytest.approx(main.s_deg, rel=0.02)
    assert kept.synthetic
