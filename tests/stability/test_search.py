"""A search for any scene, look and method of the declared ranges that draws what is no light.

Nothing that is not finite and nothing negative leaves either pass; or an InputError says what is
wrong.
"""

from __future__ import annotations

import numpy as np
import pytest
from any_picture import SIZES, looks, methods, scenes
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from materials import paper

from relgloss_view.base.errors import InputError
from relgloss_view.picture.gpu.renderer import Renderer
from relgloss_view.picture.method import Method
from relgloss_view.picture.reference import ReferenceRenderer
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.scene import Scene

QUICK = settings(
    max_examples=60,
    deadline=None,
    derandomize=True,
    database=None,
    suppress_health_check=list(HealthCheck),
)
LONG = settings(QUICK, max_examples=4000)


@pytest.fixture(scope="module")
def drawer(_session_ctx):
    made = Renderer(_session_ctx)
    yield made
    made.release()


def assert_light(frame, *, whole=True):
    """What leaves the passes is light: finite, nothing negative, nothing above the display."""
    for name in ("diffuse", "specular", "lab", "light"):
        assert np.all(np.isfinite(getattr(frame, name))), name
    assert np.min(frame.diffuse) >= 0.0
    assert np.min(frame.specular) >= 0.0
    assert 0.0 <= np.min(frame.light) <= np.max(frame.light) <= 1.0
    assert frame.display.dtype == np.uint8
    assert 0.0 <= frame.c < np.inf
    if whole:
        assert np.all(np.isfinite(frame.tilted_normal))
        assert np.all(np.isfinite(frame.point_m))
        assert 0 <= frame.clip_count <= frame.display[..., 0].size
        assert 0 <= frame.out_of_gamut_count <= frame.display[..., 0].size
    assert all(isinstance(text, str) for text in frame.warnings)


#: Programs of a software driver take a megabyte or two each, and a search compiles thousands.
MOST_PROGRAMS = 100


def try_shader(drawer, scene, look, method, size):
    if len(drawer.programs._arrays) > MOST_PROGRAMS:
        drawer.programs.release()
    try:
        frame = drawer.render(scene, look, size, method)
    except InputError as refused:
        assert len(str(refused)) > 20
        return False
    assert_light(frame)
    return True


def try_twin(scene, look, size):
    try:
        frame = ReferenceRenderer().render(scene, look, size)
    except InputError as refused:
        assert len(str(refused)) > 20
        return
    assert_light(frame)


class TestShader:
    @QUICK
    @given(scene=scenes(), look=looks(), method=methods(), size=st.sampled_from(SIZES))
    def test_any_picture_is_light(self, drawer, scene, look, method, size):
        try_shader(drawer, scene, look, method, size)

    @pytest.mark.slow
    @LONG
    @given(scene=scenes(), look=looks(), method=methods(), size=st.sampled_from(SIZES))
    def test_any_picture_is_light_at_length(self, drawer, scene, look, method, size):
        try_shader(drawer, scene, look, method, size)

    @pytest.mark.slow
    def test_most_of_what_is_tried_is_drawn(self, drawer):
        """Control: a search whose every request is refused would find nothing."""
        drawn = []

        @settings(QUICK, max_examples=40)
        @given(scene=scenes(), look=looks())
        def tried(scene, look):
            drawn.append(try_shader(drawer, scene, look, Method(), (24, 16)))

        tried()
        assert np.mean(drawn) > 0.5

    def test_light_that_is_none_is_told(self, drawer):
        """Control: the check fails on what it is there for."""
        frame = drawer.render(Scene(paper("matte")), Look(c=1.0), (8, 8))
        assert_light(frame)
        light = np.array(frame.light)
        light[3, 3] = np.nan
        frame.__dict__["light"] = light
        with pytest.raises(AssertionError, match="light"):
            assert_light(frame)


class TestTwin:
    @settings(QUICK, max_examples=60)
    @given(scene=scenes(), look=looks(), size=st.sampled_from(SIZES))
    def test_any_picture_is_light(self, scene, look, size):
        try_twin(scene, look, size)

    @pytest.mark.slow
    @settings(QUICK, max_examples=1200)
    @given(scene=scenes(), look=looks(), size=st.sampled_from(SIZES))
    def test_any_picture_is_light_at_length(self, scene, look, size):
        try_twin(scene, look, size)
