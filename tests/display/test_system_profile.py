"""The profile of a monitor as systems have it: properties of X servers, colord's answers, waiting.

No window: tests/viewer/test_monitor_profile.py has one.
"""

from __future__ import annotations

import contextlib
import os
import shutil
import struct
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from relgloss_view.display.display import Display
from relgloss_view.display.icc_writing import profile_of
from relgloss_view.display.system import watch
from relgloss_view.display.system.answer import MOST_BYTES, Answer, Place, SystemProfile
from relgloss_view.display.system.colord import Colord, first_text
from relgloss_view.display.system.watch import Watch, answer_once, system_profile
from relgloss_view.display.system.x11 import XScreens
from relgloss_view.display.system.x_connection import Connection

LONGEST_S = 120.0
LEFT, RIGHT = Place(0, 0, 640, 480), Place(640, 0, 640, 480)
SRGB, OTHER = (profile_of(d) for d in (Display(), Display(transfer="gain-offset-gamma")))

needs_x = pytest.mark.skipif(shutil.which("Xvfb") is None, reason="without Xvfb")


# --- X11 ------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def server():
    """A connection to a server."""
    reading, writing = os.pipe()
    words = ["Xvfb", "-displayfd", str(writing), "-nolisten", "tcp", "-noreset"]
    process = subprocess.Popen(words, pass_fds=[writing], stderr=subprocess.DEVNULL)
    os.close(writing)
    before = os.environ.get("DISPLAY")
    try:
        with os.fdopen(reading) as pipe:
            os.environ["DISPLAY"] = f":{pipe.readline().strip()}"
        connection = Connection()
        yield connection
        connection.close()
    finally:
        process.terminate()
        process.wait(LONGEST_S)
        os.environ.pop("DISPLAY")
        if before is not None:
            os.environ["DISPLAY"] = before


@pytest.fixture
def _two_monitors(monkeypatch):
    """Xinerama's answer, side by side: Xvfb lays all its screens upon one another."""
    monkeypatch.setattr(XScreens, "_places", lambda self: [LEFT, RIGHT])


def put(connection, name, data, bits=8):
    count = len(data) * 8 // bits
    head = struct.pack("=3IB3xI", connection.root, connection.atom(name), 6, bits, count)
    connection.send(18, 0, head + data + bytes(-len(data) % 4))
    connection.atom("a round trip")


def remove(connection, name):
    connection.send(19, 0, struct.pack("=II", connection.root, connection.atom(name)))
    connection.reply(43, 0)  # GetInputFocus: when it answers, the property is gone


@needs_x
@pytest.mark.usefixtures("_two_monitors")
def test_each_monitor_has_its_own_property(server):
    assert system_profile(None) is None
    put(server, "_ICC_PROFILE", SRGB)
    put(server, "_ICC_PROFILE_1", OTHER)
    assert system_profile(None).data == SRGB
    assert system_profile(LEFT).data == SRGB
    assert system_profile(RIGHT).data == OTHER
    assert system_profile(Place(400, 0, 640, 480)).data == OTHER  # most of it is on the right
    assert system_profile(RIGHT).source == "the X property _ICC_PROFILE_1"
    remove(server, "_ICC_PROFILE_1")
    assert system_profile(RIGHT) is None  # and not the first monitor's
    remove(server, "_ICC_PROFILE")


