"""Sentences and numbers of a report, and the names of its files."""

import csv
import dataclasses
import io
import json
import math
import re

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from report_cases import (
    adaptive,
    alone,
    judged_as,
    pool_of,
    study_of,
    usual,
    with_grain,
    without_answers,
)

from relgloss_view.experiment.report import sentences
from relgloss_view.experiment.report.answerers import people, silent, truths
from relgloss_view.experiment.report.chosen_setting import chosen_setting, nearest_shares
from relgloss_view.experiment.report.file_names import file_names
from relgloss_view.experiment.report.results import FORMAT, as_numbers
from relgloss_view.experiment.report.tables import ANSWER_COLUMNS, SCALE_COLUMNS, write_tables
from relgloss_view.experiment.session.records import PERSON, Observer
from relgloss_view.experiment.verdict.analysis import JOINT, Options, analyse
from relgloss_view.experiment.verdict.full_grid import (
    ALIKE,
    BROAD,
    CHANCE,
    MIXED,
    RIDGE,
    TWO,
)
from relgloss_view.experiment.verdict.groups import Camp, MixedGroups
from relgloss_view.picture.scene.setting import Setting


def rows_of(path):
    return list(csv.DictReader(io.StringIO(path.read_text(encoding="utf-8"))))


class TestSentences:
    def test_the_best_with_how_surely(self):
        told = sentences.summary(usual())
        assert "matte: best 1 deg, 2/6 c_max; leads in " in told
        assert re.search(r"between grid points \d\.\d\d deg \(0\.\d\d to 1\.\d\d\), 0\.\d", told)
        assert "study.sqlite: 108 answers" in told
        assert "6 simulated observers, all finished; 108 answers" in told
        assert "computed, not given by people" in told
        assert "Krippendorff's alpha 0." in told

    def test_an_edge_says_what_lies_beyond(self):
        told = sentences.summary(usual())
        assert "largest sigma_N (a wider grid may find better), smallest c (a wider" in told
        first = chosen_setting(usual().samples[0], usual().pool.study.grid)
        at_zero = dataclasses.replace(first, edges=("smallest sigma_N",))
        assert "no less grain" in sentences._edge_words(at_zero, usual().pool.study.grid)

    def test_chance_names_no_setting(self):
        analysis = judged_as(usual(), CHANCE)
        told = sentences.sentence(analysis.samples[0], analysis)
        assert told.startswith("no setting is declared best: the answers may be by chance (p ")
        assert "deg" not in told
        assert not any("edge" in note for note in sentences.notes(analysis.samples[0], analysis))

    def test_a_ridge_is_listed_and_asks_for_grain(self):
        good = np.zeros(9, dtype=bool)
        good[[0, 1, 4, 7, 8]] = True
        analysis = judged_as(usual(), RIDGE, as_good=good)
        told = sentences.sentence(analysis.samples[0], analysis)
        assert (
            "a curve of settings is as good: 0 deg, 1/6 to 2/6 c_max; 1 deg, 2/6 c_max; 2 deg, 2/6 "
            "to 3/6 c_max; leading 1 deg, 2/6 c_max; leads in "
        ) in told
        assert any(
            "procedure.ask_grain" in n for n in sentences.notes(analysis.samples[0], analysis)
        )

    def test_a_ridge_asks_for_grain_once(self):
        analysis = judged_as(with_grain(), RIDGE)
        notes = sentences.notes(analysis.samples[0], analysis)
        assert not any("ask_grain" in note for note in notes)
        assert any("more observers" in note for note in notes)

    def test_many_as_good(self):
        analysis = judged_as(usual(), BROAD)
        told = sentences.sentence(analysis.samples[0], analysis)
        assert told.startswith("no setting is clearly best: ")

    def test_others_that_are_as_good(self):
        analysis = judged_as(usual(), "best", as_good=np.ones(9, dtype=bool))
        told = sentences.sentence(analysis.samples[0], analysis)
        assert told.startswith("best among settings not told apart: 1 deg, 2/6 c_max; ")
        assert "and 2 more; leading 1 deg, 2/6 c_max" in told
        one = judged_as(usual(), "best", as_good=np.eye(9, dtype=bool)[4])
        assert "told apart" not in sentences.sentence(one.samples[0], one)

    def test_groups_that_disagree_are_listed_and_no_setting(self):
        camps = (Camp((0, 2, 4), 1.0, 2 / 6, "ridge"), Camp((1, 3, 5), 2.0, 1 / 6, "point"))
        analysis = judged_as(usual(), MIXED, groups=MixedGroups(0.0002, camps))
        told = sentences.sentence(analysis.samples[0], analysis)
        assert told == (
            "no setting is declared best: two groups of observers disagree (p of one group "
            "< 0.001): 3 find many settings as close as 1 deg, 2/6 c_max and 3 find 2 deg, 1/6 "
            "c_max closest"
        )
        assert "group 2: O02, O04, O06" in sentences.notes(analysis.samples[0], analysis)
        assert not chosen_setting(analysis.samples[0], analysis.pool.study.grid).may_be_named

    def test_two_places_and_alike_answers(self):
        analysis = judged_as(usual(), TWO, places=(1, 7))
        told = sentences.sentence(analysis.samples[0], analysis)
        assert told.endswith("near 0 deg, 2/6 c_max and near 2 deg, 2/6 c_max")
        analysis = judged_as(usual(), ALIKE, alike=0.97)
        assert "97 % of the answers are the same" in sentences.summary(analysis)

    def test_one_observer(self):
        told = sentences.summary(alone())
        assert "leading 1 deg, 2/6 c_max; one observer shows nothing about other people" in told
        assert "1 simulated observer, finished" in told
        assert "best" not in told.replace("best between", "")
        assert "agreement" not in told

    def test_observers_that_were_not_resampled(self):
        analysis = analyse(usual().pool, Options(0))
        assert "nothing shows how sure this is" in sentences.summary(analysis)

    def test_both_questions(self):
        told = sentences.summary(with_grain())
        assert "by the ratio of gloss alone: " in told
        assert "by the grain alone: " in told

    def test_an_adaptive_study_follows_its_posterior(self):
        told = sentences.summary(adaptive())
        assert "% of the posterior" in told
        assert "resamplings" not in told

    def test_nobody_is_dropped_silently(self):
        analysis = usual()
        (record,) = analysis.pool.records
        late = Observer(6, "O07", PERSON, True, False)
        record = dataclasses.replace(
            record, observers=(*record.observers, late), details=(*record.details, {})
        )
        pool = dataclasses.replace(analysis.pool, records=(record,))
        assert silent(pool) == ["O07"]
        assert "O07: no answers yet" in sentences.summary(dataclasses.replace(analysis, pool=pool))

    def test_observers_to_look_at(self):
        pool = pool_of(study_of(("matte",)), kind="random", count=4)
        told = sentences.summary(analyse(pool, Options(5)))
        assert "observers to check:\n  O01: " in told

    def test_a_sample_that_nobody_judged(self):
        pool = without_answers(usual().pool, lambda answer: answer.trial.sample == 1)
        assert "rough: nobody has judged it yet" in sentences.summary(analyse(pool, Options(5)))

    def test_people_and_simulated_ones_together(self):
        pool = usual().pool
        first = [dataclasses.replace(m, kind=PERSON) for m in pool.members[:2]]
        mixed = dataclasses.replace(pool, members=(*first, *pool.members[2:]))
        assert "Some of these observers are simulated" in sentences.simulated_words(mixed)
        assert people(mixed) == "2 persons, all finished; 4 simulated observers, all finished"
        alike = [dataclasses.replace(m, kind=PERSON) for m in pool.members]
        assert sentences.simulated_words(dataclasses.replace(pool, members=tuple(alike))) is None

    def test_labels_cannot_break_the_terminal(self):
        pool = pool_of(study_of(("\x1b[31m\n\u202e$x_1$",)), count=1)
        assert "\x1b" not in sentences.summary(analyse(pool))

    @pytest.mark.parametrize(
        ("share", "told"),
        [(0.0, "0 %"), (0.004, "under 1 %"), (0.5, "50 %"), (0.999, "over 99 %"), (1.0, "100 %")],
    )
    def test_percent(self, share, told):
        assert sentences.percent(share) == told


