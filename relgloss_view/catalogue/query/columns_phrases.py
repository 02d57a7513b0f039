"""Phrases about one column: numbers, texts, choices, yes or no."""

from __future__ import annotations

import math
import re

from relgloss_view.catalogue.columns import BY_NAME, BYTES, FLAG, NUMBER, TEXT, WHOLE
from relgloss_view.catalogue.query.fault import QueryError
from relgloss_view.catalogue.query.scanner import QUOTES, Scanner
from relgloss_view.catalogue.query.terms import (
    CONTAINS,
    ENDS,
    IS,
    STARTS,
    WITHIN,
    Any,
    Condition,
    Flag,
    Near,
    Not,
    Present,
    Range,
    TextTest,
)
from relgloss_view.catalogue.query.vocabulary import (
    ALONE,
    CHOICES,
    column_pattern,
    label_of,
    suggestion,
)

ABOVE = (
    "above", "over", "greater than", "more than", "higher than", "larger than", "wider than", ">",
)  # fmt: skip
AT_LEAST = ("at least", "not below", "not less than", "from", ">=", "\u2265", "min", "minimum")
BELOW = (
    "below", "under", "less than", "lower than", "smaller than", "narrower than", "<",
)  # fmt: skip
AT_MOST = ("at most", "not above", "not more than", "up to", "<=", "\u2264", "max", "maximum")
UNEQUAL, EQUAL = ("!=", "<>", "\u2260", "is not"), ("==", "=", "equals", "equal to", "exactly")
ABOUT = ("about", "around", "near", "close to", "nearest to", "approximately", "~", "\u2248")
PLUS_MINUS = ("within", "+-", "+/-", "\u00b1", "tolerance")
MISSING = ("missing", "unknown", "empty", "not known", "null")
PRESENT = ("known", "present", "not missing", "not empty", "available", "not null")
UNIT = re.compile(
    r"(?P<GU>GU\b|gloss units?\b|units?\b)|(?P<degrees>\u00b0|deg(?:rees?)?\b)|(?P<bytes>bytes\b)"
    r"|(?P<percent>%)",
    re.I,
)
TO = re.compile(r"(?:-|\u2013|\u2014|\u2212|\.\.\.?|to\b)\s*(?=[0-9.+-])", re.I)
GLOSS = re.compile(r"(?:specular\s+|paper\s+)?gloss(?!\w)", re.I)
GLOSS_NUMBER = re.compile(r"gloss[\s_-]{0,3}(?:at\s{0,3})?(?P<angle>[0-9.]+)", re.I)
BARE = ("name", "path", "source")  #: columns whose text may follow without "contains"
RATIO_KEPT = ("ratio kept", "ratio is kept", "ratio was kept")
COMPARISON = re.compile(
    r"[<>\u2264\u2265]|(?:above|below|over|under|at\s+least|at\s+most|up\s+to|less\s+than"
    r"|more\s+than)\s*[-+.0-9]",
    re.I,
)
RATIO_NOT_KEPT = ("ratio not kept", "ratio is not kept", "ratio was not kept", "ratio lost")
YES, NO = ("yes", "true"), ("no", "false")
NUMBER_WORDS = "between 40 and 50, above 40, below 40, at least, at most, is, about, missing"
TEXT_WORDS = "contains, is, is not, starts with, ends with, missing"


def column(scanner: Scanner) -> str | None:
    """The column whose name is here, passed over."""
    pattern, columns = column_pattern()
    match = scanner.take(pattern)
    if match is None or match.lastgroup is None:
        return None
    return columns[int(match.lastgroup[1:])]


def alone(scanner: Scanner) -> Condition | None:
    """A condition of one word, such as `failed`, or of a text in quotation marks: a name."""
    if scanner.word("in folder", "folder"):
        return TextTest("path", WITHIN, scanner.value("the name of a folder")[0])
    if scanner.word("no warnings", "no warning", "without warnings", "without warning"):
        return Present("warnings", False)
    if scanner.word("no fault", "no faults", "without fault", "without faults"):
        return Present("fault", False)
    if scanner.word("with warnings", "has warnings", "warned"):
        return Present("warnings", True)
    if scanner.word(*RATIO_NOT_KEPT):
        return Flag("is_ratio_kept", False)
    if scanner.word(*RATIO_KEPT):
        return Flag("is_ratio_kept", True)
    if scanner.text[scanner.skip() : scanner.at + 1] in tuple(QUOTES):
        text, _ = scanner.value("a text of names")
        return Any((TextTest("name", CONTAINS, text), TextTest("path", CONTAINS, text)))
    word = scanner.word(*ALONE)
    if word is None:
        return None
    name, value = ALONE[word]
    return TextTest(name, IS, value)


