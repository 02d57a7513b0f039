"""The engines of a catalogue: same results, whatever dies; nothing is left behind."""

from __future__ import annotations

import dataclasses
import os
import random
import signal
import subprocess
import sys
import time
import tomllib
import urllib.request
from pathlib import Path

import catalogue_tasks as work
import psutil
import pytest
from catalogue_clusters import ENDED_S, HERE, ROOT, results, wait_until, workers_of

from relgloss_view.base.errors import GLUnavailableError, InputError
from relgloss_view.catalogue import cluster, cluster_evidence, cluster_processes, one_thread
from relgloss_view.catalogue.cluster_batches import MOST, Batches
from relgloss_view.catalogue.cluster_worker import Program, Refused, perform, this_program
from relgloss_view.catalogue.engine import EngineOptions, Lost, Task
from relgloss_view.catalogue.one_thread import thread_counts

TWO = EngineOptions(workers=2)


def by_one(tasks):
    """What one process of its own gives: each that starts costs half a second of a processor."""
    return results(tasks, EngineOptions(workers=1), engine=cluster.on_processes)


@pytest.fixture(autouse=True)
def tasks_reach_workers(monkeypatch):
    """Workers can import the tasks of the tests."""
    monkeypatch.setenv("PYTHONPATH", f"{ROOT}{os.pathsep}{HERE}")


def test_processes_give_what_the_loop_gives(tmp_path, monkeypatch):
    """Same results; loopback alone; one thread each; no file where the program was started."""
    monkeypatch.chdir(tmp_path)
    listening = set()

    def look():
        for process in [psutil.Process(), *workers_of(os.getpid())]:
            for socket in process.net_connections(kind="inet"):
                if socket.status == psutil.CONN_LISTEN:
                    listening.add(socket.laddr.ip)

    tasks = [*work.tasks_of(work.square, range(30)), *work.tasks_of(work.place, range(10))]
    loop = results(tasks, EngineOptions(workers=1))
    processes = results(tasks, TWO, look)
    assert list(loop) == [task.key for task in tasks]
    assert loop.keys() == processes.keys()
    for key in (task.key for task in tasks[:30]):
        assert processes[key] == loop[key]
    threads = {}
    for key in (task.key for task in tasks[30:]):
        pid, thread, folder, variables = processes[key]
        assert pid != os.getpid()
        assert Path(folder) != tmp_path
        assert threads.setdefault(pid, thread) == thread
        assert variables["LP_NUM_THREADS"] == variables["OMP_NUM_THREADS"] == "1"
    assert listening == {"127.0.0.1"}
    assert not workers_of(os.getpid())
    assert list(tmp_path.iterdir()) == []


def test_a_batch_ends_at_its_time_and_before_a_fault():
    """What was not begun travels again; what is done is kept."""
    ours = this_program()
    slow = work.tasks_of(work.slow_square, range(8), 0.02)
    performed = perform(tuple(slow), ours, 0.01)
    assert performed.results == (work.square(0),)
    assert len(performed.seconds) == 1
    wrong = work.tasks_of(work.wrong, [3])
    performed = perform((*slow[:2], *wrong, *slow[2:]), ours, 60.0)
    assert performed.results == (work.square(0), work.square(1))
    with pytest.raises(ZeroDivisionError, match="task 3"):
        perform((*wrong, *slow), ours, 60.0)


def test_cheap_tasks_travel_together_and_costly_ones_alone():
    """By the measured time of their sort; one of an unknown sort is alone."""
    cheap = [Task(f"c{n}", "", work.square, (n,), "cheap") for n in range(40)]
    costly = [Task(f"x{n}", "", work.square, (n,), "costly") for n in range(3)]
    batches = Batches([*cheap[:20], *costly, *cheap[20:]])
    assert batches.next() == (cheap[0],)
    assert batches.next() == (cheap[1],)
    for took_s in (0.9, 0.05, 0.05):  # the first of a process loads what the others find
        batches.note(cheap[0], took_s)
    assert batches.next() == tuple(cheap[2:7])
    batches.put_back(cheap[5:7])
    batches.note(costly[0], 0.3)
    sizes = []
    order = [*cheap[:5]]
    while batch := batches.next():
        sizes.append(len(batch))
        order += batch
        assert len({task.sort for task in batch}) == 1
        assert len(batch) <= (MOST if batch[0].sort == "cheap" else 1)
    assert max(sizes) == 5
    assert order == [*cheap[:20], *costly, *cheap[20:]]


