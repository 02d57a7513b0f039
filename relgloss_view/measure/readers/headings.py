"""What the headings of columns mean: angles in several words, wavelengths with and without unit."""

from __future__ import annotations

import re
from dataclasses import dataclass
from decimal import Decimal

RADIANS, DEGREES = "radians", "degrees"

#: Words of an angle and of a direction, as programs and instruments write them.
_ANGLES = {
    "theta": "theta", "polar": "theta", "zenith": "theta", "th": "theta",
    "phi": "phi", "ph": "phi", "azimuth": "phi", "azimuthal": "phi", "az": "phi", "azi": "phi",
}  # fmt: skip
_DIRECTIONS = {
    **dict.fromkeys(
        ("i", "in", "inc", "incident", "incidence", "incoming", "lamp", "light", "source",
         "illumination", "illuminant", "illum", "l"), "i"),
    **dict.fromkeys(
        ("r", "o", "out", "outgoing", "reflected", "reflection", "refl", "receiver", "detector",
         "view", "viewing", "observer", "observation", "scatter", "scattered", "scattering",
         "exitant", "det", "detection", "sensor", "camera", "sca", "s", "v"), "r"),
}  # fmt: skip
_ARMS = ("alpha", "beta", "gamma")
_IDLE = {"angle", "of", "the", "direction", "deg"}
#: Angles in one word; of remote sensing, those of sun and sensor.
_WHOLE = {
    "aoi": ("theta", "i"),
    "sza": ("theta", "i"),
    "saa": ("phi", "i"),
    "vza": ("theta", "r"),
    "vaa": ("phi", "r"),
}
_GREEK = {
    "θ": "theta",
    "ϑ": "theta",
    "φ": "phi",
    "ϕ": "phi",
    "α": "alpha",
    "β": "beta",
    "γ": "gamma",
}
_GLUED = re.compile(r"(theta|phi|th|ph)_?(i|in|inc|o|out|r|refl|s|sca|v|l)")
#: The degree sign, and what Windows-1252 shows for that of Mac OS, DOS, Shift-JIS, GBK, EUC-JP.
_DEGREE = re.compile(
    r"\bdegrees?\b|[°º˚]|(?<=[\s\[(/])(?:[¡øßã\ufffd]|\x81[‹\x8b]|¡[ãë])(?=$|[\s\])])"
)
_RADIAN = re.compile(r"\b(radians?|rads?)\b")
_BAND = re.compile(
    r"(?:(?:spectral|spec|wavelength|wl|lambda|λ|nm|r|refl|reflectance|reflectance factor|"
    r"radiance factor|rho|brdf|w|x)[ _=:.-]*){0,2}"
    r"(\d+(?:[.,]\d*)?(?:e[+-]?\d\d?)?)[ .]*"
    r"(nm|nanometers?|nanometres?|µm|μm|um|micrometers?|micrometres?|microns?|å|angstroms?)?[ .]*",
    re.ASCII,
)
_PERCENT = re.compile(r"[\[(/ ]\s*(?:%|percent|pct)\s*[\])]?$|%$")
_UNIT = re.compile(r"\s*[\[(/]\s*(?:-|1|a\.?u\.?|1\s*/\s*sr|sr\s*\^?\s*-1)\s*[\])]?$")
_WAVELENGTH = re.compile(
    r"(?:wavelengths?|wave ?length|lambda|λ|wl|wellenlänge|longueur d'onde|band)"
    r"(?: nm| nanomet(?:er|re)s?)?|nm"
)
#: Columns of one reading a row, with the quantity where the word is one.
_VALUES = {
    "brdf": "brdf", "ccbrdf": "brdf-cos", "brdf cos": "brdf-cos", "brdfcos": "brdf-cos",
    "radiance factor": "radiance-factor", "reflectance factor": "radiance-factor",
    "luminance factor": "radiance-factor", "brf": "radiance-factor",
    **dict.fromkeys(("value", "values", "reading", "reflectance", "refl", "r", "y"), ""),
}  # fmt: skip
#: Columns beside the readings that are passed over by their name.
_BESIDE = re.compile(
    r"(?:unnamed \d+|index|idx|id|row|row (?:no|number|id)|no|nr|number|n|line|point|"
    r"(?:measurement|meas|point|scan|record|run|sequence|seq|file|position|pos)"
    r"(?: ?(?:no|nr|number|id|index|name))?|"
    r"date|time|date ?time|timestamp|time stamp|(?:measurement|meas|scan) (?:date|time)|"
    r"comments?|remarks?|notes?|operator|user|instrument|device|serial(?: ?(?:no|number))?|"
    r"repeat|repeats|repetition|replicate|rep|repeat (?:no|number|id)|"
    r"file ?name|path|temp|temperature|humidity|integration(?: time)?|exposure(?: time)?|gain|"
    r"averages|quality|status|flags?)(?: (?:ms|s|us|µs|c|°c|k|%|utc|iso))?"
)
_SAMPLE = re.compile(
    r"(?:sample|specimen|material|surface|patch|colou?r|ink|substrate|board)"
    r"(?: ?(?:no|nr|number|id|name|code))?"
)
_COLOURS = {"r": "R", "g": "G", "b": "B", "red": "R", "green": "G", "blue": "B"}


