"""Passes inside the bounds of the object, and the surround around them."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from pictures import assert_same_pixels

from relgloss_view.pack.shape import Shape
from relgloss_view.picture.gpu.renderer import Renderer
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.sample import load_sample
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.setup import Eye


class TestBounds:
    """Passes draw only the rectangle that the object can reach; the rest must be as if drawn."""

    @pytest.mark.parametrize("kind", ["cylinder", "sphere", "plane", "box"])
    def test_no_pixel_outside_shows_the_object(self, renderer, monkeypatch, kind):
        from relgloss_view.picture.model import view as views

        rng = np.random.default_rng(3)
        for _ in range(12):
            azimuth, elevation = rng.uniform(-180, 180), rng.uniform(-90, 90)
            eye = Eye(
                azimuth_deg=azimuth,
                elevation_deg=elevation,
                distance_m=rng.choice([0.09, 0.3, 0.6]),
                field_of_view_deg=rng.choice([None, 12.0, 40.0]),
                shift_right=rng.uniform(-0.1, 0.1),
                shift_up=rng.uniform(-0.1, 0.1),
            )
            scene = Scene(load_sample("uncoated"), shape=Shape(kind=kind), eye=eye)
            size = (61, 47)
            bounded = renderer.render(scene, Look(), size)
            with monkeypatch.context() as whole:
                whole.setattr(views, "_bounds", lambda *given: (0, 0, *given[-1]))
                views._view_of.cache_clear()
                full = Renderer(renderer.ctx, renderer.programs)
                expected = full.render(scene, Look(), size)
                np.testing.assert_array_equal(bounded.coverage, expected.coverage)
                assert_same_pixels(bounded.display, expected.display)
                full.release()
            views._view_of.cache_clear()

    def test_what_stood_there_before_is_gone(self, renderer):
        """The object moves in the picture; its old place is surround again."""
        near = Scene(load_sample("uncoated"), eye=Eye(field_of_view_deg=12.0, shift_right=0.06))
        far = dataclasses.replace(near, eye=Eye(field_of_view_deg=12.0, shift_right=-0.06))
        size = (80, 60)
        renderer.render(near, Look(), size)
        moved = renderer.render(far, Look(), size)
        fresh = Renderer(renderer.ctx, renderer.programs)
        expected = fresh.render(far, Look(), size)
        assert np.any(moved.on_object)
        np.testing.assert_array_equal(moved.coverage, expected.coverage)
        assert_same_pixels(moved.display, expected.display)
        assert_same_pixels(moved.light, expected.light)
        fresh.release()

    @pytest.mark.parametrize(
        ("shape", "eye"),
        [
            (
                Shape("cylinder", diameter_m=10, height_m=1e-3),
                Eye(azimuth_deg=1, distance_m=5.0005, field_of_view_deg=100),
            ),
            (
                Shape("cylinder", diameter_m=1, height_m=0.01),
                Eye(distance_m=0.505, field_of_view_deg=100),
            ),
            *(
                (
                    Shape(kind, 1e-3, 1e-3, 1e-3, 1e-3),
                    Eye(azimuth_deg=33, elevation_deg=21, distance_m=1000),
                )
                for kind in ("sphere", "cylinder", "box")
            ),
        ],
    )
    def test_very_near_and_very_far(self, renderer, monkeypatch, shape, eye):
        from relgloss_view.picture.model import view as views

        scene = Scene(load_sample("uncoated"), shape=shape, eye=eye)
        size = (300, 250)
        bounded = renderer.render(scene, Look(), size)
        assert np.sum(bounded.on_object) > 100
        monkeypatch.setattr(views, "_bounds", lambda *given: (0, 0, *given[-1]))
        views._view_of.cache_clear()
        full = Renderer(renderer.ctx, renderer.programs)
        np.testing.assert_array_equal(bounded.coverage, full.render(scene, Look(), size).coverage)
        full.release()
        views._view_of.cache_clear()
