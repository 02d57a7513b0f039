"""The language of queries: every phrase of docs/catalogue.md, every fault with its place, fuzz."""

from __future__ import annotations

import math
import re
import time
from pathlib import Path

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from relgloss_view.base.errors import InputError
from relgloss_view.catalogue.columns import BYTES, COLUMNS, FLAG, NUMBER, WHOLE
from relgloss_view.catalogue.query.fault import QueryError
from relgloss_view.catalogue.query.parse import DEEPEST, MOST_CHARACTERS, parse
from relgloss_view.catalogue.query.terms import (
    CONTAINS,
    ENDS,
    IS,
    STARTS,
    WITHIN,
    All,
    Any,
    ColourNear,
    Flag,
    GlossRatio,
    Near,
    Nearest,
    Not,
    Order,
    Present,
    Range,
    ReferenceName,
    TextTest,
)

LONGEST_S = 1.0  #: for any text; docs/catalogue.md promises it


def above(column, value):
    return Range(column, low=value, with_low=False)


def below(column, value):
    return Range(column, high=value, with_high=False)


R = ReferenceName
PHRASES = {
    "gloss 60 between 40 and 50": Range("gloss_60", 40.0, 50.0),
    "GLOSS 60 BETWEEN 40 AND 50": Range("gloss_60", 40.0, 50.0),
    "gloss 60 between 50 and 40": Range("gloss_60", 40.0, 50.0),
    "gloss 60 from 40 to 50": Range("gloss_60", 40.0, 50.0),
    "gloss 60 not between 40 and 50": Not(Range("gloss_60", 40.0, 50.0)),
    "gloss 20 > 30": above("gloss_20", 30.0),
    "gloss 20>30": above("gloss_20", 30.0),
    "gloss20 > 30 GU": above("gloss_20", 30.0),
    "gloss_20 over 30": above("gloss_20", 30.0),
    "gloss at 75 degrees above 60": above("gloss_75", 60.0),
    "gloss at 75\u00b0 above 60": above("gloss_75", 60.0),
    "60 degree gloss below 3": below("gloss_60", 3.0),
    "60\u00b0 gloss under 3": below("gloss_60", 3.0),
    "paper gloss 75 >= 3": Range("gloss_75", low=3.0),
    "gloss 85 \u2264 3.5": Range("gloss_85", high=3.5),
    "gloss 60 is not above 3": Range("gloss_60", high=3.0),
    "gloss 60 error below 1": below("gloss_60_se", 1.0),
    "gloss 60 is 45": Range("gloss_60", 45.0, 45.0),
    "gloss 60 is not 45": Not(Range("gloss_60", 45.0, 45.0)),
    "gloss 60 about 45": Near("gloss_60", 45.0),
    "gloss 60 45 \u00b1 2": Near("gloss_60", 45.0, 2.0),
    "gloss 60 about 45 within 2": Near("gloss_60", 45.0, 2.0),
    "haze below 10": below("haze", 10.0),
    "haze missing": Present("haze", False),
    "haze is known": Present("haze", True),
    "distinctness of image > 3": above("doi", 3.0),
    "c_max at least .2": Range("c_max", low=0.2),
    "c max at least 0.2": Range("c_max", low=0.2),
    "c > 0.2": above("c", 0.2),
    "lobe width between 1 and 3": Range("s_deg_1", 1.0, 3.0),
    "lobe width below 3 deg": below("s_deg_1", 3.0),
    "first lobe width above 2": above("s_deg_1", 2.0),
    "second lobe width above 2": above("s_deg_2", 2.0),
    "lobes = 2": Range("lobes", 2.0, 2.0),
    "L* > 90": above("L_star", 90.0),
    "a* between -1 and \u22120.5": Range("a_star", -1.0, -0.5),
    "size > 1e6 bytes": above("bytes", 1e6),
    "colour within dE 3 of 50 20 10": ColourNear((50.0, 20.0, 10.0), 3.0),
    "color within dE 3 of 50 20 10": ColourNear((50.0, 20.0, 10.0), 3.0),
    "colour within 3 of Lab 50 20 10": ColourNear((50.0, 20.0, 10.0), 3.0),
    "colour within \u0394E 3 of L* 50 a* 20 b* -10": ColourNear((50.0, 20.0, -10.0), 3.0),
    "colour within dE00 3 of (50, 20, 10)": ColourNear((50.0, 20.0, 10.0), 3.0),
    "Lab 50 20 10 within dE76 3": ColourNear((50.0, 20.0, 10.0), 3.0, "76"),
    "dE76 3 of 50 20 10": ColourNear((50.0, 20.0, 10.0), 3.0, "76"),
    "within dE 3 of art-coated": ColourNear(R("art-coated"), 3.0),
    "colour within dE 3 of art-coated": ColourNear(R("art-coated"), 3.0),
    "dE from art-coated below 3": ColourNear(R("art-coated"), 3.0),
    "dE from 50 20 10 < 3": ColourNear((50.0, 20.0, 10.0), 3.0),
    "nearest colour to 50 20 10": ColourNear((50.0, 20.0, 10.0)),
    "colour near 7 coats": ColourNear(R("7 coats")),
    "colour within dE 3 of 007.csv and failed": All(
        (ColourNear(R("007.csv"), 3.0), TextTest("status", IS, "failed"))
    ),
    "colour near art-coated": ColourNear(R("art-coated")),
    "looks 0.7 x as glossy as cast-coated": GlossRatio(R("cast-coated"), 0.7),
    "0.7x as glossy as cast-coated": GlossRatio(R("cast-coated"), 0.7),
    "looks 0.7 times as glossy as cast-coated": GlossRatio(R("cast-coated"), 0.7),
    "looks 0.7 \u00d7 as glossy as cast-coated within 5 %": GlossRatio(R("cast-coated"), 0.7, 0.05),
    "50 % as glossy as my paper \u00b1 10%": GlossRatio(R("my paper"), 0.5, 0.1),
    "twice as glossy as uncoated": GlossRatio(R("uncoated"), 2.0),
    "half as glossy as uncoated": GlossRatio(R("uncoated"), 0.5),
    "as glossy as lot1/a-b.csv": GlossRatio(R("lot1/a-b.csv"), 1.0),
    "as glossy as X at 60 degrees within 5 %": GlossRatio(R("X"), 1.0, None, column="gloss_60"),
    "as glossy as X within 5 % at 60 degrees": GlossRatio(R("X"), 1.0, 0.05, column="gloss_60"),
    "at least 2 x as glossy as uncoated": GlossRatio(R("uncoated"), low=2.0),
    "less than 2 x as glossy as uncoated": GlossRatio(R("uncoated"), high=2.0, with_high=False),
    "glossier than X": GlossRatio(R("X"), low=1.0, with_low=False),
    "less glossy than X": GlossRatio(R("X"), high=1.0, with_high=False),
    "nearest to art-coated": Nearest(R("art-coated")),
    "looks most like art-coated": Nearest(R("art-coated")),
    'nearest to "black and white"': Nearest(R("black and white")),
    "name contains varnish": TextTest("name", CONTAINS, "varnish"),
    "name contains gloss varnish and failed": All(
        (TextTest("name", CONTAINS, "gloss varnish"), TextTest("status", IS, "failed"))
    ),
    "name is black-and-white": TextTest("name", IS, "black-and-white"),
    "name is not \u201cLot (3)\u201d": Not(TextTest("name", IS, "Lot (3)")),
    "name starts with W": TextTest("name", STARTS, "W"),
    "file ends with .csv": TextTest("path", ENDS, ".csv"),
    "file in lot1/": TextTest("path", WITHIN, "lot1/"),
    '"W"': Any((TextTest("name", CONTAINS, "W"), TextTest("path", CONTAINS, "W"))),
    "quality good": TextTest("quality", IS, "good"),
    "quality is not GOOD": Not(TextTest("quality", IS, "good")),
    "kind table": TextTest("kind", IS, "table"),
    "proofs": TextTest("kind", IS, "proof"),
    "failed": TextTest("status", IS, "failed"),
    "not failed": Not(TextTest("status", IS, "failed")),
    "not not failed": TextTest("status", IS, "failed"),
    "warning contains clip": TextTest("warnings", CONTAINS, "clip"),
    "marks contains synthetic": TextTest("marks", CONTAINS, "synthetic"),
    "ratio kept": Flag("is_ratio_kept", True),
    "ratio not kept": Flag("is_ratio_kept", False),
    "is_ratio_kept no": Flag("is_ratio_kept", False),
    "gloss 60 40-50": Range("gloss_60", 40.0, 50.0),
    "gloss 60: 40 to 50": Range("gloss_60", 40.0, 50.0),
    "gloss 60 > 40 and < 50": All((above("gloss_60", 40.0), below("gloss_60", 50.0))),
    "haze > 3 and at least 2 x as glossy as X": All(
        (above("haze", 3.0), GlossRatio(R("X"), low=2.0))
    ),
    "quality good or poor": Any(
        (TextTest("quality", IS, "good"), TextTest("quality", IS, "poor"))
    ),
    "a > 20": above("a_star", 20.0),
    "name varnish": TextTest("name", CONTAINS, "varnish"),
    "in folder lot1": TextTest("path", WITHIN, "lot1"),
    "without warnings": Present("warnings", False),
    "same gloss as X within 5 %": GlossRatio(R("X"), 1.0, 0.05),
    "colour within dE 3 of Lab(50, 20, 10)": ColourNear((50.0, 20.0, 10.0), 3.0),
    "like cast-coated": Nearest(R("cast-coated")),
    "all": None,
    "haze < 3 or haze > 9 and failed": Any(
        (below("haze", 3.0), All((above("haze", 9.0), TextTest("status", IS, "failed"))))
    ),
    "(haze < 3 or haze > 9) and failed": All(
        (Any((below("haze", 3.0), above("haze", 9.0))), TextTest("status", IS, "failed"))
    ),
    # East Asian digits and signs, other signs for ranges, and what SQL has
    "gloss 60 \uff1e \uff14\uff10\uff0e\uff15": above("gloss_60", 40.5),
    "gloss 60 40..50": Range("gloss_60", 40.0, 50.0),
    "gloss 60 40 \u2014 50": Range("gloss_60", 40.0, 50.0),
    "gloss 60 between 40 & 50": Range("gloss_60", 40.0, 50.0),
    "gloss 60 \u2248 45": Near("gloss_60", 45.0),
    "gloss 60 is not null": Present("gloss_60", True),
    "name like %varnish%": TextTest("name", CONTAINS, "varnish"),
    "no fault": Present("fault", False),
    "colour within dE 3 of 50;20;10": ColourNear((50.0, 20.0, 10.0), 3.0),
    'name is "\u767d\uff08\uff13\uff09"': TextTest("name", IS, "\u767d\uff083\uff09"),
    "haze < 3, failed": All((below("haze", 3.0), TextTest("status", IS, "failed"))),
}  # fmt: skip


