"""Double clicks, by the times at which a hand has clicked."""

from __future__ import annotations

import sys
import time

import pytest
from slow_window import draw, slow_window
from x_server import hand, needs_server, until

from relgloss_view.viewer.shell.clicks import ALWAYS_S, DOUBLE_CLICK_S, NEVER_S, Clicks

CLICKS = 8
FRAME_S = 0.18  #: a press, a release and a press take three frames, and more than DOUBLE_CLICK_S
QUICK_MS, SLOW_MS = 200, 800


def limits(clicks, *presses):
    """The limit for each press of the left button; a press is (wait, noticed) or (None, noticed).

    wait: when the wait began that it ended; without one a frame looks for events when it begins.
    """
    got = []
    for wait_s, noticed_s in presses:
        if wait_s is not None:
            clicks.wait(wait_s)
        clicks.press(0, noticed_s)
        got.append(clicks.limit_s)
        clicks.looked(noticed_s)
        clicks.take(0)
        assert clicks.limit_s is None
    return got


def test_the_first_press_is_single():
    assert limits(Clicks(), (0.0, 50.0)) == [NEVER_S]


@pytest.mark.parametrize("apart_s", [0.05, DOUBLE_CLICK_S - 0.01, DOUBLE_CLICK_S + 0.01, 5.0])
def test_waited_for_a_press_has_its_own_time(apart_s):
    """The window waited for 0.3 s and more each time, which changes nothing."""
    got = limits(Clicks(), (9.0, 10.0), (10.01, 10.0 + apart_s))
    assert got == [NEVER_S, ALWAYS_S if apart_s < DOUBLE_CLICK_S else NEVER_S]


def test_frames_that_take_long_do_not_part_two_clicks():
    clicks = Clicks()
    clicks.wait(0.0)
    clicks.press(0, 1.0)
    clicks.take(0)
    clicks.looked(1.0)
    clicks.looked(1.15)  # nothing had come yet
    clicks.press(0, 1.40)  # between 1.15 and 1.40: it may have been within the limit
    assert clicks.limit_s == ALWAYS_S


def test_what_surely_came_late_is_single_though_frames_are_slow():
    clicks = Clicks()
    clicks.press(0, 1.0)
    clicks.take(0)
    clicks.looked(1.0 + DOUBLE_CLICK_S)
    clicks.press(0, 1.6)
    assert clicks.limit_s == NEVER_S


def test_an_event_that_was_queued_before_a_wait_has_no_time_of_its_own():
    clicks = Clicks()
    clicks.press(0, 1.0)
    clicks.take(0)
    clicks.looked(1.1)
    clicks.wait(1.35)
    clicks.press(0, 1.351)
    assert clicks.limit_s == ALWAYS_S
    clicks.take(0)
    # The control: the same press, had it come during the wait.
    clicks = Clicks()
    clicks.press(0, 1.0)
    clicks.take(0)
    clicks.looked(1.1)
    clicks.wait(1.2)
    clicks.press(0, 1.351)
    assert clicks.limit_s == NEVER_S


def test_two_presses_of_one_look_keep_their_order_and_buttons_are_apart():
    clicks = Clicks()
    clicks.looked(1.0)
    clicks.press(0, 1.2)
    clicks.press(0, 1.2)
    assert clicks.limit_s == NEVER_S  # for the frame of the first
    clicks.take(0)
    assert clicks.limit_s == ALWAYS_S
    clicks.take(1)  # another button's press changes nothing
    assert clicks.limit_s == ALWAYS_S
    clicks.take(0)
    clicks.press(1, 1.2)
    assert clicks.limit_s == NEVER_S


# --- in a window ----------------------------------------------------------------------------------


@needs_server
@pytest.mark.slow
@pytest.mark.parametrize("guarded", [True, False])
def test_double_clicks_reach_a_window_whose_frames_are_slow(tmp_path, guarded):
    """The control leaves it to the interface, and shows what is guarded against."""
    with slow_window(__file__, guarded, tmp_path) as (display, printed):
        hand(display, "mousemove", "60", "60")

        def count(word):
            return printed().count(f"{word}\n")

        def has_the_mouse():
            hand(display, "click", "1")
            time.sleep(4.0 * FRAME_S)
            return count("up") > 0

        until(has_the_mouse)
        time.sleep(2.0)  # what was clicked until now is over
        before_ups, before = count("up"), count("double")

        def clicked_twice(apart_ms):
            nonlocal before_ups, before
            hand(display, "click", "--repeat", "2", "--delay", str(apart_ms), "1")
            until(lambda: count("up") >= before_ups + 2)
            time.sleep(SLOW_MS / 1000)
            doubles, before_ups, before = count("double") - before, count("up"), count("double")
            return doubles

        quick = [clicked_twice(QUICK_MS) for _ in range(CLICKS)]
        slow = [clicked_twice(SLOW_MS) for _ in range(3)]
        if guarded:
            assert quick == [1] * CLICKS
            assert slow == [0] * 3
        else:
            assert sum(quick) < CLICKS


def main(guarded):
    from imgui_bundle import imgui

    from relgloss_view.viewer.shell import window

    def say():
        if imgui.is_mouse_double_clicked(imgui.MouseButton_.left):
            print("double", flush=True)
        if imgui.is_mouse_released(imgui.MouseButton_.left):
            print("up", flush=True)

    if not guarded:
        window.clicks.listen = lambda handle, address: window.clicks.Mouse()
    draw(FRAME_S, say)


if __name__ == "__main__":
    main(sys.argv[1] == "1")
