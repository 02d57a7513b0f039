"""Text tables: what is read, converted, masked and warned of."""

from __future__ import annotations

import numpy as np
import pytest
from files import GCMS, GENERIC

from relgloss_view.base.errors import InputError
from relgloss_view.base.resources import asset
from relgloss_view.measure import gonio, table
from relgloss_view.measure.bands import RGB
from relgloss_view.measure.readers import read_measurement
from relgloss_view.measure.readers.gcms import write_gcms_csv


@pytest.fixture
def read(tmp_path):
    def from_text(text, name="t.csv", **arguments):
        path = tmp_path / name
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return read_measurement(path, **arguments)

    return from_text


def test_gcms_table(read):
    m = read(GCMS)
    assert (m.name, m.source, m.gamma_s_deg) == ("test paper", "synthetic", 15.0)
    assert m.bands.wavelengths_nm == (400.0, 500.0, 600.0)
    assert m.kept.all()
    assert m.warnings == ()
    np.testing.assert_array_equal(m.radiance_factor[1], [1.10, 1.20, 1.30])
    np.testing.assert_array_equal(m.group, [-45, -45, -45, -60])
    np.testing.assert_allclose(m.to_lamp[0], [-np.sqrt(0.5), 0, np.sqrt(0.5)], atol=1e-15)
    np.testing.assert_allclose(m.to_receiver[0], [0, 0, 1], atol=1e-15)


def test_generic_table(read):
    m = read(GENERIC)
    assert m.bands == RGB
    assert m.gamma_s_deg is None
    assert m.name == "t"
    np.testing.assert_allclose(m.radiance_factor[0], np.pi * np.array([0.1, 0.2, 0.3]))
    np.testing.assert_allclose(m.to_receiver[0], [0, 0.5, np.sqrt(0.75)], atol=1e-15)
    np.testing.assert_allclose(m.to_lamp[1], [-np.sqrt(0.5), 0, np.sqrt(0.5)], atol=1e-15)
    np.testing.assert_array_equal(m.group, [0, 45])


@pytest.mark.parametrize(
    "change",
    [
        lambda s: s.replace("\n", "\r\n"),
        lambda s: s.replace("\n", "\r"),
        lambda s: "\ufeff" + s,
        lambda s: s.replace(",", ";"),
        lambda s: s.replace(",", "\t"),
        lambda s: s.replace(",", "  ,\t "),
        lambda s: s.replace("# ", "#   ").replace(": ", " :  "),
        lambda s: s.replace("\n", "\n\n") + "\n\n",
        lambda s: s.replace("-60,10", "# a remark, in between\n-60,10"),
        lambda s: s.replace("500", "500 nm"),
        lambda s: s.upper().replace("TEST PAPER", "test paper").replace("SYNTHETIC", "synthetic"),
        lambda s: "# operator: somebody\n# free text\n#\n" + s,
        lambda s: s.rstrip("\n"),
    ],
)
def test_spelling_of_a_table_does_not_matter(read, change):
    expected, found = read(GCMS), read(change(GCMS))
    np.testing.assert_array_equal(found.radiance_factor, expected.radiance_factor)
    np.testing.assert_array_equal(found.to_lamp, expected.to_lamp)
    assert (found.name, found.source, found.bands) == (
        expected.name,
        expected.source,
        expected.bands,
    )


@pytest.mark.parametrize(("text", "bands"), [(GCMS, 3), (GENERIC, 3)])
@pytest.mark.parametrize("name", ["t.bsdf", "t.binary", "t", "t.png"])
def test_the_name_does_not_decide_the_format(read, text, bands, name):
    assert read(text, name).bands.count == bands


def test_columns_may_stand_in_another_order(read):
    text = (
        "# quantity: brdf\nphi_r_deg,theta_r_deg,phi_i_deg,theta_i_deg,R,G,B\n90,30,0,0,0.1,0.2,0.3"
    )
    np.testing.assert_array_equal(read(text).to_receiver, read(GENERIC).to_receiver[:1])


