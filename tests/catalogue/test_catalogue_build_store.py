"""Whatever ends a build, it goes on where it was, and its bytes are those of a build without."""

from __future__ import annotations

import hashlib
import json
import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import time
from functools import partial
from pathlib import Path

import pytest
from catalogue_trees import contents, quick_item, quick_tree, save

from relgloss_view.base.errors import InputError
from relgloss_view.catalogue import build as building
from relgloss_view.catalogue.build import BuildOptions, build
from relgloss_view.catalogue.catalogue import Catalogue
from relgloss_view.catalogue.engine import EngineOptions, Lost
from relgloss_view.catalogue.item import Item
from relgloss_view.catalogue.recipe import Recipe
from relgloss_view.catalogue.store import Store

KEEP = BuildOptions(keep_going=True)


@pytest.fixture
def quick(monkeypatch):
    """Builds whose work on a file is quick_item; the paths that were worked on."""
    worked = []

    def item(file, path, *rest):
        worked.append(path)
        return quick_item(file, path, *rest)

    monkeypatch.setattr(building, "make_item", item)
    return worked


def in_a_child(work):
    """Run `work` in a forked process; its exit status."""
    child = os.fork()
    if child == 0:
        status = 1
        try:
            work()
            status = 0
        finally:
            os._exit(status)
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])


@pytest.mark.parametrize("seed", range(3))
def test_order_and_number_of_workers_do_not_show(quick, tmp_path, monkeypatch, seed):
    tree = quick_tree(tmp_path / "tree")
    build(tree, tmp_path / "plain")

    def shuffled(tasks, done, options):
        waiting = list(tasks)
        random.Random(seed).shuffle(waiting)
        for task in waiting:
            done(task, task.result())

    monkeypatch.setattr(building, "run", shuffled)
    build(tree, tmp_path / "shuffled")
    assert contents(tmp_path / "plain") == contents(tmp_path / "shuffled")


def test_a_kill_at_every_step_loses_at_most_the_item_in_hand(quick, tmp_path, monkeypatch):
    """The process ends before and after each file that gets its name, as a kill would end it."""
    tree = quick_tree(tmp_path / "tree", 4)
    build(tree, tmp_path / "plain")
    expected = contents(tmp_path / "plain")
    replace = os.replace
    steps = 0

    def run_until(step, after):
        count = 0

        def ending(source, target):
            nonlocal count
            count += 1
            if count == step and not after:
                os._exit(9)
            replace(source, target)
            if count == step:
                os._exit(9)

        os.replace = ending
        build(tree, tmp_path / "killed")

    while True:
        for after in (False, True):
            shutil.rmtree(tmp_path / "killed", ignore_errors=True)
            status = in_a_child(partial(run_until, steps + 1, after))
            kept = len([*(tmp_path / "killed").glob("items/*/*.json")])
            quick.clear()
            build(tree, tmp_path / "killed")
            assert len(quick) == 4 - kept
            assert contents(tmp_path / "killed") == expected
        if status == 0:
            break
        steps += 1
    assert steps >= 4 + 4 + 2  # each item, each material, the mark and the table


