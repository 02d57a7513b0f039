"""Display files: an exact round trip, overrides, and one line for what is wrong."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from simulated_displays import MATRIX, of, patches, readings, srgb

from relgloss_view.base.errors import InputError
from relgloss_view.display.check import check_display
from relgloss_view.display.display import Display
from relgloss_view.display.display_file import read_display, write_display
from relgloss_view.display.fit import fit_display
from relgloss_view.display.fitted_monitor import SAMPLES, monitor_of_numbers
from relgloss_view.display.icc_writing import srgb_profile
from relgloss_view.display.model import DisplayModel
from relgloss_view.display.monitor import Numbers
from relgloss_view.display.read import monitor_of

ROWS = tuple(tuple(float(v) for v in row) for row in MATRIX / MATRIX[1].sum())
POWER = Numbers("gain-offset-gamma", ROWS, (0.001, 0.002, 0.003), (0.0, 0.1, -0.1), (2.0, 2.2, 2.4))
BENT = tuple(float(v) for v in np.linspace(0.0, 1.0, SAMPLES) ** 1.9)
CURVES = Numbers("curves", ROWS, (0.001, 0.001, 0.001), samples=(BENT, BENT, BENT))
SOME = np.random.default_rng(0).random((50, 3))


@pytest.mark.parametrize("numbers", [POWER, CURVES], ids=lambda n: n.kind)
def test_round_trip_is_exact(numbers, tmp_path):
    monitor = monitor_of_numbers(numbers, "a name", 163.25, True, ("one note",))
    monitor = dataclasses.replace(monitor, reflected_cd_m2=1.5, black_cd_m2=0.25, verdict="good")
    file = tmp_path / "monitor.toml"
    write_display(file, monitor)
    back = read_display(file)
    assert back.fitted == numbers
    for name in ("name", "luminance_cd_m2", "black_cd_m2", "reflected_cd_m2", "black_known"):
        assert getattr(back, name) == getattr(monitor, name)
    assert (back.notes, back.verdict) == (monitor.notes, "good")
    assert np.array_equal(back.xyz(SOME), monitor.xyz(SOME))
    assert monitor_of(str(file)) is monitor_of(str(file))


def test_reflected_light_of_a_file_counts(tmp_path):
    monitor = monitor_of_numbers(CURVES, "a", 100.0, True)
    paths = {}
    for name, light in (("dark", 0.0), ("bright", 25.0)):
        paths[name] = str(tmp_path / f"{name}.toml")
        write_display(paths[name], dataclasses.replace(monitor, reflected_cd_m2=light))
    dark, bright = (DisplayModel.of(Display(profile=paths[n])) for n in ("dark", "bright"))
    same = DisplayModel.of(Display(profile=paths["dark"], reflected_cd_m2=25.0))
    assert bright.luminance_cd_m2 == pytest.approx(125.0)
    np.testing.assert_allclose(bright.floor, same.floor, rtol=1e-12)
    assert np.all(bright.floor > dark.floor + 0.1)


def test_a_profile_beside_the_file(tmp_path):
    (tmp_path / "x.icc").write_bytes(srgb_profile())
    file = tmp_path / "m.toml"
    file.write_text(
        'format = "relgloss-display"\nversion = 1\nname = "mine"\n'
        '[display]\nprofile = "x.icc"\nluminance_cd_m2 = 120.0\nreflected_cd_m2 = 2.0\n'
    )
    monitor = read_display(file)
    assert (monitor.name, monitor.luminance_cd_m2, monitor.reflected_cd_m2) == ("mine", 120.0, 2.0)
    assert monitor.icc == srgb_profile()
    write_display(tmp_path / "n.toml", monitor, profile="x.icc")
    assert np.array_equal(read_display(tmp_path / "n.toml").xyz(SOME), monitor.xyz(SOME))
    first = monitor_of(str(file))
    (tmp_path / "x.icc").write_bytes(b"gone bad")
    with pytest.raises(InputError, match=r"display\.profile"):
        monitor_of(str(file))
    assert first.icc == srgb_profile()


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (("version = 1", "version = 2"), "version 2: this program reads version 1"),
        (("version = 1", "version = true"), "version"),
        (('"gain-offset-gamma"', '"lut"'), r"model\.kind"),
        (("gamma = [", "gamma = [nan, "), r"model\.gamma"),
        (("offset = [", "samples = []\noffset = ["), "not of this kind"),
        (("floor = [", "flor = ["), "no such entry"),
        (("[display]", "[display]\nprofile = '../x.icc'"), r"\[model\] beside"),
        (("luminance_cd_m2 = 100.0", "luminance_cd_m2 = 1e9"), r"display\.luminance_cd_m2"),
        (("xyz_from_rgb", "xyz_from_rgb = 3\nignored"), "model"),
        (("[display]", "[display"), "not TOML"),
    ],
)
def test_faults_are_one_line(change, words, tmp_path):
    file = tmp_path / "m.toml"
    write_display(file, monitor_of_numbers(POWER, "a", 100.0, True))
    text = file.read_text()
    assert change[0] in text
    file.write_text(text.replace(*change))
    with pytest.raises(InputError, match=words) as refused:
        read_display(file)
    assert str(refused.value).startswith(str(file))
    assert "\n" not in str(refused.value)


def test_profile_names_stay_in_the_folder(tmp_path):
    file = tmp_path / "m.toml"
    for name in ("../x.icc", "/etc/passwd", "", "a\\\\b"):
        file.write_text(
            f'format = "relgloss-display"\nversion = 1\n[display]\nprofile = "{name}"\n'
        )
        with pytest.raises(InputError, match="beside the display file"):
            read_display(file)


def test_a_fit_is_written_with_its_evidence_and_checked(tmp_path):
    fit = fit_display(readings(srgb, patches(60)))
    file = tmp_path / "monitor.toml"
    write_display(file, fit.monitor, fit)
    monitor = read_display(file)
    assert monitor.fitted == fit.monitor.fitted
    assert monitor.verdict == fit.verdict == "good"
    assert "unseen_mean_de2000" in file.read_text()
    again = check_display(monitor, readings(srgb, seed=7))
    assert again.verdict == "good", again.sentences
    assert abs(again.luminance_drift) < 0.02
    # Controls: a dimmer lamp, a warmer white, a lighter black, another gamma.
    dimmer = of(patches(), 0.8 * readings(srgb).xyz)
    assert check_display(monitor, dimmer).luminance_drift == pytest.approx(-0.2, abs=0.02)
    warmer = of(patches(), readings(srgb).xyz * [1.03, 1.0, 0.8])
    for changed, word in (
        (dimmer, "darker than"),
        (warmer, "white point moved"),
        (readings(srgb, black=1.0), "Black is"),
        (readings(lambda d: d**1.8), "gamma of grays"),
    ):
        check = check_display(monitor, changed)
        assert check.verdict == "poor"
        assert any(word in sentence for sentence in check.sentences), check.sentences
