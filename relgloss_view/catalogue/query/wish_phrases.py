"""Phrases about colour, the ratio of gloss to another sample, and pictures."""

from __future__ import annotations

import math
import re

from relgloss_view.catalogue.columns import READINGS
from relgloss_view.catalogue.query.columns_phrases import ABOVE, AT_LEAST, AT_MOST, BELOW
from relgloss_view.catalogue.query.fault import QueryError
from relgloss_view.catalogue.query.scanner import NUMBER, Scanner
from relgloss_view.catalogue.query.terms import (
    ColourNear,
    Condition,
    GlossRatio,
    Nearest,
    ReferenceName,
)

COLOUR = ("colour", "color", "lab", "cielab")
DELTA_E = re.compile(
    r"(?:CIE\s?)?(?:d|delta\s?|\u0394|\u2206)\s?E\*?\s?_?(?P<formula>2000|00|1976|76|ab)?(?![0-9A-Za-z])",
    re.I,
)
NEAREST_COLOUR = (
    "nearest colour to", "nearest color to", "nearest in colour to", "nearest in color to",
    "closest colour to", "closest color to",
)  # fmt: skip
NEAREST = (
    "nearest to", "nearest", "closest to", "most like", "looks most like", "looks like",
    "like",
    "similar to", "most similar to", "picture near", "picture nearest to",
)  # fmt: skip
AS_GLOSSY = ("as glossy as", "as shiny as")
SAME = ("same gloss as", "the same gloss as")
MORE = ("glossier than", "more glossy than", "shinier than")
LESS = ("less glossy than", "duller than", "matter than", "more matte than")
TIMES = re.compile(r"(?:x|\u00d7|times|fold)(?!\w)|%", re.I)
TIMES_AS = re.compile(
    r"[+\-]?[0-9.]+(?:,[0-9]+)?\s{0,9}(?:x|\u00d7|times|fold|%)\s{0,9}(?:as|the)\s", re.I
)
LABEL = re.compile(r"(?:CIE\s?)?L\*?\s?a\*?\s?b\*?(?!\w)\s*[:=(]?|\(|colou?r(?!\w)", re.I)
AXES = tuple(
    re.compile(rf"{axis}\s?(?:\*|_star)?\s?[:=]?(?=\s*[-+.0-9\u2212])", re.I) for axis in "Lab"
)
#: A number that another one or nothing follows: a colour, and not a name such as "7 coats".
NUMBERS = re.compile(rf"(?>{NUMBER.pattern})(?=\s*$|(?:\s*[,;]\s*|\s+)[-+.\u2212]?[0-9]|,[0-9])")
BETWEEN = re.compile(r",\s|;")
PERCENT, DEGREES = re.compile(r"%|percent\b", re.I), re.compile(r"\u00b0|deg(?:rees?)?\b", re.I)
ANGLE = re.compile(r"(?P<angle>[0-9.]+)\s*(?:\u00b0|deg(?:rees?)?\b)?", re.I)
EXAMPLE = "write colour within dE 3 of 50 20 10, or of NAME"


def wish(scanner: Scanner) -> Condition | None:
    """A condition on colour, ratio or picture; None where another phrase is here."""
    for read in (_colour, _ratio, _nearest):
        made = read(scanner)
        if made is not None:
            return made
    return None


def _colour(scanner: Scanner) -> Condition | None:
    start = scanner.skip()
    if scanner.word(*NEAREST_COLOUR):
        return ColourNear(_target(scanner))
    if scanner.word(*COLOUR):
        scanner.word("is")
        if scanner.has_number() or scanner.peek(AXES[0]):  # "Lab 50 20 10 within dE 3"
            target = _lab(scanner)
            if scanner.word("within", "+-", "\u00b1"):
                return ColourNear(target, *_tolerance(scanner))
            return ColourNear(target)
        if scanner.word("near", "nearest to", "close to", "about", "like", "as"):
            target_ = _target(scanner)
            return ColourNear(target_, *_tolerance_after(scanner))
        if scanner.word("within", "at most", "<", "<=") or scanner.peek(DELTA_E):
            return _of_target(scanner)
        raise scanner.fault("not a question about colour", EXAMPLE)
    if scanner.word("within"):
        if scanner.peek(DELTA_E):
            return _of_target(scanner)
        scanner.at = start
        raise scanner.fault("within what?", f"for a colour {EXAMPLE}")
    match = scanner.peek(DELTA_E)
    if match is None:
        return None
    scanner.take(DELTA_E)
    if scanner.word("from", "to", "of"):  # "dE from art-coated below 3"
        target_ = _target(scanner, ends_at_comparison=True)
        if scanner.word(*BELOW, *AT_MOST, "within"):
            return ColourNear(target_, _limit(scanner), _formula(match))
        return ColourNear(target_, None, _formula(match))
    scanner.at = start
    return _of_target(scanner)


