"""After a power cut outputs are whole, old or new, and what was acknowledged is on the disk.

The disk is recorded (recorder.py), and cut wherever it may be: what was flushed is there, and of
the rest any part. `power_cuts.py SCENARIO --cuts 10000` does the same as often as one likes.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import disk
import kernel
import power_cuts
import pytest
from disk import Cut, Image, Log, Record
from recorder import FLUSH, MARK, RECORD, WRITE

WHY = kernel.missing()
needs_disk = pytest.mark.skipif(WHY is not None, reason=f"no disk can be recorded: {WHY}")
LONGEST_S = 900.0


def outcome(place, *words):
    """What the script prints for a scenario."""
    done = power_cuts.in_room(words, place, LONGEST_S)
    assert done.returncode in (0, 1), done.stderr
    return json.loads(done.stdout)


def faults(place, *words):
    return outcome(place, *words)["faults"]


# --- images of a cut, by hand ---------------------------------------------------------------------


def log(*records):
    return Log(Image.of(bytes(8 * disk.CHUNK)), tuple(records))


def write(offset, letter, length=1024):
    return Record(WRITE, offset, letter * length)


def content(image, file):
    image.write(file)
    return file.read_bytes()


class TestImages:
    def test_flushed_writes_are_always_there(self, tmp_path):
        recorded = log(write(0, b"a"), Record(FLUSH, 0, b""), write(0, b"b"), write(4096, b"c"))
        cuts = [Cut(4, kind, seed) for kind in disk.SURVIVORS for seed in range(20)]
        found = set()
        for _, image in disk.images(recorded, cuts):
            left = content(image, tmp_path / "image")
            assert not left[:1024].strip(b"ab")
            assert not left[4096:5120].strip(b"c\0")
            found.add((left[:1], left[1023:1024], left[4096:4097], left[5119:5120]))
        assert {(b"a", b"a", b"\0", b"\0"), (b"b", b"b", b"c", b"c")} <= found
        assert {(b"a", b"a", b"c", b"c"), (b"b", b"b", b"\0", b"\0")} <= found  # in any order
        assert any(first != last for first, last, _, _ in found)  # torn

    def test_what_came_later_is_not_there(self, tmp_path):
        recorded = log(write(0, b"a"), Record(FLUSH, 0, b""), write(0, b"b"), Record(FLUSH, 0, b""))
        kinds = {1: b"a\0", 2: b"a", 3: b"ab", 4: b"b"}
        for position, letters in kinds.items():
            for _, image in disk.images(recorded, [Cut(position, "some", s) for s in range(9)]):
                assert content(image, tmp_path / "image")[0] in letters

    def test_a_write_is_torn_between_sectors(self):
        for seed in range(50):
            for record in disk.surviving([write(512, b"a", 4096)], Cut(1, "torn", seed)):
                assert record.offset % disk.SECTOR == 0 == len(record.data) % disk.SECTOR
                assert 512 <= record.offset <= record.offset + len(record.data) <= 4608

    def test_marks_and_positions(self):
        parts = [(WRITE, b"abc"), (MARK, b"one\ntw"), (MARK, b"o\n"), (FLUSH, b"")]
        raw = b"".join(RECORD.pack(kind, 7, len(data)) + data for kind, data in parts)
        recorded = Log.parsed(Image.of(b""), raw)
        assert [r.kind for r in recorded.records] == [WRITE, MARK, MARK, FLUSH]
        assert recorded.records[0] == Record(WRITE, 7, b"abc")
        assert [recorded.marks(n) for n in range(4)] == [[], [], ["one"], ["one", "two"]]
        assert recorded.position("one") == 2
        assert recorded.count(MARK) == 2

    def test_cuts_reach_both_ends(self):
        cuts = disk.chosen_cuts(10, 20, 11, seed=1)
        assert [cut.position for cut in cuts] == list(range(10, 21))
        assert cuts[-1].survivors == "none"
        assert {cut.survivors for cut in disk.chosen_cuts(0, 9, 99, 1)} == set(disk.SURVIVORS)


# --- the recorded disk ----------------------------------------------------------------------------


@needs_disk
def test_files_are_whole_and_kept(tmp_path):
    found = outcome(tmp_path, "files", "--cuts", "20")
    assert found["cuts"] == 20
    assert found["flushes"] > 6
    assert not found["faults"]


@needs_disk
def test_a_missing_fsync_of_the_folder_is_seen(tmp_path):
    """The control: the program reports a file that the disk does not have."""
    found = faults(tmp_path, "files", "--cuts", "10", "--without", "folders")
    assert any("is missing" in fault for fault in found)


@pytest.mark.slow
@needs_disk
def test_a_missing_fsync_of_the_file_is_seen(tmp_path):
    """The control: another program has the disk keep the new name, before there is content."""
    words = ("--neighbour", "--file-system", "ext4-writeback", "--without", "files")
    assert any("result.txt is empty" in fault for fault in faults(tmp_path, "files", *words))


@pytest.mark.slow
@needs_disk
@pytest.mark.parametrize("beside", [(), ("--neighbour", "--period-s", "0.002")])
@pytest.mark.parametrize("scenario", power_cuts.SCENARIOS)
def test_nothing_is_lost(tmp_path, scenario, beside):
    """Alone on the disk, and beside a program that has the names of all files kept."""
    assert not faults(tmp_path, scenario, "--cuts", "100", "--again", "6", *beside)


@pytest.mark.slow
@needs_disk
@pytest.mark.parametrize("scenario", ["files", "folders", "together", "people"])
@pytest.mark.parametrize(
    ("file_system", "words"), [("ext4-writeback", ("--neighbour",)), ("xfs", ()), ("btrfs", ())]
)
def test_nothing_is_lost_on_other_file_systems(tmp_path, scenario, file_system, words):
    if why := disk.FILE_SYSTEMS[file_system].missing():
        pytest.skip(why)
    words = ("--cuts", "60", "--file-system", file_system, *words)
    assert not faults(tmp_path, scenario, *words)


@pytest.mark.slow
@needs_disk
@pytest.mark.parametrize("scenario", ["files", "people"])
def test_a_file_system_that_never_flushes_is_seen(tmp_path, scenario):
    """The control of the disk: what the program asks for does not reach it."""
    assert faults(tmp_path, scenario, "--file-system", "ext4-nobarrier")


@pytest.mark.slow
@needs_disk
@pytest.mark.parametrize(
    "pragmas",
    [
        ("synchronous=OFF",),
        # SQLite's own default: a journal that was deleted is there again, and takes back the
        # answer. EXTRA is what keeps that from happening.
        ("locking_mode=NORMAL", "journal_mode=DELETE", "synchronous=FULL"),
    ],
)
def test_a_careless_journal_is_seen(tmp_path, pragmas):
    found = faults(tmp_path, "people", "--cuts", "200", "--pragma", *pragmas)
    assert any("acknowledged answers are lost" in fault for fault in found)


@pytest.mark.slow
@needs_disk
def test_the_same_journal_with_its_folder_synced_loses_nothing(tmp_path):
    pragmas = ("locking_mode=NORMAL", "journal_mode=DELETE", "synchronous=EXTRA")
    assert not faults(tmp_path, "people", "--cuts", "100", "--pragma", *pragmas)


@needs_disk
def test_a_kill_leaves_no_mount_and_no_device(tmp_path):
    words = [sys.executable, power_cuts.__file__, "people", "--cuts", "100000"]
    room = kernel.in_private_room([*words, "--place", str(tmp_path)])
    process = subprocess.Popen(room, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        assert soon(lambda: devices(tmp_path)), "it has begun"
        assert str(tmp_path) not in Path("/proc/mounts").read_text()  # a room of its own
    finally:
        os.kill(process.pid, signal.SIGKILL)
        process.wait()
    assert soon(lambda: not devices(tmp_path))
    assert os.listdir(tmp_path) == []


def devices(place):
    """The loop devices on files of a folder."""
    files = Path("/sys/block").glob("loop*/loop/backing_file")
    return [f for f in files if str(place) in f.read_text()]


def soon(happens, patience_s=20.0):
    end = time.monotonic() + patience_s
    while not happens():
        if time.monotonic() > end:
            return False
        time.sleep(0.02)
    return True
