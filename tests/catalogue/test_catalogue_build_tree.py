"""What a tree holds, whatever its names are, and where each material lies."""

from __future__ import annotations

import math
import os
import unicodedata

import pytest
from catalogue_trees import BROKEN_TABLE, quick_item, save, small_table
from hypothesis import given, settings
from hypothesis import strategies as st

from relgloss_view.base.decoration import VARIABLE
from relgloss_view.base.errors import InputError
from relgloss_view.base.resources import asset
from relgloss_view.catalogue import build as building
from relgloss_view.catalogue import tree as trees
from relgloss_view.catalogue import work
from relgloss_view.catalogue.build import BuildOptions, build
from relgloss_view.catalogue.catalogue import Catalogue, recipe_of
from relgloss_view.catalogue.item import Fitted
from relgloss_view.catalogue.places import LONGEST_PATH, material_places
from relgloss_view.catalogue.recipe import Recipe
from relgloss_view.catalogue.table import read_rows, write_table
from relgloss_view.catalogue.tree import scan
from relgloss_view.catalogue.work import close_renderer, make_item
from relgloss_view.gloss.meter.meter import gloss_readings
from relgloss_view.material.files import load_material
from relgloss_view.material.material import Diffuse, Lobe, Material
from relgloss_view.measure.bands import RGB

HOSTILE = [
    "line\nbreak.json",
    "\x1b[31mred.json",
    "quote\"s'and<b>.json",
    "nul.json",
    "trailing .json",
    "%41.json",
    "A.json",
    "a.json",
    "café.json",
    unicodedata.normalize("NFD", "café.json"),
    "\u202egnp.json",
    "x" * 240 + ".json",
    "=cmd.json",
    "-o.json",
    os.fsdecode(b"\xff\xfe.json"),
    "\\xff\\xfe.json~15f7e6f5",
    "\\xff\\xfe.json",
]


def paths_of(folder):
    return [entry.path for entry in scan(folder).entries]


def test_kinds_are_found_by_content(tmp_path):
    small_table(tmp_path / "readings.dat")
    save(tmp_path / "deep" / "deeper" / "paper.mat")
    (tmp_path / "broken.csv").write_text(BROKEN_TABLE, encoding="utf-8")
    (tmp_path / "notes.csv").write_text("date,author\n1,2\n", encoding="utf-8")
    (tmp_path / "other.json").write_text('{"format": "something"}', encoding="utf-8")
    (tmp_path / "late.json").write_text(
        '{"note": "' + 100_000 * "x" + '", "format": "relgloss-material"}', encoding="utf-8"
    )
    (tmp_path / "empty.csv").write_bytes(b"")
    (tmp_path / ".git").mkdir()
    save(tmp_path / ".git" / "hidden.json")
    found = scan(tmp_path)
    assert [(entry.path, entry.kind) for entry in found.entries] == [
        ("broken.csv", "table"),
        ("deep/deeper/paper.mat", "material"),
        ("late.json", "material"),
        ("readings.dat", "table"),
    ]
    assert found.passed_over == 3


def test_links_are_followed_once_and_never_in_a_circle(tmp_path):
    tree, other = tmp_path / "tree", tmp_path / "other"
    save(tree / "a" / "paper.json")
    save(other / "board.json")
    (tree / "a" / "round").symlink_to(tree)
    (tree / "same").symlink_to(tree / "a")
    (tree / "other").symlink_to(other)
    (other / "back").symlink_to(other)
    (tree / "gone.json").symlink_to(tmp_path / "nothing")
    (tree / "linked.json").symlink_to(other / "board.json")
    (tree / "up").symlink_to("..")
    (tree / "ring.json").symlink_to(tree / "gnir.json")
    (tree / "gnir.json").symlink_to(tree / "ring.json")
    os.mkfifo(tree / "pipe.json")
    assert paths_of(tree) == ["a/paper.json", "linked.json", "other/board.json"]


def test_a_root_that_is_no_folder_is_refused(tmp_path):
    for name in ("missing", "file"):
        (tmp_path / "file").write_bytes(b"")
        with pytest.raises(InputError, match=f"{name}: is no folder"):
            scan(tmp_path / name)


def test_what_can_not_be_read_is_a_fault(tmp_path, monkeypatch):
    """Whoever runs the tests may read everything: the system's answer is made up."""
    save(tmp_path / "secret.json")
    save(tmp_path / "open.json")
    real = trees.open_regular

    def refusing(path, expected):
        if os.fspath(path).endswith("secret.json"):
            raise InputError(f"{path}: can't be read (Permission denied)")
        return real(path, expected)

    monkeypatch.setattr(trees, "open_regular", refusing)
    found = {entry.path: entry for entry in scan(tmp_path).entries}
    assert found["open.json"].fault == ""
    assert found["secret.json"].sha256 == ""
    assert "Permission denied" in found["secret.json"].fault
    assert str(tmp_path) not in found["secret.json"].fault
    monkeypatch.setattr(building, "make_item", quick_item)
    report = build(tmp_path, tmp_path.with_name("out"), options=BuildOptions(keep_going=True))
    assert (report.done, report.failed) == (1, 1)


