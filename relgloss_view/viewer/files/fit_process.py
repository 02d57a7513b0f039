"""A fit in a process of its own, so that drawing and fitting do not wait for each other.

In a thread the window would hardly notice the fit: a main thread that wakes every 5 ms never waited
for longer than 42 ms. But the fit would starve. It releases the interpreter at every step and waits
up to 5 ms to get it back from drawing: a fit that takes 1.3 s alone took 20 s while pictures were
drawn one after the other (measured on two cores).

The process is this Python with this program's module path. It answers on a pipe, with pickles that
nobody else can write. If the window is killed, the process ends too.
"""

from __future__ import annotations

import contextlib
import json
import os
import pickle
import subprocess
import sys
import traceback
from typing import Any, BinaryIO

from relgloss_view.base.child import Child
from relgloss_view.base.errors import InputError, RelglossError
from relgloss_view.base.followed import follow
from relgloss_view.base.terminal import ProgressReport
from relgloss_view.material.material import Material
from relgloss_view.measure.table import Measurement

PROGRESS, DONE, FAULT = range(3)
NICENESS = 5  #: drawing comes first
_CODE = (
    "import json, sys; sys.path[:] = json.loads(sys.argv[1]); "
    "from relgloss_view.viewer.files.fit_process import answer; answer(sys.argv[2])"
)


class FitProcess:
    """Reads and fits one measurement. Begins at once; InputError where no process can be made."""

    def __init__(self, path: str) -> None:
        self._path = path
        words = [sys.executable, "-P", "-c", _CODE, json.dumps(sys.path), path]
        try:
            self._child = Child(words, followed=True, stdout=subprocess.PIPE)
        except (OSError, ValueError) as error:
            raise InputError(f"{path}: no process can be made to fit it ({error})") from error

    def run(self, progress: ProgressReport) -> tuple[Material, Measurement]:
        """Wait for the outcome; InputError for what is wrong with the file or ends the process."""
        pipe = self._child.process.stdout
        assert pipe is not None
        try:
            return self._outcome(pipe, progress)
        finally:
            self._child.close()

    def stop(self) -> None:
        """End the process now. It leaves nothing behind, for it writes no file."""
        with contextlib.suppress(OSError):
            self._child.kill()

    def _outcome(
        self, pipe: BinaryIO | Any, progress: ProgressReport
    ) -> tuple[Material, Measurement]:
        while True:
            try:
                kind, *content = pickle.load(pipe)
            except (EOFError, pickle.UnpicklingError):
                raise InputError(
                    f"{self._path}: the fit ended before it was done; there may not be enough "
                    "memory: thin out the table or close other programs"
                ) from None
            if kind == DONE:
                material, measurement = content
                return material, measurement
            if kind == PROGRESS:
                progress(*content)
            else:
                raise InputError(*content)


def answer(path: str) -> None:
    """What the process does: read, fit, and write the answers to standard output."""
    follow()
    with contextlib.suppress(AttributeError, OSError):
        os.nice(NICENESS)
    # What a library prints must not come between the answers.
    with contextlib.suppress(BrokenPipeError), os.fdopen(os.dup(1), "wb") as pipe:
        os.dup2(2, 1)
        _answer(path, pipe)


def _answer(path: str, pipe: BinaryIO) -> None:
    def send(*content: object) -> bool:
        pipe.write(pickle.dumps(content))
        pipe.flush()
        return True

    try:
        from relgloss_view.fitting import fit_material
        from relgloss_view.measure.readers import read_measurement

        measurement = read_measurement(path)
        send(PROGRESS, 0.0, "fitting")
        material = fit_material(
            measurement, progress=lambda fraction, text: send(PROGRESS, fraction, text)
        )
        send(DONE, material, measurement)
    except BrokenPipeError:
        raise
    except RelglossError as error:
        send(FAULT, str(error))
    except MemoryError:
        send(FAULT, f"{path}: not enough memory; thin out the table or close other programs")
    except Exception as error:
        traceback.print_exc()
        send(FAULT, f"{path}: the program failed on this file ({type(error).__name__})")
