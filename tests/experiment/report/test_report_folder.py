"""The folder of a report: page, plots and scenes, whatever the study is like."""

import dataclasses
import json
import shutil
from html.parser import HTMLParser
from pathlib import Path

import materials
import numpy as np
import pytest
from matplotlib.text import Text
from PIL import Image
from report_cases import (
    adaptive,
    alone,
    judged_as,
    pool_of,
    study_of,
    usual,
    with_grain,
    without_answers,
)

from relgloss_view.base.writing import whole_folder
from relgloss_view.cli import main
from relgloss_view.experiment.design.grid import Grid
from relgloss_view.experiment.design.study import StudySample
from relgloss_view.experiment.report import figures
from relgloss_view.experiment.report.folder import (
    PAGE,
    RESULTS,
    earlier_files,
    write_report,
)
from relgloss_view.experiment.report.maps import level_of
from relgloss_view.experiment.report.panels import panels
from relgloss_view.experiment.verdict.analysis import Options, analyse
from relgloss_view.experiment.verdict.full_grid import CHANCE
from relgloss_view.picture.scene.sample import Sample
from relgloss_view.picture.scene.scene_file import read_scene_file

OF_SAMPLE = ("-bounds.png", "-closeness.png", "-winners.png", ".toml")
LABEL = "$x_1$ <b>& \"quoted\" '紙'</b> \\frac"


class Reader(HTMLParser):
    """What a browser would make of a page: its tags and its text."""

    def __init__(self, page):
        super().__init__()
        self.tags, self.words, self.images = [], [], []
        self.feed(page)

    def handle_starttag(self, tag, attributes):
        self.tags.append(tag)
        self.images += [value for name, value in attributes if name == "src"]

    def handle_data(self, data):
        self.words.append(data)

    @property
    def text(self):
        return " ".join(" ".join(self.words).split())


def report(folder, analysis, **more):
    folder.mkdir(parents=True)
    return write_report(folder, analysis, **more)


def page_of(folder):
    return Reader((folder / PAGE).read_text(encoding="utf-8"))


def results_of(folder):
    return json.loads((folder / RESULTS).read_text(encoding="utf-8"))


class TestFolder:
    @pytest.fixture(scope="class")
    @classmethod
    def folder(cls, tmp_path_factory):
        folder = tmp_path_factory.mktemp("report") / "out"
        cls.written = report(folder, usual(), command="relgloss experiment analyse study.sqlite")
        return folder

    def test_it_holds_all_that_is_told(self, folder):
        expected = {PAGE, RESULTS, "scale.csv", "answers.csv", "overview.png"}
        expected |= {f"{name}{end}" for name in ("matte", "rough") for end in OF_SAMPLE}
        assert {p.name for p in folder.iterdir()} == expected == set(self.written)
        assert results_of(folder)["written"] == sorted(expected)
        assert results_of(folder)["samples"][0]["scene"] == "matte.toml"

    def test_the_page_stands_alone_and_begins_with_the_verdicts(self, folder):
        page = page_of(folder)
        assert len(page.images) == 7
        assert all(source.startswith("data:image/png;base64,") for source in page.images)
        assert not {"script", "link", "iframe"} & set(page.tags)
        assert page.tags.index("table") < page.tags.index("img")
        assert "computed, not given by people" in page.text.split("matte")[0]
        assert "matte best 1 deg, 2/6 c_max" in page.text
        assert "relgloss view matte.toml" in page.text
        assert "relgloss experiment analyse study.sqlite" in page.text
        assert "contain everybody who answered" in page.text
        for term in ("closeness", "bound", "condition D", "drawn again with replacement"):
            assert term in page.text

    def test_no_path_of_this_machine_is_handed_on(self, folder):
        texts = [path for path in folder.iterdir() if path.suffix != ".png"]
        assert {".html", ".json", ".csv"} <= {path.suffix for path in texts}
        for path in texts:
            assert str(folder.parent) not in path.read_text(encoding="utf-8")

    def test_plots_are_pictures_without_a_date(self, folder):
        plots = list(folder.glob("*.png"))
        assert len(plots) >= 3
        for path in plots:
            with Image.open(path) as picture:
                assert min(picture.size) > 200
                assert "Software" not in picture.info

    def test_it_is_the_same_again(self, folder, tmp_path):
        told = []
        again = tmp_path / "out"
        again.mkdir()
        write_report(
            again, usual(), command="relgloss experiment analyse study.sqlite",
            progress=lambda share, text: told.append(share),
        )  # fmt: skip
        for path in folder.iterdir():
            assert path.read_bytes() == (again / path.name).read_bytes(), path.name
        assert told == sorted(told)
        assert 0.0 <= told[0] < told[-1] <= 1.0

    def test_scenes_are_the_study_at_the_leading_setting(self, folder):
        study = usual().pool.study
        scene = read_scene_file(folder / "rough.toml")
        leading = study.grid.settings[usual().samples[1].verdict.leading]
        assert scene.look == study.test_look(leading)
        assert scene.reference_look == study.reference_look
        assert scene.reference.name == "cast-coated"
        assert scene.scene() == study.scene(1)
        assert scene.match.made_by == "experiment"
        assert scene.match.test_sigma_n_deg == leading.sigma_n_deg
        assert scene.match.test_c > 0.0

    def test_a_scene_is_drawn(self, folder, tmp_path):
        out = tmp_path / "out.png"
        scene = str(folder / "rough.toml")
        assert main(["snapshot", "--scene", scene, "--size", "16x16", "-o", str(out)]) == 0
        assert out.is_file()


