from __future__ import annotations

import itertools
import random

from relgloss_view.bench.speed.pareto import pareto_front


def test_a_made_up_front():
    points = [(1.0, 5.0), (2.0, 2.0), (3.0, 3.0), (4.0, 1.0), (2.0, 4.0)]
    assert pareto_front(points) == [0, 1, 3]


def test_equal_points_stand_together_and_a_tie_in_one_loses():
    assert pareto_front([(1.0, 1.0), (1.0, 1.0)]) == [0, 1]
    # As fast but farther off, or as near but slower: beaten.
    assert pareto_front([(1.0, 1.0), (1.0, 2.0), (2.0, 1.0)]) == [0]
    assert pareto_front([]) == []


def test_what_is_left_out_is_beaten_and_what_is_kept_is_not():
    chance = random.Random(4)
    points = [(chance.random(), chance.random()) for _ in range(200)]
    front = pareto_front(points)
    assert 3 < len(front) < 30

    def beats(a, b):
        return a[0] <= b[0] and a[1] <= b[1] and a != b

    for k, point in enumerate(points):
        assert any(beats(points[j], point) for j in front) == (k not in front)
    across = [points[k] for k in front]
    assert all(a[0] < b[0] and a[1] > b[1] for a, b in itertools.pairwise(across))


def test_negative_control_the_fastest_and_the_slowest_alone_are_no_front():
    # Sorting by time alone would keep all of these.
    assert pareto_front([(1.0, 1.0), (2.0, 2.0), (3.0, 3.0)]) == [0]
