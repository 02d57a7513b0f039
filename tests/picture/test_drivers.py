"""One picture on every driver: EGL, OSMesa, softpipe, OpenGL 4.1, the window's own context."""

from __future__ import annotations

import ctypes.util
import os
import subprocess
import sys

import materials
import numpy as np
import pytest
from pictures import assert_same_pixels

from relgloss_view.picture.gpu.targets import SPLIT, TONE, WEIGHTS
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.quality.backends import open_renderer

DRIVER_SCRIPT = """
import sys, numpy as np
sys.path.insert(0, sys.argv[1])
import materials
from relgloss_view.quality.backends import open_renderer
from relgloss_view.picture.gpu.targets import WRITTEN
from relgloss_view.picture.gpu.variant import Variant
from relgloss_view.picture.method import EXACT, FIRST_PASS, Method
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.scene import Scene
with open_renderer(sys.argv[2]) as renderer:
    out = {"device": np.array(str(renderer.ctx.info["GL_RENDERER"]))}
    for name in ("cast", "uncoated"):
        for sigma in (0.0, 2.0):
            scene, look = Scene(materials.paper(name)), Look(sigma_n_deg=sigma)
            frame = renderer.render(scene, look, (128, 128))
            for stage in ("diffuse", "specular", "lab", "display"):
                out[f"{name} {sigma} {stage}"] = getattr(frame, stage)
            # What the passes themselves hold, of the exact path and of the one that splits sooner.
            for method in (EXACT, Method(split=FIRST_PASS)):
                renderer.render(scene, look, (128, 128), method)
                pass_1 = WRITTEN[Variant.of(scene, look, 1, method).writes]
                for target in {*pass_1, "split", "display"}:
                    stage = f"{name} {sigma} {method.split}, target {target}"
                    out[stage] = renderer.passes.targets.read(target)
    from relgloss_view.pack.finish import Finish
    from relgloss_view.pack.pack import Pack
    from relgloss_view.pack.shape import Shape
    ink = Finish("ink", "ink", materials.paper("matte"))
    spot = Finish("gloss", "varnish", materials.paper("cast"), "", "everywhere")
    pack = Pack("can", Shape("can"), (ink, spot))
    frame = renderer.render(Scene(ink.material, pack=pack), Look(sigma_n_deg=0.0), (64, 64))
    for stage in ("diffuse", "specular", "normal", "display"):
        out[f"pack {stage}"] = getattr(frame, stage)
np.savez(sys.argv[3], **out)
"""


@pytest.fixture(scope="module")
def pictures(tmp_path_factory):
    folder = tmp_path_factory.mktemp("drivers")

    def draw(backend, **environment):
        if backend == "osmesa" and ctypes.util.find_library("OSMesa") is None:
            return None
        path = folder / f"{backend}-{len(environment)}.npz"
        here = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
        done = subprocess.run(
            [sys.executable, "-c", DRIVER_SCRIPT, here, backend, str(path)],
            env={**os.environ, **environment},
            capture_output=True,
            text=True,
            timeout=300,
        )
        assert done.returncode == 0, done.stderr
        return np.load(path)

    return {
        "egl": draw("egl"),
        "osmesa": draw("osmesa"),
        "softpipe": draw("egl", GALLIUM_DRIVER="softpipe"),
        # As far as macOS goes.
        "gl41": draw("egl", MESA_GL_VERSION_OVERRIDE="4.1", MESA_GLSL_VERSION_OVERRIDE="410"),
    }


