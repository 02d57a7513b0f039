"""The comparison of pictures: what passes, what fails, and what it leaves to look at."""

from __future__ import annotations

import re

import numpy as np
import pictures
import pytest
from PIL import Image


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setattr(pictures, "FOLDER", tmp_path / "failed")
    return tmp_path / "failed"


def ramp(kind=np.uint8):
    values = np.arange(40 * 30).reshape(30, 40) % 200
    return np.repeat(values[..., None], 3, axis=-1).astype(kind)


def opened(message):
    """The three pictures that a message names."""
    paths = re.findall(r"\S+\.png", message)
    assert len(paths) == 3
    return [np.asarray(Image.open(path)) for path in paths]


def test_a_wrong_pixel_is_shown_and_named(folder):
    expected = ramp()
    drawn = expected.copy()
    drawn[7, 11] = (10, 40, 90)
    with pytest.raises(AssertionError, match=r"1 of 1200 pixels.*row 7, column 11") as caught:
        pictures.assert_same_pixels(drawn, expected)
    first, second, difference = opened(str(caught.value))
    np.testing.assert_array_equal(first, drawn)
    np.testing.assert_array_equal(second, expected)
    # Gray where the pictures agree; the largest difference is as far from gray as a byte allows.
    untouched = np.ones((30, 40), dtype=bool)
    untouched[7, 11] = False
    assert np.all(difference[untouched] == 127)
    assert np.max(np.abs(difference[7, 11].astype(int) - 127)) == 127
    assert "test_a_wrong_pixel_is_shown_and_named" in str(caught.value)


def test_equal_pictures_leave_nothing(folder):
    pictures.assert_same_pixels(ramp(), ramp())
    assert not folder.exists()


@pytest.mark.parametrize("within", [0.0, 1.0, 2.0])
def test_the_bound_is_inclusive(folder, within):
    drawn = ramp()
    drawn[0, 0, 1] += 1
    if within >= 1.0:
        pictures.assert_same_pixels(drawn, ramp(), within)
    else:
        with pytest.raises(AssertionError):
            pictures.assert_same_pixels(drawn, ramp(), within)


def test_bytes_do_not_wrap(folder):
    """255 and 0 differ by 255, though their difference as bytes is 1."""
    with pytest.raises(AssertionError, match="by 255;"):
        pictures.assert_same_pixels(np.full((4, 4), 255, np.uint8), np.zeros((4, 4), np.uint8), 1)


@pytest.mark.parametrize("wrong", [np.nan, np.inf, -np.inf])
def test_what_is_no_number_differs(folder, wrong):
    drawn = ramp(np.float64)
    drawn[3, 2, 0] = wrong
    with pytest.raises(AssertionError, match="row 3, column 2") as caught:
        pictures.assert_same_pixels(drawn, ramp(np.float64), 1e300)
    assert len(opened(str(caught.value))) == 3


def test_absent_values_on_both_sides_agree(folder):
    absent = ramp(np.float64)
    absent[3, 2] = np.nan
    pictures.assert_same_pixels(absent, absent.copy())


def test_other_numbers_are_scaled_to_gray_levels(folder):
    expected = np.linspace(-1.0, 3.0, 12).reshape(3, 4)
    with pytest.raises(AssertionError) as caught:
        pictures.assert_same_pixels(expected + 4.0, expected, 1.0)
    first, second, _ = opened(str(caught.value))
    assert (second.min(), second.max()) == (0, 255)
    assert np.all(first == 255)


def test_sizes_must_agree(folder):
    with pytest.raises(AssertionError, match="sizes differ"):
        pictures.assert_same_pixels(ramp(), ramp()[:5])
