"""Writers: pictures are packed into their files while the next ones are drawn."""

from __future__ import annotations

from collections import deque
from concurrent.futures import Future, ThreadPoolExecutor, wait
from pathlib import Path
from types import TracebackType

from relgloss_view.base.interruptions import STEP_S, checkpoint
from relgloss_view.picture.displayed import Displayed
from relgloss_view.picture.frame import Frame
from relgloss_view.picture.output.export import save_frame
from relgloss_view.picture.output.parameters import parameters

THREADS = 2
WAITING = 3  #: most pictures that wait for their files, so that memory stays bounded


class Writers:
    """Writes files in threads of its own. Use it in a with-block; at its end every file is whole.

    A later save, or the end of the block, raises the first error of a file.
    """

    def __init__(self) -> None:
        self._pool = ThreadPoolExecutor(THREADS)
        self._open: deque[Future[None]] = deque()

    def save(
        self, frame: Frame, path: Path, command: str, displayed: Displayed | None = None
    ) -> None:
        """Write a frame as PNG of 8 bits; arguments as save_frame."""
        # Fetched here: only this thread may use OpenGL.
        _ = parameters(frame, displayed), frame.display
        while len(self._open) >= WAITING:
            self._finish_first()
        self._open.append(self._pool.submit(save_frame, frame, path, command, displayed=displayed))

    def __enter__(self) -> Writers:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        try:
            while kind is None and self._open:
                self._finish_first()
        finally:
            # What is being written has to end before its folder can be removed.
            self._pool.shutdown(wait=True, cancel_futures=True)

    def _finish_first(self) -> None:
        """Wait for the oldest file, with checkpoints; raises its error."""
        first = self._open.popleft()
        while not wait([first], STEP_S).done:
            checkpoint()
        first.result()
