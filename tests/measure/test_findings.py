"""What a table shows by itself: each fault is named, and sound tables are left alone."""

from __future__ import annotations

import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from sampled import BODY, directions, factors, gcms, in_plane, measured, noisy, rings, sample

from relgloss_view.base.errors import InputError
from relgloss_view.base.terminal import WARNING_LENGTH
from relgloss_view.bench.verdicts import judging
from relgloss_view.bench.verdicts.faults import BY_NAME
from relgloss_view.bench.verdicts.reflection import Body, Surface, metal_index
from relgloss_view.measure import table
from relgloss_view.measure.bands import Bands
from relgloss_view.measure.findings import examine
from relgloss_view.measure.readers import read_measurement
from relgloss_view.measure.readers.gcms import write_gcms_csv

GRIDS = [in_plane, gcms, rings]


def kinds(measurement):
    return {f.kind for f in examine(measurement).findings}


def the_text(measurement, kind, serious=None):
    """The only text about a kind; asserts that it is there."""
    texts = [f for f in examine(measurement).findings if f.kind == kind]
    assert len(texts) == 1, examine(measurement).findings
    if serious is not None:
        assert texts[0].serious is serious
    assert "\n" not in texts[0].text
    assert len(texts[0].text) <= WARNING_LENGTH  # what the terminal prints of it
    return texts[0].text


def with_values(measurement, change):
    return replace(measurement, radiance_factor=change(measurement.radiance_factor.copy()))


@pytest.mark.parametrize("grid", GRIDS)
@pytest.mark.parametrize("s_deg", [1.5, 3.0, 8.0, 15.0])
@pytest.mark.parametrize("seed", range(3))
def test_nothing_is_found_in_a_sound_table(grid, s_deg, seed):
    strength = (1.0, 0.3, 0.7)[seed]
    assert examine(sample(grid, seed, s_deg=s_deg, strength=strength)).findings == ()


@pytest.mark.parametrize("grid", GRIDS)
def test_nothing_is_found_in_a_matte_sample(grid):
    angles = grid()
    i, o = directions(angles)
    rough = Body(BODY, 0.35)
    first, second = rough.mean(i, o)
    values = np.pi * (first[:, None] * BODY + second[:, None] * BODY**2)
    for seed in range(4):
        assert examine(measured(angles, noisy(values, angles[:, 0], seed))).findings == ()


class TestMirrorDirection:
    @pytest.mark.parametrize("grid", GRIDS)
    @pytest.mark.parametrize("s_deg", [1.0, 3.0, 10.0])
    def test_the_other_side_is_named_with_its_option(self, grid, s_deg):
        text = the_text(sample(grid, s_deg=s_deg, flip=True), "mirror direction", serious=True)
        assert "--mirror same-side" in text
        assert "mirror: same-side" in text
        assert ("beta = +alpha" in text) == (grid is gcms)

    @pytest.mark.parametrize("s_deg", [0.6, 1.0])
    def test_a_narrow_highlight_in_a_few_rows_of_a_coarse_grid(self, s_deg):
        def coarse():
            polar = [(t, p) for t in range(0, 76, 10) for p in range(0, 360, 15)]
            return np.array([(i, 0.0, t, p) for i in (15, 30, 45, 60) for t, p in polar], float)

        flipped = sample(coarse, s_deg=s_deg, flip=True)
        assert "--mirror same-side" in the_text(flipped, "mirror direction", serious=True)
        assert kinds(sample(coarse, s_deg=s_deg)) == set()

    def test_rows_between_the_arms_are_not_passed_over(self):
        flipped = sample(gcms, flip=True)
        assert flipped.left_out()[table.OCCLUDED] > 100
        assert kinds(flipped) == {"mirror direction"}

    @pytest.mark.parametrize("turn", [45.0, 90.0, -60.0])
    def test_another_azimuth_is_named(self, turn):
        angles = rings()
        i, o = directions(angles)
        recorded = angles - np.array([0.0, 0.0, 0.0, turn])
        text = the_text(
            measured(recorded, noisy(factors(i, o), angles[:, 0])), "mirror direction", serious=True
        )
        assert f"add {turn:+.0f} to every phi_r_deg" in text

    def test_another_tilt_is_serious(self):
        text = the_text(sample(gcms, gamma_s=5.0), "mirror direction", serious=True)
        assert "--gamma-s-deg 5" in text

    def test_a_tilt_between_two_of_the_table_is_not_another(self):
        assert kinds(sample(gcms, gamma_s=16.0)) == set()

    def test_one_wrong_tilt_alone_shows_by_the_width_of_the_lobe(self):
        def scan():
            return np.array(
                [(-a, b, 15.0) for a in (20, 40, 60) for b in range(a - 20, a + 18)], dtype=float
            )

        wrong = sample(scan, gamma_s=15.0, declared_gamma_s=0.0)
        assert "--gamma-s-deg 15" in the_text(wrong, "coverage", serious=True)
        assert kinds(sample(scan)) == set()


