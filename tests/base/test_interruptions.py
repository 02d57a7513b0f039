"""A signal: what was made is removed, one line, the status of the signal."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

from relgloss_view import cli
from relgloss_view.base import interruptions

ROOT = Path(cli.__file__).parents[1]
SIGNALS = [signal.SIGINT, signal.SIGTERM, signal.SIGHUP]
GRID = ["grid", "--sample", "uncoated", "--size", "64x64", "-o", "g"]


@pytest.fixture
def started():
    """A function that starts the program; what still runs after a failed assertion is ended."""
    processes = []

    def start(folder, words, ignored=()):
        def signals():
            for number in SIGNALS:
                signal.signal(number, signal.SIG_IGN if number in ignored else signal.SIG_DFL)

        (folder / "tmp").mkdir(exist_ok=True)
        process = subprocess.Popen(
            [sys.executable, "-m", "relgloss_view.cli", *words], cwd=folder, preexec_fn=signals,
            env={**os.environ, "PYTHONPATH": str(ROOT), "TMPDIR": str(folder / "tmp")},
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        )  # fmt: skip
        processes.append(process)
        return process

    yield start
    for process in processes:
        if process.poll() is None:
            process.kill()
        process.communicate()


def wait_for_pictures(folder):
    """Until the program is in the middle of its work, with OpenGL alive."""

    def pictures():
        # os.walk passes over a folder that is renamed meanwhile; pathlib's glob (3.11) raises
        for root, _, names in os.walk(folder):
            if "/.relgloss-" in root and any(name.endswith(".png") for name in names):
                return True
        return False

    end_s = time.monotonic() + 60.0
    while not pictures():
        assert time.monotonic() < end_s
        time.sleep(0.005)


@pytest.mark.parametrize("number", SIGNALS)
def test_in_the_middle_of_the_pictures(started, tmp_path, number):
    process = started(tmp_path, GRID)
    wait_for_pictures(tmp_path)
    process.send_signal(number)
    _, err = process.communicate(timeout=60)
    assert process.returncode == 128 + number
    assert err == f"relgloss: {interruptions.WORDS}\n"
    assert os.listdir(tmp_path) == ["tmp"]
    assert os.listdir(tmp_path / "tmp") == []


def test_a_second_signal_does_not_stop_the_clean_up(started, tmp_path):
    process = started(tmp_path, GRID)
    wait_for_pictures(tmp_path)
    for _ in range(5):
        process.send_signal(signal.SIGINT)
    process.communicate(timeout=60)
    assert process.returncode == 130
    assert os.listdir(tmp_path) == ["tmp"]


def test_what_nohup_ignores_stays_ignored(started, tmp_path):
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


@pytest.fixture
def signals(monkeypatch):
    """The program's handlers, without the signals' own."""
    one = interruptions.Signals()
    monkeypatch.setattr(interruptions, "SIGNALS", one)
    return one


def test_a_checkpoint_raises_once_and_only_what_was_noted(signals, monkeypatch):
    interruptions.checkpoint()
    signals._note(signal.SIGTERM, None)
    with pytest.raises(interruptions.Interrupted) as raised:
        interruptions.checkpoint()
    assert raised.value.exit_status == 143
    interruptions.checkpoint()  # a clean-up passes here
    later_s = time.monotonic() + 3.1
    monkeypatch.setattr(interruptions.time, "monotonic", lambda: later_s)
    with pytest.raises(interruptions.Interrupted):  # the first was swallowed
        interruptions.checkpoint()
    assert signals.noted


def test_no_checkpoint_raises_in_a_commit_or_in_another_thread(signals):
    signals._note(signal.SIGINT, None)
    with interruptions.uninterrupted(), interruptions.uninterrupted(may_leave=True):
        interruptions.checkpoint()
    faults = []

    def work():
        try:
            interruptions.checkpoint()
        except BaseException as error:
            faults.append(error)

    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert faults == []
    with pytest.raises(interruptions.Interrupted):
        interruptions.pause(10.0)


CODE = """
import os, signal, sys, time
sys.argv = ["relgloss"]
from relgloss_view.base import interruptions
interruptions.SIGNALS.before_leaving(lambda: print("cleaned", flush=True))
interruptions.SIGNALS.work()
interruptions.AGAIN_S = 0.0
with interruptions.uninterrupted(may_leave=sys.stdin.readline() == "frames\\n"):
    for _ in range(2):
        os.kill(os.getpid(), signal.SIGTERM)
        time.sleep(0.01)
print("committed", flush=True)
"""


@pytest.mark.parametrize(("kind", "out"), [("frames", "cleaned\n"), ("commit", "committed\n")])
def test_a_later_second_signal_leaves_but_not_in_a_commit(kind, out):
    done = subprocess.run(
        [sys.executable, "-c", CODE], input=f"{kind}\n", cwd=ROOT, capture_output=True, text=True
    )
    assert done.stdout == out, done.stderr
    assert done.returncode == (143 if kind == "frames" else 0)


@pytest.mark.parametrize(
    ("words", "module"),
    [
        ("python -m relgloss_view.cli fit", "relgloss_view.cli"),
        ("python -X importtime -W ignore -I -m relgloss_view.cli", "relgloss_view.cli"),
        ("python tool.py -m relgloss_view.cli", ""),
        ("python -c pass -m relgloss_view.cli", ""),
        ("python -m", ""),
    ],
)
def test_which_command_lines_are_the_program(words, module):
    assert interruptions._module_of(words.split()) == module
