"""Names of output files, checked before the work: the right ending, and not what is read."""

from __future__ import annotations

import os
from collections.abc import Iterable
from typing import TYPE_CHECKING

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.base.writing import check_writable

if TYPE_CHECKING:
    from relgloss_view.pack.pack import Pack


def check_output(output: str, sources: Iterable[str], ending: str = "") -> None:
    """InputError where -o has another ending, can't be written, or names a file that is read."""
    if not output.lower().endswith(ending):
        shown = printable(output) if output else "''"
        raise InputError(f"-o {shown}: expected a name that ends in {ending}")
    check_writable(output)
    refuse_read(output, sources)


def files_behind(samples: Iterable[tuple[str | None, Pack | None]]) -> list[str]:
    """The files that samples were read from, by their own files and packs: artworks, meshes too."""
    from relgloss_view.pack.pack_file import files_of

    files: list[str] = []
    for file, pack in samples:
        files += [file] if file else []
        files += [] if pack is None else files_of(pack)
    return files


def refuse_read(output: str | os.PathLike[str], sources: Iterable[str | None]) -> None:
    """InputError where an output is one of the files that are read, by whatever name or link."""
    for source in sources:
        both = bool(source) and os.path.exists(output) and os.path.exists(str(source))
        if both and os.path.samefile(output, str(source)):
            raise InputError(
                f"-o {printable(output)}: this is the file that is read; choose another name"
            )
