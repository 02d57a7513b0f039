"""Whole builds by the command, through kills, interruptions and on clusters: the same bytes."""

from __future__ import annotations

import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

import psutil
import pytest
from catalogue_clusters import (
    ENDED_S,
    STARTED_S,
    Cluster,
    python_of_nobody,
    results,
    wait_until,
    workers_of,
)
from catalogue_tasks import tasks_of, user

from relgloss_view.base.interruptions import WORDS
from relgloss_view.bench.verdicts.judging import SOUND, table_of
from relgloss_view.catalogue.engine import EngineOptions

pytestmark = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="ends by signals")
COMMAND = (sys.executable, "-m", "relgloss_view.cli", "catalogue", "build")


def tree(folder, count):
    """Tables with a known truth."""
    folder.mkdir(parents=True)
    for k in range(count):
        table_of(20, SOUND, k, None).write(folder / f"{k:03d}.csv")
    return folder


def start(samples, catalogue, *words):
    """Start a build in a folder of its own."""
    (catalogue.parent / "cwd").mkdir(exist_ok=True)
    return subprocess.Popen(
        [*COMMAND, str(samples), "-o", str(catalogue), *words],
        cwd=catalogue.parent / "cwd",
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def built(samples, catalogue, *words):
    """Build to the end. Returns every file of the catalogue but the items, by name."""
    build = start(samples, catalogue, *words)
    _, err = build.communicate(timeout=600)
    assert build.returncode == 0, err
    return content(catalogue)


def content(catalogue):
    """Bytes of a catalogue's files, by name."""
    files = (path for path in catalogue.rglob("*") if path.is_file())
    return {str(path.relative_to(catalogue)): path.read_bytes() for path in files}


def items(catalogue):
    """Items that a catalogue has kept."""
    return len([path for path in (catalogue / "items").glob("*/*") if path.is_file()])


@pytest.mark.slow
def test_a_build_whose_workers_are_killed_fifty_times(tmp_path):
    samples = tree(tmp_path / "samples", 60)
    untouched = built(samples, tmp_path / "untouched", "--workers", "2")
    build = start(samples, tmp_path / "killed", "--workers", "2")
    dice = random.Random(20)
    kills = []
    over = threading.Event()

    def killer():
        while len(kills) < 50 and not over.wait(dice.uniform(0.5, 2.0)):
            alive = workers_of(build.pid)
            if alive:
                kills.append(dice.choice(alive))
                kills[-1].send_signal(signal.SIGKILL)

    thread = threading.Thread(target=killer)
    thread.start()
    _, err = build.communicate()
    over.set()
    thread.join()
    assert build.returncode == 0, err
    assert len(kills) >= 30, "the build has to be longer"
    assert content(tmp_path / "killed") == untouched


@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGKILL])
def test_an_interrupted_build_goes_on(number, tmp_path):
    """Its status is the signal's, no process stays, what is done is kept, then the same bytes."""
    samples = tree(tmp_path / "samples", 8)
    untouched = built(samples, tmp_path / "untouched", "--workers", "1")
    catalogue = tmp_path / "stopped"
    build = start(samples, catalogue, "--workers", "2")
    assert wait_until(lambda: items(catalogue) >= 2, 120.0)
    workers = workers_of(build.pid)
    build.send_signal(number)
    _, err = build.communicate(timeout=ENDED_S)
    assert wait_until(lambda: not any(map(psutil.Process.is_running, workers)))
    kept = items(catalogue)
    assert kept >= 2
    if number != signal.SIGKILL:
        assert build.returncode == 128 + number
        goes_on = "what is done is kept; the same command goes on from there"
        assert err.splitlines() == [goes_on, f"relgloss: {WORDS}"]
    assert built(samples, catalogue, "--workers", "2") == untouched
    assert list((tmp_path / "cwd").iterdir()) == []


@pytest.mark.slow
def test_a_build_on_four_workers_of_another_user():
    """The same bytes as here; a table that is not theirs is named; a lost scheduler is one line."""
    nobody = python_of_nobody()
    if nobody is None:
        pytest.skip("needs root, setpriv and a Python that every user can run")
    folder = Path(tempfile.mkdtemp(prefix="relgloss-cluster-"))
    folder.chmod(0o755)
    cluster = Cluster(folder, nobody)
    try:
        samples = tree(folder / "samples", 8)
        here = built(samples, folder / "here", "--workers", "2")
        address = cluster.start_scheduler()
        for n in range(4):
            cluster.start_worker(f"w{n}")
        options = EngineOptions(scheduler=address, patience_s=STARTED_S)
        assert len(results(tasks_of(user, range(4)), options)) == 4
        assert built(samples, folder / "there", "--scheduler", address) == here

        private = samples / "private.csv"
        table_of(21, SOUND, 0, None).write(private)
        private.chmod(0o600)
        build = start(samples, folder / "there", "--scheduler", address)
        _, err = build.communicate(timeout=120)
        assert build.returncode == 1
        assert len(err.strip().splitlines()) == 1, err
        assert "worker w" in err
        assert str(private) in err
        private.unlink()

        build = start(samples, folder / "lost", "--scheduler", address)
        assert wait_until(lambda: items(folder / "lost") >= 2, 120.0)
        cluster.close()
        begun_s = time.monotonic()
        _, err = build.communicate(timeout=120)
        assert time.monotonic() - begun_s < 90.0
        assert build.returncode == 1
        assert len(err.strip().splitlines()) == 1, err
        assert items(folder / "lost") >= 2
        assert built(samples, folder / "lost", "--workers", "2") == here
    finally:
        cluster.close()
        shutil.rmtree(folder, ignore_errors=True)


def test_the_tests_leave_no_worker():
    """The processes of this file are all gone."""
    assert workers_of(os.getpid()) == []
