"""What a profile shows, on the device: GLSL against float64, and what another profile draws again.

One step of 8 bits is 1/255. Digital values of the shader and of float64 that are less than one step
apart round to the same or to the next step.
"""

from __future__ import annotations

import glob
import os
import shutil
import subprocess

import numpy as np
import pytest

from relgloss_view.display import inverse_nodes
from relgloss_view.display.display import Display
from relgloss_view.display.inverse_nodes import CURVE_CELLS
from relgloss_view.display.model import DisplayModel
from relgloss_view.display.monitor import Curves
from relgloss_view.display.read import monitor_of
from relgloss_view.display.table import Table
from relgloss_view.display.tone_curve import ToneCurve
from relgloss_view.picture.gpu.constants import code
from relgloss_view.picture.gpu.evaluate import evaluate
from relgloss_view.picture.gpu.overlays import draw_overlay
from relgloss_view.picture.gpu.renderer import Renderer
from relgloss_view.picture.gpu.uploads import Uploads
from relgloss_view.picture.model import tone
from relgloss_view.picture.reference import ReferenceRenderer
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.sample import load_sample
from relgloss_view.picture.scene.scene import Scene

COLORD = "/usr/share/color/icc/colord"
SIZE = (48, 48)
LOOK = Look(c_fraction=1.3)  # some of it clips
PROFILES = [
    path for path in sorted(glob.glob(f"{COLORD}/*.icc"))
    if os.path.basename(path) not in ("Crayons.icc", "x11-colors.icc")  # named colours
]  # fmt: skip
needs_profiles = pytest.mark.skipif(not PROFILES, reason="colord's profiles are not here")


def scene_of(display):
    return Scene(load_sample("matte-coated"), display=display)


def power(gamma):
    return ToneCurve(lambda d: np.power(d, gamma))


def srgb(d):
    return np.where(d <= 0.04045, d / 12.92, ((d + 0.055) / 1.055) ** 2.4)


def shown_by_curves(ctx, curves, light):
    uploads = Uploads(ctx)
    got = evaluate(
        ctx,
        ["transfer.glsl"],
        "result = vec4(encode(TRANSFER_CURVES, v.xyz, vec4(1)), 1);",
        {"v": light.astype(np.float32)},
        defines={"TRANSFER": code("TRANSFER", "curves"), "CURVE_CELLS": f"{CURVE_CELLS}.0"},
        samplers={"transfer_curves": uploads.curves(curves)},
    )
    uploads.release()
    return got[:, :3].astype(np.float64)


def shown_by_table(ctx, table, light):
    """(N, 4): digital values, and whether the light is reached."""
    uploads = Uploads(ctx)
    texture = uploads.table(table)
    got = evaluate(
        ctx,
        ["transfer.glsl"],
        "vec3 digital; bool reached = table_reach(v.xyz, digital); "
        "result = vec4(encode(TRANSFER_TABLE, v.xyz, vec4(1)), reached ? 1 : 0);",
        {"v": light.astype(np.float32)},
        defines={
            "TRANSFER": code("TRANSFER", "table"),
            "TABLE_NODES": f"{inverse_nodes.TABLE_NODES}.0",
            "REACH": 1,
        },
        samplers={"transfer_table": texture, "reach_table": texture},
    )
    uploads.release()
    return got.astype(np.float64)


class TestCurves:
    @pytest.mark.parametrize("gammas", [(0.5, 1.0, 1.8), (2.2, 2.6, 4.0)])
    def test_powers_in_closed_form(self, ctx, gammas):
        """Float32 light is exact here; the nodes of CURVE_CELLS alone are off, by at most 3e-4."""
        curves = Curves(tuple(power(g) for g in gammas))
        light = np.random.default_rng(1).uniform(0.0, 1.0, (4000, 3)) ** 4
        got = shown_by_curves(ctx, curves, light)
        assert np.abs(got - light ** (1.0 / np.array(gammas))).max() < 1e-3
        # Negative control: the curve of another channel is not within two steps.
        assert np.abs(got - light ** (1.0 / np.array(gammas[::-1])))[:, 0].max() > 2.0 / 255.0

    def test_ends_are_exact(self, ctx):
        curves = Curves((ToneCurve(srgb),) * 3)
        got = shown_by_curves(ctx, curves, np.array([[0.0, 1.0, 1.5], [1.0, 0.0, 0.5]]))
        np.testing.assert_allclose(got[:, :2], [[0.0, 1.0], [1.0, 0.0]], atol=1e-6)
        assert got[0, 2] == pytest.approx(1.0, abs=1e-6)


def mixing_screen(loss):
    """A screen whose channels dim each other where two are lit; below 0, light each other up."""
    matrix = np.array([[0.436, 0.385, 0.143], [0.222, 0.717, 0.061], [0.014, 0.097, 0.714]])

    def forward(digital):
        light = np.power(digital, 2.2)
        mixed = light.sum(axis=1, keepdims=True) - light.max(axis=1, keepdims=True)
        return (light * (1.0 - loss * mixed / (1.0 + mixed))) @ matrix.T

    white = forward(np.ones((1, 3)))[0]
    own = matrix * np.linalg.solve(matrix, white)
    return Table(forward, np.linalg.inv(own), np.zeros(3))


