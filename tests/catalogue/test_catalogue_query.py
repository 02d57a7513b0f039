"""Hits, order and rows left out, against DuckDB's SQL, colour-science, and by hand."""

from __future__ import annotations

import json

import duckdb
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from search_rows import MemoryCatalogue, paths

from relgloss_view.catalogue.columns import NAMES
from relgloss_view.catalogue.query.fault import QueryError
from relgloss_view.catalogue.query.listing import listing
from relgloss_view.catalogue.query.search import Searcher, search
from relgloss_view.gloss.match import gloss_of
from relgloss_view.material.files import save_material
from relgloss_view.picture.scene.sample import load_sample

COUNT = 300
NUMBERS = ("gloss_60", "haze", "s_deg_1", "lobes")
TEXTS = ("name", "quality", "warnings", "path")


def many_rows():
    """Rows with round numbers, so that equal ones are common, and with missing values."""
    rng = np.random.default_rng(20)

    def some(value):
        return None if rng.random() < 0.2 else value

    return [
        {
            "path": f"lot{k % 4}/{'AbCdE'[k % 5]}{k}.csv",
            "name": some(f"{['Gloss', 'matt', 'SATIN'][k % 3]} {k % 40}"),
            "quality": some(["good", "poor", "unidentifiable"][k % 3]),
            "warnings": some("clipped light\nfew angles" if k % 7 else ""),
            "status": "failed" if k % 11 == 0 else "done",
            "gloss_60": some(float(rng.integers(0, 100))),
            "haze": some(float(rng.integers(0, 20)) / 2.0),
            "s_deg_1": some(float(rng.uniform(0.1, 20.0))),
            "lobes": some(int(rng.integers(0, 3))),
            "is_ratio_kept": some(bool(k % 2)),
        }
        for k in range(COUNT)
    ]


@pytest.fixture(scope="module")
def both():
    """The same rows for a search and in DuckDB."""
    rows = many_rows()
    columns = list(rows[0])
    base = duckdb.connect(":memory:")
    kinds = {"gloss_60": "DOUBLE", "haze": "DOUBLE", "s_deg_1": "DOUBLE", "lobes": "INTEGER",
             "is_ratio_kept": "BOOLEAN"}  # fmt: skip
    declared = ", ".join(f"{name} {kinds.get(name, 'VARCHAR')}" for name in columns)
    base.execute(f"CREATE TABLE t ({declared})")
    base.executemany(
        f"INSERT INTO t VALUES ({', '.join('?' * len(columns))})", [list(r.values()) for r in rows]
    )
    yield Searcher(MemoryCatalogue(rows)), base
    base.close()


#: A phrase with {a} and {b}, and its meaning in SQL.
NUMBER_PAIRS = [
    ("{c} > {a}", "{c} > {a}"),
    ("{c} below {a}", "{c} < {a}"),
    ("{c} at least {a}", "{c} >= {a}"),
    ("{c} at most {a}", "{c} <= {a}"),
    ("{c} is {a}", "{c} = {a}"),
    ("{c} is not {a}", "{c} <> {a}"),
    ("{c} between {a} and {b}", "{c} BETWEEN least({a}, {b}) AND greatest({a}, {b})"),
    ("{c} about {a} within {b}", "abs({c} - {a}) <= {b}"),
    ("{c} missing", "{c} IS NULL"),
    ("{c} known", "{c} IS NOT NULL"),
]
TEXT_PAIRS = [
    ("quality good", "quality = 'good'"),
    ("quality is not poor", "quality <> 'poor'"),
    ("name contains gloss", "contains(lower(name), 'gloss')"),
    ("name is Satin 2", "lower(name) = 'satin 2'"),
    ("name starts with m", "starts_with(lower(name), 'm')"),
    ("warning contains CLIP", "contains(lower(coalesce(warnings, '')), 'clip')"),
    ("file in lot2/", "starts_with(path, 'lot2/')"),
    ("file ends with 3.csv", "suffix(path, '3.csv')"),
    ("failed", "status = 'failed'"),
    ("ratio kept", "is_ratio_kept"),
    ("ratio not kept", "NOT is_ratio_kept"),
]
values = st.integers(0, 40).map(lambda n: n / 2.0)
leaves = st.one_of(
    st.tuples(st.sampled_from(NUMBER_PAIRS), st.sampled_from(NUMBERS), values, values).map(
        lambda t: tuple(part.format(c=t[1], a=t[2], b=t[3]) for part in t[0])
    ),
    st.sampled_from(TEXT_PAIRS),
)
conditions = st.recursive(
    leaves,
    lambda inner: st.one_of(
        inner.map(lambda c: (f"not ({c[0]})", f"NOT ({c[1]})")),
        st.tuples(inner, st.sampled_from(["and", "or"]), inner).map(
            lambda t: (f"({t[0][0]}) {t[1]} ({t[2][0]})", f"({t[0][1]}) {t[1]} ({t[2][1]})")
        ),
        # without parentheses both languages bind "and" before "or"
        st.tuples(leaves, leaves, leaves).map(
            lambda t: (f"{t[0][0]} or {t[1][0]} and {t[2][0]}",
                       f"{t[0][1]} OR {t[1][1]} AND {t[2][1]}")
        ),
    ),
    max_leaves=6,
)  # fmt: skip


