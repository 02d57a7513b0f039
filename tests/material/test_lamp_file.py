"""Lamp files as spectrometers and spreadsheets save them."""

from __future__ import annotations

import numpy as np
import pytest

from relgloss_view.base.errors import InputError
from relgloss_view.material.lamp_file import read_lamp
from relgloss_view.material.spectra import illuminant

NM = np.arange(380, 781, 5)
POWER = 0.1 + np.exp(-(((NM - 560) / 90.0) ** 2))


def lines(form="{},{:.5f}", nm=NM, power=POWER):
    return [form.format(w, p) for w, p in zip(nm, power, strict=True)]


def changed(nm, line):
    """The plain table with another line for a wavelength."""
    return [line if int(old.split(",")[0]) == nm else old for old in lines()]


@pytest.fixture
def read(tmp_path):
    def from_content(content):
        if isinstance(content, list):
            content = "\n".join(content) + "\n"
        path = tmp_path / "lamp.csv"
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return read_lamp(path)

    return from_content


def comma(rows):
    return [row.replace(".", ",") for row in rows]


PLAIN = "\n".join(lines())
FORMS = {
    "semicolons, decimal commas": comma(lines("{};{:.5f}")),
    "tabs": lines("{}\t{:.5f}"),
    "spaces, decimal commas": comma(lines("{}.0 {:.5f}")),
    "quoted": comma(lines('"{}.0","{:.5f}"')),
    "trailing blanks": lines("{},{:.5f},,,"),
    "titles": [
        "Spectrum of lamp 7",
        "Date: 2024-01-01",
        "12 readings, 3 lamps",
        "nm,W/nm",
        *lines(),
    ],
    "padded comments": ["# a lamp,,,", '"# a, b",,,', *lines("{},{:.5f},,")],
    "remarks below": [*lines(), "", "End", "CCT,5000"],
    "downwards": lines()[::-1],
    "utf-16": PLAIN.encode("utf-16"),
    "utf-16 without a mark": PLAIN.encode("utf-16-le"),
    "byte order mark": PLAIN.encode("utf-8-sig"),
    "twice the same": [*lines(), lines()[-1]],
    "bars": lines("{} | {:.5f}"),
    "whole wavelengths, spaces, decimal commas": [
        line.replace(".", ",") for line in lines("{:.0f} {:.5f}")
    ],
}


@pytest.mark.parametrize("form", FORMS)
def test_another_form_reads_as_the_plain_one(read, form):
    found = read(FORMS[form])
    np.testing.assert_allclose(found.wavelengths_nm, NM)
    np.testing.assert_allclose(found.power, POWER, atol=1e-5)
    assert found.notes == ()


def test_percent_of_the_peak(read):
    found = read(lines("{},{:.5f}%", power=100 * POWER))
    np.testing.assert_allclose(np.array(found.power) / 100, POWER, atol=1e-5)


@pytest.mark.parametrize("cell", ["", "n/a", "nan", "-", "#N/A", "#NV", "---"])
def test_an_empty_cell_is_interpolated_and_named(read, cell):
    found = read(changed(500, f"500,{cell}"))
    k = list(NM).index(500)
    assert found.power[k] == pytest.approx((found.power[k - 1] + found.power[k + 1]) / 2)
    assert "500 nm (line 25)" in found.notes[0]


def test_a_mark_of_nines_is_no_power(read):
    found = read(changed(500, "500,9999"))
    assert max(found.power) == pytest.approx(max(POWER), abs=1e-5)
    assert "read 9999 in line 25 as empty" in found.notes[0]


def test_unsorted_wavelengths_are_sorted_with_a_note(read):
    rows = lines()
    rows[3], rows[40] = rows[40], rows[3]
    found = read(rows)
    np.testing.assert_allclose(found.power, POWER, atol=1e-5)
    assert "sorted" in found.notes[0]


