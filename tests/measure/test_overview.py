"""What a table shows before any fit, against closed forms and known spreads."""

from __future__ import annotations

import json

import numpy as np
import pytest

from relgloss_view.fitting.purpose import ESTIMATE, FIT, NOTHING, purpose_of
from relgloss_view.measure.bands import RGB, Bands
from relgloss_view.measure.findings.rows import facet_density
from relgloss_view.measure.gonio import spherical
from relgloss_view.measure.overview import look_over
from relgloss_view.measure.overview.describe import describe
from relgloss_view.measure.overview.directions import BODY, MIRROR
from relgloss_view.measure.table import Measurement


def table(angles, level, bands=RGB):
    """A measurement of (lamp, signed receiver, azimuth out of the plane) and levels (N,)."""
    lamp, receiver, plane = np.asarray(angles, dtype=np.float64).T
    to_lamp = spherical(lamp, 180.0)
    to_receiver = spherical(np.abs(receiver), np.where(receiver < 0.0, 180.0 + plane, plane))
    level = np.broadcast_to(level, len(lamp))
    return Measurement(
        name="made", source="made", to_lamp=to_lamp, to_receiver=to_receiver, bands=bands,
        radiance_factor=np.repeat(level[:, None], bands.count, axis=1),
        reasons=np.full(len(lamp), "", dtype=object), group=np.rint(lamp).astype(np.int64),
    )  # fmt: skip


def grid(lamps, receivers, planes=(0.0,)):
    return np.array([(i, o, p) for i in lamps for o in receivers for p in planes], np.float64)


def cosines(angles):
    return np.cos(np.radians(angles[:, 0])), np.cos(np.radians(angles[:, 1]))


EVEN = grid(range(10, 71, 10), range(-70, 71, 10), (0.0, 30.0, 60.0))
#: No receiver has a lamp's angle: every partner is interpolated.
ODD = grid(range(10, 71, 10), np.arange(-73.5, 74.0, 3.0))

#: Reciprocal for every pair of angles: Lambert 1760; Minnaert 1941, (cos i cos o)^(k - 1); Lommel
#: and Seeliger 1888, 1 / (cos i + cos o), times pi and an albedo.
RECIPROCAL = {
    "Lambert": lambda i, o: np.full_like(i, 0.7),
    "Minnaert": lambda i, o: 0.5 * (i * o) ** 0.4,
    "Lommel-Seeliger": lambda i, o: 0.4 / (i + o),
}


class TestReciprocity:
    @pytest.mark.parametrize("law", RECIPROCAL)
    def test_reciprocal_laws_differ_by_nothing(self, law):
        level = RECIPROCAL[law](*cosines(EVEN))
        pairs = look_over(table(EVEN, level)).reciprocity
        # 7 lamps make 21 pairs, on two sides of three planes.
        assert (pairs.pairs, pairs.interpolated) == (21 * 2 * 3, 0)
        assert np.max(np.abs(pairs.difference)) < 1e-9

    @pytest.mark.parametrize("law", RECIPROCAL)
    def test_interpolated_partners_too(self, law):
        level = RECIPROCAL[law](*cosines(ODD))
        pairs = look_over(table(ODD, level)).reciprocity
        assert pairs.pairs == pairs.interpolated > 30
        assert np.max(np.abs(pairs.difference)) < 1e-4

    @pytest.mark.parametrize("law", RECIPROCAL)
    def test_a_cosine_that_is_left_in_has_its_error(self, law):
        """Control: cos o stays, so a pair differs by 2 (cos o - cos i) / (cos o + cos i)."""
        i, o = cosines(EVEN)
        pairs = look_over(table(EVEN, RECIPROCAL[law](i, o) * o)).reciprocity
        steep, other = (np.cos(np.radians(a)) for a in (pairs.lamp_deg, pairs.receiver_deg))
        assert pairs.difference == pytest.approx(2 * (other - steep) / (other + steep), abs=1e-9)
        assert pairs.bias > 0.1

    def test_a_flank_is_not_interpolated(self):
        """A lobe of half a degree between receivers three degrees apart is not known there."""
        half = np.abs(ODD[:, 1] - ODD[:, 0]) / 2.0
        level = 0.5 + 50.0 * np.exp(-0.5 * np.square(half / 0.5))
        pairs = look_over(table(ODD, level)).reciprocity
        assert pairs.pairs > 10
        assert np.max(np.abs(pairs.difference)) < 0.02

    def test_noise_has_no_bias(self):
        """Of noise of 2 % the difference of two readings has a median of 0.6745 sqrt(2) 2 %."""
        angles = grid(range(4, 77, 2), range(-76, 77, 2))
        noise = np.random.default_rng(5).normal(1.0, 0.02, len(angles))
        pairs = look_over(table(angles, 0.6 * noise)).reciprocity
        assert pairs.typical() == pytest.approx(0.6745 * np.sqrt(2.0) * 0.02, rel=0.08)
        assert abs(pairs.bias) < 0.003

    def test_one_plane_of_incidence_has_no_partner(self):
        overview = look_over(table(grid([45.0], range(-70, 71, 5)), 0.5))
        assert overview.reciprocity.pairs == 0
        assert overview.as_json()["reciprocity"]["median"] is None