class TestMirrorOption:
    @staticmethod
    def write(path, comments=None):
        angles = gcms()
        i, o = directions(angles)
        recorded = angles * np.array([1.0, -1.0, 1.0])
        write_gcms_csv(
            path, name="card", source="synthetic", quantity="radiance-factor", gamma_s_deg=15.0,
            angles_deg=recorded, wavelengths_nm=(450, 500, 550, 600, 650), values=factors(i, o),
            comments=comments,
        )  # fmt: skip
        return i, o

    def test_the_option_reads_the_table_right(self, tmp_path):
        i, o = self.write(tmp_path / "t.csv")
        read = read_measurement(tmp_path / "t.csv", mirror="same-side")
        assert np.allclose(read.to_lamp, i)
        assert np.allclose(read.to_receiver, o)
        assert examine(read).findings == ()
        plain = read_measurement(tmp_path / "t.csv")
        assert not np.allclose(plain.to_receiver, o)
        assert kinds(plain) == {"mirror direction"}

    def test_the_line_of_the_file_does_the_same_and_the_option_replaces_it(self, tmp_path):
        _, o = self.write(tmp_path / "t.csv", {"mirror": "Same side"})
        assert np.allclose(read_measurement(tmp_path / "t.csv").to_receiver, o)
        other = read_measurement(tmp_path / "t.csv", mirror="opposite")
        assert not np.allclose(other.to_receiver, o)

    def test_generic_tables_turn_their_azimuth(self, tmp_path):
        file = tmp_path / "t.csv"
        file.write_text(
            "# quantity: radiance-factor\n# mirror: same-side\n"
            "theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,450,550\n30,0,30,0,2,2\n30,0,0,0,1,1\n"
        )
        read = read_measurement(file)
        half = read.to_lamp[0] + read.to_receiver[0]
        assert np.allclose(half[:2], 0.0)

    def test_a_wrong_word_is_one_line(self, tmp_path):
        self.write(tmp_path / "t.csv", {"mirror": "left"})
        with pytest.raises(InputError, match=r"line \d+: 'left'; expected same-side or opposite"):
            read_measurement(tmp_path / "t.csv")


class TestPlateaus:
    def test_rows_on_a_plateau_are_named_and_left_out(self):
        sound = sample(in_plane)
        level = 0.3 * sound.radiance_factor.max()
        clipped = with_values(sound, lambda v: np.minimum(v, level))
        examined = examine(clipped)
        assert [f.kind for f in examined.findings] == ["plateau"]
        assert f"largest value {level:.6g} (as radiance factor)" in examined.findings[0].text
        assert "'# saturation: LEVEL'" in examined.findings[0].text
        above = (sound.radiance_factor >= level).any(axis=1)
        assert np.array_equal(examined.measurement.reasons == table.SATURATED, above)

    def test_a_single_band_is_named(self):
        def one(values):
            values[:, 2] = np.minimum(values[:, 2], 0.4 * values[:, 2].max())
            return values

        text = the_text(with_values(sample(in_plane), one), "plateau")
        assert " in 550 nm (as" in text
        assert "450" not in text

    def test_a_plateau_in_another_quantity_is_found(self):
        """A detector that ends at a value of f_r cos: radiance factors differ along its plateau."""
        sound = sample(in_plane)
        cosine = sound.to_receiver[:, 2:]
        level = 0.4 * (sound.radiance_factor * cosine).max()
        spoiled = with_values(sound, lambda v: np.minimum(v * cosine, level) / cosine)
        assert "plateau" in kinds(spoiled)

    def test_a_plateau_with_a_little_noise_is_found(self):
        sound = sample(in_plane)
        level = 0.2 * sound.radiance_factor.max()
        jitter = 1.0 + 1e-3 * np.random.default_rng(0).standard_normal(sound.radiance_factor.shape)
        clipped = with_values(sound, lambda v: np.where(v > level, level * jitter, v))
        assert "plateau" in kinds(clipped)

    @pytest.mark.parametrize("digits", [2, 3])
    @pytest.mark.parametrize("grid", GRIDS)
    def test_few_digits_are_no_plateau(self, grid, digits):
        def rounded(values):
            return np.array([float(f"{v:.{digits}g}") for v in values.ravel()]).reshape(
                values.shape
            )

        for seed in range(4):
            assert "plateau" not in kinds(with_values(sample(grid, seed), rounded))
            matte = sample(grid, seed, strength=0.0)
            assert not kinds(with_values(matte, rounded)) & {"plateau", "floor"}

    def test_a_computed_table_without_noise_has_none(self):
        for grid in GRIDS:
            assert not kinds(sample(grid, noise=False)) & {"plateau", "floor"}
            assert not kinds(sample(grid, noise=False, strength=0.0)) & {"plateau", "floor"}

    def test_one_geometry_read_again_and_again_is_none(self):
        angles = np.array([(0.0, 0.0, t, p) for t in range(0, 60, 6) for p in range(0, 360, 30)])
        i, o = directions(angles)
        assert "plateau" not in kinds(measured(angles, factors(i, o)))

    def test_a_floor_is_named(self):
        floor = 0.25
        with_floor = with_values(sample(in_plane, body=BODY / 3), lambda v: np.maximum(v, 0.1))
        text = the_text(with_floor, "floor", serious=False)
        assert "smallest value 0.1 in 450 nm" in text
        assert kinds(sample(in_plane, body=BODY / 3)) == set()
        assert floor