def _of_target(scanner: Scanner) -> ColourNear:
    """ "dE 3 of 50 20 10"."""
    tolerance, formula = _tolerance(scanner)
    if not scanner.word("of", "from", "to", "around", "about"):
        raise scanner.fault("expected 'of' and a colour or a sample", EXAMPLE)
    return ColourNear(_target(scanner), tolerance, formula)


def _tolerance(scanner: Scanner) -> tuple[float, str]:
    match = scanner.take(DELTA_E)
    scanner.word("<", "<=", "=", "of", "at most")
    value = _limit(scanner)
    if match is None:
        match = scanner.take(DELTA_E)
    return value, _formula(match)


def _tolerance_after(scanner: Scanner) -> tuple[float | None, str]:
    if scanner.word("within", "+-", "\u00b1"):
        return _tolerance(scanner)
    return None, "2000"


def _limit(scanner: Scanner) -> float:
    at = scanner.skip()
    value = scanner.number("a colour difference")
    if value < 0.0:
        raise scanner.fault("a colour difference is not negative", "write 0 or more", at)
    return value


def _formula(match: re.Match[str] | None) -> str:
    formula = "" if match is None else (match["formula"] or "").lower()
    return "76" if formula in ("76", "1976", "ab") else "2000"


def _target(
    scanner: Scanner, *, ends_at_comparison: bool = False
) -> tuple[float, float, float] | ReferenceName:
    at = scanner.at
    scanner.word("that of", "the colour of", "the color of")
    if scanner.peek(NUMBERS):
        return _lab(scanner)
    if scanner.take(LABEL) and (scanner.peek(NUMBERS) or scanner.peek(AXES[0])):
        return _lab(scanner)
    scanner.at = at
    if scanner.peek(AXES[0]):
        return _lab(scanner)
    if ends_at_comparison:
        return _name_before_comparison(scanner)
    return reference_name(scanner)


def _name_before_comparison(scanner: Scanner) -> ReferenceName:
    """A name that ends at below, <, at most or within."""
    at = scanner.skip()
    rest = scanner.text[at : at + 400]
    match = re.search(
        r"\s(?:below|under|<=?|\u2264|less than|lower than|at most|up to|within)\s", rest, re.I
    )
    if match is None or rest[:1] in "\"'\u201c\u00ab":
        return reference_name(scanner)
    inner = Scanner(scanner.text[: at + match.start()])
    inner.at = at
    made = reference_name(inner)
    scanner.at = inner.at
    return made


def _lab(scanner: Scanner) -> tuple[float, float, float]:
    """L*, a*, b*, with or without their letters, with spaces or commas and spaces."""
    at = scanner.skip()
    opened = scanner.text[:at].rstrip().endswith("(") and scanner.text[at - 1 : at] == "("
    values = []
    for axis in range(3):
        if axis:
            scanner.take(BETWEEN)
        scanner.take(AXES[axis])
        if not scanner.has_number():
            raise scanner.fault(
                f"expected {('L*', 'a*', 'b*')[axis]}",
                "write three numbers such as 50 20 10; a name of digits needs quotation marks",
            )
        values.append(scanner.number("a number"))
    if opened:
        scanner.take(re.compile(r"\)"))
    if not 0.0 <= values[0] <= 100.0 or max(abs(values[1]), abs(values[2])) > 200.0:
        raise scanner.fault(
            "no colour has these numbers", "L* is 0 to 100, a* and b* are -200 to 200", at
        )
    return values[0], values[1], values[2]


