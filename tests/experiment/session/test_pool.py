"""Answers of several session files together, and what may not be pooled."""

from __future__ import annotations

import contextlib
import shutil
import sqlite3

import numpy as np
import pytest
from cases import answer, answer_all, percepts, replaced, started, study

from relgloss_view.base.errors import InputError
from relgloss_view.display.display import Display
from relgloss_view.experiment.design.grid import Grid
from relgloss_view.experiment.design.study import Procedure, Screen
from relgloss_view.experiment.observers.population import Population
from relgloss_view.experiment.observers.simulation import run_observers
from relgloss_view.experiment.session.flow import Phase
from relgloss_view.experiment.session.pool import read_pool
from relgloss_view.experiment.session.store import Store
from relgloss_view.experiment.verdict.analysis import Options, analyse
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.setting import Setting
from relgloss_view.picture.scene.setup import Eye, Lamp, Setup

SMALL = Grid((0.0, 2.0), (0.5, 1.0))


def simulated(file, made, count, seed, truth=Setting(1.0, 0.7)):  # noqa: B008 - frozen
    with Store(file, made) as store:
        seen = percepts(made, [truth] * len(made.samples))
        run_observers(store, seen, Population(), count, seed)


def test_two_files_are_one_study(tmp_path):
    made = study()
    simulated(tmp_path / "mon.sqlite", made, 3, 1)
    simulated(tmp_path / "tue.sqlite", replaced(made, title="The same, on Tuesday"), 2, 2)
    pool = read_pool([tmp_path / "mon.sqlite", tmp_path / "tue.sqlite"], tmp_path)
    assert [m.name for m in pool.members] == [
        "mon: O01", "mon: O02", "mon: O03", "tue: O01", "tue: O02",
    ]  # fmt: skip
    counts = pool.answers(0, "ratio").counts()
    assert counts.shape == (5, 42, 5)
    assert np.all(counts.sum(axis=(1, 2)) == 42)
    assert pool.simulated
    alone = read_pool([tmp_path / "mon.sqlite"], tmp_path)
    assert [m.name for m in alone.members] == ["O01", "O02", "O03"]


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"grid": Grid((0.0, 1.0), (0.5, 1.0))}, "another grid"),
        ({"categories": ("yes", "maybe", "no")}, "another categories"),
        ({"reference": study(("uncoated",)).samples[0].sample}, "another reference"),
        ({"samples": study(("uncoated",)).samples}, "another samples"),
        ({"look": Look(grain="surface")}, "another look"),
        ({"reference_look": Look(c_fraction=0.5)}, "another reference look"),
        ({"setup": Setup(lamp=Lamp(azimuth_deg=60))}, "another lamp"),
        ({"setup": Setup(eye=Eye(distance_m=0.7))}, "another eye"),
        ({"setup": Setup(display=Display(gamma=2.0))}, "another display"),
        ({"screen": Screen(width_px=97)}, "another screen"),
        ({"procedure": Procedure(ask_grain=True)}, "another procedure"),
        ({"procedure": Procedure(design="adaptive")}, "another procedure"),
    ],
)
def test_other_questions_are_not_pooled(tmp_path, changes, words):
    made = study(grid=SMALL)
    for name, each in (("a", made), ("b", replaced(made, **changes))):
        with Store(tmp_path / f"{name}.sqlite", each) as store:
            answer(started(store))
    with pytest.raises(InputError, match=rf"b\.sqlite: its study has {words}"):
        read_pool([tmp_path / "a.sqlite", tmp_path / "b.sqlite"], tmp_path)


def test_how_it_was_led_may_differ(tmp_path):
    for name, made in (
        ("a", study(grid=SMALL)),
        ("b", study(grid=SMALL, seed=4, gap_s=1.0, adaptation_min=3.0, order="random", repeats=2)),
    ):
        with Store(tmp_path / f"{name}.sqlite", made) as store:
            answer(started(store))
    pool = read_pool([tmp_path / "a.sqlite", tmp_path / "b.sqlite"], tmp_path)
    assert len(pool.members) == 2


def test_a_copy_does_not_count_twice(tmp_path):
    simulated(tmp_path / "a.sqlite", study(grid=SMALL), 2, 0)
    shutil.copy(tmp_path / "a.sqlite", tmp_path / "backup.sqlite")
    with pytest.raises(InputError, match=r"backup\.sqlite: holds the session of O01 that is in"):
        read_pool([tmp_path / "a.sqlite", tmp_path / "backup.sqlite"], tmp_path)


def test_files_of_one_name_are_told_apart(tmp_path):
    for k, folder in enumerate(("x", "y")):
        (tmp_path / folder).mkdir()
        simulated(tmp_path / folder / "s.sqlite", study(grid=SMALL), 1, k)
    pool = read_pool([tmp_path / "x" / "s.sqlite", tmp_path / "y" / "s.sqlite"], tmp_path)
    assert len({m.name for m in pool.members}) == 2


