"""A fit of a table that shows by itself that something is wrong: never good, and it says why."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from sampled import gcms, in_plane, sample

from relgloss_view.fitting import fit_material
from relgloss_view.gloss.meter.meter import specular_gloss
from relgloss_view.material.material import Quality


def test_a_peak_at_the_lamp_is_never_a_good_fit() -> None:
    sound = fit_material(sample(gcms))
    assert sound.fit is not None
    assert sound.fit.quality == Quality.GOOD
    flipped = fit_material(sample(gcms, flip=True))
    assert flipped.fit is not None
    assert flipped.fit.quality == Quality.POOR
    grounds = [text for text in flipped.fit.grounds if "--mirror same-side" in text]
    assert len(grounds) == 1
    assert flipped.fit.warnings.count(grounds[0]) == 1


@pytest.mark.parametrize("part", [0.8, 0.3])
def test_rows_on_a_plateau_do_not_draw_the_fit(part: float) -> None:
    sound = sample(in_plane, s_deg=4.0)
    whole = fit_material(sound)
    level = part * sound.radiance_factor.max()
    clipped = replace(sound, radiance_factor=np.minimum(sound.radiance_factor, level))
    fitted = fit_material(clipped)
    assert fitted.fit is not None
    assert any("largest value" in text for text in fitted.fit.warnings)
    assert specular_gloss(fitted, 60) == pytest.approx(specular_gloss(whole, 60), rel=0.05)
    assert fitted.fit.residuals["left_out"] == {"saturated": int(
        (clipped.radiance_factor >= level).any(axis=1).sum()
    )}  # fmt: skip


def test_a_serious_finding_leaves_its_numbers_to_be_read() -> None:
    """The fit is not refused: who knows better can look at it."""
    sound = sample(gcms)
    wrong = replace(sound, radiance_factor=sound.radiance_factor * sound.to_receiver[:, 2:])
    fitted = fit_material(wrong)
    assert fitted.fit is not None
    assert fitted.fit.quality == Quality.POOR
    assert any("brdf-cos" in text for text in fitted.fit.grounds)
