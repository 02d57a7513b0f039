"""Work that would hold up the window, done in a thread: one piece at a time."""

from __future__ import annotations

import threading
import traceback
from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, TypeVar

from relgloss_view.base.errors import RelglossError

K = TypeVar("K")
T = TypeVar("T")


@dataclass(frozen=True)
class Outcome(Generic[K, T]):
    """What came of a piece of work: a value, or one line that says why there is none."""

    key: K
    value: T | None
    fault: str = ""


class Worker(Generic[K, T]):
    """Does one piece of work at a time; `wake` is called from its thread when one ends."""

    def __init__(self, wake: Callable[[], None]) -> None:
        self._wake = wake
        self._thread: threading.Thread | None = None
        self._ended: list[Outcome[K, T]] = []

    @property
    def busy(self) -> bool:
        """Whether a piece is under way, or has ended and was not taken yet."""
        return self._thread is not None

    def start(self, key: K, work: Callable[[], T]) -> None:
        """Begin a piece, identified by its key; it must touch nothing of OpenGL."""
        self._thread = threading.Thread(
            target=self._run, args=(key, work), name="background", daemon=True
        )
        self._thread.start()

    def take(self) -> Outcome[K, T] | None:
        """What has ended since this was last asked."""
        if not self._ended:
            return None
        self._thread = None
        return self._ended.pop()

    def _run(self, key: K, work: Callable[[], T]) -> None:
        try:
            outcome: Outcome[K, T] = Outcome(key, work())
        except RelglossError as error:
            outcome = Outcome(key, None, str(error))
        except MemoryError:
            outcome = Outcome(key, None, "not enough memory; make the window smaller")
        except Exception as error:
            # The window must not wait for ever for work that has met a mistake of the program.
            traceback.print_exc()
            outcome = Outcome(key, None, f"the program failed ({type(error).__name__})")
        self._ended.append(outcome)
        self._wake()