class TestTable:
    @pytest.mark.slow
    def test_against_the_table_itself(self, ctx):
        table = mixing_screen(0.02)
        digital = np.random.default_rng(2).uniform(0.03, 1.0, (3000, 3))
        light = table.light(digital)
        inside = np.all((light >= 0.0) & (light <= 1.0), axis=1)
        assert np.mean(inside) > 0.4
        got = shown_by_table(ctx, table, light[inside])
        assert np.abs(got[:, :3] - digital[inside]).max() < 1.0 / 255.0
        assert np.mean(np.abs(got[:, :3] - digital[inside])) < 0.25 / 255.0
        assert np.all(got[:, 3] == 1.0)
        # Negative control: by curves alone, as if channels added, it is further off.
        assert np.abs(light[inside] ** (1.0 / 2.2) - digital[inside]).max() > 1.0 / 255.0

    def test_what_it_cannot_reach(self, ctx, monkeypatch):
        """A screen whose white is brighter than its channels together shows no bright primaries."""
        monkeypatch.setattr(inverse_nodes, "TABLE_NODES", 25)  # so that the test is quick
        table = mixing_screen(-0.3)
        light = np.random.default_rng(3).uniform(0.0, 1.0, (3000, 3))
        left = table.solved(light)[1]
        got = shown_by_table(ctx, table, light)[:, 3]
        reached, beyond = left < 0.05, left > 1.0
        assert np.sum(reached) > 100
        assert np.sum(beyond) > 100
        assert np.mean(got[reached]) > 0.99
        assert np.mean(got[beyond]) < 0.01


def steps_off(first, second):
    return int(np.abs(first.display.astype(int) - second.display).max())


@needs_profiles
class TestPictures:
    def test_each_profile_against_float64(self, ctx):
        renderer, reference = Renderer(ctx), ReferenceRenderer()
        off = {}
        for path in PROFILES:
            scene = scene_of(Display(profile=path))
            frame = renderer.render(scene, LOOK, SIZE)
            off[os.path.basename(path)] = steps_off(frame, reference.render(scene, LOOK, SIZE))
        assert max(off.values()) <= 1, off
        plain = renderer.render(scene_of(Display()), LOOK, SIZE)
        adobe = scene_of(Display(profile=f"{COLORD}/AdobeRGB1998.icc"))
        assert steps_off(reference.render(adobe, LOOK, SIZE), plain) > 1  # negative control
        renderer.release()

    def test_another_profile_draws_the_last_pass_alone_and_compiles_nothing(self, ctx):
        renderer = Renderer(ctx)
        renderer.render(scene_of(Display(profile=PROFILES[0])), LOOK, SIZE)
        before, compiled = dict(renderer.draws), renderer.programs.compiled
        for k, path in enumerate(PROFILES[1:4], 1):
            for look in (LOOK, Look(c_fraction=0.5 + 0.1 * k)):
                renderer.render(scene_of(Display(profile=path)), look, SIZE)
        drawn = {n for n, count in renderer.draws.items() if count > before[n]}
        assert drawn == {"tone"}
        assert renderer.programs.compiled == compiled
        renderer.render(scene_of(Display()), LOOK, SIZE)  # another kind
        assert renderer.programs.compiled > compiled
        renderer.release()

    @pytest.mark.parametrize("edges", ["sampled", "smooth"])
    def test_black_and_another_display(self, ctx, edges):
        """The floor, and the other display's light on this one, with the pixels it can't show."""
        display = Display(
            profile=f"{COLORD}/sRGB.icc",
            seen_on=f"{COLORD}/WideGamutRGB.icc",
            luminance_cd_m2=100.0,
            reflected_cd_m2=4.0,
            edges=edges,
        )
        renderer, reference = Renderer(ctx), ReferenceRenderer()
        for shown in (display, Display(profile=f"{COLORD}/sRGB.icc", reflected_cd_m2=4.0)):
            scene = scene_of(shown)
            frame, exact = (r.render(scene, LOOK, SIZE) for r in (renderer, reference))
            assert steps_off(frame, exact) <= 1
            flags = 255 - renderer.passes.targets.read("display")[..., 3].astype(int)
            model = DisplayModel.of(shown)
            whole = exact.on_object
            cut = tone.cut_by_screen(np.asarray(exact.light, dtype=np.float64), model) & whole
            assert np.mean((flags[whole] & 4 > 0) == cut[whole]) > 0.995
            assert np.any(cut) == (model.screen is not None)
            assert frame.clip_count == exact.clip_count  # flag 4 counts as neither
            texture = draw_overlay(renderer, scene, LOOK, SIZE, "cut by this display")
            pixels = np.frombuffer(texture.read(alignment=1), np.uint8).reshape(*SIZE, 4)[::-1]
            lined = np.all((pixels[..., :3] == 0) | (pixels[..., :3] == 255), axis=-1) & whole
            np.testing.assert_array_equal(lined, (flags & 4 > 0) & whole)
        renderer.release()


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("colprof") is None, reason="Argyll is not installed")
def test_a_profile_with_look_up_tables(ctx, tmp_path):
    source = "/usr/share/color/argyll/ref/sRGB.icm"
    if not os.path.exists(source):
        pytest.skip("Argyll's sRGB profile is not here")
    for command in (
        ["targen", "-v0", "-d3", "-f300", "t"],
        ["fakeread", "-v0", source, "t"],
        ["colprof", "-v0", "-ql", "-ax", "-O", "t.icc", "t"],
    ):
        subprocess.run(command, cwd=tmp_path, check=True, capture_output=True)
    path = str(tmp_path / "t.icc")
    assert monitor_of(path).emission.kind == "table"
    renderer, reference = Renderer(ctx), ReferenceRenderer()
    for display in (Display(profile=path), Display(profile=path, reflected_cd_m2=3.0)):
        scene = scene_of(display)
        frame = renderer.render(scene, LOOK, SIZE)
        assert steps_off(frame, reference.render(scene, LOOK, SIZE)) <= 1
    renderer.release()