class TestScenes:
    def test_materials_and_lamp_move_with_the_folder(self, tmp_path):
        lamp = tmp_path / "mine.csv"
        lamp.write_text("\n".join(f"{w},{100 + w / 10}" for w in range(380, 781, 5)))
        own = Sample(materials.paper("matte"), file="gone/matte.json")
        # A material that was built in once, and is another today.
        old = Sample(materials.paper("art"), name="art-coated")
        study = study_of()
        study = dataclasses.replace(
            study,
            samples=(StudySample("mine", own), StudySample("reference", old)),
            reference=Sample(materials.paper("cast"), file="gone/cast.json"),
            setup=study.setup.with_entries("lamp", illuminant=str(lamp)),
        )
        analysis = analyse(pool_of(study_of(("mine", "reference"))), Options(5))
        pool = dataclasses.replace(analysis.pool, study=study)
        report(tmp_path / "out", dataclasses.replace(analysis, pool=pool))
        shutil.move(tmp_path / "out", tmp_path / "elsewhere")
        lamp.unlink()
        scene = read_scene_file(tmp_path / "elsewhere" / "mine.toml")
        assert scene.sample.material == own.material
        assert scene.reference.material == study.reference.material
        assert Path(scene.setup.lamp.illuminant) == tmp_path / "elsewhere" / "lamp.csv"
        assert (
            read_scene_file(tmp_path / "elsewhere/reference.toml").sample.material == old.material
        )
        assert str(tmp_path) not in (tmp_path / "elsewhere" / "mine.toml").read_text()

    def test_none_where_nothing_is_declared_best(self, tmp_path):
        written = report(tmp_path / "out", judged_as(usual(), CHANCE))
        assert "matte.toml" not in written
        assert "rough.toml" in written
        assert "No scene is written: nothing is declared best." in page_of(tmp_path / "out").text
        (first, second) = results_of(tmp_path / "out")["samples"]
        assert (first["scene"], second["scene"]) == (None, "rough.toml")
        assert first["declared"] is False

    def test_of_one_observer_it_has_a_caveat(self, tmp_path):
        written = report(tmp_path / "out", alone())
        assert {"matte.toml", "matte-bounds.png"} <= set(written)
        assert "matte-winners.png" not in written  # nothing was resampled
        assert "one observer shows nothing about other people" in page_of(tmp_path / "out").text


