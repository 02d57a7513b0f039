"""Which spot colours of a file are finishes and marks of production, and which are inks."""

from __future__ import annotations

import itertools
import re

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
    coded = {"pantone", "hks", "toyo", "dic", "ral", "focoltone", "trumatch"} & set(words)
    if coded:  # "PANTONE Cool White" is an ink, "Foil PANTONE 871" is none
        return bool({"foil", "varnish", "emboss", "coldfoil", "hotfoil"} & set(words))
    return bool(_TECHNICAL & {*words, whole} or _PAIRS & joined)
