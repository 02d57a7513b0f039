"""`relgloss experiment` as its users meet it: new, simulate, analyse, export."""

from __future__ import annotations

import contextlib
import csv
import json
import os
import signal
import sqlite3
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import test_cli
from PIL import Image

from relgloss_view import cli
from relgloss_view.experiment.design.study_file import load_study
from relgloss_view.experiment.observers.kinds import KINDS
from relgloss_view.experiment.observers.percept import BOTH_SIGNS
from relgloss_view.experiment.session.records import read_record
from relgloss_view.picture.scene.scene_file import load_scene

ROOT = Path(cli.__file__).parents[1]
SMALL = ("--set", "screen.width_px=64", "--set", "screen.height_px=64")
GRID = ("--set", "grid.sigma_n_deg=[0,2]", "--set", "grid.c_fraction=['3/6','6/6']")
TINY = (*SMALL, *GRID, "--truth", "cells")


def run(capsys, *words):
    """What a command prints on standard output."""
    status, out, err = test_cli.run(capsys, *words)
    assert status == 0, err
    return out


def refused(capsys, *words):
    """The one line of a refused command that left the working folder as it was."""
    return test_cli.refused(capsys, Path.cwd(), *words)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def session(folder, capsys):
    """A simulated study of four observers, three samples and four settings."""
    words = ("experiment", "simulate", "paper", *TINY, "--observers", 4, "-o", "s.sqlite")
    run(capsys, *words)
    return folder / "s.sqlite"


def test_a_loss_is_reported_by_every_command(session, capsys):
    """And nothing where nothing is lost."""
    analyse = ("experiment", "analyse", "s.sqlite", "--draws", 20, "--json")
    status, out, err = test_cli.run(capsys, *analyse)
    assert (status, err) == (0, "")
    assert json.loads(out)["files"][0]["losses"] == []
    with contextlib.closing(sqlite3.connect(session)) as connection, connection:
        connection.execute("DELETE FROM answer WHERE id IN (5, 9)")
    words = "s.sqlite: lacks 2 answers that the program had stored"
    status, out, err = test_cli.run(capsys, *analyse)
    assert status == 0
    assert words in err
    assert json.loads(out)["files"][0]["losses"] == [{"cause": "answers missing", "answers": 2}]
    for command in (
        ("experiment", "export", "s.sqlite", "-o", "a.csv"),
        ("experiment", "simulate", "paper", *TINY, "--observers", 4, "-o", "s.sqlite"),
        ("experiment", "export", "s.sqlite", "-o", "a.csv"),
    ):
        status, _, err = test_cli.run(capsys, *command)
        assert status == 0
        assert words in err


class TestNew:
    def test_writes_the_papers_study(self, folder, capsys):
        out = run(capsys, "experiment", "new", "-o", "mine.toml")
        assert "mine.toml" in out
        assert load_study("mine.toml") == load_study("paper")

    def test_never_over_something(self, folder, capsys):
        Path("mine.toml").write_text("mine")
        assert "is there already" in refused(capsys, "experiment", "new", "-o", "mine.toml")
        assert Path("mine.toml").read_text() == "mine"
        assert "ends in .toml" in refused(capsys, "experiment", "new", "-o", "mine.json")
        assert os.listdir(folder) == ["mine.toml"]