def test_hostile_names_are_built_and_found_again(tmp_path, monkeypatch):
    monkeypatch.setattr(building, "make_item", quick_item)
    for k, name in enumerate(HOSTILE):
        save(tmp_path / "tree" / f"lot {k % 3}." / name, name=f"stock {k}")
    report = build(tmp_path / "tree", tmp_path / "catalogue")
    assert (report.done, report.failed) == (len(HOSTILE), 0)
    catalogue = Catalogue.open(tmp_path / "catalogue")
    assert len({row["path"] for row in catalogue.rows}) == len(HOSTILE)
    places = [row["material"] for row in catalogue.rows]
    assert len({place.casefold() for place in places}) == len(HOSTILE)
    for row in catalogue.rows:
        row["path"].encode("utf-8")
        assert catalogue.material(row["path"]).name == row["name"]
    assert build(tmp_path / "tree", tmp_path / "catalogue").worked == 0


def test_a_fault_names_no_folder(tmp_path):
    """The same file elsewhere has the same row, so a fault holds nothing of where it lies."""
    faults = set()
    for name in ("here", "there\nwith a line", "x" * 200 + "/" + "y" * 200):
        file = tmp_path / name / "broken.csv"
        file.parent.mkdir(parents=True)
        file.write_text(BROKEN_TABLE, encoding="utf-8")
        entry = scan(file.parent).entries[0]
        item = make_item(entry.file, entry.path, entry.kind, entry.sha256, Recipe())
        assert item.failed
        assert item.failed_in == "file"
        faults.add(item.row["fault"])
    assert len(faults) == 1
    assert "none" in faults.pop()


def test_a_file_that_changes_meanwhile_is_tried_again(tmp_path):
    file = save(tmp_path / "paper.json")
    entry = scan(tmp_path).entries[0]
    save(file, "cast")
    item = make_item(entry.file, entry.path, entry.kind, entry.sha256, Recipe())
    assert item.failed_in == "machine"
    assert "changed" in item.row["fault"]
    file.unlink()
    item = make_item(entry.file, entry.path, entry.kind, entry.sha256, Recipe())
    assert item.failed_in == "machine"
    with pytest.raises(InputError, match="no such folder here"):  # a machine without the share
        make_item("/nowhere/paper.json", entry.path, entry.kind, entry.sha256, Recipe())


def test_no_memory_is_a_fault_of_the_machine(tmp_path, monkeypatch):
    save(tmp_path / "paper.json")
    entry = scan(tmp_path).entries[0]

    def exhausted(*arguments):
        raise MemoryError

    monkeypatch.setattr("relgloss_view.catalogue.work.load_material", exhausted)
    item = make_item(entry.file, entry.path, entry.kind, entry.sha256, Recipe())
    assert (item.failed_in, item.failed) == ("machine", True)


def test_a_driver_that_fails_is_a_fault_of_the_machine(tmp_path, monkeypatch):
    """Kept as the file's own, it would fail in every build to come; its context is given up."""
    monkeypatch.delenv(VARIABLE, raising=False)
    save(tmp_path / "paper.json")
    entry = scan(tmp_path).entries[0]
    words = (entry.file, entry.path, entry.kind, entry.sha256, Recipe())

    def broken(*arguments, **options):
        work.renderer()
        raise RuntimeError("the device is lost")

    with monkeypatch.context() as lost:
        lost.setattr("relgloss_view.catalogue.look.draw", broken)
        item = make_item(*words)
    assert item.failed_in == "machine"
    assert "the device is lost" in item.row["fault"]
    assert item.fitted is not None
    before = work.renderer()
    assert not make_item(*words).failed
    assert work.renderer() is before
    with (
        monkeypatch.context() as lost
    ):  # negative control: what a file asks for stays its own fault
        lost.setattr("relgloss_view.catalogue.look.draw", refused)
        assert make_item(*words).failed_in == "look"
    assert work.renderer() is before


def refused(*arguments, **options):
    raise InputError("it can't be drawn")


def test_the_first_width_is_that_of_the_brightest_lobe():
    """A wide lobe of more light is not the one that a meter's distinctness is of."""
    body = Diffuse("lambert", (0.2, 0.2, 0.2))
    lobes = (Lobe((0.8,), 12.0), Lobe((0.5,), 1.5))
    material = Material("two", "by hand", RGB, body, lobes)
    facts = work.facts_of(material, Fitted({}))
    assert (facts["s_deg_1"], facts["s_deg_2"]) == (1.5, 12.0)
    distinct = {r.key: r.value for r in gloss_readings(material)}["distinctness"]
    assert distinct == pytest.approx(1.0 - math.sqrt(2.0) * math.radians(facts["s_deg_1"]))


def test_the_same_bytes_make_the_same_item_in_any_folder(tmp_path):
    for folder in ("a", "b/c"):
        path = tmp_path / folder / "art.json"
        path.parent.mkdir(parents=True)
        path.write_bytes(asset("materials", "art-coated.json").read_bytes())
    items = [
        make_item(entry.file, "x", entry.kind, entry.sha256, Recipe())
        for entry in scan(tmp_path).entries
    ]
    close_renderer()
    assert items[0] == items[1]
    assert not items[0].failed