LONGEST = 80  #: characters of a heading


@dataclass(frozen=True)
class AngleHeading:
    """An angle column: its name in relgloss, its unit if the heading has one."""

    name: str  #: such as 'theta_i_deg'
    unit: str | None  #: RADIANS, DEGREES, None, or what else stands in brackets


def angle_heading(heading: str) -> AngleHeading | None:
    """The angle that a heading names, or None.

    >>> angle_heading("Theta_i [deg]"), angle_heading("incident polar angle").name
    (AngleHeading(name='theta_i_deg', unit='degrees'), 'theta_i_deg')
    >>> angle_heading("φ_out (rad)"), angle_heading("550 nm")
    (AngleHeading(name='phi_r_deg', unit='radians'), None)
    """
    text = heading.strip().strip("\ufeff")
    if not text or len(text) > 60 or text[0] in "0123456789+-.":
        return None
    # thetaIn, ThetaR: the capital begins a word.
    text = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", text).lower() if not text.isupper() else text.lower()
    text = text.replace("$", " ").replace("\\", " ")
    for letter, word in _GREEK.items():
        text = text.replace(letter, f" {word} ")
    text = " ".join(re.sub(r"[\[\](){}<>,;:/|_.\-]", " ", text).split())
    unit = unit_of(text)
    text = re.sub(r"\bin (?=deg|rad|[°º˚])", " ", text)
    words = _RADIAN.sub(" ", _DEGREE.sub(" ", text)).split()
    if "deg" in words:
        unit = unit or DEGREES
    some_angle = "angle" in words
    words = [part for word in words if word not in _IDLE for part in _parts(word)]
    if some_angle and words and all(word in _DIRECTIONS for word in words):
        words.append("polar")  # "angle of incidence": from the normal, as in optics
    name = _name(words)
    if name is None:
        # 'theta_i [gon]': an angle in a unit that is refused where the header is read.
        bracket = re.fullmatch(r"(.*?)\s*[\[(]\s*([^\[\]()]+?)\s*[\])]", heading.strip())
        inner = angle_heading(bracket[1]) if bracket else None
        return AngleHeading(inner.name, bracket[2]) if bracket and inner else None
    return AngleHeading(f"{name}_deg", unit)


def unit_of(text: str) -> str | None:
    """The unit of angle that a heading or a cell of a row of units names, or None."""
    text = text.lower()
    if _RADIAN.search(text):
        return RADIANS
    return DEGREES if _DEGREE.search(text) or re.search(r"\bdeg\b", text) else None