class TestSimulate:
    def test_prints_each_answer_once_it_is_stored(self, folder, capsys):
        words = ("experiment", "simulate", "paper", *TINY, "--observers", 2, "-o", "s.sqlite")
        out = run(capsys, *words, "--echo")
        told = [line.split() for line in out.splitlines() if line.startswith("O0")]
        record = read_record(folder / "s.sqlite", folder)
        assert len(told) == len(record.answers) == 2 * 3 * 4
        assert [int(line[-1]) for line in told] == [a.category for a in record.answers]
        assert os.listdir(folder) == ["s.sqlite"]

    def test_goes_on_where_it_was(self, folder, capsys):
        words = (
            "experiment",
            "simulate",
            "paper",
            *TINY,
            "-o",
            "s.sqlite",
            "--json",
            "--observers",
        )
        assert json.loads(run(capsys, *words, 2))["answers"] == 24
        assert json.loads(run(capsys, *words, 3))["answers"] == 36
        other = [*words, 3, "--set", "procedure.seed=5"]
        assert "another study" in refused(capsys, *other)
        assert len(read_record(folder / "s.sqlite", folder).answers) == 36

    def test_truths_are_told(self, folder, capsys):
        words = ("experiment", "simulate", "paper", *TINY, "--observers", 1, "-o", "s.sqlite")
        found = json.loads(run(capsys, *words, "--truth", "uncoated=1.0,4/6", "--json"))["truths"]
        assert found["uncoated"] == {"sigma_n_deg": 1.0, "c_fraction": pytest.approx(4 / 6)}
        record = read_record(folder / "s.sqlite", folder)
        assert record.details[0]["truths"]["uncoated"][0] == 1.0

    def test_settings_are_those_of_the_file(self, folder, capsys):
        words = ("experiment", "simulate", "paper", *TINY, "--observers", 1, "-o", "s.sqlite")
        run(capsys, *words, "--set", "procedure.ask_grain=true", "--set", "study.title=Ours")
        record = read_record(folder / "s.sqlite", folder)
        assert record.study.procedure.ask_grain
        assert record.study.title == "Ours"
        assert len(record.answers) == 24

    def test_without_opengl_no_file_is_made(self, folder, capsys, monkeypatch):
        from relgloss_view.base.errors import GLUnavailableError
        from relgloss_view.picture.gpu import context

        def none(backend):
            raise GLUnavailableError("no OpenGL")

        monkeypatch.setattr(context, "open_context", none)
        words = ("experiment", "simulate", "paper", *TINY, "-o", "s.sqlite")
        assert cli.main([str(w) for w in words]) == 3
        assert os.listdir(folder) == []

    @pytest.mark.slow
    def test_many_studies(self, folder, capsys):
        words = ("experiment", "simulate", "paper", *SMALL, "--studies", 2, "--observers", 5)
        words = (*words, "--grain-weight", -1)
        found = json.loads(run(capsys, *words, "--draws", 10, "--json"))
        assert found["all"]["cases"] == 6
        assert set(found["samples"]) == {"art-coated", "matte-coated", "uncoated"}
        assert "2 studies of 5 observers" in run(capsys, *words, "--draws", 10)
        assert os.listdir(folder) == []

    @pytest.mark.slow
    def test_both_settings_of_two_that_are_right_are_named(self, folder, capsys):
        words = ("experiment", "simulate", "paper", *SMALL, "--kind", "two-optima")
        told = run(capsys, *words, "--observers", 4, "-o", "s.sqlite")
        (line,) = [line for line in told.splitlines() if line.startswith("right for them")]
        assert line.count(" and ") == line.count(";") + 1  # two for each sample
        found = run(capsys, "experiment", "analyse", "s.sqlite", "--draws", 20)
        assert "and as right" in found
        run(capsys, *words[:-1], "unique", "--observers", 4, "-o", "one.sqlite")  # control
        alone = run(capsys, "experiment", "analyse", "one.sqlite", "--draws", 20)
        assert "right for the simulated observers" in alone
        assert "and as right" not in alone

    @pytest.mark.slow
    def test_both_signs_of_grain_where_none_is_stated(self, folder, capsys):
        words = ("experiment", "simulate", "paper", *SMALL, *GRID, "--truth", "cells")
        many = ("--studies", 1, "--observers", 2, "--draws", 5)
        found = json.loads(run(capsys, *words, *many, "--json"))
        assert [t["grain_weight"] for t in found["tables"]] == list(BOTH_SIGNS)
        assert [t["all"]["cases"] for t in found["tables"]] == [3, 3]
        assert found["all"]["cases"] == 6
        assert {s["study"] for s in found["studies"]} == {0, 1}
        told = run(capsys, *words, *many)
        assert "unique, grain weight -4" in told
        assert "unique, grain weight +4" in told
        one = json.loads(run(capsys, *words, *many, "--grain-weight", "-0.5", "--json"))
        assert (one["kind"], one["grain_weight"]) == ("unique", -0.5)
        assert "tables" not in one

    def test_a_session_holds_the_sign_of_each_observer(self, folder, capsys):
        words = ("experiment", "simulate", "paper", *TINY, "--observers", 4, "-o")
        assert "lowers it for others (-4, +4)" in run(capsys, *words, "both.sqlite")
        stated = run(capsys, *words, "one.sqlite", "--grain-weight", "1.5")
        assert "lowers" not in stated
        blind = json.loads(run(capsys, *words, "blind.sqlite", "--kind", "city-block", "--json"))
        assert (blind["kind"], blind["grain_weights"]) == ("city-block", [])
        for name, weights in (
            ("both", [-4, -4, 4, 4]), ("one", [1.5] * 4), ("blind", [None] * 4)
        ):  # fmt: skip
            record = read_record(folder / f"{name}.sqlite", folder)
            assert [record.details[n]["grain_weight"] for n in range(4)] == weights

    @pytest.mark.slow
    def test_all_kinds_in_one_table(self, folder, capsys):
        words = ("experiment", "simulate", "paper", *SMALL, *GRID, "--truth", "cells")
        words = (*words, "--kind", "all", "--studies", 1, "--observers", 5, "--draws", 5)
        found = json.loads(run(capsys, *words, "--json"))
        kinds = [(t["kind"], t["grain_weight"]) for t in found["tables"]]
        assert {kind for kind, _ in kinds} == set(KINDS)
        assert len(set(kinds)) == len(kinds) == 2 * len(KINDS) - 3  # three see no picture
        told = run(capsys, *words)
        assert all(kind in told for kind in KINDS)
        assert cli.main(["experiment", "simulate", "paper", "--kind", "all", "-o", "s.sqlite"]) == 2
        assert "--kind all needs --studies" in capsys.readouterr().err
        assert os.listdir(folder) == []

    @pytest.mark.parametrize(
        ("words", "told"),
        [
            (("--grain-weight", "nan"), "--grain-weight: expected -100 to 100"),
            (("--grain-weight", "1e6"), "--grain-weight: expected -100 to 100"),
            (("--observers", "0"), "--observers 0: expected 1 to 1000"),
            (("--seed", "-1"), "--seed -1: expected 0 to"),
            (("--truth", "uncoated"), "expected SAMPLE=SIGMA_N,C"),
            (("--truth", "uncoated=1.0.0,1"), "expected SAMPLE=SIGMA_N,C"),
            (("--truth", "uncoated=.,0.5"), "expected SAMPLE=SIGMA_N,C"),
            (("--backend", "egl", "--set", "procedure.ask_grain=yes"), "expected true or false"),
            (("--truth", "uncoated=9,1"), "outside the study's grid"),
            (
                ("--truth", "published"),
                "matte-coated: 2 deg, 2/6 c_max is outside the study's grid",
            ),
            (("--truth", "glossy=1,1"), "no such sample"),
            (("--lapse", "2"), "population.lapse: expected 0 to 1"),
            (("--set", "grid=3"), "expected TABLE.ENTRY=VALUE"),
            (("--set", "grid.c_fraction=[2,1]"), "ascending"),
            (("--set", "samples.name=art-coated"), "can't be set"),
        ],
    )
    def test_one_line_says_what_is_wrong(self, folder, capsys, words, told):
        command = ("experiment", "simulate", "paper", *TINY, "-o", "s.sqlite")
        assert told in refused(capsys, *command, *words)
        assert os.listdir(folder) == []

    def test_either_a_file_or_studies(self, folder, capsys):
        for more in ((), ("-o", "s.sqlite", "--studies", "2")):
            assert cli.main(["experiment", "simulate", "paper", *more]) == 2
            assert "give either -o" in capsys.readouterr().err
        assert os.listdir(folder) == []

    def test_interrupted(self, folder):
        """Ctrl-C: one line, and what was answered is kept."""
        words = [sys.executable, "-m", "relgloss_view.cli", "experiment", "simulate", "paper"]
        words += [*SMALL, "--observers", "1000", "--echo", "-o", "s.sqlite"]
        process = subprocess.Popen(
            words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
            env={**os.environ, "PYTHONPATH": str(ROOT)},
        )  # fmt: skip
        for _ in range(20):
            process.stdout.readline()
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=60)
        assert process.returncode == 130
        assert err.count("\n") == 1
        assert "interrupted" in err
        assert os.listdir(folder) == ["s.sqlite"]
        answers = len(read_record(folder / "s.sqlite", folder).answers)
        assert 20 + len(out.splitlines()) <= answers <= 21 + len(out.splitlines())


