"""The engine on a running Dask cluster: processes of another user, faults of the cluster."""

from __future__ import annotations

import shutil
import sys
import tempfile
import threading
import time
from pathlib import Path

import catalogue_tasks as work
import pytest
from catalogue_clusters import NOBODY, STARTED_S, Cluster, python_of_nobody, results

from relgloss_view.base.errors import InputError
from relgloss_view.catalogue.engine import EngineOptions, Lost, Task, run

pytestmark = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="ends by signals")


@pytest.fixture
def cluster_folder():
    """A folder that every user can reach."""
    folder = Path(tempfile.mkdtemp(prefix="relgloss-cluster-"))
    folder.chmod(0o755)
    yield folder
    shutil.rmtree(folder, ignore_errors=True)


@pytest.fixture
def cluster(cluster_folder):
    """A cluster without processes yet."""
    made = Cluster(cluster_folder)
    yield made
    made.close()


def test_a_cluster_gives_what_the_loop_gives(cluster):
    """A worker with three threads works in one; a deadly task is lost alone."""
    address = cluster.start_scheduler()
    cluster.start_worker("one")
    cluster.start_worker("two", "--nthreads", "3")
    tasks = [
        *work.tasks_of(work.square, range(10)),
        *work.tasks_of(work.place, range(12)),
        *work.tasks_of(work.square, range(10, 20)),
    ]
    options = EngineOptions(scheduler=address, patience_s=STARTED_S)
    got = results(tasks, options)
    threads = {}
    for n in range(12):
        pid, thread, _, variables = got.pop(f"place {n}")
        assert threads.setdefault(pid, thread) == thread
        assert variables["LP_NUM_THREADS"] == "1"
    assert got == {f"square {n}": work.square(n) for n in range(20)}
    with pytest.raises(InputError, match=r"worker (one|two) .*no table\.csv"):
        results([Task("a", "a.csv", work.text_of, ("/no table.csv",))], options)


def test_a_lost_scheduler_ends_the_run_after_a_while(cluster):
    address = cluster.start_scheduler()
    cluster.start_worker("one")
    got, lost_s = {}, []
    options = EngineOptions(scheduler=address, patience_s=STARTED_S)

    def done(task, result):
        got[task.key] = result
        if len(got) == 5:
            cluster.close()
            lost_s.append(time.monotonic())
            # Not sooner: a busy machine takes its time to find the worker.
            object.__setattr__(options, "patience_s", 2.0)

    tasks = work.tasks_of(work.slow_square, range(200), 0.02)
    with pytest.raises(InputError) as caught:
        run(tasks, done, options)
    assert time.monotonic() - lost_s[0] > 1.0  # counted from when the worker was seen last
    assert "no answer for 2 s" in str(caught.value)
    assert "what is done is kept" in str(caught.value)
    assert 5 <= len(got) < 200
    assert all(got[f"slow_square {result['number']}"] == result for result in got.values())


def test_a_cluster_without_workers_ends_the_run(cluster, monkeypatch):
    import distributed

    connected = distributed.Client.__init__

    def in_time(client, *words, timeout, **more):  # a busy machine takes more than a second
        connected(client, *words, timeout=STARTED_S, **more)

    monkeypatch.setattr(distributed.Client, "__init__", in_time)
    address = cluster.start_scheduler()
    with pytest.raises(InputError, match=rf"no worker for 1 s.*dask worker {address} --nthreads 1"):
        results(
            work.tasks_of(work.square, range(3)), EngineOptions(scheduler=address, patience_s=1)
        )


