"""A catalogue in the window: what its panel shows of an item, and the query that it asks.

No OpenGL, no window library, no reading of files: the catalogue has been read in the background.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from relgloss_view.base.reading import printable
from relgloss_view.base.shell import command_line, operand
from relgloss_view.base.terminal import ProgressReport, no_progress
from relgloss_view.base.words import sentence_case
from relgloss_view.catalogue.columns import DONE, LAB
from relgloss_view.catalogue.query.fault import QueryError
from relgloss_view.catalogue.query.listing import rounded_up

if TYPE_CHECKING:
    from relgloss_view.catalogue.query.found import Found, Hit, Searched
    from relgloss_view.catalogue.query.search import Searcher

    class ShownCatalogue(Searched, Protocol):
        """What the window needs of a catalogue; catalogue/catalogue.py has it."""

        def material_file(self, path: str) -> Path:
            """The material file of an item; InputError where it has none."""
            ...


Row = Mapping[str, Any]
Stamp = tuple[int, int]  #: of a file: time of its last change in ns, size in bytes

LONGEST_LINE = 160  #: characters of a warning or a path
MOST_WARNINGS = 4  #: that a tooltip lists
LEAST_TILE_EM, TILE_EM, MOST_TILE_EM = 4.0, 7.0, 12.0  #: width of a thumbnail
AS_FOUND = "as found"

#: Choices of the order: what they show, and the phrase that they add to the query.
SORTS: dict[str, str] = {
    AS_FOUND: "",
    "file": "sort by file",
    "name": "sort by name",
    "gloss 60, highest first": "sort by gloss 60 descending",
    "gloss 60, lowest first": "sort by gloss 60",
    "gloss 20, highest first": "sort by gloss 20 descending",
    "haze, highest first": "sort by haze descending",
    "L*, lightest first": "sort by L* descending",
    "lobe width, narrowest first": "sort by lobe width",
    "quality": "sort by quality",
}
#: Words of the readings in a tooltip: column, heading, decimals, unit.
_READINGS = (
    ("gloss_20", "Gloss 20°", 1, " GU"),
    ("gloss_60", "Gloss 60°", 1, " GU"),
    ("gloss_75", "Gloss 75°", 1, " GU"),
    ("gloss_85", "Gloss 85°", 1, " GU"),
    ("haze", "Haze", 2, ""),
    ("doi", "DOI", 1, ""),
    ("contrast_gloss", "Contrast gloss c", 3, ""),
    ("distinctness", "Distinctness d", 3, ""),
)
#: The same under a thumbnail, and what else a query may be about: heading, decimals, unit.
SHORT = {
    "gloss_60": ("", 1, " GU"),
    "gloss_20": ("20°: ", 1, ""),
    "gloss_75": ("75°: ", 1, ""),
    "gloss_85": ("85°: ", 1, ""),
    "haze": ("haze ", 1, ""),
    "doi": ("DOI ", 1, ""),
    "contrast_gloss": ("c ", 3, ""),
    "distinctness": ("d ", 3, ""),
    "s_deg_1": ("lobe ", 2, "°"),
    "L_star": ("L* ", 1, ""),
}
#: What a query computes, under a thumbnail: before and after the number.
MEASURES = {
    "ratio": ("", " x"),
    "colour_difference": ("dE ", ""),
    "picture_difference": ("dE ", ""),
}
_MEANINGS = {
    "poor": "The fit is poor: look at the panel Fit before you rely on it.",
    "unidentifiable": "The measurement does not determine all parameters of the fit.",
    "synthetic": "Synthetic: computed, not measured.",
    "hypothetical": "Hypothetical: not measured.",
    "estimated": "Estimated from few readings, not measured.",
    "described": "Described by another program, not measured.",
    "ratio cut": "The ratio to the reference is not kept in this picture: c is cut at c_max.",
    "failed": "It could not be read or fitted.",
}


@dataclass(frozen=True)
class OpenCatalogue:
    """A catalogue that was read: its folder, its rows, what searches it, and the file's stamp."""

    folder: str
    catalogue: ShownCatalogue
    searcher: Searcher
    stamp: Stamp | None = None

    @property
    def name(self) -> str:
        """The folder's name, fit to print."""
        return printable(Path(self.folder).name or self.folder, 60)

    def material_file(self, path: str) -> Path:
        """The material file of an item. Raises InputError where it has none."""
        return self.catalogue.material_file(path)