@pytest.fixture
def bound(monkeypatch):
    """By task, the workers that each submission of it was bound to; None where Dask chose."""
    import distributed

    submitted: dict[str, list[list[str] | None]] = {}
    submit = distributed.Client.submit

    def spy(client, function, tasks, *words, workers=None, **more):
        for task in tasks:
            submitted.setdefault(task.key, []).append(workers)
        return submit(client, function, tasks, *words, workers=workers, **more)

    monkeypatch.setattr(distributed.Client, "submit", spy)
    return submitted


def test_a_task_that_kills_its_worker_is_lost_alone(bound):
    """Its neighbours, which died with it, are done: whoever is tried again has a worker alone.

    Left to itself, Dask may put the deadly task and a neighbour on one worker again and again.
    """
    tasks = [
        *work.tasks_of(work.square, range(6)),
        *work.tasks_of(work.deadly, [7]),
        *work.tasks_of(work.square, range(8, 20)),
    ]
    got = results(tasks, TWO)
    lost = got.pop("deadly 7")
    assert isinstance(lost, Lost)
    assert 3 <= lost.tries <= 6
    assert lost.fault.count("\n") == 0
    assert got == {f"square {n}": work.square(n) for n in range(20) if n not in (6, 7)}
    for first, *more in bound.values():
        assert first is None
        assert all(workers is not None and len(workers) == 1 for workers in more)
    again = [workers[0] for workers in bound["deadly 7"][1:]]
    assert len(set(again)) == len(again) == lost.tries  # each try has ended a worker


def test_a_result_that_dask_never_hands_over(monkeypatch):
    """The task is done again: Dask forgets a future where a worker dies under its result."""
    import distributed

    track, forgotten = distributed.as_completed._track_future, []

    async def tracked(completed, future):
        if len(forgotten) < 2:
            forgotten.append(future.key)
        else:
            await track(completed, future)

    monkeypatch.setattr(distributed.as_completed, "_track_future", tracked)
    monkeypatch.setattr(cluster, "UNHEARD_S", 0.1)
    got = by_one(work.tasks_of(work.square, range(40)))
    assert len(forgotten) == 2
    assert got == {f"square {n}": work.square(n) for n in range(40)}


@pytest.mark.slow
def test_a_task_that_takes_all_memory_is_lost(monkeypatch):
    monkeypatch.setattr(cluster_processes, "MEMORY_SHARE", 1.0)
    monkeypatch.setattr("distributed.system.MEMORY_LIMIT", 600_000_000)
    # One death alone is enough here; how many it takes is what the deadly task shows.
    monkeypatch.setattr(cluster_evidence.Evidence, "died", lambda *_, **__: True)
    tasks = [*work.tasks_of(work.greedy, [0]), *work.tasks_of(work.square, range(3))]
    got = by_one(tasks)
    assert isinstance(got.pop("greedy 0"), Lost)
    assert got == {f"square {n}": work.square(n) for n in range(3)}


def killed(count, tasks, options, most):
    """Results of a run whose workers are killed at random, and the number of kills.

    most: results between two kills; a time between them would be too short to start a worker in
    where the machine is busy.
    """
    dice = random.Random(20)
    kills, left = 0, dice.randint(1, most)

    def step():
        nonlocal kills, left
        left -= 1
        if kills == count or left > 0:
            return
        time.sleep(dice.uniform(0.0, 0.1))  # so that it happens anywhere in the next task
        alive = workers_of(os.getpid())
        if alive:
            dice.choice(alive).send_signal(signal.SIGKILL)
            kills, left = kills + 1, dice.randint(1, most)

    return results(tasks, options, step), kills


