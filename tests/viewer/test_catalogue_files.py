"""Catalogues as files of the window, and what its panel knows, without a window."""

from __future__ import annotations

import dataclasses
import io
import json
import os
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import ClassVar

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / "scripts"))
import made_catalogue

from relgloss_view.base.errors import InputError
from relgloss_view.catalogue.query.search import Searcher
from relgloss_view.viewer.drawing import thumbnails
from relgloss_view.viewer.files import catalogue_files
from relgloss_view.viewer.files.background import Outcome
from relgloss_view.viewer.files.exact_search import ExactSearch
from relgloss_view.viewer.files.open_job import OpenJob
from relgloss_view.viewer.shell import catalogue_actions
from relgloss_view.viewer.shell.catalogue_actions import CatalogueActions
from relgloss_view.viewer.state import catalogues
from relgloss_view.viewer.state.catalogues import Asked, OpenCatalogue
from relgloss_view.viewer.state.layout_file import WindowLayout, load_layout, save_layout
from relgloss_view.viewer.state.model import Model
from relgloss_view.viewer.state.state import State

COUNT = 40
LIMIT_S = 120.0


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


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no pipes with names")
def test_a_pipe_in_the_place_of_the_mark_is_not_waited_for(tmp_path):
    from relgloss_view.catalogue.catalogue import Catalogue

    os.mkfifo(tmp_path / "catalogue.json")
    faults = []

    def open_it():
        with pytest.raises(InputError) as fault:
            Catalogue.open(tmp_path)
        faults.append(str(fault.value))

    opener = threading.Thread(target=open_it, daemon=True)
    opener.start()
    opener.join(LIMIT_S)
    assert "is no catalogue" in "".join(faults)


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
    asked: list = []
    proofs: list = []
    made = CatalogueActions(
        Model(State.initial()), lambda *given: asked.append(given), proofs.append, lambda: None
    )
    made.asked_for, made.proofs = asked, proofs
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


def test_a_proof_is_asked_for_with_the_reference_of_the_search(actions):
    hit = actions.found.hits[0]
    actions.write_proof(hit)
    actions.write_proof(next(h for h in actions.found.hits if h.row["status"] == "failed"))
    text = "looks 0.9 x as glossy as matte-coated at 60 degrees"
    found = settled_on(actions, text)
    (hit,) = (one for one in found.hits if one.path == hit.path)
    actions.write_proof(hit)
    first, second = actions.proofs  # a failed item has none
    assert first.name == second.name == hit.name
    assert "the catalogue's reference, cast-coated" in first.words
    assert "the reference of your search, built-in matte-coated" in second.words
    assert first.note == ""
    assert second.note == f"Hit {hit.rank} of the query: {text}"


@pytest.mark.slow
@pytest.mark.parametrize("text", ["gloss 60 > 89.9", "nearest to mill-0/sheet-00000.csv first 1"])
def test_a_proof_of_an_item_is_that_of_the_command(text, actions, tmp_path):
    from relgloss_view.catalogue.proofs import write_proofs
    from relgloss_view.proof.read import read_proof
    from relgloss_view.quality.backends import open_renderer
    from relgloss_view.viewer.files.proof_writing import ProofRequest, written

    found = settled_on(actions, text)
    (hit,) = found.hits
    actions.write_proof(hit)
    (pair,) = actions.proofs
    file = str(tmp_path / "own.html")
    written(ProofRequest(file, State.initial(), pair.note, title=pair.name, make=pair.make))
    with open_renderer("auto") as renderer:
        (made,) = write_proofs(found, actions.opened.catalogue, tmp_path, renderer)
    own, theirs = read_proof(file), read_proof(tmp_path / made.file)
    for part in ("title", "names", "pictures", "meter", "grid", "display"):
        assert own.content[part] == theirs.content[part]
    mine, other = own.messages[0], theirs.messages[0]
    assert mine.note == other.note
    assert (mine.settings.test, mine.settings.reference) == (
        other.settings.test, other.settings.reference
    )  # fmt: skip
    assert mine.settings.reference.c > 0.0
    # The control: the window's own pair has other pictures.
    written(ProofRequest(file, State.initial(), title=pair.name))
    assert read_proof(file).content["pictures"] != theirs.content["pictures"]


class FakeDrawing:
    """An exact search that turns the order of thumbnails round when it is let go."""

    made: ClassVar[list[FakeDrawing]] = []

    def __init__(self, opened, query):
        self.query, self.go, self.stopped = query, threading.Event(), False
        self.made.append(self)

    def run(self, preliminary, progress):
        assert self.go.wait(LIMIT_S)
        return dataclasses.replace(preliminary, hits=preliminary.hits[::-1], is_exact=True)

    def stop(self):
        self.stopped = True
        self.go.set()


@pytest.fixture
def drawings(monkeypatch):
    monkeypatch.setattr(catalogue_actions, "ExactSearch", FakeDrawing)
    monkeypatch.setattr(FakeDrawing, "made", [])
    return FakeDrawing.made


def refined(actions):
    until_s = time.monotonic() + LIMIT_S
    while not actions._refine._ended and time.monotonic() < until_s:
        time.sleep(0.005)
    actions.each_frame()


NEAREST = "nearest to mill-0/sheet-00000.csv"


def test_the_order_of_thumbnails_is_preliminary_until_pictures_are_drawn(actions, drawings):
    settled_on(actions, "gloss 60 > 80")
    assert not drawings  # no picture is compared
    first = settled_on(actions, NEAREST)
    (drawing,) = drawings
    assert drawing.query == NEAREST
    assert actions.refining
    assert not first.is_exact
    drawing.go.set()
    actions.held = True  # a menu is open on a tile
    refined(actions)
    assert actions.found is first
    actions.each_frame()
    assert actions.found.is_exact
    assert actions.found.hits == first.hits[::-1]
    assert not actions.refining