class TestAgainstSql:
    """SQL's logic of nulls is Kleene's, written by others."""

    @given(conditions)
    @settings(deadline=None, max_examples=150)
    def test_hits_and_rows_left_out(self, both, condition):
        searcher, base = both
        text, sql = condition
        found = searcher.search(f"({text}) sort by file")
        wanted = base.execute(f"SELECT path FROM t WHERE {sql} ORDER BY lower(path)").fetchall()
        assert paths(found) == [row[0] for row in wanted]
        unknown = base.execute(f"SELECT count(*) FROM t WHERE ({sql}) IS NULL").fetchone()
        assert found.left_out == unknown[0]
        assert found.total == len(found.hits)

    @pytest.mark.parametrize("column", ["gloss_60", "haze", "quality", "lobes"])
    @pytest.mark.parametrize("way", ["ascending", "descending"])
    def test_order(self, both, column, way):
        searcher, base = both
        found = searcher.search(f"sort by {column} {way}, lobes first 200")
        sql = f"ORDER BY {column} {way[: way.index('c') + 1]} NULLS LAST, lobes NULLS LAST, path"
        wanted = base.execute(f"SELECT path FROM t {sql} LIMIT 200").fetchall()
        assert paths(found) == [row[0] for row in wanted]
        assert found.total == COUNT

    def test_a_wrong_answer_is_noticed(self, both):
        """Where nulls counted as 0, the two would differ: the rows do test it."""
        searcher, base = both
        found = searcher.search("not haze > 3")
        count = "SELECT count(*) FROM t WHERE NOT coalesce(haze, 0) > 3"
        assert base.execute(count).fetchone()[0] > found.total


def gray(path, **values):
    return {"path": path, "name": path.removesuffix(".csv"), **values}


class TestColour:
    def catalogue(self):
        rng = np.random.default_rng(3)
        labs = rng.uniform((20, -60, -60), (90, 60, 60), (200, 3))
        rows = [
            gray(f"{k:03}.csv", L_star=lightness, a_star=a, b_star=b)
            for k, (lightness, a, b) in enumerate(labs)
        ]
        return labs, MemoryCatalogue(rows)

    @pytest.mark.parametrize(("word", "method"), [("dE", "CIE 2000"), ("dE76", "CIE 1976")])
    def test_against_colour_science(self, word, method):
        """colour-science computes CIEDE2000 after Sharma et al., too; both are float64."""
        from colour.difference import delta_E

        labs, catalogue = self.catalogue()
        target = [50.0, 20.0, 10.0]
        wanted = delta_E(labs, np.broadcast_to(target, labs.shape), method=method)
        found = search(catalogue, f"colour within {word} 35 of 50 20 10")
        order = [k for k in np.argsort(wanted, kind="stable") if wanted[k] <= 35.0]
        assert 5 < len(order) < 195
        assert paths(found) == [f"{k:03}.csv" for k in order]
        numbers = [hit.numbers["colour_difference"] for hit in found.hits]
        np.testing.assert_allclose(numbers, wanted[order], atol=1e-9)

    def test_the_formulas_rank_differently(self):
        """Negative control: 1976 in place of 2000 would be seen."""
        _, catalogue = self.catalogue()
        first, second = (
            paths(search(catalogue, f"colour within {word} 35 of 50 20 10"))
            for word in ("dE", "dE76")
        )
        assert first != second

    def test_of_a_sample(self):
        _, catalogue = self.catalogue()
        found = search(catalogue, "colour near 007.csv, first 1")
        assert paths(found) == ["007.csv"]
        assert found.hits[0].numbers["colour_difference"] == 0.0
        assert found.reference.words == "item 007.csv"