def spectrometer(noise, seed=3):
    """A narrow lamp from 200 to 1200 nm in steps of 1 nm, with noise of a share of its peak."""
    nm = np.arange(200.0, 1201.0)
    power = np.exp(-(((nm - 560) / 60.0) ** 2))
    noisy = power + noise * np.random.default_rng(seed).standard_normal(nm.size)
    return nm, power, noisy


@pytest.mark.parametrize("noise", [1e-4, 1e-3, 2e-3])
def test_noise_of_a_spectrometer_below_zero_is_read_as_zero_with_a_note(read, tmp_path, noise):
    nm, power, noisy = spectrometer(noise)
    found = read(lines("{},{:.5e}", nm, noisy))
    assert min(found.power) == 0.0
    assert "read as 0" in found.notes[0]
    # The colour is that of the lamp without noise.
    white = illuminant(str(tmp_path / "lamp.csv")).white_xyz()
    (tmp_path / "clean.csv").write_text("\n".join(lines("{},{:.5e}", nm, power)))
    clean = illuminant(str(tmp_path / "clean.csv")).white_xyz()
    np.testing.assert_allclose(white, clean, rtol=40 * noise)


def test_more_below_zero_is_no_noise_and_refused_with_the_wavelength(read):
    for line in ("600,-0.1", "600,-0.005"):
        with pytest.raises(InputError, match=r"power at 600 nm is -0\.\d+, below zero"):
            read(changed(600, line))
    nm, _, noisy = spectrometer(1e-3)
    noisy[nm == 600] = -0.02
    with pytest.raises(InputError, match=r"power at 600 nm"):
        read(lines("{},{:.5e}", nm, noisy))


def test_what_no_eye_sees_may_be_any_amount_below_zero(read):
    nm, _, noisy = spectrometer(1e-4)
    noisy[nm > 1100] = -0.3
    assert "read as 0" in read(lines("{},{:.5e}", nm, noisy)).notes[0]


REFUSED = {
    "two powers": ([*lines(), "780,0.9"], "lines 81 and 82 give two powers of 780 nm"),
    "a word": (changed(600, "600,bright"), "line 45: expected wavelength"),
    "infinity": (changed(600, "600,inf"), "line 45"),
    "three columns": (lines("{},{:.5f},1"), "line 1: expected wavelength (nm) and power"),
    "a gap": (
        [row for row in lines() if not row.startswith(("500", "505"))], "at most 10 nm"),
    "empty cells side by side": (
        [row if row[:3] not in ("500", "505") else row[:4] for row in lines()],
        "no power from 495 to 510 nm"),
    "micrometres": (lines("{:.3f},{:.5f}", nm=NM / 1000), "look like micrometres"),
    "angstroms": (lines(nm=NM * 10), "look like ångströms"),
    "words among the rows": ([*lines()[:9], "Part 2", *lines()[9:]], "line 10"),
    "a spreadsheet": (b"PK\x03\x04xl/workbook.xml", "save or export the table as CSV"),
    "a luminaire": (b"IESNA:LM-63-2002\nTILT=NONE\n", "holds no spectrum"),
    "escape": (changed(600, "600,\x1b[31m"), "line 45"),
}  # fmt: skip


@pytest.mark.parametrize("fault", REFUSED)
def test_what_is_refused_in_one_line(read, fault):
    content, expected = REFUSED[fault]
    with pytest.raises(InputError) as caught:
        read(content)
    assert expected in str(caught.value)
    assert str(caught.value).isprintable()


def test_the_notes_of_a_lamp_are_among_the_warnings_of_a_picture(tmp_path):
    import relgloss_view as r
    from relgloss_view.picture.frame import scene_warnings
    from relgloss_view.picture.scene.setup import Lamp

    (tmp_path / "lamp.csv").write_text("\n".join(changed(500, "500,")))
    for name, count in ((str(tmp_path / "lamp.csv"), 1), ("D65", 0)):
        scene = r.Scene(r.load_sample("uncoated"), lamp=Lamp(illuminant=name))
        warnings = scene_warnings(scene, r.Look(), (64, 64), seen=True, lit=True)
        assert sum("500 nm" in w for w in warnings) == count
