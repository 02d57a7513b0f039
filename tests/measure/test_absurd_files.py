"""What damaged inputs once got past a reader: each is refused in one line, or read soundly."""

import numpy as np
import pytest

from relgloss_view import read_measurement
from relgloss_view.base.errors import InputError
from relgloss_view.measure.readers.spectrum import read_spectrum

ANGLES = "name,geometry,400nm,450nm,500nm,550nm,600nm,650nm,700nm\n"
ROWS = "".join(f"a,{g},.1,.15,.2,.25,.3,.35,.4\n" for g in ("45as-15", "45as15", "15as45"))


def refusal(tmp_path, content, read=read_measurement):
    path = tmp_path / "x.csv"
    path.write_bytes(content.encode())
    with pytest.raises(InputError) as caught:
        read(path)
    message = str(caught.value)
    assert "can't be decoded" not in message
    return message


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (ANGLES + ROWS + "a,45as25,.1,1e999,.2,.25,.3,.35,.4\n", "beyond any reading"),
        (ANGLES + ROWS + "a,45as25,.1,.15,.2,.25,.3,0\n", "line 5: 8 fields"),
        ("#DIM 3 1\n#PARAM_IN \n#PARAM_OUT INV_STERADIAN\n0 0 0 1\n", "UNKNOWN_INPUT"),
    ],
    ids=["infinite", "cut off", "no coordinates"],
)
def test_what_no_table_holds_is_refused(content, words, tmp_path):
    assert words in refusal(tmp_path, content)
    whole = tmp_path / "whole.csv"
    whole.write_text(ANGLES + ROWS)
    assert read_measurement(whole).radiance_factor.shape == (3, 7)


def test_white_space_of_unicode_is_no_spectrum(tmp_path):
    assert "no spectrum" in refusal(tmp_path, "\x1f\n" * 3, read_spectrum)


def test_a_filled_value_is_never_below_zero(tmp_path):
    """The first line falls to 700 nm, where its value is missing: a straight line ends below 0."""
    path = tmp_path / "x.csv"
    path.write_text(ANGLES + ROWS + "a,45as25,.6,.5,.4,.3,.2,.001,\n")
    measured = read_measurement(path)
    assert "1 single value is filled" in " ".join(measured.warnings)
    assert np.min(measured.radiance_factor) >= 0.0


@pytest.mark.parametrize("end", ["\r", "\r\n", "\n "])
def test_line_ends_and_white_space_hide_no_format(end, tmp_path):
    path = tmp_path / "x.astm"
    rows = [f"{i},0,{s},3.1,.5" for i in (0.1, 0.6) for s in (0.2, 0.4)]
    lines = ["TITLE a", "VARS theta_i,phi_i,theta_s,phi_s,BRDF", *rows]
    path.write_bytes(end.join(lines).encode())
    assert len(read_measurement(path).reasons) == 4