class TestLampPeak:
    @staticmethod
    def retro(height, sd_deg=5.0, grid=in_plane):
        sound = sample(grid)
        apart = np.degrees(np.arccos(np.clip((sound.to_lamp * sound.to_receiver).sum(1), -1, 1)))
        peak = height * np.exp(-0.5 * (apart / sd_deg) ** 2)
        return with_values(sound, lambda v: v + peak[:, None])

    @pytest.mark.parametrize("grid", [in_plane, gcms])
    def test_a_peak_towards_the_lamp_is_named(self, grid):
        assert "back to the lamp" in the_text(self.retro(1.5, grid=grid), "peak towards the lamp")

    def test_a_rough_body_is_not(self):
        """Oren and Nayar's brightening is no peak: see test_nothing_is_found_in_a_matte_sample."""
        assert kinds(self.retro(0.0)) == set()
        assert kinds(self.retro(0.02)) == set()


class TestUnits:
    def test_radians(self):
        angles = rings()
        i, o = directions(angles)
        text = the_text(measured(np.radians(angles), factors(i, o)), "units", serious=True)
        assert "radians" in text

    def test_percent(self):
        wrong = with_values(sample(rings), lambda v: 100.0 * v)
        assert "percent" in the_text(wrong, "units", serious=True)

    def test_a_factor_of_pi(self):
        white = np.array([0.8, 0.82, 0.85, 0.85, 0.86])
        wrong = with_values(sample(rings, body=white), lambda v: np.pi * v / 1.6)
        assert "factor of pi" in the_text(wrong, "units", serious=True)
        fluorescent = np.array([1.25, 0.9, 0.85, 0.85, 0.86])
        assert kinds(sample(rings, body=fluorescent)) == set()

    @pytest.mark.parametrize("grid", GRIDS)
    @pytest.mark.parametrize("power", [1.0, -1.0])
    def test_a_cosine_left_in_or_divided_out_twice(self, grid, power):
        sound = sample(grid)
        wrong = with_values(sound, lambda v: v * sound.to_receiver[:, 2:] ** power)
        text = the_text(wrong, "units", serious=True)
        assert ("--quantity brdf-cos" in text) == (power > 0)


class TestDrift:
    def test_a_lamp_that_fades_is_named(self):
        def fading(values):
            return values * np.linspace(1.0, 0.7, len(values))[:, None]

        assert "lamp drifts" in the_text(with_values(sample(gcms), fading), "drift", serious=True)
        # The rows of a matrix are in the order of their angles, which shows no time.
        of_a_matrix = replace(with_values(sample(gcms), fading), in_time_order=False)
        assert "drift" not in kinds(of_a_matrix)

    def test_noise_of_the_planes_is_no_drift(self):
        angles = in_plane()
        i, o = directions(angles)
        named = [
            "drift" in kinds(measured(angles, noisy(factors(i, o), angles[:, 0], seed)))
            for seed in range(60)
        ]
        assert sum(named) == 0


