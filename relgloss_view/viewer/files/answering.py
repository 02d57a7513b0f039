"""A process that does one piece of work for the window, and reports how far it is.

It is this Python with this program's module path. It answers on a pipe, with pickles that nobody
else can write. If the window is killed, the process ends too.
"""

from __future__ import annotations

import contextlib
import json
import os
import pickle
import subprocess
import sys
import traceback
from collections.abc import Callable
from typing import Any

from relgloss_view.base.child import Child
from relgloss_view.base.errors import InputError, RelglossError
from relgloss_view.base.followed import follow
from relgloss_view.base.terminal import ProgressReport

PROGRESS, DONE, FAULT = range(3)
NICENESS = 5  #: drawing comes first
_CODE = (
    "import importlib, json, sys; sys.path[:] = json.loads(sys.argv[1]); "
    "importlib.import_module(sys.argv[2]).answer(*sys.argv[3:])"
)


class Answering:
    """Runs `answer` of a module with words. Begins at once.

    Raises InputError, with the fault, where no process can be made.
    """

    def __init__(self, module: str, *words: str, fault: str) -> None:
        code = [sys.executable, "-P", "-c", _CODE, json.dumps(sys.path), module, *words]
        try:
            self._child = Child(code, followed=True, stdout=subprocess.PIPE)
        except (OSError, ValueError) as error:
            raise InputError(f"{fault} ({error})") from error

    def outcome(self, progress: ProgressReport, ended: str) -> Any:
        """Wait for what `answer` gives. Raises InputError: its fault, or `ended` without one."""
        pipe: Any = self._child.process.stdout
        try:
            while True:
                try:
                    kind, *content = pickle.load(pipe)
                except (EOFError, pickle.UnpicklingError):
                    raise InputError(ended) from None
                if kind == DONE:
                    return content[0]
                if kind == PROGRESS:
                    progress(*content)
                else:
                    raise InputError(*content)
        finally:
            self._child.close()

    def stop(self) -> None:
        """End the process now. It leaves nothing behind, for it writes no file."""
        with contextlib.suppress(OSError):
            self._child.kill()


def answered(work: Callable[[ProgressReport], object], name: str, no_memory: str) -> None:
    """What such a process does: work, and write the answers to standard output.

    name: what the work is on, for faults. no_memory: the line where memory is short.
    """
    follow()
    with contextlib.suppress(AttributeError, OSError):
        os.nice(NICENESS)
    # What a library prints must not come between the answers.
    with contextlib.suppress(BrokenPipeError), os.fdopen(os.dup(1), "wb") as pipe:
        os.dup2(2, 1)

        def send(*content: object) -> None:
            pipe.write(pickle.dumps(content))
            pipe.flush()

        try:
            send(DONE, work(lambda fraction, text: send(PROGRESS, fraction, text)))
        except BrokenPipeError:
            raise
        except RelglossError as error:
            send(FAULT, str(error))
        except MemoryError:
            send(FAULT, no_memory)
        except Exception as error:
            traceback.print_exc()
            send(FAULT, f"{name}: the program failed on it ({type(error).__name__})")
