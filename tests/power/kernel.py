"""Mounts and loop devices by the kernel's own calls, in mounts and processes of their own.

What is mounted here is seen by no other process, and is gone with the last process of the room,
however that ends: the loop devices clear themselves when nothing uses them.
"""

from __future__ import annotations

import contextlib
import ctypes
import errno
import fcntl
import os
import shutil
import struct
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from pathlib import Path

_libc = ctypes.CDLL(None, use_errno=True)
LOOP_CONFIGURE, LOOP_GET_FREE = 0x4C0A, 0x4C82
AUTOCLEAR = 4
DETACH = 2
#: The child of unshare is process 1 of its room: when it ends, or this process does, all end.
PRIVATE = [
    "setpriv",
    "--pdeathsig",
    "KILL",
    "unshare",
    "--mount",
    "--pid",
    "--fork",
    "--kill-child=KILL",
    "--mount-proc",
]


def missing() -> str | None:
    """Why no disk can be recorded on this machine; None where it can."""
    if sys.platform != "linux":
        return "needs Linux"
    if os.geteuid() != 0:
        return "needs root, to mount"
    for device in ("/dev/fuse", "/dev/loop-control"):
        if not os.path.exists(device):
            return f"needs {device}"
    for name in ("setpriv", "unshare", "mkfs.ext4"):
        if tool(name) is None:
            return f"needs {name}"
    tried = subprocess.run([*PRIVATE, "true"], capture_output=True, text=True)
    if tried.returncode:
        return f"no private mounts: {tried.stderr.strip()}"
    with open("/proc/filesystems") as file:
        systems = file.read().split()
    return None if "fuse" in systems and "ext4" in systems else "needs fuse and ext4 in the kernel"


def _path() -> str:
    return os.environ.get("PATH", os.defpath) + ":/sbin:/usr/sbin"


def tool(name: str) -> str | None:
    """A program of the system, also where PATH leaves the administrator's out."""
    return shutil.which(name, path=_path())


def in_private_room(words: Sequence[str]) -> list[str]:
    """The command that runs a command with mounts and processes of its own."""
    return [*PRIVATE, *words]


def mount(source: str, place: Path, kind: str, options: str = "") -> None:
    """mount(2); OSError."""
    _checked(
        _libc.mount(source.encode(), os.fspath(place).encode(), kind.encode(), 0, options.encode()),
        f"mount {kind} {options}",
    )


def unmount(place: Path, patience_s: float = 5.0) -> None:
    """Unmount, waiting for whoever still holds a file there; then detach it all the same."""
    end = time.monotonic() + patience_s
    while _libc.umount2(os.fspath(place).encode(), 0):
        if ctypes.get_errno() == errno.EINVAL:  # nothing is mounted there
            return
        if time.monotonic() > end:
            _libc.umount2(os.fspath(place).encode(), DETACH)
            raise OSError(errno.EBUSY, "still in use", os.fspath(place))
        time.sleep(0.01)


def sync(place: Path) -> None:
    """Have all that was written to the file system of a folder reach its disk."""
    folder = os.open(place, os.O_RDONLY)
    try:
        _checked(_libc.syncfs(folder), "syncfs")
    finally:
        os.close(folder)


@contextlib.contextmanager
def loop_device(image: Path) -> Iterator[str]:
    """A block device whose content is a file; it clears itself after its last use."""
    with open(image, "r+b") as file:
        for _ in range(100):
            with open("/dev/loop-control", "r+b", buffering=0) as control:
                number = fcntl.ioctl(control, LOOP_GET_FREE)
            name = f"/dev/loop{number}"
            with open(name, "r+b", buffering=0) as device:
                # struct loop_config: file, block size, struct loop_info64, reserved
                config = struct.pack("<II", file.fileno(), 0)
                config += struct.pack("<5Q4I160x2Q", *[0] * 5, 0, 0, 0, AUTOCLEAR, 0, 0)
                config += bytes(64)
                try:
                    fcntl.ioctl(device, LOOP_CONFIGURE, config)
                except OSError as error:
                    if error.errno != errno.EBUSY:  # somebody else was faster
                        raise
                    continue
                yield name
                return
        raise OSError(errno.EBUSY, "no free loop device")


@contextlib.contextmanager
def mounted(image: Path, place: Path, kind: str, options: str = "") -> Iterator[Path]:
    """A file system in an image, mounted at `place`."""
    with loop_device(image) as device:
        mount(device, place, kind, options)
    try:
        yield place
    finally:
        unmount(place)


def _checked(result: int, what: str) -> None:
    if result:
        number = ctypes.get_errno()
        raise OSError(number, f"{what}: {os.strerror(number)}")