def test_another_query_ends_the_drawing_of_the_last(actions, drawings):
    settled_on(actions, NEAREST)
    other = settled_on(actions, "gloss 60 > 80")
    (drawing,) = drawings
    assert drawing.stopped
    assert not actions.refining
    actions.each_frame()
    assert actions.found is other
    settled_on(actions, NEAREST)
    actions.close()
    assert drawings[1].stopped


def test_whoever_comes_back_to_a_query_gets_its_exact_order(actions, drawings):
    settled_on(actions, NEAREST)
    actions.ask("gloss 60 >")  # a fault, which is not searched for
    assert drawings[0].stopped
    settled_on(actions, NEAREST)
    assert actions.refining
    drawings[1].go.set()
    refined(actions)
    assert actions.found.is_exact


def test_where_no_picture_can_be_drawn_the_order_stays_with_one_line(actions, drawings):
    first = settled_on(actions, NEAREST)
    drawings[0].run = None  # the control below would be met by a result, too
    actions._refine._ended.append(Outcome(None, None, "no OpenGL"))
    actions.each_frame()
    assert actions.found is first
    assert not actions.refining
    assert [note.text for note in actions.model.notes if note.fault] == ["no OpenGL"]


@pytest.mark.slow
def test_the_exact_order_is_that_of_the_command(tmp_path):
    from relgloss_view.material.files import save_material
    from relgloss_view.picture.scene.sample import SAMPLES, load_sample

    (tmp_path / "tree").mkdir()
    for name in SAMPLES:
        for k in range(4):
            sample = load_sample(name)
            lobes = [
                dataclasses.replace(lobe, s_deg=lobe.s_deg * (1 - 0.1 * k))
                for lobe in sample.specular
            ]
            material = dataclasses.replace(sample, name=f"{name} {k}", specular=tuple(lobes))
            save_material(material, tmp_path / "tree" / f"{name}-{k}.json")
    command = [sys.executable, "-m", "relgloss_view.cli", "catalogue"]
    stock, query = str(tmp_path / "stock"), "nearest to matte-coated"
    subprocess.run([*command, "build", str(tmp_path / "tree"), "-o", stock], check=True)
    words = [*command, "search", stock, query, "--limit", "0", "--json"]
    printed = subprocess.run(words, check=True, capture_output=True, text=True).stdout
    hits = json.loads(printed)["hits"]
    opened = catalogue_files.opened_catalogue(stock)
    first = catalogues.searched(opened, Asked(query))
    found = ExactSearch(opened, query).run(first, lambda share, text: None)
    assert [hit.path for hit in found.hits] == [hit["path"] for hit in hits]
    assert [dict(hit.numbers) for hit in found.hits] == [hit["numbers"] for hit in hits]
    # The control: thumbnails know only one of the numbers.
    assert [dict(hit.numbers) for hit in first.hits] != [hit["numbers"] for hit in hits]
    old = dataclasses.replace(opened, stamp=(0, 0))
    with pytest.raises(InputError, match="was built again; Reload it"):
        ExactSearch(old, query).run(first, lambda share, text: None)


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


def test_an_error_is_never_shown_as_nothing(actions):
    """A fit of clean data has an error of 0.004 GU, and "± 0.0" would be a claim."""
    hit = next(h for h in actions.found.hits if h.row["quality"] == "good")
    small = dataclasses.replace(
        hit, row={**hit.row, "gloss_60": 22.4, "gloss_60_se": 0.004, "distinctness_se": 1e-5}
    )
    text = catalogues.tooltip_of(small, actions.found)
    assert "Gloss 60°: 22.4 ± 0.1 GU" in text
    assert "± 0.0" not in text.replace("± 0.001", "").replace("± 0.01", "")


def test_the_report_counts_what_failed(actions):
    failed = sum(made_catalogue.is_failed(k) for k in range(COUNT))
    assert actions.model.notes[-1].text.endswith(f": {COUNT} items, {failed} failed")


def test_one_item_lacks_and_two_lack(actions):
    for left_out, words in ((1, "; 1 lacks a value"), (2, "; 2 lack a value")):
        found = dataclasses.replace(actions.found, left_out=left_out)
        assert words in catalogues.found_words(found, actions.opened)


def test_words_of_a_hostile_name_are_one_line(actions):
    hit = actions.found.hits[0]
    row = dict(hit.row, name="a\nb\x1b[31m##c%s", source="x" * 10_000)
    hostile = dataclasses.replace(hit, row=row)
    assert "\n" not in catalogues.title_of(row)
    assert "\x1b" not in catalogues.tooltip_of(hostile, actions.found)
    assert len(catalogues.tooltip_of(hostile, actions.found)) < 1500


def test_the_line_under_a_name_has_what_was_asked_for(actions, drawings):
    actions.ask("gloss 20 > 1 and looks 0.9 x as glossy as mill-0/sheet-00000.csv at 60 degrees")
    settled(actions)
    hit = actions.found.hits[0]
    text = catalogues.numbers_of(hit, actions.found)
    assert text == f"20°: {hit.row['gloss_20']:.1f}  {hit.numbers['ratio']:.2f} x"
    failed = catalogues.numbers_of(
        next(h for h in settled_on(actions, "failed").hits), actions.found
    )
    assert failed == "line 3: not a number"
    near = settled_on(actions, NEAREST).hits[1]
    assert "dE about" in catalogues.numbers_of(near, actions.found)
    exact = dataclasses.replace(near, numbers={**near.numbers, "picture_mean": 1.0})
    assert "about" not in catalogues.numbers_of(exact, actions.found)


def settled_on(actions, text):
    actions.ask(text)
    settled(actions)
    return actions.found
