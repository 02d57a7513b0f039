"""Names of output files, checked before the work: the right ending, and not what is read."""

from __future__ import annotations

import os
from collections.abc import Iterable

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.base.writing import check_writable


def check_output(output: str, sources: Iterable[str], ending: str = "") -> None:
    """InputError where -o has another ending, can't be written, or names a file that is read."""
    if not output.lower().endswith(ending):
        shown = printable(output) if output else "''"
        raise InputError(f"-o {shown}: expected a name that ends in {ending}")
    check_writable(output)
    for source in sources:
        both = os.path.exists(output) and os.path.exists(source)
        if both and os.path.samefile(output, source):
            raise InputError(
                f"-o {printable(output)}: this is the file that is read; choose another name"
            )
