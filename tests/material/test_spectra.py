"""Bands x illuminant -> XYZ against colour-science."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest

from relgloss_view.base.errors import InputError
from relgloss_view.material import lamp_names, spectra
from relgloss_view.material.material import Diffuse, Lobe, Material
from relgloss_view.measure.bands import REC2020, RGB, SRGB, WIDE_RGB, Bands
from relgloss_view.measure.readers import tristimulus
from relgloss_view.picture.scene.scene_file import load_scene

colour = pytest.importorskip("colour")

OBSERVER = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"]
BANDS = Bands(tuple(float(w) for w in range(390, 731, 10)))


def as_illuminant(distribution):
    return spectra.Illuminant(
        "test",
        tuple(float(w) for w in distribution.wavelengths),
        tuple(float(p) for p in distribution.values),
    )


def iso_17321_patch(name):
    patch = colour.SDS_COLOURCHECKERS["ISO 17321-1"][name]
    return patch.copy().align(colour.SpectralShape(380, 780, 5))


def lamp_table(power):
    return "".join(f"{w} {power(w)!r}\n" for w in range(370, 791, 5))


def write_lamp(path, power=lambda w: 1.0):
    path.write_text(lamp_table(power))


@pytest.mark.parametrize("interval", [5, 10])
def test_weights_are_astm_e2022(interval):
    lamp = colour.sd_CIE_standard_illuminant_A(OBSERVER.shape)
    shape = colour.SpectralShape(360, 830, interval)
    expected = colour.colorimetry.tristimulus_weighting_factors_ASTME2022(OBSERVER, lamp, shape)
    bands = Bands(tuple(float(w) for w in shape.wavelengths))
    weights = 100 * spectra.xyz_weights(bands, as_illuminant(lamp))
    np.testing.assert_allclose(weights, expected, atol=1e-10)


def test_weights_sum_to_white():
    lamp = spectra.illuminant("HP5")
    white = lamp.white_xyz()
    assert white[1] == pytest.approx(1.0, abs=1e-14)
    np.testing.assert_allclose(spectra.xyz_weights(BANDS, lamp).sum(axis=0), white, atol=1e-12)
    np.testing.assert_allclose(spectra.xyz_weights(RGB, lamp).sum(axis=0), white, atol=1e-12)


@pytest.mark.parametrize("name", ["HP5", "D65", "D50", "A", "C"])
def test_shipped_lamp_is_colour_sciences(name):
    assert name in spectra.SHIPPED_ILLUMINANTS
    ours, theirs = spectra.illuminant(name), colour.SDS_ILLUMINANTS[name]
    np.testing.assert_array_equal(ours.wavelengths_nm, theirs.wavelengths)
    np.testing.assert_array_equal(ours.power, theirs.values)


def test_the_usual_lamps_do_not_import_colour_science(tmp_path):
    """It takes longer than a picture does."""
    write_lamp(tmp_path / "lamp.csv")
    code = (
        "import sys; from relgloss_view.material.spectra import illuminant as i; "
        "[i(n).white_xyz() for n in sys.argv[1:]]; assert 'colour' not in sys.modules"
    )
    names = [*spectra.SHIPPED_ILLUMINANTS, str(tmp_path / "lamp.csv")]
    subprocess.run([sys.executable, "-c", code, *names], check=True)


@pytest.mark.slow
def test_other_lamps_do_not_import_colour_science_either(tmp_path):
    """It takes 130 MB for good; another process reads its tables. FL2 has a colour of CIE 15."""
    code = (
        "import sys; from relgloss_view.material import lamp_names, spectra; "
        "assert lamp_names.lamp_table('fl2') is lamp_names.lamp_table('FL2') is not None; "
        "assert lamp_names.lamp_table('no such lamp') is None; "
        "x, y, z = spectra.illuminant('FL2').white_xyz(); print(x / (x + y + z), y / (x + y + z)); "
        "assert not {'colour', 'scipy', 'matplotlib'} & set(sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    x, y = (float(word) for word in done.stdout.split())
    assert (x, y) == (pytest.approx(0.3721, abs=3e-4), pytest.approx(0.3751, abs=3e-4))


def test_lamps_by_name_are_colour_sciences():
    for lamps in (colour.SDS_LIGHT_SOURCES, colour.SDS_ILLUMINANTS):
        for name in lamps:
            if name in colour.SDS_ILLUMINANTS:  # which come before light sources
                lamps = colour.SDS_ILLUMINANTS
            wavelengths_nm, power = lamp_names.lamp_table(name)
            np.testing.assert_array_equal(wavelengths_nm, lamps[name].wavelengths)
            np.testing.assert_array_equal(power, lamps[name].values)


def test_no_ending_of_a_lamp_file_is_in_a_lamps_name():
    for name in [*colour.SDS_ILLUMINANTS, *colour.SDS_LIGHT_SOURCES]:
        assert not name.lower().endswith(spectra.LAMP_SUFFIXES)
        assert spectra.is_lamp_name(name)
        assert np.all(spectra.illuminant(name).white_xyz() > 0.0)


@pytest.mark.parametrize("lamp_name", ["HP3", "HP4", "HP5", "D50"])
@pytest.mark.parametrize("patch_name", ["green", "blue flower", "neutral 8 (.23 D)"])
def test_ten_nanometre_bands_under_a_discharge_lamp(lamp_name, patch_name):
    """Patches known at 5 nm, seen through 10 nm bands: within 0.05 dE2000 of the 5 nm sum.

    The lamps' lines are summed at 5 nm in both; what is left is the interpolation of a smooth
    reflectance. Sampling the lamp at the bands instead fails by far (next test).
    """
    reference, ours = _both(lamp_name, patch_name, sample_lamp_at_bands=False)
    assert colour.delta_E(reference, ours, method="CIE 2000") < 0.05


def test_point_sampled_lamp_fails():
    reference, wrong = _both("HP4", "green", sample_lamp_at_bands=True)
    assert colour.delta_E(reference, wrong, method="CIE 2000") > 1.0


def _both(lamp_name, patch_name, sample_lamp_at_bands):
    names = list(colour.SDS_COLOURCHECKERS["ISO 17321-1"])
    assert patch_name in names, names
    patch = iso_17321_patch(patch_name)
    table = colour.SDS_ILLUMINANTS[lamp_name].copy().align(colour.SpectralShape(380, 780, 5))
    observer = OBSERVER.copy().align(colour.SpectralShape(380, 780, 5))
    xyz = colour.sd_to_XYZ(patch, observer, table, method="Integration") / 100
    white = colour.sd_to_XYZ(colour.sd_ones(table.shape), observer, table, method="Integration")
    lab = colour.XYZ_to_Lab(xyz, colour.XYZ_to_xy(white / 100))
    lamp = as_illuminant(table)
    if sample_lamp_at_bands:
        keep = np.isin(table.wavelengths, BANDS.centres_nm())
        lamp = spectra.Illuminant(
            "sampled",
            tuple(float(w) for w in table.wavelengths[keep]),
            tuple(float(p) for p in table.values[keep]),
        )
    values = np.array([patch[w] for w in BANDS.centres_nm()])
    ours = values @ spectra.xyz_weights(BANDS, lamp)
    return lab, colour.XYZ_to_Lab(ours, colour.XYZ_to_xy(lamp.white_xyz()))


def test_lagrange_reproduces_cubics_on_irregular_bands():
    centres = np.array([400.0, 415.0, 440.0, 480.0, 500.0, 560.0, 610.0, 700.0])
    grid = np.arange(415.0, 610.0)
    cubic = np.polynomial.Polynomial([3.0, -2e-2, 5e-5, -4e-8])
    matrix = spectra.lagrange_matrix(centres, grid)
    np.testing.assert_allclose(matrix @ cubic(centres), cubic(grid), rtol=1e-10)


def test_srgb_matrix_and_primaries():
    matrix = spectra.rgb_to_xyz_matrix(spectra.SRGB_PRIMARIES_XY, spectra.D65_XY)
    # IEC 61966-2-1 prints four digits of the matrix.
    np.testing.assert_allclose(
        matrix, colour.models.RGB_COLOURSPACE_sRGB.matrix_RGB_to_XYZ, atol=2e-4
    )


def test_readers_and_pictures_have_one_srgb_and_one_rec2020():
    # measure/ is below material/, so the readers have the published digits of their own.
    to_xyz = {name: spectra.rgb_to_xyz_matrix(xy, spectra.D65_XY)
              for name, xy in spectra.PRIMARIES_XY.items()}  # fmt: skip
    # The digits of IEC 61966-2-1 are those of the inverse of a matrix of four digits.
    np.testing.assert_allclose(tristimulus.SRGB_FROM_XYZ @ to_xyz[SRGB], np.eye(3), atol=5e-4)
    wide = np.linalg.solve(to_xyz[REC2020], to_xyz[SRGB])
    np.testing.assert_allclose(tristimulus.REC2020_FROM_SRGB, wide, atol=5e-5)
    np.testing.assert_allclose(tristimulus.LUMINANCE, to_xyz[SRGB][1], atol=5e-5)


def test_other_lamps_by_name_and_by_file(tmp_path):
    a = spectra.illuminant("A").white_xyz()
    xy = a[:2] / a.sum()
    np.testing.assert_allclose(xy, (0.44758, 0.40745), atol=2e-4)  # CIE 15
    file = tmp_path / "lamp.txt"
    file.write_text("nm\tpower\n" + "".join(f"{w}\t1\n" for w in range(380, 781, 5)))
    white = spectra.illuminant(str(file)).white_xyz()
    np.testing.assert_allclose(white[:2] / white.sum(), (1 / 3, 1 / 3), atol=2e-4)


@pytest.mark.parametrize(
    "content",
    [
        "",
        "380 1\n390 nan\n",
        "380 1\n370 1\n",
        "500 1\n510 1\n",
        "380 1\n480 1\n780 1\n",
        "1 2 3\n",
        lamp_table(lambda w: 1e308),
        lamp_table(lambda w: float(w > 660)),
        lamp_table(lambda w: -1.0),
    ],
)
def test_bad_lamp_files(tmp_path, content):
    file = tmp_path / "lamp.csv"
    file.write_text(content)
    with pytest.raises(InputError, match=r"lamp\.csv"):
        spectra.illuminant(str(file))


def test_unknown_lamp_is_one_short_line():
    for name in ("no such lamp", "x" * 200):
        with pytest.raises(InputError, match=r"neither a name .* such as D65") as caught:
            spectra.illuminant(name)
        assert len(str(caught.value)) < 300


def test_a_name_wins_over_a_file_and_an_edited_file_is_read_again(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name in ("D50", "FL2"):
        expected = spectra.illuminant(name)
        write_lamp(tmp_path / name)
        assert spectra.illuminant(name) == expected
    path = tmp_path / "lamp"
    write_lamp(path)
    first = spectra.illuminant("lamp").white_xyz()
    write_lamp(path, lambda w: float(w))
    assert np.abs(spectra.illuminant("lamp").white_xyz() - first).max() > 0.01


def test_a_lamp_beside_its_scene_file(tmp_path, monkeypatch):
    folder = tmp_path / "project"
    folder.mkdir()
    write_lamp(folder / "lamp.csv")
    scene = folder / "scene.toml"
    scene.write_text('[lamp]\nilluminant = "lamp.csv"\n')
    monkeypatch.chdir(tmp_path)
    lamp = load_scene(scene)[0].lamp
    np.testing.assert_allclose(
        spectra.illuminant(lamp.illuminant).white_xyz(),
        spectra.illuminant(str(folder / "lamp.csv")).white_xyz(),
    )
    for name in ("D50", "FL2"):
        scene.write_text(f'[lamp]\nilluminant = "{name}"\n')
        assert load_scene(scene)[0].lamp.illuminant == name
    for name in ("gone.csv", "no such lamp"):
        scene.write_text(f'[lamp]\nilluminant = "{name}"\n')
        with pytest.raises(InputError, match=r"scene\.toml: .*") as caught:
            load_scene(scene)
        assert name in str(caught.value)


def rows_of(first, last, step=5.0, power=lambda w: 1.0):
    """Text of a lamp file from one wavelength to another."""
    count = round((last - first) / step)
    return "".join(f"{w:g},{power(w):g}\n" for w in first + step * np.arange(count + 1))


@pytest.mark.parametrize(
    ("text", "accepted"),
    [
        (rows_of(400, 700), True),
        (rows_of(400, 700, 10), True),
        (rows_of(401, 701, 5), False),  # the blue end is missing
        (rows_of(399, 699, 5), False),  # the red end
        (rows_of(400, 700, 10) + "710.5,1\n", False),  # a step of more than 10 nm
        (rows_of(380, 780, power=lambda w: 0.0), False),
        (rows_of(380, 780, power=lambda w: float(440 <= w <= 460 or 540 <= w <= 660)), True),
        ("# a comment\n\nnm;power\n" + rows_of(400, 700).replace(",", " ; ") + "\n# end\n", True),
    ],
)
def test_what_a_lamp_file_must_hold(tmp_path, text, accepted):
    """The limits are those that the message names: 400 to 700 nm, in steps of at most 10 nm."""
    (tmp_path / "lamp.csv").write_text(text)
    if accepted:
        assert spectra.illuminant(str(tmp_path / "lamp.csv")).white_xyz()[1] == pytest.approx(1.0)
    else:
        with pytest.raises(InputError, match=r"400 to 700 nm or wider, in steps of at most 10 nm"):
            spectra.illuminant(str(tmp_path / "lamp.csv"))


def test_power_that_no_eye_sees_changes_no_colour(tmp_path):
    """CIE 1931's observer is given from 360 to 830 nm; outside it nothing is seen."""
    (tmp_path / "plain.csv").write_text(rows_of(360, 830))
    (tmp_path / "wide.csv").write_text(
        rows_of(300, 900, power=lambda w: 1.0 if 360 <= w <= 830 else 1e6)
    )
    plain, wide = (spectra.illuminant(str(tmp_path / f"{n}.csv")) for n in ("plain", "wide"))
    np.testing.assert_allclose(wide.white_xyz(), plain.white_xyz(), rtol=1e-12)


