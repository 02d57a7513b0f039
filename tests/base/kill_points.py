"""Programs that are killed before every call that changes a folder, and what is left then.

The program is a function that runs in a fork. Python's audit events count its calls (rename, link,
unlink, mkdir, open and so on); the calls that have no event are wrapped.
"""

from __future__ import annotations

import contextlib
import os
import shutil
import signal
import sys
import traceback
from collections.abc import Callable, Iterator
from pathlib import Path

from relgloss_view.base import file_system, temporaries

EVENTS = {
    "os.rename", "os.link", "os.remove", "os.rmdir", "os.mkdir", "os.chmod", "os.chown",
    "os.symlink", "os.truncate", "os.utime", "shutil.rmtree", "os.setxattr",
}  # fmt: skip
Tree = dict[str, tuple[int, bytes | str | None]]


def tree(folder: Path) -> Tree:
    """Every name below a folder, with its mode and content; temporary folders are left out."""
    found: Tree = {}
    for path in sorted(folder.rglob("*")):
        if any(temporaries.is_temporary(part) for part in path.relative_to(folder).parts):
            continue
        mode = path.lstat().st_mode
        content: bytes | str | None = None
        if path.is_symlink():
            content = os.readlink(path)
        elif path.is_file():
            content = path.read_bytes()
        found[os.fspath(path.relative_to(folder))] = mode, content
    return found


def temporary(folder: Path) -> list[str]:
    """The temporary folders below a folder."""
    return [str(p) for p in folder.rglob("*") if temporaries.is_temporary(p.name)]


def run(program: Callable[[], object], at: int = 0, sent: int = signal.SIGKILL) -> int:
    """Run a program in a fork and send it a signal before its call number `at`, from 1.

    Returns the number of the signal that ended it, or 0 where it came to its end.
    """
    child = os.fork()
    if child:
        status = os.waitpid(child, 0)[1]
        if os.WIFSIGNALED(status):
            return os.WTERMSIG(status)
        assert os.WEXITSTATUS(status) in (0, 128 + sent), "the program has failed"
        return sent if os.WEXITSTATUS(status) else 0
    try:
        temporaries._swept.clear()
        if at:
            _count(at, sent)
        program()
    except BaseException:
        traceback.print_exc()
        os._exit(1)
    os._exit(0)


def _count(at: int, sent: int) -> None:
    calls = 0

    def call() -> None:
        nonlocal calls
        calls += 1
        if calls == at:
            os.kill(os.getpid(), sent)

    def hook(event: str, arguments: tuple[object, ...]) -> None:
        writes = event == "open" and isinstance(arguments[2], int) and arguments[2] & os.O_CREAT
        if event in EVENTS or writes:
            call()

    sys.addaudithook(hook)
    for module, name in ((file_system, "_renameat2"), (os, "fsync")):
        setattr(module, name, _counted(getattr(module, name), call))


def _counted(real: Callable[..., object], call: Callable[[], None]) -> Callable[..., object]:
    def counted(*arguments: object) -> object:
        call()
        return real(*arguments)

    return counted


def killed_at_every_call(
    prepare: Callable[[Path], None],
    program: Callable[[Path], object],
    base: Path,
    *,
    step: int = 1,
    most: int = 10_000,
) -> Iterator[tuple[int, Path]]:
    """The number of the call, and the folder as the kill has left it.

    prepare: fills an empty folder. program: works in it. The last number is one at which the
    program has come to its end.
    """
    for at in range(1, most, step):
        work = base / str(at)
        work.mkdir()
        prepare(work)
        with contextlib.chdir(work):
            ended = run(lambda work=work: program(work), at)
        yield at, work
        shutil.rmtree(work)
        if not ended:
            return
    raise AssertionError("the program makes more calls than that")
