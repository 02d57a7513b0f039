"""Killed at every call, a folder is the old or the new one, and nothing of the user's is lost."""

from __future__ import annotations

import errno
import os
import tempfile
from pathlib import Path

import kill_points
import pytest

from relgloss_view import cli
from relgloss_view.base import file_system, temporaries
from relgloss_view.base.writing import together, whole_file, whole_folder

ROOT = Path(cli.__file__).parents[1]
MARK = "results.json"
OURS = {MARK: '{"format": "x"}', "page.html": "page", "scale.csv": "1"}


def fill(work: Path) -> None:
    """A report of a former run, with files of the user's beside and below it."""
    rep = work / "rep"
    (rep / "notes" / "deep").mkdir(parents=True)
    for name, text in OURS.items():
        (rep / name).write_text(f"old {text}")
    (rep / "scale.csv").chmod(0o600)
    (rep / "gone.toml").write_text("a scene that is no longer chosen")
    (rep / "mine.txt").write_text("mine")
    (rep / "mine.txt").chmod(0o640)
    (rep / "notes" / "deep" / "own").write_bytes(bytes(range(256)))
    (rep / "notes").chmod(0o750)
    (rep / "link").symlink_to("notes/deep")
    (rep / "dangling").symlink_to("nowhere")
    (rep / os.fsdecode(b"odd\xff\n")).write_text("odd")
    (work / "beside.txt").write_text("beside")


def write_folder(folder: Path) -> None:
    with whole_folder(folder, MARK, stale=lambda _: ["gone.toml", "never.toml"]) as temporary:
        for name, text in OURS.items():
            (temporary / name).write_text(f"new {text}")


def one_by_one(folder: Path) -> None:
    """How it was done before: the mark first removed, then file after file."""
    with temporaries.held_folder(folder) as temporary:
        for name, text in OURS.items():
            (temporary / name).write_text(f"new {text}")
        (folder / MARK).unlink()
        for name in sorted(OURS, key=lambda name: (name == MARK, name)):
            os.replace(temporary / name, folder / name)
        (folder / "gone.toml").unlink()


def in_report(work: Path) -> None:
    os.chdir(work / "rep")
    write_folder(Path("."))


def without_exchange(work: Path) -> None:
    no_renameat2()
    write_folder(work / "rep")


def no_renameat2() -> None:
    def refuse(*_: object) -> None:
        raise OSError(errno.ENOSYS, "no such call")

    file_system._renameat2 = refuse


def several(work: Path) -> None:
    """Two files that exist, one that does not, and a folder."""
    with together():
        for name in ("a.html", "b.html", "far/c.html"):
            with whole_file(work / name) as temporary:
                temporary.write_text("new")
        write_folder(work / "rep")


def several_without_exchange(work: Path) -> None:
    no_renameat2()
    several(work)


def fill_several(work: Path) -> None:
    fill(work)
    (work / "far").mkdir()
    (work / "a.html").write_text("old")
    (work / "far" / "c.html").write_text("old")


@pytest.fixture
def quick(tmp_path):
    """A folder on a file system in memory, where there is one: a run brings much to the disk."""
    memory = Path("/dev/shm")
    if not os.access(memory, os.W_OK):
        yield tmp_path
        return
    with tempfile.TemporaryDirectory(dir=memory) as folder:
        yield Path(folder)


def outcomes(prepare, program, base):
    """The tree before, and after a run that is not killed."""
    work = base / "undisturbed"
    work.mkdir()
    prepare(work)
    before = kill_points.tree(work)
    assert kill_points.run(lambda: program(work)) == 0
    after = kill_points.tree(work)
    assert before != after
    assert kill_points.temporary(work) == []
    return before, after


PROGRAMS = {
    "exchange": (fill, lambda work: write_folder(work / "rep")),
    "new": (fill, lambda work: write_folder(work / "deep" / "new")),
    "in-place": (fill, in_report),
    "no-exchange": (fill, without_exchange),
    "several": (fill_several, several),
    "several-no-exchange": (fill_several, several_without_exchange),
}
AT_ONCE = ("exchange", "new")  #: the others are finished by the next program


class TestKilled:
    @pytest.mark.parametrize("step", [7, pytest.param(1, marks=pytest.mark.slow)])
    @pytest.mark.parametrize("name", PROGRAMS)
    def test_at_every_call(self, quick, name, step):
        prepare, program = PROGRAMS[name]
        before, after = outcomes(prepare, program, quick)
        seen, calls = set(), 0
        for calls, work in kill_points.killed_at_every_call(prepare, program, quick, step=step):
            found = kill_points.tree(work)
            mine = {k: v for k, v in before.items() if k in after and before[k] == after[k]}
            assert {k: found.get(k) for k in mine} == mine, calls
            assert "rep/results.json" in found, calls
            if name in AT_ONCE:
                assert found in (before, after), calls
            # The next command, whatever it does there.
            assert kill_points.run(lambda work=work: temporaries.prepare([f"{work}/rep"])) == 0
            found = kill_points.tree(work)
            assert found in (before, after), calls
            seen.add(found == after)
            for place in (work, work / "far"):
                temporaries.sweep(place, again=True)
            assert kill_points.temporary(work) == [], calls
            assert kill_points.run(lambda work=work: program(work)) == 0
            assert kill_points.tree(work) == after
        assert seen == {False, True}
        assert calls > 15

    def test_the_search_finds_what_was_wrong_before(self, quick):
        before, after = outcomes(fill, lambda work: one_by_one(work / "rep"), quick)
        mixed = unmarked = 0
        for _, work in kill_points.killed_at_every_call(
            fill, lambda work: one_by_one(work / "rep"), quick
        ):
            found = kill_points.tree(work)
            mixed += found not in (before, after)
            unmarked += "rep/results.json" not in found
        assert mixed >= 4
        assert unmarked >= 3