class TestNumbers:
    @pytest.mark.parametrize("made", [usual, alone, with_grain, adaptive])
    def test_json_holds_everything(self, made):
        found = as_numbers(made())
        assert json.loads(json.dumps(found, allow_nan=False)) == found
        assert found["format"] == FORMAT
        assert found["simulated"] is True
        assert found["truths"]["matte"] == {"sigma_n_deg": 1.0, "c_fraction": 2 / 6}
        (file,) = found["files"]
        assert len(file["study_digest"]) == 64
        assert file["runs"][0]["device"] == "none: simulated"
        first = found["samples"][0]
        assert first["leading"]["sigma_n_deg"] == 1.0
        assert len(first["questions"]["ratio"]["settings"]) == 9
        assert len(first["questions"]["ratio"]["bounds"]["probit"]) == 4

    def test_intervals_hold_what_they_are_of(self):
        ratio = as_numbers(usual())["samples"][0]["questions"]["ratio"]
        best = max(ratio["settings"], key=lambda s: s["probit"])
        assert best["low"] < best["probit"] < best["high"]
        assert sum(s["wins"] for s in ratio["settings"]) == pytest.approx(1.0)
        assert best["counts"] == [int(n) for n in best["counts"]]
        assert sum(best["counts"]) == best["answers"] == 6

    def test_one_observer_has_no_intervals(self):
        (sample,) = as_numbers(alone())["samples"]
        assert sample["status"] == "few"
        assert sample["optimum"]["c_interval"] is None
        assert sample["krippendorff_alpha"] is None
        assert sample["questions"]["ratio"]["settings"][0]["low"] is None

    def test_both_together_is_the_sum(self):
        questions = as_numbers(with_grain())["samples"][0]["questions"]
        for ratio, grain, both in zip(
            *(questions[q]["settings"] for q in ("ratio", "grain", JOINT)), strict=True
        ):
            assert both["probit"] == pytest.approx(ratio["probit"] + grain["probit"])
            assert both["counts"] is None

    def test_settings_that_nobody_judged_have_no_number(self):
        pool = without_answers(usual().pool, lambda answer: answer.trial.setting == 8)
        (first, _) = as_numbers(analyse(pool, Options(5)))["samples"]
        last = first["questions"]["ratio"]["settings"][8]
        assert (last["probit"], last["low"], last["torgerson"]) == (None, None, None)
        assert last["answers"] == 0

    def test_truths_need_to_be_the_same_for_all(self):
        pool = usual().pool
        (record,) = pool.records
        details = ({"truths": {"matte": [0.5, 0.5], "rough": "x"}}, *record.details[1:])
        changed = dataclasses.replace(record, details=details)
        assert truths(dataclasses.replace(pool, records=(changed,))) == {}
        assert truths(pool) == {"matte": Setting(1.0, 2 / 6), "rough": Setting(2.0, 1 / 6)}

    def test_a_posterior_is_shared_out_to_the_nearest(self):
        grid = usual().pool.study.grid
        posterior = np.zeros((9, 9))
        posterior[1, 0], posterior[4, 5], posterior[8, 8] = 0.2, 0.3, 0.5
        shares = nearest_shares(grid, posterior).reshape(grid.shape)
        assert (shares[0, 0], shares[1, 1], shares[2, 2]) == pytest.approx((0.2, 0.3, 0.5))