def test_workers_killed_at_random():
    tasks = work.tasks_of(work.slow_square, range(60), 0.05)
    got, kills = killed(3, tasks, TWO, 12)
    assert kills >= 2
    assert got == {f"slow_square {n}": work.square(n) for n in range(60)}


@pytest.mark.slow
def test_workers_killed_fifty_times():
    tasks = work.tasks_of(work.slow_square, range(1500), 0.05)
    got, kills = killed(50, tasks, TWO, 25)
    assert kills == 50
    assert got == {f"slow_square {n}": work.square(n) for n in range(1500)}


DRIVER = """
import sys
from relgloss_view.base.interruptions import SIGNALS, Interrupted
SIGNALS.catch()
import catalogue_tasks as work
from relgloss_view.catalogue.engine import EngineOptions, run
SIGNALS.work()
try:
    run(
        work.tasks_of(work.slow_square, range(1000), 0.1),
        lambda task, result: print(task.key, flush=True),
        EngineOptions(workers=2),
    )
except Interrupted as error:
    sys.exit(error.exit_status)
"""


@pytest.mark.parametrize(
    "number", [signal.SIGKILL, signal.SIGINT, pytest.param(signal.SIGTERM, marks=pytest.mark.slow)]
)
def test_no_worker_outlives_the_driver(number, tmp_path):
    """Killed, it leaves no process; interrupted, it ends early with the signal's status."""
    driver = subprocess.Popen(
        [sys.executable, "-c", DRIVER],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "TMPDIR": str(tmp_path)},
    )
    try:
        assert driver.stdout is not None
        assert driver.stdout.readline()
        assert wait_until(lambda: len(workers_of(driver.pid)) == 2)
        workers = workers_of(driver.pid)
        driver.send_signal(number)
        printed, err = driver.communicate(timeout=ENDED_S)
    finally:
        driver.kill()
        driver.wait()
    assert wait_until(lambda: not any(worker.is_running() for worker in workers))
    if number == signal.SIGKILL:
        assert driver.returncode == -signal.SIGKILL
    else:
        assert driver.returncode == 128 + number
        assert len(printed.split("\n")) < 500  # of 1000: it has not worked on
        assert err == ""
        assert list(tmp_path.iterdir()) == []


def test_a_bug_keeps_its_name():
    with pytest.raises(ZeroDivisionError, match="task 3"):
        by_one(work.tasks_of(work.wrong, [3]))
    assert not workers_of(os.getpid())


def test_a_worker_that_cannot_read_is_named(tmp_path):
    missing = tmp_path / "no such table.csv"
    with pytest.raises(InputError) as caught:
        by_one([Task("a", "no such table.csv", work.text_of, (str(missing),))])
    line = str(caught.value)
    assert line.startswith("worker ")
    assert str(missing) in line
    assert "\n" not in line


def test_a_worker_that_cannot_draw_ends_the_run():
    tasks = work.tasks_of(work.no_context, [0])
    with pytest.raises(GLUnavailableError, match="no OpenGL"):
        results(tasks, EngineOptions(workers=1))
    with pytest.raises(GLUnavailableError, match=r"worker .*no OpenGL"):
        by_one(tasks)


@pytest.fixture
def two_threads(monkeypatch):
    """Linear algebra as a user's process loads it, here and in what it starts."""
    monkeypatch.setenv("OPENBLAS_NUM_THREADS", "2")
    before = thread_counts()
    for _, write in one_thread._libraries():
        write(2)
    yield
    for (_, write), count in zip(one_thread._libraries(), before, strict=True):
        write(count)


