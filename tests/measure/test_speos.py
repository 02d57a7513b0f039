"""Speos tables: a published pair of files, closed forms, hostile files."""

from __future__ import annotations

import numpy as np
import pytest
import speos_files as made

from relgloss_view.base.errors import InputError
from relgloss_view.measure.gonio import spherical
from relgloss_view.measure.readers import read_measurement
from relgloss_view.measure.readers.recognised import is_table


def read(tmp_path, text, name="made.anisotropicbsdf"):
    path = tmp_path / name
    path.write_text(text)
    return read_measurement(path)


def at(measured, theta, phi):
    """The BRDF (B,) of a receiver."""
    apart = np.linalg.norm(measured.to_receiver - spherical(theta, phi), axis=1)
    assert apart.min() < 1e-6
    return measured.radiance_factor[np.argmin(apart)] / np.pi


def test_the_published_file_has_the_brdf_of_the_measurement_it_was_made_of(tmp_path):
    """Ansys' own pair: the Zemax file in 1/sr, and the Speos file of relative readings.

    Both state a reflectance of 13.45 %. The instrument sees nothing beyond 70 degrees on the lamp's
    side, which is some 3 % of the projected hemisphere: the readings that are left make up for it,
    by one factor in all directions.
    """
    measured = read(tmp_path, made.published())
    ratio = [at(measured, *place)[0] / brdf for place, brdf in made.ZEMAX.items()]
    assert np.ptp(ratio) < 2e-3  # the digits that Zemax prints
    assert 1.0 < min(ratio) < max(ratio) < 1.05
    # The lamp is opposite the mirror direction; with azimuths turned round it would not fit.
    assert at(measured, 45, 0)[0] / at(measured, 45, 180)[0] == pytest.approx(5.4 / 3.463, rel=2e-3)
    assert measured.to_lamp[0] == pytest.approx(spherical(15.0, 180.0))
    # Zeros show where the instrument saw nothing.
    assert not measured.kept[
        np.argmin(np.linalg.norm(measured.to_receiver - spherical(75, 180), axis=1))
    ]
    assert measured.format == "a Speos BSDF file"
    assert any("gray" in warning for warning in measured.warnings)


def test_a_spectrum_gives_the_level_of_each_wavelength(tmp_path):
    flat = read(tmp_path, made.published())
    spectrum = ((350, 10.0), (500, 10.0), (600, 30.0), (850, 30.0))
    coloured = read(tmp_path, made.published(spectrum))
    nm = coloured.bands.wavelengths_nm
    assert nm == tuple(range(400, 701, 10))
    share = at(coloured, 45, 0) / at(flat, 45, 0)[0] * 13.4506
    assert share[nm.index(450)] == pytest.approx(10.0)
    assert share[nm.index(550)] == pytest.approx(20.0)
    assert share[nm.index(700)] == pytest.approx(30.0)


@pytest.mark.parametrize("kind", [0, 1])
def test_each_block_of_a_brdf_file_has_its_reflectance(tmp_path, kind):
    """A Lambertian surface: BRDFs are even, and intensities fall with the cosine."""
    text = made.lambert(kind=kind)
    if kind == 0:
        lines = []
        for line in text.splitlines():
            words = line.split("\t")
            if len(words) == 6 and words[0].isdecimal() and words[1:] == words[1:2] * 5:
                cosine = np.cos(np.radians(float(words[0])))
                words[1:] = [str(float(word) * cosine) for word in words[1:]]
            lines.append("\t".join(words))
        text = "\n".join(lines)
    measured = read(tmp_path, text, "made.brdf")
    kept = measured.radiance_factor[measured.kept]
    assert measured.bands.wavelengths_nm == (500.0, 600.0)
    # The trapezium in steps of 2 degrees is 2e-4 off.
    assert kept == pytest.approx(np.tile([0.2, 0.4], (len(kept), 1)), rel=1e-3)
    assert set(measured.group.tolist()) == {10, 40}


def test_a_tree_finds_it(tmp_path):
    path = tmp_path / "a.brdf"
    path.write_text(made.lambert())
    assert is_table(path)
    path.write_text("OPTIS - Advanced scattering surface file v5.0\n1 2\n")
    assert not is_table(path)
    with pytest.raises(InputError, match="a file of Speos that holds no BRDF"):
        read_measurement(path)


def changed(old, new, text=None):
    text = text or made.published()
    assert old in text
    return text.replace(old, new, 1)


FAULTS = {
    "binary": (changed("v7.0\n0\n", "v7.0\n1\n"), "save it as text"),
    "an old version": (changed("v7.0", "v3.0"), "another version"),
    "transmission": (made.published(flags="0\t1"), "holds transmission alone"),
    "no incidence": (changed("\n1\n15.0\t\n", "\n0\n15.0\t\n"), "found 0, expected 1 to"),
    "too many": (changed("19 13", "9999 9999"), "more than 3000000 readings"),
    "an angle beyond": (changed("\n15.0\t\n", "\n95.0\t\n"), "angles from 0 to 90"),
    "a short row": (changed("\t0.16844", ""), "numbers, expected 14"),
    "words": (changed("0.16844", "x"), "expected numbers"),
    "not a number": (changed("0.16844", "nan"), "a number above"),
    "a falling spectrum": (made.published(((500, 1.0), (400, 2.0))), "does not increase"),
    "infrared alone": (made.published(((900, 1.0), (950, 2.0))), "from 900 to 950 nm alone"),
    "cut off": (made.published()[:2000], "line "),
    "header alone": ("OPTIS - brdf surface file v8.0\n0\n", "cut off"),
    "endless description": (changed("\n23\n", "\n9999999\n"), "cut off"),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_a_file_at_fault_is_one_line(tmp_path, fault):
    text, words = FAULTS[fault]
    with pytest.raises(InputError) as caught:
        read(tmp_path, text)
    assert words in str(caught.value)
    assert "made.anisotropicbsdf: line" in str(caught.value)
    assert "\n" not in str(caught.value)
