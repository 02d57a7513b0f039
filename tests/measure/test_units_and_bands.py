"""Radians, percent, bands without readings and noise below zero: read by declaration, or asked."""

from __future__ import annotations

import numpy as np
import pytest

from relgloss_view.base.errors import InputError
from relgloss_view.measure import screening
from relgloss_view.measure.bands import Bands
from relgloss_view.measure.quantity import canonical_quantity
from relgloss_view.measure.readers import read_measurement

ANGLES = np.array([(a, 0.0, b, 180.0) for a in (0, 20, 45, 60) for b in (0, 10, 30, 45, 60)])
ARMS = np.array([(a, b, g) for a in (-60, -45) for b in (10, 25, 45) for g in (0, 15, 30)])
BANDS = (390.0, 420.0, 450.0, 480.0, 510.0, 550.0, 600.0, 650.0)


def text_of(angles, values, bands=BANDS, comments="", names=None):
    names = names or ("theta_i_deg", "phi_i_deg", "theta_r_deg", "phi_r_deg")
    header = ",".join([*names, *(f"{nm:g}" for nm in bands)])
    rows = [
        ",".join(["" if np.isnan(x) else f"{x:.6g}" for x in (*angle, *value)])
        for angle, value in zip(angles, values, strict=True)
    ]
    return "\n".join([f"# quantity: radiance-factor\n{comments}{header}", *rows]) + "\n"


@pytest.fixture
def read(tmp_path):
    def from_text(text, **arguments):
        (tmp_path / "t.csv").write_text(text)
        return read_measurement(tmp_path / "t.csv", **arguments)

    return from_text


def flat(count, level=0.4, bands=BANDS):
    return np.full((count, len(bands)), level)


class TestRadians:
    def test_a_table_in_radians_is_asked_about_and_read_when_declared(self, read):
        expected = read(text_of(ANGLES, flat(20)))
        radians = text_of(np.radians(ANGLES), flat(20))
        with pytest.raises(InputError, match=r"below 1\.6.*are they radians\?.*--angle-unit"):
            read(radians)
        named = ("theta_i_rad", "phi_i [rad]", "Theta_r (radians)", "phi_r/rad")
        for found in (
            read(radians, angle_unit="radians"),
            read(radians.replace("theta_i_deg", "# angle_unit: radians\ntheta_i_deg", 1)),
            read(text_of(np.radians(ANGLES), flat(20), names=named)),
        ):
            np.testing.assert_allclose(found.to_lamp, expected.to_lamp, atol=5e-6)
            np.testing.assert_allclose(found.to_receiver, expected.to_receiver, atol=5e-6)

    def test_arms_in_radians(self, read):
        names = ("alpha_deg", "beta_deg", "gamma_deg")
        degrees = read(text_of(ARMS, flat(18), names=names), gamma_s_deg=15)
        radians = text_of(np.radians(ARMS), flat(18), names=names)
        with pytest.raises(InputError, match=r"all angles lie below 1\.6: are they radians"):
            read(radians, gamma_s_deg=15)
        found = read(radians, gamma_s_deg=15, angle_unit="radians")
        np.testing.assert_allclose(found.to_receiver, degrees.to_receiver, atol=5e-6)

    @pytest.mark.parametrize("columns", [[1, 3], [0, 2]])
    def test_azimuths_or_polar_angles_alone(self, read, columns):
        mixed = ANGLES.copy()
        mixed[:, columns] = np.radians(mixed[:, columns])
        with pytest.raises(InputError, match="are they radians"):
            read(text_of(mixed, flat(20)))

    def test_a_right_angle_in_rounded_radians(self, read):
        angles = np.array([(0.0, 0.0, 1.5708, 3.1416), *np.radians(ANGLES)])
        found = read(text_of(angles, flat(21)), angle_unit="radians")
        assert found.left_out() == {"within 3 degrees of the horizon": 1} or found.left_out() == {
            "below the horizon": 1
        }

    def test_degrees_near_the_mirror_direction_can_be_declared(self, read):
        near = text_of(ANGLES / 45.0 * [1, 1, 1, 0], flat(20))
        with pytest.raises(InputError, match="angle_unit: degrees"):
            read(near)
        assert read(near, angle_unit="degrees").kept.all()

    @pytest.mark.parametrize(
        "angles", [[(0, 0, 1, 0), (1, 0, 1, 180)], [(0, 0, 0, 0)] * 3, [(0.5, 0, 0.5, 0)] * 3]
    )
    def test_few_degrees_are_not_taken_for_radians(self, read, angles):
        assert read(text_of(np.array(angles, float), flat(len(angles)))).kept.all()

    def test_the_argument_wins_with_a_warning_and_a_wrong_word_is_named(self, read):
        table = text_of(ANGLES, flat(20), comments="# angle_unit: radians\n")
        assert "are read as degrees" in read(table, angle_unit="degrees").warnings[0]
        with pytest.raises(InputError, match=r"line \d, column \d.* rad is not between"):
            read(table)
        with pytest.raises(InputError, match="line 2: unknown unit of angle 'gon'"):
            read(table.replace("radians", "gon"))


