"""Pixels that show nothing of the object, whatever pass 1 writes."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from splits import IN_PASS_1, SHAPES, SIZE, scene_of

from relgloss_view.picture.frame import Extremes, Scaling
from relgloss_view.picture.method import EXACT, Method
from relgloss_view.picture.model import tone
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.setup import Eye

#: Where the whole object, or only some of it, is in the picture.
EYES = {
    "whole": Eye(elevation_deg=20.0),
    "half outside": Eye(elevation_deg=20.0, field_of_view_deg=12.0, shift_right=0.1),
    "above": Eye(field_of_view_deg=12.0, shift_up=-0.07),
}


class TestOffTheObject:
    """Pixels that show nothing of the object say so in whatever pass 1 writes."""

    @pytest.mark.parametrize("method", [EXACT, IN_PASS_1, Method(targets="float16")])
    @pytest.mark.parametrize("samples", [1, 3])
    @pytest.mark.parametrize("place", list(EYES))
    @pytest.mark.parametrize("shape", SHAPES)
    def test_marked(self, renderer, reference, shape, place, samples, method):
        scene = dataclasses.replace(scene_of(shape), eye=EYES[place])
        look = Look(sigma_n_deg=1.0, c=0.3, samples=samples)
        frame = renderer.render(scene, look, SIZE, method)
        truth = reference.render(scene, look, SIZE)
        off = ~frame.on_object
        assert 0 < np.sum(off) < off.size
        if place == "half outside":
            assert np.any(frame.on_object[:, 0])
        np.testing.assert_array_equal(frame.on_object, truth.on_object)
        np.testing.assert_array_equal(frame.coverage, truth.coverage.astype(np.float32))
        np.testing.assert_array_equal(frame.coverage > 0.0, frame.on_object)
        assert frame.object_pixels == np.sum(frame.on_object)
        split = frame._fetch("split")
        np.testing.assert_array_equal(split[off], [[tone.OFF_OBJECT, 0.0, 0.0, 0.0]] * np.sum(off))
        assert np.min(split[~off][:, 0]) > -1.0
        for stage in (frame.diffuse, frame.specular, frame.lab, frame.normal, frame.point_m):
            assert not np.any(stage[off])
        assert not np.any(frame.clipped[off] | frame.out_of_gamut[off])
        surround = np.unique(frame.display[off].reshape(-1, 3), axis=0)
        assert len(surround) == 1
        l_d, l_s = frame.split
        assert not np.any(l_d[off])
        assert not np.any(l_s[off])
        if samples > 1:
            shares = np.unique(np.round(frame.coverage * samples**2, 4))
            assert np.all(shares == np.round(shares))
            assert len(shares) > 3 or place == "above"

    @pytest.mark.parametrize("method", [EXACT, IN_PASS_1, Method(targets="float16")])
    @pytest.mark.parametrize("samples", [1, 2])
    def test_unseen(self, renderer, method, samples):
        scene = dataclasses.replace(scene_of(), eye=Eye(shift_right=50.0))
        frame = renderer.render(scene, Look(c=0.3, samples=samples), SIZE, method)
        assert not np.any(frame.on_object)
        assert not np.any(frame.coverage)
        assert not np.any(frame.diffuse)
        assert frame.object_pixels == 0
        assert frame.scaling == Scaling.of(frame.look, Extremes.of_nothing())
        assert len(np.unique(frame.display.reshape(-1, 3), axis=0)) == 1

    def test_an_unlit_object_is_no_surround(self, renderer):
        """Light of zero is on the object, black; off it there is the marker."""
        scene = scene_of(azimuth_deg=180.0)
        for method in (EXACT, IN_PASS_1):
            frame = renderer.render(scene, Look(), SIZE, method)
            assert np.sum(frame.on_object) > 100
            assert not np.any(frame.specular)
            np.testing.assert_array_equal(frame.lab[frame.on_object], 0.0)
            surround = frame.display[~frame.on_object][0]
            assert np.all(frame.display[frame.on_object] == 0)
            assert np.all(surround > 0)
