"""Who is timed when, and what is drawn again; no test looks at how long anything takes."""

from __future__ import annotations

import dataclasses
from functools import partial

import pytest

from relgloss_view.base.errors import RelglossError
from relgloss_view.bench.speed import scenes, tasks
from relgloss_view.bench.speed.floor import FillFloor
from relgloss_view.bench.speed.passes import believed, time_passes
from relgloss_view.bench.speed.pixels import fit_line, size_of, time_pixels
from relgloss_view.bench.speed.timing import Times, take_turns
from relgloss_view.picture.method import EXACT, Method

SIZE = (160, 90)
SMOOTH = Method(noise="none")
SCENES = {chart_scene.name: chart_scene for chart_scene in scenes.chart_scenes(SIZE)}


class Noted:
    """Notes when it is called; says its own time."""

    def __init__(self, name, calls, fails_at=None):
        self.name, self.calls, self.fails_at, self.frames = name, calls, fails_at, 0

    def warm(self):
        self.calls.append(f"{self.name} warm")

    def frame(self, turn):
        self.calls.append(f"{self.name} {turn}")
        self.frames += 1
        if self.fails_at == self.frames:
            raise RelglossError("too dim")
        return float(self.frames)


def test_tasks_take_turns_and_every_other_round_goes_backwards():
    calls = []
    times = take_turns([Noted("a", calls), Noted("b", calls)], frames=3, per_visit=2)
    first = ["a warm", "a 0", "a 1", "b warm", "b 0", "b 1"]
    assert calls == [*first, *first[3:], *first[:3]]
    assert times["a"].ms == [1.0, 2.0, 3.0, 4.0]
    assert times["a"].median == 2.5


def test_a_task_that_fails_says_why_and_the_others_go_on():
    calls = []
    times = take_turns([Noted("a", calls, fails_at=3), Noted("b", calls)], frames=6, per_visit=2)
    assert times["a"].fault == "too dim"
    assert times["a"].median is None
    assert times["a"].as_dict() == {
        "ms": None,
        "quartiles_ms": None,
        "frames": 0,
        "fault": "too dim",
    }
    assert len(times["b"].ms) == 6
    assert calls.count("a warm") == 2


def test_a_task_without_a_clock_of_its_own_is_timed():
    class Plain:
        name = "plain"

        def warm(self):
            pass

        def frame(self, turn):
            return None

    found = take_turns([Plain()], frames=4)["plain"]
    assert len(found.ms) == 4
    assert all(ms > 0.0 for ms in found.ms)
    assert Times().quartiles is None


@pytest.mark.parametrize(
    ("pictures", "method", "drawn"),
    [
        (tasks.c_changed, EXACT, {"tone"}),
        (tasks.sigma_n_changed, EXACT, {"shade", "split", "tone"}),
        (partial(tasks.pass_1_changed, method=EXACT), EXACT, {"shade", "split", "tone"}),
        (partial(tasks.pass_1_changed, method=SMOOTH), SMOOTH, {"shade", "split", "tone"}),
        (tasks.lamp_moved, EXACT, {"white", "shade", "split", "tone"}),
    ],
    ids=["c", "sigma_n", "pass-1", "pass-1-without-grain", "lamp"],
)
def test_what_changes_alone_draws_just_its_passes(renderer, pictures, method, drawn):
    chart_scene = SCENES["matte-coated az50"]
    look = dataclasses.replace(chart_scene.look, c=0.5)
    some = pictures(chart_scene.scene, look, count=3)
    task = tasks.Drawing("x", renderer, SIZE, some, method)
    task.warm()
    for turn in range(2):
        before = dict(renderer.draws)
        task.frame(turn)
        again = {name for name, count in renderer.draws.items() if count > before[name]}
        assert again == drawn


def test_frames_that_are_timed_show_the_same_picture(renderer):
    chart_scene = SCENES["matte-coated az50"]
    for pictures in (
        tasks.sigma_n_changed(chart_scene.scene, chart_scene.look, 3),
        tasks.pass_1_changed(chart_scene.scene, chart_scene.look, SMOOTH, 3),
        tasks.lamp_moved(chart_scene.scene, chart_scene.look, 3),
    ):
        shown = [renderer.render(scene, look, SIZE).display.copy() for scene, look in pictures]
        assert (shown[0] == shown[1]).all()
        assert (shown[0] == shown[2]).all()


def test_the_floor_writes_and_reads_every_pixel(ctx):
    for _ in range(2):  # again after the first is freed
        floor = FillFloor(ctx, (48, 32))
        floor.draw()
        shown = floor.display.read()
        floor.release()
        # 0.25 + 0.5 of 255.
        assert set(shown) == {191}
        assert len(shown) == 48 * 32 * 4


def test_passes_of_a_frame_are_all_told(ctx):
    chart_scene = SCENES["matte-coated az50"]
    found = time_passes(ctx, SIZE, tasks.lamp_moved(chart_scene.scene, chart_scene.look, 3), 2)
    assert set(found["wall_ms"]) == {"white", "shade", "split", "measure", "tone", "rest"}
    assert all(ms > 0.0 for ms in found["wall_ms"].values())


def test_a_device_clock_is_believed_only_where_it_agrees_with_the_wall():
    wall = {"shade": 8.0, "tone": 2.0, "rest": 50.0}
    assert believed(wall, {"shade": 7.0, "tone": 2.0})["device_ms"] == {"shade": 7.0, "tone": 2.0}
    for nonsense in (0.001, 1e6):
        found = believed(wall, {"shade": nonsense, "tone": nonsense})
        assert found["device_ms"] is None
        assert "not believed" in found["device_clock"]


def test_lines_through_times():
    line = fit_line([1.0, 2.0, 4.0, 8.0], [12.0, 22.0, 42.0, 82.0])
    assert line.start_ms == pytest.approx(2.0)
    assert line.slope_ms == pytest.approx(10.0)
    assert line.straight
    # Negative control: a square is no line, and one slow size shows.
    assert not fit_line([1.0, 2.0, 4.0, 8.0], [1.0, 4.0, 16.0, 64.0]).straight
    bent = fit_line([1.0, 2.0, 4.0, 8.0, 16.0], [10.0, 20.0, 60.0, 80.0, 160.0])
    assert not bent.straight
    assert max(bent.residuals) == bent.residuals[2]
    # Nothing costs less than nothing at no pixels.
    assert fit_line([1.0, 2.0, 4.0], [5.0, 14.0, 30.0]).start_ms == 0.0


def test_sizes_hold_about_so_many_pixels():
    for megapixels in (0.25, 1.0, 4.0, 9.0, 16.0, 33.0):
        width, height = size_of(megapixels)
        assert width * height == pytest.approx(1e6 * megapixels, rel=0.03)
        assert width % 8 == height % 8 == 0


def test_sizes_that_the_device_cannot_hold_are_skipped(ctx, monkeypatch):
    from relgloss_view.bench.speed import pixels

    chart_scene = SCENES["matte-coated az50"]
    monkeypatch.setattr(pixels, "available_bytes", lambda: 2_000_000)
    found = time_pixels(ctx, chart_scene, (0.005, 0.01, 0.015, 1.0), 2, lambda share, text: None)
    assert "memory" in found["sizes"][-1]["fault"]
    assert [row["ms"] is None for row in found["sizes"]] == [False, False, False, True]
    assert "residual" not in found["sizes"][-1]
    assert set(found["line"]) == {"start_ms", "slope_ms", "straight"}
