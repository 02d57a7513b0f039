"""The session file: nothing acknowledged that is not stored, nobody else's hand in it."""

from __future__ import annotations

import contextlib
import os
import resource
import shutil
import signal
import sqlite3
import subprocess
import sys
import time
from pathlib import Path

import pytest
from cases import answer, answer_all, percepts, replaced, standing, started, study

from relgloss_view.base.errors import InputError
from relgloss_view.experiment.design.grid import Grid
from relgloss_view.experiment.observers.population import Population
from relgloss_view.experiment.observers.simulation import run_observers
from relgloss_view.experiment.session import session_file
from relgloss_view.experiment.session.flow import Flow
from relgloss_view.experiment.session.records import SIMULATED, read_record
from relgloss_view.experiment.session.store import Store
from relgloss_view.picture.scene.setting import Setting

SMALL = Grid((0.0, 2.0), (0.5, 1.0))


@pytest.fixture
def file(tmp_path):
    return tmp_path / "s.sqlite"


def test_answers_come_back(file):
    made = study(grid=SMALL, ask_grain=True)
    with Store(file, made) as store:
        flow = started(store)
        answer_all(flow, (0, 3, 1))
        flow.end()
        kept = standing(store)
    assert len(kept) == 8
    assert os.listdir(file.parent) == ["s.sqlite"]  # one plain file
    with Store(file, made) as store:
        assert standing(store) == kept
        assert [o.ended for o in store.observers()] == [True]
    record = read_record(file, file.parent)
    assert len(record.answers) == 8
    assert record.answers[0].response_s == pytest.approx(1.0)
    assert record.runs[0].device == "device"
    assert record.runs[0].ended_utc is not None


def test_each_answer_is_in_the_file_before_the_call_returns(file):
    """Seen by another process, in a copy of the files as they lie on the disk."""
    with Store(file, study(grid=SMALL)) as store:
        flow = started(store)
        for count in (1, 2, 3):
            answer(flow)
            copy = file.parent / f"copy{count}"
            copy.mkdir()
            for name in os.listdir(file.parent):
                if name.startswith("s.sqlite"):
                    (copy / name).write_bytes((file.parent / name).read_bytes())
            assert len(read_record(copy / "s.sqlite", copy).answers) == count


def test_each_step_is_synced_and_the_journal_is_void_between_answers(file):
    with Store(file, study(grid=SMALL)) as store:
        connection = store._connection
        assert connection.execute("PRAGMA journal_mode").fetchone() == ("persist",)
        assert connection.execute("PRAGMA synchronous").fetchone() == (3,)  # EXTRA
        answer(started(store))
        assert Path(f"{file}-journal").read_bytes()[:28] == bytes(28)
    assert os.listdir(file.parent) == ["s.sqlite"]


class TestOneProgramAlone:
    def test_second_is_refused(self, file):
        with Store(file, study(grid=SMALL)) as store:
            answer(started(store))
            with pytest.raises(InputError, match="another program has this session open"):
                Store(file)
            with pytest.raises(InputError, match="another program has this session open"):
                read_record(file, file.parent)
            answer(started(store))
        with Store(file) as store:
            assert len(store.answers()) == 2

    def test_second_process_is_refused(self, file):
        code = (
            "import sys; from relgloss_view.experiment.session.store import Store\n"
            "from relgloss_view.base.errors import InputError\n"
            "try: Store(sys.argv[1])\n"
            "except InputError as error: print(error)\n"
            "else: print('opened')"
        )
        words = [sys.executable, "-c", code, str(file)]
        with Store(file, study(grid=SMALL)):
            refused = subprocess.run(words, capture_output=True, text=True, check=True).stdout
        opened = subprocess.run(words, capture_output=True, text=True, check=True).stdout
        assert "another program has this session open; close it first" in refused
        assert opened == "opened\n"

    def test_two_read_at_once(self, file):
        Store(file, study(grid=SMALL)).close()
        with session_file.open_to_read(file), session_file.open_to_read(file):
            pass


