"""Errors that a user can mend. The command prints each as one line and exits with its status."""

from __future__ import annotations

from relgloss_view.base.visible import visible

LONGEST, LAST = 1000, 300  #: characters of a message, and those of its end that stay


class RelglossError(Exception):
    """An error with a remedy: its message is one line that names the place, the fault, the remedy.

    No character of it is one that a terminal would obey.

    The base of all errors that relgloss raises for a user.

    >>> str(RelglossError("a.csv: no rows;\\n  add one"))
    'a.csv: no rows; add one'
    """

    exit_status = 1

    def __init__(self, message: str) -> None:
        line = visible(" ".join(message.split()))
        if len(line) > LONGEST:  # a remedy comes last, and stays
            line = f"{line[: LONGEST - LAST - 5]} ... {line[-LAST:]}"
        super().__init__(line)


class InputError(RelglossError):
    """A file or a value from outside that relgloss can't use; exit status 1.

    >>> from relgloss_view import load_sample
    >>> try:
    ...     load_sample("velvet")
    ... except InputError as error:
    ...     print(error)
    sample 'velvet': expected one of cast-coated, art-coated, matte-coated, uncoated
    """


class FitCancelled(RelglossError):
    """The caller's progress callback asked the fit to stop."""


class GLUnavailableError(RelglossError):
    """No OpenGL 3.3 context can be made on this machine; exit status 3.

    `open_renderer("reference")` needs no OpenGL.

    >>> GLUnavailableError("no OpenGL 3.3 context").exit_status
    3
    """

    exit_status = 3