class TestPercent:
    def test_percent_is_refused_with_the_option_that_reads_it(self, read):
        percent = text_of(ANGLES, flat(20, 40.0))
        option = "--quantity radiance-factor-percent"
        with pytest.raises(InputError, match=f"percent; pass {option}"):
            read(percent)
        quantity = option.split()[1]
        for found in (
            read(percent, quantity=quantity),
            read(percent.replace("radiance-factor", quantity)),
            read(percent.replace("radiance-factor", "Radiance factor [%]")),
        ):
            np.testing.assert_allclose(found.radiance_factor, 0.4)

    def test_one_geometry_in_percent(self, read):
        with pytest.raises(InputError, match="percent"):
            read(text_of(np.array([(45.0, 0.0, 0.0, 0.0)]), flat(1, 40.0)))

    def test_counts_are_not_called_percent(self, read):
        with pytest.raises(InputError, match="check the unit"):
            read(text_of(ANGLES, flat(20, 30_000.0)))

    def test_a_mirror_and_a_retroreflector_are_not_percent(self, read):
        # In-plane at 180 degrees the mirror direction; at 0 degrees the lamp itself.
        values = np.where((ANGLES[:, 0] == ANGLES[:, 2])[:, None], 90.0, flat(20))
        assert read(text_of(ANGLES, values)).kept.all()
        back = ANGLES * [1, 1, 1, 0]
        assert read(text_of(back, values)).kept.all()

    @pytest.mark.parametrize(
        ("words", "quantity"),
        [
            ("Radiance Factor", "radiance-factor"),
            ("radiance_factor", "radiance-factor"),
            ("BRDF (1/sr)", "brdf"),
            ("BRDF [sr^-1]", "brdf"),
            ("CCBRDF", "brdf-cos"),
            ("BRDF*cos", "brdf-cos"),
            ("percent", "radiance-factor-percent"),
        ],
    )
    def test_words_for_a_quantity(self, words, quantity):
        assert canonical_quantity(words, "x") == quantity


