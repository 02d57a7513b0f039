"""`relgloss bench` on small pictures: what it writes, says and leaves behind."""

from __future__ import annotations

import csv
import dataclasses
import json

import pytest

from relgloss_view import cli
from relgloss_view.bench.speed import measure, methods, report, run
from relgloss_view.bench.speed.chart import CHARTS
from relgloss_view.picture.method import Method

FILES = {*CHARTS, report.TABLE, report.RESULTS}


@pytest.fixture(autouse=True)
def _small(monkeypatch):
    """The quick run, quicker."""
    small = dataclasses.replace(
        measure.QUICK,
        frames=2,
        error_width_px=96,
        grains=4,
        megapixels=(0.01, 0.02, 0.04),
        pixel_frames=2,
        variants=(),
    )
    monkeypatch.setattr(measure, "QUICK", small)
    monkeypatch.setattr("relgloss_view.bench.peers.peers.STIMULI_SIZE", (48, 48))
    monkeypatch.setattr("relgloss_view.commands.bench.GRID_SIZE", (32, 32))


def bench(folder, *words):
    return cli.main(["bench", "--quick", "--size", "160x90", "-o", str(folder), *words])


def test_chart_table_and_numbers(tmp_path, capsys):
    folder = tmp_path / "new" / "chart"
    assert bench(folder) == 0
    assert {p.name for p in folder.iterdir()} == FILES
    assert list(tmp_path.iterdir()) == [tmp_path / "new"]
    said = capsys.readouterr().out
    ways = methods.ways(quick=True)
    for way in ways:
        assert way.label in said
    assert "fill floor" in said
    assert "quality auto:" in said
    assert "against the mean of many grains: mean of the grain p95" in said

    found = json.loads((folder / report.RESULTS).read_text())
    assert (found["format"], found["version"], found["quick"]) == ("relgloss-bench", 1, True)
    assert found["machine"]["opengl"]["renderer"]
    assert found["machine"]["libraries"]["numpy"]
    assert found["settings"]["size"] == [160, 90]
    assert len(found["scenes"]) == 2
    assert all(scene["coverage"] >= 0.60 for scene in found["scenes"])
    assert len(found["results"]) == 2 * len(ways)
    by_name = {entry["method"]: entry for entry in found["methods"]}
    assert by_name["default"]["worst_p95"] < 0.02 < by_name["constant-f"]["worst_p95"]
    assert any(entry["front"] for entry in found["methods"])
    assert set(found["changes"]) == {"scene", "floor", "c", "sigma_n", "lamp"}
    assert found["changes"]["floor"]["floors"] == 1.0
    assert found["grid"]["stimuli"] == 42
    assert [row["frames"] for row in found["pixels"]["sizes"]] == [4, 4, 4]
    mean = next(r for r in found["results"] if r["method"] == "grain-mean")
    assert mean["error_against_mean"]["highlight"]["p95"] < mean["error"]["highlight"]["p95"]

    with (folder / report.TABLE).open(newline="") as file:
        table = list(csv.DictReader(file))
    assert len(table) == len(found["results"])
    for line, result in zip(table, found["results"], strict=True):
        assert line["method"] == result["method"]
        assert float(line["object_p95"]) == result["error"]["object"]["p95"]
        assert float(line["ms"]) == result["ms"]


@pytest.mark.slow
def test_again_into_the_same_folder_and_not_into_anothers(tmp_path, capsys):
    """And with --json the numbers alone are on standard output."""
    folder = tmp_path / "a"
    assert bench(folder, "--json") == 0
    (folder / "note.txt").write_text("mine")
    first = (folder / report.RESULTS).read_text()
    assert json.loads(capsys.readouterr().out) == json.loads(first)
    assert bench(folder) == 0
    assert (folder / report.RESULTS).read_text() != first
    assert {p.name for p in folder.iterdir()} == {*FILES, "note.txt"}
    capsys.readouterr()

    (folder / report.RESULTS).write_text('{"format": "else"}')
    assert bench(folder) == 1
    told = capsys.readouterr().err
    assert "was not written by `relgloss bench`" in told
    assert told.count("\n") == 1
    (tmp_path / "file").touch()
    assert bench(tmp_path / "file") == 1
    assert "is a file" in capsys.readouterr().err


@pytest.mark.parametrize(("size", "told"), [("900x90", "times the height"), ("0x5", "size 0x5")])
def test_sizes_that_no_object_fills_are_refused(tmp_path, capsys, size, told):
    words = ["bench", "--quick", "--size", size, "-o", str(tmp_path / "a")]
    assert cli.main(words) == 1
    assert told in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


@pytest.mark.slow
@pytest.mark.parametrize(
    "stage", ["speed.run.time_changes", "speed.chart.write_chart", "peers.peers.time_scientist"]
)
def test_an_interruption_leaves_nothing(tmp_path, monkeypatch, capsys, stage):
    def interrupt(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr(f"relgloss_view.bench.{stage}", interrupt)
    assert bench(tmp_path / "a") == 130
    assert not list(tmp_path.iterdir())
    assert "interrupted" in capsys.readouterr().err


def test_a_method_that_a_scene_refuses_is_told_and_the_rest_goes_on(tmp_path, monkeypatch, capsys):
    from relgloss_view.base.errors import InputError

    real = run.Drawers.of

    def refuse(self, method: Method):
        if method.fresnel == "schlick":

            class Refuses:
                ctx = self.ctx

                def render(self, *_):
                    raise InputError("too bright")

            return Refuses()
        return real(self, method)

    monkeypatch.setattr(run.Drawers, "of", refuse)
    assert bench(tmp_path / "a") == 0
    found = json.loads((tmp_path / "a" / report.RESULTS).read_text())
    refused = [r for r in found["results"] if r.get("fault")]
    assert {(r["method"], r["fault"]) for r in refused} == {("schlick", "too bright")}
    assert "Schlick" not in capsys.readouterr().out
    with (tmp_path / "a" / report.TABLE).open(newline="") as file:
        faults = {line["method"]: line["fault"] for line in csv.DictReader(file)}
    assert faults["schlick"] == "too bright"
    assert faults["default"] == ""


def test_somebody_elses_files_are_left_alone(tmp_path, capsys):
    folder = tmp_path / "charts"
    folder.mkdir()
    (folder / "chart.png").write_text("mine")
    for words in (["--quick"], ["--stability", "--quick"]):
        assert cli.main(["bench", *words, "-o", str(folder)]) == 1
        assert "move this one away" in capsys.readouterr().err
    assert (folder / "chart.png").read_text() == "mine"