def test_a_lamps_white_is_shared_and_so_not_writable():
    with pytest.raises(ValueError, match="read-only"):
        spectra.illuminant("D65").white_xyz()[1] = 2.0


def test_two_bands_and_one_band_are_interpolated_as_far_as_they_go():
    grid = np.array([390.0, 400.0, 430.0, 500.0, 510.0])
    line = spectra.lagrange_matrix(np.array([400.0, 500.0]), grid)
    np.testing.assert_allclose(line @ [0.2, 0.7], [0.2, 0.2, 0.35, 0.7, 0.7])
    np.testing.assert_array_equal(spectra.lagrange_matrix(np.array([400.0]), grid), 1.0)


UNEVEN = (
    (380.0, 500.0, 501.0, 502.0, 780.0),
    (400.0, 401.0, 700.0),
    (300.0, 440.0, 441.5, 555.0, 556.0, 610.0, 900.0),
    (610.0, 610.5, 700.0),
)


def non_negative_spectra(count, seed):
    """Spectra of lone bands, steps and noise, (N, count), 0 to 4."""
    rng = np.random.default_rng(seed)
    return np.concatenate(
        [np.eye(count), np.tril(np.ones((count, count))), rng.uniform(0.0, 4.0, (20, count))]
    )


@pytest.mark.parametrize("centres", UNEVEN)
@pytest.mark.parametrize("lamp_name", ["HP5", "D65", "A"])
def test_uneven_bands_do_not_overshoot(centres, lamp_name):
    """Every colour lies among those of its bands: none negative, none above the brightest band."""
    lamp = spectra.illuminant(lamp_name)
    weights = spectra.xyz_weights(Bands(centres), lamp)
    assert np.min(weights) >= 0.0
    np.testing.assert_allclose(weights.sum(axis=0), lamp.white_xyz(), atol=1e-12)
    values = non_negative_spectra(len(centres), 1)
    xyz = values @ weights
    assert np.all(xyz <= np.max(values, axis=1)[:, None] * lamp.white_xyz() * (1.0 + 1e-12))