@pytest.mark.parametrize("text", PHRASES)
def test_phrases_mean_what_they_say(text):
    wanted = PHRASES[text]
    if text == "as glossy as X at 60 degrees within 5 %":  # the tolerance may come last, too
        wanted = GlossRatio(R("X"), 1.0, 0.05, column="gloss_60")
    assert parse(text).condition == wanted


@pytest.mark.parametrize("column", [c for c in COLUMNS if c.kind in (NUMBER, WHOLE)], ids=str)
def test_every_number_is_known_by_name_and_heading(column):
    for name in (column.name, column.label, column.name.upper(), column.name.replace("_", " ")):
        assert parse(f"{name} > 3").condition == above(column.name, 3.0)
        assert parse(f"sort by {name} desc").order == (Order(column.name, True),)


def test_every_text_and_flag_is_known():
    for column in COLUMNS:
        if column.kind == FLAG:
            assert parse(column.name).condition == Flag(column.name, True)
        elif column.kind not in (NUMBER, WHOLE, BYTES):
            condition = parse(f"{column.name} contains x").condition
            assert condition == TextTest(column.name, CONTAINS, "x")


def test_order_and_number_of_hits():
    query = parse("haze < 3 sort by gloss 60 descending, name first 20")
    assert query.order == (Order("gloss_60", True), Order("name"))
    assert query.first == 20
    assert parse("sort by haze").condition is None
    assert parse("top 5").first == 5
    assert parse("").condition is parse("  ").condition is None
    query = parse("name contains first sample, sort by name, first 3 hits")
    assert (query.condition, query.first) == (TextTest("name", CONTAINS, "first sample"), 3)


