"""Spectra of spectrophotometers in text, as spreadsheets and instruments save them."""

from __future__ import annotations

import re

import numpy as np
import pytest

from relgloss_view.base.errors import InputError
from relgloss_view.fitting.purpose import ESTIMATE, purpose_of
from relgloss_view.measure.readers import read_measurement
from relgloss_view.measure.readers.spectrum import read_spectrum

NM = np.arange(400, 701, 10)
RED = 0.05 + 0.8 / (1.0 + np.exp(-(NM - 580) / 15.0))
BLUE = 0.9 - RED


def column(form="{},{:.5f}", values=RED):
    return [form.format(w, v) for w, v in zip(NM, values, strict=True)]


def comma(lines):
    return [line.replace(".", ",") for line in lines]


def row(*words, values, join=","):
    return join.join([*words, *(f"{v:.5f}" for v in values)])


PERCENT = column("{},{:.3f}", 100 * RED)
HEADER = ",".join(f"{w}nm" for w in NM)
FORMS = {
    "plain": column(),
    "headings": ["Wavelength (nm),Reflectance", *column()],
    "percent by its heading": ["nm,R%", *PERCENT],
    "percent by its values": ["nm,R", *PERCENT],
    "percent signs": ["nm,R", *[f"{line}%" for line in PERCENT]],
    "declared percent": ["# quantity: radiance-factor-percent", "nm,R", *PERCENT],
    "semicolons, decimal commas": ["Wellenlänge;Remission", *comma(column("{};{:.5f}"))],
    "sep=": ["sep=;", "nm;R", *comma(column("{};{:.5f}"))],
    "units": ["wavelength\tR", *column("{}nm\t{:.5f}")],
    "titles, blanks, footer": [
        "Report 5,,,", "Date: 2024-01-01,,,", "nm,R,,", *column("{},{:.5f},,"), ",,,", "mean,0.3,,",
    ],
    "declared percent, no header": ["# quantity: radiance-factor-percent", *PERCENT],
    "bars": ["nm | R", *column("{} | {:.5f}")],
    "bars around, decimal commas": comma(column("| {} | {:.5f} |")),
    "spaces, decimal commas": comma(column("{} {:.5f}")),
    "a blank column before": ["nm,R", *column(",{},{:.5f}")],
    "an index before": [",nm,R", *[f"{k},{line}" for k, line in enumerate(column())]],
    "wavelengths last": ["R,nm", *[",".join(reversed(line.split(","))) for line in column()]],
    "downwards": column()[::-1],
    "windows-1252": "\n".join(["Wellenlänge;R", *column("{};{:.5f}")]).encode("cp1252"),
    "utf-16": "\n".join(["nm\tR", *column("{}\t{:.5f}")]).encode("utf-16"),
    "utf-16 without a mark": "\n".join(["nm\tR", *column("{}\t{:.5f}")]).encode("utf-16-le"),
    "byte order mark": "\n".join(column()).encode("utf-8-sig"),
    "one row": ["name," + HEADER, row("red", values=RED)],
    "one row of bare wavelengths": [",".join(map(str, NM)), row(values=RED)],
    "one row, R400, decimal commas": [
        "Probe 7", "Probe;" + ";".join(f"R{w}" for w in NM),
        *comma([row("rot", values=RED, join=";")]),
    ],
    "transposed": [
        "Wavelength," + ",".join(map(str, NM)), row("Reflectance (%)", values=100 * RED),
    ],
    "one geometry of a gonio table": [
        "# quantity: radiance-factor",
        "theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg," + HEADER,
        row("45,180,0,0", values=RED), row("45,180,30,0", values=BLUE),
    ],
}  # fmt: skip


@pytest.fixture
def read(tmp_path):
    def from_content(content, **options):
        if isinstance(content, list):
            content = "\n".join(content) + "\n"
        path = tmp_path / "sample.csv"
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return read_spectrum(path, **options)

    return from_content


@pytest.mark.parametrize("content", FORMS.values(), ids=FORMS.keys())
def test_each_form_has_the_same_reflectances(read, content):
    reading = read(content)
    assert reading.bands.wavelengths_nm == tuple(NM)
    assert reading.radiance_factor == pytest.approx(RED, abs=1e-5)


def test_one_of_several_samples_by_name_or_number(read):
    for content in (
        [f"nm,red,blue {'%'}", *[f"{w},{a},{b}" for w, a, b in zip(NM, RED, BLUE, strict=True)]],
        ["name," + HEADER, row("red", values=RED), row("blue %", values=BLUE)],
    ):
        for part in ("BLUE %", "2"):
            reading = read(content, part=part, quantity="radiance-factor")
            assert reading.radiance_factor == pytest.approx(BLUE, abs=1e-5)
        with pytest.raises(InputError, match=r"2 samples.*--part: red, blue"):
            read(content)
        with pytest.raises(InputError, match=r"no sample 'green' among 2: red"):
            read(content, part="green")


