"""Which spot colours of a file are finishes and marks of production, and which are inks."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterable

PROCESS = ("Cyan", "Magenta", "Yellow", "Black")
#: Words of names that designers and printers give to what is no ink: English, German, French,
#: Spanish, Italian.
_WORDS = (
    "varnish", "varnishes", "vernis", "verniz", "barniz", "vernice", "lack", "uvlack", "spotlack",
    "lacquer", "uv", "spotuv", "gloss", "glanz", "matt", "matte", "satin", "coating", "coat",
    "softtouch", "dispersion", "dispersionslack", "foil", "folie", "coldfoil", "hotfoil",
    "kaltfolie", "heissfolie", "stamping", "hotstamping", "foilstamping", "emboss", "embossing",
    "deboss", "debossing", "blindpraegung", "praegung", "prägung", "gaufrage", "braille", "white",
    "opaquewhite", "underwhite", "whiteink", "weiss", "weiß", "deckweiss", "blanc", "bianco",
    "blanco", "cut", "cutter", "cutcontour", "cuttercontour", "thrucut", "throughcut", "kisscut",
    "cutline", "die", "dieline", "diecut", "diecutting", "stanze", "stanzform", "stanzkontur",
    "stanzlinie", "kontur", "découpe", "decoupe", "troquel", "fustella", "crease", "creasing",
    "fold", "folding", "score", "scoring", "rill", "rille", "rillen", "rillung", "falz", "perf",
    "perforation", "perforating", "glue", "glueflap", "gluearea", "leim", "leimung", "kleber",
    "dimension", "dimensions", "bemassung", "legend", "structural", "guides", "primer",
    "adhesive", "register", "holdout", "technical", "technik",
)  # fmt: skip
_TECHNICAL = frozenset(_WORDS)
#: Systems of colours, whose names are those of inks.
_SYSTEMS = frozenset({"pantone", "hks", "toyo", "dic", "ral", "focoltone", "trumatch"})
#: Two words that are one, as in "Die Line", "Soft Touch", "Kiss-Cut".
_PAIRS = frozenset({"softtouch", "dieline", "diecut", "kisscut", "thrucut", "spotuv", "cutline"})


def is_technical(name: str) -> bool:
    """Whether a spot colour of this name is a finish or a mark, so that it prints no colour.

    >>> [is_technical(n) for n in ("Varnish", "Foil Gold", "CutContour", "Spot_UV 1", "Die Line")]
    [True, True, True, True, True]
    >>> [is_technical(n) for n in ("PANTONE 186 C", "Matterhorn Blue", "Gold", "HKS 43")]
    [False, False, False, False]
    """
    spread = re.sub(r"(?<=[a-zäöüß])(?=[A-Z])", " ", name)
    words = re.findall(r"[^\W\d_]+", spread.lower())
    joined = {a + b for a, b in itertools.pairwise(words)}
    whole = "".join(words)
    if _SYSTEMS & set(words):  # "PANTONE Cool White" is an ink, "Foil PANTONE 871" is none
        return bool({"foil", "varnish", "emboss", "coldfoil", "hotfoil"} & set(words))
    return bool(_TECHNICAL & {*words, whole} or _PAIRS & joined)


def plate_named(plates: Iterable[str], name: str) -> str | None:
    """The plate of a name, or the only one whose name differs in case and blanks alone.

    >>> plate_named(["Varnish", "VP 7"], "vp7")
    'VP 7'
    """
    plates = list(plates)
    if name in plates:
        return name
    alike = [other for other in plates if _folded(other) == _folded(name)]
    return alike[0] if len(alike) == 1 else None


def finishing_plates(plates: Iterable[str], names: Iterable[str]) -> list[str]:
    """The plates that these names mean, in their own order, but for inks of a colour system.

    A varnish may lie where PANTONE 186 C prints, which stays an ink.

    >>> finishing_plates(["PANTONE 186 C", "VP7", "Red"], ["vp7", "PANTONE 186 C"])
    ['VP7']
    """
    plates = list(plates)
    meant = {plate_named(plates, name) for name in names}
    return [one for one in plates if one in meant and not _is_coded(one)]


def _is_coded(name: str) -> bool:
    return bool(_SYSTEMS & set(re.findall(r"[^\W\d_]+", name.lower())))


def _folded(name: str) -> str:
    return "".join(name.casefold().split())