@needs_x
@pytest.mark.parametrize(
    ("data", "bits", "words"),
    [
        (b"x", 8, "not an ICC profile"),
        (SRGB[:200], 8, "cut off"),
        (b"", 8, "holds no bytes"),
        (SRGB[: len(SRGB) // 4 * 4], 32, "holds no bytes"),
        (b"\xff" * 4000, 8, "not an ICC profile"),
    ],
)
def test_a_damaged_property_is_one_line(server, data, bits, words):
    put(server, "_ICC_PROFILE", data, bits)
    answer = answer_once(LEFT)
    assert answer.profile is None
    assert answer.fault
    assert words in answer.reason
    assert "\n" not in answer.reason
    remove(server, "_ICC_PROFILE")


@needs_x
@pytest.mark.usefixtures("_two_monitors")
def test_a_watch_sleeps_until_there_is_a_change(server):
    """Another property is the control: it wakes nobody."""
    made, woken = [], threading.Semaphore(0)

    def prepare(answer):
        made.append(answer.profile and answer.profile.data)
        return answer

    monitor = Watch(watch.X11, prepare, woken.release)
    try:
        assert monitor.wait(LONGEST_S)
        put(server, "_ICC_PROFILE_1", OTHER)
        put(server, "_NET_SOMETHING", SRGB)
        put(server, "_ICC_PROFILE", SRGB)
        woken.acquire(timeout=LONGEST_S)
        woken.acquire(timeout=LONGEST_S)
        assert monitor.take().profile.data == SRGB
        assert monitor.take() is None
        monitor.look_at(RIGHT)
        woken.acquire(timeout=LONGEST_S)
        assert monitor.take().profile.data == OTHER
        assert made == [None, SRGB, OTHER]
    finally:
        monitor.close()
        for name in ("_ICC_PROFILE", "_ICC_PROFILE_1"):
            remove(server, name)


def test_without_a_server_or_on_wayland_there_is_a_reason(monkeypatch):
    monkeypatch.setenv("DISPLAY", ":654321")
    assert answer_once(None) == Answer(None, "no X server can be reached")
    assert "Wayland" in answer_once(None, watch.WAYLAND).reason
    assert system_profile(LEFT, "null") is None


@pytest.mark.skipif(sys.platform in ("win32", "darwin"), reason="these are for other systems")
@pytest.mark.parametrize("system", [watch.WINDOWS, watch.MACOS])
def test_calls_of_other_systems_are_not_tried_here(system):
    assert answer_once(None, system).profile is None


# --- waiting --------------------------------------------------------------------------------------


class Scripted:
    """A source whose answers a test gives."""

    def __init__(self):
        self.answers, self.changed, self.closed = {None: Answer()}, threading.Event(), False

    def answer(self, place):
        found = self.answers[place]
        if isinstance(found, Exception):
            raise found
        return found

    def wait(self, longest_s):
        happened = self.changed.wait(longest_s)
        self.changed.clear()
        return happened

    def rouse(self):
        self.changed.set()

    def close(self):
        self.closed = True


def test_a_mistake_in_a_source_ends_nothing(monkeypatch):
    monkeypatch.delenv("RELGLOSS_FAULTS", raising=False)  # which tests set, so that none is hidden
    source, woken = Scripted(), threading.Semaphore(0)
    source.answers |= {LEFT: RuntimeError("a mistake"), RIGHT: Answer(SystemProfile(SRGB, "", ""))}
    monkeypatch.setattr(watch, "source_of", lambda system: source)
    monitor = Watch(watch.X11, lambda answer: answer, woken.release)
    assert monitor.wait(LONGEST_S)
    woken.acquire(timeout=LONGEST_S)
    monitor.look_at(LEFT)
    woken.acquire(timeout=LONGEST_S)
    answer = monitor.take()
    assert answer.fault
    assert "a mistake" in answer.reason
    monitor.look_at(RIGHT)
    woken.acquire(timeout=LONGEST_S)
    assert monitor.take().profile.data == SRGB
    monitor.close()
    assert source.closed


# --- colord ---------------------------------------------------------------------------------------

GDBUS = """#!/bin/sh
case "$*" in
  *FindDeviceByProperty*XRANDR_name*DP-1*) echo "(objectpath '/org/freedesktop/devices/x',)";;
  *Properties.Get*Device*Profiles*) echo "(<[objectpath '/org/freedesktop/profiles/p', '/q']>,)";;
  *Properties.Get*Profile*Filename*) echo "(<'{file}'>,)";;
  *) echo "Error" >&2; exit 1;;
esac
"""
BUSCTL = """#!/bin/sh
case "$*" in
  *FindDeviceByProperty*ss*XRANDR_name*DP-1*) echo 'o "/org/freedesktop/devices/x"';;
  *get-property*Device*Profiles*) echo 'ao 2 "/org/freedesktop/profiles/p" "/q"';;
  *get-property*Profile*Filename*) echo 's "{file}"';;
  *) echo "Error" >&2; exit 1;;
esac
"""


@pytest.mark.parametrize(("name", "text"), [("gdbus", GDBUS), ("busctl", BUSCTL)])
def test_colord_is_asked_by_either_program(tmp_path, monkeypatch, name, text):
    file = tmp_path / "my monitor.icc"
    file.write_bytes(SRGB)
    program = tmp_path / "bin" / name
    program.parent.mkdir()
    program.write_text(text.replace("{file}", str(file)))
    program.chmod(0o755)
    monkeypatch.setenv("PATH", f"{program.parent}:/bin")
    monkeypatch.setattr(shutil, "which", lambda n: str(program) if n == name else None)
    colord = Colord()
    answer = colord.answer("DP-1")
    assert answer.profile == SystemProfile(SRGB, "my monitor.icc", "colord")
    assert colord.answer("HDMI-1") == Answer()
    file.unlink()
    assert colord.answer("DP-1").fault
    program.unlink()
    assert colord.answer("DP-1") == Answer()


@pytest.mark.parametrize("text", ["", "'", '"\\', "(<@ao []>,)", "ao 0", "\x00'\\x'"])
def test_odd_answers_are_none(text):
    assert first_text(text) == ""


def test_a_profile_has_room_for_any_of_colords():
    folder = Path("/usr/share/color/icc")
    sizes = [0]
    with contextlib.suppress(OSError):
        sizes += [file.stat().st_size for file in folder.rglob("*.ic[cm]")]
    assert max(sizes) < MOST_BYTES
