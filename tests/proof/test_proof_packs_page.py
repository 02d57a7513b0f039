"""Packs and forms of triangles in the page: the pictures that the window draws, pixel by pixel."""

from __future__ import annotations

import numpy as np
import pytest
from browsers import console
from engines import desktop, draw, open_engine, settings_of
from pack_pages import LIT, carried, make_pack, pair_of

from relgloss_view import Look

SIZE = (96, 96)
C_MAX = 1e-4  #: relative: of a texel's highlight, whose float sums two drivers round otherwise


def both(browser, renderer, sides, files, size=SIZE, settings=None):
    """Largest difference and share of different pixels of each side, and the two reports."""
    settings = settings or settings_of(sides)
    open_engine(browser, sides, files=files)
    report, pictures = draw(browser, settings, size)
    factor, frames = desktop(renderer, sides, settings, size)
    assert report["factor"] == pytest.approx(factor, rel=C_MAX)
    for side, frame in frames.items():
        if frame["c_max"] is not None:
            assert report[side]["c_max"] == pytest.approx(frame["c_max"], rel=C_MAX)
    console(browser)
    return {
        side: np.abs(pictures[side].astype(int) - frames[side]["display"].astype(int)).max(axis=-1)
        for side in frames
    }


def test_a_can_with_artwork_foil_and_varnish(chromium_gl, renderer, tmp_path):
    pack = make_pack(tmp_path, "can")
    sides = pair_of(pack, Look(1.0, c=2.0, grain="surface"))
    apart = both(chromium_gl, renderer, sides, carried(tmp_path))
    assert {side: int(one.max()) for side, one in apart.items()} == {"reference": 0, "test": 0}