@pytest.mark.slow
def test_four_workers_of_another_user(cluster_folder):
    """Files on a shared folder, another home: same results; a file that is not theirs is named."""
    nobody = python_of_nobody()
    if nobody is None:
        pytest.skip("needs root, setpriv and a Python that every user can run")
    shared = cluster_folder / "shared"
    shared.mkdir()
    for n in range(40):
        (shared / f"{n}.csv").write_text(f"table {n}")
    private = shared / "private.csv"
    private.write_text("private")
    private.chmod(0o600)
    tasks = [Task(str(n), f"{n}.csv", work.text_of, (str(shared / f"{n}.csv"),)) for n in range(40)]
    theirs = Cluster(cluster_folder, nobody)
    try:
        address = theirs.start_scheduler()
        for n in range(4):
            theirs.start_worker(f"w{n}")
        options = EngineOptions(scheduler=address, patience_s=STARTED_S)
        assert results(tasks, options) == results(tasks, EngineOptions(workers=1))
        where = results(work.tasks_of(work.user, range(20)), options)
        assert set(where.values()) == {(NOBODY, str(cluster_folder / "home"))}
        with pytest.raises(InputError) as caught:
            results([Task("p", "private.csv", work.text_of, (str(private),))], options)
    finally:
        theirs.close()
    line = str(caught.value)
    assert line.startswith("worker w")
    assert "user nobody" in line
    assert f"Permission denied: '{private}'" in line


@pytest.fixture
def other_program(tmp_path):
    """Folders that hide relgloss from a process, or give it another one."""

    def made(version):
        package = tmp_path / f"with {version}" / "relgloss_view"
        package.mkdir(parents=True)
        text = "" if version else "raise ImportError('not installed')"
        (package / "__init__.py").write_text(text)
        if version:
            (package / "base").mkdir()
            (package / "base" / "version.py").write_text(f"__version__ = {version!r}")
        return (str(package.parent),)

    return made


@pytest.mark.slow
def test_a_cluster_with_another_program(cluster, other_program):
    """Worker, then scheduler: one line each, and the workers live on."""
    address = cluster.start_scheduler()
    options = EngineOptions(scheduler=address, patience_s=STARTED_S)
    old = cluster.start_worker("old", packages=other_program("0.0.1"))
    with pytest.raises(InputError, match=r"worker tcp://\S+ relgloss 0\.0\.1 in place of "):
        results(work.tasks_of(work.square, range(3)), options)
    assert old.poll() is None
    cluster.close()
    address = cluster.start_scheduler()
    options = EngineOptions(scheduler=address, patience_s=STARTED_S)
    bare = cluster.start_worker("bare", packages=other_program(None))
    with pytest.raises(InputError, match=r"worker tcp://\S+ it has no relgloss"):
        results(work.tasks_of(work.square, range(3)), options)
    assert bare.poll() is None
    cluster.close()
    address = cluster.start_scheduler(packages=other_program(""))
    with pytest.raises(InputError, match=f"scheduler {address}: it has no relgloss"):
        results(work.tasks_of(work.square, range(3)), EngineOptions(scheduler=address))


@pytest.mark.slow
def test_a_scheduler_that_comes_back(cluster):
    """The run goes on, and every task is done."""
    address = cluster.start_scheduler()
    cluster.start_worker("one")
    port = int(address.rsplit(":", 1)[1])
    threads = []

    def restart():
        cluster.close()
        assert cluster.start_scheduler(port) == address
        cluster.start_worker("again")

    count = 0

    def step():
        nonlocal count
        count += 1
        if count == 20:
            threads.append(threading.Thread(target=restart))
            threads[0].start()

    tasks = work.tasks_of(work.slow_square, range(100), 0.02)
    got = results(tasks, EngineOptions(scheduler=address, patience_s=STARTED_S), step)
    threads[0].join()
    assert got == {f"slow_square {n}": work.square(n) for n in range(100)}


@pytest.mark.slow
def test_a_deadly_task_on_a_cluster(cluster):
    """Dask tries it on four workers itself; its neighbours are done."""
    address = cluster.start_scheduler()
    for name in ("one", "two"):
        cluster.start_worker(name)
    tasks = [
        *work.tasks_of(work.square, range(6)),
        *work.tasks_of(work.deadly, [7]),
        *work.tasks_of(work.square, range(8, 20)),
    ]
    got = results(tasks, EngineOptions(scheduler=address, patience_s=STARTED_S))
    assert isinstance(got.pop("deadly 7"), Lost)
    assert got == {f"square {n}": work.square(n) for n in (*range(6), *range(8, 20))}
