"""What the interface is given of the keyboard, frame by frame."""

from __future__ import annotations

import sys
import time

import glfw
import pytest
from slow_window import draw, slow_window
from x_server import hand, needs_server, until

from relgloss_view.viewer.shell.keyboard import Keyboard

CTRL, SHIFT = glfw.KEY_LEFT_CONTROL, glfw.KEY_RIGHT_SHIFT
E, Q = glfw.KEY_E, glfw.KEY_Q
CHORDS = 12
FRAME_S = 0.1  #: longer than xdotool holds a chord, about 25 ms with the time between its events


class Given:
    """A keyboard, and what it gave, a list a frame."""

    def __init__(self):
        self.frames = [[]]
        self.keyboard = Keyboard(
            lambda key, scancode, action, mods: self.frames[-1].append((key, action)),
            lambda codepoint: self.frames[-1].append(chr(codepoint)),
        )

    def happens(self, *events):
        for event in events:
            if isinstance(event, str):
                self.keyboard.character(ord(event))
            else:
                self.keyboard.key(event[0], 0, event[1], 0)
        return self

    def all(self):
        """What the frames get until no more comes."""
        while True:
            self.frames.append([])
            if not self.keyboard.next_frame():
                return self.frames[:-1]


def down(key):
    return key, glfw.PRESS


def up(key):
    return key, glfw.RELEASE


class TestKeyboard:
    def test_a_modifier_stays_down_for_the_frame_of_its_key(self):
        given = Given().happens(down(CTRL), down(E), up(CTRL), up(E)).all()
        assert given == [[down(CTRL), down(E)], [up(CTRL), up(E)]]

    def test_a_modifier_does_not_come_to_a_key_before_it(self):
        given = Given().happens(down(E), down(CTRL), down(Q)).all()
        assert given == [[down(E)], [down(CTRL), down(Q)]]

    def test_a_key_goes_up_in_a_later_frame(self):
        given = Given().happens(down(E), up(E), down(E), up(E)).all()
        assert given == [[down(E)], [up(E)], [down(E)], [up(E)]]

    def test_other_keys_and_modifiers_together_share_a_frame(self):
        events = (down(CTRL), down(SHIFT), down(E), down(Q))
        assert Given().happens(*events).all() == [list(events)]

    def test_characters_keep_their_place(self):
        given = Given().happens(down(CTRL), down(E), up(CTRL), up(E), "y", down(Q), "z").all()
        assert given == [[down(CTRL), down(E)], [up(CTRL), up(E), "y", down(Q), "z"]]

    def test_a_key_that_is_held_is_no_other_press(self):
        events = (down(E), (E, glfw.REPEAT), (E, glfw.REPEAT))
        assert Given().happens(*events).all() == [list(events)]

    def test_nothing_is_lost_or_changes_its_order(self):
        events = [down(CTRL), down(E), up(E), up(CTRL), "a", down(SHIFT), down(Q), "Q", up(SHIFT)]
        given = Given().happens(*events, *events).all()
        assert [event for frame in given for event in frame] == 2 * events
        assert len(given) > 2


# --- in a window ----------------------------------------------------------------------------------


@needs_server
@pytest.mark.parametrize("guarded", [True, pytest.param(False, marks=pytest.mark.slow)])
def test_chords_reach_a_window_whose_frames_are_slow(tmp_path, guarded):
    """The control gives the interface everything at once, and shows what is guarded against."""
    with slow_window(__file__, guarded, tmp_path) as (display, said):

        def has_the_keyboard():
            hand(display, "key", "q")
            time.sleep(3.0 * FRAME_S)
            return said().startswith("q\n")

        until(has_the_keyboard)
        sent = 0

        def lost():
            nonlocal sent
            hand(display, "key", "ctrl+e")
            sent += 1
            until(lambda: said().count("up\n") >= sent)
            return said().count("chord\n") < sent

        if guarded:
            assert not any(lost() for _ in range(CHORDS))
        else:
            until(lost)  # on a busy machine a chord may come slowly enough by itself


def main(guarded):
    from imgui_bundle import imgui

    from relgloss_view.viewer.shell import window

    def say():
        if imgui.is_key_chord_pressed(int(imgui.Key.q)):
            print("q", flush=True)
        if imgui.is_key_chord_pressed(int(imgui.Key.mod_ctrl) | int(imgui.Key.e)):
            print("chord", flush=True)
        if imgui.is_key_released(imgui.Key.e):
            print("up", flush=True)

    if not guarded:
        window.keyboard.listen = lambda handle, address: None
    draw(FRAME_S, say)


if __name__ == "__main__":
    main(sys.argv[1] == "1")
