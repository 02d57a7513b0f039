"""What every limit leaves, and the line that refuses what is too much."""

import resource
import subprocess
import sys

import pytest

from relgloss_view.base import room
from relgloss_view.base.errors import InputError
from relgloss_view.base.room import GB, MB, Need, Room, check_room

LINUX = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="reads /proc")


def write(folder, **files):
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in files.items():
        (folder / name.replace("__", ".")).write_text(text)
    return folder


class TestControlGroups:
    def test_version_2_counts_what_is_cached_as_free(self, tmp_path):
        stat = "anon 100\ninactive_file 30\n"
        folder = write(tmp_path, memory__max="1000\n", memory__current="400\n", memory__stat=stat)
        assert room._left_in(folder) == 1000 - 400 + 30

    def test_version_1(self, tmp_path):
        folder = write(
            tmp_path,
            memory__limit_in_bytes="1000",
            memory__usage_in_bytes="400",
            memory__stat="inactive_file 1\ntotal_inactive_file 50\n",
        )
        assert room._left_in(folder) == 650

    @pytest.mark.parametrize("limit", ["max", "9223372036854771712", "", "x"])
    def test_without_a_limit(self, tmp_path, limit):
        stat = "inactive_file 30\n"
        folder = write(tmp_path, memory__max=limit, memory__current="400", memory__stat=stat)
        assert room._left_in(folder) is None

    @pytest.mark.parametrize("line", ["0::/a/b", "4:memory:/a/b", "4:cpu,memory:/a/b"])
    def test_a_group_and_those_above_it(self, tmp_path, line):
        base = tmp_path / "memory" if "memory" in line else tmp_path
        (base / "a").mkdir(parents=True)  # b is there on the host only
        listed = tmp_path / "listed"
        listed.write_text(f"3:cpuset:/z\n{line}\n\n")
        assert room._control_groups(str(tmp_path), str(listed)) == [base / "a", base]

    def test_a_group_that_limits_refuses(self, tmp_path, monkeypatch):
        write(
            tmp_path, memory__max="100000000", memory__current="0", memory__stat="inactive_file 0"
        )
        monkeypatch.setattr(room, "_control_groups", lambda: [tmp_path])
        with pytest.raises(
            InputError, match=r"needs about 200 MB .* 100 MB is left in this control"
        ):
            check_room(Need(200 * MB), "a picture", "give a smaller --size")
        check_room(Need(90 * MB), "a picture", "")


def test_each_need_is_held_against_its_own_limit(monkeypatch):
    need = Need(1 * MB, 2 * MB, 3 * MB)
    for of, count in (("resident", 1.0), ("data", 2.0), ("addresses", 3.0)):
        monkeypatch.setattr(room, "rooms", lambda of=of, count=count: [Room(count * MB, "", of)])
        check_room(need, "it", "")
        lower = [Room(0.99 * count * MB, "is free", of)]
        monkeypatch.setattr(room, "rooms", lambda lower=lower: lower)
        with pytest.raises(InputError, match=f"it needs about {count:.0f} MB of memory"):
            check_room(need, "it", "wait")


def test_needs_add_up():
    both = Need(1.0).plus(Need(1.0, 5.0, 20.0))
    assert both == (2.0, 6.0, 21.0)


@LINUX
def test_limits_of_a_shell_are_seen():
    code = """
import resource
from relgloss_view.base.room import rooms
free = {r.of: r.left for r in rooms()}
resource.setrlimit(resource.RLIMIT_AS, (300 << 20, 300 << 20))
resource.setrlimit(resource.RLIMIT_DATA, (100 << 20, 100 << 20))
left = {r.limit.split()[-1]: r.left for r in rooms()}
assert 0 < left["-v"] < 300 << 20 and 0 < left["-d"] < 100 << 20, left
assert free["resident"] > 1e6
"""
    subprocess.run([sys.executable, "-c", code], check=True, timeout=60)


@LINUX
@pytest.mark.parametrize("megabytes", [60, 150])
def test_too_little_to_start_is_one_line(megabytes, tmp_path):
    def limit():
        resource.setrlimit(resource.RLIMIT_AS, (megabytes << 20, megabytes << 20))

    words = ["-m", "relgloss_view.cli", "snapshot", "--size", "8x8", "-o", str(tmp_path / "a.png")]
    done = subprocess.run(
        [sys.executable, *words], preexec_fn=limit, capture_output=True, text=True, timeout=60,
        env={"PATH": "", "OPENBLAS_NUM_THREADS": "2", "PYTHONPATH": ":".join(sys.path)},
    )  # fmt: skip
    assert done.returncode == 1, done.stderr
    assert done.stderr.count("\n") == 1
    assert "the program needs about" in done.stderr
    assert "ulimit -v; raise the limit" in done.stderr


class TestImports:
    @pytest.fixture
    def gate(self, monkeypatch):
        monkeypatch.setattr(sys, "meta_path", list(sys.meta_path))
        room.guard_imports()
        room.guard_imports()
        assert sum(isinstance(finder, room._ImportGate) for finder in sys.meta_path) == 1

    def test_a_library_that_there_is_no_memory_for(self, gate, monkeypatch):
        monkeypatch.setattr(room, "LIBRARY", {"wave": (9 * MB, 9 * MB, 9 * MB)})
        monkeypatch.setattr(room, "rooms", lambda: [Room(8 * MB, "is free", "addresses")])
        monkeypatch.delitem(sys.modules, "wave", raising=False)
        with pytest.raises(InputError, match="the program needs about 9 MB of memory, and 8 MB"):
            import wave
        import colorsys  # noqa: F401 - the control: another one is not looked at

        monkeypatch.setattr(room, "rooms", lambda: [Room(9 * MB, "is free", "addresses")])
        import wave  # noqa: F401

    @LINUX
    def test_scipy_waits_for_no_memory_that_never_comes(self):
        """Its OpenBLAS asks again and again, within a call that no signal ends."""
        code = """
import numpy, resource
from relgloss_view.base.room import _fields, guard_imports
taken = int(_fields("/proc/self/status", "VmSize")["VmSize"])
guard_imports()
resource.setrlimit(resource.RLIMIT_AS, (taken + (100 << 20), taken + (100 << 20)))
import scipy.special
"""
        done = subprocess.run(
            [sys.executable, "-c", code], capture_output=True, text=True, timeout=60
        )
        assert "InputError: the program needs about" in done.stderr


@LINUX
def test_too_little_for_the_window_is_one_line(tmp_path):
    """OpenGL and fonts ended it in several ways, up to a segmentation fault."""

    def limit():
        resource.setrlimit(resource.RLIMIT_AS, (700 << 20, 700 << 20))

    words = ["-m", "relgloss_view.cli", "view", "--screenshot", str(tmp_path / "a.png")]
    done = subprocess.run(
        [sys.executable, *words], preexec_fn=limit, capture_output=True, text=True, timeout=60,
        env={"PATH": "", "OPENBLAS_NUM_THREADS": "2", "PYTHONPATH": ":".join(sys.path)},
    )  # fmt: skip
    assert done.returncode == 1, done.stderr
    assert done.stderr.count("\n") == 1
    assert "the window needs about" in done.stderr


def test_words_of_sizes():
    assert [room._size(v) for v in (2.14 * GB, 1 * GB, 450 * MB)] == ["2.1 GB", "1 GB", "450 MB"]
