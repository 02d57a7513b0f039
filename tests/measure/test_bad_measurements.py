"""Every fault of an input file: one line that names file, place and remedy."""

from __future__ import annotations

import struct
import tracemalloc

import numpy as np
import pytest
from files import GCMS, GENERIC, rgl_fields, tensor_file

from relgloss_view.base.errors import InputError
from relgloss_view.measure.readers import csv_table, header, merl, read_measurement
from relgloss_view.measure.readers import tensor_file as container


def swap(old, new, text=GCMS):
    assert old in text
    return text.replace(old, new, 1)


BSDF = tensor_file(rgl_fields())


def bsdf(**changes):
    return tensor_file(rgl_fields(**changes))


def poked(name, value):
    """A valid .bsdf with one number of a field replaced."""
    field = rgl_fields()[name].copy()
    field.flat[1] = value
    return bsdf(**{name: field})


def claimed(shape_of, *numbers):
    """A valid .bsdf whose directory claims another shape for a field, its data unchanged."""
    at = BSDF.index(shape_of.encode()) + len(shape_of) + 2 + 1 + 8
    return BSDF[:at] + struct.pack(f"<{len(numbers)}Q", *numbers) + BSDF[at + 8 * len(numbers) :]


MERL_HEADER = struct.pack("<3i", 90, 90, 180)

