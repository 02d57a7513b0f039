"""Estimates of memory against what processes take, and limits under which none may crash."""

import resource
import subprocess
import sys

import numpy as np
import pytest

from relgloss_view.base import room
from relgloss_view.base.errors import InputError
from relgloss_view.base.resources import asset
from relgloss_view.base.room import GB, MB, Room
from relgloss_view.pack.artwork.artwork import Artwork
from relgloss_view.pack.finish import Finish
from relgloss_view.pack.pack import Pack
from relgloss_view.pack.shape import Shape
from relgloss_view.picture import peak
from relgloss_view.picture.peak import check_memory, check_picture, picture_bytes
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.sample import load_sample
from relgloss_view.picture.scene.scene import Scene

pytestmark = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="reads /proc")
BIG = (6144, 6144)

PEAK = """
import sys
from relgloss_view.cli import main
status = main(sys.argv[1:])
text = open("/proc/self/status").read()
print("peak", 1024 * int(text.split("VmHWM:")[1].split()[0]))
sys.exit(status)
"""


def measured_peak(*words):
    done = subprocess.run(
        [sys.executable, "-c", PEAK, *map(str, words)], capture_output=True, text=True, timeout=1800
    )
    assert done.returncode == 0, done.stderr
    return float(done.stdout.split()[-1])


def limited(megabytes, kind, *words):
    """Exit status and stderr of a command under a limit."""

    def limit():
        resource.setrlimit(kind, (megabytes << 20, megabytes << 20))

    done = subprocess.run(
        [sys.executable, "-m", "relgloss_view.cli", *map(str, words)],
        preexec_fn=limit, capture_output=True, text=True, timeout=600,
    )  # fmt: skip
    return done.returncode, done.stderr


def check_outcome(status, stderr):
    """Done, or one line; no signal, no traceback."""
    if status == 0:
        return
    assert status in (1, 3), (status, stderr)
    assert stderr.count("\n") == 1, stderr
    assert stderr.startswith("relgloss: "), stderr


class TestEstimates:
    def test_of_36_megapixels(self):
        assert picture_bytes(BIG) < 2.5 * GB
        assert picture_bytes(BIG, 4) < 3.2 * GB
        assert picture_bytes(BIG, backend="reference") < 3.5 * GB
        assert picture_bytes(BIG, uses=["multiscale"]) > 10 * GB

    def test_packs_take_more(self):
        """Their surface, their mesh, their artwork, each of which is counted."""
        plain, shape = Scene(load_sample("art-coated")), Shape("can")
        finishes = (Finish("ink", "ink", plain.material),)
        xyz = np.ones((512, 512, 3), dtype=np.float16)
        made = [
            plain.placed(shape=shape),
            Scene(plain.material, pack=Pack("bare", shape, finishes)),
            Scene(plain.material, pack=Pack("printed", shape, finishes, Artwork(xyz, 50.0, 50.0))),
        ]
        size = (1024, 1024)
        taken = [picture_bytes(size, scene=scene) for scene in (plain, *made)]
        assert taken[0] == picture_bytes(size)
        assert np.all(np.diff(taken) > 5 * MB)

    def test_more_takes_more(self):
        assert picture_bytes((100, 100), 2) > picture_bytes((100, 100))
        assert picture_bytes((100, 100), uses=["grid"]) > picture_bytes((100, 100), uses=["png"])
        assert picture_bytes((101, 100)) > picture_bytes((100, 100))

    def test_a_picture_without_room_is_refused_before_it_is_drawn(self, renderer, monkeypatch):
        scene, look = Scene(load_sample("art-coated")), Look()
        monkeypatch.setattr(room, "rooms", lambda: [Room(1.2 * GB, "is free", "resident")])
        with pytest.raises(InputError, match=r"6144x6144 pixels needs about .* GB of memory, and"):
            renderer.render(scene, look, BIG)
        assert renderer.draws["shade"] == 0
        with pytest.raises(InputError, match=r"1.2 GB is free; give a smaller --size"):
            check_picture(BIG, backend="reference")
        renderer.render(scene, look, (32, 32))

    def test_a_target_without_room(self, monkeypatch):
        monkeypatch.setattr(room, "rooms", lambda: [Room(70 * MB, "is free", "resident")])
        check_memory((100, 100), 16)
        check_memory((790, 790), 16)
        with pytest.raises(InputError, match="a picture of 1000x1000 pixels"):
            check_memory((1000, 1000), 16)

    def test_threads_of_the_driver_count(self, monkeypatch):
        monkeypatch.setenv("LP_NUM_THREADS", "2")
        two = peak.context_need()
        monkeypatch.setenv("LP_NUM_THREADS", "8")
        eight = peak.context_need()
        assert eight.addresses - two.addresses == 12 * room.THREAD_ADDRESSES
        assert eight.resident == two.resident