def documented_phrases():
    """The phrases of the table in docs/catalogue.md, with a sample's name for its dots."""
    page = Path(__file__).resolve().parents[2] / "docs" / "catalogue.md"
    text = page.read_text(encoding="utf-8")
    table = text.split("### Phrases", 1)[1].split("###", 1)[0]
    rows = [line for line in table.splitlines() if line.startswith("| ")]
    return [phrase.replace("...", "X") for row in rows for phrase in re.findall("`(.+?)`", row)]


def test_documented_phrases_are_understood():
    phrases = documented_phrases()
    assert len(phrases) > 40
    for phrase in phrases:
        assert parse(phrase).condition is not None, phrase


#: text, the characters at fault, words of the message
FAULTS = [
    ("gloss 60 > 40,5", (11, 15), "40.5 with a point"),
    ("looks 0,7 x as glossy as art-coated", (6, 9), "with a point"),
    ("colour within dE 3 of 50,20,10", (22, 27), "a space between two numbers"),
    ("haze < 3 and glos 60 > 3", (13, 17), "did you mean gloss 60?"),
    ("quality goood", (8, 13), "did you mean good?"),
    ("kind sheet", (5, 10), "table, material, proof"),
    ("gloss > 60", (0, 5), "at which angle"),
    ("gloss 45 > 60", (0, 8), "no gloss at 45 degrees"),
    ("gloss 60 between 40", (19, 19), "between 40 and 50"),
    ("gloss 60", (0, 8), "above 40"),
    ("gloss 60 > 30 deg", (14, 17), "in GU"),
    ("gloss 60 > abc", (11, 14), "a number"),
    ("gloss 60 > 1e999", (11, 16), "too large"),
    ("poor", (0, 4), "write quality poor"),
    ("name contains and", (14, 17), "quotation marks"),
    ("name is Lot (3)", (8, 13), "quotation marks"),
    ('name is "Lot', (8, 12), "partner"),
    ("(gloss 60 > 3", (0, 1), "not closed"),
    ("gloss 60 > 3)", (12, 13), "not opened"),
    ("gloss 60 > 3 xor haze < 3", (13, 16), "did you mean or?"),
    ("gloss 60 > 3 and", (16, 16), "has to follow"),
    ("and gloss 60 > 3", (0, 3), "it joins two conditions"),
    ("not nearest to art-coated", (0, 25), "only ranks"),
    ("haze < 3 or as glossy as X", (0, 26), "within 5 %"),
    ("nearest to 50 20 10", (11, 19), "nearest colour to"),
    ("colour within dE 3", (18, 18), "'of'"),
    ("colour red", (7, 10), "colour within dE 3 of 50 20 10"),
    ("colour within dE -3 of 50 20 10", (17, 19), "not negative"),
    ("colour within dE 3 of 150 20 10", (22, 31), "0 to 100"),
    ("looks 0.7 x as shiny", (12, 14), "as glossy as"),
    ("0 x as glossy as X", (0, 3), "above 0"),
    ("as glossy as X within 5", (15, 23), "%"),
    ("as glossy as X at 50 degrees", (15, 28), "20, 60, 75 or 85"),
    ("40 < gloss 60 < 50", (0, 2), "between 40 and 50"),
    ("not quality good or poor", (20, 24), "write quality poor"),
    ("gloss 60 desc", (0, 13), "sort by gloss 60 descending"),
    ("colour near 7", (13, 13), "a name of digits needs quotation marks"),
    ("sort by glos", (8, 12), "did you mean"),
    ("sort by closeness", (0, 17), "close to"),
    ("first 0", (6, 7), "whole number"),
    ("first 2.5", (6, 9), "whole number"),
    ("\u2028name", (1, 5), "contains"),
    ("varnish", (0, 7), "write name contains varnish"),
    ("name like %", (10, 11), "write name known"),
]  # fmt: skip