class TestRatio:
    ROWS = tuple(
        gray(f"{k}.csv", gloss_75=10.0 * k, gloss_60=100.0 - 10.0 * k) for k in range(1, 10)
    )

    def test_of_an_item(self):
        """By hand: 0.7 of 50 is 35; 30 and 40 are as far from it, and the file decides."""
        found = search(MemoryCatalogue(self.ROWS), "looks 0.7 x as glossy as 5.csv, first 3")
        assert paths(found) == ["3.csv", "4.csv", "2.csv"]
        assert [hit.numbers["ratio"] for hit in found.hits] == [0.6, 0.8, 0.4]
        assert found.total == 9
        assert "gloss 75 is 50.0 GU" in found.notes[0]

    def test_within_a_tolerance(self):
        found = search(MemoryCatalogue(self.ROWS), "looks 0.7 x as glossy as 5 within 15 %")
        assert paths(found) == ["3.csv", "4.csv"]
        assert not search(MemoryCatalogue(self.ROWS), "0.7 x as glossy as 5 within 14 %").hits

    def test_at_another_angle(self):
        """At 60 degrees the order is the other way round."""
        found = search(MemoryCatalogue(self.ROWS), "as glossy as 5 at 60 degrees within 20 %")
        assert paths(found) == ["5.csv", "4.csv", "6.csv"]
        assert found.columns == ("gloss_60",)

    def test_of_a_built_in_paper_and_a_file(self, tmp_path):
        matte = load_sample("matte-coated")
        save_material(matte, tmp_path / "matte file.json")
        reading = gloss_of(matte)
        wanted = [row["path"] for row in self.ROWS if row["gloss_75"] > reading]
        for name in ("matte-coated", tmp_path / "matte file.json"):
            found = search(MemoryCatalogue(self.ROWS), f"glossier than {name}")
            assert paths(found) == wanted
            ratios = [hit.numbers["ratio"] * reading for hit in found.hits]
            np.testing.assert_allclose(ratios, [10.0 * int(p[0]) for p in wanted], rtol=1e-12)

    def test_a_reference_without_gloss(self):
        rows = [*self.ROWS, gray("dull.csv", gloss_75=0.0)]
        with pytest.raises(QueryError, match="has no gloss"):
            search(MemoryCatalogue(rows), "as glossy as dull")


