"""Killed at every call, a folder is the old or the new one, and nothing of the user's is lost."""

from __future__ import annotations

import contextlib
import errno
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
from pathlib import Path

import kill_points
import pytest

from relgloss_view import cli
from relgloss_view.base import file_system, interruptions, journal, temporaries
from relgloss_view.base.errors import InputError
from relgloss_view.base.writing import fresh_file, together, whole_file, whole_folder

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
    @pytest.mark.parametrize("step", [13, pytest.param(1, marks=pytest.mark.slow)])
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

    @pytest.mark.parametrize("step", [11, pytest.param(1, marks=pytest.mark.slow)])
    @pytest.mark.parametrize("program", [several, several_without_exchange])
    def test_while_all_is_put_back(self, quick, program, step):
        """One file can't be put in place, and the program is killed before or while it undoes."""

        def on_a_full_disk(work: Path) -> None:
            real = journal.Journal._move

            def move(self, number, moved, strict):
                if moved.to == "c.html":
                    raise OSError(errno.ENOSPC, "No space left on device")
                real(self, number, moved, strict)

            journal.Journal._move = move
            with contextlib.suppress(InputError):
                program(work)

        before, after = outcomes(fill_several, program, quick)
        for at, work in kill_points.killed_at_every_call(
            fill_several, on_a_full_disk, quick, step=step
        ):
            assert kill_points.run(lambda work=work: temporaries.prepare([f"{work}/rep"])) == 0
            found = kill_points.tree(work)
            assert found in (before, after), at
            for place in (work, work / "far"):
                temporaries.sweep(place, again=True)
            assert kill_points.temporary(work) == [], at
        assert found == before or step > 1  # the last one came to its end

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


def write_files(work: Path, names: str, before_the_end, first=whole_file) -> None:
    """Write files together, the first in its own way; call something before all is committed."""
    with together():
        for name in names:
            with (first if name == names[0] else whole_file)(work / name) as temporary:
                temporary.write_text("new")
        before_the_end()


def others(work: Path) -> dict[str, str]:
    return {p.name: p.read_text() for p in work.iterdir() if p.is_file()}


