"""A report whose plots or page fail: the numbers are there, and one warning for each."""

from __future__ import annotations

import json

import pytest
from report_cases import usual

from relgloss_view.experiment.report import plots
from relgloss_view.experiment.report.folder import PAGE, RESULTS, write_report
from relgloss_view.experiment.report.plots import OVERVIEW

FAULT = "no plot today"


def fails(*_, **__):
    raise RuntimeError(FAULT)


def warnings_of(err):
    """The lines on standard error, each of them a warning that names the fault and what is kept."""
    lines = err.splitlines()
    for line in lines:
        assert line.startswith("warning: ")
        assert f"RuntimeError: {FAULT}" in line
        assert "all numbers and tables are written" in line
    return lines


@pytest.mark.usefixtures("forgiving")
class TestAnalyse:
    def write(self, folder):
        folder.mkdir()
        return write_report(folder, usual())

    def test_every_plot_may_fail(self, tmp_path, monkeypatch, capsys):
        monkeypatch.setattr("relgloss_view.experiment.report.figures.save", fails)
        written = self.write(tmp_path / "out")
        lines = warnings_of(capsys.readouterr().err)
        assert len(lines) == 1 + 3 * 2  # the overview; three plots of two samples
        assert not [name for name in written if name.endswith(".png")]
        results = json.loads((tmp_path / "out" / RESULTS).read_text())
        assert results["written"] == list(written)
        assert all(sample["plots"] == [] for sample in results["samples"])
        assert "<h1>" in (tmp_path / "out" / PAGE).read_text()

    def test_one_plot_costs_no_other(self, tmp_path, monkeypatch, capsys):
        monkeypatch.setattr(plots, "write_winners", fails)
        monkeypatch.setattr(plots, "write_overview", fails)
        written = self.write(tmp_path / "out")
        assert len(warnings_of(capsys.readouterr().err)) == 3
        assert OVERVIEW not in written
        assert {"matte-closeness.png", "matte-bounds.png"} <= set(written)
        assert (tmp_path / "out" / PAGE).read_text().count("<img") == 4

    def test_the_page_may_fail(self, tmp_path, monkeypatch, capsys):
        monkeypatch.setattr("relgloss_view.experiment.report.folder.report_page", fails)
        for name in ("closeness", "winners", "bounds"):
            monkeypatch.setattr(plots, f"write_{name}", lambda *_: None)
        written = self.write(tmp_path / "out")
        (line,) = warnings_of(capsys.readouterr().err)
        assert line.startswith(f"warning: {PAGE} was not drawn")
        assert PAGE not in written
        assert {RESULTS, OVERVIEW, "scale.csv"} <= set(written)