NAMES = st.text(
    st.characters(blacklist_characters="/\0", blacklist_categories=("Cs",)),
    min_size=1,
    max_size=300,
).filter(lambda name: name not in (".", ".."))


@settings(max_examples=60)
@given(st.sets(st.lists(NAMES, min_size=1, max_size=6).map("/".join), max_size=12))
def test_places_differ_on_every_file_system(paths):
    places = material_places(paths)
    folded = {
        unicodedata.normalize("NFC", unicodedata.normalize("NFC", place).casefold())
        for place in places.values()
    }
    assert len(folded) == len(paths)
    for place in places.values():
        assert place.startswith("materials/")
        assert place.endswith(".json")
        assert len(place.encode()) <= LONGEST_PATH + 200
        for part in place.split("/"):
            assert 0 < len(part.encode()) <= 255
            assert not part.startswith(".")
            assert not part.endswith((".", " "))
            assert not {unicodedata.category(c) for c in part} & {"Cc", "Cf", "Cs", "Zl", "Zp"}
            assert not set(part) & set('<>:"\\|?*')
            assert part.split(".")[0].lower() not in ("con", "nul", "aux", "prn", "com1")
    # No place of a file is the folder of another.
    taken = set(places.values())
    for place in taken:
        parts = place.split("/")
        assert not any("/".join(parts[:k]) in taken for k in range(1, len(parts)))


def test_places_of_plain_names_are_plain():
    places = material_places(["lot 1/paper.csv", "lot 1/paper.json", "a.json/b.csv", "a.json"])
    assert places["lot 1/paper.csv"] == "materials/lot 1/paper.csv.json"
    assert places["lot 1/paper.json"] == "materials/lot 1/paper.json"
    assert places["a.json"] == "materials/a.json"
    assert places["a.json/b.csv"] == "materials/a%2Ejson/b.csv.json"


def test_a_material_outside_the_catalogue_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(building, "make_item", quick_item)
    save(tmp_path / "tree" / "paper.json")
    build(tmp_path / "tree", tmp_path / "catalogue")
    catalogue = Catalogue.open(tmp_path / "catalogue")
    assert load_material(catalogue.material_file("paper.json")).name
    for place in ("../../etc/passwd", "/etc/passwd", "materials\\..\\x"):
        catalogue.row("paper.json")["material"] = place
        with pytest.raises(InputError, match="outside"):
            catalogue.material("paper.json")


@pytest.mark.parametrize("content", [b"", b"PAR1", b"PAR1" + 200 * b"\0" + b"PAR1", b"text"])
def test_a_table_that_is_none_is_refused(tmp_path, monkeypatch, content):
    monkeypatch.setattr(building, "make_item", quick_item)
    save(tmp_path / "tree" / "paper.json")
    build(tmp_path / "tree", tmp_path / "catalogue")
    (tmp_path / "catalogue" / "catalogue.parquet").write_bytes(content)
    with pytest.raises(InputError, match="not the table of a catalogue"):
        Catalogue.open(tmp_path / "catalogue")


def test_files_named_as_tables_that_are_none_are_listed(tmp_path) -> None:
    """A table with headings that nobody knows is not lost in silence."""
    (tmp_path / "lot").mkdir()
    (tmp_path / "lot" / "invoice.csv").write_text("date;amount\n2026-01-01;12,50\n")
    (tmp_path / "README.md").write_text("# by lot\n")
    found = scan(tmp_path)
    assert found.passed_over == 2
    assert found.doubtful == ("lot/invoice.csv",)


def test_a_name_that_looks_like_one_of_no_text_has_another_path(tmp_path):
    """What stands for a name that is no UTF-8 may be the name of another file."""
    odd = os.fsdecode(b"a\xff.json")
    path = trees.text_of(odd)
    assert trees.text_of(path) != path
    assert trees.text_of("a\\xff.json") == "a\\xff.json"  # the control: a plain backslash


@pytest.mark.parametrize(
    "change",
    [{"gloss": [60]}, {"gloss": "gloss-61"}, {"thumbnail_px": 10**9}, {"thumbnail_px": True},
     {"reference": 3}, {"reference_c": "1"}, {"reference_sigma_n_deg": None}, {"fit": [1]}],
)  # fmt: skip
def test_a_recipe_of_wrong_values_is_refused(change, tmp_path):
    recipe_of(Recipe().as_json(), tmp_path)  # the control
    with pytest.raises(InputError, match="holds no recipe"):
        recipe_of({**Recipe().as_json(), **change}, tmp_path)


@pytest.mark.parametrize("value", [float("nan"), float("inf"), 1e308])
def test_numbers_that_no_build_writes_are_read_as_empty(value, tmp_path):
    path = tmp_path / "catalogue.parquet"
    rows = [{"path": "a", "gloss_60": value}, {"path": "b", "gloss_60": 40.0}]
    write_table(path, rows, {}, path)
    assert [row["gloss_60"] for row in read_rows(path)] == [None, 40.0]
