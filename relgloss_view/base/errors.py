"""The faults that a user can mend. The command turns each into one line and an exit status."""

from __future__ import annotations


class RelglossError(Exception):
    """A fault with a remedy: the message is one line that says what, where and how to mend it."""

    exit_status = 1

    def __init__(self, message: str) -> None:
        super().__init__(" ".join(message.split()))


class InputError(RelglossError):
    """A file or a value from outside that is not as it should be."""


class FitCancelled(RelglossError):
    """The caller's progress callback asked the fit to stop."""


class GLUnavailableError(RelglossError):
    """No OpenGL 3.3 context could be made on this machine."""

    exit_status = 3
