"""Files of up to 64 MB that cost a reader most for their size: for mutated_inputs.py --large.

Each is as large as its reader accepts, or just beyond one of its limits.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

SIZE = 64_000_000  #: bytes
#: What reading one may take: seconds of processor time, and MB more than before.
MOST_S, MOST_MB = 5.0, 1000.0


def _filled(head: bytes, unit: bytes, tail: bytes = b"", size: int = SIZE) -> bytes:
    return head + unit * ((size - len(head) - len(tail)) // len(unit)) + tail


# Tables


def _table(bands: int, rows: int) -> bytes:
    head = b"# quantity: brdf\ntheta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,"
    head += b",".join(b"%.2f" % (380.0 + 0.6 * k) for k in range(bands)) + b"\n"
    block = b"".join(
        b"%d,0,%d,%d" % (k % 80, k // 80, k % 360) + b",.1" * bands + b"\n" for k in range(6400)
    )
    return head + block * max(rows // 6400, 1)


def _long_table(rows: int) -> bytes:
    head = b"# quantity: brdf\ntheta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,wavelength_nm,brdf\n"
    lines = (
        b"%d,0,%d,%d,%d,.1\n" % (k % 80, (k // 80) % 80, (k // 6400) % 360, nm)
        for k in range(rows // 4)
        for nm in (450, 500, 550, 600)
    )
    return head + b"".join(lines)


def _quoted(rows: int) -> bytes:
    return _table(5, rows).replace(b",0,", b',"0",')


def _signs(rows: int) -> bytes:
    """Rows that are read cell by cell."""
    return _table(5, rows).replace(b",.1,.1\n", b",n/a,.1\n")


def _samples_column(rows: int) -> bytes:
    head, _, body = _table(4, rows).partition(b"\n")
    columns, _, body = body.partition(b"\n")
    return head + b"\nsample," + columns + b"\n" + b"a," + body.replace(b"\n", b"\nb,")[:-2]


# Formats of other programs


def _ssdd(sizes: tuple[int, int, int, int], wavelengths: int, binary: bool = True) -> bytes:
    largest = (90.0, 360.0, 90.0, 360.0)
    lists = "".join(
        f"PARAM{k}_LIST {' '.join(f'{x:.7g}' for x in np.linspace(0.0, most, count))}\n"
        for k, (count, most) in enumerate(zip(sizes, largest, strict=True))
    )
    nm = " ".join(f"{x:.7g}" for x in 380.0 + 0.6 * np.arange(wavelengths))
    head = "VERSION 0.2\nDATA_TYPE brdf\nCOLOR_MODEL "
    head += f"spectrum\nWAVELENGTH_LIST {nm}\n" if wavelengths else "monochrome\n"
    head += f"PARAM_TYPE spherical_coordinate_system\n{lists}NAME a\nDATA "
    count = int(np.prod(sizes))
    if binary:
        numbers = np.full(count * max(wavelengths, 1), 0.1, "<f4").tobytes()
        return f"{head}binary\n".encode() + numbers
    row = " ".join([".1"] * max(wavelengths, 1)) + "\n"
    return f"{head}ascii\n{row * count}".encode()


def _astm(bands: int, rows: int) -> bytes:
    names = ",".join(f"{380 + 0.6 * k:.1f}nm" for k in range(bands)) if bands > 1 else "BRDF"
    head = f"TITLE a\nANGLE_UNIT degrees\nVARS theta_i,phi_i,theta_s,phi_s,{names}\n"
    values = ",.1" * bands
    block = "".join(f"{k % 80},0,{k // 80},{k % 360}{values}\n" for k in range(6400))
    return (head + block * max(rows // 6400, 1)).encode()


def _alta(rows: int, kind: str = "SPHERICAL_TL_PL_TV_PV", outputs: int = 3) -> bytes:
    inputs = 4 if kind.startswith("SPH") else 3
    out = "RGB_COLOR" if outputs == 3 else "INV_STERADIAN"
    head = f"#DIM {inputs} {outputs}\n#PARAM_IN {kind}\n#PARAM_OUT {out}\n"
    angles = ("%.2f 0 %.2f %.2f" if inputs == 4 else "%.2f %.2f %.2f") + " .1" * outputs + "\n"
    fields = 3
    block = "".join(
        angles % (k % 80 * 0.018, k // 80 * 0.018, k % 60 * 0.1)[:fields] for k in range(6400)
    )
    return (head + block * (rows // 6400)).encode()


def _zemax(sizes: tuple[int, int, int, int], colour: bool = False) -> bytes:
    names = ("SampleRotation", "AngleOfIncidence", "ScatterAzimuth", "ScatterRadial")
    most = (360.0, 80.0, 360.0, 90.0)
    content = "XYZ" if colour else "Monochrome"
    head = f"Symmetry PlaneSymmetrical\nSpectralContent {content}\nScatterType BRDF\n"
    for name, count, end in zip(names, sizes, most, strict=True):
        angles = " ".join(f"{x:.7g}" for x in np.linspace(0.0, end, count))
        head += f"{name} {count}\n{angles}\n"
    row = " ".join([".1"] * sizes[3]) + "\n"
    block = "TIS 0.3\n" + row * sizes[2]
    data = f"DataBegin\n{block * (sizes[0] * sizes[1])}DataEnd\n"
    blocks = [f"Tristimulus{c}\n{data}" for c in "XYZ"] if colour else [f"Monochrome\n{data}"]
    return (head + "".join(blocks)).encode()


def _xml(head: str, unit: str, tail: str, count: int | None = None) -> bytes:
    made = (head.encode(), unit.encode(), tail.encode())
    return made[0] + made[1] * count + made[2] if count is not None else _filled(*made)


def _bsdf_xml(wavelengths: int, basis: str = "LBNL/Klems Full", count: int = 145) -> bytes:
    values = "0.1 " * count**2
    blocks = "".join(
        f"<WavelengthData><Wavelength>{380 + k}</Wavelength><WavelengthDataBlock>"
        "<WavelengthDataDirection>Reflection Front</WavelengthDataDirection><ColumnAngleBasis>"
        f"{basis}</ColumnAngleBasis><RowAngleBasis>{basis}</RowAngleBasis><ScatteringDataType>BRDF"
        f"</ScatteringDataType><ScatteringData>{values}</ScatteringData></WavelengthDataBlock>"
        "</WavelengthData>"
        for k in range(wavelengths)
    )
    head = "<WindowElement><Optical><Layer><DataDefinition><IncidentDataStructure>Columns"
    head += "</IncidentDataStructure></DataDefinition>"
    return f"{head}{blocks}</Layer></Optical></WindowElement>".encode()


_CXF = "<CxF><Resources><ObjectCollection>"
_CXF_END = (
    "</ObjectCollection><ColorSpecificationCollection><ColorSpecification Id='s'><MeasurementSpec>"
    "<WavelengthRange StartWL='400' Increment='10'/></MeasurementSpec></ColorSpecification>"
    "</ColorSpecificationCollection></Resources></CxF>"
)


def _cxf(objects: int, bands: int, spectra: int = 1) -> bytes:
    values = " ".join(["0.1"] * bands)
    one = f"<ReflectanceSpectrum ColorSpecification='s'>{values}</ReflectanceSpectrum>" * spectra
    parts = (
        f"<Object Name='n{k}' Id='{k}'><ColorValues>{one}</ColorValues></Object>"
        for k in range(objects)
    )
    return (_CXF + "".join(parts) + _CXF_END).encode()


def _cxf_points(objects: int, points: int) -> bytes:
    one = "".join(f"<SpectralPoint WL='{380 + k}'>0.1</SpectralPoint>" for k in range(points))
    unit = f"<CustomSpectrum>{one}</CustomSpectrum>"
    unit = f"<Object Name='n'><ColorValues>{unit}</ColorValues></Object>"
    return (_CXF + unit * objects + _CXF_END).encode()


def _cgats(sets: int, bands: int) -> bytes:
    fields = " ".join(f"SPECTRAL_NM_{380 + k}" for k in range(bands))
    row = " ".join(["0.1"] * bands)
    head = f"CGATS.17\nBEGIN_DATA_FORMAT\nSAMPLE_NAME {fields}\nEND_DATA_FORMAT\nBEGIN_DATA\n"
    return (head + "".join(f"n{k} {row}\n" for k in range(sets)) + "END_DATA\n").encode()


def _spectra(rows: int, bands: int) -> bytes:
    head = "name," + ",".join(f"{380 + 0.5 * k:g}" for k in range(bands)) + "\n"
    row = ",".join(["0.1"] * bands)
    return (head + "".join(f"n{k},{row}\n" for k in range(rows))).encode()


def _columns_of_spectra(columns: int, rows: int) -> bytes:
    head = "nm," + ",".join(f"n{k}" for k in range(columns)) + "\n"
    row = ",".join(["0.1"] * columns)
    return (head + "".join(f"{380 + k},{row}\n" for k in range(rows))).encode()


#: What makes each file, by the name of its reader and its own.
LARGE: Mapping[str, Callable[[], bytes]] = {
    "declared: a table of 400,000 rows, 35 bands": lambda: _table(35, 400_000)[:SIZE],
    "declared: a table of 1 million rows": lambda: _table(5, 998_400)[:SIZE],
    "declared: a table of 2.4 million rows": lambda: _table(3, 2_400_000)[:SIZE],
    "declared: a table of 5 million rows": lambda: _filled(
        b"# quantity: brdf\nalpha_deg,beta_deg,gamma_deg,500,600\n", b"9,8,7,1,1\n", size=50_000_000
    ),
    "declared: a table of 6 million rows": lambda: _filled(
        b"# quantity: brdf\nalpha_deg,beta_deg,gamma_deg,500,600\n", b"9,8,7,1,1\n"
    ),
    "declared: a table of 4,300 columns": lambda: _table(4300, 1)[:SIZE],
    "declared: a table of 10,000 columns": lambda: _table(9990, 1)[:SIZE],
    "declared: rows read cell by cell": lambda: _signs(998_400)[:SIZE],
    "declared: rows with quotes": lambda: _quoted(998_400)[:SIZE],
    "declared: a column of samples": lambda: _samples_column(998_400)[:SIZE],
    "declared: a long table of 1 million rows": lambda: _long_table(1_000_000)[:SIZE],
    "declared: a long table, all of one geometry": lambda: _filled(
        b"# quantity: brdf\ntheta_i,phi_i,theta_r,phi_r,nm,brdf\n",
        b"9,0,5,0,450,.1\n",
        size=15_000_000,
    ),
    "declared: empty lines": lambda: _filled(b"", b"\n"),
    "declared: empty rows": lambda: _filled(_table(5, 6400), b",,,,,,,,\n"),
    "declared: titles": lambda: _filled(b"", b"quantity of light: brdf and more words\n"),
    "declared: UTF-16": lambda: _table(5, 998_400)[: SIZE // 2].decode().encode("utf-16"),
    "ssdd: binary, 3 million directions": lambda: _ssdd((90, 1, 90, 370), 5),
    "ssdd: binary, a spectrum": lambda: _ssdd((20, 1, 20, 90), 440),
    "ssdd: binary, 8,000 wavelengths": lambda: _ssdd((10, 1, 10, 20), 4000),
    "ssdd: binary, one list of 100,000": lambda: _ssdd((1, 1, 30, 100_000), 5),
    "ssdd: text, 3 million directions": lambda: _ssdd((90, 1, 90, 370), 3, binary=False),
    "ssdd: text, monochrome": lambda: _ssdd((90, 1, 90, 370), 0, binary=False),
    "ssdd: lines of remarks": lambda: _filled(_ssdd((2, 1, 2, 2), 0, binary=False)[:-6], b"#\n"),
    "astm-e1392: 1 million rows": lambda: _astm(8, 1_000_000),
    "astm-e1392: 1 million rows of one value": lambda: _astm(1, 1_000_000),
    "astm-e1392: 12 million numbers": lambda: _astm(400, 27_000)[:SIZE],
    "astm-e1392: empty lines": lambda: _filled(_astm(1, 1), b"\n"),
    "alta: 1 million rows": lambda: _alta(1_000_000),
    "alta: 1 million rows by half-vectors": lambda: _alta(1_000_000, "RUSIN_TH_TD_PD"),
    "alta: 1 million rows of one value": lambda: _alta(1_000_000, outputs=1),
    "zemax: 1 million readings of a colour": lambda: _zemax((1, 20, 180, 270), colour=True),
    "zemax: 1 million readings in long rows": lambda: _zemax((1, 1, 1, 1_000_000)),
    "zemax: 1 million readings in short rows": lambda: _zemax((1, 20, 50_000, 1)),
    "zemax: counts beyond the data": lambda: _filled(
        b"Symmetry ASymmetrical\nSpectralContent Monochrome\nAngleOfIncidence 1\n0\n"
        b"ScatterAzimuth 1000\n",
        b"1 2 3\n",
    ),
    "zemax: one line of numbers": lambda: _filled(
        b"Symmetry ASymmetrical\nSpectralContent Monochrome\nAngleOfIncidence 1000000\n", b"1 "
    ),
    "zemax: unknown words": lambda: _filled(
        b"Symmetry ASymmetrical\nSpectralContent Monochrome\nAngleOfIncidence 1\n0\n", b"a b c\n"
    ),
    "bsdf-xml: 95 wavelengths": lambda: _bsdf_xml(95),
    "bsdf-xml: 700 wavelengths": lambda: _bsdf_xml(700),
    "bsdf-xml: one long text": lambda: _xml(
        "<WindowElement><Optical><Layer><WavelengthData><Wavelength>Visible</Wavelength>"
        "<WavelengthDataBlock><WavelengthDataDirection>Reflection Front</WavelengthDataDirection>"
        "<ScatteringData>",
        "1 ",
        "</ScatteringData></WavelengthDataBlock></WavelengthData></Layer>"
        "</Optical></WindowElement>",
    ),
    "bsdf-xml: elements": lambda: _xml(
        "<WindowElement>", "<Layer>1</Layer>", "</WindowElement>", 299_000
    ),
    "bsdf-xml: empty elements": lambda: _xml(
        "<WindowElement>", "<a/>", "</WindowElement>", 599_000
    ),
    "bsdf-xml: attributes": lambda: _xml(
        "<WindowElement>", "<a b='1' c='2'/>", "</WindowElement>", 149_000
    ),
    "bsdf-xml: many layers": lambda: _xml(
        "<WindowElement>", "<Layer><WavelengthData/></Layer>", "</WindowElement>", 199_000
    ),
    "bsdf-xml: blocks": lambda: _xml(
        "<WindowElement><Layer><WavelengthData><Wavelength>Visible</Wavelength>",
        "<WavelengthDataBlock><WavelengthDataDirection>Reflection Back</WavelengthDataDirection>"
        "</WavelengthDataBlock>",
        "</WavelengthData></Layer></WindowElement>",
        149_000,
    ),
    "bsdf-xml: entities": lambda: _xml("<WindowElement>", "&lt;", "</WindowElement>"),
    "bsdf-xml: characters by number": lambda: _xml("<WindowElement>", "&#65;", "</WindowElement>"),
    "bsdf-xml: line ends": lambda: _xml("<WindowElement>", "\n", "</WindowElement>"),
    "bsdf-xml: UTF-16": lambda: (
        _xml("<WindowElement>", "ä\n", "</WindowElement>", 15_000_000).decode().encode("utf-16")
    ),
    "samples: CxF of 16,000 objects": lambda: _cxf(16_000, 31),
    "samples: CxF of 20,000 objects": lambda: _cxf(20_000, 25),
    "samples: CxF of long spectra": lambda: _cxf(250, 2000),
    "samples: CxF of one object with many spectra": lambda: _cxf(1, 31, 16_000),
    "samples: CxF of points": lambda: _cxf_points(150, 1900),
    "samples: CxF of 290,000 specifications": lambda: _xml(
        _CXF + "</ObjectCollection>", "<ColorSpecification Id='s'/>", "</Resources></CxF>", 290_000
    ),
    "samples: CxF of angles": lambda: _xml(
        _CXF + "</ObjectCollection><ColorSpecification Id='s'><MeasurementSpec><GeometryChoice>",
        "<BRDFAngle Notation='a'><Aspecular>15</Aspecular></BRDFAngle>",
        "</GeometryChoice></MeasurementSpec></ColorSpecification></Resources></CxF>",
        149_000,
    ),
    "samples: CGATS of 16,000 sets": lambda: _cgats(16_000, 31),
    "samples: CGATS of 30,000 sets": lambda: _cgats(30_000, 16),
    "samples: CGATS of 4,900 fields": lambda: _cgats(102, 4900),
    "samples: CGATS of keywords": lambda: _filled(b"CGATS.17\n", b'ABC "d e f"\n', size=33_000_000),
    "samples: CGATS, one line of quotes": lambda: _filled(b"CGATS.17\n", b'" "', size=33_000_000),
    "samples: a row a spectrum": lambda: _spectra(16_000, 31),
    "samples: long rows": lambda: _spectra(500, 990),
    "spectrum: 10,000 columns of spectra": lambda: _columns_of_spectra(9_000, 400),
    "spectrum: 1 million rows of a spectrum": lambda: b"".join(
        b"%.4f,.1\n" % (300 + k * 1e-3) for k in range(1_000_000)
    ),
    "spectrum: titles": lambda: _filled(b"", b"a b c,d\n", size=33_000_000),
    "lamp: rows": lambda: b"".join(b"%.4f,.1\n" % (300 + k * 1e-2) for k in range(100_000)),
}