def _parts(word: str) -> list[str]:
    if word in _WHOLE:
        return [*_WHOLE[word]]
    glued = _GLUED.fullmatch(word) if word not in _ANGLES else None
    return [glued[1], glued[2]] if glued else [word]


def _name(words: list[str]) -> str | None:
    if len(words) == 1 and words[0] in _ARMS:
        return words[0]
    angles = {_ANGLES[w] for w in words if w in _ANGLES}
    directions = {_DIRECTIONS[w] for w in words if w in _DIRECTIONS}
    known = all(w in _ANGLES or w in _DIRECTIONS for w in words)
    if not known or len(angles) != 1 or len(directions) != 1:
        return None
    return f"{angles.pop()}_{directions.pop()}"


def band_nm(heading: str) -> float | None:
    """The wavelength that a heading names, nanometres, or None.

    >>> band_nm("400"), band_nm("R_400 [nm]"), band_nm("SPECTRAL_NM400"), band_nm("402,5nm")
    (400.0, 400.0, 400.0, 402.5)
    >>> band_nm("X") is None
    True
    """
    text = _without_unit(heading)
    text = re.sub(r"[\[\]()]", " ", text)
    text = " ".join(text.replace("_nm", " nm").split())
    text = re.sub(r"^(spectral|spec) ?nm ?", "nm", text)
    found = _BAND.fullmatch(text)
    if not found:
        return None
    unit = (found[2] or "n")[0]
    # Through decimals, so that 0.46 micrometres are the number that 460 is.
    nm = Decimal(found[1].replace(",", ".")).scaleb({"n": 0, "a": -1, "å": -1}.get(unit, 3))
    return float(nm)


def is_band(heading: str) -> bool:
    """Whether a heading names a wavelength or a channel of linear sRGB, or is a number at least."""
    text = heading.strip().lower()
    number = text.lstrip("+-.")[:1].isdigit() or text in ("nan", "inf")
    return number or band_nm(text) is not None or colour_name(text) is not None


def colour_name(heading: str) -> str | None:
    """'R', 'G' or 'B' where a heading names a channel of linear sRGB, else None."""
    return _COLOURS.get(_without_unit(heading).strip())


def has_percent(heading: str) -> bool:
    """Whether a heading or a cell of a row of units names percent.

    >>> has_percent("R400 [%]"), has_percent("%"), has_percent("400 nm")
    (True, True, False)
    """
    text = _lower(heading)
    return text == "percent" or _PERCENT.search(text) is not None


def is_wavelength(heading: str) -> bool:
    """Whether a heading is that of a column of wavelengths in nm.

    >>> is_wavelength("Wavelength [nm]"), is_wavelength("λ"), is_wavelength("400 nm")
    (True, True, False)
    """
    return _WAVELENGTH.fullmatch(_plain(heading)) is not None


def value_quantity(heading: str) -> str | None:
    """The quantity of a column of single readings, '' where it names none; None for no such column.

    >>> value_quantity("BRDF [1/sr]"), value_quantity("Value"), value_quantity("400")
    ('brdf', '', None)
    """
    text = _without_unit(heading)
    return _VALUES.get(_plain(text))


def is_beside(heading: str) -> bool:
    """Whether a heading is that of a column beside the readings, such as a time or a remark."""
    return _BESIDE.fullmatch(_plain(heading)) is not None or is_sample(heading)


def is_sample(heading: str) -> bool:
    """Whether a heading is that of a column that names the sample of each row."""
    return _SAMPLE.fullmatch(_plain(heading)) is not None


def _without_unit(heading: str) -> str:
    return _UNIT.sub("", _PERCENT.sub("", _lower(heading)))


def _lower(heading: str) -> str:
    """A heading in lower case; '' for one so long that it is none."""
    text = heading.strip()
    return text.lower() if len(text) <= LONGEST else ""


def _plain(heading: str) -> str:
    """Lower-case words of a heading without brackets and marks."""
    text = heading[:LONGEST].lower()
    return " ".join(re.sub(r"[\[\](){}:;/|_.,#-]", " ", text).split())