class TestAnyStudy:
    def test_labels_are_shown_as_they_are(self, tmp_path):
        study = study_of((LABEL, "../etc", "..", "A", "a"), categories=("<i>near</i>", "$far$"))
        study = dataclasses.replace(study, title="<script>alert(1)</script>")
        written = report(tmp_path / "out", analyse(pool_of(study, count=5), Options(2)))
        assert {p.name for p in (tmp_path / "out").iterdir()} == set(written)
        page = page_of(tmp_path / "out")
        assert LABEL in page.text
        assert "<script>alert(1)</script>" in page.text
        assert "<i>near</i> | $far$" in page.text
        assert not {"b", "i", "script"} & set(page.tags)

    @pytest.mark.parametrize("made", [with_grain, pytest.param(adaptive, marks=pytest.mark.slow)])
    def test_other_kinds_of_studies(self, made, tmp_path):
        written = report(tmp_path / "out", made())
        assert {f"matte{end}" for end in OF_SAMPLE} <= set(written)
        page = page_of(tmp_path / "out")
        assert ("posterior" in page.text) == (made is adaptive)
        assert ("by both together" in page.text) == (made is with_grain)

    @pytest.mark.parametrize(
        "grid",
        [
            Grid((0.0,), (0.25, 0.5, 0.75, 1.0)),
            Grid((0.0, 0.5, 3.0), (0.5,)),
            Grid((0.0, 1.0), (0.0, 1.0)),
            pytest.param(
                Grid(tuple(np.linspace(0.0, 5.0, 15)), tuple(np.linspace(0.0, 1.0, 15))),
                marks=pytest.mark.slow,
            ),
        ],
        ids=["one sigma", "one c", "two by two", "large"],
    )
    def test_any_grid(self, grid, tmp_path):
        pool = pool_of(study_of(("matte",), grid), count=3)
        assert "matte-closeness.png" in report(tmp_path / "out", analyse(pool, Options(2)))

    def test_settings_that_nobody_judged_and_categories_that_nobody_used(self, tmp_path):
        names = tuple(f"category {k} with a name of forty characters"[:40] for k in range(9))
        pool = pool_of(study_of(("matte",), categories=names), count=3)
        pool = without_answers(pool, lambda a: a.trial.setting in (0, 4) or a.category in (0, 5, 8))
        report(tmp_path / "out", analyse(pool, Options(5)))
        (sample,) = results_of(tmp_path / "out")["samples"]
        bounds = sample["questions"]["ratio"]["bounds"]["probit"]
        assert (bounds[0], bounds[-1]) == (None, None)

    def test_several_files(self, tmp_path):
        study = study_of(("matte",))
        first, second = (pool_of(study, count=2, name=name) for name in ("day 1", "day 2"))
        both = dataclasses.replace(
            first,
            members=(*first.members, *second.members),
            records=(*first.records, *second.records),
        )
        report(tmp_path / "out", analyse(both, Options(5)))
        rows = (tmp_path / "out" / "answers.csv").read_text().splitlines()[1:]
        assert [row.split(",")[0] for row in rows] == ["day 1.sqlite"] * 18 + ["day 2.sqlite"] * 18


class TestRunningAgain:
    def test_what_a_former_report_left_is_removed(self, tmp_path):
        folder = tmp_path / "out"
        for analysis in (usual(), judged_as(usual(), CHANCE)):
            with whole_folder(folder, RESULTS, earlier_files) as temporary:
                written = write_report(temporary, analysis)
            (folder / "notes.txt").touch()
            assert (folder / "answers.csv").stat().st_mode & 0o777 == 0o600
        assert {p.name for p in folder.iterdir()} == {*written, "notes.txt"}
        assert not (folder / "matte.toml").exists()

    @pytest.mark.parametrize(
        "told",
        [
            '{"written": ["../a", "/a", "b/c", "", ".", 3, null, "a\\u0000", "sub", "own"]}',
            "[]",
            "{",
            "3",
        ],
    )
    def test_only_its_own_files_are_removed(self, told, tmp_path):
        folder = tmp_path / "out"
        (folder / "sub").mkdir(parents=True)
        (folder / "b").mkdir()
        for file in (tmp_path / "a", folder / "b" / "c", folder / "own"):
            file.touch()
        (folder / RESULTS).write_text(told)
        with whole_folder(folder, RESULTS, earlier_files) as temporary:
            (temporary / RESULTS).write_text("{}")
        names = {"a", "out", "out/sub", "out/b", "out/b/c", f"out/{RESULTS}"}
        names |= set() if "own" in told else {"out/own"}
        assert {str(p.relative_to(tmp_path)) for p in tmp_path.rglob("*")} == names
        assert earlier_files(tmp_path / "none") == ()


class TestPaint:
    def test_text_fits_its_width(self):
        with figures.drawing():
            long = "many words that do not fit " * 4
            lines = figures.fitted(long, 2.0, 9.0, 3)
            assert len(lines) == 3
            assert lines[-1].endswith("...")
            assert " ".join(figures.fitted(long, 2.0, 9.0, 99)) == long.strip()
            assert "".join(figures.fitted("x" * 200, 1.0, 9.0, 99)) == "x" * 200
            assert figures.fitted("$x_1$ \\frac", 9.0, 9.0, 1) == ["$x_1$ \\frac"]

    def test_nothing_is_mathematics(self):
        analysis = analyse(pool_of(study_of(("$x_1$",)), count=2), Options(5))
        with figures.drawing():
            figure, _ = panels(analysis.samples[0], analysis, ["$y$"])
        written = [t for t in figure.findobj(Text) if t.get_text()]
        assert "$x_1$" in [t.get_text() for t in written]
        assert not any(t.get_parse_math() for t in written)

    def test_a_region_of_a_posterior(self):
        posterior = np.array([[0.5, 0.3], [0.15, 0.05]])
        assert level_of(posterior, 0.9) == 0.15
        assert level_of(posterior, 0.5) == 0.5
        assert level_of(posterior, 1.0) == 0.05
