"""Files of other programs, recognised by how they begin and refused by their names.

Each entry names the format in a reader's words and the step that helps, so that nobody has to
find out from a message about line 3, column 1 that a spreadsheet's own file was given.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

from relgloss_view.base.decoding import decoded_beginning, wide_encoding
from relgloss_view.base.errors import InputError

HEAD_BYTES = 16384  #: of a file's beginning, which are enough to recognise it

_CSV = "save or export the table as CSV"
_LATER = "relgloss does not read these yet; export the readings as CSV (docs/files.md)"
#: Of formats that measure.readers reads, where a lamp or a material is wanted.
_FIT = "it is a table of a surface: make a material of it with `relgloss fit FILE -o NAME.json`"
_TO_SSDD = (
    "open it in BSDF Processor, which writes .ssdd, and give that; or export the readings as CSV"
)
_SAMPLES = (
    "it holds reflectances of samples: give it to `relgloss fit` where it holds 12 geometries of "
    "one, or to `relgloss estimate --spectrum`"
)
#: Of materials of other programs, where a material or a table is wanted.
_IMPORT = "make a material of it with `relgloss import FILE -o NAME.json`"
_TABLE = "give the measured table as CSV, an RGL .bsdf or a MERL .binary"
_SPECTRUM = "relgloss does not read these; save two columns, wavelength (nm) and value, as text"


@dataclass(frozen=True)
class Foreign:
    """A recognised format: its name with its article, and what can be done."""

    name: str
    remedy: str
    #: of a format for which measure.readers has a reader, or is to have one; '' for all others
    key: str = ""


_SHEET = Foreign("an Excel or OpenDocument spreadsheet", _CSV)
_PICTURE = Foreign("a picture", _TABLE)
_PACKED = Foreign("a packed archive", "unpack it and give the table inside")
_DATA = Foreign("a container of binary data", _CSV)
_PROGRAM = Foreign("a program", _TABLE)
_HDF5 = Foreign(
    "an AxF or other HDF5 file",
    "export its readings as CSV; for AxF, X-Rite's own programs do that (docs/files.md)",
)

#: The first bytes of binary formats. Those of .zip and OLE files are looked into first.
_MAGIC: tuple[tuple[bytes, Foreign], ...] = (
    (b"%PDF", Foreign("a PDF document", "ask for the numbers behind it as CSV")),
    (b"\x89PNG\r\n", _PICTURE),
    (b"\xff\xd8\xff", _PICTURE),
    (b"glTF", Foreign("a glTF file", _IMPORT)),
    (b"GIF8", _PICTURE),
    (b"II*\x00", _PICTURE),
    (b"MM\x00*", _PICTURE),
    (b"v/1\x01", _PICTURE),
    (b"8BPS", _PICTURE),
    (b"#?RADIANCE", _PICTURE),
    (b"#?RGBE", _PICTURE),
    (b"\x1f\x8b", _PACKED),
    (b"BZh", _PACKED),
    (b"\xfd7zXZ\x00", _PACKED),
    (b"7z\xbc\xaf\x27\x1c", _PACKED),
    (b"Rar!\x1a", _PACKED),
    (b"\x89HDF\r\n", _HDF5),
    # Their reader looks at them first; here they are named where a lamp or a material is wanted.
    (b"tensor_file\x00", Foreign("a BRDF of RGL (.bsdf) or a polarised one (.pbsdf)", _FIT)),
    (b"Z\x00\x00\x00Z\x00\x00\x00\xb4\x00\x00\x00", Foreign("a MERL .binary", _FIT)),
    (b"CDF\x01", _DATA),
    (b"CDF\x02", _DATA),
    (b"MATLAB 5.0", Foreign("a MATLAB file", "export the table with writetable as CSV")),
    (b"\x93NUMPY", Foreign("a numpy array", _CSV)),
    (b"PAR1", _DATA),
    (b"SQLite format 3\x00", Foreign("an SQLite database", _TABLE)),
    (b"\x7fELF", _PROGRAM),
    (b"MZ\x90\x00", _PROGRAM),
    (b"%!PS", Foreign("a PostScript document", "ask for the numbers behind it as CSV")),
    (b"{\\rtf", Foreign("a formatted text (RTF)", "save it as plain text")),
)

#: Elements whose presence near the top of an XML file names its kind; all other XML comes last.
_XML: tuple[tuple[str, Foreign], ...] = (
    (
        r"<(\w+:)?WindowElement\b",
        Foreign("a BSDF in XML (WINDOW, Radiance)", _FIT, "bsdf-xml"),
    ),
    (r"<(\w+:)?CxF\b", Foreign("a CxF file of colour measurements", _SAMPLES, "cxf")),
    (r"IESTM2714|<(\w+:)?SpectralDistribution\b", Foreign("a TM-27 spectrum (.spdx)", _SPECTRUM)),
    (r"<!DOCTYPE html|<html\b", Foreign("a web page", "download the file itself")),
    (r"<svg\b", _PICTURE),
    (r"<(\w+:)?Workbook\b", _SHEET),
    (r"<scene\b", Foreign("a scene of Mitsuba", "give a scene of relgloss or a measured table")),
    (r"<(\w+:)?materialx\b", Foreign("a MaterialX document", _IMPORT)),
)

_SSDD = Foreign("an SSDD file (surface scattering data)", _FIT, "ssdd")

#: Formats of text with binary numbers below; every expression of an entry must be met.
_MIXED: tuple[tuple[tuple[bytes, ...], Foreign], ...] = (
    (
        (rb"^[ \t]*VERSION[ \t:=]+\d", rb"^[ \t]*DATA_TYPE[ \t:=]+\w"),
        _SSDD,
    ),
    (
        (rb"^[ \t]*#\s*FORMAT\s+binary", rb"^[ \t]*#\s*PARAM_IN\b"),
        Foreign("a binary data file of ALTA", "save it as text with ALTA's data2data, or as CSV"),
    ),
)

_ZEMAX_WORDS = (
    "symmetry", "spectralcontent", "scattertype", "samplerotation", "angleofincidence",
    "scatterazimuth", "scatterradial", "databegin",
)  # fmt: skip

#: What JSON of other programs holds; every expression of an entry must be met.
_JSON: tuple[tuple[tuple[bytes, ...], Foreign], ...] = (
    (
        (rb'"asset"\s*:', rb'"(accessors|bufferViews|meshes|materials|scenes)"\s*:'),
        Foreign("a glTF file", _IMPORT),
    ),
    (
        (rb'"(open_?pbr\w*|base_metalness|specular_roughness)"\s*:',),
        Foreign(
            "a material of OpenPBR in JSON",
            "save it as MaterialX (.mtlx) and make a material of that with `relgloss import "
            "FILE.mtlx -o NAME.json`",
        ),
    ),
)

_GROUND = re.MULTILINE | re.IGNORECASE
#: What the lines of text formats begin with; every expression of an entry must be met.
_TEXTS: tuple[tuple[tuple[str, ...], Foreign], ...] = (
    (
        (r"^[ \t]*VARS\b[ \t=:].*\btheta_?[iso]",),
        Foreign("a BRDF in the format of ASTM E1392", _FIT, "e1392"),
    ),
    (
        (r"\AOPTIS[ -]+(Anisotropic BSDF|brdf) surface file\b",),
        Foreign("a Speos BSDF file", _FIT, "speos"),
    ),
    (
        (r"\AOPTIS\b",),
        Foreign("a file of Speos that holds no BRDF", "give .anisotropicbsdf or .brdf of Speos"),
    ),
    (
        (r"^TypeSym\b|^TypeColorModel\b|^TypeData\b", r"^(sigma|phi|psi|theta|Source)\b"),
        Foreign("an Integra .ddr or .ddt file", _TO_SSDD),
    ),
    (
        (r"^[ \t]*#\s*PARAM_IN\b", r"^[ \t]*#\s*DIM\b"),
        Foreign("a data file of ALTA", _FIT, "alta"),
    ),
    # In bytes it is found above, with a binary table; here in UTF-16 or with other line ends.
    ((r"^[ \t]*VERSION\s+\d", r"^[ \t]*DATA_TYPE\s+\w"), _SSDD),
    (
        (r"\AIESNA|^TILT *=",),
        Foreign(
            "an IES photometric file of a luminaire, which holds no spectrum",
            "give a spectrum as text of wavelength (nm) and power, or a table of readings",
        ),
    ),
    (
        (r"\ACGATS|\AIT8|^BEGIN_DATA_FORMAT\b",),
        Foreign("a CGATS or IT8 colour chart", _SAMPLES, "cgats"),
    ),
    ((r"\ACTI[123]\b",), Foreign("a chart of ArgyllCMS", _SAMPLES, "cgats")),
    ((r"\ASPECT\b",), Foreign("a spectrum of ArgyllCMS (.sp)", _SPECTRUM, "cgats")),
    ((r"\A##TITLE *=",), Foreign("a JCAMP-DX spectrum", _SPECTRUM)),
    ((r"^STD_NAME *=|^\[STANDARD_DATA",), Foreign("a QTX file of Datacolor", _LATER)),
    ((r"\A#! */",), Foreign("a script", _TABLE)),
)
_EULUMDAT = Foreign(
    "a EULUMDAT photometric file of a luminaire, which holds no spectrum",
    "give a spectrum as text of wavelength (nm) and power, or a table of readings",
)


def foreign_format(head: bytes) -> Foreign | None:
    """The format of another program that a file's beginning shows, or None.

    head: the first HEAD_BYTES of the file. JSON and TOML are relgloss's own and not among them.

    >>> foreign_format(b"%PDF-1.7 ...").name
    'a PDF document'
    >>> foreign_format(b"# quantity: brdf\\nalpha_deg,beta_deg,gamma_deg,400,500") is None
    True
    """
    packed = _office(head)
    if packed is not None:
        return packed
    for magic, foreign in _MAGIC:
        if head.startswith(magic):
            return foreign
    if any(head[at:].startswith(b"\x89HDF\r\n") for at in (512, 1024, 2048)):
        return _HDF5  # below a block of the user's
    if head.startswith(b"RIFF") and head[8:12] == b"WEBP":
        return _PICTURE
    if head.startswith(b"BM") and head[6:10] == b"\x00\x00\x00\x00":
        return _PICTURE
    lines = decoded_beginning(head).encode() if wide_encoding(head) is not None else head
    lines = lines.removeprefix(b"\xef\xbb\xbf").replace(b"\r", b"\n")
    for patterns, foreign in _MIXED:
        if all(re.search(pattern, lines, re.MULTILINE | re.IGNORECASE) for pattern in patterns):
            return foreign
    if head[:1] and b"\x00" in head and wide_encoding(head) is None:
        return None
    text = decoded_beginning(head).replace("\r\n", "\n").replace("\r", "\n")
    return _of_text(text.lstrip())


def foreign_json(data: bytes) -> Foreign | None:
    """The format of another program that JSON shows by its keys, or None.

    >>> foreign_json(b'{"asset": {"version": "2.0"}, "materials": []}').name
    'a glTF file'
    """
    return next(
        (foreign for keys, foreign in _JSON
         if all(re.search(key, data, re.IGNORECASE) for key in keys)),
        None,
    )  # fmt: skip


def refuse_foreign_json(data: bytes, path: object) -> None:
    """Raise InputError, naming the format, where JSON is of another program."""
    foreign = foreign_json(data)
    if foreign is not None:
        raise InputError(f"{path}: this looks like {foreign.name}; {foreign.remedy}")


def refuse_foreign(head: bytes, path: object) -> None:
    """Raise InputError, naming the format, where a file begins as one of another program."""
    foreign = foreign_format(head)
    if foreign is not None:
        raise InputError(f"{path}: this looks like {foreign.name}; {foreign.remedy}")


def _office(head: bytes) -> Foreign | None:
    """What a .zip or OLE file holds: both are what office programs write, among others."""
    if head.startswith(b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1"):
        return _SHEET
    if not head.startswith((b"PK\x03\x04", b"PK\x05\x06")):
        return None
    if b"word/" in head or b"opendocument.text" in head:
        return Foreign("a text document", "save the table as CSV or plain text")
    if b"xl/" in head or b"[Content_Types].xml" in head or b"opendocument.spreadsheet" in head:
        return _SHEET
    return _PACKED


def _of_text(text: str) -> Foreign | None:
    if text.startswith("<"):
        for pattern, foreign in _XML:
            if re.search(pattern, text, re.IGNORECASE):
                return foreign
        return Foreign("an XML file", _TABLE) if re.match(r"<[?!\w]", text) else None
    words = {line.split(maxsplit=1)[0].lower() for line in text.splitlines() if line.strip()}
    if {"aoi", "side"} <= words and "scatterradial" in words:
        return Foreign("a LightTools BSDF file", _LATER, "lighttools")
    if len(words & set(_ZEMAX_WORDS)) >= 3:
        return Foreign("a Zemax BSDF file", _FIT, "zemax")
    text = "\n".join(line.strip() for line in text.splitlines())
    for patterns, foreign in _TEXTS:
        if all(re.search(pattern, text, _GROUND) for pattern in patterns):
            return foreign
    return _EULUMDAT if _is_eulumdat(text) else None


def _is_eulumdat(text: str) -> bool:
    """Whether lines 2 to 6 are EULUMDAT's: type 0 to 3, symmetry 0 to 4, counts and distances."""
    maker, *lines = [line.strip() for line in text.splitlines()[:26]] or [""]
    if len(lines) < 25 or not re.search(r"[^\W\d_]", maker) or not re.fullmatch(r"[0-3]", lines[0]):
        return False
    return bool(re.fullmatch(r"[0-4]", lines[1])) and all(
        re.fullmatch(r"\d+([.,]\d+)?", line) for line in lines[2:6]
    )
