"""Catalogues as files of the window, and what its panel knows, without a window."""

from __future__ import annotations

import io
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / "scripts"))
import made_catalogue

from relgloss_view.base.errors import InputError
from relgloss_view.catalogue.query.search import Searcher
from relgloss_view.viewer.drawing import thumbnails
from relgloss_view.viewer.files import catalogue_files
from relgloss_view.viewer.files.open_job import OpenJob
from relgloss_view.viewer.shell.catalogue_actions import CatalogueActions
from relgloss_view.viewer.state import catalogues
from relgloss_view.viewer.state.catalogues import Asked, OpenCatalogue
from relgloss_view.viewer.state.layout_file import WindowLayout, load_layout, save_layout
from relgloss_view.viewer.state.model import Model
from relgloss_view.viewer.state.state import State

COUNT = 40
LIMIT_S = 30.0


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    made = tmp_path_factory.mktemp("made") / "stock"
    made_catalogue.write(made, COUNT)
    return made


def job_on(path):
    prepared = []
    job = OpenJob(path, lambda: None, prepared.append)
    assert job.wait(LIMIT_S)
    return job, prepared


def open_of(path, count=COUNT):
    made = made_catalogue.MadeCatalogue(path, count)
    return OpenCatalogue(str(path), made, Searcher(made))


def test_a_folder_and_its_table_are_told_by_the_mark(folder, tmp_path):
    assert catalogue_files.catalogue_folder(folder) == str(folder)
    assert catalogue_files.catalogue_folder(folder / "catalogue.parquet") == str(folder)
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "catalogue.json").write_text('{"format": "another"}', encoding="utf-8")
    assert catalogue_files.catalogue_folder(tmp_path / "other") is None
    assert catalogue_files.catalogue_folder(folder / "catalogue.json") is None
    assert catalogue_files.catalogue_folder("no such folder") is None


def test_it_opens_as_other_files_do_and_changes_no_picture(folder):
    job, prepared = job_on(folder)
    assert job.fault is None
    opened = job.result.catalogue
    assert len(opened.catalogue.rows) == COUNT
    table = (folder / "catalogue.parquet").stat()
    assert opened.stamp == (table.st_mtime_ns, table.st_size)
    assert prepared == []
    state = State.initial()
    assert job.result.applied(state, "test") is state