@pytest.mark.parametrize(
    ("content", "remedy"),
    [
        (["nm,power", *column()], "'power' and no reflectance"),
        (["nm,R", *column(values=2 * RED)], "--quantity radiance-factor-percent"),
        (["nm,R", *column(values=900 * RED)], "no raw signal"),
        (["um,R", *[f"{w / 1000:.4f},{v}" for w, v in zip(NM, RED, strict=True)]], "micrometres"),
        (["nm,R", *column(values=RED - 0.2)], "below zero by more than noise"),
        ([*column(), "500,0.9"], "two reflectances of 500 nm"),
        (column()[8:], "from 430 to 670 nm"),
        ([f"{w},{v},{v}" for w, v in zip(NM, RED, strict=True)], "keep two columns"),
        (["hello"], "two columns"),
        (b"", "empty"),
        (b"%PDF-1.4", "PDF"),
    ],
)
def test_what_is_no_reflectance_is_refused_with_its_remedy(read, content, remedy):
    with pytest.raises(InputError, match=re.escape(remedy)):
        read(content)


def test_the_geometry_is_taken_from_the_titles_alone(read):
    for title, geometry in (
        ("45/0, M1", "45-0"), ("SCI", "d-8-sci"), ("d/8 SPEX", "d-8-sce"), ("SCI and SCE", None),
        ("2045-01-02", None), ("nothing", None),
    ):  # fmt: skip
        assert read([title, "nm,R", *column()]).geometry == geometry


def test_fine_and_wide_scans_are_thinned_to_what_the_eye_sees(read):
    nm = np.arange(250.0, 1000.0, 0.25)
    reading = read([f"{w:.2f},0.5" for w in nm])
    assert reading.bands.wavelengths_nm == tuple(range(360, 831))
    assert reading.radiance_factor == pytest.approx(0.5)
    assert len(reading.notes) == 3


@pytest.mark.parametrize(("receiver", "taken"), [(0, True), (9.9, True), (10.2, False)])
def test_what_measure_announces_as_45_0_is_read_as_45_0(tmp_path, receiver, taken):
    """CIE 15:2004 allows the receiver 10 degrees; a nearer row that is left out does not count."""
    path = tmp_path / "table.csv"
    rows = [
        row(f"45,180,{receiver},0", values=RED),
        row("45,180,0,0", values=np.full(len(NM), np.nan)),
    ]
    head = ["# quantity: radiance-factor", "theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg," + HEADER]
    path.write_text("\n".join([*head, *rows]) + "\n")
    assert (purpose_of(read_measurement(path)).use == ESTIMATE) == taken
    if taken:
        assert read_spectrum(path).radiance_factor == pytest.approx(RED, abs=1e-5)
    else:
        with pytest.raises(InputError, match="no geometry 45/0"):
            read_spectrum(path)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ([*column()[:20], *PERCENT[20:30], *[f"{p}%" for p in PERCENT[30:]]], "write all of them"),
        (["name," + HEADER, row("red", values=RED) + "%"], "write all of them alike"),
        ([line.replace(".", ",") for line in column()], "semicolons or tabs"),
        ([",".join(reversed(line.split(","))) for line in column()], "put them first"),
        (["nm,R", *column()[:5], "450,OL", *column()[6:]], "leave the cell empty"),
    ],
)
def test_what_is_asked_about(read, content, message):
    with pytest.raises(InputError, match=message):
        read(content)


@pytest.mark.parametrize("sign", ["---", "#NV", "-1.#IND", "9999"])
def test_signs_of_no_reading(read, sign):
    lines = column()
    lines[5] = f"{NM[5]},{sign}"
    assert np.delete(read(lines).radiance_factor - RED, 5) == pytest.approx(0.0, abs=1e-5)
    assert read(lines).radiance_factor[5] == pytest.approx((RED[4] + RED[6]) / 2, abs=1e-5)


def test_a_bad_value_of_a_gonio_table_is_no_colour(read):
    """Noise below zero counts as 0, as in every spectrum; what no surface has is refused."""
    head = ["# quantity: radiance-factor", "theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg," + HEADER]

    def table(value):
        values = np.full(len(NM), 0.2)
        values[10] = value
        return [*head, row("45,180,0,0", values=values)]

    assert read(table(-0.0005)).radiance_factor.min() >= 0.0
    assert read(table(0.2)).radiance_factor == pytest.approx(0.2)
    with pytest.raises(InputError, match="the perfect diffuser has 1"):
        read([*head, row("45,180,0,0", values=np.full(len(NM), 2.5))])
