"""Files of other programs are recognised by their beginning; tables of relgloss never are."""

from __future__ import annotations

import io
import zipfile

import pytest

from relgloss_view.base.errors import InputError
from relgloss_view.base.foreign import (
    HEAD_BYTES,
    foreign_format,
    foreign_json,
    refuse_foreign,
)
from relgloss_view.base.resources import asset
from relgloss_view.material.files import load_material
from relgloss_view.measure.readers import read_measurement
from relgloss_view.picture.scene import file_kinds

ZEMAX = """\
#Data from a scatterometer
Source  Measured
Symmetry  PlaneSymmetrical
SpectralContent  Monochrome
ScatterType  BRDF
SampleRotation  1
0
AngleOfIncidence  2
0.0\t45.0
"""
#: As KimuraRyo/libbsdf reads it, src/Reader/LightToolsBsdfReader.cpp.
LIGHTTOOLS = """# made
Symmetry Asymmetric
SpectralContent Monochrome
ScatterAzimuth 2
0 180
ScatterRadial 2
0 45
DataBegin
AOI 20
POI 0
Side Front
Wavelength 550
ScatterType BRDF
TIS 0.5
0.1 0.1
0.1 0.1
DataEnd
"""
EULUMDAT = "A maker\n1\n1\n24\n15\n19\n5\nreport\nlamp\n" + "0\n" * 30


def zipped(*names):
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w") as archive:
        for name in names:
            archive.writestr(name, "x" * 50)
    return data.getvalue()


#: Content -> a word of the name that the message must have.
FOREIGN = {
    "Zemax": ZEMAX.encode(),
    "Zemax BSDF": ZEMAX.encode("utf-16"),
    "LightTools": LIGHTTOOLS.encode(),
    "Radiance": b'<?xml version="1.0"?>\n<WindowElement xmlns="http://windows.lbl.gov">',
    "CxF": b'<?xml version="1.0"?>\n<cc:CxF xmlns:cc="http://colorexchangeformat.com/CxF3-core">',
    "CxF file": '\ufeff<?xml version="1.0"?><CxF>'.encode("utf-16-le"),
    "XML": b"<?xml version='1.0'?><other/>",
    "web page": b"<!DOCTYPE html>\n<html>",
    "ASTM E1392": b"TITLE x\nNUM_POINTS 3\nVARS=theta_i,theta_s,phi_s,BRDF\n0,0,0,1\n",
    "ALTA": b"# made\n#DIM 3 3\n#PARAM_IN  RUSIN_TH_TD_PD\n#PARAM_OUT RGB_COLOR\n",
    "binary data file of ALTA": b"#DIM 3 3\n#PARAM_IN X\n#FORMAT binary\n#BEGIN_STREAM\n"
    + bytes(9),
    "AxF or other HDF5": b"\x89HDF\r\n\x1a\n" + bytes(40),
    "Speos": b"OPTIS - brdf surface file v9.0\n0\nScattering surface\n",
    "SSDD": b"# made\nVERSION 0.2\nAPI libbsdf-1.0.0\n\nDATA_TYPE brdf\nDATA binary\n\0\0\x80\x3f",
    "Integra": b"Source Measured\nTypeSym ASymmetrical 4D\nTypeColorModel BRDF\n",
    "IES": b"IESNA:LM-63-2002\n[TEST] 1\nTILT=NONE\n1 1000 1\n",
    "EULUMDAT": EULUMDAT.encode(),
    "CGATS": b"CGATS.17\nNUMBER_OF_FIELDS 4\nBEGIN_DATA_FORMAT\n",
    "ArgyllCMS": b'SPECT\n\nSPECTRAL_BANDS "36"\n',
    "Excel": zipped("[Content_Types].xml", "xl/workbook.xml"),
    "OpenDocument": b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1" + bytes(600),
    "text document": zipped("[Content_Types].xml", "word/document.xml"),
    "archive": zipped("table.csv"),
    "packed": b"\x1f\x8b\x08\x00" + bytes(20),
    "PDF": b"%PDF-1.7\n%\xe2\xe3\xcf\xd3",
    "picture": b"\xff\xd8\xff\xe0\x00\x10JFIF",
    "a picture": b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n",
    "SQLite": b"SQLite format 3\x00" + bytes(84),
    "RTF": b"{\\rtf1\\ansi",
    "MATLAB": b"MATLAB 5.0 MAT-file" + bytes(100),
    "numpy": b"\x93NUMPY\x01\x00v\x00{",
}


@pytest.mark.parametrize("name", FOREIGN)
def test_each_is_refused_by_its_name_with_a_remedy(name):
    with pytest.raises(InputError) as caught:
        refuse_foreign(FOREIGN[name][:HEAD_BYTES], "x.csv")
    message = str(caught.value)
    assert message.startswith("x.csv: this looks like a")
    assert name in message
    assert "; " in message


def test_nothing_that_comes_with_relgloss_is_foreign():
    files = [f for folder in ("papers", "spectra") for f in asset(folder).iterdir() if f.is_file()]
    assert len(files) > 8
    for file in files:
        assert foreign_format(file.read_bytes()[:HEAD_BYTES]) is None, file


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"# Source: Measured\n# Symmetry: none\nalpha_deg,beta_deg,gamma_deg,400,500",
        b"Source,Measured\nName,x\nalpha_deg,beta_deg,gamma_deg,400,500\n0,0,0,1,1\n",
        b"1\n1\n1\n" * 20,
        b"400 1\n405 1\n" * 30,
        b"[lamp]\nazimuth_deg = 3\n",
        b'{"format": "relgloss-material"}',
    ],
)
def test_what_is_not_foreign(content):
    assert foreign_format(content) is None


def test_binary_brdfs_and_hdf5_below_a_block_of_the_users():
    assert "RGL (.bsdf) or a polarised one (.pbsdf)" in foreign_format(b"tensor_file\0\1\0").name
    merl = bytes([90, 0, 0, 0, 90, 0, 0, 0, 180, 0, 0, 0])
    assert foreign_format(merl).name == "a MERL .binary"
    hdf = b"\x89HDF\r\n\x1a\n"
    assert foreign_format(bytes(512) + hdf).name == "an AxF or other HDF5 file"
    assert foreign_format(bytes(500) + hdf) is None


@pytest.mark.parametrize("end", ["\r", "\r\n"])
def test_lines_of_any_end_are_recognised(end):
    text = "TITLE x\nVARS theta_i,phi_i,theta_s,phi_s,R,G,B\n"
    assert foreign_format(text.replace("\n", end).encode()).key == "e1392"


def test_json_of_other_programs_is_named_with_the_command_that_reads_it(tmp_path):
    path = tmp_path / "a.json"
    for text, words in (
        ('{"scenes": [], "asset": {"version": "2.0"}}', "looks like a glTF file.*relgloss import"),
        ('{"open_pbr_surface": {"base_weight": 1}}', "OpenPBR in JSON.*MaterialX.*relgloss import"),
    ):
        path.write_text(text)
        for reads in (file_kinds.likely_kind, load_material, read_measurement):
            with pytest.raises(InputError, match=words):
                reads(path)
    assert foreign_json(b'{"asset": 1}') is None
    assert foreign_json(b'{"format": "relgloss-material", "materials": []}') is None