class TestTogether:
    @pytest.mark.parametrize("exchanging", [True, False])
    def test_all_or_none(self, tmp_path, monkeypatch, exchanging):
        """The third can't be put in place, for a folder has come there meanwhile."""
        if not exchanging:
            monkeypatch.setattr(file_system, "_call_of_renameat2", lambda: None)
        (tmp_path / "a").write_text("old")
        with pytest.raises(InputError, match=r"c: .*folder"):
            write_files(tmp_path, "abc", lambda: (tmp_path / "c").mkdir())
        assert others(tmp_path) == {"a": "old"}
        assert sorted(os.listdir(tmp_path)) == ["a", "c"]

    @pytest.mark.parametrize("exchanging", [True, False])
    @pytest.mark.parametrize(
        ("fault", "kind"),
        [
            (OSError(errno.ENOSPC, "No space left on device"), InputError),
            (KeyboardInterrupt(), KeyboardInterrupt),
        ],
        ids=["full-disk", "interrupted"],
    )
    def test_what_was_replaced_is_put_back(self, tmp_path, monkeypatch, exchanging, fault, kind):
        """A move fails although all was in order."""
        if not exchanging:
            monkeypatch.setattr(file_system, "_call_of_renameat2", lambda: None)
        fill_several(tmp_path)
        before = kill_points.tree(tmp_path)
        real = journal.Journal._move

        def move(self, number, moved, strict):
            if moved.to == "c.html":
                raise fault
            real(self, number, moved, strict)

        monkeypatch.setattr(journal.Journal, "_move", move)
        with pytest.raises(kind, match=r"c\.html: can't be written|^$"):
            several(tmp_path)
        assert kill_points.tree(tmp_path) == before
        assert kill_points.temporary(tmp_path) == []

    def test_a_mark_that_does_not_reach_the_disk_is_none(self, tmp_path, monkeypatch):
        """The command reports a failure, so the next program must not make the moves."""
        fill_several(tmp_path)
        before, real = kill_points.tree(tmp_path), journal.sync

        def broken(path):
            if os.path.lexists(Path(path) / journal.COMMITTED):
                raise OSError(errno.EIO, "Input/output error")
            real(path)

        with monkeypatch.context() as patched:
            patched.setattr(journal, "sync", broken)
            with pytest.raises(InputError, match="Input/output error"):
                several(tmp_path)
        temporaries._swept.clear()
        temporaries.prepare([f"{tmp_path}/rep"])
        assert kill_points.tree(tmp_path) == before
        assert kill_points.temporary(tmp_path) == []

    def test_a_journal_that_could_not_be_read_back_commits_nothing(self, tmp_path, monkeypatch):
        fill_several(tmp_path)
        before = kill_points.tree(tmp_path)
        monkeypatch.setattr(journal, "MOST_BYTES", 200)
        with pytest.raises(InputError, match="too many files at once"):
            several(tmp_path)
        assert kill_points.tree(tmp_path) == before
        assert kill_points.temporary(tmp_path) == []

    def test_a_fault_in_the_block_changes_nothing(self, tmp_path):
        (tmp_path / "a").write_text("old")
        with pytest.raises(KeyError):
            write_files(tmp_path, "a", lambda: {}["fault"])
        assert os.listdir(tmp_path) == ["a"]
        assert others(tmp_path) == {"a": "old"}

    def test_an_output_that_is_given_up_is_left_out(self, tmp_path):
        with together():
            with contextlib.suppress(KeyError), whole_file(tmp_path / "plot") as temporary:
                raise KeyError
            with whole_file(tmp_path / "a") as temporary:
                temporary.write_text("new")
        assert os.listdir(tmp_path) == ["a"]

    def test_one_place_twice_and_a_file_in_the_folder(self, tmp_path):
        """`-o a -o a`, and `-o rep/answers.csv --stimuli rep`."""
        fill(tmp_path)
        with together():
            for text in ("first", "second"):
                with whole_file(tmp_path / "a") as temporary:
                    temporary.write_text(text)
            for name in ("rep/answers.csv", "rep/notes/deep/own", "rep/notes/new"):
                with whole_file(tmp_path / name) as temporary:
                    temporary.write_text("inside")
            write_folder(tmp_path / "rep")
        found = kill_points.tree(tmp_path)
        assert found["a"][1] == b"second"
        assert found["rep/page.html"][1] == b"new page"
        assert found["rep/mine.txt"][1] == b"mine"
        for name in ("rep/answers.csv", "rep/notes/deep/own", "rep/notes/new"):
            assert found[name][1] == b"inside"
        assert kill_points.temporary(tmp_path) == []

    def test_fresh_names_stay_fresh(self, tmp_path):
        def interfere() -> None:
            (tmp_path / "a").write_text("another program's")

        with pytest.raises(InputError, match="is there already"):
            write_files(tmp_path, "ab", interfere, fresh_file)
        assert others(tmp_path) == {"a": "another program's"}


