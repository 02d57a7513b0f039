"""Room: how much memory this process may still take, and one clear line where that is too little.

OpenGL drivers, OpenBLAS and OpenEXR end the process where an allocation fails. So what takes much
memory asks here first.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from relgloss_view.base.errors import InputError

MB, GB = 1e6, 1e9
UNLIMITED = 1 << 60  #: a control group of version 1 without a limit holds a number above it
THREAD_ADDRESSES = 72 * 1024 * 1024  #: of a thread: its stack, and what glibc sets aside for it
STACK = 8 * 1024 * 1024
#: What the interpreter and numpy take before anything is read, with one thread of OpenBLAS; and
#: what each further thread takes.
START, BLAS_THREAD = 140 * MB, 42 * MB
LIBRARIES = 50 * MB  #: of START, what files are mapped to: no writable addresses


#: What a library takes when it is first imported, beside START: resident, data and addresses.
#: Measured. scipy has an OpenBLAS of its own, which waits for ever where it finds no memory.
LIBRARY = {
    "scipy": (70 * MB, 110 * MB, 215 * MB),
    "imgui_bundle": (35 * MB, 25 * MB, 90 * MB),
    "matplotlib": (40 * MB, 30 * MB, 50 * MB),
    "pyarrow": (70 * MB, 40 * MB, 230 * MB),
}
WITH_BLAS = "scipy"


class Need(NamedTuple):
    """What a task takes at most, bytes more than now."""

    resident: float  #: memory
    data: float = 0.0  #: of writable addresses, where that is more
    addresses: float = 0.0  #: of all addresses, where that is more

    def plus(self, other: Need) -> Need:
        """Both at once."""
        return Need(
            self.resident + other.resident,
            max(self.data, self.resident) + max(other.data, other.resident),
            max(self) + max(other),
        )


class Room(NamedTuple):
    """What may still be taken, bytes, and by which of the limits."""

    left: float
    limit: str
    of: str  #: of Need


def rooms() -> Iterator[Room]:
    """What each limit of this machine leaves; none where the system shows none."""
    free = _fields("/proc/meminfo", "MemAvailable", "SwapFree")
    if "MemAvailable" in free:
        yield Room(sum(free.values()), "is free", "resident")
    for path in _control_groups():
        left = _left_in(path)
        if left is not None:
            yield Room(left, "is left in this control group", "resident")
    yield from _resource_limits()


def available_bytes() -> float | None:
    """Memory that this process may still take, by the tightest limit; None where none is known."""
    return min((room.left for room in rooms() if room.of == "resident"), default=None)


def check_room(need: Need, task: str, remedy: str) -> None:
    """Raise InputError where a task needs more memory than there is.

    task: what needs it, as the beginning of a sentence. remedy: one step.

    >>> check_room(Need(1e6), "a small table", "close other programs")
    >>> check_room(Need(1e18), "a large table", "thin it out")  # doctest: +ELLIPSIS
    Traceback (most recent call last):
    ...
    relgloss_view.base.errors.InputError: a large table needs about 1e+09 GB of memory, and ...
    """
    for room in rooms():
        needed = {
            "resident": need.resident,
            "data": max(need.data, need.resident),
            "addresses": max(need),
        }[room.of]
        if needed > room.left:
            raise InputError(
                f"{task} needs about {_size(needed)} of memory, and {_size(max(room.left, 0.0))} "
                f"{room.limit}; {remedy}"
            )


def check_start() -> None:
    """Raise InputError where numpy could not even be imported."""
    if "numpy" not in sys.modules:
        taken = START + (blas_threads() - 1) * BLAS_THREAD
        check_room(Need(40 * MB, taken - LIBRARIES, taken), "the program", "raise the limit")


class _ImportGate:
    """Refuses the import of a library that there is no memory for; it finds no module itself."""

    def find_spec(self, name: str, *_: object) -> None:
        need = LIBRARY.get(name)
        if need is None:
            return
        resident, data, addresses = need
        if "numpy" not in sys.modules:  # which most of them import unasked
            check_start()
        threads = (blas_threads() - 1) * BLAS_THREAD if name == WITH_BLAS else 0.0
        check_room(
            Need(resident, data + threads, addresses + threads), "the program", "raise the limit"
        )


def guard_imports() -> None:
    """From now on InputError where a large library is imported without the memory for it.

    For the command alone: it changes how this process imports.
    """
    if not any(isinstance(finder, _ImportGate) for finder in sys.meta_path):
        sys.meta_path.insert(0, _ImportGate())


def blas_threads() -> int:
    """How many threads OpenBLAS starts, each with memory of its own."""
    for name in ("OPENBLAS_NUM_THREADS", "GOTO_NUM_THREADS", "OMP_NUM_THREADS"):
        count = os.environ.get(name, "")
        if count.isdecimal() and int(count) > 0:
            return min(int(count), processors())
    return min(processors(), 64)


def processors() -> int:
    """How many processors this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _resource_limits() -> Iterator[Room]:
    """What `ulimit -v` and `ulimit -d` leave."""
    try:
        import resource
    except ImportError:  # Windows
        return
    taken = _fields("/proc/self/status", "VmSize", "VmData")
    for kind, field, word, of in (
        (resource.RLIMIT_AS, "VmSize", "ulimit -v", "addresses"),
        (resource.RLIMIT_DATA, "VmData", "ulimit -d", "data"),
    ):
        limit = resource.getrlimit(kind)[0]
        if limit != resource.RLIM_INFINITY and field in taken:
            yield Room(limit - taken[field], f"is left under the limit of {word}", of)


def _fields(file: str, *names: str) -> dict[str, float]:
    """Numbers of a file of /proc, bytes; those that it has."""
    found = {}
    try:
        for line in Path(file).read_text(encoding="utf-8", errors="replace").splitlines():
            name, _, rest = line.partition(":")
            words = rest.split()
            if name in names and len(words) == 2 and words[0].isdecimal():
                found[name] = 1024.0 * int(words[0])
    except OSError:  # no such file on this system
        pass
    return found


def _control_groups(root: str = "/sys/fs/cgroup", listed: str = "/proc/self/cgroup") -> list[Path]:
    """The folders of the control groups whose limits hold for this process, of version 1 or 2."""
    folders = []
    try:
        lines = Path(listed).read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        return []
    for line in lines:
        _, kinds, path = line.split(":", 2) if line.count(":") >= 2 else ("", "-", "")
        if kinds and "memory" not in kinds.split(","):
            continue
        base = Path(root) / "memory" if kinds else Path(root)
        group = Path(path.lstrip("/"))
        # Within a container the path may be that of the machine, of which only the root is there.
        folders += [base / part for part in (group, *group.parents) if (base / part).is_dir()]
    return folders


def _left_in(folder: Path) -> float | None:
    """What a control group leaves, bytes, with what is cached; None without a limit."""
    for limit, usage, cached in (
        ("memory.max", "memory.current", "inactive_file"),
        ("memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file"),
    ):
        try:
            most = (folder / limit).read_text().strip()
            if not most.isdecimal() or int(most) > UNLIMITED:
                continue
            used = int((folder / usage).read_text())
            counts = dict(
                line.split(" ", 1) for line in (folder / "memory.stat").read_text().splitlines()
            )
            return float(int(most) - used + int(counts.get(cached, 0)))
        except (OSError, ValueError):
            continue
    return None


def _size(count: float) -> str:
    return f"{count / GB:.2g} GB" if count >= 0.995 * GB else f"{count / MB:.0f} MB"
