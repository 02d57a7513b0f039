"""A real window on an X server without a monitor: it shows what the null platform draws, rests when
nothing happens, comes back after a kill and keeps all when it is asked to end.

Run as a program with a folder, this file draws the window of both_platforms.
"""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
from x_server import (
    LONGEST_S,
    TICKS_S,
    TITLE,
    environment,
    hand,
    needs_server,
    rest,
    running,
    ticks,
    until,
)

from relgloss_view.base import interruptions
from relgloss_view.viewer.state.session import restore

WINDOW = "1280x800"
FRAMES = 8
STEP_PX = 40

pytestmark = needs_server


@pytest.fixture(scope="module")
def display():
    """The name of a display whose server runs as long as these tests."""
    with running() as name:
        yield name


# --- both platforms draw the same -----------------------------------------------------------------


def drawn(folder, display, *, sigma_n_deg=2.0):
    """The window after some frames, (H, W, 3), and the rectangles of the pictures in it."""
    out = folder / "window.npz"
    done = subprocess.run(
        [sys.executable, __file__, str(out), str(sigma_n_deg), str(int(display is None))],
        env=environment(folder, display),
        capture_output=True,
        text=True,
        timeout=LONGEST_S,
    )
    assert done.returncode == 0, done.stderr[-3000:]
    with np.load(out) as held:
        return held["pixels"].astype(int), held["rects"]


def main(out, sigma_n_deg, headless):
    from relgloss_view.viewer.shell.app import App
    from relgloss_view.viewer.shell.window import Window
    from relgloss_view.viewer.state.state import State

    class Timeless(App):
        """The status line tells the time of a frame, which no two windows share."""

        def after_frame(self, frame_s):
            again = super().after_frame(frame_s)
            self.model.frame_s = 0.01
            return again

    app = Timeless(State.initial().with_look("test", sigma_n_deg=sigma_n_deg))
    pixels = Window(app, (800, 600), headless=headless).run(FRAMES)
    left, top = (int(v) for v in app.stage_origin)
    rects = [(left + x, top + y, w, h) for x, y, w, h in app.drawn_pane.arrangement.rects.values()]
    np.savez(out, pixels=pixels, rects=rects)


def difference(one, other):
    """Largest difference of a channel at each pixel."""
    assert one.shape == other.shape
    return np.abs(one - other).max(axis=-1)


