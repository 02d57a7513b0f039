"""Decoration: what shows a result and is not one, such as a plot, a page or a contact sheet.

A command saves its result first. Then it draws the decoration in a block of `decoration`, and where
that fails, whatever the reason, it prints one warning and goes on: the result, its files and the
exit status stay as they are. Status 0 means that every file named by -o exists; so where a
decoration is itself such a file (`match -o`, `compare -o`), the command prints its result and ends
with status 1.

A mistake of the program must not hide behind this: the warning names the exception, and with
RELGLOSS_FAULTS=raise, as the tests run, the exception goes on as a traceback.
"""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from relgloss_view.base.errors import RelglossError
from relgloss_view.base.reading import printable
from relgloss_view.base.terminal import warn

VARIABLE, RAISE = "RELGLOSS_FAULTS", "raise"
NAMES_LENGTH, REASON_LENGTH = 300, 120  #: characters of a warning: paths are worth reading whole
OWN_FAULT = f"a fault of relgloss: report this line ({VARIABLE}={RAISE} shows where it lies)"


@dataclass
class Drawn:
    """Whether a decoration is there; known when its block has ended."""

    done: bool = False


@contextlib.contextmanager
def decoration(
    what: str, kept: str, *, files: Iterable[str | os.PathLike[str]] = ()
) -> Iterator[Drawn]:
    """A block that draws a decoration; any Exception in it ends as a warning on standard error.

    what: the decoration, as in "rep.png: the report". kept: what there is nevertheless, as in
    "fit.json is written". files: those that the block writes under their own names; where it fails,
    they are removed, so that none is there in part. The warning ends with the step that helps.

    >>> with decoration("rep.png: the report", "fit.json is written") as drawn:
    ...     print("drawn")
    drawn
    >>> drawn.done
    True
    """
    drawn = Drawn()
    try:
        yield drawn
        drawn.done = True
    except Exception as error:
        for file in files:
            with contextlib.suppress(OSError):
                os.unlink(file)
        what, kept = printable(what, NAMES_LENGTH), printable(kept, NAMES_LENGTH)
        warn(f"{what} was not drawn; {kept}. {fault_line(error)}", 4 * NAMES_LENGTH)


def fault_line(error: Exception) -> str:
    """What went wrong and the step that helps, on one line; raises it with RELGLOSS_FAULTS=raise.

    For places that must go on after a mistake of the program: decorations, and the window.
    """
    if os.environ.get(VARIABLE) == RAISE:
        raise error
    message = str(error) or "without a message"
    if isinstance(error, RelglossError):  # it names its remedy
        return printable(message, 2 * REASON_LENGTH)
    reason = printable(f"{type(error).__name__}: {message}", REASON_LENGTH)
    return f"{reason}; {_remedy(error)}"


def _remedy(error: Exception) -> str:
    if isinstance(error, MemoryError):
        return "close other programs and try again"
    if isinstance(error, ImportError):
        return "`relgloss doctor` lists what is missing"
    if isinstance(error, OSError):
        return "make room or give another place"
    return OWN_FAULT
