"""The browsers themselves: what the other tests of the page believe about them."""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from pathlib import Path

import browsers
import numpy as np
import pytest
from browsers import call, call_array, console, emulate, open_page, screenshot

PAGE = '<!DOCTYPE html>\n<html><head><meta charset="utf-8"><title>t</title></head><body>{}</body>'


def test_llvmpipe(chromium_gl):
    assert "llvmpipe" in chromium_gl.renderer


def test_swiftshader(chromium_sw):
    assert "SwiftShader" in chromium_sw.renderer


def test_calls(chromium_gl):
    open_page(chromium_gl, PAGE.format("hello"))
    assert call(chromium_gl, "() => document.body.textContent") == "hello"
    assert call(chromium_gl, "async (a, b) => a + b.x", 1, {"x": 2}) == 3
    with pytest.raises(AssertionError, match=r"RangeError: so it is"):
        call(chromium_gl, "async () => { throw new RangeError('so it is'); }")
    got = call_array(chromium_gl, "() => new Float32Array([0.5, NaN, 3])")
    assert got.dtype == np.float32
    assert np.array_equal(got, np.float32([0.5, np.nan, 3]), equal_nan=True)


def test_page_errors_fail(chromium_gl):
    open_page(chromium_gl, PAGE.format("<script>console.log('a word')</script>"))
    assert any("a word" in line for line in console(chromium_gl))
    open_page(chromium_gl, PAGE.format("<script>throw new Error('planted')</script>"))
    with pytest.raises(AssertionError, match="planted"):
        console(chromium_gl)
    open_page(chromium_gl, PAGE.format(""))
    console(chromium_gl)


def test_emulation_and_its_end(chromium_gl, tmp_path):
    features = """() => ["(prefers-reduced-motion: reduce)", "(forced-colors: active)",
      "(pointer: coarse)"].map(q => matchMedia(q).matches).concat([innerWidth, innerHeight,
      devicePixelRatio])"""
    emulate(chromium_gl, 390, 844, 2, touch=True, reduced_motion=True, forced_colours=True)
    wide = '<meta name="viewport" content="width=device-width"><title>'
    open_page(chromium_gl, PAGE.replace("<title>", wide))
    assert call(chromium_gl, features) == [True, True, True, 390, 844, 2]
    screenshot(chromium_gl, tmp_path / "a.png")
    assert (tmp_path / "a.png").read_bytes()[:4] == b"\x89PNG"
    browsers.as_before(chromium_gl)
    assert call(chromium_gl, features)[:3] == [False, False, False]
    assert call(chromium_gl, features)[5] == 1


STARTS = """
import sys
sys.path[:0] = [{here!r}]
from browsers import SWIFTSHADER, chromium, kept
with {what} as started:
    print(getattr(started, "folder", ""), flush=True)
    sys.stdin.read()
"""
LONGEST_S = 60.0


def running(word):
    """Processes whose command line holds a word."""
    found = []
    for path in Path("/proc").glob("[0-9]*/cmdline"):
        try:
            if word.encode() in path.read_bytes():
                found.append(int(path.parent.name))
        except OSError:  # it has just ended
            continue
    return found


def until(condition):
    end = time.monotonic() + LONGEST_S
    while not condition():
        assert time.monotonic() < end, "it does not come"
        time.sleep(0.02)


@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGINT])
def test_nothing_outlives_the_tests(how, tmp_path):
    """A tree with a process that left its session, as browsers have; a stand-in for pytest ends."""
    word = f"3{tmp_path.stat().st_ino}"  # a time to sleep that nobody else has
    what = f"kept('sh', '-c', 'setsid sleep {word} & sleep {word}')"
    code = STARTS.format(here=str(Path(browsers.__file__).parent), what=what)
    with subprocess.Popen(
        [sys.executable, "-c", code],
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
    ) as stand_in:  # fmt: skip
        stand_in.stdout.readline()
        until(lambda: len(running(f"sleep\0{word}")) == 2)
        stand_in.send_signal(how)
        stand_in.wait(LONGEST_S)
    until(lambda: not running(word))


@pytest.mark.slow
def test_no_browser_outlives_the_tests():
    code = STARTS.format(
        here=str(Path(browsers.__file__).parent), what="chromium(*SWIFTSHADER, needs='Swift')"
    )
    with subprocess.Popen(
        [sys.executable, "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    ) as stand_in:
        folder = stand_in.stdout.readline().decode().strip()
        assert len(running(folder)) > 3
        stand_in.kill()
    until(lambda: not running(folder))
    until(lambda: not Path(folder).exists())


@pytest.mark.parametrize("name", browsers.PACKAGES)
def test_a_missing_program_fails_with_the_line_that_brings_it(name, monkeypatch):
    assert browsers.program(name)
    monkeypatch.setenv("PATH", "")
    with pytest.raises(
        pytest.fail.Exception, match=f"apt-get install .* {browsers.PACKAGES[name]}"
    ):
        browsers.program(name)


def test_system_packages_bring_them():
    script = Path(__file__).parents[2] / "scripts" / "system-packages"
    lines = script.read_text(encoding="utf-8")
    for command, package in browsers.PACKAGES.items():
        assert f"command -v {command} >/dev/null || need {package}\n" in lines


def test_a_browser_without_what_the_page_needs_fails():
    with (
        pytest.raises(pytest.fail.Exception, match=r"apt-get install .*chromium"),
        browsers.chromium("--headless=new", "--disable-gpu", "--disable-3d-apis", needs="Swift"),
    ):
        pass