class TestAnalyse:
    def test_report(self, folder, session, capsys):
        out = run(capsys, "experiment", "analyse", session, "--draws", 30, "-o", "report")
        assert "4 simulated observers" in out
        found = json.loads(Path("report/results.json").read_text(encoding="utf-8"))
        assert found["format"] == "relgloss-experiment-results"
        assert {s["label"] for s in found["samples"]} == {"art-coated", "matte-coated", "uncoated"}
        page = Path("report/report.html").read_text(encoding="utf-8")
        assert "imulated" in page
        with Path("report/answers.csv").open(encoding="utf-8", newline="") as file:
            assert len(list(csv.DictReader(file))) == 4 * 12
        before = {p.name: p.read_bytes() for p in Path("report").iterdir()}
        run(capsys, "experiment", "analyse", session, "--draws", 30, "-o", "report")
        assert {p.name: p.read_bytes() for p in Path("report").iterdir()} == before

    def test_json_is_the_same_without_a_report(self, session, capsys):
        found = json.loads(run(capsys, "experiment", "analyse", session, "--draws", 10, "--json"))
        assert len(found["samples"]) == 3
        assert os.listdir(session.parent) == ["s.sqlite"]

    @pytest.mark.parametrize(
        ("words", "told"),
        [
            (("--draws", "1"), "--draws 1: expected 2 to"),
            (("--seed", "-1"), "--seed -1: expected"),
            (("-o", "s.sqlite"), "is a file"),
            (("-o", ""), "empty name"),
        ],
    )
    def test_one_line_says_what_is_wrong(self, folder, session, capsys, words, told):
        assert told in refused(capsys, "experiment", "analyse", session, *words)
        assert os.listdir(folder) == ["s.sqlite"]

    def test_files_that_are_none(self, folder, session, capsys):
        Path("x.txt").write_text("hello")
        assert "not a session file" in refused(capsys, "experiment", "analyse", "x.txt")
        assert "check the name" in refused(capsys, "experiment", "analyse", "gone.sqlite")
        assert "given twice" in refused(capsys, "experiment", "analyse", session, "./s.sqlite")
        assert "a folder" in refused(capsys, "experiment", "analyse", ".")

    def test_a_folder_that_holds_other_things(self, folder, session, capsys):
        Path("own").mkdir()
        Path("own/matte-coated.toml").write_text("mine")
        told = refused(capsys, "experiment", "analyse", session, "--draws", 5, "-o", "own")
        assert "no results.json of `relgloss experiment analyse`; choose a new folder" in told
        assert Path("own/matte-coated.toml").read_text() == "mine"

    def test_a_place_is_refused_before_the_analysis(self, folder, session, capsys, monkeypatch):
        """Which takes minutes where there are many answers."""
        monkeypatch.setattr(
            "relgloss_view.experiment.verdict.analysis.analyse",
            lambda *_: pytest.fail("the analysis has begun"),
        )
        told = refused(capsys, "experiment", "analyse", session, "-o", "s.sqlite/report")
        assert "can't be written" in told
        Path("link").symlink_to("nowhere")
        told = refused(capsys, "experiment", "analyse", session, "-o", "link")
        assert "link: a link to nothing" in told

    def test_a_folder_of_somebody_else(self, folder, session, capsys):
        run(capsys, "grid", "--size", "16x16", "-o", "stimuli")
        Path("stimuli/results.json").write_text("{}")
        told = refused(capsys, "experiment", "analyse", session, "--draws", 5, "-o", "stimuli")
        assert "was not written by `relgloss experiment analyse`" in told