def truncated(place):
    data = (place / "catalogue.parquet").read_bytes()
    (place / "catalogue.parquet").write_bytes(data[: len(data) // 2])


def of_another(place):
    import pyarrow as pa
    import pyarrow.parquet as pq

    pq.write_table(pa.table({"a": [1, 2]}), place / "catalogue.parquet")


def without_table(place):
    (place / "catalogue.parquet").unlink()


def unmarked(place):
    (place / "catalogue.json").unlink()


@pytest.mark.parametrize("damage", [truncated, of_another, without_table, unmarked])
def test_a_damaged_one_is_one_line_that_names_it(damage, tmp_path):
    place = tmp_path / "stock"
    made_catalogue.write(place, 3)
    damage(place)
    job, _ = job_on(place / "catalogue.parquet")
    assert job.result is None
    assert "stock" in job.fault
    assert "\n" not in job.fault
    assert "the program failed" not in job.fault


def test_a_folder_that_is_gone_is_one_line(tmp_path):
    job, _ = job_on(tmp_path / "gone")
    assert job.result is None
    assert "gone" in job.fault
    assert "\n" not in job.fault


def test_the_window_starts_without_what_reads_parquet():
    code = (
        "import sys; import relgloss_view.viewer.shell.app, relgloss_view.commands.view;"
        "print('pyarrow' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split()[0] == "False"
    # The control: the reader needs it.
    code = "import sys; import relgloss_view.catalogue.catalogue; print('pyarrow' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split()[0] == "True"


def test_two_catalogues_are_refused_before_one_is_read(folder):
    from relgloss_view.commands import view

    view._check_files([str(folder), "cast-coated"])
    with pytest.raises(InputError, match="2 catalogues given: expected at most 1"):
        view._check_files([str(folder), str(folder / "catalogue.parquet")])


def test_the_layout_remembers_the_folder(tmp_path):
    save_layout(tmp_path / "window.toml", WindowLayout(catalogue="/a/stock"))
    assert load_layout(tmp_path / "window.toml").catalogue == "/a/stock"
    text = (tmp_path / "window.toml").read_text(encoding="utf-8")
    (tmp_path / "old.toml").write_text(
        "\n".join(line for line in text.splitlines() if "catalogue" not in line), encoding="utf-8"
    )
    assert load_layout(tmp_path / "old.toml").catalogue == ""


# --- the panel's actions --------------------------------------------------------------------------


def settled(actions):
    until_s = time.monotonic() + LIMIT_S
    actions.each_frame()
    while actions.searching and time.monotonic() < until_s:
        time.sleep(0.005)
        actions.each_frame()


@pytest.fixture
def actions(tmp_path):
    made = CatalogueActions(
        Model(State.initial()), lambda *given: asked.append(given), lambda: None
    )
    asked: list = []
    made.asked_for = asked
    made.take(open_of(tmp_path / "stock"))
    settled(made)
    return made


def test_the_last_typed_query_is_the_one_that_shows(actions):
    for text in ("gloss 60 > 89", "gloss 60 > 88", "gloss 60 > 87"):
        actions.ask(text)
        actions.each_frame()
    settled(actions)
    rows = (made_catalogue.row_of(k) for k in range(COUNT))
    assert actions.found.total == sum(1 for row in rows if (row["gloss_60"] or 0.0) > 87)


def test_a_fault_keeps_the_last_result_and_an_end_of_it_searches_again(actions):
    actions.ask("gloss 60 > 89")
    settled(actions)
    count = actions.found.total
    actions.ask("gloss 60 >")
    settled(actions)
    assert actions.fault is not None
    assert actions.found.total == count
    actions.ask("")
    settled(actions)
    assert actions.fault is None
    assert actions.found.total == COUNT > count


def test_a_fault_that_only_the_catalogue_knows_has_its_place_too(actions):
    actions.ask('gloss 60 > 10 and nearest to "nowhere.csv"')
    settled(actions)
    assert actions.asked.text[actions.fault.at : actions.fault.end] == '"nowhere.csv"'


def test_an_order_in_the_text_goes_before_the_list():
    assert Asked("sort by haze", "name").query == "sort by haze"
    assert Asked("gloss 60 > 40,", "name").query == "gloss 60 > 40, sort by name"
    for sort in catalogues.SORTS:
        Asked("gloss 60 > 40 first 5", sort)  # each phrase is of the language
        assert Asked("gloss 60 > 40 first 5", sort).query


def test_an_item_becomes_a_sample_by_its_material_file(actions):
    hit = next(h for h in actions.found.hits if h.path == made_catalogue.row_of(0)["path"])
    actions.set("reference", hit)
    ((file, side, finish),) = actions.asked_for
    assert Path(file) == actions.material_file(hit)
    assert (side, finish) == ("reference", "")


# --- pictures -------------------------------------------------------------------------------------


class FakeTexture:
    made = 0

    def __init__(self):
        FakeTexture.made += 1
        self.glo, self.released = FakeTexture.made, False

    def build_mipmaps(self):
        pass

    def release(self):
        self.released = True


class FakeContext:
    def texture(self, size, components, pixels):
        assert pixels.shape == (*size[::-1], components)
        return FakeTexture()


PICTURE = np.zeros((4, 6, 3), np.uint8)


def test_a_frame_uploads_few_pictures_and_old_ones_make_room():
    kept, ctx = thumbnails.Thumbnails(most=20), FakeContext()
    names = [f"{k}" for k in range(50)]
    kept.give(dict.fromkeys(names, PICTURE))
    frames = 0
    while kept.waiting:
        assert kept.upload(ctx) <= thumbnails.MOST_IN_A_FRAME
        frames += 1
        assert kept.count <= 20
    assert frames >= 50 / thumbnails.MOST_IN_A_FRAME
    assert kept.texture("49")
    assert kept.texture("0") == 0
    assert kept.take_wanted() == ["0"]


def test_what_shows_stays_however_much_it_is():
    kept, ctx = thumbnails.Thumbnails(most=5), FakeContext()
    names = [f"{k}" for k in range(30)]
    kept.give(dict.fromkeys(names, PICTURE))
    for _ in range(40):
        for name in names:
            kept.texture(name)
        kept.upload(ctx)
    assert all(kept.texture(name) for name in names)


def test_an_item_without_a_picture_is_not_asked_for_again():
    kept = thumbnails.Thumbnails()
    kept.give({"a": None})
    assert kept.texture("a") is None
    assert kept.take_wanted() == []


def test_a_damaged_picture_is_none_and_a_huge_one_is_made_small():
    from PIL import Image

    whole = made_catalogue.png_of(7)
    assert catalogue_files.decoded(whole).shape == (128, 128, 3)
    for damaged in (b"", None, whole[:200], b"\x89PNG\r\n\x1a\n" + b"x" * 40, b"GIF89a"):
        assert catalogue_files.decoded(damaged) is None
    held = io.BytesIO()
    Image.new("L", (4000, 1000)).save(held, "PNG")
    assert catalogue_files.decoded(held.getvalue()).shape == (128, 512, 3)


# --- words ----------------------------------------------------------------------------------------


def test_a_tooltip_has_every_reading_with_its_error_and_every_warning(actions):
    hit = next(h for h in actions.found.hits if h.row["quality"] == "poor")
    text = catalogues.tooltip_of(hit, actions.found)
    row = hit.row
    assert f"Gloss 60°: {row['gloss_60']:.1f} ± 0.4 GU" in text
    assert f"Gloss 20°: {row['gloss_20']:.1f} ± 0.5 GU" in text
    assert "! the highlight was not measured\n! few angles" in text
    assert "The fit is poor" in text
    good = next(h for h in actions.found.hits if h.row["quality"] == "good")
    assert "!" not in catalogues.tooltip_of(good, actions.found)


def test_words_of_a_hostile_name_are_one_line(actions):
    import dataclasses

    hit = actions.found.hits[0]
    row = dict(hit.row, name="a\nb\x1b[31m##c%s", source="x" * 10_000)
    hostile = dataclasses.replace(hit, row=row)
    assert "\n" not in catalogues.title_of(row)
    assert "\x1b" not in catalogues.tooltip_of(hostile, actions.found)
    assert len(catalogues.tooltip_of(hostile, actions.found)) < 1500


def test_the_line_under_a_name_has_what_was_asked_for(actions):
    actions.ask("gloss 20 > 1 and looks 0.9 x as glossy as mill-0/sheet-00000.csv at 60 degrees")
    settled(actions)
    hit = actions.found.hits[0]
    text = catalogues.numbers_of(hit, actions.found)
    assert text == f"20°: {hit.row['gloss_20']:.1f}  {hit.numbers['ratio']:.2f} x"
    failed = catalogues.numbers_of(
        next(h for h in settled_on(actions, "failed").hits), actions.found
    )
    assert failed == "failed"


def settled_on(actions, text):
    actions.ask(text)
    settled(actions)
    return actions.found