def test_a_polynomial_through_uneven_bands_is_no_light():
    """Control: the cubic through the same bands gives a Y far below zero."""
    lamp = spectra.illuminant("D65")
    grid, weighted = lamp.weighted_observer
    cubic = weighted @ spectra.lagrange_matrix(np.array(UNEVEN[0]), grid)
    assert np.min(cubic[1]) < -10.0


@pytest.mark.parametrize("step", [5.0, 10.0, 20.0, 50.0])
def test_even_bands_are_interpolated_as_before(step):
    """Bit for bit, with the rounding of instruments' wavelengths too: cubic Lagrange."""
    grid = np.arange(360.0, 831.0)
    centres = np.arange(400.0, 701.0, step)
    for places in (centres, np.round(centres / 3.0, 1) * 3.0):
        expected = spectra.lagrange_matrix(places, grid)
        np.testing.assert_array_equal(spectra.interpolation_matrix(places, grid), expected)


def test_a_missing_band_is_bridged_by_a_line():
    centres = np.delete(np.arange(400.0, 701.0, 10.0), 12)  # 520 nm
    grid = np.arange(400.0, 701.0)
    matrix = spectra.interpolation_matrix(centres, grid)
    line = np.interp(grid, centres, np.sin(centres / 30.0))
    cubic = spectra.lagrange_matrix(centres, grid) @ np.sin(centres / 30.0)
    drawn = matrix @ np.sin(centres / 30.0)
    beside = (grid >= 500.0) & (grid <= 540.0)
    np.testing.assert_allclose(drawn[beside], line[beside], rtol=1e-12)
    away = (grid < 500.0) | (grid > 540.0)
    np.testing.assert_array_equal(drawn[away], cubic[away])