@pytest.mark.parametrize("megabytes", [420, 700])
def test_opengl_without_room_is_one_line(tmp_path, megabytes):
    words = ("snapshot", "--size", "16x16", "-o", tmp_path / "a.png")
    status, stderr = limited(megabytes, resource.RLIMIT_AS, *words)
    assert status == 1
    check_outcome(status, stderr)
    assert "raise the limit, or draw with --backend reference" in stderr


@pytest.mark.slow
@pytest.mark.parametrize(
    "megabytes", [30, 60, 100, 150, 200, 300, 450, 600, 800, 1000, 1400, 2000, 4000]
)
@pytest.mark.parametrize("kind", [resource.RLIMIT_AS, resource.RLIMIT_DATA])
def test_no_limit_ends_in_a_crash(tmp_path, megabytes, kind):
    sizes = ("64x64", "1024x1024", "2048x1536")
    for size in sizes:
        for name, *more in (
            ["a.png"],
            ["a.exr"],
            ["a.png", "--bits", 16],
            ["a.exr", "--operator", "clip"],
        ):
            words = ("snapshot", "--size", size, "-o", tmp_path / name, *more)
            status, stderr = limited(megabytes, kind, *words)
            check_outcome(status, stderr)
    words = ("snapshot", "--backend", "reference", "--size", "64x64", "-o", tmp_path / "a.exr")
    status, stderr = limited(megabytes, kind, *words)
    check_outcome(status, stderr)


@pytest.mark.slow
@pytest.mark.parametrize("size", [(640, 480), (1280, 1024), (2048, 2048)])
@pytest.mark.parametrize(
    ("use", "words"),
    [
        ("exr", ["a.exr"]),
        ("png", ["a.png"]),
        ("png16", ["a.png", "--bits", 16]),
        ("exr", ["a.exr", "--samples", 3]),
        ("clip", ["a.png", "--operator", "clip"]),
        ("multiscale", ["a.exr", "--operator", "multiscale"]),
        ("exr", ["a.exr", "--backend", "reference"]),
    ],
)
def test_estimates_hold(tmp_path, size, use, words):
    """What a process takes above the smallest picture is at most the estimate, and not far less."""
    name, *more = words
    base = measured_peak("snapshot", "-o", tmp_path / name, "--size", "8x8", *more)
    taken = (
        measured_peak("snapshot", "-o", tmp_path / name, "--size", f"{size[0]}x{size[1]}", *more)
        - base
    )
    samples = 3 if "--samples" in more else 1
    backend = "reference" if "reference" in more else "auto"
    estimate = picture_bytes(size, samples, backend=backend, uses=[use])
    assert taken < estimate + 20 * MB
    # Whatever the file, there is room for the parts of an EXR.
    assert estimate < 1.5 * taken + peak.PART


@pytest.mark.slow
@pytest.mark.parametrize("more", [[], ["--pack", asset("packs", "can.toml"), "--edges", "smooth"]])
def test_36_megapixels_take_at_most_4_gb(tmp_path, more):
    if min(r.left for r in room.rooms()) < 8 * GB:
        pytest.skip("less than 8 GB of memory is available")
    taken = measured_peak("snapshot", "-o", tmp_path / "a.exr", "--size", "6144x6144", *more)
    assert taken < 4 * GB
