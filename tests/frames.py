"""Comparison of frames: the colour differences between two drawings of one picture."""

from __future__ import annotations

import numpy as np
import pytest
from pictures import assert_same_pixels

from relgloss_view.display.model import DisplayModel
from relgloss_view.picture.model import tone

SIZE = (512, 512)
SMALL = (160, 120)


def delta_e(frame, truth):
    """dE2000 over the object between two frames' Lab before gamut mapping."""
    colour = pytest.importorskip("colour")
    seen = frame.on_object & truth.on_object
    return colour.delta_E(
        frame.lab[seen].astype(np.float64), truth.lab[seen].astype(np.float64), method="CIE 2000"
    )


def displayed_delta_e(frame, truth):
    """dE2000 of the displayed light, before quantisation."""
    colour = pytest.importorskip("colour")
    model = DisplayModel.of(frame.scene.display)
    back = np.linalg.inv(model.rgb_from_xyz).T
    a, b = (
        tone.lab_from_xyz(f.light.astype(np.float64) @ back, model.white) for f in (frame, truth)
    )
    return colour.delta_E(a.reshape(-1, 3), b.reshape(-1, 3), method="CIE 2000")


def assert_same_picture(frame, truth):
    np.testing.assert_array_equal(frame.coverage, truth.coverage)
    for mask in ("clipped", "out_of_gamut"):
        # Pixels on the very edge of the gamut may fall to either side.
        assert (
            np.sum(getattr(frame, mask) != getattr(truth, mask)) <= 2 + 1e-3 * frame.coverage.size
        )
    assert np.max(delta_e(frame, truth)) <= 0.02
    assert np.max(displayed_delta_e(frame, truth)) <= 0.02
    assert_same_pixels(frame.display, truth.display, within=1)
    if truth.c_max is not None:
        assert frame.c_max == pytest.approx(truth.c_max, rel=1e-5)
        assert frame.scaling.c_max_eq4 == pytest.approx(truth.scaling.c_max_eq4, rel=1e-4)