def again(scanner: Scanner, last: Condition | None) -> Condition | None:
    """A further question about the column of the last condition, as in "gloss 60 > 40 and < 50"."""
    if isinstance(last, Range) and scanner.peek(COMPARISON):
        return _number(scanner, last.column, scanner.at)
    if isinstance(last, TextTest) and last.how == IS and last.column in CHOICES:
        word = scanner.word(*CHOICES[last.column])
        if word is not None:
            return TextTest(last.column, IS, CHOICES[last.column][word])
    return None


def on_column(scanner: Scanner) -> Condition | None:
    """A column and what is asked of it."""
    start = scanner.skip()
    name = column(scanner)
    if name is None:
        _refuse_gloss_alone(scanner)
        return None
    kind = BY_NAME[name].kind
    if kind == FLAG:
        return _flag(scanner, name)
    if kind in (NUMBER, WHOLE):
        return _number(scanner, name, start)
    assert kind in (TEXT, BYTES)
    return _text(scanner, name, start)


def _refuse_gloss_alone(scanner: Scanner) -> None:
    """QueryError for gloss without an angle, or at one that the catalogue has not."""
    match = scanner.peek(GLOSS_NUMBER)
    if match is None:
        match = scanner.peek(GLOSS)
        if match is None:
            return
        fault = "gloss at which angle?"
    else:
        fault = f"the catalogue has no gloss at {match['angle'][:8]} degrees"
    raise QueryError(
        scanner.text, match.start(), match.end(), fault,
        "write gloss 20, gloss 60, gloss 75 or gloss 85",
    )  # fmt: skip


def _flag(scanner: Scanner, name: str) -> Condition:
    scanner.word("is", "=", "==")
    if scanner.word(*NO):
        return Flag(name, False)
    scanner.word(*YES)
    return Flag(name, True)


def _number(scanner: Scanner, name: str, start: int) -> Condition:
    """What is asked of a number."""
    is_first = scanner.word("is", "are", "of", ":") == "is"
    if scanner.word(*MISSING):
        return Present(name, False)
    if scanner.word(*PRESENT):
        return Present(name, True)
    negated = scanner.word("not between") is not None
    if negated or scanner.word("between"):
        low = _value(scanner, name)
        if not scanner.word("and", "&", "to", "-", "\u2013", "\u2014", "...", ".."):
            raise scanner.fault("expected 'and'", f"write {label_of(name)} between 40 and 50")
        made: Condition = _range(name, low, _value(scanner, name))
        return Not(made) if negated else made
    for words, limits in (
        (AT_LEAST, {"low": 0.0}), (AT_MOST, {"high": 0.0}),
        (ABOVE, {"low": 0.0, "with_low": False}), (BELOW, {"high": 0.0, "with_high": False}),
    ):  # fmt: skip
        word = scanner.word(*words)
        if word is None:
            continue
        value = _value(scanner, name)
        if word == "from" and scanner.word("to", "-", "\u2013", "up to"):
            return _range(name, value, _value(scanner, name))
        low = value if "low" in limits else -math.inf
        high = value if "high" in limits else math.inf
        return Range(
            name, low, high, bool(limits.get("with_low", True)), bool(limits.get("with_high", True))
        )
    if scanner.word(*ABOUT):
        return Near(name, _value(scanner, name), _tolerance(scanner, name))
    is_not = scanner.word(*UNEQUAL) or (is_first and scanner.word("not"))
    if is_not or scanner.word(*EQUAL) or scanner.has_number():
        value = _value(scanner, name)
        if not is_not and scanner.take(TO):  # "gloss 60 40-50"
            return _range(name, value, _value(scanner, name))
        if not is_not and (tolerance := _tolerance(scanner, name)) is not None:
            return Near(name, value, tolerance)
        made = Range(name, value, value)
        return Not(made) if is_not else made
    raise _no_question(scanner, name, start, NUMBER_WORDS)