def test_the_three_quantities_agree(read):
    # One sample of BRDF 0.2/sr seen at 60 degrees: pi f = 0.6283, f cos = 0.1.
    head = "theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,550,560\n10,0,60,0,"
    for quantity, value in [("radiance-factor", 0.2 * np.pi), ("brdf", 0.2), ("brdf-cos", 0.1)]:
        m = read(f"# quantity: {quantity}\n{head}{value!r},{value!r}")
        assert m.radiance_factor[0, 0] == pytest.approx(0.2 * np.pi, rel=1e-12)


def test_the_argument_wins_over_the_file_with_a_warning(read):
    m = read(GENERIC, quantity="radiance-factor")
    assert m.radiance_factor[0, 0] == 0.1
    assert "brdf" in m.warnings[0]
    assert "radiance-factor" in m.warnings[0]
    assert read(GENERIC, quantity="brdf").warnings == ()
    m = read(GCMS, gamma_s_deg=0)
    assert m.gamma_s_deg == 0.0
    assert any("gamma_s_deg 15" in w for w in m.warnings)
    assert "not used" in read(GENERIC, gamma_s_deg=0).warnings[0]


def test_an_undeclared_quantity_is_asked_for(read):
    text = GENERIC.replace("# quantity: brdf\n", "")
    with pytest.raises(InputError, match=r"# quantity: radiance-factor.*--quantity"):
        read(text)
    assert read(text, quantity="brdf").kept.all()


def test_gamma_s_argument_over_file_over_default(read):
    assert read(GCMS.replace("gamma_s_deg: 15", "gamma_s_deg: 5")).gamma_s_deg == 5.0
    assert read(GCMS.replace("gamma_s_deg: 15", "gamma_s_deg: 5"), gamma_s_deg=2).gamma_s_deg == 2.0
    assert read(GCMS.replace("# gamma_s_deg: 15\n", "")).gamma_s_deg == 15.0


def test_a_table_that_cannot_show_an_undeclared_gamma_s_warns(read):
    flat = "# quantity: brdf\nalpha_deg,beta_deg,gamma_deg,550,560\n-45,45,0,9,9\n-45,30,0,1,1\n"
    assert "gamma_s is not declared" in read(flat).warnings[0]
    assert read("# gamma_s_deg: 0\n" + flat).warnings == ()


@pytest.mark.parametrize(
    ("text", "expected"), [("0.3", (0.3, 0.3)), ("0.3 0.4", (0.3, 0.4)), ("0.3,0.4", (0.3, 0.4))]
)
def test_aperture(read, text, expected):
    assert read(f"# aperture_sd_deg: {text}\n{GCMS}").aperture_sd_deg == expected


def test_samples_are_masked_with_reasons_and_counted(read):
    text = """\
# quantity: radiance-factor
# gamma_s_deg: 15
# saturation: 5
alpha_deg,beta_deg,gamma_deg,500,600
-45,0,15,0.1,0.2
-45,0,15,,0.2
-45,0,15,-0.1,0.2
-45,0,15,0.1,5.0
-45,0,15,0.1,4.999
30,38,15,0.1,0.2
30,39,15,0.1,0.2
-88,0,15,0.1,0.2
0,88,15,0.1,0.2
-45,90,15,0.1,0.2
-45,0,-80,0.1,0.2
"""
    m = read(text)
    assert list(m.reasons) == [
        table.KEPT,
        table.MISSING,
        table.NEGATIVE,
        table.SATURATED,
        table.KEPT,
        table.OCCLUDED,
        table.KEPT,
        table.GRAZING,
        table.GRAZING,
        table.BELOW,
        table.BELOW,
    ]
    assert len(m.radiance_factor) == 11
    assert m.left_out() == {
        table.MISSING: 1,
        table.NEGATIVE: 1,
        table.SATURATED: 1,
        table.OCCLUDED: 1,
        table.GRAZING: 2,
        table.BELOW: 2,
    }
    assert np.isfinite(m.radiance_factor[m.kept]).all()


def test_generic_arms_do_not_occlude(read):
    text = "# quantity: brdf\ntheta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,550,560\n30,0,32,0,1,1"
    assert read(text).kept.all()


