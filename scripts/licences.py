"""The licences of installed packages, and what follows from them for a program under MIT."""

from __future__ import annotations

import importlib.metadata
from dataclasses import dataclass
from pathlib import Path

from locked import Pin
from packaging.markers import Marker

PERMISSIVE, COPYLEFT, WEAK, UNKNOWN = "permissive", "copyleft", "weak copyleft", "unknown"
ABSENT = "not needed here"  #: as a package for Windows alone; so nothing is known of its licence
WORST = (PERMISSIVE, ABSENT, WEAK, COPYLEFT, UNKNOWN)  #: of several joined with AND the last counts
#: SPDX identifiers, lower case, that a program under the MIT licence may depend on without more.
MAY_BE_USED = frozenset(
    {
        *("mit", "mit-0", "mit-cmu", "bsd", "bsd-2-clause", "bsd-3-clause", "0bsd", "apache-2.0"),
        *("isc", "zlib", "cc0-1.0", "unlicense", "hpnd", "psf-2.0", "python-2.0", "bsl-1.0"),
        *("unicode-3.0", "unicode-dfs-2016", "ofl-1.1"),
    }
)
WEAK_PREFIXES = ("mpl-", "lgpl-", "epl-", "cddl-")
COPYLEFT_PREFIXES = ("gpl-", "agpl-", "sspl-", "cc-by-sa-")
#: Words of older metadata and of classifiers, by the SPDX identifier that they mean.
SPELLINGS = {
    "mit": "MIT",
    "mit license": "MIT",
    "bsd license": "BSD",  # which one, the classifier leaves open
    "2-clause bsd": "BSD-2-Clause",
    "isc license": "ISC",
    "unknown": "",
    "apache 2.0": "Apache-2.0",
    "apache license 2.0": "Apache-2.0",
    "apache software license": "Apache-2.0",
    "python software foundation license": "PSF-2.0",
    "psf": "PSF-2.0",
    "isc license (iscl)": "ISC",
    "mozilla public license 2.0 (mpl 2.0)": "MPL-2.0",
    "dual license": "",
}
#: Sentences of licence texts, for packages whose metadata name none.
TEXTS = {
    "Redistribution and use in source and binary forms": "BSD",
    "Permission is hereby granted, free of charge, to any person obtaining a copy": "MIT",
    "Apache License": "Apache-2.0",
    "Mozilla Public License": "MPL-2.0",
    "GNU GENERAL PUBLIC LICENSE": "GPL-3.0-or-later",
}


@dataclass(frozen=True)
class Licence:
    """What a package declares, as an SPDX expression, and what follows from it."""

    expression: str
    verdict: str  #: one of WORST


def licence_of(pin: Pin) -> Licence:
    """The licence of an installed package; a missing one is unknown, unless it is not needed."""
    try:
        found = importlib.metadata.distribution(pin.name)
    except importlib.metadata.PackageNotFoundError:
        if pin.marker and not Marker(pin.marker).evaluate():
            return Licence(f"only where {pin.marker}", ABSENT)
        return Licence("not installed", UNKNOWN)
    return judged(_declared(found))


def _declared(found: importlib.metadata.Distribution) -> str:
    """An SPDX expression, by what says most: the field for it, the old field, classifier, text."""
    fields = found.metadata.get_all
    expression = (fields("License-Expression") or [""])[0]
    if expression:
        return str(expression)
    old = str((fields("License") or [""])[0]).strip()
    short = SPELLINGS.get(old.lower(), old)
    if short and len(old) < 60 and "\n" not in old:
        return short
    classified = [
        SPELLINGS.get(name.lower(), name)
        for text in fields("Classifier") or []
        if (name := str(text).rpartition(" :: ")[2]) and str(text).startswith("License ::")
    ]
    classified = [name for name in classified if name and name != "OSI Approved"]
    if classified:
        return " OR ".join(classified)
    texts = [old, *_licence_texts(found)]
    return next((name for text in texts for start, name in TEXTS.items() if start in text), "")


def _licence_texts(found: importlib.metadata.Distribution) -> list[str]:
    return [
        Path(str(file.locate())).read_text(encoding="utf-8", errors="replace")
        for file in found.files or ()
        if ".dist-info" in file.parts[0] and "licen" in str(file).lower()
    ]


def judged(expression: str) -> Licence:
    """The verdict on an SPDX expression: of OR the best part counts, of AND the worst.

    >>> judged("MIT OR GPL-3.0-only").verdict, judged("MIT AND GPL-3.0-only").verdict
    ('permissive', 'copyleft')
    """
    words = expression.replace("(", " ( ").replace(")", " ) ").split()
    verdict, rest = _either(words)
    return Licence(expression or "none declared", UNKNOWN if rest else verdict)


def _either(words: list[str]) -> tuple[str, list[str]]:
    verdict, rest = _all_of(words)
    while rest and rest[0].upper() == "OR":
        other, rest = _all_of(rest[1:])
        verdict = min(verdict, other, key=WORST.index)
    return verdict, rest


def _all_of(words: list[str]) -> tuple[str, list[str]]:
    verdict, rest = _one(words)
    while rest and rest[0].upper() == "AND":
        other, rest = _one(rest[1:])
        verdict = max(verdict, other, key=WORST.index)
    return verdict, rest


def _one(words: list[str]) -> tuple[str, list[str]]:
    if not words:
        return UNKNOWN, []
    if words[0] == "(":
        verdict, rest = _either(words[1:])
        return (verdict, rest[1:]) if rest[:1] == [")"] else (UNKNOWN, rest)
    rest = words[1:]
    if rest and rest[0].upper() == "WITH":  # an exception only adds permissions
        rest = rest[2:]
    name = words[0].lower().rstrip("+")
    if name in MAY_BE_USED:
        return PERMISSIVE, rest
    if name.startswith(WEAK_PREFIXES):
        return WEAK, rest
    return (COPYLEFT if name.startswith(COPYLEFT_PREFIXES) else UNKNOWN), rest


def fonts() -> list[tuple[str, str, str]]:
    """The fonts that the program draws with: name, the package that brings it, its own words.

    The words are those in the font's file: its licence, or its copyright where it names none.
    """
    import imgui_bundle
    from fontTools.ttLib import TTFont
    from PIL import ImageFont

    from relgloss_view.base.fonts import dejavu

    roboto = Path(imgui_bundle.__file__).parent / "assets" / "fonts" / "Roboto"
    aileron = ImageFont.load_default(12)
    places = [
        ("matplotlib", dejavu()),
        ("pillow", getattr(aileron, "path", None)),
        ("imgui-bundle", roboto / "Roboto-Regular.ttf"),
    ]
    listed = []
    for package, place in places:
        if place is None:
            listed.append(("missing", package, "not installed"))
            continue
        names = TTFont(place)["name"]
        words = names.getDebugName(13) or names.getDebugName(0) or "no words in the file"
        listed.append((str(names.getDebugName(4)), package, " ".join(words.split())[:100]))
    return listed
