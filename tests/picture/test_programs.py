"""The last used programs are kept, and pictures do not depend on which; so with freed targets."""

from __future__ import annotations

import dataclasses
import subprocess
import sys
from pathlib import Path

import materials
import numpy as np
import pytest

from relgloss_view import Look, Scene
from relgloss_view.pack.shape import Shape
from relgloss_view.picture.gpu.programs import Programs
from relgloss_view.picture.gpu.renderer import Renderer
from relgloss_view.picture.gpu.targets import GEOMETRY, LIGHT, WEIGHTS, XYZ

ROOT = Path(__file__).resolve().parents[2]
SIZE = (40, 32)
STAGES = ("display", "diffuse", "specular", "lab", "light", "normal", "tilted_normal", "point_m")
FEW = 8  #: programs: fewer than a picture with all its stages needs


def varied():
    """Pictures that need other programs each: forms, lobes, grain, samples."""
    for paper in ("cast", "uncoated"):
        for shape in ("sphere", "cylinder", "plane"):
            for look in (Look(), Look(2.0, samples=2), Look(1.0, grain="eye")):
                yield Scene(materials.paper(paper), shape=Shape(shape)), look


def drawn(renderer, scene, look):
    frame = renderer.render(scene, look, SIZE)
    arrays = {name: np.array(getattr(frame, name)) for name in STAGES}
    return arrays | {"clipped": np.array(frame.clip_count), "c": np.array(frame.c)}


def assert_equal(one, other):
    for name, array in one.items():
        np.testing.assert_array_equal(array, other[name], err_msg=name)


def test_few_programs_draw_the_same_pictures(ctx):
    few, all_ = Programs(ctx, FEW), Programs(ctx, 1000)
    renderers = Renderer(ctx, few), Renderer(ctx, all_)
    for scene, look in varied():
        assert_equal(*(drawn(renderer, scene, look) for renderer in renderers))
        assert few.count <= FEW
    # The control: without room made, there are many more.
    assert all_.count == all_.compiled > 4 * FEW
    assert few.freed == few.compiled - few.count > 0
    for renderer, programs in zip(renderers, (few, all_), strict=True):
        renderer.release()
        programs.release()


def test_the_last_used_ones_stay(ctx):
    programs = Programs(ctx, 4)
    names = {"GAMUT": 0, "TRANSFER": 1, "SAMPLED": 0, "DITHER": 0, "SEEN_ON": 0, "REACH": 0}
    made = [programs.get("tone.frag", names | {"DITHER": k % 2, "GAMUT": k // 2}) for k in range(4)]
    assert programs.get("tone.frag", names) is made[0]  # used again: now the second is the oldest
    programs.get("tone.frag", names | {"SAMPLED": 1})
    assert programs.freed == 1
    compiled = programs.compiled
    assert programs.get("tone.frag", names) is made[0]
    assert programs.compiled == compiled
    programs.get("tone.frag", names | {"DITHER": 1})
    assert programs.compiled == compiled + 1  # the oldest had gone
    programs.release()


def test_a_renderer_with_shared_programs_uses_them_while_they_are_none(ctx):
    programs = Programs(ctx, 64)
    assert Renderer(ctx, programs).programs is programs


@pytest.mark.parametrize("samples", [1, 2])
@pytest.mark.parametrize("grain", ["screen", "eye"])
def test_what_is_freed_at_rest_is_drawn_again(ctx, samples, grain):
    kept, tidied = Renderer(ctx), Renderer(ctx)
    scene, look = Scene(materials.paper("cast")), Look(1.0, samples=samples, grain=grain)
    turned = scene.placed(lamp=dataclasses.replace(scene.lamp, azimuth_deg=30.0))
    steps = [(scene, look), (scene, look.with_entries(c=0.4)), (turned, look), (scene, look)]
    freed = 0
    for one in steps:
        want = drawn(kept, *one)
        frame = tidied.render(*one, SIZE)
        freed += tidied.tidy()
        np.testing.assert_array_equal(frame.display, want["display"])
        assert_equal(want, drawn(tidied, *one))
        freed += tidied.tidy()
        left = set(tidied.passes.targets.held())
        assert not left & {*LIGHT, *GEOMETRY}
        assert samples > 1 or not left & {*WEIGHTS, *XYZ}
    assert freed > 0
    assert {*LIGHT, *GEOMETRY} <= set(kept.passes.targets.held())  # the control
    kept.release()
    tidied.release()


@pytest.mark.slow
def test_many_varied_pictures_take_bounded_memory():
    """300 of the 20,000 pictures that the script draws by itself.

    Without a bound on programs, 200 of them took 608 MB (commit 851e9fa, llvmpipe of Mesa 22.3).
    """
    script = ROOT / "scripts" / "varied_pictures.py"
    done = subprocess.run(
        [sys.executable, str(script), "--count", "300"], capture_output=True, text=True, timeout=900
    )
    assert done.returncode == 0, done.stdout[-500:] + done.stderr[-2000:]
    assert "300 pictures" in done.stdout