def test_saturation_is_in_the_unit_of_the_file(read):
    # 0.4/sr is a radiance factor of 1.26: above 1 only after conversion.
    m = read("# saturation: 1\n" + GENERIC)
    assert m.kept.all()


def test_nothing_left_is_refused(read):
    text = "# quantity: brdf\nalpha_deg,beta_deg,gamma_deg,550,560\n30,30,15,1,1\n-45,45,15,-1,1\n"
    with pytest.raises(InputError, match=r"none of the 2 samples.*1 negative"):
        read(text)


def test_contradicting_repeats_are_kept_with_a_warning(read):
    repeated = GCMS + "-45,0,15,0.10,0.20,0.30\n"
    assert read(repeated).warnings == ()
    contradicting = GCMS + "-45,0,15,0.20,0.30,0.40\n"
    m = read(contradicting)
    assert m.kept.sum() == 5
    assert "1 repeated geometry" in m.warnings[0]
    assert "-45, 0, 15" in m.warnings[0]


def test_what_is_written_is_read_back(tmp_path):
    grid = gonio.gcms4_grid()
    nm = list(range(390, 731, 10))
    values = np.random.default_rng(0).uniform(0.01, 3, (len(grid), len(nm)))
    values[3, 5] = np.nan
    path = tmp_path / "t.csv"
    write_gcms_csv(
        path,
        name="made up",
        source="synthetic,\nof course",
        quantity="radiance-factor",
        gamma_s_deg=15,
        angles_deg=grid,
        wavelengths_nm=nm,
        values=values,
        comments={"aperture_sd_deg": "0.1 0.2"},
        digits=4,
    )
    m = read_measurement(path)
    assert (m.name, m.source) == ("made up", "synthetic, of course")
    assert m.aperture_sd_deg == (0.1, 0.2)
    assert m.bands.wavelengths_nm == tuple(float(x) for x in nm)
    # Half a unit of the last of four digits.
    np.testing.assert_allclose(
        np.where(np.isnan(values), np.nan, m.radiance_factor), values, rtol=0.5e-3 + 1e-12
    )
    assert np.isfinite(m.radiance_factor[3, 5])
    assert "1 single value is filled" in m.warnings[0]
    i, o = gonio.gcms_directions(*grid.T, 15.0)
    np.testing.assert_array_equal(m.to_lamp, i)
    np.testing.assert_array_equal(m.to_receiver, o)
    # Occluded by hand: |alpha - beta| <= 8, as both arms tilt together.
    occluded = np.abs(grid[:, 0] - grid[:, 1]) <= 8
    assert m.left_out() == {table.OCCLUDED: int(occluded.sum())}


def test_the_writer_refuses_shapes_that_do_not_agree(tmp_path):
    with pytest.raises(ValueError, match="2 bands"):
        write_gcms_csv(
            tmp_path / "t.csv",
            name="x",
            source="x",
            quantity="brdf",
            gamma_s_deg=0,
            angles_deg=np.zeros((4, 3)),
            wavelengths_nm=[500, 600],
            values=np.zeros((4, 3)),
        )
    assert not list(tmp_path.iterdir())


class TestBuiltIn:
    def test_a_papers_table_is_read_by_its_name_from_anywhere(self, tmp_path, monkeypatch):
        monkeypatch.chdir(tmp_path)
        by_name = read_measurement("matte-coated")
        by_file = read_measurement(asset("papers", "matte-coated.csv"))
        np.testing.assert_array_equal(by_name.radiance_factor, by_file.radiance_factor)
        assert by_name.file == by_file.file
        assert by_name.synthetic

    def test_a_file_of_that_name_goes_first(self, tmp_path, monkeypatch):
        monkeypatch.chdir(tmp_path)
        text = asset("papers", "uncoated.csv").read_text().replace("uncoated, green ink", "mine")
        (tmp_path / "matte-coated").write_text(text)
        assert read_measurement("matte-coated").name == "mine"

    def test_another_name_is_a_file_that_is_not_there(self):
        with pytest.raises(InputError, match="can't be read"):
            read_measurement("velvet")