class TestDrivers:
    """Each driver in a process of its own, as its environment is read once a process."""

    def stages(self, pictures):
        return [name for name in pictures["egl"].files if name != "device"]

    def test_both_targets_of_the_exact_path_are_compared(self, pictures):
        targets = {
            name.partition("target ")[2] for name in self.stages(pictures) if "second pass" in name
        }
        assert targets == {*WEIGHTS, *SPLIT, *TONE}
        assert any("first pass, target split" in name for name in self.stages(pictures))

    def test_osmesa_is_bit_identical(self, pictures):
        if pictures["osmesa"] is None:
            pytest.skip("this system has no libOSMesa; Mesa 25.1 dropped it")
        if "llvmpipe" not in str(pictures["egl"]["device"]):
            pytest.skip("EGL is not on the software driver that OSMesa uses")
        for name in self.stages(pictures):
            assert_same_pixels(pictures["osmesa"][name], pictures["egl"][name])

    def test_opengl_41_is_bit_identical(self, pictures):
        for name in self.stages(pictures):
            assert_same_pixels(pictures["gl41"][name], pictures["egl"][name])

    def test_softpipe_is_close(self, pictures):
        """An independent driver of floats: 1e-4 relative, and 1e-6 of the brightest for the dark.

        Lab, a difference of roots, is held to the same 1e-4 of a lightness of 10.
        """
        assert "softpipe" in str(pictures["softpipe"]["device"])
        differs = False
        for name in self.stages(pictures):
            a, b = (pictures[d][name].astype(np.float64) for d in ("softpipe", "egl"))
            if name.startswith("pack"):
                continue
            differs |= bool(np.any(a != b))
            if name.endswith("display"):
                assert_same_pixels(a, b, within=1)
            elif name.endswith(("lab", "split")):
                assert_same_pixels(a, b, within=1e-3)
            else:
                np.testing.assert_allclose(a, b, rtol=1e-4, atol=1e-6 * np.max(b))
        assert differs, "two drivers that never differ are one driver: this test shows nothing"

    def test_softpipe_draws_packs(self, pictures):
        """A pixel on the edge between two triangles may see either: one in a thousand."""
        for name in ("pack diffuse", "pack specular", "pack normal", "pack display"):
            a, b = (pictures[d][name].astype(np.float64) for d in ("softpipe", "egl"))
            apart = np.abs(a - b).max(axis=-1)
            within = 1.0 if name.endswith("display") else 1e-3 * np.max(b)
            assert np.mean(apart > within) <= 1e-3
            assert np.mean(b[..., 0] != b[0, 0, 0]) > 0.1  # a can is seen


ATTACH_SCRIPT = """
import ctypes, sys, numpy as np
import imgui_bundle, glfw  # in this order both use the bundle's own GLFW
sys.path.insert(0, sys.argv[1])
import materials
from relgloss_view.quality.backends import open_renderer
from relgloss_view.picture.gpu.context import attach
from relgloss_view.picture.gpu.targets import SPLIT, TONE, WEIGHTS
from relgloss_view.picture.gpu.renderer import Renderer
from relgloss_view.picture.gpu.targets import WRITTEN
from relgloss_view.picture.gpu.variant import Variant
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.scene import Scene
glfw.init_hint(glfw.PLATFORM, glfw.PLATFORM_NULL)
assert glfw.init()
for hint, value in ((glfw.CONTEXT_CREATION_API, glfw.EGL_CONTEXT_API),
                    (glfw.CONTEXT_VERSION_MAJOR, 3), (glfw.CONTEXT_VERSION_MINOR, 3),
                    (glfw.OPENGL_PROFILE, glfw.OPENGL_CORE_PROFILE)):
    glfw.window_hint(hint, value)
window = glfw.create_window(64, 64, "window", None, None)
glfw.make_context_current(window)
load = lambda name: ctypes.cast(glfw.get_proc_address(name), ctypes.c_void_p).value or 0
request = Scene(materials.paper("matte")), Look(sigma_n_deg=1.0), (64, 48)
ctx = attach(load)
def targets(renderer):
    return [renderer.passes.targets.read(t) for t in (*WEIGHTS, *SPLIT, *TONE)]
drawn = Renderer(ctx)
in_window = drawn.render(*request).lab.copy()
in_targets = targets(drawn)
assert ctx.error == "GL_NO_ERROR"
with open_renderer("egl") as headless:
    np.testing.assert_array_equal(in_window, headless.render(*request).lab)
    for one, other in zip(in_targets, targets(headless), strict=True):
        np.testing.assert_array_equal(one, other)
"""


def test_a_windows_own_context_draws_the_same():
    """GLFW's null platform: a window and its context, without a display."""
    here = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
    words = [sys.executable, "-c", ATTACH_SCRIPT, here]
    done = subprocess.run(words, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr


def test_backends_open_and_close():
    for backend in ("egl", "reference"):
        with open_renderer(backend) as renderer:
            assert renderer.render(Scene(materials.flat()), Look(), (8, 8)).display.shape == (
                8,
                8,
                3,
            )