class TestRepeatability:
    def test_it_is_the_spread_that_was_put_in(self):
        angles = np.repeat(grid(range(10, 71, 10), range(-70, 71, 5)), 10, axis=0)
        for spread in (0.002, 0.03):
            noise = np.random.default_rng(1).normal(1.0, spread, len(angles))
            # The level differs between geometries, which is no spread.
            level = 0.3 * (1.0 + angles[:, 0] / 90.0) * noise
            found = look_over(table(angles, level)).repeats
            assert (found.geometries, found.readings) == (7 * 29, len(angles))
            assert found.relative_sd == pytest.approx(spread, rel=0.05)
            assert not found.copies

    def test_copies_are_no_repeated_readings(self):
        angles = np.repeat(EVEN, 2, axis=0)
        overview = look_over(table(angles, 0.5))
        assert overview.repeats.copies
        assert "copies" in describe(overview)

    def test_none(self):
        assert look_over(table(ODD, 0.5)).repeats.relative_sd is None


class TestRidge:
    @pytest.mark.parametrize("shift", [0.0, 0.4, -0.7])
    def test_it_is_where_the_receiver_is_off(self, shift):
        """Facets lean as a Gaussian of 3 degrees; the receiver's scale is off by the shift."""
        angles = grid(range(20, 61, 10), range(-70, 76, 1))
        true = angles - np.array([0.0, shift, 0.0])
        there = table(true, 1.0)
        half = (true[:, 1] - true[:, 0]) / 2.0
        density = 300.0 * np.exp(-0.5 * np.square(half / 3.0))
        unit = facet_density(np.ones(len(true)), there.to_lamp, there.to_receiver)
        overview = look_over(table(angles, 0.3 + density / unit))
        assert len(overview.summits) == 5
        assert overview.ridge_offset_deg == pytest.approx(shift, abs=0.05)

    def test_a_matte_sample_has_none(self):
        assert look_over(table(EVEN, 0.7)).summits == ()


class TestPurpose:
    def test_a_scan_serves_for_a_fit(self):
        overview = look_over(table(EVEN, 0.5))
        assert purpose_of(overview.measurement, overview.findings).use == FIT

    def test_a_multi_angle_instrument_serves_for_an_estimate(self):
        """Lamp at 45 degrees, receivers -15, 15, 25, 45, 75, 110 off its mirror (ASTM E2539)."""
        angles = grid([45.0], [45.0 - a for a in (-15, 15, 25, 45, 75, 110)])
        overview = look_over(table(angles, 0.4, Bands((450.0, 550.0, 650.0))))
        parts = {d.part: d.row for d in overview.directions}
        assert parts[BODY] == 3
        assert parts[MIRROR] in (0, 1)
        purpose = purpose_of(overview.measurement, overview.findings)
        assert purpose.use == ESTIMATE
        assert "row 4" in purpose.text

    def test_without_a_spectrum_or_45_0_for_nothing(self):
        few = grid([45.0], [0.0])
        assert purpose_of(table(few, 0.4)).use == NOTHING
        aside = grid([60.0], [20.0])
        assert purpose_of(table(aside, 0.4, Bands((450.0, 550.0)))).use == NOTHING

    @pytest.mark.parametrize("level", [1e-9, 0.0])
    def test_darkness_serves_for_nothing(self, level):
        overview = look_over(table(EVEN, level))
        assert purpose_of(overview.measurement).use == NOTHING
        assert json.loads(json.dumps(overview.as_json(), allow_nan=False))["used"] in (0, len(EVEN))
        assert "left out" in describe(overview)