class TestExport:
    def test_answers(self, folder, session, capsys):
        run(capsys, "experiment", "export", session, "-o", "a.csv")
        run(capsys, "experiment", "export", session, "-o", "a.json")
        with Path("a.csv").open(encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(file))
        told = json.loads(Path("a.json").read_text(encoding="utf-8"))
        assert len(rows) == len(told) == 48
        assert rows[0]["category_name"] in load_study("paper").categories
        assert [row["observer"] for row in rows] == [row["observer"] for row in told]

    def test_stimuli_are_the_snapshots(self, folder, session, capsys):
        run(capsys, "experiment", "export", session, "--stimuli", "st")
        manifest = json.loads(Path("st/manifest.json").read_text(encoding="utf-8"))
        assert len(manifest["stimuli"]) == 1 + 3 * 4
        assert all(s["as_shown"] is None for s in manifest["stimuli"])
        words = ("--sample", "uncoated", "--sigma-n", 2, "--c-fraction", 1.0, "--size", "64x64")
        words += ("--grain-kind", "screen", "--edges", "sampled", "--dither", "none")
        run(capsys, "snapshot", *words, "-o", "u.png")
        (name,) = [
            s["file"] for s in manifest["stimuli"]
            if (s["sample"], s["sigma_n_deg"]) == ("uncoated", 2.0) and s["setting"] == 3
        ]  # fmt: skip
        with Image.open("u.png") as one, Image.open(Path("st") / name) as other:
            np.testing.assert_array_equal(np.asarray(one), np.asarray(other))

    def test_never_over_a_session(self, folder, session, capsys):
        """Whatever it is called: answers can't be asked for again."""
        session.rename("s.csv")
        before = Path("s.csv").read_bytes()
        for other in ("s.csv", "./s.csv", folder / "s.csv"):
            told = refused(capsys, "experiment", "export", "s.csv", "-o", other)
            assert "is a session file" in told
        assert Path("s.csv").read_bytes() == before

    def test_json(self, folder, session, capsys):
        told = json.loads(run(capsys, "experiment", "export", session, "-o", "a.csv", "--json"))
        assert told["answers"] == 48
        assert json.loads(run(capsys, "experiment", "new", "-o", "n.toml", "--json")) == {
            "file": "n.toml"
        }

    def test_what_is_wrong(self, folder, session, capsys):
        assert "ends in .csv or .json" in refused(
            capsys, "experiment", "export", session, "-o", "a.txt"
        )
        Path("mine").mkdir()
        Path("mine/x").write_text("")
        told = refused(capsys, "experiment", "export", session, "--stimuli", "mine")
        assert "no manifest.json of `relgloss experiment export`" in told
        assert sorted(os.listdir(folder)) == ["mine", "s.sqlite"]


