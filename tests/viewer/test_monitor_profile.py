"""The monitor's own profile in a real window: taken, named, drawn for, and let go of.

An X server without a monitor has the properties that a desktop sets; Argyll's dispwin sets them
(xprop sets 64 bytes at most), and Argyll's xicclu gives the digital values that a profile asks for.
Run as a program with a folder, this file is the window, which writes what it shows.
"""

from __future__ import annotations

import contextlib
import json
import os
import shutil
import struct
import subprocess
import sys
import time
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from x_server import LONGEST_S, environment, needs_server, running

from relgloss_view.display.system.x_connection import Connection

ARGYLL = Path("/usr/share/color/argyll/ref")
ATOM = "_ICC_PROFILE"
WINDOW = (640, 480)
CHANGE_PROPERTY, CARDINAL = 18, 6  #: of the X protocol

pytestmark = needs_server


def needs(*programs, file):
    missing = [name for name in programs if shutil.which(name) is None]
    missing += [] if file.exists() else [str(file)]
    return pytest.mark.skipif(bool(missing), reason=f"without {', '.join(missing)}")


# --- the window, in a process of its own ----------------------------------------------------------


def main(folder):
    from relgloss_view.display.display import Display
    from relgloss_view.viewer.shell.app import App
    from relgloss_view.viewer.shell.window import Window
    from relgloss_view.viewer.state.screens import screen_words
    from relgloss_view.viewer.state.state import State

    class Reporting(App):
        """Writes what it shows after each frame in which that is something else."""

        last: object = None

        def after_frame(self, frame_s):
            model = self.model
            again = super().after_frame(frame_s)
            now = {
                "line": screen_words(model.state, model.screen)[0],
                "file": model.screen.file,
                "redrawn": sorted({name for _, name in model.redrawn}),
                "notes": [note.text for note in model.notes],
            }
            if now != self.last:
                self.last = now
                model.take_view = partial(self.write, now)
                self.wake()
            if (folder / "stop").exists():
                self.quit()
            return again

        def write(self, now, pixels):
            """pixels: (H, W, 3) of the pane."""
            left, top, width, height = self.drawn_pane.arrangement.rects["test"]
            x, y = left + width // 2, top + height // 2
            picture = pixels[y : y + 8, x : x + 8].reshape(-1, 3)
            both = {"gray": pixels[-2, 2].tolist(), "picture": picture.tolist()}
            _write(folder / "shows.json", {**now, **both})

    state = State.initial()
    # No dither and no grain: a pixel is what the profile asks for, to the last of 8 bits.
    state = state.with_part("display", **vars(Display(background_lstar=70.0)))
    Window(Reporting(state), WINDOW).run()


def _write(file, content):
    staged = file.with_suffix(".new")
    staged.write_text(json.dumps(content), encoding="utf-8")
    os.replace(staged, file)


# --- the tests ------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def display():
    with running() as name:
        yield name


@contextlib.contextmanager
def window(folder, display):
    """A function that gives what the window shows, once something holds for it."""
    with (folder / "said").open("w") as said:
        process = subprocess.Popen(
            [sys.executable, __file__, str(folder)],
            env=environment(folder, display),
            stdout=said,
            stderr=said,
        )

    def shows(holds):
        end = time.monotonic() + LONGEST_S
        while time.monotonic() < end:
            assert process.poll() is None, (folder / "said").read_text()[-3000:]
            with contextlib.suppress(FileNotFoundError):
                found = json.loads((folder / "shows.json").read_text(encoding="utf-8"))
                if holds(found):
                    return found
            time.sleep(0.01)
        raise AssertionError(f"it does not come: {found}")

    try:
        yield shows
        (folder / "stop").touch()
        subprocess.run(["xdotool", "mousemove", "5", "5"], env=on(display), check=False)
        assert process.wait(LONGEST_S) == 0, (folder / "said").read_text()[-3000:]
    finally:
        process.kill()
        process.wait()


def on(display):
    return {**os.environ, "DISPLAY": display}


def xprop(display, *words):
    subprocess.run(["xprop", "-root", *words], env=on(display), check=True, timeout=LONGEST_S)


