"""What simulated observers see, and that they answer as their model says."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from cases import Clock, answer, index_of, percepts, standing, started, study
from scipy.special import ndtr

from relgloss_view.base.errors import InputError
from relgloss_view.experiment.design.grid import Grid
from relgloss_view.experiment.design.stimuli import digest_of, draw_reference, draw_stimulus
from relgloss_view.experiment.observers.kinds import Mismatch
from relgloss_view.experiment.observers.percept import percept_of, see_study
from relgloss_view.experiment.observers.population import (
    Population,
    SimulatedObserver,
    usual_bounds,
)
from relgloss_view.experiment.observers.simulation import StoredAnswer, run_observers
from relgloss_view.experiment.observers.truth import ANYWHERE, CELLS, PUBLISHED, truths_of
from relgloss_view.experiment.session.store import Store
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.sample import SAMPLES
from relgloss_view.picture.scene.setting import Setting

SMALL = Grid((0.0, 2.0), (0.5, 1.0))
THREE = ("art-coated", "matte-coated", "uncoated")


class TestPercepts:
    @pytest.fixture
    def seen(self, renderer):
        made = study(THREE)
        return made, see_study(renderer, made, truths_of(made, PUBLISHED, {}, 0), (-1.0,))

    def test_gloss_follows_c_and_grain_follows_sigma_n(self, seen):
        made, found = seen
        gloss, grain = (found.stimuli[..., k].reshape(3, 7, 6) for k in (0, 1))
        assert np.all(np.diff(gloss, axis=2) > 0.0)
        assert np.all(np.diff(grain, axis=1) > 0.0)
        # The highlight's L* is scaled by c: between neighbours gloss changes by about log(c'/c),
        # but for the rest of the object, which the highlight of a matt sample lightens too.
        steps = np.diff(np.log(made.grid.c_fraction))
        np.testing.assert_allclose(np.diff(gloss[:, 0], axis=1), np.tile(steps, (3, 1)), atol=0.2)

    def test_smooth_pictures_have_no_grain(self, seen):
        _, found = seen
        smooth = found.stimuli[..., 1].reshape(3, 7, 6)[:, 0]
        assert np.all(smooth < 0.01)

    def test_the_truth_is_seen_as_the_stimulus_that_it_is(self, seen):
        made, found = seen
        for k, truth in enumerate(found.truths):
            np.testing.assert_array_equal(
                found.targets[k], found.stimuli[k, index_of(made.grid, truth)]
            )

    def test_no_highlight_is_finite(self, renderer):
        frame = renderer.render(study().scene(0), Look(c=0.0), (64, 64))
        assert np.isfinite(percept_of(frame).log_gloss(-4.0))


class TestStimuli:
    def test_are_those_of_grid(self, renderer, tmp_path):
        """`relgloss grid` and a study draw the same pictures, bit by bit."""
        from PIL import Image

        from relgloss_view import cli

        words = ["grid", "--sample", "uncoated", "--size", "96x96", "-o", str(tmp_path / "g")]
        assert cli.main(words) == 0
        made = study(("uncoated",))
        for setting in (0, 17, 41):
            at = made.grid.settings[setting]
            name = f"sigma_{at.sigma_n_deg:.1f}_c_{round(6 * at.c_fraction)}of6.png"
            with Image.open(tmp_path / "g" / name) as picture:
                drawn = draw_stimulus(renderer, made, 0, setting)
                np.testing.assert_array_equal(np.asarray(picture), drawn.display)
        other = draw_stimulus(renderer, made, 0, 18)  # the control
        assert np.any(np.asarray(other.display) != np.asarray(drawn.display))

    def test_digests_tell_pictures_apart(self, renderer):
        made = study(("uncoated",))
        digests = {digest_of(draw_stimulus(renderer, made, 0, k)) for k in (0, 1, 6)}
        digests.add(digest_of(draw_reference(renderer, made)))
        assert len(digests) == 4
        assert digest_of(draw_stimulus(renderer, made, 0, 0)) in digests


class TestTruths:
    def test_published(self):
        """Ishii et al., "Results"."""
        assert truths_of(study(THREE), PUBLISHED, {}, 0) == (
            Setting(0.0, 5 / 6),
            Setting(2.0, 2 / 6),
            Setting(2.0, 1 / 6),
        )
        assert SAMPLES["cast-coated"].c_fraction == 1.0

    def test_by_chance(self):
        made = study(THREE)
        drawn = [truths_of(made, CELLS, {}, seed) for seed in range(60)]
        indices = {index_of(made.grid, t) for three in drawn for t in three}
        assert None not in indices
        assert len(indices) > 35  # 180 draws of 42: all but one are missed with p < 1e-4
        free = [t for seed in range(20) for t in truths_of(made, ANYWHERE, {}, seed)]
        assert all(0 <= t.sigma_n_deg <= 3 and 1 / 6 - 1e-9 <= t.c_fraction <= 1 for t in free)
        assert all(index_of(made.grid, t) is None for t in free)

    def test_given(self):
        assert truths_of(study(), CELLS, {"matte-coated": Setting(1.1, 0.4)}, 0) == (
            Setting(1.1, 0.4),
        )

    @pytest.mark.parametrize(
        ("given", "words"),
        [
            ({"glossy": Setting(1, 1)}, "no such sample; expected matte-coated"),
            ({"matte-coated": Setting(3.5, 1)}, "outside the study's grid"),
            ({"matte-coated": Setting(1, 0.1)}, "outside the study's grid"),
        ],
    )
    def test_that_no_analysis_could_find(self, given, words):
        with pytest.raises(InputError, match=words):
            truths_of(study(), PUBLISHED, given, 0)


class TestModel:
    """The observers of the analysis's own model; the other kinds are in test_kinds.py."""

    def shares(self, population, mismatch, count=4000):
        observer = SimulatedObserver(population, 1, 0, tuple(usual_bounds(5)), (0.0, 0.0))
        answers = [observer.judge(k, 0, "ratio", mismatch) for k in range(count)]
        return np.bincount(answers, minlength=5) / count

    @pytest.mark.parametrize("gloss", [0.0, 1.0, 3.0])
    @pytest.mark.parametrize("lapse", [0.0, 0.3])
    def test_categories_are_cut_from_a_normal_distribution(self, gloss, lapse):
        """Against the closed form, within 4 standard errors of a share."""
        edges = ndtr(np.array([-np.inf, *usual_bounds(5), np.inf]) - np.hypot(gloss, 1.0))
        expected = (1.0 - lapse) * np.diff(edges) + lapse / 5
        found = self.shares(Population(lapse=lapse), Mismatch(gloss, 1.0))
        assert np.all(np.abs(found - expected) <= 4.0 * np.sqrt(expected / 4000) + 1e-3)

    def test_kinds(self):
        kinds = ("unique", "ratio", "random")
        unique, ratio, random = (self.shares(Population(kind=k), Mismatch(0.0, 5.0)) for k in kinds)
        assert unique[4] > 0.4  # far, for its grain
        assert ratio[0] > 0.7  # close: only gloss counts
        assert np.all(np.abs(random - 0.2) < 4.0 * np.sqrt(0.2 * 0.8 / 4000))

    def test_the_second_question_is_of_grain_alone(self):
        observer = SimulatedObserver.of(Population(bias=0.0), 0, 0, 5)
        target, at = np.array([1.0, 0.05]), Setting(1.0, 0.5)
        mismatch = observer.mismatch(target + np.array([1.0, 0.0]), target, at, (at,))
        assert observer.distance("grain", mismatch) == pytest.approx(0.0)
        assert observer.distance("ratio", mismatch) == pytest.approx(1.0 / 0.15)

    def test_observers_differ_and_repeat(self):
        one, same, other = (SimulatedObserver.of(Population(), 0, n, 5) for n in (0, 0, 1))
        assert one == same
        assert one.bounds != other.bounds
        assert one.bias != other.bias

    @pytest.mark.parametrize("categories", [2, 3, 9])
    def test_bounds_of_any_number_of_categories(self, categories):
        bounds = usual_bounds(categories)
        assert bounds.shape == (categories - 1,)
        assert np.all(np.diff(bounds) > 0.0)