@dataclass(frozen=True)
class Asked:
    """A query as it was typed, with the order that the panel adds to it."""

    text: str = ""
    sort: str = AS_FOUND

    @property
    def query(self) -> str:
        """The whole query. An order in the text itself is kept.

        Raises QueryError, whose places are those of the text that was typed.

        >>> Asked("gloss 60 > 40", "name").query
        'gloss 60 > 40, sort by name'
        >>> Asked("", "name").query
        'sort by name'
        >>> Asked("gloss 60 > 40, sort by haze", "name").query
        'gloss 60 > 40, sort by haze'
        """
        # The language is loaded with the first catalogue, and not when the window starts.
        from relgloss_view.catalogue.query.parse import parse

        typed = parse(self.text) if self.text.strip() else None
        phrase = SORTS.get(self.sort, "")
        if not phrase or (typed is not None and typed.order):
            return self.text if typed is not None else ""
        return phrase if typed is None else f"{self.text.rstrip().rstrip(',;')}, {phrase}"


def searched(
    opened: OpenCatalogue, asked: Asked, progress: ProgressReport = no_progress
) -> Found | QueryError:
    """What a query finds, or its fault; a thread does it."""
    try:
        return opened.searcher.search(asked.query, progress=progress)
    except QueryError as error:
        return error


def is_done(row: Row) -> bool:
    """Whether an item has a material."""
    return row.get("status") == DONE and bool(row.get("material"))


def marks_of(row: Row) -> tuple[str, ...]:
    """Short words on a thumbnail, worst first; none of a measured sample with a good fit.

    >>> marks_of({"status": "done", "quality": "poor", "marks": "estimated"})
    ('poor', 'estimated')
    """
    if row.get("status") != DONE:
        return ("failed",)
    marks = [str(row["quality"])] if row.get("quality") in ("poor", "unidentifiable") else []
    if row.get("is_ratio_kept") is False:
        marks.append("ratio cut")
    marks += [word for word in _words(row.get("marks")) if word]
    return tuple(dict.fromkeys(marks))


def _words(value: object) -> list[str]:
    text = value if isinstance(value, str) else ""
    return [printable(word.strip(), 20) for word in text.replace(";", ",").split(",")]


def title_of(row: Row) -> str:
    """The sample's name, or its file's."""
    name = row.get("name") or str(row.get("path", "")).rpartition("/")[2]
    return printable(str(name), 80)


def fault_of(row: Row, most: int) -> str:
    """Why an item failed, in at most so many characters."""
    return printable(str(row.get("fault") or "no reason is given"), most)


def numbers_of(hit: Hit, found: Found) -> str:
    """The line under a name: a reading, and its ratio or what the query computed of it.

    The reading is the first that the query uses, else gloss at 60 degrees. A failed item has its
    fault there.
    """
    row = hit.row
    if row.get("status") != DONE:
        return fault_of(row, 80)
    used = next((name for name in found.columns if name in SHORT), "gloss_60")
    parts = [_short(row, used)]
    computed = [(one, hit.numbers[one.key]) for one in found.measures if one.key in hit.numbers]
    ratio = _number(row.get("gloss_ratio"))
    if computed:
        measure, value = computed[0]
        before, after = MEASURES.get(measure.key, ("", f" {measure.label}"))
        # A picture that is drawn anew has more numbers than a thumbnail.
        if measure.key == "picture_difference" and "picture_mean" not in hit.numbers:
            before += "about "
        parts.append(f"{before}{value:.2f}{after}")
    elif ratio is not None:
        parts.append(f"{ratio:.2f} x")
    return "  ".join(part for part in parts if part)


def _short(row: Row, name: str) -> str:
    heading, decimals, unit = SHORT[name]
    value = _number(row.get(name))
    return "" if value is None else f"{heading}{value:.{decimals}f}{unit}"


