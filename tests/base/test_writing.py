"""Output files: whole or not at all, and only where a file may stand."""

from __future__ import annotations

import os
import socket

import pytest

from relgloss_view.base.errors import InputError
from relgloss_view.base.writing import check_writable, make_folder, whole_file, whole_folder


def fail(place, names=(), fault=KeyboardInterrupt):
    """Fail in the middle of writing."""
    with place as temporary:
        for name in names:
            (temporary / name).write_text("new")
        if fault:
            raise fault


def write(path, text="new"):
    with whole_file(path) as temporary:
        temporary.write_text(text)


def refused(path):
    """The one line by which both ways to a place refuse it."""
    with pytest.raises(InputError) as caught:
        check_writable(path)
    with pytest.raises(InputError) as again:
        write(path)
    assert str(again.value) == str(caught.value)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def test_a_file_appears_whole(tmp_path):
    write(tmp_path / "a.txt")
    assert (tmp_path / "a.txt").read_text() == "new"
    with pytest.raises(KeyboardInterrupt):
        fail(whole_file(tmp_path / "a.txt"))
    assert (tmp_path / "a.txt").read_text() == "new"
    assert [p.name for p in tmp_path.iterdir()] == ["a.txt"]


def test_what_is_no_regular_file_is_never_replaced(tmp_path):
    os.mkfifo(tmp_path / "fifo")
    (tmp_path / "link").symlink_to("/dev/null")
    with socket.socket(socket.AF_UNIX) as server:
        server.bind(str(tmp_path / "socket"))
        for name in ("fifo", "socket", "link"):
            before = (tmp_path / name).lstat()
            assert "not a regular file" in refused(tmp_path / name)
            assert (tmp_path / name).lstat().st_ino == before.st_ino
    assert "not a regular file" in refused("/dev/null")
    assert "is a folder" in refused(tmp_path)


def test_links_are_followed(tmp_path):
    (tmp_path / "far").mkdir()
    real, link = tmp_path / "far" / "real.txt", tmp_path / "link.txt"
    link.symlink_to(real)
    for text in ("dangling", "again"):
        write(link, text)
        assert link.is_symlink()
        assert real.read_text() == text
    (tmp_path / "a").symlink_to(tmp_path / "b")
    (tmp_path / "b").symlink_to(tmp_path / "a")
    assert "choose another place" in refused(tmp_path / "a")


@pytest.mark.parametrize(
    "name", ["x" * 300, "a/" * 3000 + "b", "nul\0.png", "lone\ud800.png", "no/such/folder.png", ""]
)
def test_impossible_names_are_one_line(tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    message = refused(name)
    assert "with -o" not in message
    assert list(tmp_path.iterdir()) == []
    if "/" not in name and name:
        with pytest.raises(InputError, match="can't be written"):
            make_folder(name)


def test_a_folder_that_may_not_be_looked_into(tmp_path, monkeypatch):
    real = os.stat

    def stat(path, *args, **kwargs):
        if str(path).endswith("a.png"):
            raise PermissionError(13, "Permission denied")
        return real(path, *args, **kwargs)

    monkeypatch.setattr(os, "stat", stat)
    assert "Permission denied" in refused(tmp_path / "a.png")


class TestWholeFolder:
    def test_a_new_one_appears_at_once(self, tmp_path):
        folder = tmp_path / "deep" / "new"
        with whole_folder(folder, "list") as temporary:
            (temporary / "a").write_text("1")
            assert not (tmp_path / "deep").exists()
        assert [p.name for p in folder.iterdir()] == ["a"]
        assert [p.name for p in tmp_path.iterdir()] == ["deep"]
        (tmp_path / "usual").mkdir()
        assert folder.stat().st_mode == (tmp_path / "usual").stat().st_mode

    @pytest.mark.parametrize("exists", [False, True])
    def test_failure_leaves_nothing_new(self, tmp_path, exists):
        folder = tmp_path / "f"
        if exists:
            folder.mkdir()
            (folder / "a").write_text("old")
        with pytest.raises(KeyboardInterrupt):
            fail(whole_folder(folder, "list"), ["a"])
        assert [p.name for p in tmp_path.rglob("*")] == (["f", "a"] if exists else [])
        assert not exists or (folder / "a").read_text() == "old"

    def test_old_files_stay_or_are_replaced(self, tmp_path):
        for name in ("mine", "a", "list", "gone"):
            (tmp_path / name).write_text("old")
        with whole_folder(tmp_path, "list", lambda old: ["gone", "a", "../x"]) as temporary:
            for name in ("list", "a", "z"):
                (temporary / name).write_text("new")
        found = {p.name: p.read_text() for p in tmp_path.iterdir()}
        assert found == {"mine": "old", "a": "new", "z": "new", "list": "new"}

    def test_a_folder_in_a_files_place_changes_nothing(self, tmp_path):
        (tmp_path / "z").mkdir()
        (tmp_path / "list").write_text("old")
        with pytest.raises(InputError, match="is a folder"):
            fail(whole_folder(tmp_path, "list"), ["a", "z", "list"], fault=None)
        assert sorted(p.name for p in tmp_path.iterdir()) == ["list", "z"]
        assert (tmp_path / "list").read_text() == "old"


def _fill_a_full_disk(folder):
    (folder / "sub").mkdir()
    with whole_file(folder / "sub" / "a.png"):
        raise OSError(28, "No space left on device")


def test_messages_name_places_and_not_temporary_folders(tmp_path):
    """A full disk, say, while a folder is filled."""
    for exists in (False, True):
        place = tmp_path / f"out-{exists}"
        if exists:
            place.mkdir()
        with pytest.raises(InputError) as fault, whole_folder(place, "list.json") as folder:
            _fill_a_full_disk(folder)
        assert str(fault.value).startswith(f"{place}/sub/a.png: can't be written (No space")
        assert ".part" not in str(fault.value)