class TestRun:
    def test_answers_go_through_the_store_and_repeat(self, tmp_path):
        made = study(grid=SMALL, ask_grain=True)
        seen = percepts(made, [Setting(1.0, 0.7)])
        files = []
        for name in ("a", "b"):
            given: list[StoredAnswer] = []
            with Store(tmp_path / f"{name}.sqlite", made) as store:
                run_observers(store, seen, Population(), 3, 7, given.append)
                assert len(given) == 3 * 4 * 2
                assert [o.kind for o in store.observers()] == ["simulated"] * 3
                assert all(o.ended and o.consented for o in store.observers())
                files.append(standing(store))
        assert files[0] == files[1]

    def test_more_observers_are_added(self, tmp_path):
        made = study(grid=SMALL)
        seen = percepts(made, [Setting(1.0, 0.7)])
        with Store(tmp_path / "a.sqlite", made) as store:
            run_observers(store, seen, Population(), 2, 7)
            first = standing(store)
            run_observers(store, seen, Population(), 4, 7)
            assert standing(store)[: len(first)] == first
            assert len(store.observers()) == 4

    def test_not_on_with_others_half_way(self, tmp_path):
        made = study(grid=SMALL)
        seen = percepts(made, [Setting(1.0, 0.7)])

        def stop(answer):
            raise KeyboardInterrupt

        with Store(tmp_path / "a.sqlite", made) as store:
            with pytest.raises(KeyboardInterrupt):
                run_observers(store, seen, Population(), 2, 7, stop)
            for population, seed in ((Population(), 8), (Population(kind="ratio"), 7)):
                with pytest.raises(InputError, match="O01 began with other truths"):
                    run_observers(store, seen, population, 2, seed)
            run_observers(store, seen, Population(), 2, 7)
            assert len(store.answers()) == 8

    def test_an_older_file_goes_on(self, tmp_path):
        """Its observers do not state what all had before there were kinds."""
        made = study(grid=SMALL)
        seen = dataclasses.replace(percepts(made, [Setting(1.0, 0.7)]), grain_weights=(-1.0,))
        details = {
            **SimulatedObserver.of(Population(), 7, 0, 5).details(),
            "truths": {"matte-coated": [1.0, 0.7]},
        }
        for name in ("group", "to_middle", "sigma_n_jnd", "c_jnd"):
            del details[name]
        with Store(tmp_path / "a.sqlite", made) as store:
            store.observer(kind="simulated", details=details)
            other = dataclasses.replace(seen, grain_weights=(-4.0,))
            with pytest.raises(InputError, match="O01 began with other truths"):
                run_observers(store, other, Population(), 1, 7)
            run_observers(store, seen, Population(), 1, 7)
            assert len(store.answers()) == 4

    def test_not_into_the_answers_of_people(self, tmp_path):
        made = study(grid=SMALL)
        with Store(tmp_path / "a.sqlite", made) as store:
            answer(started(store, Clock()))
            with pytest.raises(InputError, match="holds answers of people"):
                run_observers(store, percepts(made, [Setting(1.0, 0.7)]), Population(), 1, 0)
            assert len(store.answers()) == 1