def test_a_record_that_is_not_whole_is_made_again(quick, tmp_path):
    tree = quick_tree(tmp_path / "tree")
    build(tree, tmp_path / "catalogue")
    expected = contents(tmp_path / "catalogue")
    records = sorted((tmp_path / "catalogue").glob("items/*/*.json"))
    records[0].write_bytes(records[0].read_bytes()[:-5])
    records[1].write_bytes(b"")
    data = bytearray(records[2].read_bytes())
    data[len(data) // 2] ^= 1
    records[2].write_bytes(data)
    quick.clear()
    build(tree, tmp_path / "catalogue")
    assert len(quick) == 3
    assert contents(tmp_path / "catalogue") == expected


@pytest.mark.parametrize("limit", [30, 1000, 12000])
def test_a_full_disk_keeps_what_is_done(quick, tmp_path, limit):
    """No file may grow beyond a limit, as on a disk without room: mark, records or table."""
    tree = quick_tree(tmp_path / "tree")
    build(tree, tmp_path / "plain")

    def limited():
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
        with pytest.raises(InputError, match=r"catalogue: can't be written \(File too large\)"):
            build(tree, tmp_path / "catalogue")

    assert in_a_child(limited) == 0
    kept = len([*(tmp_path / "catalogue").glob("items/*/*.json")])
    assert kept == (6 if limit == 12000 else 0)
    assert not [*(tmp_path / "catalogue").rglob("*.part")]
    quick.clear()
    build(tree, tmp_path / "catalogue")
    assert len(quick) == 6 - kept
    assert contents(tmp_path / "catalogue") == contents(tmp_path / "plain")


def test_the_first_fault_ends_a_build_and_keeps_what_is_done(quick, tmp_path):
    tree = quick_tree(tmp_path / "tree")
    save(tree / "lot 1" / "broken.json")
    report = build(tree, tmp_path / "catalogue")
    assert (report.is_complete, report.faults) == (False, ["lot 1/broken.json: line 3: is broken"])
    assert quick == ["lot 0/stock-0.json", "lot 0/stock-3.json", "lot 1/broken.json"]
    with pytest.raises(InputError, match="holds no table yet"):
        Catalogue.open(tmp_path / "catalogue")
    quick.clear()
    report = build(tree, tmp_path / "catalogue")  # a known fault is not tried again
    assert (report.is_complete, quick) == (False, [])
    report = build(tree, tmp_path / "catalogue", options=KEEP)
    assert (report.is_complete, report.done, report.failed) == (True, 6, 1)
    assert len(quick) == 4
    rows = {row["path"]: row for row in Catalogue.open(tmp_path / "catalogue").rows}
    assert rows["lot 1/broken.json"]["status"] == "failed"
    assert rows["lot 1/broken.json"]["fault"] == "line 3: is broken"
    assert rows["lot 1/broken.json"]["material"] is None


def test_a_known_fault_is_tried_again_where_it_may_help(quick, tmp_path):
    tree = quick_tree(tmp_path / "tree", 2)
    save(tree / "broken.json")
    save(tree / "lonely.json")  # a fault of the machine
    build(tree, tmp_path / "catalogue", options=KEEP)
    for options, expected in (
        (KEEP, ["lonely.json"]),
        (BuildOptions(keep_going=True, retry=True), ["broken.json", "lonely.json"]),
    ):
        quick.clear()
        report = build(tree, tmp_path / "catalogue", options=options)
        assert sorted(quick) == expected
        assert report.failed == 2
    quick.clear()
    save(tree / "broken.json", "cast").rename(tree / "mended.json")
    report = build(tree, tmp_path / "catalogue", options=KEEP)
    assert "mended.json" in quick
    assert [fault.partition(":")[0] for fault in report.faults] == ["lonely.json"]


def test_a_file_that_ends_its_process_is_a_fault_of_one_row(quick, tmp_path, monkeypatch):
    tree = quick_tree(tmp_path / "tree")

    def losing(tasks, done, options):
        for task in tasks:
            done(task, Lost(3) if task.name.endswith("stock-4.json") else task.result())

    monkeypatch.setattr(building, "run", losing)
    report = build(tree, tmp_path / "catalogue", options=KEEP)
    assert (report.done, report.failed) == (5, 1)
    assert "ended without an answer" in report.faults[0]
    monkeypatch.undo()
    monkeypatch.setattr(building, "make_item", quick_item)
    assert build(tree, tmp_path / "catalogue", options=KEEP).failed == 0  # it is tried again


def test_what_the_tree_has_lost_leaves_the_catalogue(quick, tmp_path):
    tree = quick_tree(tmp_path / "tree")
    catalogue = tmp_path / "catalogue"
    build(tree, catalogue)
    (catalogue / "materials" / "lot 0" / "note.txt").write_text("mine", encoding="utf-8")
    shutil.rmtree(tree / "lot 1")
    (tree / "lot 0" / "stock-0.json").unlink()
    report = build(tree, catalogue)
    assert (report.rows, report.removed) == (3, 3)
    assert not (catalogue / "materials" / "lot 1").exists()
    assert (catalogue / "materials" / "lot 0" / "note.txt").exists()  # nobody here wrote it
    assert len([*catalogue.glob("items/*/*.json")]) == 3
    build(tree, tmp_path / "fresh")
    (catalogue / "materials" / "lot 0" / "note.txt").unlink()
    assert contents(catalogue) == contents(tmp_path / "fresh")


def test_a_second_build_is_kept_out(quick, tmp_path, monkeypatch):
    tree = quick_tree(tmp_path / "tree")

    def meddling(tasks, done, options):
        with pytest.raises(InputError, match="another build works on it"):
            build(tree, tmp_path / "catalogue")

    monkeypatch.setattr(building, "run", meddling)
    with pytest.raises(InputError, match="store was changed"):  # nothing was worked off
        build(tree, tmp_path / "catalogue")


@pytest.mark.parametrize("place", ["tree", ".", "file", "full"])
def test_a_folder_that_is_no_catalogue_is_never_written_to(quick, tmp_path, place):
    tree = quick_tree(tmp_path / "tree")
    (tmp_path / "file").write_text("mine", encoding="utf-8")
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "mine.txt").write_text("mine", encoding="utf-8")
    before = contents(tmp_path)
    with pytest.raises(InputError, match=r"choose|give"):
        build(tree, tmp_path / place)
    assert contents(tmp_path) == before
    assert quick == []


