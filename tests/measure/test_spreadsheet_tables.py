"""Tables as spreadsheets and instruments save them: each reads as the plain one, or is refused."""

from __future__ import annotations

import re

import numpy as np
import pytest

from relgloss_view.base.errors import InputError
from relgloss_view.measure.readers import read_measurement
from relgloss_view.measure.readers.csv_table import parse

HEADER = "theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,450,550,650"
ROWS = [
    f"{lamp},0,{receiver},180,{0.25 + 0.001 * k:.3f},{0.35 + 0.001 * k:.3f},0.5"
    for k, (lamp, receiver) in enumerate((a, b) for a in (0, 20, 45) for b in (0, 10, 30, 60))
]
TABLE = "\n".join(["# quantity: radiance-factor", "# name: a card", HEADER, *ROWS, ""])


def with_row(row, text, table=TABLE):
    """The table with another text in a line, counted from 1."""
    lines = table.split("\n")
    lines[row - 1] = text
    return "\n".join(lines)


def padded(table=TABLE):
    """As a spreadsheet saves it: each line has as many separators as the longest."""
    most = max(line.count(",") for line in table.split("\n"))
    return "\ufeff" + "\r\n".join(
        line + "," * (most - line.count(",")) for line in table.strip().split("\n")
    )


def european(table=TABLE):
    return table.replace(",", ";").replace(".", ",")


@pytest.fixture
def read(tmp_path):
    def from_content(content, **arguments):
        path = tmp_path / "t.csv"
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return read_measurement(path, **arguments)

    return from_content


def renamed(*headings, table=TABLE):
    """The table with other words for its four angles."""
    return table.replace("theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg", ",".join(headings))


def recoloured(table=TABLE):
    """Readings of another sample in the same geometries."""
    return re.sub(r"0\.\d+(,0\.\d+,)0\.5$", r"0.9\g<1>0.1", table, flags=re.MULTILINE)


#: Another form of the same table -> what the one warning must name; None: no warning at all.
FORMS = {
    "padded": (padded(), None),
    "semicolons, decimal commas": (european(), None),
    "tabs, decimal commas": (TABLE.replace(",", "\t").replace(".", ","), None),
    "quoted decimal commas": (re.sub(r"(\d)\.(\d+)", r'"\1,\2"', TABLE), None),
    "spaces": (TABLE.replace(",", "   "), None),
    "utf-16": (TABLE.encode("utf-16"), None),
    "utf-16 without a mark": (european().encode("utf-16-le"), None),
    "big-endian without a mark": (TABLE.encode("utf-16-be"), None),
    "windows-1252": (("# Gerät: 45°\n" + TABLE).encode("cp1252"), "line 1 is not UTF-8"),
    "each line one cell": ("\n".join(f'"{line}"' for line in TABLE.split("\n")), None),
    "quoted comments": (TABLE.replace("# name: a card", '"# name: a card",,,'), None),
    "separator line": ("sep=,\n" + TABLE, None),
    "titles": ("Report,,,,,,\nBoard 7\n" + TABLE, "lines 1 and 2 above the header"),
    "declared without #": (TABLE.replace("# quantity: ", "Quantity,"), None),
    "blank columns": (re.sub(r"^(?=[\dt])(.*)$", r"\1,,", TABLE, flags=re.M), "columns 8 and 9"),
    "blank rows": (TABLE.replace(ROWS[4], ",,,,,,\n" + ROWS[4]) + ",,,,,,\n", "lines 8 and 17"),
    "averages": (TABLE + "Mean,,,,0.3,0.4,0.5\nStd,,,,0,0,0\n", "lines 16 and 17 ('Mean')"),
    "averages among the rows": (TABLE.replace(ROWS[4], "Mean,,,,1,1,1\n" + ROWS[4]), "line 8"),
    "averages without a word": (TABLE + ",,,,0.3,0.4,0.5\n", "line 16 below the data"),
    "remarks below": (TABLE + "\nMeasured by me, on 24.12.2024\nEnd\n", "lines 17 and 18 below"),
    "keys below": (TABLE + "Operator,7,,,,,\n", "line 16 below the data ('Operator')"),
    "units": (TABLE.replace(HEADER, HEADER + "\n°,°,°,°,1/sr,1/sr,1/sr"), "units in line 4"),
    "header again": (TABLE.replace(ROWS[4], HEADER + "\n" + ROWS[4]), "header again in line 8"),
    "numbered rows": (
        TABLE.replace(HEADER, "," + HEADER).replace(
            "\n".join(ROWS), "\n".join(f"{k},{row}" for k, row in enumerate(ROWS))),
        "column 1 without a name"),
    "remarks beside": (
        TABLE.replace(HEADER, HEADER + ",").replace("0.5\n", "0.5,fine\n"),
        "column 8 without a name"),
    "other words": (
        TABLE.replace(HEADER, "Incident polar angle,Incident azimuth,Viewing zenith (deg),"
                      "Viewing azimuth [°],450 nm,R_550,650nm"),
        "'Viewing zenith (deg)' as theta_r_deg"),
    "case and blanks": (TABLE.replace(HEADER, HEADER.upper().replace(",", " , ")), None),
    "minus of a typesetter": (TABLE.replace("\n45,0,", "\n45,\u22120,"), None),
    "exponents of Fortran": (TABLE.replace(",0.5\n", ",5.0D-01\n"), None),
}  # fmt: skip