class TestBatch:
    def test_all_of_it_or_nothing(self, file):
        with Store(file, study(grid=SMALL)) as store:
            flow = started(store)
            with store.batch():
                answer(flow, 1)
                answer(flow, 2)

            def fails():
                with store.batch():
                    answer(flow, 3)
                    raise KeyError

            with pytest.raises(KeyError):
                fails()
            assert [a.category for a in store.answers()] == [1, 2]
        record = read_record(file, file.parent)
        assert (len(record.answers), record.losses) == (2, ())

    def test_what_is_printed_is_in_the_file(self, file):
        """A copy of the file alone, made when an answer is printed, has it."""
        made = study(grid=Grid((0.0, 1.0, 2.0), (0.25, 0.5, 0.75, 1.0)), repeats=2)
        counts = []

        def on_stored(_):
            shutil.copyfile(file, file.parent / "copy.sqlite")
            counts.append(len(read_record(file.parent / "copy.sqlite", file.parent).answers))

        with Store(file, made) as store:
            seen = percepts(made, [Setting(1.0, 0.7)])
            run_observers(store, seen, Population(), 1, 0, on_stored)
        assert len(counts) == 24
        assert all(count > k for k, count in enumerate(counts))


class TestTakenAway:
    """What lies at the file's name is not what the program writes into."""

    @pytest.mark.parametrize("suffix", ["", "-journal"])
    def test_no_answer_goes_nowhere(self, file, suffix):
        with Store(file, study(grid=SMALL)) as store:
            flow = started(store)
            answer(flow)
            os.rename(f"{file}{suffix}", f"{file}.away")
            trial = flow.trial
            for replacement in (False, True):
                if replacement:
                    shutil.copyfile(f"{file}.away", f"{file}{suffix}")
                flow.shown()
                flow._clock.now_s += 1.0
                with pytest.raises(InputError, match="moved, replaced or removed"):
                    flow.answer(1)
                assert flow.trial == trial
            os.replace(f"{file}.away", f"{file}{suffix}")
            answer(flow)  # it is put back
        assert len(read_record(file, file.parent).answers) == 2


class TestObservers:
    def test_pseudonyms(self, file):
        with Store(file, study(grid=SMALL)) as store:
            first = store.observer()
            assert (first.name, first.number) == ("O01", 0)
            assert store.observer() == first  # not finished yet
            store.end(first)
            assert store.observer().name == "O02"
            assert store.observer("blue").number == 2
            with pytest.raises(InputError, match="'O01' has finished this study"):
                store.observer("O01")

    @pytest.mark.parametrize("name", ["", "  ", "a\nb", "x" * 41, "\x1b[31m"])
    def test_bad_names(self, file, name):
        with Store(file, study(grid=SMALL)) as store, pytest.raises(InputError, match="pseudonym"):
            store.observer(name)

    def test_no_name_is_asked_for_and_none_kept(self, file):
        with Store(file, study(grid=SMALL)) as store:
            store.observer()
            columns = [row[1] for row in store._rows("PRAGMA table_info(observer)")]
        assert columns == [
            "number", "name", "kind", "begun_utc", "consented_utc", "ended_utc", "details",
        ]  # fmt: skip

    def test_simulated_are_marked(self, file):
        with Store(file, study(grid=SMALL)) as store:
            assert store.observer(kind=SIMULATED, details={"x": 1}).kind == SIMULATED
        assert read_record(file, file.parent).details == ({"x": 1},)


class TestUndo:
    def test_the_last_answer_is_taken_back_and_kept(self, file):
        with Store(file, study(grid=SMALL)) as store:
            flow = started(store)
            answer(flow, 4)
            answer(flow, 1)
            assert flow.undo()
            assert [a.category for a in store.answers()] == [4]
            assert flow.trial.position == 1
        record = read_record(file, file.parent)
        assert record.undone == 1
        with session_file.open_to_read(file) as opened:
            rows = opened.connection.execute("SELECT category FROM answer ORDER BY id").fetchall()
        assert rows == [(4,), (1,)]

    def test_one_standing_answer_a_question(self, file):
        with Store(file, study(grid=SMALL)) as store:
            flow = started(store)
            trial = flow.trial
            answer(flow)
            with pytest.raises(InputError):
                store.answer(flow.observer, trial, "ratio", 1, 1.0, flow.run)
            assert len(store.answers()) == 1


class TestAnotherStudy:
    def test_is_refused(self, file):
        made = study(grid=SMALL)
        Store(file, made).close()
        with pytest.raises(InputError, match="another study, or to this one before it was edited"):
            Store(file, replaced(made, categories=("yes", "no")))
        with Store(file) as store:
            assert store.study.categories == made.categories