class TestKept:
    def test_mode_and_owner_of_a_file(self, tmp_path):
        file = tmp_path / "a"
        for mode in (0o600, 0o640, 0o666, 0o444):
            file.write_text("old")
            file.chmod(mode)
            if os.geteuid() == 0:
                os.chown(file, 65534, 65534)
            before = file.stat()
            with whole_file(file) as temporary:
                temporary.write_text("new")
            after = file.stat()
            assert (after.st_mode, after.st_uid, after.st_gid) == (
                before.st_mode, before.st_uid, before.st_gid,
            )  # fmt: skip
            assert after.st_ino != before.st_ino
            file.unlink()

    @pytest.mark.parametrize(("private", "mode"), [(False, 0o640), (True, 0o600)])
    def test_new_files_follow_the_umask(self, tmp_path, private, mode):
        """In a process of its own: nothing may change the umask, which all threads share."""
        code = (
            "import os, sys\nfrom pathlib import Path\nos.umask(0o027)\n"
            "changes = []\nreal = os.umask\nos.umask = lambda mask: changes.append(mask)\n"
            "from relgloss_view.base.writing import whole_file, whole_folder\n"
            f"with whole_file('a', private={private}) as t: t.write_text('x')\n"
            "with whole_folder('f', 'm') as t: (t / 'm').write_text('x')\n"
            "assert not changes\nprint(oct(os.stat('a').st_mode), oct(os.stat('f').st_mode))"
        )
        done = subprocess.run(
            [sys.executable, "-c", code],
            cwd=tmp_path, env={**os.environ, "PYTHONPATH": str(ROOT)}, capture_output=True,
            text=True, check=True,
        )  # fmt: skip
        assert done.stdout.split() == [oct(0o100000 | mode), oct(0o040750)]

    def test_a_linked_folder_stays_a_link(self, tmp_path):
        fill(tmp_path)
        (tmp_path / "link").symlink_to("rep")
        write_folder(tmp_path / "link")
        assert (tmp_path / "link").is_symlink()
        assert (tmp_path / "rep" / "page.html").read_text() == "new page"

    def test_a_file_that_comes_in_between_is_kept(self, tmp_path, monkeypatch):
        """An editor saves into the folder while it is being replaced."""
        fill(tmp_path)
        rep, real = tmp_path / "rep", journal.exchange

        def exchange(one, other):
            (rep / "late.txt").write_text("late")
            (rep / "notes" / "late.txt").write_text("late")
            (rep / "saving").write_text("mine, edited")
            os.replace(rep / "saving", rep / "mine.txt")
            real(one, other)

        monkeypatch.setattr(journal, "exchange", exchange)
        write_folder(rep)
        assert (rep / "late.txt").read_text() == (rep / "notes" / "late.txt").read_text() == "late"
        assert (rep / "mine.txt").read_text() == "mine, edited"
        assert (rep / "page.html").read_text() == "new page"
        assert kill_points.temporary(tmp_path) == []

    def test_somebodys_working_folder_stays_the_same_one(self, tmp_path):
        fill(tmp_path)
        rep = tmp_path / "rep"
        number = rep.stat().st_ino
        with subprocess.Popen(["sleep", "60"], cwd=rep / "notes") as sleeper:
            write_folder(rep)
            sleeper.kill()
        assert rep.stat().st_ino == number
        write_folder(rep)
        assert rep.stat().st_ino != number

    def test_files_that_cannot_be_linked_stay_where_they_are(self, tmp_path, monkeypatch):
        fill(tmp_path)
        before, number = kill_points.tree(tmp_path), (tmp_path / "rep" / "mine.txt").stat().st_ino

        def link(*_, **__):
            raise PermissionError(errno.EPERM, "no links here")

        monkeypatch.setattr(os, "link", link)
        write_folder(tmp_path / "rep")
        assert (tmp_path / "rep" / "mine.txt").stat().st_ino == number
        after = kill_points.tree(tmp_path)
        assert after["rep/page.html"][1] == b"new page"
        assert set(before) - set(after) == {"rep/gone.toml"}


