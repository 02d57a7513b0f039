"""What the headings of columns mean: angles in several words, wavelengths with and without unit."""

from __future__ import annotations

import re
from dataclasses import dataclass

RADIANS, DEGREES = "radians", "degrees"

#: Words of an angle and of a direction, as programs and instruments write them.
_ANGLES = {
    "theta": "theta", "polar": "theta", "zenith": "theta", "th": "theta",
    "phi": "phi", "azimuth": "phi", "azimuthal": "phi", "az": "phi", "azi": "phi",
}  # fmt: skip
_DIRECTIONS = {
    **dict.fromkeys(
        ("i", "in", "inc", "incident", "incidence", "incoming", "lamp", "light", "source",
         "illumination", "illuminant"), "i"),
    **dict.fromkeys(
        ("r", "o", "out", "outgoing", "reflected", "reflection", "refl", "receiver", "detector",
         "view", "viewing", "observer", "observation", "scatter", "scattered", "exitant"), "r"),
}  # fmt: skip
_ARMS = ("alpha", "beta", "gamma")
_IDLE = {"angle", "of", "the", "direction", "deg"}
_GREEK = {
    "θ": "theta",
    "ϑ": "theta",
    "φ": "phi",
    "ϕ": "phi",
    "α": "alpha",
    "β": "beta",
    "γ": "gamma",
}
_GLUED = re.compile(r"(theta|phi)_?(i|in|inc|o|out|r|refl)")
_DEGREE = re.compile(r"\bdegrees?\b|[°º˚]")
_RADIAN = re.compile(r"\b(radians?|rads?)\b")
_BAND = re.compile(
    r"(?:(?:spectral|spec|wavelength|wl|lambda|λ|nm|r|refl|rho|brdf|w)[ _=:.-]*)?"
    r"(\d+(?:[.,]\d*)?)\s*(nm|nanometers?|nanometres?)?",
    re.ASCII,
)
_COLOURS = {"r": "R", "g": "G", "b": "B", "red": "R", "green": "G", "blue": "B"}


@dataclass(frozen=True)
class AngleHeading:
    """An angle column: its name in relgloss, its unit if the heading has one."""

    name: str  #: such as 'theta_i_deg'
    unit: str | None  #: RADIANS, DEGREES or None


def angle_heading(heading: str) -> AngleHeading | None:
    """The angle that a heading names, or None.

    >>> angle_heading("Theta_i [deg]"), angle_heading("incident polar angle").name
    (AngleHeading(name='theta_i_deg', unit='degrees'), 'theta_i_deg')
    >>> angle_heading("φ_out (rad)"), angle_heading("550 nm")
    (AngleHeading(name='phi_r_deg', unit='radians'), None)
    """
    text = heading.strip().lower()
    if not text or len(text) > 60 or text[0] in "0123456789+-.":
        return None
    for letter, word in _GREEK.items():
        text = text.replace(letter, f" {word} ")
    text = " ".join(re.sub(r"[\[\](){}<>,;:/|_.\-]", " ", text).split())
    unit = unit_of(text)
    words = _RADIAN.sub(" ", _DEGREE.sub(" ", text)).split()
    if "deg" in words:
        unit = unit or DEGREES
    words = [part for word in words if word not in _IDLE for part in _parts(word)]
    name = _name(words)
    return None if name is None else AngleHeading(f"{name}_deg", unit)


def unit_of(text: str) -> str | None:
    """The unit of angle that a heading or a cell of a row of units names, or None."""
    text = text.lower()
    if _RADIAN.search(text):
        return RADIANS
    return DEGREES if _DEGREE.search(text) or re.search(r"\bdeg\b", text) else None


def _parts(word: str) -> list[str]:
    glued = _GLUED.fullmatch(word)
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
    text = re.sub(r"[\[\]()]", " ", heading.strip().lower())
    text = " ".join(text.replace("_nm", " nm").split())
    text = re.sub(r"^(spectral|spec) ?nm ?", "nm", text)
    found = _BAND.fullmatch(text)
    return float(found[1].replace(",", ".")) if found else None


def is_band(heading: str) -> bool:
    """Whether a heading names a wavelength or a channel of linear sRGB, or is a number at least."""
    text = heading.strip().lower()
    number = text.lstrip("+-.")[:1].isdigit() or text in ("nan", "inf")
    return number or band_nm(text) is not None or colour_name(text) is not None


def colour_name(heading: str) -> str | None:
    """'R', 'G' or 'B' where a heading names a channel of linear sRGB, else None."""
    return _COLOURS.get(heading.strip().lower())