@pytest.mark.parametrize("step", [5.0, 10.0, 20.0, 50.0, 100.0])
@pytest.mark.parametrize("lamp_name", ["HP5", "D65", "FL11"])
def test_no_spectrum_folds_to_negative_light(step, lamp_name):
    bands, lamp = Bands(tuple(np.arange(400.0, 701.0, step))), spectra.illuminant(lamp_name)
    plain = spectra.xyz_weights(bands, lamp)
    values = non_negative_spectra(bands.count, 2)
    for one in values:
        weights = spectra.light_weights([one], bands, lamp)
        assert np.all(one @ weights >= 0.0)
        np.testing.assert_allclose(weights.sum(axis=0), lamp.white_xyz(), atol=1e-12)
        if np.all(one @ plain >= 0.0):
            assert weights is plain  # usual spectra keep their bits
    assert np.min(values @ plain) < 0.0 or step < 10.0  # control: there is something to mend


def test_a_materials_spectra_share_their_weights():
    """A lone band in the albedo bends the lobe's spectrum too, and neither is negative."""
    bands, lamp = Bands(tuple(np.arange(400.0, 701.0, 50.0))), spectra.illuminant("D65")
    lone = np.eye(7)[3]
    for albedo, strength in ((lone, np.ones(7)), (np.ones(7), lone)):
        material = Material(
            "lone",
            "synthetic",
            bands,
            Diffuse("eon", tuple(albedo), 20.0),
            (Lobe(tuple(strength), 5.0),),
        )
        weights = material.xyz_weights(lamp)
        for values in (albedo, albedo**2, strength, material.second_albedo()):
            assert np.all(values @ weights >= 0.0)
    assert np.min(lone @ spectra.xyz_weights(bands, lamp)) < 0.0