def test_linear_algebra_has_one_thread_in_every_engine(two_threads):
    """Here as well, though it was loaded with several; as before after."""
    loaded = thread_counts()
    assert set(loaded) == {2}, "the wheels of numpy and scipy bring OpenBLAS"
    tasks = work.tasks_of(work.blas_threads, range(4))
    loop, processes = results(tasks, EngineOptions(workers=1)), by_one(tasks)
    assert loop == processes
    assert {tuple(counts) for counts, _ in loop.values()} == {(1,) * len(loaded)}
    assert thread_counts() == loaded


def test_another_program_is_refused():
    ours = this_program()
    task = Task("a", "a.csv", work.square, (2,))
    assert perform((task,), ours, 1.0).results == (work.square(2),)
    for changed, word in (
        ({"version": "0.0.9"}, "relgloss"),
        ({"digest": "0" * 64}, "assets"),
        ({"scipy": "1.0"}, "scipy"),
    ):
        (refused,) = perform((task,), dataclasses.replace(ours, **changed), 1.0).results
        assert isinstance(refused, Refused)
        assert refused.fault.startswith("worker ")
        assert word in refused.fault


def test_another_program_ends_the_run(monkeypatch):
    monkeypatch.setattr(cluster, "this_program", lambda: Program("0.0.9", "0", "3.11", "2", "1"))
    with pytest.raises(InputError, match=r"worker \d+ .*another program: relgloss .* in place of"):
        by_one(work.tasks_of(work.square, range(3)))


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (EngineOptions(workers=0), "expected 1 to"),
        (EngineOptions(scheduler="localhost:8786"), "expected tcp://HOST:PORT"),
        (EngineOptions(scheduler="tcp://127.0.0.1:9", patience_s=0.5), "no answer within 0.5 s"),
    ],
)
def test_options_that_lead_nowhere(options, words):
    with pytest.raises(InputError, match=words):
        results(work.tasks_of(work.square, range(3)), options)


def test_without_bokeh_a_dashboard_is_refused_with_the_command_that_installs_it(monkeypatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    words = rf"needs bokeh; install it with: {sys.executable} -m pip install '.*\[dashboard\]'"
    with pytest.raises(InputError, match=words) as caught:
        results(work.tasks_of(work.square, range(3)), EngineOptions(workers=1, dashboard=True))
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert f"'{project['name']}[dashboard]'" in str(caught.value)
    assert any(text.startswith("bokeh") for text in project["optional-dependencies"]["dashboard"])


@pytest.mark.slow
def test_the_dashboard_is_served_on_loopback_alone():
    """Its page and its own data; the address that is printed is the one that answers."""
    pytest.importorskip("bokeh")
    printed, answers = [], []

    def step():
        if not answers:
            address = printed[0].split()[-1]
            assert address.startswith("http://127.0.0.1:")
            with urllib.request.urlopen(address, timeout=30) as page:
                answers.append(page.read())

    options = EngineOptions(workers=2, dashboard=True, report=printed.append)
    got = results(work.tasks_of(work.slow_square, range(20), 0.1), options, step)
    assert got == {f"slow_square {n}": work.square(n) for n in range(20)}
    assert b"Bokeh" in answers[0] or b"bokeh" in answers[0]


MEMORY = """
import catalogue_tasks as work
from relgloss_view.catalogue.engine import EngineOptions, run
sizes = []
tasks = (task for n in range(10_000) for task in work.tasks_of(work.heavy, [n], 20_000))
run(tasks, lambda task, result: sizes.append(len(result[1])), EngineOptions(workers=2))
assert sizes == [20_000] * 10_000
print(open("/proc/self/status").read().split("VmHWM:")[1].split()[0])
"""


@pytest.mark.slow
def test_memory_of_ten_thousand_items():
    """At most 500 MB in the driver, which never holds more than what is in flight."""
    words = [sys.executable, "-c", MEMORY]
    printed = subprocess.run(words, capture_output=True, text=True, check=True)
    assert int(printed.stdout) < 500_000  # kB
