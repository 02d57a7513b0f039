"""Writing files and folders so that they appear whole or not at all, one or several at once.

What is not whole yet lies in a temporary folder beside its place (temporaries.py), so a program
that was killed leaves nothing that the next one does not remove. How it comes to its place:
commit.py.
"""

from __future__ import annotations

import contextlib
import os
import shutil
import stat
from collections.abc import Callable, Iterable, Iterator
from contextvars import ContextVar
from dataclasses import dataclass, field
from pathlib import Path

from relgloss_view.base.commit import (
    FolderOutput,
    Output,
    errors_of,
    put_in_place,
    shown_as,
    taken,
    unwritable,
)
from relgloss_view.base.errors import InputError
from relgloss_view.base.file_system import may_be_exchanged
from relgloss_view.base.temporaries import held_folder, is_held, scratch_folder, sweep

NEW = "new"  #: in a temporary folder, where the outputs lie
USUAL, PRIVATE = 0o666, 0o600  #: modes of new files, from which the system takes the umask


@dataclass
class _Together:
    """The outputs of a `together` block, and what holds their temporary folders."""

    stack: contextlib.ExitStack
    outputs: list[Output] = field(default_factory=list)


_together: ContextVar[_Together | None] = ContextVar("_together", default=None)


@contextlib.contextmanager
def together() -> Iterator[None]:
    """All files and folders that are written within the block are put in place at its end.

    Either all are, or none is: on any exception every place keeps its content. An inner block is
    part of the outer one. What other threads write is not part of it.

    >>> with together():
    ...     with whole_file("numbers.txt") as temporary:
    ...         _ = temporary.write_text("1 2 3")
    ...     Path("numbers.txt").exists()
    False
    >>> Path("numbers.txt").exists()
    True
    """
    if _together.get() is not None:
        yield
        return
    with contextlib.ExitStack() as stack:
        block = _Together(stack)
        token = _together.set(block)
        try:
            yield
        finally:
            _together.reset(token)
        put_in_place(block.outputs)


@contextlib.contextmanager
def whole_file(path: str | os.PathLike[str], *, private: bool = False) -> Iterator[Path]:
    """A temporary path beside `path`, which replaces `path` when the block ends without error.

    On any exception the temporary file is removed and `path` keeps its content. A symbolic link
    stays one: its target is written. An existing file's mode and owner are kept. private: a new
    file may be read by its owner alone. Raises InputError where the place can't be written.

    >>> with whole_file("numbers.txt") as temporary:
    ...     _ = temporary.write_text("1 2 3")
    >>> Path("numbers.txt").read_text()
    '1 2 3'
    """
    with _staged_file(path, private) as output:
        yield output.staged


@contextlib.contextmanager
def fresh_file(path: str | os.PathLike[str], *, private: bool = False) -> Iterator[Path]:
    """As whole_file, for a new name: an existing file is never replaced.

    Raises InputError where the name exists when the block begins or ends.
    """
    if os.path.lexists(check_target(path)):
        raise taken(path)
    with _staged_file(path, private) as output:
        output.fresh = True
        yield output.staged


@contextlib.contextmanager
def whole_folder(
    path: str | os.PathLike[str],
    last: str,
    stale: Callable[[Path], Iterable[str]] = lambda folder: (),
) -> Iterator[Path]:
    """A temporary folder, whose files are put into `path` when the block ends without error.

    A new `path` appears at once with all its files. One that exists is replaced at once, too, by a
    folder with the new files and all other ones of the old; see commit.py for where that can't be.
    last: name of the file that lists the others and marks the folder as the program's own; it is
    never missing. stale: names of what a former run has written into a folder, which goes unless it
    is written again. On any exception the temporary folder is removed with its files. Raises
    InputError where the place can't be written.
    """
    folder = _resolved(path)
    mode = _mode(path, folder)
    if mode is not None and not stat.S_ISDIR(mode):
        raise InputError(f"{path}: is a file; give the name of a folder")
    if mode is not None and not os.access(folder, os.W_OK | os.X_OK):
        raise unwritable(path, PermissionError(1, "the folder is protected"))
    exchanged = mode is not None and may_be_exchanged(folder)
    above = next(p for p in folder.parents if os.path.lexists(p))
    with errors_of(path), contextlib.ExitStack() as stack:
        if mode is not None:
            sweep(folder)
        holder = _stack(stack, folder).enter_context(
            held_folder(above if exchanged or mode is None else folder)
        )
        staged = holder / NEW / (folder.relative_to(above) if mode is None else "")
        staged.mkdir(parents=True)
        with shown_as(staged, path):
            yield staged
        output = FolderOutput(
            os.fspath(path), holder, staged, folder, last=last, stale=stale,
            is_new=mode is None, in_place=mode is not None and not exchanged,
        )  # fmt: skip
        _put(output)


