"""`relgloss experiment run` up to the window: which session file, and what is refused before."""

from __future__ import annotations

from pathlib import Path

import pytest

from relgloss_view.cli import main
from relgloss_view.commands import experiment_run
from relgloss_view.experiment.store import Store
from relgloss_view.experiment.study_file import load_study


@pytest.fixture
def run(capsys):
    """Runs the command; returns its exit status and what it said on standard error."""

    def command(*words):
        status = main(["experiment", "run", *map(str, words)])
        return status, capsys.readouterr().err

    return command


@pytest.fixture(autouse=True)
def _no_display(monkeypatch):
    """Here no window opens; what comes before it is what is tested."""
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)


@pytest.fixture
def study(tmp_path):
    file = tmp_path / "mine.study.toml"
    file.write_text('[[samples]]\nname = "uncoated"\n')
    return file


def test_without_a_display_no_file_is_made(run, study):
    status, told = run(study)
    assert status == 3
    assert "no display" in told
    assert [p.name for p in study.parent.iterdir()] == [study.name]


def test_the_session_lies_beside_the_study(study):
    path, held = experiment_run._session(str(study), None)
    assert path == study.parent / "mine.study.sqlite"
    assert [s.label for s in held.samples] == ["uncoated"]
    path, _ = experiment_run._session(str(study), "elsewhere.sqlite")
    assert path == Path("elsewhere.sqlite")


def test_the_built_in_study_needs_a_place(run):
    status, told = run("paper")
    assert status == 1
    assert "-o paper.sqlite" in told
    path, held = experiment_run._session("paper", "paper.sqlite")
    assert path == Path("paper.sqlite")
    assert len(held.samples) == 3


def test_a_session_file_goes_on_in_itself(run, study, tmp_path):
    session = tmp_path / "answers.sqlite"
    Store(session, load_study(study)).close()
    assert experiment_run._session(str(session), None) == (session, None)
    status, told = run(session, "-o", tmp_path / "other.sqlite")
    assert status == 1
    assert "leave -o out" in told


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("nowhere.toml",), "nowhere.toml: can't be read"),
        (("mine.study.toml", "--display-profile", "mine.study.toml"), "not an ICC profile"),
        (("mine.study.toml", "--display-profile", "none.icc"), "none.icc: can't be read"),
    ],
)
def test_faults_are_told_in_a_line(run, words, told, study, monkeypatch):
    monkeypatch.chdir(study.parent)
    status, said = run(*words)
    assert status == 1
    assert told in said
    assert said.count("\n") == 1
    assert [p.name for p in study.parent.iterdir()] == [study.name]
