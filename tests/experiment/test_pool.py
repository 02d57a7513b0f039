"""Answers of several session files together, and what may not be pooled."""

from __future__ import annotations

import numpy as np
import pytest
from cases import answer, answer_all, percepts, replaced, started, study

from relgloss_view.errors import InputError
from relgloss_view.experiment.analysis import Options, analyse
from relgloss_view.experiment.grid import Grid, Setting
from relgloss_view.experiment.observers import Population
from relgloss_view.experiment.pool import read_pool
from relgloss_view.experiment.simulation import run_observers
from relgloss_view.experiment.store import Store

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
    ],
)
def test_other_questions_are_not_pooled(tmp_path, changes, words):
    made = study(grid=SMALL)
    for name, each in (("a", made), ("b", replaced(made, **changes))):
        with Store(tmp_path / f"{name}.sqlite", each) as store:
            answer(started(store))
    with pytest.raises(InputError, match=rf"b\.sqlite: its study has {words}"):
        read_pool([tmp_path / "a.sqlite", tmp_path / "b.sqlite"], tmp_path)


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
        assert "all answers are 'close'" in analysis.untold["matte-coated"]

    def test_always_the_same_answer(self, tmp_path):
        made = study(("matte-coated", "uncoated"), grid=SMALL)
        with Store(tmp_path / "a.sqlite", made) as store:
            for _ in range(2):
                flow = started(store)
                answer_all(flow, (4,))
                flow.end()
        analysis = self.analysed(tmp_path, made)
        assert set(analysis.untold) == {"matte-coated", "uncoated"}
        assert all("always the same answer" in o.told[0] for o in analysis.observers)

    def test_an_interrupted_session_counts_as_far_as_it_goes(self, tmp_path):
        made = study(("matte-coated", "uncoated"))
        simulated(tmp_path / "a.sqlite", made, 4, 0)
        with Store(tmp_path / "a.sqlite", made) as store:
            flow = started(store, name="late")
            for category in (0, 4, 2):
                answer(flow, category)
        analysis = self.analysed(tmp_path, made)
        assert sum(r.answers for r in analysis.samples) == 4 * 84 + 3
        assert "not through" in analysis.observers[-1].told

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
        told = {o.name: " ".join(o.told) for o in analysis.observers}
        assert "can't be told from chance" in told.pop("dice")
        assert not any("chance" in text for text in told.values())
        assert all(r.observers == 7 for r in analysis.samples)
