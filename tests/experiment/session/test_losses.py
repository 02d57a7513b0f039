"""A loss is seen, whatever became of the files: torn, replaced, edited, of an earlier version."""

from __future__ import annotations

import contextlib
import itertools
import os
import shutil
import sqlite3
import subprocess
import sys
from pathlib import Path

import answering
import kills
import pytest
from cases import answer, answer_all, started, study

from relgloss_view.base.errors import InputError
from relgloss_view.experiment.design.grid import Grid
from relgloss_view.experiment.report.sentences import losses_words
from relgloss_view.experiment.session import former_log
from relgloss_view.experiment.session.losses import (
    CHANGED,
    LOG_DAMAGED,
    LOG_MISSING,
    MISSING,
    UNCOUNTED,
    Loss,
    former_copies,
    warnings,
)
from relgloss_view.experiment.session.pool import read_pool
from relgloss_view.experiment.session.records import read_record
from relgloss_view.experiment.session.store import Store

SMALL = Grid((0.0, 2.0), (0.5, 1.0))
PAGE = 4096


@pytest.fixture
def file(tmp_path):
    return tmp_path / "s.sqlite"


def answered(file, count=3):
    """A closed session with so many answers."""
    with Store(file, study()) as store:
        flow = started(store)
        for k in range(count):
            answer(flow, k)


def edited(file, *statements):
    """As a program that is not relgloss, or a person with a tool, changes a file."""
    with contextlib.closing(sqlite3.connect(file, isolation_level=None)) as connection:
        for statement in statements:
            connection.execute(statement)


def losses_of(file):
    """As `analyse` and then as `run` find them; both find the same."""
    found = read_record(file, file.parent).losses
    with Store(file) as store:
        assert store.losses == found
    assert read_record(file, file.parent).losses == found  # and the file keeps them
    return found


class TestEdited:
    @pytest.mark.parametrize(
        ("change", "loss"),
        [
            ("DELETE FROM answer WHERE id = 2", Loss(MISSING, 1)),
            ("DELETE FROM answer WHERE id = 3", Loss(MISSING, 1)),
            ("DELETE FROM answer", Loss(MISSING, 3)),
            ("DELETE FROM trial WHERE position = 1", Loss(MISSING, 1)),
            ("UPDATE answer SET category = 4 WHERE id = 2", Loss(CHANGED)),
            ("UPDATE answer SET response_ms = 2 WHERE id = 2", Loss(CHANGED)),
            ("UPDATE trial SET setting = (setting + 1) % 42 WHERE position = 1", Loss(CHANGED)),
            ("UPDATE answer SET undone_utc = 'now' WHERE id = 3", Loss(CHANGED)),
            (
                "INSERT INTO answer SELECT NULL, observer, 5, question, category, response_ms, "
                "run, answered_utc, NULL FROM answer WHERE id = 1",
                Loss(UNCOUNTED, 1),
            ),
        ],
    )
    def test_is_seen_and_kept(self, file, change, loss):
        answered(file)
        edited(file, change)
        assert losses_of(file) == (loss,)

    def test_an_answer_that_stands_again(self, file):
        with Store(file, study()) as store:
            flow = started(store)
            answer(flow)
            flow.undo()
        edited(file, "UPDATE answer SET undone_utc = NULL")
        assert losses_of(file) == (Loss(CHANGED),)

    def test_two_losses_add_up(self, file):
        answered(file, 5)
        edited(file, "DELETE FROM answer WHERE id = 2")
        Store(file).close()
        edited(file, "DELETE FROM answer WHERE id > 3")
        assert losses_of(file) == (Loss(MISSING, 3),)
        (line,) = warnings(losses_of(file), file)
        assert line.startswith(f"{file}: lacks 3 answers that the program had stored")

    def test_the_report_names_it(self, file):
        answered(file)
        assert losses_words(read_pool([file], file.parent)) == []
        edited(file, "DELETE FROM answer WHERE id = 2")
        (line,) = losses_words(read_pool([file], file.parent))
        assert "lacks 1 answer that" in line

    def test_what_is_no_loss(self, file):
        """The control: whatever the program itself does."""
        with Store(file, study(grid=SMALL, ask_grain=True)) as store:
            flow = started(store)
            answer(flow)
            answer(flow)
            flow.undo()
            answer_all(flow)
            flow.end()
        with Store(file) as store:
            started(store)
        assert losses_of(file) == ()

    def test_the_tally_or_study_itself(self, file):
        answered(file)
        for change in ("UPDATE tally SET chain = x'00'", "UPDATE tally SET answers = -1",
                       "DELETE FROM tally", "INSERT INTO tally SELECT * FROM tally",
                       "UPDATE study SET content = content || ' '",
                       "INSERT INTO loss VALUES (NULL, 'now', 'mice', 3)"):  # fmt: skip
            copy = file.parent / "copy.sqlite"
            shutil.copyfile(file, copy)
            edited(copy, change)
            for opener in (
                lambda copy=copy: Store(copy),
                lambda copy=copy: read_record(copy, copy.parent),
            ):
                with pytest.raises(InputError, match="damaged"):
                    opener()