def test_worked_example(folder, capsys):
    """From design to report: simulated observers whose truth is the paper's optimum.

    Pictures of a fourteenth of its pixels; the report has to find each paper's setting (Ishii
    et al., "Results") among those that are not told apart from the best, at most one step off.
    """
    run(capsys, "experiment", "new", "-o", "study.toml")
    pictures = ("--set", "screen.width_px=136", "--set", "screen.height_px=136")
    run(capsys, "experiment", "simulate", "study.toml", *pictures, "-o", "answers.sqlite")
    run(capsys, "experiment", "analyse", "answers.sqlite", "--draws", 100, "-o", "report")
    found = json.loads(Path("report/results.json").read_text(encoding="utf-8"))
    published = {
        "art-coated": (0.0, 5 / 6),
        "matte-coated": (2.0, 2 / 6),
        "uncoated": (2.0, 1 / 6),
    }
    grid = load_study("study.toml").grid
    assert {s["label"] for s in found["samples"]} == set(published)
    exact = 0
    for sample in found["samples"]:
        sigma, c = published[sample["label"]]
        scene, look = load_scene(Path("report") / f"{sample['label']}.toml")
        assert scene.material.name.startswith(sample["label"].split("-")[0])
        assert abs(look.sigma_n_deg - sigma) <= 0.5 + 1e-9
        assert abs(look.c_fraction - c) <= 1 / 6 + 1e-9
        exact += abs(look.sigma_n_deg - sigma) < 1e-9 and abs(look.c_fraction - c) < 1e-9
        assert sample["status"] == "best", sample["label"]
    assert exact >= 2  # of three; the figures of many studies are in docs/experiment.md
    assert len(grid) == 42
