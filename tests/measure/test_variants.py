"""Tables as many programs write them: read as the plain one, or refused with the remedy."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest
import variants

from relgloss_view import fit_material
from relgloss_view.measure.readers import read_measurement
from relgloss_view.measure.readers.recognised import is_table
from relgloss_view.picture.scene.file_kinds import MEASUREMENT, likely_kind

BASES = (variants.gcms, variants.generic)


@pytest.fixture
def plain(tmp_path):
    expected = {}
    for base in BASES:
        path = tmp_path / f"{base.__name__}.csv"
        path.write_bytes(base().content())
        expected[base] = read_measurement(path)
    return expected


def outcomes(tmp_path, plain, cases):
    counts, faults = Counter(), []
    for base, names in cases:
        result, text = variants.outcome(
            tmp_path / "t.csv", variants.build(base, names), plain[base]
        )
        counts[result] += 1
        if result not in (variants.READ, variants.REFUSED):
            faults.append((result, base.__name__, names, text))
    print(dict(counts))
    return counts, faults


def test_sixty_files_of_programs(tmp_path, plain):
    counts, faults = outcomes(tmp_path, plain, variants.sixty())
    assert faults == []
    assert sum(counts.values()) == 60
    assert counts[variants.READ] >= 54


def test_what_is_read_is_no_stranger_in_a_folder_or_the_window(tmp_path):
    path = tmp_path / "t.csv"
    bars = (variants.generic, {"separator": "bar"})
    for base, names in [*variants.sixty(), bars]:
        sheet = variants.build(base, names)
        path.write_bytes(sheet.content())
        if sheet.remedy is None:
            assert is_table(path), names
            assert likely_kind(path) == MEASUREMENT
    # A program that writes a table, and a lamp, are none.
    for content in (f"HEAD = {sheet.header}\nprint(HEAD)\n", "nm,W\n400,1\n410,2\n420,3\n"):
        path.write_text(content)
        assert not is_table(path)


def test_a_wrong_number_or_row_is_seen(tmp_path, plain):
    # The negative control of the comparison: one digit, one row, one heading.
    sheet = variants.generic()
    changes = (
        variants.replace(sheet, rows=(*sheet.rows[:-1], (*sheet.rows[-1][:-1], "0.2"))),
        variants.replace(sheet, rows=sheet.rows[:-1]),
        variants.replace(sheet, header=(*sheet.header[:-1], "701")),
        variants.replace(sheet, remedy="split"),
    )
    for changed in changes:
        result, _ = variants.outcome(tmp_path / "t.csv", changed, plain[variants.generic])
        assert result == variants.WRONG


@pytest.mark.slow
def test_every_change_alone_and_many_together(tmp_path, plain):
    cases = [(base, n) for n in [*variants.singles(), *variants.combined(600)] for base in BASES]
    _, faults = outcomes(tmp_path, plain, cases)
    assert faults == []


@pytest.mark.slow
def test_the_fit_is_the_same(tmp_path, plain):
    expected = {base: fit_material(plain[base], model="lobe") for base in BASES}
    path = tmp_path / "t.csv"
    read = 0
    for base, names in variants.sixty():
        sheet = variants.build(base, names)
        if sheet.remedy is not None:
            continue
        path.write_bytes(sheet.content())
        found = fit_material(read_measurement(path), model="lobe")
        read += 1
        np.testing.assert_allclose(found.diffuse.albedo, expected[base].diffuse.albedo, rtol=1e-9)
        for a, b in zip(found.specular, expected[base].specular, strict=True):
            np.testing.assert_allclose([*a.strength, a.s_deg], [*b.strength, b.s_deg], rtol=1e-9)
    assert read >= 54