class TestReplaced:
    def test_older_content_in_the_same_file(self, file):
        """Seen by the attribute beside the content, where the file system keeps one."""
        answered(file, 2)
        older = file.read_bytes()
        with Store(file) as store:
            flow = started(store)
            for _ in range(4):
                answer(flow)
        if not os.listxattr(file):
            pytest.skip("no extended attributes here")
        file.write_bytes(older)
        assert losses_of(file) == (Loss(MISSING, 4),)

    def test_copies_raise_no_false_alarm(self, file):
        answered(file, 2)
        copy, other = file.parent / "copy.sqlite", file.parent / "other.sqlite"
        shutil.copyfile(file, copy)  # without the attribute
        answered(other, 5)
        other.write_bytes(file.read_bytes())  # with that of another session
        shutil.copy2(file, file.parent / "same.sqlite")
        for each in (copy, other, file.parent / "same.sqlite"):
            assert losses_of(each) == ()


class TestTorn:
    """A write that was cut short, and its journal gone: any pages old, any new."""

    def states(self, file, count, act):
        """The file before and after one more step, and the journal of the write between."""
        with Store(file, study()) as store:
            flow = started(store)
            for k in range(count):
                answer(flow, k % 5)
            before = file.read_bytes()
            act(store, flow)
            after = file.read_bytes()
        return before, after

    @pytest.mark.parametrize("count", [2, 60])
    def test_every_mixture_is_seen_or_whole(self, file, count):
        before, after = self.states(file, count if count < 42 else 40, lambda s, f: answer(f, 4))
        pages = [(k * PAGE, (k + 1) * PAGE) for k in range(len(after) // PAGE)]
        changed = [k for k, (a, b) in enumerate(pages) if before[a:b] != after[a:b]]
        assert 3 <= len(changed) <= 8
        stored = min(count, 40)
        torn = refused = 0
        for news in itertools.product((False, True), repeat=len(changed)):
            data = bytearray(before)
            for page, new in zip(changed, news, strict=True):
                if new:
                    data[page * PAGE : (page + 1) * PAGE] = after[page * PAGE : (page + 1) * PAGE]
            file.write_bytes(data)
            with contextlib.suppress(OSError):
                os.removexattr(file, answering.ATTRIBUTE)
            try:
                record = read_record(file, file.parent)
            except InputError:
                refused += 1
                continue
            torn += bool(record.losses)
            assert len(record.answers) >= stored or record.losses
            if len(set(news)) == 1:
                assert record.losses == ()
        assert torn + refused >= 2 ** len(changed) // 2  # the control: mixtures do occur


def changes_nothing(folder):
    """What is in a folder, to be compared."""
    return {p.name: p.read_bytes() for p in folder.iterdir()}


class TestJournal:
    def left_by_a_kill(self, file, more):
        """A file with a journal of a write that was `more` answers before its last."""
        answered(file, 2)
        journal = kills.hot_journal(file)
        if more:
            with Store(file) as store:
                flow = started(store)
                for _ in range(more):
                    answer(flow)
        Path(f"{file}-journal").write_bytes(journal)

    def test_one_of_an_earlier_write_is_not_put_back(self, file):
        """SQLite would put it back: the file would be whole, and lack what came since."""
        self.left_by_a_kill(file, 3)
        control = file.parent / "control"
        control.mkdir()
        for each in (file, Path(f"{file}-journal")):
            shutil.copyfile(each, control / each.name)
        with contextlib.closing(sqlite3.connect(control / file.name)) as connection:
            (left,) = connection.execute("SELECT count(*) FROM answer").fetchone()
        assert left == 2
        shutil.rmtree(control)
        before = changes_nothing(file.parent)
        record = read_record(file, file.parent)
        assert (len(record.answers), record.losses) == (5, ())
        with pytest.raises(InputError, match=r"move s\.sqlite-journal away"):
            Store(file)
        assert changes_nothing(file.parent) == before
        Path(f"{file}-journal").unlink()
        assert losses_of(file) == ()

    @pytest.mark.parametrize("keep", [0, 1, 100, 512, 3000])
    def test_one_that_was_cut(self, file, keep):
        self.left_by_a_kill(file, 0)
        journal = Path(f"{file}-journal")
        journal.write_bytes(journal.read_bytes()[:keep])
        assert len(read_record(file, file.parent).answers) == 2
        journal.unlink()
        assert losses_of(file) == ()

    def test_its_own_is_put_back(self, file):
        self.left_by_a_kill(file, 0)
        before = changes_nothing(file.parent)
        assert len(read_record(file, file.parent).answers) == 2
        assert changes_nothing(file.parent) == before
        assert losses_of(file) == ()
        assert os.listdir(file.parent) == ["s.sqlite"]

    @pytest.mark.skipif(os.geteuid() != 0, reason="needs root, to become somebody else")
    def test_it_is_read_where_nothing_can_be_written(self, file):
        self.left_by_a_kill(file, 0)
        for folder in list(file.parents)[:4]:
            os.chmod(folder, os.stat(folder).st_mode | 0o055)
        for each in file.parent.iterdir():
            each.chmod(0o444)
        before = changes_nothing(file.parent)
        os.seteuid(65534)
        try:
            assert len(read_record(file, Path("/tmp")).answers) == 2
            with pytest.raises(InputError, match="can't be written"):
                Store(file)
        finally:
            os.seteuid(0)
        assert changes_nothing(file.parent) == before

    @pytest.mark.parametrize("suffix", ["", "-journal", "-wal", "-shm"])
    @pytest.mark.parametrize("kind", ["pipe", "folder", "link to a pipe", "link to nothing"])
    def test_what_is_no_file_is_not_opened(self, file, suffix, kind):
        if suffix:
            answered(file, 1)
        place = Path(f"{file}{suffix}")
        if kind == "folder":
            place.mkdir()
        elif kind == "pipe":
            os.mkfifo(place)
        else:
            place.symlink_to(file.parent / "pipe")
            if kind == "link to a pipe":
                os.mkfifo(file.parent / "pipe")
        for opener in (lambda: Store(file), lambda: read_record(file, file.parent)):
            with pytest.raises(InputError) as caught:
                opener()
            assert len(str(caught.value).splitlines()) == 1

    def test_a_log_that_is_not_its_own(self, file):
        """SQLite would read it in place of the file's own pages."""
        answered(file, 2)
        Path(f"{file}-wal").write_bytes(b"x" * 100)
        for opener in (lambda: Store(file), lambda: read_record(file, file.parent)):
            with pytest.raises(InputError, match=r"move s\.sqlite-wal away"):
                opener()


@pytest.fixture(scope="module")
def killed(tmp_path_factory):
    """As it was left by a kill between two answers, all 40 of them in the log alone.

    A kill within an answer can leave half of it in the log, which is a damaged one.
    """
    file = tmp_path_factory.mktemp("former") / "s.sqlite"
    words = [sys.executable, answering.__file__, str(file), "former", "40"]
    with subprocess.Popen(words, stdout=subprocess.PIPE) as process:
        for _ in range(40):
            process.stdout.readline()
        process.kill()
    return file


class TestFormerVersion:
    """Files that were written into a log, closed or left by a kill."""

    def copied(self, killed, tmp_path, change=lambda log: log):
        for part in killed.parent.iterdir():
            shutil.copyfile(part, tmp_path / part.name)
        log = tmp_path / "s.sqlite-wal"
        data = change(bytearray(log.read_bytes()))
        log.unlink()
        if data is not None:
            log.write_bytes(data)
        return tmp_path / "s.sqlite"

    def test_with_its_log(self, killed, tmp_path):
        file = self.copied(killed, tmp_path)
        before = changes_nothing(tmp_path)
        record = read_record(file, tmp_path)
        assert len(record.answers) >= 40
        assert record.losses == ()
        assert changes_nothing(tmp_path) == before
        with Store(file) as store:
            assert len(store.answers()) == len(record.answers)
            assert not Path(f"{file}-wal").exists()
        assert losses_of(file) == ()
        with contextlib.closing(sqlite3.connect(file)) as connection:
            assert connection.execute("PRAGMA user_version").fetchone() == (2,)

    @pytest.mark.parametrize(
        ("change", "cause"),
        [
            (lambda log: None, LOG_MISSING),
            (lambda log: log[:0], LOG_MISSING),
            (lambda log: log[:20], LOG_DAMAGED),
            (lambda log: log[: len(log) // 2], LOG_DAMAGED),
            (lambda log: log[:-1], LOG_DAMAGED),
            (lambda log: _flipped(log, 3), LOG_DAMAGED),
            (lambda log: _flipped(log, 17), LOG_DAMAGED),
            (lambda log: _flipped(log, 32 + 5), LOG_DAMAGED),
            (lambda log: _flipped(log, 32 + 9), LOG_DAMAGED),
            (lambda log: _flipped(log, len(log) // 2), LOG_DAMAGED),
            (lambda log: _flipped(log, len(log) - 1), LOG_DAMAGED),
        ],
    )
    def test_without_it_or_with_a_damaged_one(self, killed, tmp_path, change, cause):
        # The kill may have come after another answer than the fortieth.
        (tmp_path / "whole").mkdir()
        with Store(self.copied(killed, tmp_path / "whole")) as store:
            whole = len(store.answers())
        file = self.copied(killed, tmp_path, change)
        assert losses_of(file) == (Loss(cause),)
        with Store(file) as store:
            assert len(store.answers()) < whole  # the control: something is lost
        # Nothing of it is gone: should the log turn up, the file as it was is there for it.
        (former,) = former_copies(file)
        assert former.read_bytes() == killed.read_bytes()
        assert former.stat().st_mode & 0o777 == 0o600
        Store(file).close()
        assert former_copies(file) == [former]

    def test_a_log_that_turns_up(self, killed, tmp_path):
        """A session was renamed and its log was not; the study has gone on without it."""
        whole = self.copied(killed, tmp_path)
        count = len(read_record(whole, tmp_path).answers)
        file, log = tmp_path / "renamed.sqlite", Path(f"{whole}-wal")
        whole.rename(file)
        Store(file).close()
        (line,) = warnings(losses_of(file), file)
        assert "renamed.sqlite.former is the file as it was" in line
        log.rename(tmp_path / "renamed.sqlite.former-wal")
        record = read_record(tmp_path / "renamed.sqlite.former", tmp_path)
        assert (len(record.answers), record.losses) == (count, ())

    def test_reading_leaves_nothing(self, killed, tmp_path):
        file = self.copied(killed, tmp_path, lambda log: None)
        assert read_record(file, tmp_path).losses == (Loss(LOG_MISSING),)
        assert [path.name for path in tmp_path.iterdir()] == ["s.sqlite"]

    def test_frames_of_an_earlier_use_are_no_damage(self, tmp_path):
        file = tmp_path / "a.sqlite"
        with contextlib.closing(sqlite3.connect(file, isolation_level=None)) as connection:
            connection.execute("PRAGMA journal_mode = WAL")
            connection.execute("CREATE TABLE t (x)")
            for _ in range(20):
                connection.execute("INSERT INTO t VALUES (zeroblob(3000))")
            connection.execute("PRAGMA wal_checkpoint(FULL)")
            connection.execute("INSERT INTO t VALUES (1)")
            assert former_log.lost_with(Path(f"{file}-wal")) is None

    def test_closed_files(self, file):
        """One at rest, with the tables of the first files too."""
        for first in (False, True):
            answered(file, 3)
            answering.to_former(file, first=first)
            record = read_record(file, file.parent)
            assert (len(record.answers), record.losses) == (3, ())
            assert losses_of(file) == ()
            with Store(file) as store:
                answer(started(store))
            assert losses_of(file) == ()
            file.unlink()

    def test_what_such_a_file_has_kept(self, file):
        answered(file, 1)
        answering.to_former(file)
        edited(file, "INSERT INTO event VALUES (NULL, 1, 'now', 'log missing', '')")
        assert losses_of(file) == (Loss(LOG_MISSING),)

    def test_nobody_has_answered(self, killed, tmp_path):
        file = self.copied(killed, tmp_path, lambda log: None)
        with pytest.raises(InputError, match=r"s\.sqlite-wal is or was not beside it.*no answers"):
            read_pool([file], tmp_path)


def _flipped(log, place):
    log[place] ^= 4
    return log


def test_every_fault_of_a_few_kills(tmp_path):
    sums = kills.main(["--kills", "2"])
    assert set(sums) == set(kills.FAULTS)
    assert all(silent == wrong == 0 for _, _, silent, wrong, _ in sums.values())
    for fault in ("none", "gone", "renamed", kills.ALONE):
        assert sums[fault][:2] == [0, 0]