class TestNames:
    ROWS = (
        gray("a/one.csv"), gray("b/one.csv"), gray("Straße.csv"), gray("A\u0308rmel.csv"),
        {**gray("bad.csv"), "status": "failed", "fault": "no rows"},
    )  # fmt: skip

    def place(self, text):
        with pytest.raises(QueryError) as caught:
            search(MemoryCatalogue(self.ROWS), text)
        return text[caught.value.at : caught.value.end], str(caught.value)

    def test_unknown_ones_name_the_place(self):
        place, words = self.place("haze < 3 and colour near Strase")
        assert place == "Strase"
        assert "did you mean Straße" in words

    def test_ambiguous_and_failed_ones(self):
        assert "a/one.csv, b/one.csv" in self.place("colour near one")[1]
        place, words = self.place("nearest to bad.csv")
        assert (place, "no rows" in words) == ("bad.csv", True)

    def test_a_name_that_is_not_the_file(self):
        rows = [*self.ROWS, {**gray("x/7.csv"), "name": "Blue varnish", "L_star": 50.0,
                             "a_star": 0.0, "b_star": 0.0}]  # fmt: skip
        found = search(MemoryCatalogue(rows), "colour near blue VARNISH")
        assert found.reference.words == "item x/7.csv"

    @pytest.mark.parametrize("name", ["x/y/7.csv", "7.csv", '"7"', "Seven", "X/Y/7.CSV"])
    def test_every_way_to_name_a_file(self, name):
        colour = {"L_star": 50.0, "a_star": 0.0, "b_star": 0.0}
        rows = [*self.ROWS, {**gray("x/y/7.csv"), "name": "seven", **colour}]
        found = search(MemoryCatalogue(rows), f"colour near {name}")
        assert found.reference.words == "item x/y/7.csv"

    def test_letters_of_any_kind(self):
        catalogue = MemoryCatalogue(self.ROWS)
        assert paths(search(catalogue, "name contains STRASSE")) == ["Straße.csv"]
        assert paths(search(catalogue, "name is \u00c4RMEL")) == ["A\u0308rmel.csv"]


class TestAnswers:
    ROWS = (
        gray("a.csv", gloss_60=45.26, gloss_60_se=0.31, haze=1.0),
        gray("b.csv", gloss_60=12.0),
        {**gray("\x1b[31mred.csv"), "gloss_60": 50.0, "haze": None},
    )

    def test_table(self):
        text = listing(search(MemoryCatalogue(self.ROWS), "gloss 60 > 20 and haze < 3"))
        assert "45.3 +- 0.4" in text  # rounded up, as meter readings are
        assert "1 hit of 3 files, by file:" in text
        assert "1 row was left out because a value is missing: haze in 1." in text
        assert "whatever its standard error" in text

    def test_nothing_found_says_so(self):
        text = listing(search(MemoryCatalogue(self.ROWS), "gloss 60 > 99"))
        assert text.startswith("No hits: none of 3 files meets the query.")

    def test_hostile_names_are_shown_and_not_obeyed(self):
        text = listing(search(MemoryCatalogue(self.ROWS), "gloss 60 > 20"))
        assert "\x1b" not in text
        assert "\\x1b[31mred.csv" in text

    def test_json_is_whole(self):
        found = search(MemoryCatalogue(self.ROWS), "gloss 60 > 20 first 1")
        content = json.loads(json.dumps(found.as_json(), allow_nan=False))
        assert (content["total"], len(content["hits"])) == (2, 1)
        assert set(content["hits"][0]) == {"rank", "numbers", *NAMES} - {"thumbnail"}

    def test_json_holds_no_infinity(self):
        found = search(MemoryCatalogue([gray("a.csv", c_spread=float("inf"))]), "")
        assert found.as_json()["hits"][0]["c_spread"] is None

    def test_an_empty_catalogue(self):
        found = search(MemoryCatalogue([]), "gloss 60 > 20 and name contains x")
        assert (found.total, found.searched) == (0, 0)
        assert "none of 0 files" in listing(found)

    def test_limits_meet(self):
        catalogue = MemoryCatalogue(self.ROWS)
        assert len(search(catalogue, "first 2", 1).hits) == 1
        assert len(search(catalogue, "first 1", 2).hits) == 1
        assert len(search(catalogue, "", None).hits) == 3


def test_a_number_that_is_shown_rounded_has_a_note():
    """Else "gloss 60 is 45.3" finds nothing of what the table shows as 45.3, in silence."""
    rows = [{"path": "a.csv", "status": "done", "gloss_60": 45.312, "lobes": 2}]
    searcher = Searcher(MemoryCatalogue(rows))
    found = searcher.search("gloss 60 is 45.3")
    assert (found.total, found.notes[0]) == (
        0,
        "Only gloss 60 of exactly 45.3 counts: about 45.3 within 0.05 allows for rounding.",
    )
    assert searcher.search("gloss 60 about 45.3 within 0.05").total == 1
    assert "within 0.5" in searcher.search("gloss 60 = 45").notes[0]
    assert searcher.search("lobes is 2").notes == ()