def test_a_catalogue_in_the_tree_is_passed_over(quick, tmp_path):
    tree = quick_tree(tmp_path / "tree")
    catalogue = tree / "catalogue"
    assert build(tree, catalogue).rows == 6
    assert build(tree, catalogue).rows == 6
    with pytest.raises(InputError, match="is a catalogue"):
        build(catalogue, tmp_path / "other")


def test_many_rows_are_written_in_parts(quick, tmp_path):
    tree = quick_tree(tmp_path / "tree", 210)
    build(tree, tmp_path / "catalogue")
    catalogue = Catalogue.open(tmp_path / "catalogue")
    assert len(catalogue.rows) == 210
    wanted = [catalogue.rows[k]["path"] for k in (0, 199, 200, 209)]
    assert sorted(catalogue.thumbnails(wanted)) == sorted(wanted)
    names = [(row["path"], row["name"]) for row in catalogue.columns(["path", "name"])]
    assert names == [(row["path"], row["name"]) for row in catalogue.rows]


BUILD = (sys.executable, "-m", "relgloss_view.cli", "catalogue", "build")
ALONE = ("--workers", "1", "--json")
#: The command, killed by itself: whoever watches from outside may come too late.
KILLED = """
import os, signal, sys
from relgloss_view.catalogue.store import Store
from relgloss_view.cli import main
put, kept = Store.put, []
def put_twice(store, key, item, recipe):
    put(store, key, item, recipe)
    kept.append(key)
    if len(kept) == 2:
        os.kill(os.getpid(), signal.SIGKILL)
Store.put = put_twice
main(sys.argv[1:])
"""


def _started(tree, catalogue):
    words = [*BUILD, str(tree), "-o", str(catalogue), *ALONE]
    return subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def _report(tree, catalogue):
    """Of a build by the command, to its end."""
    words = [*BUILD, str(tree), "-o", str(catalogue), *ALONE]
    return json.loads(subprocess.run(words, check=True, capture_output=True).stdout)