def pictures(pixels, rects):
    """The middle of each picture, which no caption stands over."""
    return [
        pixels[y + h // 4 : y + 3 * h // 4, x : x + w][..., :3] for x, y, w, h in rects.tolist()
    ]


def test_shows_what_the_null_platform_draws(tmp_path, display):
    """The pictures are equal. So is the interface, but for the rounding of smooth edges.

    What blends is rounded to 8 bits after each layer, and two kinds of surface may round a half
    either way: by one level where one smooth edge lies over a field, two where it lies over
    another. Seen were 8 pixels of 480,000 with one level; ten times as many are allowed.
    """
    hand(display, "mousemove", "1399", "899")  # off the window, so that nothing is lit up
    (real, rects), (null, null_rects) = drawn(tmp_path, display), drawn(tmp_path, None)
    assert real.shape == (600, 800, 3)
    np.testing.assert_array_equal(rects, null_rects)
    for one, other in zip(pictures(real, rects), pictures(null, rects), strict=True):
        np.testing.assert_array_equal(one, other)
        assert len(np.unique(one.reshape(-1, 3), axis=0)) > 50  # a picture, no empty pane
    off = difference(real, null)
    assert off.max() <= 2
    assert np.count_nonzero(off) <= 80
    # The control: a slider by a fiftieth of its width changes the picture and its panel.
    moved, _ = drawn(tmp_path, display, sigma_n_deg=2.06)
    other = difference(moved, null)
    assert other.max() > 10
    assert np.mean(other > 0) > 1e-2
    np.testing.assert_array_equal(pictures(moved, rects)[0], pictures(null, rects)[0])
    assert np.mean(difference(pictures(moved, rects)[1], pictures(null, rects)[1]) > 0) > 0.05


# --- what a real window's own framebuffer is read by ----------------------------------------------


@pytest.mark.parametrize("copied", [True, False])
def test_an_exported_view_is_confirmed_and_nothing_is_lost(tmp_path, display, copied):
    """The control reads the window's framebuffer itself, which looks like a loss of objects."""
    file = tmp_path / "view.png"
    done = subprocess.run(
        [sys.executable, __file__, str(file), "export", str(int(copied))],
        env=environment(tmp_path, display),
        capture_output=True,
        text=True,
        timeout=LONGEST_S,
    )
    assert done.returncode == 0, done.stderr[-3000:]
    width, height, *notes = done.stdout.splitlines()
    from PIL import Image

    with Image.open(file) as picture:
        assert picture.size == (int(width), int(height))
    assert notes[0] == f"exported view.png, {width} x {height} px, to {tmp_path}"
    assert len(notes) == (1 if copied else 2)
    assert copied or "lost its objects" in notes[1]


def export_view(out, copied):
    from pathlib import Path

    from relgloss_view.viewer.shell import window
    from relgloss_view.viewer.shell.app import App
    from relgloss_view.viewer.state.state import State

    class Exporting(App):
        def frame(self):
            super().frame()
            self.drawn += 1
            if self.drawn == 3:
                self.files._write_view(out)

        drawn = 0

    def read(ctx, blitter, source, box):
        size = (box[2] - box[0], box[3] - box[1])
        data = ctx.screen.read(viewport=(*box[:2], *size), components=3, alignment=1)
        return np.frombuffer(data, dtype=np.uint8).reshape(size[1], size[0], 3)[::-1]

    if not copied:
        window.copied_pixels = read
    app = Exporting(State.initial())
    window.Window(app, (800, 600)).run(FRAMES)
    rects = app.drawn_pane.arrangement.rects.values()
    print(max(x + w for x, _, w, _ in rects), max(y + h for _, y, _, h in rects), sep="\n")
    assert Path(out).exists()
    for note in app.model.notes:
        print(note.text)


# --- the program, from outside --------------------------------------------------------------------

#: The command, and the same without an autosave in reach: what is kept is kept at the end.
COMMAND = ("-m", "relgloss_view.cli")
LATE = (
    "-c",
    "import sys\nsys.argv[0] = 'relgloss'\n"
    "from relgloss_view.viewer.state import session\nsession.WAIT_S = 1e6\n"
    "from relgloss_view.cli import main\nsys.exit(main())",
)


@contextlib.contextmanager
def opened(folder, display, *, how=COMMAND):
    """The running command once its window has come to rest; killed in the end, if need be."""
    place = folder / "work"
    place.mkdir(exist_ok=True)
    words = [sys.executable, *how, "view", "--window", WINDOW]
    with (folder / "said").open("w") as said:
        process = subprocess.Popen(
            words, cwd=place, env=environment(folder, display), stdout=said, stderr=said
        )
    try:
        hand(display, "search", "--sync", "--onlyvisible", "--name", TITLE)
        rest(process)
        yield process
    finally:
        if process.poll() is None:
            process.kill()
        process.wait(LONGEST_S)
    assert os.listdir(place) == []


def drag(display):
    """Turn the object by STEP_PX: press in the middle of the left picture, move, let go."""
    hand(
        display, "search", "--name", TITLE, "mousemove", "--window", "%1", "140", "200",
        "sleep", "0.1", "mousedown", "1", "sleep", "0.1",
        "mousemove_relative", str(STEP_PX // 2), "0", "sleep", "0.1",
        "mousemove_relative", str(STEP_PX // 2), "0", "sleep", "0.1", "mouseup", "1",
    )  # fmt: skip


def session(folder):
    return folder / "kept" / "state" / "session.toml"


def azimuth(folder):
    """Where the eye of the kept session stands; None where none is kept."""
    state = restore(session(folder)).state
    return None if state is None else state.setup.eye.azimuth_deg


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="reads /proc")
class TestProgram:
    def test_change_comes_back_after_a_kill(self, tmp_path, display):
        with opened(tmp_path, display) as process:
            drag(display)
            until(lambda: azimuth(tmp_path) not in (None, 0.0))
            rest(process)
            process.send_signal(signal.SIGKILL)
            assert process.wait(LONGEST_S) == -signal.SIGKILL
        first = azimuth(tmp_path)
        assert first < -5.0  # by the hand, to the right
        with opened(tmp_path, display):
            drag(display)
            until(lambda: azimuth(tmp_path) != first)
            until(lambda: azimuth(tmp_path) == pytest.approx(2.0 * first, abs=1e-3))

    @pytest.mark.slow
    def test_rests_and_keeps_all_when_it_is_asked_to_end(self, tmp_path, display):
        with opened(tmp_path, display, how=LATE) as process:
            drag(display)
            rest(process)
            assert not session(tmp_path).exists()
            # The figure to reach is 3 % of a core. A clock tick counts whole for a process that
            # it finds running, and a machine shared with other work runs with cold caches: three
            # times as much is allowed, a tenth of what a window that keeps drawing takes.
            before = ticks(process)
            assert before > 0.1 * 3.0 * TICKS_S  # the control: starting is seen by this measure
            time.sleep(3.0)
            assert ticks(process) - before < 0.1 * 3.0 * TICKS_S
            process.terminate()
            assert process.wait(LONGEST_S) == 128 + signal.SIGTERM
        assert azimuth(tmp_path) < -5.0
        assert (tmp_path / "kept" / "config" / "window.toml").exists()
        assert (tmp_path / "said").read_text() == f"relgloss: {interruptions.WORDS}\n"


if __name__ == "__main__":
    if sys.argv[2] == "export":
        export_view(sys.argv[1], sys.argv[3] == "1")
    else:
        main(sys.argv[1], float(sys.argv[2]), sys.argv[3] == "1")
