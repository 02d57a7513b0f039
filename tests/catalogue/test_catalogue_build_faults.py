"""Builds on machines that refuse something: no rights, no drive, no locks, no memory."""

from __future__ import annotations

import errno
import os
import subprocess
import sys

import pytest
from catalogue_trees import contents, quick_item, quick_tree, save

from relgloss_view import cli
from relgloss_view.base.errors import InputError
from relgloss_view.catalogue import build as building
from relgloss_view.catalogue import folder, store, table
from relgloss_view.catalogue import tree as scanning
from relgloss_view.catalogue.build import BuildOptions, build
from relgloss_view.catalogue.catalogue import Catalogue
from relgloss_view.catalogue.cluster_processes import _faults_of_start
from relgloss_view.catalogue.store import put_whole
from relgloss_view.catalogue.tree import scan, text_of

GOING_ON = BuildOptions(keep_going=True)


@pytest.fixture(autouse=True)
def quick(monkeypatch):
    """The digests of the files that were worked on."""
    worked = []

    def item(*arguments):
        worked.append(arguments[3])
        return quick_item(*arguments)

    monkeypatch.setattr(building, "make_item", item)
    return worked


def refusing(monkeypatch, name):
    """Folders of this name can't be listed. The tests may run as root, whom no mode keeps out."""
    listed = os.scandir

    def scandir(path):
        if not isinstance(path, int) and os.path.basename(path) == name:
            raise PermissionError(errno.EACCES, "Permission denied")
        return listed(path)

    monkeypatch.setattr(os, "scandir", scandir)


def test_a_folder_that_is_away_for_a_day_costs_no_fit(quick, tmp_path, monkeypatch):
    tree = quick_tree(tmp_path / "tree")
    build(tree, tmp_path / "stock")
    expected = contents(tmp_path / "stock")
    with monkeypatch.context() as refused:
        refusing(refused, "lot 1")
        report = build(tree, tmp_path / "stock", options=GOING_ON)
        assert report.faults == ["lot 1: can't be read (Permission denied); mend its permissions"]
        assert (report.rows, report.done, report.failed) == (4, 4, 0)
        assert "1 folder not read" in "\n".join(building.words_of(report, "stock"))
    quick.clear()
    build(tree, tmp_path / "stock")
    assert quick == []
    assert contents(tmp_path / "stock") == expected
    # A folder that has gone for good takes its records with it.
    for path in (tree / "lot 1").iterdir():
        path.unlink()
    build(tree, tmp_path / "stock")
    assert len([*(tmp_path / "stock").glob("items/*/*")]) == 4


def test_a_drive_that_is_not_there_empties_no_catalogue(tmp_path):
    tree = quick_tree(tmp_path / "tree")
    build(tree, tmp_path / "stock")
    expected = contents(tmp_path / "stock")
    tree.rename(tmp_path / "away")
    tree.mkdir()
    with pytest.raises(InputError, match=r"the catalogue has 6 files of it; check that its drive"):
        build(tree, tmp_path / "stock")
    assert contents(tmp_path / "stock") == expected
    assert build(tree, tmp_path / "new").rows == 0


def test_a_tree_that_is_too_deep_is_a_fault_and_not_silent(tmp_path, monkeypatch):
    monkeypatch.setattr(scanning, "MOST_DEPTH", 5)
    place = tmp_path / "tree"
    for _ in range(6):
        place = place / "d"
    save(place / "deep.json")
    assert (
        scan(tmp_path / "tree")
        .faults[0]
        .endswith("d/d/d/d/d: more than 5 folders within each other; move it up")
    )
    assert scan(place.parent).faults == ()


