"""The white of a screen from its ICC profile: `chad`, `wtpt`, neither, and a contradiction."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest

from relgloss_view import Look, Scene, load_sample, open_renderer
from relgloss_view.base.icc.profile import D50, read_profile
from relgloss_view.display.display import Display
from relgloss_view.display.icc_monitor import monitor_of_profile
from relgloss_view.display.icc_white import NO_WHITE, TWO_WHITES, emitted_from_connection
from relgloss_view.display.icc_writing import matrix_profile

COLORD = Path("/usr/share/color/icc/colord")
D65 = np.array([0.9505, 1.0, 1.0891])


def colord(name):
    path = COLORD / f"{name}.icc"
    if not path.is_file():
        pytest.skip(f"{path} is absent (colord-data)")
    return path


def s15(values):
    return struct.pack(f">{len(values)}i", *np.round(65536 * np.asarray(values)).astype(int))


def changed(data, tag, numbers=None, name=None):
    """The profile with a tag of other numbers, or under another name (so that it is absent)."""
    data, at = bytearray(data), data.index(tag)
    if name:
        data[at : at + 4] = name
    else:
        start = struct.unpack_from(">I", data, at + 4)[0] + 8
        data[start : start + 4 * len(numbers)] = s15(numbers)
    return bytes(data)


@pytest.fixture(scope="module")
def srgb():
    return matrix_profile(Display())


def white_of(data):
    matrix, notes = emitted_from_connection(read_profile(data))
    white = matrix @ D50
    return white / white[1], notes


def test_a_picture_for_srgb_as_a_profile_is_that_for_srgb():
    """Numbers of a profile have steps of 1/65536, so that 8 bits differ by at most 1."""
    pictures = []
    with open_renderer("reference") as renderer:
        for profile in ("", str(colord("sRGB")), str(colord("SwappedRedAndGreen"))):
            scene = Scene(load_sample("uncoated"), display=Display(profile=profile))
            pictures.append(renderer.render(scene, Look(), (64, 48)).display.astype(int))
    assert np.abs(pictures[1] - pictures[0]).max() <= 1
    assert np.abs(pictures[2] - pictures[0]).max() > 5  # the negative control


def test_white_of_chad(srgb):
    white, notes = white_of(srgb)
    assert np.abs(white - D65).max() < 2e-4
    assert notes == ()
    # Version 2 of some makers also has the screen's own white in wtpt: it is adapted once.
    both, notes = white_of(changed(srgb, b"wtpt", D65))
    assert np.abs(both - D65).max() < 2e-4
    assert notes == ()


def test_white_of_wtpt(srgb):
    without = changed(changed(srgb, b"wtpt", D65), b"chad", name=b"none")
    for data in (without, changed(changed(srgb, b"wtpt", D65), b"chad", np.eye(3).ravel())):
        white, notes = white_of(data)
        assert np.abs(white - D65).max() < 2e-4
        assert notes == ()


def test_a_white_that_nothing_holds_is_noted(srgb):
    white, notes = white_of(changed(srgb, b"chad", name=b"none"))
    assert np.abs(white - D50).max() < 1e-4
    assert notes == (NO_WHITE,)
    data = changed(changed(srgb, b"chad", name=b"none"), b"wtpt", name=b"none")
    assert white_of(data)[1] == (NO_WHITE,)
    assert NO_WHITE in monitor_of_profile(data, "x").notes


def test_whites_in_contradiction_are_noted(srgb):
    white, notes = white_of(changed(srgb, b"wtpt", [0.9, 1.0, 0.6]))
    assert np.abs(white - D65).max() < 2e-4
    assert notes == (TWO_WHITES,)


@pytest.mark.parametrize("numbers", [[0] * 9, [1] * 9, [30000] * 9, [-1, 0, 0, 0, 1, 0, 0, 0, 1]])
def test_a_chad_that_is_no_adaptation_counts_as_absent(srgb, numbers):
    assert white_of(changed(srgb, b"chad", numbers))[1] == (NO_WHITE,)
