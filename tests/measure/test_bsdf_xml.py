"""BSDF XML against Radiance's own reader, on files made here and on a real one."""

from pathlib import Path

import numpy as np
import pytest

from relgloss_view.base.errors import InputError
from relgloss_view.measure.readers import read_measurement
from relgloss_view.measure.readers.klems import known_bases

REAL = Path(__file__).resolve().parents[3] / "shared/data/formats"
DATA = "<ScatteringData>"

#: basis, theta and phi to the lamp, theta and phi to the receiver (degrees), and the BRDFs of
#: front and back that `pyradiance.bsdf.query` of pyradiance 1.3.1 (Radiance 6) gave for the files
#: that `document` makes, in both layouts. It calls the front the side below z = 0.
RADIANCE = [
    ("Full", 41.3, 288.3, 4.3, 290.3, 0.103571, 0.051785),
    ("Full", 29.3, 185.3, 38.3, 102.3, 0.142477, 0.071239),
    ("Full", 58.3, 19.3, 18.3, 137.3, 0.108983, 0.054491),
    ("Full", 13.3, 234.3, 45.3, 84.3, 0.247248, 0.123624),
    ("Full", 52.3, 30.3, 51.3, 303.3, 0.192265, 0.096132),
    ("Half", 19.3, 156.3, 18.3, 349.3, 0.219519, 0.109759),
    ("Half", 57.3, 199.3, 54.3, 97.3, 0.131632, 0.065816),
    ("Half", 23.3, 315.3, 13.3, 23.3, 0.148512, 0.074256),
    ("Quarter", 24.3, 243.3, 9.3, 312.3, 0.149911, 0.074956),
    ("Quarter", 22.3, 81.3, 34.3, 321.3, 0.140259, 0.070129),
    ("Quarter", 53.3, 313.3, 20.3, 6.3, 0.163946, 0.081973),
    ("Quarter", 36.3, 161.3, 12.3, 286.3, 0.107167, 0.053583),
    ("Quarter", 19.3, 181.3, 58.3, 84.3, 0.248401, 0.124201),
]
#: The same of 2011-SA1.XML, front and back.
RADIANCE_SA1 = [
    ("Full", 56.3, 245.3, 39.3, 166.3, 0.177971, 0.201312),
    ("Full", 58.3, 79.3, 23.3, 230.3, 0.177969, 0.201310),
    ("Full", 40.3, 38.3, 12.3, 248.3, 0.164168, 0.188268),
    ("Full", 21.3, 286.3, 5.3, 69.3, 0.156198, 0.180736),
]


def blocks(name, matrix, wavelength="Visible", kind="BRDF", directions=(("Front", 1), ("Back", 2))):
    made = ""
    for surface, share in directions:
        rows = "\n".join(", ".join(f"{x / share:.6f}" for x in row) + "," for row in matrix)
        made += (
            f"<WavelengthData><Wavelength unit='Integral'>{wavelength}</Wavelength>"
            f"<WavelengthDataBlock><WavelengthDataDirection>Reflection {surface}"
            f"</WavelengthDataDirection><ColumnAngleBasis>{name}</ColumnAngleBasis>"
            f"<RowAngleBasis>{name}</RowAngleBasis><ScatteringDataType>{kind}</ScatteringDataType>"
            f"<ScatteringData>\n{rows}\n</ScatteringData></WavelengthDataBlock></WavelengthData>"
        )
    return made


def document(name, inside, structure="Columns", basis=""):
    return (
        "<?xml version='1.0'?><WindowElement xmlns='http://windows.lbl.gov'><Optical><Layer>"
        "<Material><Name>made</Name></Material><DataDefinition><IncidentDataStructure>"
        f"{structure}</IncidentDataStructure>{basis}</DataDefinition>{inside}</Layer></Optical>"
        "</WindowElement>"
    )


def matrix(count):
    """Outgoing x incident, without any symmetry."""
    o, i = np.mgrid[:count, :count]
    return 0.05 + 0.2 * ((37 * o + 101 * i) % 997) / 997


def patch(basis, theta, phi):
    """The centre of the patch that holds a direction, by the definition of the basis."""
    ring = next(r for r in basis.rings if r.lower <= theta < r.upper)
    step = 360.0 / ring.count
    return ring.centre, round(phi / step) % ring.count * step


def unit(theta, phi):
    t, p = np.radians((theta, phi))
    return np.array([np.sin(t) * np.cos(p), np.sin(t) * np.sin(p), np.cos(t)])


def value_at(measurement, basis, to_lamp, to_receiver):
    """BRDF of the row whose patches hold two directions (theta, phi), 1/sr."""
    # The azimuths of the patches of incidence are those of where the light goes.
    theta, phi = patch(basis, to_lamp[0], (to_lamp[1] + 180.0) % 360.0)
    lamp, receiver = unit(theta, phi + 180.0), unit(*patch(basis, *to_receiver))
    at = np.all(np.isclose(measurement.to_lamp, lamp, atol=1e-9), axis=1)
    at &= np.all(np.isclose(measurement.to_receiver, receiver, atol=1e-9), axis=1)
    assert at.sum() == 1
    return float(measurement.radiance_factor[at, 1][0] / np.pi)