@pytest.mark.parametrize("form", FORMS)
def test_another_form_reads_as_the_plain_table(read, form):
    content, note = FORMS[form]
    expected, found = read(TABLE), read(content)
    np.testing.assert_array_equal(found.radiance_factor, expected.radiance_factor)
    np.testing.assert_array_equal(found.to_lamp, expected.to_lamp)
    np.testing.assert_array_equal(found.to_receiver, expected.to_receiver)
    assert found.name == "a card"
    if note is None:
        assert found.warnings == ()
    else:
        (warning,) = found.warnings
        assert note in warning


#: A form that can't be read -> what the message must name.
REFUSED = {
    "thousands": (with_row(6, '0,0,30,180,"1,234.5",0.3,0.5'), "line 6, column 5", "thousands"),
    "spaced thousands": (with_row(6, "0,0,30,180,1 234.5,0.3,0.5"), "line 6", "thousands"),
    "point and comma": (with_row(6, "0;0;30;180;1.234,5;0,3;0,5", european()), "1.234,5",
                        "thousands"),
    "unit": (with_row(6, "0,0,30,180,0.2 sr-1,0.3,0.5"), "line 6, column 5 (450)", "its unit"),
    "degree sign": (with_row(6, "0,0,30°,180,0.2,0.3,0.5"), "column 3 (theta_r_deg)", "its unit"),
    "percent sign": (with_row(6, "0,0,30,180,20%,0.3,0.5"), "'20%'", "radiance-factor-percent"),
    "date": (with_row(6, "0,0,30,180,3-Apr,0.3,0.5"), "line 6, column 5", "made a date"),
    "formula": (with_row(6, "0,0,30,180,=A1,0.3,0.5"), "line 6, column 5", "its formulas"),
    "infinity": (with_row(6, "0,0,30,180,inf,0.3,0.5"), "line 6, column 5", "leave the field"),
    "empty angle": (with_row(6, "0,0,n/a,180,0.2,0.3,0.5"), "column 3 (theta_r_deg)", "complete"),
    "decimal commas": (re.sub(r"(\d)\.(\d)", r"\1,\2", TABLE), "line 4: 10 fields", "semicolons"),
    "one decimal comma": (
        with_row(6, "0;0;30;180;0,2;0.3;0.5", TABLE.replace(",", ";")), "column 5", "decimal"),
    "same heading": (TABLE.replace("550", "450"), "line 3, column 6", "already column 5"),
    "same angle": (TABLE.replace("450", "theta_in"), "line 3, column 5", "already column 1"),
    "values without a name": (
        TABLE.replace(HEADER, HEADER + ",").replace("0.5\n", "0.5,0.7\n"), "line 4, column 8",
        "without a name"),
    "a column of words": (
        TABLE.replace(HEADER, HEADER + ",by").replace("0.5\n", "0.5,me\n"), "line 3, column 8",
        "rename or remove"),
    "two quantities": (TABLE + TABLE.replace("radiance-factor", "brdf"), "line 16", "line 1"),
    "a cut row at the end": (TABLE + "45,0,60,1", "line 16: 4 fields", "complete the row"),
    "a typo at the end": (TABLE + "4s,0,60,180,1,1,1", "line 16, column 1", "number"),
    "another separator in the rows": (
        "\n".join([*TABLE.split("\n")[:3], *(row.replace(",", ";") for row in ROWS)]),
        "line 4: 1 field,", "semicolons"),
    "no table": ("Dear all,\nthis, and that, is a letter.\n", "line 1: found column", "begin"),
    "no header": ("Report of today\n" + "\n".join(ROWS), "line 1", "the header should begin"),
}  # fmt: skip