class TestBands:
    def values(self, **columns):
        """Values of 0.4 with other ones in the bands whose wavelength is named."""
        values = flat(20)
        for name, column in columns.items():
            values[:, BANDS.index(float(name[2:]))] = column
        return values

    @pytest.mark.parametrize(
        ("column", "word"), [(-0.0004, "negative"), (-0.05, "negative"), (np.nan, "empty")]
    )
    def test_a_band_without_readings_is_left_out_and_named(self, read, column, word):
        found = read(text_of(ANGLES, self.values(nm390=column)))
        assert found.bands.wavelengths_nm == BANDS[1:]
        assert found.kept.all()
        assert f"left out the band 390 nm, which is {word} in 20 of 20" in found.warnings[0]

    def test_mostly_is_enough_and_seldom_is_not(self, read):
        mostly = np.where(np.arange(20) % 3 == 0, 0.01, -0.01)
        assert read(text_of(ANGLES, self.values(nm390=mostly))).bands.count == len(BANDS) - 1
        seldom = np.where(np.arange(20) % 5 == 0, -0.01, 0.01)
        found = read(text_of(ANGLES, self.values(nm390=seldom)))
        assert found.bands.count == len(BANDS)
        assert found.kept.all()
        assert (
            "4 single values are filled from neighbouring bands (4 negative)" in found.warnings[0]
        )

    def test_bands_that_would_cost_most_samples_together(self, read):
        fourth = np.arange(20) % 4
        columns = {
            f"nm{nm:g}": np.where((k - fourth) % 4 < 3, -0.05, 0.01)
            for k, nm in enumerate(BANDS[:4])
        }
        found = read(text_of(ANGLES, self.values(**columns)))
        assert found.bands.count < len(BANDS)
        assert found.kept.sum() >= 10

    def test_samples_that_are_negative_in_all_bands_leave_the_bands(self, read):
        values = flat(20)
        values[:12] = -0.01
        found = read(text_of(ANGLES, values))
        assert found.bands.count == len(BANDS)
        assert found.left_out() == {"negative": 12}

    def test_zeros_are_black_unless_a_highlight_shows_that_they_are_not(self, read):
        assert read(text_of(ANGLES, self.values(nm390=0.0))).bands.count == len(BANDS)
        values = self.values(nm390=0.0)
        values[3, 1:] = 3.0
        found = read(text_of(ANGLES, values))
        assert found.bands.wavelengths_nm == BANDS[1:]
        assert "zero in 20 of 20" in found.warnings[0]

    def test_a_dark_colour_stays(self, read):
        # A red ink: no light from 420 to 510 nm, where the noise falls on either side of zero.
        rng = np.random.default_rng(1)
        noise = {f"nm{nm:g}": rng.normal(-1e-4, 2e-4, 20) for nm in BANDS[1:5]}
        found = read(text_of(ANGLES, self.values(nm390=-0.01, **noise)))
        assert found.bands.wavelengths_nm is not None
        assert set(BANDS[1:5]) <= set(found.bands.wavelengths_nm)
        assert found.kept.all()
        assert found.radiance_factor[:, :4].max() < 1e-3
        assert found.radiance_factor[:, :4].min() < 0.0
        assert any("kept as noise about zero" in w for w in found.warnings)

    def test_noise_about_zero_is_kept_and_a_single_fault_is_filled(self, read):
        values = self.values(nm390=0.01)
        values[4, 0], values[5, 0] = -0.0009, -0.0011
        found = read(text_of(ANGLES, values))
        assert found.radiance_factor[4, 0] == -0.0009
        assert found.radiance_factor[5, 0] == pytest.approx(0.01, rel=1e-6)
        assert found.kept.all()
        assert found.warnings == (
            "1 single value is filled from neighbouring bands (1 negative): the first at 390 nm, "
            + ", ".join(f"{x:g}" for x in ANGLES[5]) + " deg",
            "1 reading down to -0.0009 is kept as noise about zero",
        )  # fmt: skip

    @pytest.mark.parametrize("fault", [np.nan, -0.4, 25.0, 0.0])
    def test_one_bad_value_drops_none_of_thirty_good_ones(self, read, fault):
        bands = np.arange(400.0, 701.0, 10.0)
        # An ink's edge: the spectrum grows eightfold within 60 nm.
        right = 0.05 + 0.4 / (1.0 + np.exp(-(bands - 570.0) / 12.0))
        values = np.tile(right, (20, 1)) * np.linspace(0.9, 1.1, 20)[:, None]
        values[3] += 1.0  # a highlight is white
        expected = read(text_of(ANGLES, values, bands=bands))
        assert expected.warnings == ()
        for row, band in ((7, 17), (3, 17), (12, 0)):
            values[row, band] = fault
        found = read(text_of(ANGLES, values, bands=bands))
        assert found.kept.all()
        np.testing.assert_allclose(found.radiance_factor, expected.radiance_factor, rtol=0.08)
        assert "3 single values are filled" in found.warnings[0]

    def test_too_many_bad_values_leave_the_sample_out(self, read):
        values = flat(20)
        values[4, :3] = np.nan
        assert read(text_of(ANGLES, values)).left_out() == {"missing": 1}

    def test_negative_channels_of_srgb_are_colours_and_stay(self, read):
        text = text_of(ANGLES, flat(20)[:, :3] * [-0.001, 1, 1], bands=(1, 2, 3))
        text = text.replace(",1,2,3\n", ",R,G,B\n")
        found = read(text + "0,0,30,0,0.3,0.3,0.3\n")
        assert found.bands.is_rgb
        assert found.left_out() == {"negative": 20}

    def test_two_bands_always_stay(self):
        nothing = np.full((20, 3), -1.0)
        out, dark = screening.unusable_bands(
            nothing, np.full(20, True), Bands((390.0, 550.0, 650.0))
        )
        assert not out.any()
        assert not dark.any()


def test_too_few_geometries_are_good_for_a_colour(read):
    from relgloss_view import fit_material

    spectrum = read(text_of(np.array([(45.0, 0.0, 0.0, 0.0)]), flat(1)))
    with pytest.raises(
        InputError, match=r"1 usable sample of 1; .*colour.*estimate.*12 geometries"
    ):
        fit_material(spectrum)
