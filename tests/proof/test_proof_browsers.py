"""The browsers themselves: what the other tests of the page believe about them."""

from __future__ import annotations

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