@contextlib.contextmanager
def _staged_file(path: str | os.PathLike[str], private: bool) -> Iterator[Output]:
    target = check_target(path)
    with errors_of(path), contextlib.ExitStack() as stack:
        holder = _stack(stack, target).enter_context(held_folder(target.parent))
        staged = holder / NEW / target.name
        staged.parent.mkdir()
        _make_empty(staged, PRIVATE if private else USUAL)
        output = Output(os.fspath(path), holder, staged, target)
        yield output
        _put(output)


def _stack(own: contextlib.ExitStack, target: Path) -> contextlib.ExitStack:
    """What holds the temporary folder of an output: its own block, or that of all."""
    block = _together.get()
    return own if block is None or is_held(target) else block.stack


def _put(output: Output) -> None:
    block = _together.get()
    if block is None or is_held(output.target):
        put_in_place([output])
    else:
        block.outputs.append(output)


def check_writable(path: str | os.PathLike[str]) -> None:
    """Raise InputError where `path` can't be written; call it before long work."""
    target = check_target(path)
    try:
        with held_folder(target.parent) as folder:
            _make_empty(folder / target.name, USUAL)
    except (OSError, ValueError) as error:
        raise unwritable(path, error) from error


def check_target(path: str | os.PathLike[str]) -> Path:
    """The path that a file of this name is written to, with links followed.

    Raises InputError for an empty name, a folder, a device and a pipe: only a regular file may be
    replaced.
    """
    if not os.fspath(path):
        raise InputError("an empty file name; give the name of the file to write")
    target = _resolved(path)
    mode = _mode(path, target)
    if mode is not None and stat.S_ISDIR(mode):
        raise InputError(f"{path}: is a folder; give the name of a file in it")
    if mode is not None and not stat.S_ISREG(mode):
        raise InputError(f"{path}: is not a regular file; choose another place")
    return target


@contextlib.contextmanager
def utf8_path(path: Path) -> Iterator[Path]:
    """A path that libraries take which know UTF-8 alone; what they write there goes to `path`."""
    try:
        os.fspath(path).encode("utf-8")
    except UnicodeEncodeError:
        with scratch_folder() as folder:
            written = folder / f"written{path.suffix if path.suffix.isascii() else ''}"
            yield written
            shutil.copyfile(written, path)
        return
    yield path


def make_folder(path: str | os.PathLike[str]) -> Path:
    """Make a folder and its parents, unless they exist; InputError where that is not possible."""
    folder = Path(path)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except (OSError, ValueError) as error:
        raise unwritable(folder, error) from error
    return folder


def _resolved(path: str | os.PathLike[str]) -> Path:
    try:
        return Path(os.path.realpath(path))
    except (OSError, ValueError) as error:  # ValueError: a NUL, a lone surrogate
        raise unwritable(path, error) from error


def _mode(path: str | os.PathLike[str], target: Path) -> int | None:
    """The mode of the file or folder `target`; None where there is none. Errors name `path`."""
    try:
        return target.stat().st_mode
    except FileNotFoundError:
        return None
    except (OSError, ValueError) as error:  # a loop of links, a name too long, no permission
        raise unwritable(path, error) from error


def _make_empty(file: Path, mode: int) -> None:
    """Make a file; the system takes the umask from its mode."""
    os.close(os.open(file, os.O_CREAT | os.O_EXCL | os.O_WRONLY, mode))
