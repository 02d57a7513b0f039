"""CSV: a spreadsheet shows each text and runs none; what is read back is what was written."""

from __future__ import annotations

import csv

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from relgloss_view.base.csv_files import cell, read_csv, text_of, write_csv

DANGEROUS = [
    '=HYPERLINK("http://x")', "+1", "-1+1", "@SUM(1)", "\t=1", "\r=1", "\n=1", " =1", "＝1", "'=1",
    "a\x1b[31m", "a\u202eb", "a\nb", "a\\n\x00", "\ud800", "'", "-0.5",
]  # fmt: skip


@pytest.mark.parametrize("text", DANGEROUS, ids=ascii)
def test_a_dangerous_text_is_marked_and_comes_back(tmp_path, text):
    write_csv(tmp_path / "a.csv", ["label", "value"], [[text, -0.5]])
    raw = (tmp_path / "a.csv").read_text(encoding="utf-8")
    assert all(c.isprintable() or c == "\n" for c in raw)
    with (tmp_path / "a.csv").open(encoding="utf-8", newline="") as file:
        (_, (shown, number)) = csv.reader(file)
    assert shown.startswith("'")
    assert number == "-0.5"
    assert read_csv(tmp_path / "a.csv") == [["label", "value"], [text, "-0.5"]]


@pytest.mark.parametrize(
    "value",
    [-0.5, 0, 1e-300, np.float64(-2.5), np.int64(-3), True, None, "uncoated", "a=b", "10-2"],
)
def test_numbers_and_plain_texts_stay_as_they_are(value):
    assert cell(value) is value


@given(st.text())
def test_any_text_comes_back(text):
    written = cell(text)
    assert text_of(written) == text
    assert not written.lstrip().startswith(tuple("=+-@"))
    assert not set(written) & set("\t\r\n\0\x1b")
