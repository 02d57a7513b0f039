"""Where the pictures are in their pane; pictures and bare parts tile it, pixel by pixel."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from relgloss_view.picture.model.view import MAX_PIXELS, MAX_SIDE_PX, View, check_size
from relgloss_view.viewer.drawing.arrangement import (
    Arrangement,
    arranged,
    as_shown,
    drawable,
    seen_by,
)
from relgloss_view.viewer.drawing.canvas import bare
from relgloss_view.viewer.state.state import COMPARE_MODES, Presentation, State

PANE = (1001, 600)
WHOLE = (0, 0, *PANE)
BOTH = ("reference", "test")


@pytest.mark.parametrize(
    ("settings", "rects"),
    [
        ({}, {"reference": (0, 0, 488, 600), "test": (512, 0, 488, 600)}),
        ({"mirror": True}, {"test": (0, 0, 488, 600), "reference": (512, 0, 488, 600)}),
        ({"gap_px": 0.0}, {"reference": (0, 0, 500, 600), "test": (500, 0, 500, 600)}),
        ({"gap_px": 2000.0}, {"reference": (0, 0, 1, 600), "test": (1000, 0, 1, 600)}),
        ({"compare": "wipe"}, {"reference": WHOLE, "test": WHOLE}),
        ({"compare": "wipe", "mirror": True}, {"test": WHOLE, "reference": WHOLE}),
        ({"compare": "flip"}, {"reference": WHOLE}),
        ({"compare": "flip", "flipped": True}, {"test": WHOLE}),
        ({"compare": "flip", "mirror": True}, {"reference": WHOLE}),
        ({"compare": "difference"}, {"test": WHOLE}),
        ({"compare": "side by side", "flipped": True}, None),
        *(({"compare": m, "haploscopic": True, "flipped": True}, None) for m in COMPARE_MODES),
    ],
)
def test_every_mode(settings, rects):
    presentation = Presentation(**settings)
    got = arranged(PANE, presentation)
    expected = rects or arranged(PANE, Presentation()).rects
    assert got is not None
    assert list(got.rects.items()) == list(expected.items())  # in the order that they show in
    assert got.size == next(iter(expected.values()))[2:]
    assert got.complete


@pytest.mark.parametrize(
    ("settings", "sides"),
    [
        ({}, BOTH),
        ({"compare": "wipe"}, BOTH),
        ({"compare": "difference"}, BOTH),
        ({"compare": "flip"}, ("reference",)),
        ({"compare": "flip", "flipped": True}, ("test",)),
        ({"compare": "flip", "flipped": True, "haploscopic": True}, BOTH),
    ],
)
def test_sides_that_are_shown(settings, sides):
    presentation = Presentation(**settings)
    got = arranged(PANE, presentation)
    assert got is not None
    assert set(got.rects) <= set(sides)  # what is shown was drawn


@pytest.mark.parametrize(
    ("pane", "each"),
    [
        ((0, 0), None), ((0, 5), None), ((5, 0), None), ((1, 5), None), ((-3, 5), None),
        ((2, 5), (1, 5)), ((3, 1), (1, 1)), ((25, 5), (1, 5)), ((26, 5), (1, 5)), ((28, 5), (2, 5)),
    ],
)  # fmt: skip
def test_tiny_panes(pane, each):
    got = arranged(pane, Presentation())
    assert (None if got is None else got.size) == each
    if got is not None:
        _inside(got, pane)
    one = arranged(pane, Presentation(compare="wipe"))
    assert (one is None) == (min(pane) < 1)


def _inside(got, pane):
    for left, top, width, height in got.rects.values():
        assert left >= 0
        assert top >= 0
        assert left + width <= pane[0]
        assert top + height <= pane[1]


class TestHugePanes:
    def test_as_large_as_can_be_drawn(self):
        got = arranged((20000, 20000), Presentation(compare="wipe"))
        assert got is not None
        assert got.rects["test"] == (0, 0, 20000, 20000)
        assert got.size == (6144, 6144)  # MAX_PIXELS is its square
        assert not got.complete

    @given(
        st.tuples(st.integers(1, 60_000), st.integers(1, 60_000)),
        st.sampled_from([None, (16384, 16384), (4096, 4096), (64, 64)]),
    )
    def test_proportions_are_kept_and_limits_are_used(self, size, largest):
        width, height = drawable(size, largest)
        check_size((width, height))
        side = min(MAX_SIDE_PX, *(largest or ()), *(() if largest else (MAX_SIDE_PX,)))
        assert max(width, height) <= side
        if max(size) <= side and size[0] * size[1] <= MAX_PIXELS:
            assert (width, height) == size
            return
        # A side is cut to whole pixels, so that it is less than one short; none gets below one.
        wide, narrow = max(width, height), min(width, height)
        exact = wide * min(size) / max(size)
        share = min(size) / max(size)
        assert max(exact - 1.0, 0.0) <= narrow <= max(exact + share, 1.0) + 1e-6
        # One more pixel on the longer side would be beyond a limit.
        longer = wide + 1
        assert longer > side or longer * (longer * share) > MAX_PIXELS

    def test_limit_of_the_device(self):
        got = arranged((5000, 100), Presentation(gap_px=0.0), largest=(1024, 1024))
        assert got is not None
        assert got.size == (1024, 40)
        assert got.rects["test"] == (2500, 0, 2500, 100)


# --- what no picture covers -----------------------------------------------------------------------


def count_covers(pane, rects):
    """How many rectangles cover each pixel of a pane; none may reach out of it."""
    counts = np.zeros((pane[1], pane[0]), int)
    for left, top, width, height in rects:
        assert width > 0
        assert height > 0
        assert left >= 0
        assert top >= 0
        assert left + width <= pane[0]
        assert top + height <= pane[1]
        counts[top : top + height, left : left + width] += 1
    return counts


@st.composite
def covered_panes(draw):
    """A small pane with rectangles side by side; they may reach out of it anywhere."""
    pane = draw(st.tuples(st.integers(1, 24), st.integers(1, 16)))
    edges = sorted(draw(st.lists(st.integers(-6, 32), min_size=2, max_size=6, unique=True)))
    rects = []
    for left, right in zip(edges[::2], edges[1::2], strict=False):
        top, tall = draw(st.integers(-6, 20)), draw(st.integers(0, 24))
        rects.append((left, top, right - left, tall))
    if draw(st.booleans()):
        rects.append(draw(st.sampled_from(rects)))  # one over the other, as the wipe has them
    return pane, draw(st.permutations(rects))


@given(covered_panes())
def test_parts_and_pictures_tile_the_pane(case):
    pane, covered = case
    counts = count_covers(pane, bare(pane, covered))
    pictures = np.zeros_like(counts)
    for left, top, width, height in covered:
        rows = slice(max(top, 0), max(top + height, 0))
        pictures[rows, max(left, 0) : max(left + width, 0)] = 1
    np.testing.assert_array_equal(counts + pictures, 1)


def test_count_notices_a_missing_or_doubled_column():
    """The control of the count above."""
    parts = bare((10, 4), [(2, 1, 3, 2)])
    assert np.all(count_covers((10, 4), [*parts, (2, 1, 3, 2)]) == 1)
    assert not np.all(count_covers((10, 4), [*parts, (2, 1, 4, 2)]) == 1)
    assert not np.all(count_covers((10, 4), [*parts, (2, 1, 3, 1)]) == 1)


@given(
    st.tuples(st.integers(2, 60), st.integers(1, 20)),
    st.sampled_from(COMPARE_MODES),
    st.floats(0.0, 2000.0),
    st.booleans(),
)
def test_arrangements_tile_their_pane(pane, mode, gap, mirror):
    got = arranged(pane, Presentation(compare=mode, gap_px=gap, mirror=mirror))
    assert got is not None
    rects = list(dict.fromkeys(got.rects.values()))
    np.testing.assert_array_equal(count_covers(pane, [*rects, *bare(pane, rects)]), 1)


@pytest.mark.parametrize("pane", [(0, 0), (0, 7), (7, 0)])
def test_pane_of_no_pixel_has_no_parts(pane):
    assert bare(pane, []) == []
    assert bare(pane, [(0, 0, 3, 3)]) == []


def test_complete_is_told_by_each_picture():
    whole = Arrangement((5, 4), {"reference": (0, 0, 5, 4), "test": (6, 0, 5, 4)})
    assert whole.complete
    assert not dataclasses.replace(whole, size=(4, 4)).complete


# --- the eye that it takes ------------------------------------------------------------------------


class TestLifeSize:
    STATE = State.initial()
    LIFE = STATE.with_part("presentation", life_size=True)

    def test_only_where_it_is_asked_for_and_the_monitor_tells(self):
        assert seen_by(self.STATE, (400, 300), 2.5e-4) is self.STATE.setup.eye
        assert seen_by(self.LIFE, (400, 300), None) is self.LIFE.setup.eye
        assert as_shown(self.STATE, (400, 300), 2.5e-4) is self.STATE
        assert as_shown(self.LIFE, (400, 300), None) is self.LIFE

    @pytest.mark.parametrize("shrunk", [1, 2])
    def test_object_has_its_size(self, shrunk):
        """The cylinder's 100 mm, also in a picture that is drawn smaller and shown enlarged."""
        pitch, size = 1.5e-4 * shrunk, (600 // shrunk, 500 // shrunk)
        shown = as_shown(self.LIFE, size, pitch)
        assert shown.setup.eye != self.LIFE.setup.eye
        assert shown.placed(eye=self.LIFE.setup.eye) == self.LIFE
        view = View.of(shown.scene("test"), size)
        tall_px = 0.10 / shown.setup.eye.distance_m / view.pixel_step
        assert tall_px * pitch == pytest.approx(0.10, rel=1e-6)
        other = View.of(self.LIFE.scene("test"), size)  # the control: framed, it has not
        framed_px = 0.10 / shown.setup.eye.distance_m / other.pixel_step
        assert framed_px * pitch != pytest.approx(0.10, rel=0.1)
