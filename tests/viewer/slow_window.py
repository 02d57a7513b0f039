"""A window whose frames take long, in a program of its own, and the hand that waits for it."""

from __future__ import annotations

import contextlib
import subprocess
import sys
import time

from x_server import LONGEST_S, environment, running


@contextlib.contextmanager
def slow_window(program, guarded, folder):
    """Run a test file as a program. Yields the display and what it has printed, as a function."""
    printed = folder / "printed"
    with running() as display, printed.open("w") as file:
        process = subprocess.Popen(
            [sys.executable, program, str(int(guarded))],
            env=environment(folder, display),
            stdout=file,
        )
        try:
            yield display, printed.read_text
            process.terminate()
            assert process.wait(LONGEST_S) == 0
        finally:
            process.kill()
            process.wait(LONGEST_S)


def draw(frame_s, say):
    """Be that program: each frame takes so long, then says what it sees."""
    from relgloss_view.viewer.shell import window

    class Slow:
        def start(self, ctx, window):
            pass

        def frame(self):
            time.sleep(frame_s)
            say()

        def after_frame(self, frame_s):
            return True  # draw on: events come while a frame is being made

        def wait_s(self):
            return None

        def dropped(self, paths):
            pass

        def finish(self):
            pass

    window.Window(Slow(), (200, 100)).run()