class TestTables:
    def test_the_scale(self, tmp_path):
        write_tables(tmp_path, with_grain())
        rows = rows_of(tmp_path / "scale.csv")
        assert tuple(rows[0])[: len(SCALE_COLUMNS)] == SCALE_COLUMNS
        assert tuple(rows[0])[-5:] == (
            "1 close", "2 slightly close", "3 fair", "4 slightly far", "5 far",
        )  # fmt: skip
        assert [r["question"] for r in rows] == [
            q for q in ("ratio", "grain", JOINT) for _ in "9" * 9
        ]
        assert all(int(r["n"]) == 6 for r in rows[:18])
        assert rows[-1]["n"] == ""
        leading = max(rows[18:], key=lambda r: float(r["probit"]))
        assert leading["as_good"] == "1"
        assert float(leading["low"]) < float(leading["probit"]) < float(leading["high"])

    def test_every_answer(self, tmp_path):
        write_tables(tmp_path, usual())
        rows = rows_of(tmp_path / "answers.csv")
        assert tuple(rows[0]) == ANSWER_COLUMNS
        assert len(rows) == 6 * 2 * 9
        assert {r["observer"] for r in rows} == {f"O0{k}" for k in range(1, 7)}
        assert {int(r["category"]) for r in rows} <= {1, 2, 3, 4, 5}
        answer = usual().pool.members[0].answers[0]
        assert rows[0]["category_name"] == usual().pool.study.categories[answer.category]
        assert float(rows[0]["response_s"]) == answer.response_s


class TestNames:
    @given(st.lists(st.text(min_size=1, max_size=60), max_size=24))
    @example(["..", ".", "", "/etc/passwd", "a/b", "a\\b", "A/B", "con", "COM1.txt", "-rf", "~"])
    @example(["x" * 60, "x" * 59, "X" * 58])
    @example(["é", "e\u0301", "ﬁ", "fi", "ß", "SS"])
    def test_they_are_safe_and_different(self, labels):
        names = file_names(labels)
        assert len({n.casefold() for n in names}) == len(labels)
        for name in names:
            assert name.strip(". ") == name != ""
            assert not name.startswith("-")
            assert not set(name) & set('/\\:*?"<>|\0\n\r\t ')
            assert name.split(".")[0].casefold() not in ("con", "com1")
            assert len(f"{name}.material.json".encode()) <= 255

    def test_they_can_be_recognised(self):
        assert file_names(["art-coated", "Karton 3 (weiß)", "紙"]) == (
            "art-coated", "Karton-3-weiß", "紙",
        )  # fmt: skip


def test_no_number_is_a_dash():
    assert [sentences.number(v) for v in (None, math.nan, -0.001, -1.5)] == [
        "-",
        "-",
        "0.00",
        "-1.50",
    ]