def _range(name: str, first: float, second: float) -> Range:
    """Between two numbers, whichever is written first."""
    return Range(name, min(first, second), max(first, second))


def _value(scanner: Scanner, name: str) -> float:
    """A number, with the column's own unit behind it or without any."""
    value = scanner.number(f"a number for {label_of(name)}")
    match = scanner.take(UNIT)
    unit = BY_NAME[name].unit
    if match is not None and match.lastgroup != unit:
        scanner.at = match.end()
        raise QueryError(
            scanner.text, match.start(), match.end(),
            f"{label_of(name)} is in {unit}" if unit else f"{label_of(name)} has no unit",
            "write the number without this unit",
        )  # fmt: skip
    return value


def _tolerance(scanner: Scanner, name: str) -> float | None:
    at = scanner.at
    if not scanner.word(*PLUS_MINUS):
        return None
    if not scanner.has_number():  # "gloss 60 about 40, within dE 3 of ..."
        scanner.at = at
        return None
    tolerance = _value(scanner, name)
    if tolerance < 0.0:
        raise scanner.fault("a tolerance is not negative", "write a number above 0", at)
    return tolerance


def _text(scanner: Scanner, name: str, start: int) -> Condition:
    """What is asked of a text."""
    if scanner.word("is missing", "missing", "is empty"):
        return Present(name, False)
    if scanner.word("is known", "known"):
        return Present(name, True)
    for words, how in (
        (("contains", "contain", "containing", "includes", "has", "with", "~"), CONTAINS),
        ((":",) if name not in CHOICES else (), CONTAINS),
        (("starts with", "begins with", "starting with"), STARTS),
        (("ends with", "ending with"), ENDS),
    ):
        if words and scanner.word(*words):
            return TextTest(name, how, scanner.value(f"a text that {label_of(name)} {how}")[0])
    if name in BARE and scanner.word("like", "matches"):  # as SQL has it
        at = scanner.skip()
        text = scanner.value(f"a text that {label_of(name)} {CONTAINS}")[0].strip("%*")
        if not text:
            raise scanner.fault("any text is like this", f"write {label_of(name)} known", at)
        return TextTest(name, CONTAINS, text)
    if name == "path" and scanner.word("in", "under", "is in"):
        return TextTest(name, WITHIN, scanner.value("the name of a folder")[0])
    if name == "marks" and scanner.word("as"):
        return TextTest(name, CONTAINS, scanner.value("a mark")[0])
    negated = scanner.word("is not", "!=", "<>", "\u2260", "not") is not None
    has_word = negated or scanner.word("is", "=", "==", ":", "equals") is not None
    if name in CHOICES:
        made = _choice(scanner, name)
    elif has_word:
        made = TextTest(name, IS, scanner.value(f"the {label_of(name)}")[0])
    elif name in BARE and not scanner.done and not scanner.at_end_of_text():
        made = TextTest(name, CONTAINS, scanner.value(f"a text of {label_of(name)}")[0])
    else:
        raise _no_question(scanner, name, start, TEXT_WORDS)
    return Not(made) if negated else made


def _choice(scanner: Scanner, name: str) -> Condition:
    """One of few words."""
    choices = CHOICES[name]
    text, (at, end) = scanner.value(
        f"a {label_of(name)}: {', '.join(dict.fromkeys(choices.values()))}"
    )
    value = choices.get(text.lower())
    if value is None:
        raise QueryError(
            scanner.text, at, end, f"there is no such {label_of(name)}",
            suggestion(text, dict.fromkeys(choices.values())),
        )  # fmt: skip
    return TextTest(name, IS, value)


def _no_question(scanner: Scanner, name: str, start: int, words: str) -> QueryError:
    """The fault of a column without a question."""
    if scanner.done:
        return QueryError(
            scanner.text, start, len(scanner.text), f"what of {label_of(name)}?",
            f"add one of: {words}",
        )  # fmt: skip
    if scanner.word("descending", "desc", "ascending", "asc", "highest", "lowest", "high", "low"):
        text = scanner.text[start : scanner.at]
        order = f"write sort by {label_of(name)} descending, or {label_of(name)} above 40"
        return QueryError(scanner.text, start, start + len(text), "this is an order", order)
    return scanner.fault(f"not a question about {label_of(name)}", f"write one of: {words}")