class TestBadFiles:
    @pytest.mark.parametrize(
        "content",
        [b"", b"not a database", b"SQLite format 3\x00" + bytes(90), os.urandom(5000)],
        ids=["empty", "text", "header", "noise"],
    )
    def test_not_a_session(self, file, content):
        file.write_bytes(content)
        for opener in (lambda: Store(file), lambda: read_record(file, file.parent)):
            with pytest.raises(InputError, match=r"s\.sqlite: .*(session file|damaged)") as caught:
                opener()
            assert "\n" not in str(caught.value)
        assert file.read_bytes() == content

    def test_somebody_elses_database(self, file):
        with contextlib.closing(sqlite3.connect(file)) as connection:
            connection.execute("CREATE TABLE mine (x)")
        before = file.read_bytes()
        with pytest.raises(InputError, match="not a session file"):
            Store(file, study(grid=SMALL))
        assert file.read_bytes() == before

    def test_newer_version(self, file):
        Store(file, study(grid=SMALL)).close()
        with contextlib.closing(sqlite3.connect(file)) as connection:
            connection.execute("PRAGMA user_version = 9")
        with pytest.raises(InputError, match="of version 9, expected 1 or 2"):
            Store(file)

    def test_damaged_in_the_middle(self, file):
        with Store(file, study()) as store:
            answer_all(started(store))
        content = bytearray(file.read_bytes())
        content[4096:12288] = os.urandom(8192)
        file.write_bytes(content)
        with pytest.raises(InputError, match=r"s\.sqlite: "):
            read_record(file, file.parent)

    @pytest.mark.parametrize("name", ["", "a folder", "/dev/null", "gone/s.sqlite"])
    def test_no_place_for_a_file(self, tmp_path, monkeypatch, name):
        monkeypatch.chdir(tmp_path)
        (tmp_path / "a folder").mkdir()
        with pytest.raises(InputError):
            Store(name, study(grid=SMALL))
        assert os.listdir(tmp_path) == ["a folder"]

    def test_two_creators(self, file):
        """Who comes second finds the first one's file, and does not replace it."""
        first = Store(file, study(grid=SMALL))
        with pytest.raises(InputError, match="is there already"):
            session_file.create_file(file, "{}", "", "")
        first.close()
        assert os.listdir(file.parent) == ["s.sqlite"]


class TestNoRoom:
    def fill(self, store, flow):
        """Answer until the disk says no; how many were acknowledged."""
        count = 0
        told = ""
        while not told:
            before = flow.trial
            try:
                answer(flow)
                count += 1
            except InputError as error:
                told = str(error)
        assert told.endswith(
            "the disk is full; make room and start again; all answers so far are kept"
        )
        assert flow.trial == before  # it is still asked for
        return count

    def test_full_disk(self, file):
        """SQLite's own limit of pages answers as a full disk does."""
        with Store(file, study(repeats=20)) as store:
            flow = started(store)
            (pages,) = store._connection.execute("PRAGMA page_count").fetchone()
            store._connection.execute(f"PRAGMA max_page_count = {pages + 1}")
            count = self.fill(store, flow)
            assert len(store.answers()) == count
            store._connection.execute("PRAGMA max_page_count = 100000")
            assert flow.answer(2)  # after room was made the same trial takes its answer
            assert len(store.answers()) == count + 1
        assert len(read_record(file, file.parent).answers) == count + 1

    def test_file_that_may_not_grow(self, file):
        """A limit of the system: the file is no longer extended, and all that was told is in it."""
        code = (
            f"import sys; sys.path.insert(0, {str(Path(__file__).parent.parent)!r})\n"
            "import os, resource, signal\n"
            "from cases import answer, started, study\n"
            "from relgloss_view.base.errors import InputError\n"
            "from relgloss_view.experiment.session.store import Store\n"
            "store = Store(sys.argv[1], study(repeats=5))\n"
            "flow = started(store)\n"
            "size = os.path.getsize(sys.argv[1])\n"
            "signal.signal(signal.SIGXFSZ, signal.SIG_IGN)\n"
            "resource.setrlimit(resource.RLIMIT_FSIZE, (size, resource.RLIM_INFINITY))\n"
            "try:\n"
            "    for n in range(210): answer(flow); print(n, flush=True)\n"
            "except InputError as error: print(error)\n"
            "store.close()\n"
        )
        done = subprocess.run(
            [sys.executable, "-c", code, str(file)], capture_output=True, text=True, check=True
        )
        *told, fault = done.stdout.splitlines()
        assert fault.startswith(f"{file}: ")
        assert 0 < len(told) < 210
        assert len(read_record(file, file.parent).answers) == len(told)

    @pytest.mark.skipif(os.geteuid() != 0, reason="needs root, to become somebody else")
    def test_folder_that_may_not_be_written(self, file):
        made = study(grid=SMALL)
        Store(file, made).close()
        assert os.stat(file).st_mode & 0o777 == 0o600  # answers of people
        os.chmod(file, 0o644)
        os.chmod(file.parent, 0o755)
        for parent in list(file.parent.parents)[:3]:
            os.chmod(parent, os.stat(parent).st_mode | 0o055)
        os.seteuid(65534)
        try:
            with pytest.raises(InputError, match="can't be written"):
                Store(file)
            with pytest.raises(InputError, match="can't be written"):
                Store(file.parent / "new.sqlite", made)
            assert read_record(file, Path("/tmp")).answers == ()  # reading is possible
        finally:
            os.seteuid(0)
        assert os.listdir(file.parent) == ["s.sqlite"]


