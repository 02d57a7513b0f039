"""Whatever becomes of a plot, a page or a sheet: the result is there, and one warning."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest
from test_cli import run

from relgloss_view import cli
from relgloss_view.bench.speed import report as bench_report
from relgloss_view.bench.stability import figures as stability_figures
from relgloss_view.commands import grid
from relgloss_view.material.files import load_material

FAULT = "no plot today"
SMALL = ("--size", "64x64")


def fails(*_, **__):
    raise RuntimeError(FAULT)


def one_warning(err, what, kept):
    """The only line on standard error: what failed, why, and what is there nevertheless."""
    assert err.count("\n") == 1, err
    assert err.startswith(f"warning: {what}")
    assert f"RuntimeError: {FAULT}" in err
    assert kept in err


@pytest.mark.usefixtures("forgiving")
class TestFit:
    WORDS = ("fit", "art-coated", "--model", "lobe")

    def test_the_material_stays(self, tmp_path, monkeypatch, capsys):
        monkeypatch.setattr("relgloss_view.fitting.write_fit_report", fails)
        out, report = tmp_path / "m.json", tmp_path / "m.png"
        status, printed, err = run(capsys, *self.WORDS, "-o", out, "--report", report)
        assert status == 0
        one_warning(err, str(report), f"{out} is written")
        assert "quality" in printed
        assert load_material(out).fit is not None
        assert [p.name for p in tmp_path.iterdir()] == ["m.json"]

    def test_a_report_of_before_stays_whole(self, tmp_path, monkeypatch, capsys):
        """The fault comes while the page is being written."""
        monkeypatch.setattr("relgloss_view.fitting.report.save_figure", fails)
        report = tmp_path / "m.png"
        report.write_text("before")
        words = (*self.WORDS, "-o", tmp_path / "m.json", "--report", report)
        assert run(capsys, *words)[0] == 0
        assert report.read_text() == "before"
        assert sorted(p.name for p in tmp_path.iterdir()) == ["m.json", "m.png"]

    def test_without_matplotlib(self, tmp_path):
        code = (
            "import sys; sys.modules['matplotlib'] = None\n"
            "from relgloss_view.cli import main; sys.exit(main(sys.argv[1:]))"
        )
        words = [*self.WORDS, "-o", "m.json", "--report", "m.png", "--json"]
        done = subprocess.run(
            [sys.executable, "-c", code, *words],
            capture_output=True,
            text=True,
            cwd=tmp_path,
            env={"PYTHONPATH": ":".join(sys.path), "PATH": "/usr/bin:/bin"},
        )
        assert done.returncode == 0, done.stderr
        assert done.stderr.count("\n") == 1
        assert "`relgloss doctor`" in done.stderr
        assert json.loads(done.stdout)["output"] == "m.json"
        assert [p.name for p in tmp_path.iterdir()] == ["m.json"]

    def test_a_place_that_takes_nothing_is_refused_before_the_fit(self, tmp_path, capsys):
        words = (*self.WORDS, "-o", tmp_path / "m.json", "--report", tmp_path / "no" / "m.png")
        status, printed, err = run(capsys, *words)
        assert status == 1
        assert err.startswith("relgloss: ")
        assert printed == ""
        assert list(tmp_path.iterdir()) == []


@pytest.mark.usefixtures("forgiving")
class TestOutputsThatAreDecorations:
    """-o names the file itself: the result is printed, and the status says that the file is not."""

    def test_match(self, tmp_path, monkeypatch, capsys):
        monkeypatch.setattr("relgloss_view.gloss.match_plot.save_figure", fails)
        plot, scene = tmp_path / "a.png", tmp_path / "a.toml"
        words = ("match", "matte-coated", "--here", *SMALL, "-o", plot, "--write", scene, "--json")
        status, printed, err = run(capsys, *words)
        assert status == 1
        one_warning(err, str(plot), "the curves are printed")
        assert json.loads(printed)["outputs"] == [str(scene)]
        assert [p.name for p in tmp_path.iterdir()] == ["a.toml"]

    def test_compare_writes_all_or_none(self, tmp_path, monkeypatch, capsys):
        monkeypatch.setattr("relgloss_view.gloss.comparison_sheet.comparison_sheet", fails)
        sheet, page = tmp_path / "a.png", tmp_path / "a.html"
        words = ("compare", "uncoated", "--operators", "clip", *SMALL, "-o", sheet, "-o", page)
        status, printed, err = run(capsys, *words)
        assert status == 1
        one_warning(err, "the comparison", "its numbers are printed")
        assert "peak" in printed
        assert "written" not in printed
        assert list(tmp_path.iterdir()) == []


@pytest.mark.usefixtures("forgiving")
def test_grid_without_its_sheet(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr("relgloss_view.picture.output.contact_sheet.contact_sheet", fails)
    words = ("grid", "--size", "16x16", "--operator", "clip", "-o", tmp_path / "out")
    status, printed, err = run(capsys, *words)
    assert status == 0
    one_warning(err, grid.SHEET, "all pictures")
    assert grid.SHEET not in printed
    names = {p.name for p in (tmp_path / "out").iterdir()}
    assert grid.MANIFEST in names
    assert len(names) == 7 + 1


@pytest.mark.usefixtures("forgiving")
def test_bench_without_its_chart(tmp_path, monkeypatch, capsys):
    """The numbers are made up; test_bench.py measures them."""
    numbers = {"results": [], "methods": []}
    monkeypatch.setattr("relgloss_view.bench.speed.measure.measure", lambda *_: numbers)
    monkeypatch.setattr("relgloss_view.bench.speed.report.lines", lambda _: [])
    monkeypatch.setattr("relgloss_view.bench.speed.chart.figure_of", fails)
    folder = tmp_path / "out"
    status, printed, err = run(capsys, "bench", "--quick", "-o", folder)
    assert status == 0
    one_warning(err, "chart.svg", "has all numbers")
    assert printed == f"{folder}: {bench_report.TABLE}, {bench_report.RESULTS}\n"
    assert {p.name for p in folder.iterdir()} == {bench_report.RESULTS, bench_report.TABLE}


@pytest.mark.usefixtures("forgiving")
def test_stability_maps_that_can_be_drawn_are(tmp_path, monkeypatch, capsys):
    def page(title, panels):
        if title == stability_figures.PAGES["grain"]:
            (tmp_path / "stability-grain.png").write_bytes(b"in part")
            fails()
        return stability_figures.new_figure(1.0, 1.0, dpi=20)

    monkeypatch.setattr(stability_figures, "_page", page)
    names = stability_figures.write_figures([], tmp_path)
    one_warning(capsys.readouterr().err, "stability-grain.png", "stability.json")
    assert len(names) == 2 * (len(stability_figures.PAGES) - 1)
    assert sorted(names) == sorted(p.name for p in tmp_path.iterdir())


def test_a_fault_is_no_warning_where_the_tests_run(tmp_path, monkeypatch):
    """Control: without the fixture the command raises, so that no test passes over a fault."""
    monkeypatch.setattr("relgloss_view.fitting.write_fit_report", fails)
    words = ["fit", "art-coated", "--model", "lobe", "-o", str(tmp_path / "m.json")]
    with pytest.raises(RuntimeError, match=FAULT):
        cli.main([*words, "--report", str(tmp_path / "m.png")])
    assert load_material(tmp_path / "m.json").fit is not None