def test_a_file_that_goes_during_the_scan_is_no_fault(tmp_path, monkeypatch):
    tree = quick_tree(tmp_path / "tree", 2)
    looked_at = os.stat

    def stat(path, **options):
        if str(path).endswith("stock-1.json"):
            raise FileNotFoundError(errno.ENOENT, "No such file or directory", path)
        return looked_at(path, **options)

    monkeypatch.setattr(os, "stat", stat)
    found = scan(tree)
    assert [entry.path for entry in found.entries] == ["lot 0/stock-0.json"]
    assert found.entries[0].fault == ""


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (("", "-o", "stock"), "an empty name; give the folder of samples"),
        (("tree", "-o", "circle"), "-o circle: is a link that leads nowhere"),
        (("tree", "-o", "n" * 300), "can't be written (File name too long)"),
    ],
)
def test_names_that_mean_nothing_are_one_line(words, line, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    quick_tree(tmp_path / "tree", 1)
    os.symlink("circle", "circle")
    assert cli.main(["catalogue", "build", "--workers", "1", *words]) == 1
    err = capsys.readouterr().err
    assert line in err
    assert err.count("\n") == 1
    assert sorted(os.listdir(tmp_path)) == ["circle", "tree"]


def test_two_builds_without_locks_give_the_bytes_of_one(tmp_path, monkeypatch):
    """Some network drives have no locks: the second build comes in, and harms nothing."""

    def refused(*_):
        raise OSError(errno.ENOLCK, "No locks available")

    tree = quick_tree(tmp_path / "tree")
    build(tree, tmp_path / "alone")
    monkeypatch.setattr(folder.fcntl, "flock", refused)
    inside = []
    replace = os.replace

    def second_build(source, target):
        if not inside:
            inside.append(target)  # while the first one's file is written and not in its place
            build(tree, tmp_path / "stock")
        replace(source, target)

    monkeypatch.setattr(store.os, "replace", second_build)
    build(tree, tmp_path / "stock")
    assert inside
    assert contents(tmp_path / "stock") == contents(tmp_path / "alone")


@pytest.mark.parametrize(
    ("number", "remedy"),
    [(errno.ENOSPC, "make room there"), (errno.EACCES, "mend its permissions")],
)
def test_what_is_not_written_has_a_remedy_of_its_own(number, remedy, tmp_path, monkeypatch):
    def refused(source, target):
        raise OSError(number, os.strerror(number), os.fspath(source))

    monkeypatch.setattr(os, "replace", refused)
    with pytest.raises(InputError, match=remedy):
        put_whole(tmp_path / "stock" / "items" / "record.json", b"{}", tmp_path / "stock")


def test_a_catalogue_that_may_not_be_read_is_called_so(tmp_path, monkeypatch):
    from pathlib import Path

    def refused(*_):
        raise PermissionError(errno.EACCES, "Permission denied")

    build(quick_tree(tmp_path / "tree", 1), tmp_path / "stock")
    monkeypatch.setattr(Path, "open", refused)
    with pytest.raises(InputError, match=r"stock: can't be read \(Permission denied\); ask its"):
        Catalogue.open(tmp_path / "stock")


def test_counts_that_no_build_writes_take_no_memory(tmp_path, monkeypatch):
    build(quick_tree(tmp_path / "tree", 3), tmp_path / "stock")
    assert len(Catalogue.open(tmp_path / "stock").rows) == 3
    monkeypatch.setattr(table, "MOST_ROWS", 2)
    with pytest.raises(InputError, match=r"catalogue\.parquet: .* counts of rows can't be right"):
        Catalogue.open(tmp_path / "stock")


@pytest.mark.slow  # a second interpreter
def test_paths_are_the_same_text_in_a_locale_of_other_names():
    """In a Latin-1 or ASCII locale Python's names of UTF-8 bytes are others, and the rows not."""
    text = "gl\u00e4nzend \u65e5\u672c.csv"
    program = (
        "import os, sys; from relgloss_view.catalogue.tree import text_of; from relgloss_view."
        "catalogue.places import from_system, in_system; assert sys.getfilesystemencoding() == "
        "'ascii', sys.getfilesystemencoding(); name = os.fsdecode(bytes.fromhex(sys.argv[1])); "
        "print(ascii(text_of(name)), from_system(in_system(text_of(name))) == text_of(name))"
    )
    words = [sys.executable, "-X", "utf8=0", "-c", program, text.encode().hex()]
    env = {**os.environ, "LC_ALL": "C", "PYTHONCOERCECLOCALE": "0"}
    shown = subprocess.run(words, env=env, capture_output=True, text=True, check=False)
    assert shown.stdout.strip() == f"{text!a} True", shown.stderr
    assert text_of(text) == text


def test_a_full_temporary_folder_is_one_line_of_a_cluster():
    with (
        pytest.raises(InputError, match=r"No space left on device\); set TMPDIR"),
        _faults_of_start(),
    ):
        raise RuntimeError("Cluster failed to start") from OSError(
            errno.ENOSPC, os.strerror(errno.ENOSPC)
        )
    with pytest.raises(RuntimeError), _faults_of_start():
        raise RuntimeError("Cluster failed to start") from KeyError("a mistake of Dask's")
