"""Whether a task has ended its workers: judged by chance, on a clock of the test's own."""

from __future__ import annotations

import heapq
import itertools
import math
import random
from collections import Counter, deque

import pytest

from relgloss_view.catalogue import cluster_evidence
from relgloss_view.catalogue.cluster_evidence import LEAST_TRIES, MOST_TRIES, Evidence


class Clock:
    """Seconds that the test counts."""

    def __init__(self):
        self.now_s = 0.0

    def __call__(self):
        return self.now_s


def tries_until_blamed(dice, rate, deadly, took_s=0.5, workers=2, restart_s=1.0, before_s=60.0):
    """Tries of one task until it is at fault, or 0 where it was done before.

    rate: deaths of other causes in a second of a worker.
    """
    clock = Clock()
    evidence = Evidence(clock)
    evidence.begin("first")
    others = dice.expovariate(rate * workers) if rate else float("inf")

    def pass_by(seconds):
        nonlocal others
        clock.now_s += seconds
        while others < clock.now_s:
            evidence.deaths += 1
            others += dice.expovariate(rate * (workers - 1))

    pass_by(before_s)
    tries = 0
    while True:
        evidence.begin("task")
        dies_s = dice.expovariate(rate) if rate else float("inf")
        if not deadly and dies_s > took_s:
            return 0
        tries += 1
        lasted_s = min(dies_s, took_s)
        pass_by(lasted_s)
        evidence.deaths += 1
        if evidence.died("task", lasted_s, workers):
            return tries
        pass_by(restart_s)


def test_a_deadly_task_needs_few_tries():
    assert tries_until_blamed(random.Random(1), 0.0, deadly=True) == LEAST_TRIES
    for seed in range(50):
        assert tries_until_blamed(random.Random(seed), 0.02, deadly=True) <= 12


@pytest.mark.parametrize("rate", [0.01, 0.2, 0.5, 1.0])
def test_an_innocent_task_is_never_blamed(rate):
    """At most one of 2,000, where each try dies with up to 1 - exp(-0.5) = 39 %.

    Three deaths in a row alone, the rule without a rate, have a chance of 6 % there.
    """
    assert blamed_of_2000(rate) <= 1


def test_deaths_alone_are_no_evidence(monkeypatch):
    """The control: the rule without chance blames the innocent."""
    monkeypatch.setattr(cluster_evidence, "LEAST_CHANCE", 2.0)
    assert blamed_of_2000(1.0) > 50


def blamed_of_2000(rate):
    """Innocent tasks that are found at fault, of 2,000."""
    dice = random.Random(7)
    return sum(bool(tries_until_blamed(dice, rate, deadly=False)) for _ in range(2000))