class TestBands:
    NM = tuple(range(400, 730, 10))

    def table(self, change=lambda values: values):
        wavelengths = np.array(self.NM, dtype=float)
        ink = 0.05 + 0.6 * np.exp(-(((wavelengths - 530.0) / 60.0) ** 2))
        angles = gcms()
        i, o = directions(angles)
        lobe = factors(i, o)
        values = ink + (lobe - lobe.min(axis=1, keepdims=True))[:, :1] + 0.0 * lobe[:, :1]
        values = noisy(np.broadcast_to(values, (len(angles), len(ink))).copy(), angles[:, 0])
        return measured(angles, change(values), bands=self.NM)

    def test_a_dead_band_is_left_out_and_named(self):
        def dead(values):
            values[:, self.NM.index(540)] = 1e-4
            return values

        found = examine(self.table(dead))
        assert found.measurement.bands.count == len(self.NM) - 1
        assert 540.0 not in found.measurement.bands.wavelengths_nm
        (finding,) = [f for f in found.findings if f.kind == "bands"]
        assert "540 nm" in finding.text
        assert not finding.serious  # its neighbours are 20 nm apart
        sound = examine(self.table())  # control
        assert sound.measurement.bands.count == len(self.NM)
        assert not [f for f in sound.findings if f.kind == "bands"]

    def test_a_dead_band_that_leaves_colour_open_is_serious(self):
        def dead(values):
            values[:, :4] = 1e-4  # 400 to 430 nm
            return values

        found = examine(self.table(dead))
        assert any(f.kind == "bands" and f.serious for f in found.findings)

    def test_swapped_bands_are_named(self):
        def swapped(values):
            pair = [self.NM.index(440), self.NM.index(540)]
            values[:, pair] = values[:, pair[::-1]]
            return values

        found = examine(self.table(swapped))
        (finding,) = [f for f in found.findings if f.kind == "bands"]
        assert finding.serious
        assert "440 nm" in finding.text
        assert "540 nm" in finding.text


class TestLobe:
    def test_a_full_angle_as_deviation(self):
        narrow = sample(rings, s_deg=1.0, aperture=(0.3, 0.3))
        assert kinds(narrow) == set()
        text = the_text(replace(narrow, aperture_sd_deg=(2.0, 2.0)), "aperture", serious=True)
        assert "Divide it by 4 (disc: diameter / 4;" in text

    def test_the_rule_from_a_solid_angle(self):
        """A cone of half angle r has 2 pi (1 - cos r) steradians; its disc deviates by r / 2."""
        half_deg = 0.8
        omega = 2.0 * np.pi * (1.0 - np.cos(np.radians(half_deg)))
        diameter = 2.0 * np.degrees(np.arccos(1.0 - omega / (2.0 * np.pi)))
        assert diameter / 4.0 == pytest.approx(half_deg / 2.0)
        radius = np.sqrt(np.random.default_rng(0).uniform(size=200_000)) * half_deg
        turn = np.random.default_rng(1).uniform(0.0, 2.0 * np.pi, 200_000)
        assert np.std(radius * np.cos(turn)) == pytest.approx(diameter / 4.0, rel=0.01)

    def test_no_aperture_and_a_lobe_as_narrow_as_instruments(self):
        deltas = (0, 0.1, 0.2, 0.35, 0.5, 0.8, 1.5, 4, 9, 20, 30, 42)

        def fine():
            return rings(deltas=deltas)

        text = the_text(sample(fine, s_deg=0.4, aperture=(0.0, 0.0)), "aperture", serious=False)
        assert "aperture_sd_deg" in text
        assert kinds(sample(fine, s_deg=3.0, aperture=(0.0, 0.0))) == set()

    @pytest.mark.parametrize("azimuth_deg", [0.0, 30.0, 90.0])
    def test_anisotropy_is_named_with_both_widths(self, azimuth_deg):
        brushed = sample(rings, s_deg=np.sqrt(12.0), ratio=3.0, azimuth_deg=azimuth_deg)
        text = the_text(brushed, "anisotropy", serious=True)
        wide, narrow = (float(x) for x in (text.split(" deg wide")[0].split()[-1],
                                           text.split(" deg across")[0].split()[-1]))  # fmt: skip
        assert wide == pytest.approx(6.0, rel=0.15)
        assert narrow == pytest.approx(2.0, rel=0.15)
        towards = float(text.split("azimuth ")[1].split()[0])
        assert abs((towards - azimuth_deg + 90.0) % 180.0 - 90.0) < 8.0

    def test_a_little_anisotropy_is_not(self):
        assert kinds(sample(rings, ratio=1.08)) == set()

    def test_one_azimuth_shows_none(self):
        assert kinds(sample(in_plane, s_deg=np.sqrt(12.0), ratio=3.0)) == set()

    def test_a_table_without_mirror_directions(self):
        wide = sample(rings, s_deg=6.0)
        half = wide.to_lamp + wide.to_receiver
        delta = np.degrees(np.arccos(np.clip(half[:, 2] / np.linalg.norm(half, axis=1), -1, 1)))
        for least, serious in ((3.5, False), (25.0, True)):
            rows = delta > least
            part = replace(
                wide, to_lamp=wide.to_lamp[rows], to_receiver=wide.to_receiver[rows],
                radiance_factor=wide.radiance_factor[rows], reasons=wide.reasons[rows],
                group=wide.group[rows],
            )  # fmt: skip
            text = the_text(part, "coverage", serious)
            assert ("flanks alone" in text) is not serious


