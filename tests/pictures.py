"""Comparison of pictures that leaves something to look at where it fails.

Both pictures and their magnified difference are written as PNG into tests/failed/, which git
ignores, and the message of the assertion names them.
"""

from __future__ import annotations

import os
import re
from pathlib import Path

import numpy as np
from PIL import Image

FOLDER = Path(__file__).resolve().parent / "failed"


def assert_same_pixels(drawn, expected, within=0.0):
    """Fail where two pictures (H, W) or (H, W, channels) differ by more than `within` anywhere.

    Values may be digital (uint8) or any other numbers. NaN equals NaN, as in numpy's tests.
    """
    drawn, expected = np.asarray(drawn), np.asarray(expected)
    assert drawn.shape == expected.shape, f"sizes differ: {drawn.shape} and {expected.shape}"
    a, b = drawn.astype(np.float64), expected.astype(np.float64)
    both_absent = np.isnan(a) & np.isnan(b)
    off = np.where(both_absent, 0.0, a - np.where(both_absent, 0.0, b))
    wrong = ~(np.abs(off) <= within)
    if not np.any(wrong):
        return
    pixels = wrong if wrong.ndim == 2 else np.any(wrong, axis=-1)
    row, column = np.argwhere(pixels)[0]
    # A difference that is no number counts as the largest.
    largest = float(np.max(np.where(np.isfinite(off), np.abs(off), np.inf)))
    finite = np.abs(off[np.isfinite(off)])
    gain = 127.0 / max(float(np.max(finite, initial=0.0)), 1e-300)
    files = {
        "drawn": _gray_levels(a, b, drawn.dtype),
        "expected": _gray_levels(b, b, drawn.dtype),
        "difference": np.nan_to_num(127.0 + gain * off, nan=255.0, posinf=255.0, neginf=0.0),
    }
    saved = [_save(name, values) for name, values in files.items()]
    raise AssertionError(
        f"{np.sum(pixels)} of {pixels.size} pixels differ by more than {within:g}, the largest by "
        f"{largest:g}; the first in row {row}, column {column}: {drawn[row, column]} where "
        f"{expected[row, column]} was expected. See {', '.join(map(str, saved))}; the difference "
        f"is magnified {gain:.3g} times around gray."
    )


def _gray_levels(values, scale_of, kind):
    """0 to 255: digital values as they are, others from the least to the largest expected one."""
    if kind == np.uint8:
        return values
    usable = scale_of[np.isfinite(scale_of)]
    low, high = (float(np.min(usable)), float(np.max(usable))) if usable.size else (0.0, 1.0)
    scaled = 255.0 * (values - low) / max(high - low, 1e-300)
    return np.nan_to_num(scaled, nan=0.0, posinf=255.0, neginf=0.0)


def _save(name, values):
    test = os.environ.get("PYTEST_CURRENT_TEST", "no test").partition(" ")[0]
    stem = re.sub(r"[^\w.-]+", "-", test.rpartition("/")[2])
    FOLDER.mkdir(parents=True, exist_ok=True)
    path = FOLDER / f"{stem}-{name}.png"
    levels = np.clip(np.round(values), 0, 255).astype(np.uint8)
    if levels.ndim == 3 and levels.shape[-1] not in (3, 4):
        levels = levels[..., 0]
    Image.fromarray(levels).save(path)
    return path
