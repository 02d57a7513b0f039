"""The maps themselves: what they measure is an error, and the command writes them."""

from __future__ import annotations

import json

import numpy as np
import pytest
from PIL import Image

from relgloss_view import cli
from relgloss_view.bench.stability import figures as stability_figures
from relgloss_view.bench.stability import grain_errors, model_errors
from relgloss_view.bench.stability import maps as stability
from relgloss_view.bench.stability.figures import PAGES
from relgloss_view.commands import stability_maps
from relgloss_view.material import approximations, brdf
from relgloss_view.picture.model import noise


class TestErrors:
    """Against closed forms, and against errors put in on purpose."""

    def test_what_the_shader_draws_exactly_is_rounding(self, ctx):
        """float32 directions carry 6e-8, and a lobe's slope is 0.6 / s; ten such at grazing."""
        for s_deg in (0.05, 1.0, 10.0):
            error = model_errors.lobe_error(ctx, s_deg, [0.0, 45.0, 80.0])
            assert np.all(error > 0.0)
            assert np.max(error) < 1e-6 * (1.0 + 0.1 / np.radians(s_deg))

    def test_a_constant_fresnel_term_is_off_by_what_the_formula_says(self, ctx):
        theta = np.array([10.0, 30.0, 60.0])
        exact = brdf.fresnel_dielectric(np.cos(np.radians(theta)), 1.5)
        error = model_errors.lobe_error(ctx, 2.0, theta, fresnel="constant")
        # theta_d is the same at every normal, so the whole lobe is off by the same share.
        np.testing.assert_allclose(error, 1.0 - 0.04 / exact, atol=2e-4)

    def test_beckmann_at_the_peak_is_off_by_its_norm(self, ctx):
        """At delta = 0, normal incidence: 1 / (2 pi s^2) against the Gaussian's amplitude."""
        s = np.radians(10.0)
        amplitude = approximations.plain_lobe(s, 1.5).amplitude
        error = model_errors.lobe_error(ctx, 10.0, 0.0, facets="beckmann")
        at_the_peak = 1.0 - 0.5 / (np.pi * s * s) / amplitude
        # Where else it is off, it is by no more than that again.
        assert at_the_peak <= error + 1e-6 < 2.0 * at_the_peak

    def test_lambert_is_off_by_the_full_models_own_terms(self, ctx):
        """Facing lamp and eye at the same place, n = i = o: 1 against C1 + 0.17 rho ...; dark."""
        sigma = np.radians(20.0)
        first, _ = brdf.oren_nayar(brdf.facing(*np.eye(3)[[2, 2, 2]]), sigma)
        off = abs(1.0 / np.pi - first) * np.pi
        assert model_errors.diffuse_error(ctx, 20.0, 0.0, "lambert") >= off

    def test_what_is_not_finite_is_told(self):
        exact = np.ones((2, 5))
        drawn = exact.copy()
        drawn[1, 3] = np.nan
        met = np.ones((2, 5), dtype=bool)
        np.testing.assert_array_equal(model_errors.share_of_peak(drawn, exact, met), [0.0, np.inf])
        met[1, 3] = False  # where nothing can be seen nothing counts
        np.testing.assert_array_equal(model_errors.share_of_peak(drawn, exact, met), [0.0, 0.0])

    def test_quadrature_over_the_tilt_is_the_closed_form(self):
        """Mean of exp(-delta^2 / 2 s^2) at small angles: 0.1 % of noise.mean_lobe."""
        for ratio in (0.1, 1.0, 5.0):
            s = np.radians(0.2)
            angles, weights = grain_errors.tilts(ratio * s, ratio)
            assert np.sum(weights) == pytest.approx(1.0)
            for delta in (0.0, s, 3.0 * s):
                away = np.hypot(angles[:, 0] - delta, angles[:, 1])
                found = np.exp(-np.minimum(0.5 * np.square(away / s), 500.0)) @ weights
                expected = noise.mean_lobe(np.array(delta), s, ratio * s)
                assert found == pytest.approx(float(expected), rel=2e-3)

    def test_a_lamp_so_far_off_is_distant(self):
        """The error is the angle times half a lobe's slope: it falls with the angle, in step."""
        near, far = grain_errors.distant_error(1.0, [0.1, 0.01])
        assert near / far == pytest.approx(10.0, rel=0.05)
        assert far < 2e-3

    def test_16_bits_fail_where_they_overflow_and_only_there(self, ctx):
        error = model_errors.tone_error(
            ctx, [1e4, 4e4, 5e4, 1e5], 0.1, cube_root="householder", targets="float16"
        )
        np.testing.assert_array_equal(np.isfinite(error), [True, True, False, False])


def test_every_map_is_an_error_or_says_that_it_is_none(ctx):
    for subject in stability.SUBJECTS:
        if subject.page == "grain" and subject.name.startswith("grain"):
            continue  # by quadrature; tests/stability/test_domains.py computes them
        made = stability.computed(ctx, subject, 4)
        assert made.error.shape == (4, 4)
        finite = np.isfinite(made.error)
        assert np.all(made.error[finite] >= 0.0)
        # Only 16 bits fail anywhere.
        assert np.all(finite) == (subject.name != "tone-householder-float16")


@pytest.mark.parametrize(
    "pages", [["diffuse"], pytest.param(list(PAGES), marks=pytest.mark.slow)], ids=["one", "all"]
)
def test_the_command_writes_figures_and_numbers(tmp_path, monkeypatch, capsys, pages):
    monkeypatch.setattr(stability_maps, "QUICK_CELLS", 3)
    monkeypatch.setattr(stability_figures, "PAGES", {page: PAGES[page] for page in pages})
    subjects = tuple(s for s in stability.SUBJECTS if s.page in pages)
    monkeypatch.setattr(stability, "SUBJECTS", subjects)
    folder = tmp_path / "maps"
    assert cli.main(["bench", "--stability", "--quick", "-o", str(folder)]) == 0
    said = capsys.readouterr().out
    assert "Qualitative Oren-Nayar" in said
    found = json.loads((folder / "stability.json").read_text())
    assert found["format"] == "relgloss-stability"
    assert [m["name"] for m in found["maps"]] == [s.name for s in subjects]
    for page in pages:
        with Image.open(folder / f"stability-{page}.png") as picture:
            assert picture.width > 800
        assert (folder / f"stability-{page}.svg").read_text().startswith("<?xml")
    # A folder of something else is left alone.
    other = tmp_path / "other"
    other.mkdir()
    (other / "stability.json").write_text("{}")
    assert cli.main(["bench", "--stability", "-o", str(other)]) != 0
