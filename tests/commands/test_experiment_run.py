"""`relgloss experiment run` up to the window: which session file, and what is refused before."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import pytest

from relgloss_view.cli import main
from relgloss_view.commands import experiment_run
from relgloss_view.experiment.design.study_file import load_study
from relgloss_view.experiment.session.flow import nothing_left
from relgloss_view.experiment.session.records import SIMULATED
from relgloss_view.experiment.session.store import Store


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


class TestWhoIsLed:
    """The command but for its window: whose session it is, and what it says of that."""

    @pytest.fixture(autouse=True)
    def _no_window(self, monkeypatch):
        class Unseen:
            def __init__(self, program, *_, **__):
                self.size = (0, 0)

            def run(self):
                pass

        monkeypatch.setattr(
            "relgloss_view.viewer.shell.platform.open_platform", lambda headless: None
        )
        monkeypatch.setattr("relgloss_view.viewer.shell.window.Window", Unseen)

    @pytest.fixture(params=["full", "adaptive"])
    def session(self, request, tmp_path):
        """A session file whose O01 has judged 2 of 4."""
        file = tmp_path / "who.study.toml"
        grid = "sigma_n_deg = [0.0, 2.0]\nc_fraction = [0.5, 1.0]"
        file.write_text(
            f'[[samples]]\nname = "uncoated"\n[grid]\n{grid}\n'
            f'[procedure]\ndesign = "{request.param}"\n[adaptive]\ntrials = 4\n'
            "interval_steps = 0.01\n"
        )
        path = tmp_path / "who.sqlite"
        with Store(path, load_study(file)) as store:
            self.judge(store, store.observer(), 2)
        return path

    def judge(self, store, observer, count):
        from relgloss_view.experiment.session.flow import Flow

        run = store.begin_run(observer, "device", {})
        store.consent(observer)
        for _ in range(count):
            flow = Flow(store, observer, run, lambda: 0.0)
            store.answer(observer, flow.trial, "ratio", 1, 0.5, run)

    def names(self, session):
        with Store(session) as store:
            return [(o.name, o.ended) for o in store.observers()]

    def test_the_last_one_goes_on_and_it_is_said(self, run, session):
        said = (
            "O01 continues: 2 of 4 are judged. Somebody else? Close the window (Ctrl+Q) and start "
            "with --new.\n"
        )
        assert run(session) == (0, said)
        assert run(session, "--observer", "O01") == (0, said)

    def test_a_new_one_begins_and_the_other_can_still_go_on(self, run, session):
        assert run(session, "--new") == (0, "O02 begins\n")
        assert self.names(session) == [("O01", False), ("O02", False)]
        assert run(session, "--observer", "O02") == (0, "O02 begins\n")
        assert run(session, "--observer", "Z") == (0, "Z begins\n")
        assert run(session)[1].startswith("O01 continues")

    def test_new_and_a_name_exclude_each_other(self, run, session):
        status, said = run(session, "--new", "--observer", "O03")
        assert status == 2
        assert "not allowed with" in said
        assert len(self.names(session)) == 1

    def test_killed_on_the_last_page(self, run, session):
        with Store(session) as store:
            assert not nothing_left(store, store.observer())
            self.judge(store, store.observer(), 2)
            assert nothing_left(store, store.observer())
        # By name, the last answer can still be taken back.
        assert run(session, "--observer", "O01")[1].startswith("O01 continues: 4 of 4")
        assert self.names(session) == [("O01", False)]
        assert run(session) == (0, "O02 begins\n")
        assert self.names(session) == [("O01", True), ("O02", False)]

    def test_how_to_go_on_is_said_of_this_observer(self, session, capsys):
        experiment_run._tell(SimpleNamespace(json=False), session, "Z 1", 1, 4)
        assert capsys.readouterr().out == (
            f"{session}: Z 1 has judged 1 of 4; `relgloss experiment run {session} "
            "--observer 'Z 1'` resumes\n"
        )

    @pytest.mark.parametrize("words", [(), ("--new",), ("--observer", "O07")])
    def test_not_beside_simulated_ones(self, run, session, words):
        with Store(session) as store:
            store.observer("S01", SIMULATED)
        status, said = run(session, *words)
        assert status == 1
        assert said.endswith(
            f"{session}: holds simulated answers; give people a file of their own with -o\n"
        )
        assert said.count("\n") == 1
        assert len(self.names(session)) == 2