def test_a_killed_program_goes_on(tmp_path):
    """Killed once two items are kept; the next one keeps those, and all bytes are the same."""
    tree, catalogue = quick_tree(tmp_path / "tree", 6), tmp_path / "killed"
    words = [sys.executable, "-c", KILLED, "catalogue", "build", str(tree), "-o", str(catalogue)]
    killed = subprocess.run([*words, *ALONE], capture_output=True)
    assert (killed.returncode, killed.stdout) == (-signal.SIGKILL, b"")
    assert len([*catalogue.glob("items/*/*.json")]) == 2
    report = _report(tree, catalogue)
    assert (report["done"], report["unchanged"]) == (6, 2)
    build(tree, tmp_path / "plain")
    assert contents(tmp_path / "plain") == contents(catalogue)


@pytest.mark.slow
def test_a_program_killed_often_goes_on(tmp_path):
    tree, catalogue = quick_tree(tmp_path / "tree", 40), tmp_path / "killed"
    began = time.monotonic()
    _report(tree, tmp_path / "plain")
    took_s = time.monotonic() - began
    seed = random.Random(7)
    for _ in range(25):
        with _started(tree, catalogue) as process:
            time.sleep(seed.uniform(0.2, 1.0) * took_s)
            process.kill()
    report = _report(tree, catalogue)
    assert (report["done"], report["failed"]) == (40, 0)
    assert contents(tmp_path / "plain") == contents(catalogue)


@pytest.mark.slow
def test_two_workers_give_the_bytes_of_one(tmp_path):
    tree = quick_tree(tmp_path / "tree", 8)
    recipe = Recipe()
    for workers in (1, 2):
        options = BuildOptions(EngineOptions(workers=workers))
        build(tree, tmp_path / str(workers), recipe, options)
    assert contents(tmp_path / "1") == contents(tmp_path / "2")


@pytest.mark.parametrize("change", ["key", "type", "name", "text", "body"])
def test_a_record_with_a_true_digest_and_wrong_content_counts_as_none(change, tmp_path):
    """It is removed, so that a build is never told twice that its store was changed."""
    recipe, key, other = Recipe(), "ab" * 32, "cd" * 32
    store = Store(tmp_path)
    row = {"path": "a.csv", "kind": "table", "status": "failed", "fault": "x", "bytes": 3}
    store.put(key, Item(row, failed_in="file"), recipe)
    place = tmp_path / "items" / key[:2] / f"{key}.json"
    assert store.kept(key) is not None
    assert store.item(key) is not None
    head, body = (json.loads(line) for line in place.read_bytes().split(b"\n")[1:])
    if change == "key":
        head["key"] = other
    elif change == "type":
        body["row"]["gloss_60"] = "high"
    elif change == "name":
        body["row"]["colour"] = 1
    elif change == "text":
        body["row"]["fault"] = "\ud800"
    lines = [json.dumps(head).encode(), b"[]" if change == "body" else json.dumps(body).encode()]
    data = b"\n".join(lines)
    place.write_bytes(hashlib.sha256(data).hexdigest().encode() + b"\n" + data)
    assert store.item(key) is None
    assert not place.exists()
    assert store.kept(key) is None


MEMORY = """
import resource, sys
sys.path[:0] = sys.argv[3:]
import catalogue_trees
from relgloss_view.catalogue import build
build.make_item = catalogue_trees.quick_item
report = build.build(sys.argv[1], sys.argv[2])
print(report.done, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024)
"""


@pytest.mark.slow
def test_ten_thousand_items_take_little_memory(tmp_path):
    """At most 500 MB in the program that builds, table and materials included."""
    here = Path(__file__).resolve().parent
    text = save(tmp_path / "stock.json").read_text(encoding="utf-8")
    for k in range(10_000):
        file = tmp_path / "tree" / f"lot {k // 500}" / f"stock-{k}.json"
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text.replace('"stock"', f'"stock {k}"'), encoding="utf-8")
    words = [sys.executable, "-c", MEMORY, str(tmp_path / "tree"), str(tmp_path / "catalogue")]
    done = subprocess.run(
        [*words, str(here), str(here.parent)], check=True, capture_output=True, text=True
    )
    count, megabytes = map(int, done.stdout.split())
    assert count == 10_000
    assert megabytes < 500
    assert len(Catalogue.open(tmp_path / "catalogue").rows) == 10_000
