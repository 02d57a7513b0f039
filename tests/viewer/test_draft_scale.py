"""DraftScale on simulated machines: it goes down when it must, up when it can, and settles.

A machine's frame takes `fixed + full * scale^2` seconds: its time goes with the pixels.
"""

from __future__ import annotations

import itertools
import math
import random

import pytest

from relgloss_view.viewer.drawing import draft_scale
from relgloss_view.viewer.drawing.draft_scale import BUDGET_S, SCALES, DraftScale

FRAMES = 60


def drag(chooser, full_s, fixed_s=0.0, frames=FRAMES, noise=0.0):
    """The scales of the frames of one drag on a machine; the hand then rests."""
    jitter = random.Random(1)
    scales = []
    for _ in range(frames):
        chooser.drag()
        scales.append(chooser.scale)
        time_s = fixed_s + full_s * chooser.scale**2
        chooser.measured(time_s * (1.0 + noise * jitter.uniform(-1.0, 1.0)))
    chooser.rest()
    return scales


def changes(scales):
    return sum(a != b for a, b in itertools.pairwise(scales))


#: Full frames from a fifth of the budget to a hundred times it, closely spaced.
SPEEDS = [BUDGET_S * 0.2 * 1.07**k for k in range(93)]


class Greedy(DraftScale):
    """The control, without hysteresis: up as soon as the larger scale seems within the budget of
    the *present* frame, down as soon as a frame is over it."""

    def measured(self, frame_s):
        step = SCALES.index(self.scale)
        step += 1 if frame_s > BUDGET_S else -1
        self._step = min(max(step, 0), len(SCALES) - 1)
        self.scale = SCALES[self._step]


@pytest.mark.parametrize("fixed_s", [0.0, 0.003, 0.012])
def test_settles_on_every_machine(fixed_s):
    for full_s in SPEEDS:
        chooser = DraftScale()
        scales = drag(chooser, full_s, fixed_s)
        settled = scales[20:]
        assert changes(settled) == 0, full_s
        assert changes(scales) <= 1 + (fixed_s > 0.0) * 3, full_s  # down once, as far as it takes
        last = settled[-1]
        time_s = fixed_s + full_s * last**2
        assert time_s <= BUDGET_S or last == SCALES[-1], full_s
        # No smaller than it takes: what is next larger is over the budget, or too near to it.
        if last < 1.0:
            larger = SCALES[SCALES.index(last) - 1]
            assert fixed_s + full_s * larger**2 > draft_scale.ROOM * BUDGET_S, full_s


def test_settles_where_frames_are_uneven():
    """Frames uneven by a tenth: never up where that goes down again."""
    for full_s in SPEEDS:
        scales = drag(DraftScale(), full_s, noise=0.1, frames=200)
        assert changes(scales[20:]) <= 1, full_s


def test_without_hysteresis_it_would_not():
    """Where neither the largest nor the smallest scale is the answer."""
    between = [s for s in SPEEDS if BUDGET_S < s < BUDGET_S / SCALES[-1] ** 2]
    assert len(between) > 30
    for full_s in between:
        assert changes(drag(Greedy(), full_s)[20:]) > 10, full_s


def test_starts_full_and_stays_where_there_is_time():
    assert set(drag(DraftScale(), 0.9 * BUDGET_S)) == {1.0}


def test_goes_down_within_two_frames_as_far_as_it_takes():
    scales = drag(DraftScale(), 3.9 * BUDGET_S, frames=4)
    assert scales == [1.0, 1.0, 0.5, 0.5]
    assert SCALES[2] * math.sqrt(3.9) < 1.0 < SCALES[1] * math.sqrt(3.9)


def test_goes_up_step_by_step_when_there_is_room():
    chooser = DraftScale()
    drag(chooser, 20.0 * BUDGET_S)
    scales = drag(chooser, 0.3 * BUDGET_S)
    assert scales[0] == SCALES[-1]  # what the last drag came to
    assert scales[-1] == 1.0
    assert sorted(scales) == scales
    assert set(scales) == set(SCALES)


@pytest.mark.parametrize("at", [0, 1, 2, 5, 17])
@pytest.mark.parametrize("steady", [0.3, 0.95])
def test_one_slow_frame_is_no_reason(at, steady):
    """However slow it is: a page fault, another program, a compiler."""
    chooser, scales = DraftScale(), []
    for k in range(20):
        chooser.drag()
        chooser.measured(100.0 * BUDGET_S if k == at else steady * BUDGET_S)
        scales.append(chooser.scale)
    assert set(scales) == {1.0}


def test_two_slow_frames_are():
    chooser = DraftScale()
    chooser.drag()
    for _ in range(2):
        chooser.measured(1.5 * BUDGET_S)
    assert chooser.scale == SCALES[1]


@pytest.mark.parametrize("full", [0.5, 2.0, 200.0])
def test_full_at_rest(full):
    chooser = DraftScale()
    drag(chooser, full * BUDGET_S)
    assert chooser.scale == 1.0
    chooser.drag()
    assert (chooser.scale == 1.0) == (full < 1.0)
    chooser.rest()
    assert chooser.scale == 1.0


def test_frames_of_another_drag_do_not_count():
    chooser = DraftScale()
    drag(chooser, 1.5 * BUDGET_S, frames=1)
    assert drag(chooser, 1.5 * BUDGET_S, frames=2) == [1.0, 1.0]
    assert chooser._step == 1


def test_time_of_nothing():
    chooser = DraftScale()
    drag(chooser, 200.0 * BUDGET_S)
    assert drag(chooser, 0.0)[-1] == 1.0


def test_scales_halve_the_pixels():
    for larger, smaller in itertools.pairwise(SCALES):
        assert (smaller / larger) ** 2 == pytest.approx(0.5, abs=0.02)