class Alone:
    """Tasks that were set aside, each alone on one of two workers, while someone kills at random.

    Its clock jumps from event to event. A worker that has died is missing for 0.2 s, and its
    successor takes a second to start; both are killed at any time, whatever they do.
    """

    TASK_S, DEADLY_S, LATE_S, MISSING_S, START_S, BEFORE_S = 0.5, 0.05, 0.1, 0.2, 1.0, 10.0

    def __init__(self, dice, rate, deadly, innocent, *, late):
        """rate: kills in a second of each worker. late: whether the first one is after BEFORE_S."""
        self.dice, self.rate = dice, rate
        self.clock = Clock()
        self.evidence = Evidence(self.clock)
        self.evidence.begin("first")
        self.evidence.forget("first")
        self.clock.now_s = self.BEFORE_S
        if not late:
            self.evidence.deaths += sum(self._kill_s() < 0.01 for _ in range(2000))
        self.aside = deque([*(f"deadly {n}" for n in range(deadly)), *map(str, range(innocent))])
        dice.shuffle(self.aside)
        self.left, self.lost, self.tries = deadly + innocent, set(), Counter()
        self._number = itertools.count()
        self._events = []
        self._killed_s = {}
        self._idle = set()

    def run(self):
        """Try the tasks until each is done or lost."""
        for worker in range(2):
            self._at(self.BEFORE_S, self._start, worker, 0.0)
        while self.left:
            self.clock.now_s, _, step, *words = heapq.heappop(self._events)
            step(*words)
        return self

    def _kill_s(self):
        return self.dice.expovariate(self.rate) if self.rate else math.inf

    def _at(self, time_s, step, *words):
        heapq.heappush(self._events, (time_s, next(self._number), step, *words))

    def _start(self, worker, takes_s):
        """A process of a worker begins its life."""
        killed_s = self._killed_s[worker] = self.clock() + self._kill_s()
        ready_s = self.clock() + takes_s
        if killed_s < ready_s:
            self._at(killed_s, self._die, worker, None, 0.0)
        else:
            self._at(ready_s, self._work, worker, killed_s)

    def _work(self, worker, killed_s):
        """Begin a task; without one, wait to be killed."""
        if self._killed_s[worker] != killed_s:
            return
        if not self.aside:
            self._idle.add(worker)
            if killed_s < math.inf:
                self._at(killed_s, self._die, worker, None, 0.0)
            return
        self._idle.discard(worker)
        task = self.aside.popleft()
        self.evidence.begin(task)
        begun_s = self.clock()
        end_s = begun_s + (self.DEADLY_S if task.startswith("deadly") else self.TASK_S)
        if killed_s < end_s or task.startswith("deadly"):
            self._at(min(end_s, killed_s), self._die, worker, task, begun_s)
        else:
            self._at(end_s, self._finish, worker, task, killed_s)

    def _finish(self, worker, task, killed_s):
        self.evidence.forget(task)
        self.left -= 1
        self._work(worker, killed_s)

    def _die(self, worker, task, begun_s):
        if task is None and worker in self._idle and self._killed_s[worker] != self.clock():
            return
        self._idle.discard(worker)
        self.evidence.deaths += 1
        self._at(self.clock() + self.MISSING_S, self._start, worker, self.START_S)
        if task is None:
            return
        self.tries[task] += 1
        noticed_s = self.clock() - begun_s + self.dice.uniform(0.0, self.LATE_S)
        if self.evidence.died(task, noticed_s, 2):
            self.evidence.forget(task)
            self.lost.add(task)
            self.left -= 1
            return
        self.aside.append(task)
        for other in list(self._idle):
            self._at(self.clock(), self._work, other, self._killed_s[other])


def innocents_lost(runs, rate, deadly, innocent, *, late):
    """Of all runs; each deadly task has to be lost in each."""
    dice = random.Random(11)
    lost = 0
    for _ in range(runs):
        alone = Alone(dice, rate, deadly, innocent, late=late).run()
        guilty = {task for task in alone.lost if task.startswith("deadly")}
        assert len(guilty) == deadly
        lost += len(alone.lost - guilty)
    return lost


def test_several_deadly_tasks_need_few_tries():
    """Their deaths are no measure of chance for each other."""
    alone = Alone(random.Random(1), 0.0, deadly=3, innocent=6, late=False).run()
    assert len(alone.lost) == 3
    assert max(alone.tries.values()) <= 7


@pytest.mark.parametrize("late", [False, True])
@pytest.mark.parametrize("rate", [0.0, 0.05, pytest.param(0.3, marks=pytest.mark.slow), 1.0])
def test_an_innocent_task_among_deadly_ones_is_never_blamed(rate, late):
    """None of 90; deadly tasks do not hide kills, nor kills that begin while all are alone."""
    assert innocents_lost(15, rate, deadly=3, innocent=6, late=late) == 0


@pytest.mark.slow
@pytest.mark.parametrize("late", [False, True])
@pytest.mark.parametrize("rate", [0.05, 0.2, 0.5, 1.0])
@pytest.mark.parametrize(("deadly", "innocent"), [(0, 6), (1, 5), (3, 6), (6, 2)])
def test_innocents_among_deadly_ones_long(rate, late, deadly, innocent):
    """At most one of 2,000, or of 660 where few are innocent, whose runs take longest."""
    runs = min(2000 // innocent, 330)
    assert innocents_lost(runs, rate, deadly, innocent, late=late) <= 1


def test_deaths_of_all_suspects_left_out_blame_the_innocent(monkeypatch):
    """The control: suspects of whom nobody asks whether chance explains them all."""
    monkeypatch.setattr(Evidence, "_more_than_chance", lambda *_: True)
    monkeypatch.setattr(Evidence, "_others", lambda *_: (0, 1e3))
    assert innocents_lost(30, 1.0, deadly=0, innocent=6, late=True) > 5


def test_tries_have_an_end():
    dice = random.Random(3)
    assert LEAST_TRIES < tries_until_blamed(dice, 5.0, deadly=True) <= MOST_TRIES