@pytest.mark.parametrize(("text", "place", "words"), FAULTS, ids=[f[0] for f in FAULTS])
def test_faults_name_the_place_and_the_remedy(text, place, words):
    with pytest.raises(QueryError) as caught:
        parse(text)
    error = caught.value
    assert (error.at, error.end) == place
    assert words in str(error)
    assert "\n" not in str(error)
    assert error.exit_status == 1


class TestAnyText:
    """Whatever someone types, there is a query or an InputError, and that within a second."""

    WORDS = (
        "gloss", "60", "gloss 60", "between", "and", "or", "not", "(", ")", ",", "50 20 10", "dE",
        "colour", "within", "of", "nearest to", "as glossy as", "0.7 x", "%", "sort by", "first",
        "name", "contains", "'", '"', ">", "<", "=", "art-coated", "-", "1e9", "\u00b0", "\u00b1",
        "lot1/", "L*", "at", "looks", "is", "desc", "\x00", "\u202e", "\ud800", "7,5", "missing",
    )  # fmt: skip

    LONGER = (
        " ", "--", "gloss 60 > 3 and ", "not ", "gloss ", "a", "haze < 3, ", "((haze < 3) or ",
        "x as glossy as ", "9",
    )  # fmt: skip

    @staticmethod
    def check(text):
        start = time.process_time()
        try:
            query = parse(text)
        except InputError as error:
            assert isinstance(error, QueryError)
            assert 0 <= error.at <= error.end <= len(text) or not text
        else:
            assert query.text == text
        assert time.process_time() - start < LONGEST_S

    @given(st.text(max_size=200))
    @example("gloss 60 between ")
    @example("(" * 10_000)
    @settings(deadline=None, max_examples=150)
    def test_of_any_characters(self, text):
        self.check(text)

    @given(st.lists(st.sampled_from(WORDS), max_size=40), st.sampled_from([" ", "", "  "]))
    @settings(deadline=None, max_examples=400)
    def test_of_known_words(self, words, between):
        self.check(between.join(words))

    @pytest.mark.parametrize("word", [*WORDS, *LONGER])
    def test_of_ten_kilobytes(self, word):
        for joined in (word, word + " "):
            self.check((joined * 10_000)[:10_000])
            self.check("name contains " + (joined * 10_000)[:9_900])
            self.check("gloss 60" + (joined * 10_000)[:9_900])

    def test_of_nested_parentheses(self):
        self.check("(" * 10_000 + "haze < 3" + ")" * 10_000)
        self.check("not (" * 10_000)
        fine = "(" * DEEPEST + "haze < 3" + ")" * DEEPEST
        assert parse(fine).condition == below("haze", 3.0)
        with pytest.raises(QueryError, match="parentheses within each other"):
            parse(f"({fine})")

    def test_that_is_too_long(self):
        with pytest.raises(QueryError, match="longer"):
            parse("haze < 3 and " * MOST_CHARACTERS)

    def test_a_condition_of_many_parts(self):
        text = " and ".join(f"haze < {k}" for k in range(1, 1000))
        assert len(parse(text).condition.parts) == 999

    @given(st.floats(0.0, 1e6), st.floats(0.0, 1e6))
    def test_numbers_come_back(self, low, high):
        """What is written with Python's shortest digits is read as the same double."""
        condition = parse(f"haze between {low!r} and {high!r}").condition
        assert (condition.low, condition.high) == (min(low, high), max(low, high))
        assert math.isfinite(condition.high)
