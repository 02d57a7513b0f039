"""Files of readings: formats, units, scales, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest

from relgloss_view.base.errors import InputError
from relgloss_view.display.read import monitor_of
from relgloss_view.display.readings import is_readings, read_readings

ROWS = [
    (0, 0, 0, 0.19, 0.2, 0.22),
    (255, 255, 255, 152.1, 160.0, 174.2),
    (255, 0, 0, 66.2, 34.1, 3.3),
    (0, 127.5, 0, 12.3, 24.5, 4.2),
]
DIGITAL = np.array([row[:3] for row in ROWS]) / 255.0
XYZ = np.array([row[3:] for row in ROWS])


def written(tmp_path, text, name="a.csv", encoding="utf-8"):
    file = tmp_path / name
    file.write_bytes(text.encode(encoding))
    return file


def table(heads, rows=ROWS, mark=",", point="."):
    lines = [mark.join(heads)]
    lines += [mark.join(f"{v:.10g}".replace(".", point) for v in row) for row in rows]
    return "\n".join(lines) + "\n"


HEADS = ("R", "G", "B", "X", "Y", "Z")


@pytest.mark.parametrize(
    "text",
    [
        table(HEADS),
        table(HEADS, mark=";", point=","),
        "sep=;\r\n" + table(HEADS, mark=";", point=",").replace("\n", "\r\n"),
        table(HEADS, mark="\t"),
        table(HEADS, mark="\t", point=","),
        table(HEADS, mark=" "),
        "# made by hand\n\n" + table(("Red", "Green", "Blue", "XYZ_X", "XYZ_Y", "XYZ_Z")),
        table(("R (0-255)", "G (0-255)", "B (0-255)", "X [cd/m2]", "Y [cd/m2]", "Z [cd/m2]")),
        table(("r", "g", "b", "x", "y", "z")),
        table(HEADS, [(*[v / 2.55 for v in row[:3]], *row[3:]) for row in ROWS]),
        table(HEADS, [(*[v / 255 for v in row[:3]], *row[3:]) for row in ROWS]),
        table(HEADS, [(*[v * 257 for v in row[:3]], *row[3:]) for row in ROWS]),
        table(("Y", "R", "Z", "G", "X", "B"), [(r[4], r[0], r[5], r[1], r[3], r[2]) for r in ROWS]),
        table(HEADS) + "\nmean;of;all\n",
    ],
)
def test_tables_in_many_spellings(text, tmp_path):
    readings = read_readings(written(tmp_path, text))
    np.testing.assert_allclose(readings.rgb, DIGITAL, atol=1e-9)
    np.testing.assert_allclose(readings.xyz, XYZ, rtol=1e-9)
    assert readings.absolute
    assert is_readings(text.encode())


def test_chromaticities_and_foot_lamberts(tmp_path):
    rows = [(*row[:3], *(np.array(row[3:5]) / sum(row[3:])), row[4] / 3.4262591) for row in ROWS]
    text = table(("R", "G", "B", "x", "y", "Y (fL)"), rows)
    readings = read_readings(written(tmp_path, text))
    np.testing.assert_allclose(readings.xyz, XYZ, rtol=1e-6)
    assert any("foot-lambert" in note for note in readings.notes)


def argyll(rows, keywords, tail=""):
    lines = ["CTI3", 'ORIGINATOR "Argyll dispread"', *keywords, "BEGIN_DATA_FORMAT"]
    lines += ["SAMPLE_ID RGB_R RGB_G RGB_B XYZ_X XYZ_Y XYZ_Z", "END_DATA_FORMAT", "BEGIN_DATA"]
    lines += [" ".join(str(v) for v in (k + 1, *row)) for k, row in enumerate(rows)]
    return "\n".join([*lines, "END_DATA", tail])


PERCENT = [(*[v / 2.55 for v in row[:3]], *[v / 1.6 for v in row[3:]]) for row in ROWS]
CALIBRATION = """CAL
BEGIN_DATA_FORMAT
RGB_I RGB_R RGB_G RGB_B
END_DATA_FORMAT
BEGIN_DATA
0 0 0 0
1 1 1 1
END_DATA
"""


def test_normalised_readings_take_their_luminance_from_the_file(tmp_path):
    words = ['NORMALIZED_TO_Y_100 "YES"', 'LUMINANCE_XYZ_CDM2 "152.1 160.0 174.2"']
    readings = read_readings(written(tmp_path, argyll(PERCENT, words, CALIBRATION), "a.ti3"))
    np.testing.assert_allclose(readings.xyz, XYZ, rtol=1e-9)
    assert readings.absolute
    assert any("calibration" in note for note in readings.notes)
    alone = read_readings(written(tmp_path, argyll(PERCENT, words[:1]), "b.ti3"))
    assert not alone.absolute
    assert any("luminance is unknown" in note for note in alone.notes)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "empty"),
        ("hello\n", "no headings R, G, B"),
        ("R,G,B,X,Y,Z\n", "without a row"),
        (table(HEADS).replace("160", "n/a"), "line 3: a patch without a number"),
        (table(HEADS).replace("160", "1,160.5"), "line 3: 7 cells, and 6"),
        (table(HEADS).replace("152.1", "abc"), "line 3: found 'abc'"),
        (table(HEADS).replace("255,0,0", "-5,0,0"), "digital value of -5"),
        (table(HEADS).replace("255,0,0", "1e7,0,0"), "at most 65535"),
        ("R,G,B,x,y,Y\n255,255,255,0.9,0.9,100\n", "no chromaticity"),
        (argyll(PERCENT, ['LUMINANCE_XYZ_CDM2 "1 0 1"']), "above 0"),
        (argyll(PERCENT, []).replace("XYZ_X XYZ_Y XYZ_Z", "LAB_L LAB_A LAB_B"), "are CIELAB"),
        (argyll(PERCENT, []).replace("END_DATA\n", "1 2"), "a set of"),
    ],
)
def test_faults_of_files_are_one_line(text, words, tmp_path):
    with pytest.raises(InputError, match=words) as refused:
        read_readings(written(tmp_path, text))
    assert "\n" not in str(refused.value)


def test_readings_where_a_display_is_wanted_name_the_command(tmp_path):
    file = written(tmp_path, table(HEADS))
    with pytest.raises(InputError, match=r"relgloss display .*a\.csv -o monitor\.toml"):
        monitor_of(str(file))
