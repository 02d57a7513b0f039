"""Real samples: the RGL material database on a 10-degree grid plus the mirror scan."""

from __future__ import annotations

import numpy as np
import pytest
from rgl_data import rgl_file

from relgloss_view.base.arrays import Array
from relgloss_view.fitting import fit_material
from relgloss_view.material.spectra import illuminant, xyz_weights
from relgloss_view.measure.bands import RGB, Bands
from relgloss_view.measure.readers import read_measurement

#: Median relative error over samples and channels inside the gamut of sRGB.
FIGURES = {"paper_white": 0.02, "satin_rosaline": 0.06, "cg_sunflower": 0.06}


@pytest.mark.parametrize("name", FIGURES)
def test_median_relative_error(name: str) -> None:
    measurement = read_measurement(rgl_file(name))
    material = fit_material(measurement)
    assert material.fit is not None
    kept = measurement.kept
    diffuse, specular = material.evaluate(measurement.to_lamp[kept], measurement.to_receiver[kept])
    model = np.pi * (diffuse + specular)
    value = measurement.radiance_factor[kept]
    # The record holds the same, of all channels of the bands that the samples are kept in.
    recorded = material.fit.residuals["median_relative_error"]
    assert np.median(np.abs(model - value) / value) == pytest.approx(recorded, rel=1e-3)
    to_srgb = xyz(measurement.bands) @ np.linalg.inv(xyz(RGB))
    model, value = model @ to_srgb, value @ to_srgb
    inside = np.median(value, axis=0) > 0.0  # sunflower yellow has no blue in sRGB
    relative = np.abs(model - value)[:, inside] / np.abs(value[:, inside])
    assert np.median(relative) <= FIGURES[name]


def xyz(bands: Bands) -> Array:
    return xyz_weights(bands, illuminant("D65"))


def test_a_colour_shifting_flake_film_is_poor() -> None:
    material = fit_material(read_measurement(rgl_file("vch_golden_yellow")))
    assert material.fit is not None
    assert material.fit.quality == "poor"
    assert any("no model describes" in text for text in material.warnings)


def test_highlights_and_gloss_decide_beside_medians() -> None:
    """Their medians are within 6 %; still their pictures or their gloss are not the table's.

    Integrated over the meters' windows, the whole measured BRDF of the sunflower film reads 41 and
    28 at 20 and 60 degrees; this fit reads 27 and 35. The rosaline film's highlight at a lamp of
    110 degrees differs by dE2000 23 in its brightest twentieth.
    """
    for name, word in (("cg_sunflower", "near the mirror"), ("satin_rosaline", "pictures of")):
        material = fit_material(read_measurement(rgl_file(name)))
        assert material.fit is not None
        assert material.fit.quality == "poor"
        assert any(word in text for text in material.fit.grounds)
    paper = fit_material(read_measurement(rgl_file("paper_white")))
    assert paper.fit is not None
    assert paper.fit.quality == "good"