@pytest.mark.parametrize(
    ("change", "what"),
    [
        ("UPDATE answer SET category = 99", "answer.category"),
        ("UPDATE answer SET category = 'far'", "answer.category"),
        ("UPDATE answer SET response_ms = 'soon'", "damaged"),
        ("UPDATE trial SET setting = 999", "trial.setting"),
        ("UPDATE trial SET sample = 17", "trial.sample"),
        ("UPDATE observer SET details = '{'", "damaged"),
        ("UPDATE observer SET details = '3'", "observer.details"),
        ("UPDATE observer SET name = x'00ff'", "damaged"),
        ("UPDATE run SET screen = 'x'", "damaged"),
        ("UPDATE run SET device = x'00'", "run"),
        ("UPDATE study SET version = x'00'", "study.version"),
        ("UPDATE study SET content = '[[[['", "the study in it is damaged"),
        ("UPDATE study SET content = replace(content, 'cylinder', 'can')", "the study in it"),
        ("DELETE FROM study", "the study in it is damaged"),
    ],
)
def test_damaged_rows(tmp_path, change, what):
    """One line with the file's name, whatever a row says."""
    file = tmp_path / "a.sqlite"
    simulated(file, study(grid=SMALL), 1, 0)
    with contextlib.closing(sqlite3.connect(file)) as connection, connection:
        connection.execute("PRAGMA ignore_check_constraints = ON")
        connection.execute(change)
    with pytest.raises(InputError, match=rf"a\.sqlite: .*{what}") as caught:
        read_pool([file], tmp_path)
    assert "\n" not in str(caught.value)


def test_a_file_given_twice(tmp_path):
    simulated(tmp_path / "a.sqlite", study(grid=SMALL), 1, 0)
    (tmp_path / "link.sqlite").symlink_to(tmp_path / "a.sqlite")
    with pytest.raises(InputError, match="given twice"):
        read_pool([tmp_path / "a.sqlite", tmp_path / "link.sqlite"], tmp_path)


def test_nobody_has_answered(tmp_path):
    Store(tmp_path / "a.sqlite", study(grid=SMALL)).close()
    with pytest.raises(InputError, match="nobody has answered yet"):
        read_pool([tmp_path / "a.sqlite"], tmp_path)