class TestSeveralPrograms:
    def test_threads_that_write_one_folder(self, tmp_path):
        """Each writes files with its own number: the folder is always that of one of them."""
        rep = tmp_path / "rep"
        faults: list[BaseException] = []

        def write(number: int) -> None:
            try:
                for turn in range(4):
                    with whole_folder(rep, MARK, stale=lambda old: os.listdir(old)) as temporary:
                        (temporary / MARK).write_text(f'{{"format": "x", "by": {number}}}')
                        for name in range(3):
                            (temporary / f"{number}-{turn}-{name}").write_text(str(number))
            except BaseException as error:
                faults.append(error)

        threads = [threading.Thread(target=write, args=(n,)) for n in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        assert faults == []
        by = json.loads((rep / MARK).read_text())["by"]
        names = [p.name for p in rep.iterdir() if p.name != MARK]
        assert len(names) == 3
        assert {name.partition("-")[0] for name in names} == {str(by)}
        assert kill_points.temporary(tmp_path) == []

    def test_a_signal_ends_the_wait_for_another_program(self, tmp_path, monkeypatch):
        """The other one holds the lock; the signal comes while this one waits for it."""
        fill(tmp_path)
        before, real = kill_points.tree(tmp_path), temporaries._lock
        signals = interruptions.Signals()
        monkeypatch.setattr(interruptions, "SIGNALS", signals)

        def lock(path):
            if path != str(tmp_path):
                return real(path)
            signals.number = signal.SIGINT
            return temporaries.TAKEN

        monkeypatch.setattr(temporaries, "_lock", lock)
        with pytest.raises(interruptions.Interrupted):
            write_folder(tmp_path / "rep")
        assert kill_points.tree(tmp_path) == before
        assert kill_points.temporary(tmp_path) == []

    def test_a_folder_that_somebody_else_makes_meanwhile(self, tmp_path):
        def meanwhile() -> None:
            with whole_folder(tmp_path / "new", MARK) as temporary:
                (temporary / MARK).write_text('{"format": "x"}')
                (tmp_path / "new").mkdir()
                (tmp_path / "new" / MARK).write_text("of another kind")

        with pytest.raises(InputError, match="made by another program"):
            meanwhile()
        assert (tmp_path / "new" / MARK).read_text() == "of another kind"
        assert kill_points.temporary(tmp_path) == []

    def test_a_journal_from_elsewhere_moves_nothing(self, tmp_path):
        """A folder out of an archive, with a journal that names files of the user's."""
        (tmp_path / "thesis").write_text("mine")
        for to in ("thesis", "../thesis", str(tmp_path / "thesis")):
            holder = tmp_path / f"{temporaries.PREFIX}x{temporaries.SUFFIX}"
            (holder / "new").mkdir(parents=True)
            (holder / "new" / "evil").write_text("evil")
            moves = [
                {"new": "new/evil", "to": to, "was": None, "made": [1, 2, 3], "fresh": False,
                 "dropped": []},
                {"new": None, "to": to, "was": [1, 2, 3], "made": None, "fresh": False,
                 "dropped": []},
            ]  # fmt: skip
            content = {"format": journal.FORMAT, "version": journal.VERSION, "key": "k",
                       "primary": ".", "others": ["../../x", "/"], "moves": moves}  # fmt: skip
            (holder / journal.JOURNAL).write_text(json.dumps(content))
            (holder / journal.COMMITTED).touch()
            temporaries.sweep(tmp_path, again=True)
            assert (tmp_path / "thesis").read_text() == "mine"
            shutil.rmtree(holder, ignore_errors=True)


@pytest.fixture
def small_disk(tmp_path):
    """A file system of half a megabyte."""
    place = tmp_path / "disk"
    place.mkdir()
    words = ["mount", "-t", "tmpfs", "-o", "size=512k", "tmpfs", str(place)]
    if os.geteuid() or subprocess.run(words, capture_output=True).returncode:
        pytest.skip("nothing can be mounted here")
    yield place
    subprocess.run(["umount", str(place)], check=True)


class TestPlaces:
    def test_a_full_disk_keeps_the_old(self, small_disk):
        fill(small_disk)
        before = kill_points.tree(small_disk)

        def too_much() -> None:
            with whole_folder(small_disk / "rep", MARK) as temporary:
                (temporary / MARK).write_text("x")
                (temporary / "big").write_bytes(bytes(10**6))

        with pytest.raises(InputError, match="No space left"):
            too_much()
        assert kill_points.tree(small_disk) == before
        assert kill_points.temporary(small_disk) == []

    def test_the_root_of_a_file_system(self, small_disk):
        fill(small_disk)
        for name in OURS:
            (small_disk / name).write_text("old")
        write_folder(small_disk)
        assert (small_disk / "page.html").read_text() == "new page"
        assert (small_disk / "beside.txt").read_text() == "beside"
        assert kill_points.temporary(small_disk.parent) == []

    def test_files_on_two_file_systems(self, small_disk, tmp_path):
        (tmp_path / "a").write_text("old")
        with together():
            for place in (small_disk / "b", tmp_path / "a"):
                with whole_file(place) as temporary:
                    temporary.write_text("new")
        assert (small_disk / "b").read_text() == (tmp_path / "a").read_text() == "new"

    @pytest.mark.skipif(os.geteuid() != 0, reason="becomes another user")
    @pytest.mark.parametrize(
        ("above", "at", "works"), [(0o555, 0o777, True), (0o777, 0o555, False)]
    )
    def test_protected_folders(self, above, at, works):
        """Where the one above is protected the files are moved in; a protected one is refused."""
        place = Path(tempfile.mkdtemp(dir="/tmp"))
        try:
            fill(place)
            before = kill_points.tree(place)
            (place / "rep").chmod(at)
            place.chmod(above)

            def program() -> None:
                os.setresuid(65534, 65534, 65534)
                try:
                    write_folder(place / "rep")
                except InputError as error:
                    assert not works
                    assert "protected" in str(error)
                else:
                    assert works

            assert kill_points.run(program) == 0
            after = kill_points.tree(place)
            assert (after["rep/page.html"] != before["rep/page.html"]) == works
            assert kill_points.temporary(place) == []
        finally:
            shutil.rmtree(place)

    def test_an_immutable_file_is_left_where_it_is(self, tmp_path):
        fill(tmp_path)
        mine = tmp_path / "rep" / "mine.txt"
        if os.geteuid() or subprocess.run(["chattr", "+i", mine], capture_output=True).returncode:
            pytest.skip("no file can be made immutable here")
        try:
            write_folder(tmp_path / "rep")
        finally:
            subprocess.run(["chattr", "-i", mine], check=True)
        assert mine.read_text() == "mine"
        assert (tmp_path / "rep" / "page.html").read_text() == "new page"
        assert kill_points.temporary(tmp_path) == []
