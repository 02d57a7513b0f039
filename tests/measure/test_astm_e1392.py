"""ASTM E1392: conventions of Cornell's files as libbsdf's AstmReader and ALTA read them."""

from __future__ import annotations

import numpy as np
import pytest

from relgloss_view.base.errors import InputError
from relgloss_view.measure.bands import RGB, WIDE_RGB
from relgloss_view.measure.gonio import spherical
from relgloss_view.measure.readers import read_measurement

#: The header that two independent readers expect: 'KEY value' lines, NUM_POINTS, then VARS.
HEAD = "TITLE made up\nSAMPLE a card\nNUM_POINTS 3\nVARS theta_i,phi_i,theta_s,phi_s,{}\n"
RADIANS = "0.5,3.14159265,0.5,0.0,{}\n0.5,3.14159265,0.2,0.3,{}\n0.5,3.14159265,0.2,1.0,{}\n"


@pytest.fixture
def read(tmp_path):
    path = tmp_path / "card.astm"

    def reader(text, **options):
        path.write_text(text, encoding="utf-8")
        return read_measurement(path, **options)

    return reader


def rows(*values):
    return RADIANS.format(*values)


def test_radians_and_the_mirror_direction(read):
    """phi_s = phi_i + pi is the mirror direction, as in libbsdf's spherical coordinates."""
    m = read(HEAD.format("R,G,B") + rows("1,0.5,0.25", "0.1,0.1,0.2", "0.1,0.1,0.3"))
    assert m.bands == RGB
    assert m.name == "a card"
    np.testing.assert_allclose(m.radiance_factor[0] / np.pi, [1, 0.5, 0.25])
    np.testing.assert_allclose(m.to_receiver[0], m.to_lamp[0] * [-1, -1, 1], atol=1e-8)
    np.testing.assert_allclose(m.to_receiver[1], spherical(*np.degrees([0.2, 0.3])), atol=1e-12)
    assert any("read in radians" in w for w in m.warnings)
    turned = read(HEAD.format("R,G,B") + rows("1,1,1", "1,1,1", "1,1,1"), mirror="same-side")
    np.testing.assert_allclose(turned.to_receiver[0], turned.to_lamp[0], atol=1e-8)


def test_degrees(read):
    text = HEAD.format("BRDF") + "30,180,30,0,0.5\n30,180,10,20,0.1\n60,180,10,20,0.1\n"
    m = read(text)
    np.testing.assert_allclose(m.to_receiver[0], m.to_lamp[0] * [-1, -1, 1], atol=1e-12)
    np.testing.assert_allclose(m.radiance_factor[0] / np.pi, 0.5)
    assert any("one channel (BRDF)" in w for w in m.warnings)
    assert any("read in degrees" in w for w in m.warnings)
    with pytest.raises(InputError, match="angle-unit"):
        read(text, angle_unit="radians")
    small = HEAD.format("BRDF") + "1,0,1,0,0.5\n1,1,1,1,0.1\n1,0,0,0,0.1\n"
    assert np.degrees(np.arccos(read(small).to_lamp[0, 2])) == pytest.approx(57.2958)
    assert np.degrees(np.arccos(read(small, angle_unit="degrees").to_lamp[0, 2])) == pytest.approx(
        1.0
    )


def test_spectra_and_xyz(read):
    m = read(HEAD.format("650nm,450nm,550nm") + rows("3,1,2", ".3,.1,.2", ".3,.1,.2"))
    assert m.bands.wavelengths_nm == (450, 550, 650)
    np.testing.assert_allclose(m.radiance_factor[0] / np.pi, [1, 2, 3])
    xyz = read(HEAD.format("X,Y,Z") + rows(*["0.2851,0.3,0.3267"] * 3))
    np.testing.assert_allclose(xyz.radiance_factor / np.pi, 0.3, atol=2e-4)
    # Cornell's RGB are not fitted into the gamut of a monitor: they have negative values.
    blue = read(HEAD.format("R,G,B") + rows(*["-0.01,0.05,0.3"] * 3))
    assert blue.bands == WIDE_RGB
    assert blue.kept.all()


def test_what_instruments_vary(read):
    ends = read(HEAD.format("450nm,550nm") + rows("1,2,", "1,", "1,2,"))  # commas at the ends
    assert ends.left_out() == {"missing": 1}
    text = HEAD.replace("VARS ", "VARS=").replace("NUM_POINTS 3", "NUM_POINTS 9")
    m = read(text.format("BRDF,temperature") + rows("1,20", "1,20", ",20"))
    assert m.left_out() == {"missing": 1}
    assert any("declares 9 points and holds 3" in w for w in m.warnings)
    assert any("passed over columns without a BRDF: temperature" in w for w in m.warnings)
    header = HEAD.format("CCBRDF").replace("TITLE made up", "ANGLE_UNIT radians")
    m = read(header + rows("1", "1", "1"))
    np.testing.assert_allclose(m.radiance_factor[0] / np.pi, 1 / np.cos(0.5))


@pytest.mark.parametrize(
    "change",
    [
        lambda text: text.replace("\n", "\r"),
        lambda text: text.replace(",", ";"),
        lambda text: text.replace(",", ";").replace(".", ","),
        lambda text: text.upper(),
        lambda text: text.replace("nm", "[nm]"),
        lambda text: text.replace("_", "").replace("NUMPOINTS", "NUM_POINTS"),
        lambda text: text + "END\n",
    ],
)
def test_what_other_writers_vary(read, change):
    text = HEAD.format("450nm,550nm") + rows("1.5,2", "1,2", "1,2")
    plain, other = read(text), read(change(text))
    assert other.bands == plain.bands
    np.testing.assert_array_equal(other.radiance_factor, plain.radiance_factor)
    np.testing.assert_array_equal(other.to_receiver, plain.to_receiver)


def test_rows_below_words_are_refused(read):
    with pytest.raises(InputError, match="line 9: numbers below a line of words"):
        read(HEAD.format("BRDF") + rows("1", "1", "1") + "END\n0.5,3.1,0.5,0.0,1\n")


BAD = {
    "no phi_s": ("VARS theta_i,theta_s,BRDF\n1,1,1\n", "no column phi_s"),
    "twice": ("VARS theta_i,theta_i,theta_s,phi_s,BRDF\n1,1,1,1,1\n", "two columns theta_i"),
    "unknown": ("VARS theta_i,theta_s,phi_s,S,P\n1,1,1,1,1\n", "expected R,G,B"),
    "a word": (HEAD.format("BRDF") + "1,1,1,1,x\n", "line 5, column 5"),
    "too few": (HEAD.format("BRDF") + "1,1,1,1\n", "4 fields, expected 5"),
    "none": (HEAD.format("BRDF"), "none of the 0"),
    "a wavelength": (HEAD.format("450nm,450nm") + rows(*["1,1"] * 3), "VARS"),
    "huge": (HEAD.format("BRDF") + rows("1", "1", "1e300"), "row 3"),
}


@pytest.mark.parametrize("fault", BAD)
def test_one_line_names_the_fault(read, fault):
    text, words = BAD[fault]
    with pytest.raises(InputError) as caught:
        read(text)
    assert words in str(caught.value)
