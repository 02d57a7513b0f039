"""A renderer in another thread than its own, and after a fork: a clear error, never a crash."""

import os
import subprocess
import sys
import threading

import pytest

from relgloss_view.base.errors import RelglossError
from relgloss_view.display.display import Display
from relgloss_view.picture.gpu import home
from relgloss_view.picture.gpu.overlays import draw_overlay
from relgloss_view.picture.gpu.renderer import Renderer
from relgloss_view.picture.output.export import save_frame
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.sample import load_sample
from relgloss_view.picture.scene.scene import Scene

SCENE = Scene(load_sample("art-coated"), display=Display(edges="smooth"))
LOOK, SIZE = Look(sigma_n_deg=1.0, samples=1), (24, 16)
OTHER = "opened in another thread; open a renderer in each thread"
STAGES = (
    "diffuse", "specular", "coverage", "split", "on_object", "light", "lab", "display", "edges",
    "clipped", "normal", "tilted_normal", "point_m", "clip_count", "out_of_gamut_count",
)  # fmt: skip


def in_thread(work):
    """The error that work raises in a thread of its own."""
    errors = []

    def run():
        try:
            work()
        except BaseException as error:
            errors.append(error)

    thread = threading.Thread(target=run)
    thread.start()
    thread.join()
    return errors[0] if errors else None


@pytest.mark.parametrize("stage", STAGES)
def test_a_stage_is_not_fetched_in_another_thread(renderer, stage):
    frame = renderer.render(SCENE, LOOK, SIZE)
    error = in_thread(lambda: getattr(frame, stage))
    assert isinstance(error, RelglossError)
    assert OTHER in str(error)
    getattr(frame, stage)  # at home it still is
    assert in_thread(lambda: getattr(frame, stage)) is None  # what was fetched is there for all


@pytest.mark.parametrize(
    "use",
    [
        lambda r: r.render(SCENE, LOOK, SIZE),
        lambda r: r.prepare(SCENE, LOOK),
        lambda r: r.framebuffer_name(("display",)),
        lambda r: r.texture("display"),
        lambda r: r.release(),
        lambda r: Renderer(r.ctx),
        lambda r: draw_overlay(r, SCENE, LOOK, SIZE, "clipped"),
    ],
)
def test_no_method_draws_in_another_thread(renderer, use):
    before = renderer.render(SCENE, LOOK, SIZE).display.copy()
    error = in_thread(lambda: use(renderer))
    assert isinstance(error, RelglossError)
    assert OTHER in str(error)
    use(renderer)  # at home it does
    assert (renderer.render(SCENE, LOOK, SIZE).display == before).all()


def test_a_file_is_not_written_in_another_thread(renderer, tmp_path):
    frame = renderer.render(SCENE, LOOK, SIZE)
    for name in ("a.png", "a.exr"):
        assert OTHER in str(in_thread(lambda name=name: save_frame(frame, tmp_path / name)))
    assert list(tmp_path.iterdir()) == []


SETUP = """
import gc, os, signal, sys, threading
from relgloss_view import Look, Scene, load_sample, open_renderer
scene, look = Scene(load_sample("art-coated")), Look(sigma_n_deg=1.0)
opened = open_renderer("egl")
renderer = opened.__enter__()
frame = renderer.render(scene, look, (24, 16))
def tried(work):
    try:
        work()
    except Exception as error:
        return type(error).__name__ + ": " + str(error)
    return "no error"
def forked(work):
    sys.stdout.flush()
    child = os.fork()
    if child == 0:
        signal.alarm(30)
        work()
        sys.exit(7)
    print("ended", os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
def draw():
    with open_renderer("egl") as other:
        return other.render(scene, look, (24, 16)).display
"""
AFTER = "\nprint(frame.display.sum() > 0, renderer.render(scene, look, (20, 20)).light.sum() > 0)"


def output(code):
    """What a process of its own prints, its errors too."""
    done = subprocess.run(
        [sys.executable, "-c", SETUP + code], capture_output=True, text=True, timeout=120
    )
    assert done.returncode == 0, (done.returncode, done.stderr)
    assert done.stderr == ""
    return done.stdout.splitlines()


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork on this system")
def test_after_a_fork():
    uses = (
        "frame.display",
        "renderer.render(scene, look, (30, 20))",
        "draw()",
        "renderer.texture('split')",
    )
    code = "def work():\n" + "".join(f"    print(tried(lambda: {use}))\n" for use in uses)
    code += "    renderer.release(); opened.__exit__(None, None, None)\n"
    code += "    print('closed')\nforked(work)"
    lines = output(code + AFTER)
    assert lines == [f"RelglossError: {home.FORKED}"] * len(uses) + [
        "closed",
        "ended 7",
        "True True",
    ]


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork on this system")
def test_collected_after_a_fork_and_in_another_thread():
    dropped = (
        "    global opened, renderer, frame\n    del opened, renderer, frame\n    gc.collect()\n"
    )
    code = "def work():\n" + dropped + "    print('collected')\n"
    code += "forked(work)\nthread = threading.Thread(target=work); thread.start(); thread.join()\n"
    code += "print(draw().sum() > 0)"
    assert output(code) == ["collected", "ended 7", "collected", "True"]


def test_renderers_in_threads_of_their_own():
    code = "def work():\n    print((draw() == frame.display).all())\n_ = frame.display\n"
    code += "thread = threading.Thread(target=work); thread.start(); thread.join()"
    assert output(code + AFTER) == ["True", "True True"]
