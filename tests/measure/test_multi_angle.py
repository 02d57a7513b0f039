"""CGATS and CxF3: single spectra, and the geometries of multi-angle spectrophotometers."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from relgloss_view.base.errors import InputError
from relgloss_view.measure.readers import cxf, read_measurement
from relgloss_view.measure.readers.aspecular import directions, split_aspecular
from relgloss_view.measure.readers.recognised import is_table
from relgloss_view.measure.readers.spectrum import read_spectrum

CXF = Path(__file__).resolve().parents[3] / "shared" / "data" / "formats" / "sample.cxf"
NM = np.arange(400, 701, 10)
BYK = ("45as-15", "45as15", "45as25", "45as45", "45as75", "45as110")
#: Signed angle of the receiver from the normal, away from the lamp: 45 less the aspecular angle
#: (DIN 6175-2, ASTM E2194: 45as45 is along the normal).
POLAR = (60.0, 30.0, 20.0, 0.0, -30.0, -65.0)
RNG = np.random.default_rng(3)
READ = {g: RNG.uniform(0.1, 0.6, len(NM)) * (3.0 if g.endswith("15") else 1.0) for g in BYK}


def row(geometry, join=",", scale=1.0):
    return join.join(f"{scale * v:.6g}" for v in READ[geometry])


def cgats(geometries=BYK, fields="SPECTRAL_NM_{}", scale=1.0):
    names = " ".join(fields.format(w) for w in NM)
    lines = ["CGATS.17", 'ORIGINATOR "x"', 'KEYWORD "MEASUREMENT_GEOMETRY"', "BEGIN_DATA_FORMAT"]
    lines += [
        f"SAMPLE_ID SAMPLE_NAME MEASUREMENT_GEOMETRY\n{names}",
        "END_DATA_FORMAT",
        "# a remark",
    ]
    lines += ["NUMBER_OF_SETS 6", "BEGIN_DATA"]
    lines += [f'{k} "deep red" r{g} {row(g, " ", scale)}' for k, g in enumerate(geometries)]
    return "\n".join([*lines, "END_DATA", ""])


def multi_cxf(separate=True, names=True, angles=BYK):
    """CxF3 with a specification for each angle, or one for all with the name at each spectrum."""

    def brdf(g):
        lamp, aspecular = g.split("as")
        return (
            f'<BRDFAngle Notation="{g}"><IlluminationAngle>{lamp}</IlluminationAngle>'
            f"<Aspecular>{aspecular}</Aspecular></BRDFAngle>"
        )  # fmt: skip

    def specification(name, listed):
        return (
            f'<ColorSpecification Id="{name}"><MeasurementSpec><MeasurementType>'
            "Spectrum_Reflectance</MeasurementType><GeometryChoice><MultiAngle>"
            f"{''.join(map(brdf, listed))}</MultiAngle></GeometryChoice>"
            '<WavelengthRange StartWL="400" Increment="10"/></MeasurementSpec></ColorSpecification>'
        )

    spectra = "".join(
        f"<ReflectanceSpectrum {f'Name={chr(34)}{g}{chr(34)} ' if names else ''}"
        f'ColorSpecification="{g if separate else "all"}">{row(g, " ")}</ReflectanceSpectrum>'
        for g in angles
    )
    listed = "".join(specification(g, [g]) for g in angles) if separate else ""
    listed += "" if separate else specification("all", angles)
    return (
        '<?xml version="1.0"?><CxF xmlns="http://colorexchangeformat.com/CxF3-core"><Resources>'
        f'<ObjectCollection><Object Name="deep red" Id="1"><ColorValues>{spectra}</ColorValues>'
        f"</Object></ObjectCollection><ColorSpecificationCollection>{listed}"
        "</ColorSpecificationCollection></Resources></CxF>"
    )


HEAD = ",".join(f"{w} nm" for w in NM)
FORMS = {
    "CGATS": cgats(),
    "CGATS in percent, other field names": cgats(fields="nm{}", scale=100.0),
    "CxF, a specification for each angle": multi_cxf(names=False),
    "CxF, one specification, named spectra": multi_cxf(separate=False),
    "CxF, one specification, spectra in its order": multi_cxf(separate=False, names=False),
    "CSV, a row for each geometry": "BYK-mac i\nSample,Geometry," + HEAD + "\n"
    + "".join(f"deep red,{g[2:]},{row(g)}\n" for g in BYK),
    "CSV, angles in degrees, decimal commas": "name;angle;" + HEAD.replace(",", ";") + "\n"
    + "".join(f"deep red;{g[4:]}°;{row(g, ';', 100).replace('.', ',')}\n" for g in BYK),
    "CSV, geometry in the name": "name," + HEAD + "\n"
    + "".join(f"deep red r{g},{row(g)}\n" for g in BYK),
    "CSV, geometries side by side": "name," + ",".join(f"{g} {w}" for g in BYK for w in NM)
    + "\ndeep red," + ",".join(map(row, BYK)) + "\n",
}  # fmt: skip


@pytest.fixture
def file(tmp_path):
    def of(content):
        path = tmp_path / "readings.txt"
        path.write_text(content, encoding="utf-8")
        return path

    return of


@pytest.mark.parametrize("content", FORMS.values(), ids=FORMS.keys())
def test_the_geometries_of_a_byk_mac_become_directions(file, content):
    measured = read_measurement(file(content))
    receiver = measured.to_receiver
    polar = np.degrees(np.arctan2(receiver[:, 0], receiver[:, 2]))
    assert polar == pytest.approx(POLAR)
    assert measured.to_lamp == pytest.approx(np.tile([-(0.5**0.5), 0.0, 0.5**0.5], (6, 1)))
    assert measured.radiance_factor == pytest.approx(np.array([READ[g] for g in BYK]), rel=1e-5)
    assert measured.name == "deep red"
    assert is_table(file(content))
    along_the_normal = read_spectrum(file(content))
    assert along_the_normal.geometry == "45-0"
    assert along_the_normal.radiance_factor == pytest.approx(READ["45as45"], rel=1e-5)


def test_out_of_plane_geometries_as_x_rite_publishes_them():
    # Light (as it travels) and view directions with their names: the tests of X-Rite's open
    # formulation interface, colorimetry, "from carthesian" and its in- and out-of-plane sets.
    published = (
        ("45as110", (-0.906307787, 0.0, 0.422618262)),
        ("45as15", (0.5, 0.0, 0.866025404)),
        ("45as-15", (0.866025404, 0.0, 0.5)),
        ("45as15az15", (0.859789397, 0.066987298, 0.506236007)),
        ("45as25az-76", (0.713151411, -0.410064693, 0.568561353)),
        ("45as25az90", (0.640856, 0.422618, 0.640856)),
        ("r45as60az125.3", (0.0, 0.707, 0.707)),
        ("15as38.3az43", (0.640856, 0.422618, 0.640856)),
        ("15as46.9az-104.5", (0.000255605, -0.706904885, 0.707308573)),
    )
    geometries = [split_aspecular(name)[0] for name, _ in published]
    _, receiver = directions(geometries)
    assert receiver == pytest.approx(np.array([view for _, view in published]), abs=2e-3)
    mirrored = receiver * np.array([-1.0, 1.0, 1.0])  # a control: the side matters
    assert not np.allclose(mirrored, np.array([view for _, view in published]), atol=0.1)


def test_names_of_geometries_and_what_is_none():
    for words, name in (
        ("45asMinus15", "45as-15"), ("45:as15", "45as15"), ("45°/as 110°", "45as110"),
        ("45:-60 (as-15)", "45as-15"), ("15as\u221215", "15as-15"),
    ):  # fmt: skip
        geometry, rest = split_aspecular(words)
        assert (geometry.words, rest) == (name, "")
    for words in ("SPECTRAL_NM_400", "R450nm", "Kansas15", "LAB_A", "1e15as", "95as15", "45/0"):
        assert split_aspecular(words)[0] is None


def test_a_chart_of_single_spectra(file):
    names = ("red", "two words", "red")
    text = cgats().replace("MEASUREMENT_GEOMETRY\n", "LAB_L LAB_A LAB_B\n").split("BEGIN_DATA\n")[0]
    rows = [f'{k} "{n}" 50 0 {k} {row(BYK[k], " ")}' for k, n in enumerate(names)]
    path = file(text + "BEGIN_DATA\n" + "\n".join(rows) + "\nEND_DATA\n")
    with pytest.raises(InputError, match=r"3 samples.*--part: red \(1\), two words, red \(3\)"):
        read_spectrum(path)
    reading = read_spectrum(path, part="two words", quantity="radiance-factor")
    assert reading.radiance_factor == pytest.approx(READ[BYK[1]], rel=1e-5)
    with pytest.raises(InputError, match=r"3 spectra in a single geometry.*relgloss estimate"):
        read_measurement(path)


def test_a_chart_of_argyll_is_percent_and_its_geometry_that_of_the_keyword(file):
    head = 'CTI3\n\nDESCRIPTOR "x"\nMEASUREMENT_GEOMETRY "45/0"\nDEVICE_CLASS "OUTPUT"\n'
    head += 'SPECTRAL_BANDS "31"\nSPECTRAL_START_NM "400.0"\nSPECTRAL_END_NM "700.0"\n'
    fields = " ".join(f"SPEC_{w}" for w in NM)
    table = f"BEGIN_DATA_FORMAT\nSAMPLE_ID SAMPLE_LOC {fields}\nEND_DATA_FORMAT\nBEGIN_DATA\n"
    # A black in percent looks like a fraction; the keywords of Argyll settle it.
    black = " ".join("1.5" for _ in NM)
    reading = read_spectrum(file(f'{head}{table}1 "A1" {black}\nEND_DATA\n'))
    assert reading.radiance_factor == pytest.approx(0.015)
    assert (reading.name, reading.geometry) == ("1", "45-0")
    # A lamp's spectrum is none of a sample.
    lamp = f'SPECT\n\nMEAS_TYPE "EMISSION"\nSPECTRAL_NORM "1.0"\n{table}1 "A1" {black}\nEND_DATA\n'
    with pytest.raises(InputError, match="no sample with a spectrum"):
        read_spectrum(file(lamp))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("END_DATA_FORMAT", ""), "cut off"),
        (("deep red", 'deep" "red'), "names with spaces in quotes"),
        (("END_DATA\n", "7 x r45as15 0.5\nEND_DATA\n"), "a set of 4 values"),
        ((f" {row('45as15', ' ')}", " 0,1,2" + 30 * " 1"), "line 12, field SPECTRAL_NM_400"),
        (("SPECTRAL_NM_", "XYZ_"), "no sample with a spectrum"),
    ],
)
def test_a_damaged_cgats_file_is_refused_with_its_place(file, change, message):
    with pytest.raises(InputError, match=message):
        read_measurement(file(cgats().replace(*change)))


def test_colours_without_spectra_are_named_as_such(file):
    text = "CGATS.17\nBEGIN_DATA_FORMAT\nSAMPLE_ID LAB_L LAB_A LAB_B\nEND_DATA_FORMAT\nBEGIN_DATA\n"
    path = file(text + "red 46 50.5 25\nEND_DATA\n")
    with pytest.raises(InputError, match=r"no spectrum; pass it as --lab 46,50.5,25"):
        read_spectrum(path)


def test_a_cxf_file_that_declares_too_little_is_refused(file):
    for change, message in (
        (('<WavelengthRange StartWL="400" Increment="10"/>', ""), "WavelengthRange"),
        (("<Aspecular>15<", "<Aspecular>x<"), "Aspecular: found 'x'"),
        (("Spectrum_Reflectance", "Spectrum_Transmittance"), "no object with a Reflectance"),
    ):
        with pytest.raises(InputError, match=message):
            read_measurement(file(multi_cxf().replace(*change)))
    text = multi_cxf(separate=False, names=False)
    first, end = text.index("<ReflectanceSpectrum"), text.index("</ReflectanceSpectrum>")
    five_of_six = file(text[:first] + text[end + len("</ReflectanceSpectrum>") :])
    with pytest.raises(InputError, match="which of 6 angles"):
        read_measurement(five_of_six)


@pytest.mark.skipif(not CXF.exists(), reason="files that others wrote are not here")
def test_the_sample_of_colour_cxf_as_two_others_read_it():
    # colour-cxf 0.1.1 read_cxf, object 5; cxf2ti3 of Argyll 2.3.1 gives the same, times 100. All
    # 144 spectra were equal to colour-cxf's.
    samples = cxf.read_samples(CXF).samples
    assert len(samples) == 144
    reading = read_spectrum(CXF, part="5")
    assert reading.bands.wavelengths_nm == tuple(range(380, 681, 10))
    assert reading.radiance_factor[[0, 7, 8, 30]].tolist() == [
        0.2040332, 0.4976076, 0.5266417, 0.0401417,
    ]  # fmt: skip
    assert reading.geometry == "45-0"
    with pytest.raises(InputError, match=r"144 samples.*--part: 1, 2, 3, 4, 5, 6 and 138 more"):
        read_spectrum(CXF)
    with pytest.raises(InputError, match=r"144 spectra in a single geometry.*estimate"):
        read_measurement(CXF)