def _ratio(scanner: Scanner) -> Condition | None:
    start = scanner.skip()
    scanner.word("looks", "look", "is", "are", "appears")
    word = scanner.word(*MORE, *LESS)
    if word is not None:
        reference, column = _with_angle(scanner)
        if word in MORE:
            return GlossRatio(reference, low=1.0, with_low=False, column=column)
        return GlossRatio(reference, high=1.0, with_high=False, column=column)
    if scanner.word(*SAME):
        return _near_ratio(scanner, 1.0)
    side = None
    for name, words in (("low", AT_LEAST), ("high", AT_MOST), ("above", ABOVE), ("below", BELOW)):
        if scanner.word(*words):
            side = name
            break
    factor = _factor(scanner)
    if factor is None or not scanner.word(*AS_GLOSSY, "the gloss of"):
        if factor is not None and factor[1]:
            raise scanner.fault(
                "expected 'as glossy as' and a sample",
                "write looks 0.7 x as glossy as cast-coated",
            )
        scanner.at = start
        return None
    value = factor[0]
    if side is None:
        return _near_ratio(scanner, value)
    reference, column = _with_angle(scanner)
    return GlossRatio(
        reference,
        low=value if side in ("low", "above") else 0.0,
        high=value if side in ("high", "below") else math.inf,
        with_low=side != "above",
        with_high=side != "below",
        column=column,
    )


def _near_ratio(scanner: Scanner, wanted: float) -> GlossRatio:
    """The sample, the angle and the tolerance after "as glossy as"."""
    reference, column = _with_angle(scanner)
    tolerance = _share(scanner)
    return GlossRatio(reference, wanted, tolerance, column=column or _angle(scanner))


def _factor(scanner: Scanner) -> tuple[float, bool] | None:
    """The factor of "0.7 x as glossy as", 1 where none is written; whether it was written."""
    if scanner.word("twice", "double"):
        return 2.0, True
    if scanner.word("half"):
        return 0.5, True
    if scanner.peek(TIMES_AS) is None:
        return 1.0, False
    start = scanner.skip()
    value = scanner.number("a ratio of gloss")
    match = scanner.take(TIMES)
    if value <= 0.0:
        raise scanner.fault("a ratio of gloss is above 0", "write 0.7 x as glossy as NAME", start)
    return value * (0.01 if match is not None and match.group() == "%" else 1.0), True


def _with_angle(scanner: Scanner) -> tuple[ReferenceName, str | None]:
    return reference_name(scanner), _angle(scanner)


def _angle(scanner: Scanner) -> str | None:
    """ "at 60 degrees": the column of the reading."""
    at = scanner.at
    if not scanner.word("at"):
        return None
    match = scanner.take(ANGLE)
    column = READINGS.get(f"gloss-{match['angle']}") if match is not None else None
    if column is None:
        raise scanner.fault(
            "expected an angle of the catalogue", "write at 20, 60, 75 or 85 degrees",
            at if match is not None else None,
        )  # fmt: skip
    return column


def _share(scanner: Scanner) -> float | None:
    """ "within 5 %" as a share."""
    at = scanner.at
    if not scanner.word("within", "+-", "+/-", "\u00b1"):
        return None
    if scanner.peek(DELTA_E):
        scanner.at = at
        raise scanner.fault(
            "a ratio of gloss has no colour difference", "write within 5 %, or begin with 'and'"
        )
    value = scanner.number("a tolerance in %")
    if not scanner.take(PERCENT):
        raise scanner.fault("expected % after the tolerance", "write within 5 %", at)
    if not 0.0 <= value <= 100.0:
        raise scanner.fault("a tolerance is 0 to 100 %", "write within 5 %", at)
    return 0.01 * value


def _nearest(scanner: Scanner) -> Condition | None:
    if not scanner.word(*NEAREST):
        return None
    at = scanner.skip()
    if scanner.has_number():
        match = re.compile(r"[-+.0-9]+[,\s]+[-+.0-9]+[,\s]+[-+.0-9]+").match(scanner.text, at)
        if match is not None:
            raise QueryError(
                scanner.text, at, match.end(), "a picture is near that of a sample",
                "write nearest colour to 50 20 10",
            )  # fmt: skip
    return Nearest(reference_name(scanner))


def reference_name(scanner: Scanner) -> ReferenceName:
    """The name of another sample."""
    text, span = scanner.value(
        "a sample: a name or a file of the catalogue, a built-in paper, a material file",
        is_name=True,
    )
    return ReferenceName(text, span)