#: What is wrong -> the file, the place that the message must name, and the remedy.
BAD = {
    "inf": (swap("1.30", "-inf"), "line 7, column 6 (600)", "leave the field empty"),
    "overflow": (swap("1.30", "1e999"), "line 7, column 6 (600)", "correct it"),
    "absurd reading": (swap("1.30", "1e13"), "line 7, column 6 (600)", "correct it"),
    "word": (swap("0.31", "dark"), "line 8, column 6 (600): found 'dark'", "write a number"),
    "hexadecimal": (swap("0.31", "0x1F"), "line 8, column 6", "write a number"),
    "underscore": (swap("0.31", "1_0"), "line 8, column 6", "write a number"),
    "other digits": (swap("0.31", "٣"), "line 8, column 6", "write a number"),
    "decimal comma": (
        swap("0.31", "0,31", GCMS.replace(",", ";")), "line 8, column 6", "decimal point"),
    "zero nm": (swap("400", "0"), "line 5, column 4: wavelength 0", "correct it"),
    "negative nm": (swap("400", "-400"), "line 5, column 4: wavelength -400", "correct it"),
    "micrometres": (swap("400", "0.4"), "line 5, column 4", "correct it"),
    "infrared": (swap("600", "3001"), "line 5, column 6: wavelength 3001", "correct it"),
    "nm too close": (swap("500", "400.4"), "line 5, column 5: 400.4 nm follows", "at least 0.5"),
    "a material": ('{"format": "relgloss-material"}', "a material, not a measurement", "snapshot"),
    "nan nm": (swap("400", "nan"), "line 5, column 4", "correct it"),
    "nm go down": (swap("400,500", "500,400"), "line 5, column 5: 400 nm", "increasing order"),
    "nm equal": (swap("500", "400.0"), "line 5, column 5: 400 nm", "increasing order"),
    "same column twice": (swap("500", "400"), "line 5, column 5", "rename or remove"),
    "strange column": (swap("400", "X"), "line 5, column 4: 'X'", "rename or remove"),
    "no name": (swap("400", ""), "line 5, column 4", "name it or remove it"),
    "missing column": (swap("gamma_deg,", "g,"), "line 5: column gamma_deg", "alpha_deg,beta_deg"),
    "missing phi": (swap("phi_r_deg,", "p,", GENERIC), "line 2: column phi_r_deg", "theta_i_deg"),
    "no readings": (
        "# quantity: brdf\nalpha_deg,beta_deg,gamma_deg\n0,45,0", "line 2", "add wavelengths"),
    "r and g only": (swap("R,G,B", "R,G,600", GENERIC), "line 2", "R,G,B or wavelengths"),
    "b, g, r": (swap("R,G,B", "B,G,R", GENERIC), "line 2", "expected R,G,B"),
    "unknown header": ("a,b\n1,2\n", "line 1: found column 'a'", "alpha_deg,beta_deg,gamma_deg"),
    "no header": ("1,2,3\n4,5,6\n", "line 1", "name the columns"),
    "one field less": (swap("0.10,", ""), "line 6: 5 fields, the header has 6", "complete the row"),
    "one field more": (swap("0.10,", "0.10,1,"), "line 6: 7 fields", "complete the row"),
    "cut off in a row": (GCMS[:-8], "line 9: 5 fields", "complete the row"),
    "empty angle": (swap("-60,10", "-60,"), "line 9, column 2 (beta_deg)", "complete it"),
    "alpha": (swap("-60,10", "-90.5,10"), "line 9, column 1 (alpha_deg)", "between -90 and 90"),
    "theta": (swap("0,0,30", "0,0,130", GENERIC), "line 3, column 3 (theta_r_deg)", "90"),
    "phi": (swap("0,0,30", "0,361,30", GENERIC), "line 3, column 2 (phi_i_deg)", "360"),
    "empty": ("", "the file is empty", "header line and rows"),
    "blank": (" \n\t\n", "the file is empty", "header line and rows"),
    "comments only": ("# quantity: brdf\n#\n", "only comments", "header line and rows"),
    "header only": (GCMS[: GCMS.index("-45")], "no row follows the header", "add rows"),
    "quantity": (swap("radiance-factor", "gloss"), "line 2: unknown quantity 'gloss'", "brdf-cos"),
    "no quantity": (swap("# quantity", "# qty"), "is not declared", "pass --quantity"),
    "gamma_s": (swap("s_deg: 15", "s_deg: fifteen"), "line 3", "correct it or remove"),
    "gamma_s nan": (swap("s_deg: 15", "s_deg: nan"), "line 3", "correct it or remove"),
    "gamma_s 100": (swap("s_deg: 15", "s_deg: 100"), "line 3", "from -90 to 90"),
    "aperture": ("# aperture_sd_deg: -1\n" + GCMS, "line 1", "correct it or remove"),
    "three apertures": ("# aperture_sd_deg: 1 1 1\n" + GCMS, "line 1", "1 or 2 numbers"),
    "saturation": ("# saturation: high\n" + GCMS, "line 1", "correct it or remove"),
    "utf-16 cut off": (GCMS.encode("utf-16")[:-1], "UTF-16, but damaged", "save it as UTF-8"),
    "picture": (b"\x89PNG\r\n\x1a\n\x00\x00\x00\rIHDR", "a picture", "RGL .bsdf"),
    "zeros": (bytes(100), "neither text", "give a CSV table"),
    "bsdf cut in the magic": (BSDF[:7], "offset 7", "download it again"),
    "bsdf cut in the count": (BSDF[:16], "offset 16", "download it again"),
    "bsdf cut in the directory": (BSDF[:30], "inside field 1 of 8", "download it again"),
    "bsdf cut in the data": (BSDF[:-1], "field 'jacobian' claims", "download it again"),
    "bsdf half": (BSDF[: len(BSDF) // 2], "beyond the end of the file", "download it again"),
    "bsdf 10^9 fields": (BSDF[:14] + struct.pack("<I", 10**9), "1000000000 fields", "download"),
    "bsdf 10^9 rows": (claimed("sigma", 10**9), "'sigma' claims shape 1000000000x4", "download"),
    "bsdf 2^63 rows": (claimed("vndf", 1, 2**63), "'vndf' claims shape", "download it again"),
    "bsdf no rows": (claimed("vndf", 1, 0), "'vndf' claims shape 1x0x16x16", "download it again"),
    "bsdf one channel": (
        bsdf(rgb=np.ones((1, 3, 1, 8, 8), np.float32)), "shape 1x3x1x8x8", "isotropic rgb"),
    "bsdf one column": (bsdf(ndf=np.ones((2, 1), np.float32)), "field 'ndf'", "expected NxN"),
    "bsdf without ndf": (bsdf(ndf=None), "field 'ndf' is missing", ".bsdf of the RGL"),
    "bsdf anisotropic": (bsdf(phi_i=np.zeros(4, np.float32)), "field 'phi_i'", "only isotropic"),
    "bsdf spectral": (
        bsdf(rgb=None, spectra=np.ones((1, 3, 5, 8, 8), np.float32)),
        "field 'wavelengths' is missing", "RGL database"),
    "bsdf nan": (poked("rgb", np.nan), "field 'rgb' holds a NaN", "download it again"),
    "bsdf signalling nan": (
        bsdf(ndf=np.full((2, 4), 0x7F810000, np.uint32).view(np.float32)), "field 'ndf'", "NaN"),
    "bsdf inf": (poked("ndf", np.inf), "field 'ndf' holds a NaN or an inf", "download it again"),
    "bsdf negative": (poked("vndf", -1), "field 'vndf' is not a density", "download it again"),
    "bsdf incidences": (poked("theta_i", 3), "field 'theta_i'", "download it again"),
    "bsdf all dark": (
        bsdf(rgb=np.zeros((1, 3, 3, 8, 8), np.float32)), "none of the", "check the angles"),
    "merl cut": (MERL_HEADER + bytes(1000), "1012 bytes", "download it again"),
    "merl header alone": (MERL_HEADER, "12 bytes", "download it again"),
    "merl of another size": (struct.pack("<3i", 90, 90, 360), "neither text", "MERL .binary"),
}  # fmt: skip


def message_of(path, **arguments):
    with pytest.raises(InputError) as caught:
        read_measurement(path, **arguments)
    message = str(caught.value)
    assert "\n" not in message
    assert str(path) in message
    assert len(message) < 400
    return message


@pytest.mark.parametrize("fault", BAD)
def test_one_line_names_file_place_and_remedy(tmp_path, fault):
    content, place, remedy = BAD[fault]
    path = tmp_path / "input"
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    message = message_of(path)
    assert place in message
    assert remedy in message


def test_the_files_that_the_faults_are_made_from_are_sound(tmp_path):
    # Otherwise each fault above could be refused for another reason.
    for content in (GCMS.encode(), GENERIC.encode(), BSDF):
        path = tmp_path / "input"
        path.write_bytes(content)
        assert read_measurement(path).kept.any()


def test_claims_are_checked_before_anything_is_allocated(tmp_path):
    path = tmp_path / "input"
    path.write_bytes(claimed("sigma", 10**9))
    tracemalloc.start()
    try:
        message_of(path)
        assert tracemalloc.get_traced_memory()[1] < 1_000_000
    finally:
        tracemalloc.stop()


def test_overlapping_fields_do_not_multiply_the_file(tmp_path):
    # Many fields over the same bytes: each fits, together they claim more than there is.
    name, count = b"x", 900
    entry = struct.pack("<H", 1) + name + struct.pack("<HBQQ", 1, 1, 0, 10_000)
    content = b"tensor_file\x00\x01\x00" + struct.pack("<I", count) + entry * count
    path = tmp_path / "input"
    path.write_bytes(content)
    assert "claim 9000000 bytes" in message_of(path)


@pytest.mark.parametrize("channel", [0, 2])
@pytest.mark.parametrize("value", [np.nan, -np.inf])
def test_merl_with_a_value_that_is_no_number(tmp_path, channel, value):
    bins = np.ones((3, 90, 90, 180))
    bins[channel, 4, 5, 6] = value
    path = tmp_path / "input"
    path.write_bytes(MERL_HEADER + bins.tobytes())
    message = message_of(path)
    assert f"channel {'RGB'[channel]}" in message
    assert "[4, 5, 6]" in message


def test_merl_with_trailing_bytes(tmp_path):
    path = tmp_path / "input"
    path.write_bytes(MERL_HEADER)
    with path.open("r+b") as file:
        file.truncate(merl.SIZE + 1)
    assert str(merl.SIZE) in message_of(path)


def test_merl_without_a_measured_bin(tmp_path):
    path = tmp_path / "input"
    path.write_bytes(MERL_HEADER + np.full((3, 90, 90, 180), -1.0).tobytes())
    assert "none of the" in message_of(path)


def test_too_large_a_text_is_refused_unread(tmp_path):
    path = tmp_path / "input"
    path.write_text(GCMS + "# padding\n" * 1000)
    with path.open("r+b") as file:
        file.truncate(csv_table.MAX_BYTES + 1)  # sparse: takes no space
    tracemalloc.start()
    try:
        assert "split it" in message_of(path)
        assert tracemalloc.get_traced_memory()[1] < 1_000_000
    finally:
        tracemalloc.stop()


def test_too_large_a_bsdf_is_refused_unread(tmp_path):
    path = tmp_path / "input"
    path.write_bytes(BSDF)
    with path.open("r+b") as file:
        file.truncate(container.MAX_BYTES + 1)
    assert "at most" in message_of(path)


def test_too_many_rows_and_columns(tmp_path, monkeypatch):
    path = tmp_path / "input"
    path.write_text(GCMS)
    monkeypatch.setattr(csv_table, "MAX_ROWS", 4)
    assert len(read_measurement(path).reasons) == 4
    monkeypatch.setattr(csv_table, "MAX_ROWS", 3)
    assert "more than 3 rows" in message_of(path)
    monkeypatch.setattr(csv_table, "MAX_LINES", 8)
    assert "more than 8 lines" in message_of(path)
    monkeypatch.setattr(csv_table, "MAX_LINES", 9)
    monkeypatch.setattr(csv_table, "MAX_ROWS", 4)
    assert len(read_measurement(path).reasons) == 4
    monkeypatch.setattr(header, "MAX_COLUMNS", 5)
    assert "6 columns" in message_of(path)


def test_what_is_no_file(tmp_path):
    assert "No such file" in message_of(tmp_path / "absent.csv")
    assert "a folder" in message_of(tmp_path)
    (tmp_path / "file").write_text("x")
    message_of(tmp_path / "file" / "inside.csv")
    with pytest.raises(InputError, match="null"):
        read_measurement("a\0b.csv")
    with pytest.raises(InputError):
        read_measurement("x" * 5000)


def test_a_device_is_not_read():
    with pytest.raises(InputError, match=r"/dev/zero|No such file"):
        read_measurement("/dev/zero")


def test_a_file_that_may_not_be_read(tmp_path, monkeypatch):
    path = tmp_path / "input"
    path.write_text(GCMS)

    def refuse(*args, **kwargs):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr("os.open", refuse)
    assert "Permission denied" in message_of(path)


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        ({"quantity": "gloss"}, "--quantity: unknown quantity 'gloss'"),
        ({"gamma_s_deg": float("nan")}, "--gamma-s-deg"),
        ({"gamma_s_deg": 91.0}, "--gamma-s-deg"),
    ],
)
def test_bad_arguments(tmp_path, arguments, expected):
    path = tmp_path / "input"
    path.write_text(GCMS)
    with pytest.raises(InputError, match=expected):
        read_measurement(path, **arguments)
