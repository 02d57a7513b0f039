"""Whether a task has ended its workers: judged by chance, on a clock of the test's own."""

from __future__ import annotations

import random

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


def test_tries_have_an_end():
    dice = random.Random(3)
    assert LEAST_TRIES < tries_until_blamed(dice, 5.0, deadly=True) <= MOST_TRIES