def put(display, data, atom=ATOM):
    """Set a property to bytes, as the specification has it: CARDINAL, 8 bits."""
    connection = Connection(display)
    head = struct.pack("=3IB3xI", connection.root, connection.atom(atom), CARDINAL, 8, len(data))
    connection.send(CHANGE_PROPERTY, 0, head + data + bytes(-len(data) % 4))
    assert connection.property_of_root(connection.atom(atom), 1 << 20) == (data, 8, 0)
    connection.close()


def asked(profile, lstar):
    """The digital values (3,) of 255 that a profile has for a neutral, by Argyll's xicclu.

    Of the screen's own white, relative colorimetric: its neutral has D50's chromaticity in the
    profile's connection space.
    """
    done = subprocess.run(
        ["xicclu", "-fb", "-ir", "-pl", "-s255", str(profile)],
        input=f"{lstar} 0 0\n",
        capture_output=True,
        text=True,
        check=True,
        timeout=LONGEST_S,
    )
    words = next(line for line in done.stdout.splitlines() if "->" in line)
    return np.array([float(w) for w in words.split("->")[-1].split("[")[0].split()[:3]])


@needs("xprop", "xicclu", file=ARGYLL / "ProPhoto.icm")
def test_a_profile_is_taken_changed_damaged_and_removed(tmp_path, display):
    """The gray of the surround is what xicclu asks for, within one of 255 (rounding, and 16 bits of
    its tables). sRGB's own gray is the control: both profiles are away from it.
    """
    with window(tmp_path, display) as shows:
        first = shows(lambda found: "sRGB assumed: the system names no profile" in found["line"])
        srgb = np.array(first["gray"])
        assert np.abs(srgb - 255.0 * 0.670).max() < 2.0  # L* 70 of IEC 61966-2-1
        grays, pictures = [], [first["picture"]]
        for name in ("ProPhoto", "ProPhotoLin"):
            data = (ARGYLL / f"{name}.icm").read_bytes()
            put(display, data)
            found = shows(lambda found: found["file"] and found["gray"] not in (*grays, [*srgb]))
            assert "assumed" not in found["line"]
            assert np.abs(np.array(found["gray"]) - asked(ARGYLL / f"{name}.icm", 70.0)).max() <= 1
            assert np.abs(np.array(found["gray"]) - srgb).max() > 5  # the control
            assert Path(found["file"]).read_bytes() == data
            assert found["picture"] not in pictures  # redrawn, too
            assert "tone" in found["redrawn"]
            assert "shade" not in found["redrawn"]
            assert any("drawn for this monitor" in note for note in found["notes"])
            grays.append(found["gray"])
            pictures.append(found["picture"])
        put(display, b"no profile at all")
        found = shows(lambda found: found["gray"] == [*srgb])
        assert "not an ICC profile" in found["line"]
        assert found["picture"] == first["picture"]
        assert sum("not an ICC profile" in note for note in found["notes"]) == 1
        put(display, (ARGYLL / "ProPhotoLin.icm").read_bytes())
        shows(lambda found: found["gray"] == grays[1])
        xprop(display, "-remove", ATOM)
        found = shows(lambda found: found["gray"] == [*srgb])
        assert "the system names no profile" in found["line"]
        assert found["picture"] == first["picture"]


@pytest.mark.slow
@needs("dispwin", "xprop", file=ARGYLL / "DisplayP3.icm")
def test_argylls_dispwin_is_followed(tmp_path, display):
    """It sets the root window's property and the output's; what is taken away stays away."""
    home = tmp_path / "home"
    home.mkdir()
    with window(tmp_path, display) as shows:
        shows(lambda found: "assumed" in found["line"])
        subprocess.run(
            ["dispwin", "-I", str(ARGYLL / "DisplayP3.icm")],
            env=on(display) | {"HOME": str(home)},
            capture_output=True,
            check=True,
            timeout=LONGEST_S,
        )
        shows(lambda found: "P3" in found["line"])
        xprop(display, "-remove", ATOM)
        shows(lambda found: "the system names no profile" in found["line"])


if __name__ == "__main__":
    main(Path(sys.argv[1]))
