"""The words of queries: every column of columns.py by its name, its heading and other names."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable
from functools import cache

from relgloss_view.catalogue.columns import BY_NAME, BYTES, COLUMNS, DONE, FAILED, READINGS

#: Other names of columns, as people type them.
ALSO = {
    "path": ("file", "path"),
    "kind": ("type",),
    "bytes": ("file size",),
    "name": ("sample", "sample name"),
    "fault": ("error",),
    "sha256": ("sha 256", "digest"),
    "marks": ("mark", "marked"),
    "material": ("material file",),
    "warnings": ("warning",),
    "geometries": ("measured geometries",),
    "sigma_deg": ("roughness", "diffuse roughness"),
    "lobes": ("number of lobes",),
    "s_deg_1": ("lobe width", "first lobe width", "width", "first lobe", "lobe", "roughness s"),
    "s_deg_2": ("second lobe width", "second lobe"),
    "L_star": ("L", "lightness"),
    "a_star": ("a",),
    "b_star": ("b",),
    "doi": ("distinctness of image",),
    "gloss_ratio": ("ratio", "gloss ratio"),
    "sigma_n_deg": ("graininess", "grain", "sigma N"),
    "c_spread": ("spread",),
}
#: Columns whose text is one of few words; the words, and what else means them.
CHOICES: dict[str, dict[str, str]] = {
    "kind": {"table": "table", "material": "material", "proof": "proof"}
    | {"tables": "table", "materials": "material", "proofs": "proof"},
    "status": {DONE: DONE, FAILED: FAILED, "fine": DONE},
    "quality": {q: q for q in ("good", "poor", "unidentifiable")},
    "diffuse_model": {m: m for m in ("lambert", "oren-nayar", "eon")},
}
#: Words that are a condition by themselves.
ALONE = {
    "failed": ("status", FAILED),
    "done": ("status", DONE),
    "tables": ("kind", "table"),
    "materials": ("kind", "material"),
    "proofs": ("kind", "proof"),
}
#: Text columns in which nothing is a text too: no warnings, no marks, no fault.
EMPTY_IS_TEXT = ("warnings", "marks", "fault")
ANGLES = {column: key.removeprefix("gloss-") for key, column in READINGS.items() if "-" in key
          and key.startswith("gloss-")}  # fmt: skip
#: Phrases for examples and suggestions beside the columns.
PHRASES = (
    "gloss 60", "colour within dE", "looks 0.7 x as glossy as", "as glossy as", "glossier than",
    "nearest to", "sort by", "first", "ratio kept", "quality good", "failed", "and", "or", "not",
)  # fmt: skip
#: What follows a letter that stands for a column.
COMPARED = r"(?=\s{0,3}(?:[<>=!~\u2264\u2265]|(?:above|below|over|under|between|about|is)\b))"
MOST_LISTED = 60  #: words of a message
DEGREES = r"\s{0,3}(?:°|deg(?:rees?)?\b)?"
#: Between the words of a name. Bounded, so that no text makes the pattern slow.
GAP = r"[\s_-]{0,3}"
PAUSE = r"[\s_,-]{0,3}"  #: of headings with a comma, such as "haze, error"


def label_of(column: str) -> str:
    """A column's heading."""
    return BY_NAME[column].label


def _phrases() -> dict[str, str]:
    """Phrases of single spaces, in lower case, and the columns that they mean."""
    phrases: dict[str, str] = {}
    for column in COLUMNS:
        if column.kind == BYTES:
            continue
        names = (column.name, column.label, *ALSO.get(column.name, ()))
        for name in names:
            phrases.setdefault(_plain(name), column.name)
        for error in ("standard error", "se", "uncertainty", "error"):
            if column.name.endswith("_se"):
                phrases.setdefault(f"{_plain(label_of(column.name[:-3]))} {error}", column.name)
    return phrases


def _plain(name: str) -> str:
    return " ".join(re.sub(r"[_,\s-]+", " ", name).lower().split())


@cache
def column_pattern() -> tuple[re.Pattern[str], tuple[str, ...]]:
    """A pattern, longest names first; its groups g0, g1 ... are the columns of the second value."""
    phrases = _phrases()
    pieces, columns = [], []
    for phrase in sorted(phrases, key=lambda p: (-len(p), p)):
        column = phrases[phrase]
        words = [re.escape(word) for word in phrase.split()]
        angle = ANGLES.get(column.removesuffix("_se"))
        if angle is not None and words[:2] == ["gloss", angle]:
            # "gloss at 60 degrees", "60 degree gloss", and either followed by "error"
            rest = "".join(rf"{GAP},?{GAP}{word}" for word in words[2:])
            pieces.append(
                rf"(?:(?:(?:specular|paper)\s{{1,3}})?gloss{GAP}(?:at\s{{0,3}})?{angle}(?![0-9]|\.[0-9]){DEGREES}"
                rf"|{angle}{DEGREES}[\s-]{{0,3}}gloss){rest}"
            )
        else:
            if phrase in ("a", "b"):  # a letter alone, and not the beginning of any word
                words[0] += COMPARED
            gap = PAUSE if "," in label_of(column) else GAP
            pieces.append(gap.join(words))
        columns.append(column)
    body = "|".join(f"(?P<g{k}>{piece})" for k, piece in enumerate(pieces))
    return re.compile(rf"(?:{body})(?![\w*])", re.IGNORECASE), tuple(columns)


@cache
def words_known() -> tuple[str, ...]:
    """All names of columns and the beginnings of phrases, for suggestions."""
    return tuple(sorted({*_phrases(), *map(str.lower, PHRASES), *ALONE}))


def columns_known() -> tuple[str, ...]:
    """The headings of all columns that can be compared."""
    errors = ("_se",)
    return tuple(c.label for c in COLUMNS if c.kind != BYTES and not c.name.endswith(errors))


def suggestion(piece: str, among: Iterable[str] | None = None, cutoff: float = 0.72) -> str:
    """A question for the known word nearest to a wrong one, or the words that there are.

    >>> suggestion("glos 60")
    'did you mean gloss 60?'
    >>> suggestion("goood", ("good", "poor"))
    'did you mean good?'
    >>> suggestion("qqqq", ("good", "poor"))
    'expected one of good, poor'
    """
    known = words_known() if among is None else tuple(among)
    piece = " ".join(piece[:60].lower().split())
    for part in dict.fromkeys((piece, " ".join(piece.split()[:2]), piece.split(" ")[0])):
        near = difflib.get_close_matches(part, known, 1, cutoff)
        if near:
            return f"did you mean {near[0]}?"
    if among is not None:
        return f"expected one of {', '.join(known[:MOST_LISTED])}"
    return "known are " + ", ".join(summary()) + "; docs/catalogue.md has a table of phrases"


def summary() -> tuple[str, ...]:
    """The words with which a condition may begin, one of each kind."""
    return (
        "gloss 20, 60, 75 or 85", "haze", "DOI", "colour within dE 3 of 50 20 10",
        "looks 0.7 x as glossy as NAME", "nearest to NAME", "name", "file in FOLDER", "quality",
        "kind", "failed", "warning", "lobe width", "c_max", "every column of the table",
    )  # fmt: skip