@pytest.mark.parametrize("form", REFUSED)
def test_what_is_not_read_is_refused_with_place_and_remedy(read, form):
    content, place, remedy = REFUSED[form]
    with pytest.raises(InputError) as caught:
        read(content)
    assert place in str(caught.value)
    assert remedy in str(caught.value)


@pytest.mark.parametrize("sign", ["nan", "NaN", "n/a", "-", "#N/A", "#DIV/0!", "null"])
def test_signs_for_nothing_are_empty_cells_with_a_warning(read, sign):
    found = read(with_row(6, f"0,0,30,180,{sign},0.3,0.5"))
    assert found.left_out() == {"missing": 1}
    assert found.warnings == (f"read '{sign}' in line 6 as empty",)


def test_two_apertures_that_a_spreadsheet_split(read):
    for comment in ("# aperture_sd_deg: 0.3,0.4,,,,", '"# aperture_sd_deg: 0.3,0.4",,,'):
        assert read(comment + "\n" + TABLE).aperture_sd_deg == (0.3, 0.4)
    comment = "# aperture_sd_deg: 0,3;0,4;;;;"
    assert read(comment + "\n" + european()).aperture_sd_deg == (0.3, 0.4)


@pytest.mark.parametrize("place", ["name", "title", "heading", "cell", "quantity"])
def test_no_escape_sequence_comes_through(read, place):
    bad = "\x1b[31m\x07red\u202e"
    content = {
        "name": TABLE.replace("a card", bad),
        "title": bad + "\n" + TABLE,
        "heading": TABLE.replace("450", bad),
        "cell": with_row(6, f"0,0,30,180,{bad},0.3,0.5"),
        "quantity": TABLE.replace("radiance-factor", bad),
    }[place]
    try:
        found = read(content)
    except InputError as error:
        assert str(error).isprintable()
    else:
        assert "".join([found.name, found.source, *found.warnings]).isprintable()


def test_a_plain_table_of_another_subject_has_no_header_to_look_for(tmp_path):
    (tmp_path / "t.csv").write_text("a,b\n1,2\n3,4\n")
    table = parse(tmp_path / "t.csv")
    assert table.columns == ("a", "b")
    np.testing.assert_array_equal(table.values, [[1, 2], [3, 4]])


@pytest.mark.parametrize(
    "headings",
    [
        ("theta_i", "phi_i", "theta_s", "phi_s"),  # ASTM E1392
        ("theta_l", "phi_l", "theta_v", "phi_v"),  # light and view
        ("thi", "phii", "ths", "phis"),
        ("AOI", "Inc. Azimuth", "Det. Polar", "Det. Azimuth"),
        ("SZA", "SAA", "VZA", "VAA"),  # sun and sensor
        ("theta_i [\xa1\xeb]", "phi_i [\xa1\xeb]", "theta_r", "phi_r"),  # EUC-JP's degree sign
    ],
)
def test_words_for_angles(read, headings):
    plain, other = read(TABLE), read(renamed(*headings))
    np.testing.assert_array_equal(other.to_lamp, plain.to_lamp)
    np.testing.assert_array_equal(other.to_receiver, plain.to_receiver)
    np.testing.assert_array_equal(other.radiance_factor, plain.radiance_factor)