class TestColour:
    NM = np.linspace(400.0, 700.0, 7)

    def coloured(self, surface, grid=in_plane, body=0.04):
        return sample(
            grid, s_deg=3.0, body=np.full(7, body), bands=self.NM, strength=1.0,
            colour=lambda cos_d: surface.reflectance(cos_d) / 0.04,
        )  # fmt: skip

    @pytest.mark.parametrize("grid", [in_plane, rings])
    def test_a_film_is_named_with_its_angle(self, grid):
        film = Surface(np.full(7, 1.5), 2.3, 330.0, self.NM)
        text = the_text(self.coloured(film, grid), "colour", serious=True)
        angle = float(text.split("colour near ")[1].split()[0])
        assert 30.0 < angle < 80.0

    @pytest.mark.parametrize("metal", ["gold", "copper"])
    def test_a_metal_that_whitens_is_not(self, metal):
        assert kinds(self.coloured(Surface(metal_index(metal, self.NM)))) == set()

    def test_a_white_highlight_is_not(self):
        assert kinds(self.coloured(Surface(1.5 + 4e-3 * (1e6 / self.NM**2 - 3.3)))) == set()

    def test_a_body_that_turns_is_named(self):
        sound = sample(rings, bands=(450, 500, 550, 600, 650))
        lean = 1.0 - sound.to_receiver[:, 2:]
        turned = with_values(
            sound, lambda v: v * (1.0 + lean * np.array([3.0, 1.0, 0, -0.5, -0.9]))
        )
        assert "colour" in kinds(turned)


class TestSingleRows:
    def test_spikes_are_named(self):
        def dusty(values):
            values[::40] *= 4.0
            return values

        assert "spikes" in the_text(with_values(sample(gcms), dusty), "rows")

    def test_rows_of_another_sample_are_named(self):
        sound, other = sample(gcms), sample(gcms, body=BODY[::-1] * 0.5, seed=1)
        mixed = with_values(sound, lambda v: np.where(
            np.random.default_rng(3).uniform(size=len(v))[:, None] < 0.2, other.radiance_factor, v
        ))  # fmt: skip
        assert "two samples" in the_text(mixed, "rows", serious=True)


def test_rgb_tables_are_examined_too():
    angles = in_plane()
    i, o = directions(angles)
    body = np.array([0.3, 0.4, 0.2])
    values = noisy(factors(i, o, body=body), angles[:, 0])
    three = measured(angles, values, bands=(450.0, 550.0, 650.0))
    assert examine(replace(three, bands=Bands())).findings == ()
    flipped = measured(angles, values, bands=(450.0, 550.0, 650.0), flip=True)
    assert kinds(replace(flipped, bands=Bands())) == {"mirror direction"}


@pytest.mark.parametrize("count", [1, 2, 5, 12])
def test_a_few_rows_are_no_trouble(count):
    whole = sample(in_plane)
    few = replace(
        whole, to_lamp=whole.to_lamp[:count], to_receiver=whole.to_receiver[:count],
        radiance_factor=whole.radiance_factor[:count], reasons=whole.reasons[:count],
        group=whole.group[:count],
    )  # fmt: skip
    assert "mirror direction" not in kinds(few)


@pytest.mark.slow
def test_false_alarms_and_misses_over_made_tables():
    """Tables of the bench, whose samples have other lobes, apertures and noise than those here."""
    alarms = [(k, f.text) for k in range(120) for f in examine(made(21, judging.SOUND, k)).findings]
    assert len(alarms) <= 1, alarms
    for kind, finding, least in (
        ("mirror at the other side", "mirror direction", 18),
        ("undeclared saturation", "plateau", 18),
        ("cosine missed", "units", 18),
        ("retroreflection", "peak towards the lamp", 14),
        ("anisotropic", "anisotropy", 12),
        ("interference colour", "colour", 12),
        ("full angle as deviation", "aperture", 12),
    ):
        named = sum(finding in kinds(made(21, kind, k)) for k in range(20))
        assert named >= least, (kind, named)


def made(seed, kind, index):
    """A table of the bench as a measurement."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "table.csv"
        judging.table_of(seed, kind, index, BY_NAME.get(kind)).write(file)
        return read_measurement(file)