def tooltip_of(hit: Hit, found: Found) -> str:
    """All readings of an item with their errors, and what there is to know about it."""
    row = hit.row
    lines = list(dict.fromkeys([title_of(row), printable(hit.path, LONGEST_LINE)]))
    if row.get("status") != DONE:
        return "\n".join([*lines, "", fault_of(row, 2 * LONGEST_LINE)])
    lines.append("")
    for name, heading, decimals, unit in _READINGS:
        lines += _reading(row, name, heading, decimals, unit)
    lines += _computed(hit, found)
    lines += _colour(row)
    ratio = _number(row.get("gloss_ratio"))
    if ratio is not None:
        lines.append(f"{ratio:.3f} x as glossy as the catalogue's reference")
    model, source = row.get("model"), row.get("source")
    lines += [f"Model: {printable(str(model), 80)}"] if model else []
    lines += [sentence_case(printable(str(source), LONGEST_LINE))] if source else []
    for mark in marks_of(row):
        lines.append(_MEANINGS.get(mark, mark))
    warnings = [one for one in str(row.get("warnings") or "").splitlines() if one.strip()]
    for warning in warnings[:MOST_WARNINGS]:
        lines.append(f"! {printable(warning, LONGEST_LINE)}")
    if len(warnings) > MOST_WARNINGS:
        lines.append(f"and {len(warnings) - MOST_WARNINGS} more warnings")
    return "\n".join(lines)


def _reading(row: Row, name: str, heading: str, decimals: int, unit: str) -> list[str]:
    value, error = _number(row.get(name)), _number(row.get(f"{name}_se"))
    if value is None:
        return []
    within = "" if error is None else f" ± {rounded_up(error, decimals)}"
    return [f"{heading}: {value:.{decimals}f}{within}{unit}"]


def _computed(hit: Hit, found: Found) -> list[str]:
    lines = []
    for measure in found.measures:
        value = hit.numbers.get(measure.key)
        if value is not None:
            lines.append(f"{measure.label}: {value:.{measure.decimals}f} {measure.unit}".rstrip())
    return lines


def _colour(row: Row) -> list[str]:
    lab = [_number(row.get(name)) for name in LAB]
    if any(one is None for one in lab):
        return []
    # Rounded to nothing, a negative number has no sign.
    return ["L* a* b*: " + ", ".join(f"{round(v, 1) + 0.0:.1f}" for v in lab if v is not None)]


def _number(value: object) -> float | None:
    """A number of a row; None where it has none."""
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        return None
    return float(value)


def opened_words(opened: OpenCatalogue) -> str:
    """What is reported when a catalogue was opened."""
    rows = opened.catalogue.rows
    words = "1 item" if len(rows) == 1 else f"{len(rows):,} items"
    failed = sum(1 for row in rows if row.get("status") != DONE)
    return f"opened the catalogue {opened.name}: {words}" + f", {failed:,} failed" * bool(failed)


def found_words(found: Found | None, opened: OpenCatalogue) -> str:
    """How many items show, in one line."""
    count = len(opened.catalogue.rows)
    if found is None:
        return f"{count:,} items in {opened.name}"
    if found.total == found.searched:
        words = f"all {count:,} items"
    else:
        words = f"{len(found.hits):,} of {count:,} items"
    if found.left_out:
        lack = "lacks" if found.left_out == 1 else "lack"
        words += f"; {found.left_out:,} {lack} a value that the search needs"
    return f"{words}, {found.order}"


def nearest_query(row: Row) -> str:
    """The query for what looks most like an item.

    >>> print(nearest_query({"path": 'gray "a".csv'}))
    nearest to 'gray "a".csv'
    """
    path = str(row["path"])
    quote = next((mark for mark in "\"'" if mark not in path), '"')
    return f"nearest to {quote}{path}{quote}"


def view_command(file: Path) -> str:
    """The command that opens a material file in a window.

    >>> view_command(Path("a mill/silk.json"))
    "relgloss view 'a mill/silk.json'"
    """
    return command_line(["relgloss", "view", operand(file)])