ASKED = {
    "gon": (renamed("theta_i [gon]", "phi_i [gon]", "a", "b"), "unit of angle 'gon'; give degrees"),
    "two meanings": (renamed("theta_s", "phi_s", "theta_v", "phi_v"), "already column 1"),
    "another sample, named": (
        TABLE + TABLE.replace("a card", "b"), r"line 17: another sample begins \('b'\)"),
    "another sample, same header": (TABLE + recoloured(), "line 18: another table.*contradict"),
    "other bands below": (TABLE + TABLE.replace("650", "660"), "line 18: another table begins"),
    "title of a group": (
        with_row(6, "Series 2" + "\n" + ROWS[2]), r"line 6: words among the rows \('Series 2'\)"),
    "some cells in percent": (TABLE.replace("0.5\n", "50%\n", 3), "write all of them alike"),
    "a unit and no date": (with_row(4, "15 deg" + ROWS[0][1:]), "number without its unit"),
    "too narrow": (with_row(4, ROWS[0].replace("0.5", "####")), "widen the column"),
}  # fmt: skip


@pytest.mark.parametrize("fault", ASKED)
def test_what_is_asked_about(read, fault):
    content, message = ASKED[fault]
    with pytest.raises(InputError, match=message):
        read(content)


def test_parts_of_one_scan_and_a_repeated_scan_are_joined(read):
    plain = read(TABLE)
    parts = TABLE.split("\n")
    joined = read("\n".join([*parts[:9], HEADER, *parts[9:]]))
    np.testing.assert_array_equal(joined.radiance_factor, plain.radiance_factor)
    # The negative control of a contradiction: noise of 1 % makes no other sample.
    again = TABLE.replace(",0.5\n", ",0.505\n").split("\n", 2)[2]
    assert len(read(TABLE + again).to_lamp) == 2 * len(plain.to_lamp)


@pytest.mark.parametrize("sign", ["#NV", "#ZAHL!", "#NAME?", "-----", ".", "9999", "-999"])
def test_signs_of_no_reading(read, sign):
    m = read(with_row(5, ROWS[1].rsplit(",", 1)[0] + "," + sign))
    assert m.left_out() == {"missing": 1}
    assert any(f"read {sign!r}" in w or f"read {sign} " in w for w in m.warnings)


def test_nines_that_other_readings_come_near_are_readings(read):
    large = TABLE.replace(",0.5", ",900")
    m = read(with_row(5, ROWS[1].replace(",0.5", ",999"), large), quantity="radiance-factor")
    assert m.radiance_factor[1, 2] == 999.0


@pytest.mark.parametrize("line", ["# quantity = brdf", "#,quantity,brdf", "# quantity;brdf"])
def test_declarations_with_other_marks(read, line):
    assert read(TABLE.replace("# quantity: radiance-factor", line)).quantity == "brdf"


def test_channels_in_percent(read):
    table = TABLE.replace("450,550,650", "R (%),G (%),B (%)").replace("0.", "20.")
    assert read(table).radiance_factor[0] == pytest.approx([0.20250, 0.20350, 0.205])


@pytest.mark.parametrize(
    ("angle", "band"), [(" [deg]", " nm"), (" (°)", " [nm]"), (" [ deg ]", "")]
)
def test_units_between_spaces_belong_to_the_name_before_them(read, angle, band):
    angles = [f"{name}{angle}" for name in ("theta_i", "phi_i", "theta_r", "phi_r")]
    header = [*angles, *(f"{nm}{band}" for nm in (450, 550, 650))]
    plain, other = read(TABLE), read(TABLE.replace(HEADER, ",".join(header)).replace(",", "   "))
    assert other.bands == plain.bands
    np.testing.assert_array_equal(other.radiance_factor, plain.radiance_factor)
