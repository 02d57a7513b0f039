"""`relgloss catalogue search` on a catalogue that `relgloss catalogue build` has made."""

from __future__ import annotations

import json

import pytest
from PIL import Image

from relgloss_view.catalogue.catalogue import Catalogue
from relgloss_view.catalogue.columns import NAMES
from relgloss_view.cli import main
from relgloss_view.gloss.match import gloss_of
from relgloss_view.material.files import save_material
from relgloss_view.picture.scene.sample import SAMPLES, load_sample


@pytest.fixture(scope="module")
def stock(tmp_path_factory):
    """A catalogue of the four papers and a file that is no material."""
    tree = tmp_path_factory.mktemp("tree")
    for name in SAMPLES:
        save_material(load_sample(name), tree / f"{name}.json")
    (tree / "broken.json").write_text('{"format": "relgloss-material", "version": 1}')
    folder = tree.parent / "stock"
    words = ["catalogue", "build", str(tree), "-o", str(folder), "--workers", "1", "--keep-going"]
    main(words)
    return folder


def run(capsys, *words):
    """Exit status, standard output and standard error."""
    capsys.readouterr()
    status = main(["catalogue", "search", *map(str, words)])
    return status, *capsys.readouterr()


def test_table(capsys, stock):
    status, text, _ = run(capsys, stock, "gloss 75 above 20 sort by gloss 75 descending")
    assert status == 0
    lines = text.splitlines()
    assert lines[0] == "3 hits of 5 files, by gloss 75, highest first:"
    order = [line.split()[1] for line in lines[3:6]]
    assert order == ["cast-coated.json", "art-coated.json", "matte-coated.json"]
    assert "1 row was left out because a value is missing: gloss 75 in 1." in text


def test_words_need_no_quotes_of_the_shell(capsys, stock):
    assert run(capsys, stock, "gloss", "75", "above", "20")[1].startswith("3 hits of 5")


def test_what_failed_is_listed_with_its_fault(capsys, stock):
    text = run(capsys, stock, "failed")[1]
    fault = Catalogue.open(stock).row("broken.json")["fault"]
    assert len(fault) > 10
    [line] = [line for line in text.splitlines() if "broken.json" in line]
    assert fault in line


def test_a_long_list_is_left_to_the_page(capsys, stock, tmp_path, monkeypatch):
    monkeypatch.setattr("relgloss_view.commands.catalogue_search.LIMIT", 2)
    page = tmp_path / "hits.html"
    text = run(capsys, stock, "--limit", "0", "--page", page)[1]
    assert "... and 3 more on the page" in text
    assert "uncoated.json" in page.read_text(encoding="utf-8")
    assert "uncoated.json" in run(capsys, stock, "--limit", "0")[1]


def test_json(capsys, stock):
    status, text, _ = run(capsys, stock, "looks 0.7 x as glossy as cast-coated", "--json")
    content = json.loads(text)
    assert status == 0
    best = content["hits"][0]
    assert best["path"] == "art-coated.json"
    assert set(best) == {"rank", "numbers", *NAMES} - {"thumbnail"}
    ratio = gloss_of(load_sample("art-coated")) / gloss_of(load_sample("cast-coated"))
    assert best["numbers"]["ratio"] == pytest.approx(ratio, rel=1e-12)


def test_nearest_with_sheet_and_proofs(capsys, stock, tmp_path):
    sheet, proofs = tmp_path / "hits.png", tmp_path / "proofs"
    words = ("nearest to art-coated", "--limit", 2, "-o", sheet, "--proofs", proofs)
    status, text, _ = run(capsys, stock, *words)
    assert status == 0
    assert "drawn anew" in text
    assert "2 proofs," in text
    with Image.open(sheet) as image:
        assert image.text["Title"] == "nearest to art-coated"
    listed = json.loads((proofs / "proofs.json").read_text())["proofs"]
    assert listed[0]["path"] == "art-coated.json"
    assert sorted(p.name for p in proofs.iterdir()) == sorted(
        ["proofs.json", *(one["file"] for one in listed)]
    )
    # The next search replaces them; a file of the user's stays, and is no proof's place.
    (proofs / "mine.txt").write_text("mine")
    run(capsys, stock, "name contains uncoated", "--quick", "--proofs", proofs)
    left = sorted(p.name for p in proofs.iterdir())
    assert left == ["001-uncoated.html", "mine.txt", "proofs.json"]


def test_page_leads_to_the_proofs(capsys, stock, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    status, text, _ = run(
        capsys, stock, "name contains art-coated", "--page", "hits.html", "--proofs", "proofs"
    )
    assert status == 0
    assert "hits.html: page of the hits" in text
    page = (tmp_path / "hits.html").read_text()
    assert 'href="./proofs/001-art-coated.html"' in page
    assert (tmp_path / "proofs" / "001-art-coated.html").is_file()


def test_no_hits_are_no_fault(capsys, stock, tmp_path):
    sheet = tmp_path / "none.png"
    status, text, error = run(capsys, stock, "gloss 75 above 2000", "-o", sheet)
    assert (status, error) == (0, "")
    assert text.startswith("No hits: none of 5 files meets the query.")
    assert sheet.is_file()


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (["gloss 75 above 40,5"], "query, character 16 ('40,5')"),
        (["nearest to art-coatedd"], "did you mean art-coated"),
        (["nearest to broken.json"], "broken.json failed"),
        (["failed", "-o", "hits.jpg"], "-o: expected a name that ends in .png"),
        (["failed", "--page", "hits"], "--page: expected a name that ends in .html"),
        (["failed", "--proofs", "."], "holds files"),
    ],
)
def test_faults_are_one_line(capsys, stock, words, line):
    status, text, error = run(capsys, stock, *words)
    assert (status, text) == (1, "")
    assert line in error
    assert error.count("\n") == 1


def test_other_folders_are_refused(capsys, tmp_path):
    status, _, error = run(capsys, tmp_path, "failed")
    assert status == 1
    assert "is no catalogue" in error


def test_a_fault_leaves_nothing(capsys, stock, tmp_path):
    """The second output can't be written, so the first is not there either."""
    (tmp_path / "taken").mkdir()
    (tmp_path / "taken" / "mine.txt").write_text("mine")
    sheet = tmp_path / "hits.png"
    words = (stock, "kind material", "-o", sheet, "--proofs", tmp_path / "taken")
    status, _, error = run(capsys, *words)
    assert status == 1
    assert "holds files" in error
    assert not sheet.exists()
    assert [p.name for p in (tmp_path / "taken").iterdir()] == ["mine.txt"]