class TestWideRgb:
    """Linear Rec. 2020, for colours outside sRGB."""

    def test_published_matrices(self):
        # ITU-R BT.2020-2 luminance, and BT.2087-0's matrix from BT.709, as printed.
        weights = spectra.xyz_weights(WIDE_RGB, spectra.illuminant("D65"))
        np.testing.assert_allclose(weights[:, 1], [0.2627, 0.6780, 0.0593], atol=5e-5)
        between = spectra.xyz_weights(RGB, spectra.illuminant("D65")) @ np.linalg.inv(weights)
        printed = [[0.6274, 0.3293, 0.0433], [0.0691, 0.9195, 0.0114], [0.0164, 0.0880, 0.8956]]
        np.testing.assert_allclose(between.T, printed, atol=5e-5)

    @pytest.mark.parametrize("lamp", ["D65", "HP5"])
    def test_white_is_the_lamps(self, lamp):
        white = np.ones(3) @ spectra.xyz_weights(WIDE_RGB, spectra.illuminant(lamp))
        np.testing.assert_allclose(white, spectra.illuminant(lamp).white_xyz(), rtol=1e-12)
        # Negative control: the same numbers in sRGB are another colour.
        red = [1.0, 0.1, 0.1]
        one, other = (
            red @ spectra.xyz_weights(b, spectra.illuminant(lamp)) for b in (RGB, WIDE_RGB)
        )
        assert np.max(np.abs(one - other)) > 0.05