class TestAnalysis:
    """Cases that have little or nothing to tell: finite, and said."""

    def analysed(self, folder, made, **options):
        return analyse(read_pool([folder / "a.sqlite"], folder), Options(20, **options))

    def test_one_observer(self, tmp_path):
        simulated(tmp_path / "a.sqlite", study(), 1, 0)
        (result,) = self.analysed(tmp_path, study()).samples
        assert result.verdict.status == "few"
        assert result.verdict.wins is None
        assert result.verdict.optimum.c_interval is None
        assert np.all(np.isfinite(result.scales[0].scale))

    def test_one_answer(self, tmp_path):
        with Store(tmp_path / "a.sqlite", study()) as store:
            answer(started(store))
        analysis = self.analysed(tmp_path, study())
        assert analysis.samples == ()
        assert "all answers are 'close'" in analysis.unscaled["matte-coated"]

    def test_always_the_same_answer(self, tmp_path):
        made = study(("matte-coated", "uncoated"), grid=SMALL)
        with Store(tmp_path / "a.sqlite", made) as store:
            for _ in range(2):
                flow = started(store)
                answer_all(flow, (4,))
                flow.end()
        analysis = self.analysed(tmp_path, made)
        assert set(analysis.unscaled) == {"matte-coated", "uncoated"}
        assert all("always the same answer" in o.remarks[0] for o in analysis.observers)

    def test_an_interrupted_session_counts_as_far_as_it_goes(self, tmp_path):
        made = study(("matte-coated", "uncoated"))
        simulated(tmp_path / "a.sqlite", made, 4, 0)
        with Store(tmp_path / "a.sqlite", made) as store:
            flow = started(store, name="late")
            for category in (0, 4, 2):
                answer(flow, category)
        analysis = self.analysed(tmp_path, made)
        assert sum(r.answers for r in analysis.samples) == 4 * 84 + 3
        assert "not finished" in analysis.observers[-1].remarks

    @pytest.mark.parametrize(
        "grid", [SMALL, Grid((1.0,), (0.2, 0.5, 1.0)), Grid((0.0, 1.0), (1.0,))]
    )
    def test_small_grids(self, tmp_path, grid):
        simulated(tmp_path / "a.sqlite", study(grid=grid), 5, 0, Setting(1.0, 1.0))
        (result,) = self.analysed(tmp_path, study()).samples
        assert result.verdict.status in ("best", "broad", "chance")
        assert np.all(np.isfinite(result.verdict.smooth))

    def test_observer_effects(self, tmp_path):
        """Observers who call everything farther than others: their effects tell by how much."""
        made = study()
        with Store(tmp_path / "a.sqlite", made) as store:
            run_observers(
                store, percepts(made, [Setting(1.0, 0.7)]), Population(bound_shift=2.0), 8, 0
            )
        result = self.analysed(tmp_path, made, observer_effects=True).samples[0]
        effects = result.scales[0].probit.observers
        pool = read_pool([tmp_path / "a.sqlite"], tmp_path)
        means = np.nanmean(pool.answers(0, "ratio").ratings(), axis=1)
        assert np.corrcoef(effects, means)[0, 1] > 0.95

    def test_proportions_of_zero_and_one_may_be_left_out(self, tmp_path):
        """Clipped, every setting that all call far has one place; dropped, it has none."""
        simulated(tmp_path / "a.sqlite", study(), 15, 0, Setting(0.0, 1 / 6))
        clipped, dropped = (
            self.analysed(tmp_path, study(), zero=zero).samples[0].scales[0].torgerson.scale
            for zero in ("clip", "drop")
        )
        assert np.all(np.isfinite(clipped))
        assert 0 < np.sum(np.isnan(dropped)) < 42

    @pytest.mark.slow
    def test_intervals_are_over_observers_not_answers(self, tmp_path):
        """The same observers with twenty times the answers know themselves better, not people.

        Drawing answers again would make the interval of what they do not agree about narrower by
        the root of twenty.
        """
        widths = []
        for repeats in (1, 20):
            folder = tmp_path / str(repeats)
            folder.mkdir()
            made = study(grid=SMALL, repeats=repeats)
            with Store(folder / "a.sqlite", made) as store:
                for number in range(8):
                    flow = started(store)
                    while flow.phase is not Phase.FINISHED:
                        apart = (1, 3)[number % 2] if flow.trial.setting == 1 else 2
                        answer(flow, (0, apart, 4, apart)[flow.trial.setting])
                    flow.end()
            (result,) = self.analysed(folder, made, seed=3).samples
            low, high = result.scales[0].interval
            widths.append((high - low)[1])
        assert widths[1] > 0.5 * widths[0]
        assert widths[0] > 0.3

    def test_intervals_are_of_95_percent(self, tmp_path):
        simulated(tmp_path / "a.sqlite", study(), 8, 0)
        pool = read_pool([tmp_path / "a.sqlite"], tmp_path)
        scale = analyse(pool, Options(200)).samples[0].scales[0]
        inside = (scale.draws >= scale.interval[0]) & (scale.draws <= scale.interval[1])
        # 2.5 % of 200 draws are 5 on either side; equal draws at an end count as inside.
        assert np.all(inside.mean(axis=0) >= 0.949)
        low, high = scale.bounds_interval
        assert np.all(low < scale.probit.bounds)
        assert np.all(scale.probit.bounds < high)
        varied = np.ptp(scale.draws, axis=0) > 1.0
        assert np.median(inside.mean(axis=0)[varied]) <= 0.96

    def test_each_question_has_a_chance_of_its_own(self, tmp_path):
        """Gloss by chance, grain by heart: the grain is told, the joint verdict is not."""
        made = study(ask_grain=True)
        random = np.random.default_rng(0)
        with Store(tmp_path / "a.sqlite", made) as store:
            for _ in range(6):
                flow = started(store)
                while flow.phase is not Phase.FINISHED:
                    row = flow.trial.setting // 6
                    grain = flow.question == "grain"
                    answer(flow, min(row, 4) if grain else int(random.integers(5)))
                flow.end()
        (result,) = self.analysed(tmp_path, made).samples
        first, second = (scale.scale for scale in result.scales)
        assert result.verdicts["both"].leading == np.argmax(first + second)
        assert np.argmax(first) != result.verdicts["both"].leading
        np.testing.assert_allclose(
            result.verdicts["both"].smooth,
            result.verdicts["ratio"].smooth + result.verdicts["grain"].smooth,
        )
        assert result.p["grain"] == pytest.approx(0.001)
        assert result.p["ratio"] > 0.05
        assert result.verdicts["grain"].status != "chance"
        assert result.verdicts["both"].status == "chance"

    def test_same_seed_same_analysis(self, tmp_path):
        simulated(tmp_path / "a.sqlite", study(), 5, 0)
        one, same = (self.analysed(tmp_path, study()).samples[0] for _ in range(2))
        np.testing.assert_array_equal(one.scales[0].draws, same.scales[0].draws)
        other = self.analysed(tmp_path, study(), seed=1).samples[0]
        assert np.any(other.scales[0].draws != one.scales[0].draws)

    def test_who_answers_at_random_is_pointed_out_and_kept(self, tmp_path):
        made = study(("matte-coated", "uncoated"))
        simulated(tmp_path / "a.sqlite", made, 6, 0)
        with Store(tmp_path / "a.sqlite", made) as store:
            flow = started(store, name="dice")
            random = np.random.default_rng(5)
            answer_all(flow, tuple(int(k) for k in random.integers(0, 5, 84)))
            flow.end()
        analysis = self.analysed(tmp_path, made)
        told = {o.name: " ".join(o.remarks) for o in analysis.observers}
        assert "may be by chance" in told.pop("dice")
        assert not any("chance" in text for text in told.values())
        assert all(r.observers == 7 for r in analysis.samples)