@pytest.mark.parametrize("structure", ["Columns", "Rows"])
@pytest.mark.parametrize("kind", ["Full", "Half", "Quarter"])
def test_values_are_those_of_radiance(tmp_path, kind, structure):
    basis = known_bases()[f"lbnl/klems {kind.lower()}"]
    numbers = matrix(basis.count)
    path = tmp_path / "a.xml"
    as_laid = numbers.T if structure == "Rows" else numbers
    path.write_text(document(kind, blocks(basis.name, as_laid), structure))
    surfaces = read_measurement(path), read_measurement(path, part="back")
    turned, count = 0, 0
    for name, ti, pi, to, po, *expected in RADIANCE:
        if name == kind:
            read = [value_at(m, basis, (ti, pi), (to, po)) for m in surfaces]
            assert read == pytest.approx(expected, rel=3e-4)
            other = value_at(surfaces[0], basis, (ti, pi + 180.0), (to, po))
            turned += abs(other / expected[0] - 1.0) > 3e-3
            count += 1
    assert turned >= count - 1 > 0  # with the lamp on the other side the values differ


@pytest.mark.skipif(not REAL.is_dir(), reason="needs ../shared")
def test_real_files():
    path = REAL / "2011-SA1.XML"
    surfaces = read_measurement(path), read_measurement(path, part="Reflection Back")
    basis = known_bases()["lbnl/klems full"]
    for _, ti, pi, to, po, *expected in RADIANCE_SA1:
        read = [value_at(m, basis, (ti, pi), (to, po)) for m in surfaces]
        assert read == pytest.approx(expected, rel=3e-4)
    assert surfaces[0].name == "Satine 5500 5%, White Pearl"
    for small in REAL.glob("2011-SA1-Small*.XML"):
        with pytest.raises(InputError, match=r"no reflection \(transmission front"):
            read_measurement(small)


def test_patches_blur_and_the_horizon_is_left_out(tmp_path):
    path = tmp_path / "a.xml"
    path.write_text(document("q", blocks("LBNL/Klems Quarter", matrix(41))))
    m = read_measurement(path)
    # By hand: disc of 9 degrees; rings 18 wide, cut into 8, 12 and 12.
    across = np.sin(np.radians([18.0, 36.0, 54.0])) * [45.0, 30.0, 30.0]
    variance = [9.0**2 / 4.0, *((18.0**2 + across**2) / 24.0)]
    sd = np.sqrt(np.average(variance, weights=[1, 8, 12, 12]))
    assert m.aperture_sd_deg == pytest.approx((sd, sd), abs=1e-3)
    assert len(m.reasons) == 33 * 33
    assert any("592 values of patches that reach the horizon" in w for w in m.warnings)
    assert any("reflection back (visible)" in w for w in m.warnings)


def test_spectra_colours_and_bases_of_the_file(tmp_path):
    basis = (
        "<AngleBasis><AngleBasisName>two</AngleBasisName><AngleBasisBlock><ThetaBounds><LowerTheta>"
        "0</LowerTheta><UpperTheta>30</UpperTheta></ThetaBounds><nPhis>1</nPhis></AngleBasisBlock>"
        "<AngleBasisBlock><Theta>50</Theta><nPhis>6</nPhis><ThetaBounds><LowerTheta>30</LowerTheta>"
        "<UpperTheta>70</UpperTheta></ThetaBounds></AngleBasisBlock></AngleBasis>"
    )
    flat, path = np.full((7, 7), 0.1), tmp_path / "a.xml"
    spectrum = "".join(blocks("two", flat * nm / 500, f"{nm}") for nm in (600, 400, 500))
    path.write_text(document("two", spectrum + blocks("two", flat, "Solar"), basis=basis))
    m = read_measurement(path)
    assert m.bands.wavelengths_nm == (400.0, 500.0, 600.0)
    assert m.radiance_factor[0] / np.pi == pytest.approx([0.08, 0.1, 0.12])
    assert m.to_receiver[-1, 2] == pytest.approx(np.cos(np.radians(50.0)))
    xyz = (("CIE-X", 0.9505), ("Visible", 1.0), ("CIE-Z", 1.089))
    colours = "".join(blocks("two", flat * share, word) for word, share in xyz)
    path.write_text(document("two", colours, basis=basis))
    assert read_measurement(path).radiance_factor[0] / np.pi == pytest.approx([0.1] * 3, abs=1e-4)


FLAT = blocks("LBNL/Klems Quarter", np.full((41, 41), 0.1))


@pytest.mark.parametrize(("content", "part", "message"), [
    (document("q", FLAT, "TensorTree4"), None, "AngleBasis '' of a tensor tree"),
    (document("q", FLAT, "Diagonal"), None, "IncidentDataStructure 'Diagonal'"),
    (document("q", FLAT.replace("Quarter", "Third")), None, "'LBNL/Klems Third' is not defined"),
    (document("q", FLAT.replace("BRDF", "Fractional Diffuse")), None, "'Fractional Diffuse'"),
    (document("q", FLAT.replace(DATA, DATA + "0.1,")), None, "more values; .* need 41 x 41"),
    (document("q", FLAT.replace(DATA + "\n0.100000,", DATA)), None, "1680 values; .* need 41 x 41"),
    (document("q", FLAT.replace(DATA + "\n0.100000", DATA + "x")), None, "found 'x' among"),
    (document("q", FLAT.replace("Visible", "Solar")), None, "given for solar only"),
    (document("q", FLAT), "top", "--part 'top': expected front or back"),
    (document("q", blocks("LBNL/Klems Quarter", np.eye(41), directions=[("Front", 1)])), "2",
     "no reflection back; the file holds reflection front"),
    (document("q", ""), None, "no WavelengthData"),
    (document("q", FLAT)[:-40], None, "line 85: not well-formed XML"),
], ids=range(12))  # fmt: skip
def test_damaged(tmp_path, content, part, message):
    path = tmp_path / "a.xml"
    path.write_text(content)
    with pytest.raises(InputError, match=message):
        read_measurement(path, part=part)
