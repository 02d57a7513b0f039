"""A signal: what was made is removed, one line, the status of the signal."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from relgloss_view import cli
from relgloss_view.base import interruptions

ROOT = Path(cli.__file__).parents[1]
SIGNALS = [signal.SIGINT, signal.SIGTERM, signal.SIGHUP]
GRID = ["grid", "--sample", "uncoated", "--size", "64x64", "-o", "g"]


def started(folder, words, ignored=()):
    def signals():
        for number in SIGNALS:
            signal.signal(number, signal.SIG_IGN if number in ignored else signal.SIG_DFL)

    (folder / "tmp").mkdir(exist_ok=True)
    return subprocess.Popen(
        [sys.executable, "-m", "relgloss_view.cli", *words], cwd=folder, preexec_fn=signals,
        env={**os.environ, "PYTHONPATH": str(ROOT), "TMPDIR": str(folder / "tmp")},
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip


def wait_for_pictures(folder):
    """Until the program is in the middle of its work, with OpenGL alive."""
    end_s = time.monotonic() + 60.0
    while not list(folder.glob(".relgloss-*.part/**/*.png")):
        assert time.monotonic() < end_s
        time.sleep(0.005)


@pytest.mark.parametrize("number", SIGNALS)
def test_in_the_middle_of_the_pictures(tmp_path, number):
    process = started(tmp_path, GRID)
    wait_for_pictures(tmp_path)
    process.send_signal(number)
    _, err = process.communicate(timeout=60)
    assert process.returncode == 128 + number
    assert err == f"relgloss: {interruptions.WORDS}\n"
    assert os.listdir(tmp_path) == ["tmp"]
    assert os.listdir(tmp_path / "tmp") == []


def test_a_second_signal_does_not_stop_the_clean_up(tmp_path):
    process = started(tmp_path, GRID)
    wait_for_pictures(tmp_path)
    for _ in range(5):
        process.send_signal(signal.SIGINT)
    process.communicate(timeout=60)
    assert process.returncode == 130
    assert os.listdir(tmp_path) == ["tmp"]


def test_what_nohup_ignores_stays_ignored(tmp_path):
    process = started(tmp_path, GRID, ignored=[signal.SIGHUP])
    wait_for_pictures(tmp_path)
    process.send_signal(signal.SIGHUP)
    process.communicate(timeout=60)
    assert process.returncode == 0
    assert (tmp_path / "g" / "manifest.json").exists()


def test_using_the_package_catches_nothing():
    code = (
        "import signal; before = [signal.getsignal(n) for n in (2, 15, 1)]\n"
        "from relgloss_view.cli import main; main(['--version'])\n"
        "assert before == [signal.getsignal(n) for n in (2, 15, 1)]"
    )
    subprocess.run([sys.executable, "-c", code], check=True, cwd=ROOT, capture_output=True)


def test_an_exception_waits_for_c_code_that_expects_none():
    """moderngl calls Python from C, and ends in a segmentation fault where that raises."""

    def frame_of(module):
        space = {"__name__": module, "sys": sys}
        exec("def inside(): return sys._getframe()", space)
        return space["inside"]()

    for module in ("_moderngl", "moderngl", "importlib._bootstrap", "tempfile"):
        assert interruptions._is_delicate(frame_of(module))
    assert not interruptions._is_delicate(frame_of("relgloss_view.picture.gpu.passes"))