@pytest.mark.skipif(os.geteuid() != 0, reason="needs root, to become somebody else")
def test_after_a_kill_it_is_read_where_nothing_can_be_written(tmp_path, file):
    """The log beside the file holds the last answers; the files stay as they are."""
    Store(file, study(grid=SMALL)).close()
    code = (
        f"import sys; sys.path.insert(0, {str(Path(__file__).parent.parent)!r})\n"
        "import os, signal\n"
        "from cases import answer, started\n"
        "from relgloss_view.experiment.session.store import Store\n"
        "flow = started(Store(sys.argv[1])); answer(flow); answer(flow)\n"
        "os.kill(os.getpid(), signal.SIGKILL)"
    )
    done = subprocess.run([sys.executable, "-c", code, str(file)], capture_output=True)
    assert done.returncode == -signal.SIGKILL
    for left in tmp_path.iterdir():
        os.chmod(left, 0o644)
    for parent in list(file.parent.parents)[:3]:
        os.chmod(parent, os.stat(parent).st_mode | 0o055)
    os.chmod(tmp_path, 0o755)
    before = {p.name: p.read_bytes() for p in tmp_path.iterdir()}
    os.seteuid(65534)
    try:
        assert len(read_record(file, Path("/tmp")).answers) == 2
    finally:
        os.seteuid(0)
    assert {p.name: p.read_bytes() for p in tmp_path.iterdir()} == before


def test_limits_are_this_process_alone():
    """The control of the tests above: nothing of them is left."""
    assert resource.getrlimit(resource.RLIMIT_FSIZE)[1] == resource.RLIM_INFINITY
    assert os.geteuid() == os.getuid()


@pytest.mark.parametrize(
    ("change", "what"),
    [
        ("UPDATE observer SET details = '?'", "observer.details"),
        ("UPDATE observer SET details = cast(x'ff22' AS TEXT)", "damaged"),
        ("UPDATE trial SET sample = 1e300", "trial.sample"),
        ("UPDATE trial SET setting = 'left'", "trial.setting"),
        ("UPDATE answer SET category = 77", "answer.category"),
        ("UPDATE answer SET question = x'80'", "answer.question"),
        ("UPDATE answer SET response_ms = 9e18", "answer.response_ms"),
        ("UPDATE observer SET kind = cast(x'ff' AS TEXT)", "damaged"),
        ("UPDATE observer SET name = x'00'", "observer.name"),
        ("UPDATE study SET content = 3", "the study in it is damaged"),
        ("UPDATE study SET content = '{\"a\":' || '[' || '}'", "the study in it is damaged"),
        ("ALTER TABLE study DROP COLUMN version", "damaged"),
    ],
)
def test_damage_is_one_line_for_whoever_goes_on(file, change, what):
    """Not only an analysis reads a file: so does the window that continues it."""
    with Store(file, study()) as store:
        answer(started(store), 0)
    with contextlib.closing(sqlite3.connect(file)) as connection:
        connection.execute("PRAGMA ignore_check_constraints = ON")
        connection.execute(change)
        connection.commit()

    def go_on():
        with Store(file) as store:
            for observer in store.observers():
                store.details(observer)
                Flow(store, observer, 1, time.monotonic).progress()

    for opener in (go_on, lambda: read_record(file, file.parent)):
        with pytest.raises(InputError) as caught:
            opener()
        assert str(caught.value).isprintable()
        assert "damaged" in str(caught.value)
        if opener is not go_on:
            assert what in str(caught.value) or "the file is damaged" in str(caught.value)
