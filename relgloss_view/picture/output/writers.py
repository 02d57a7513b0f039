"""Writers: pictures are packed into their files while the next ones are drawn."""

from __future__ import annotations

from collections import deque
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from types import TracebackType

from relgloss_view.picture.displayed import Displayed
from relgloss_view.picture.frame import Frame
from relgloss_view.picture.output.export import parameters, save_frame

THREADS = 2
WAITING = 3  #: pictures that are held for their files at once, so that memory stays bounded


class Writers:
    """Use it in a with-block; every file is whole at its end. The first fault is raised."""

    def __init__(self) -> None:
        self._pool = ThreadPoolExecutor(THREADS)
        self._open: deque[Future[None]] = deque()

    def save(self, frame: Frame, path: Path, command: str, shown: Displayed | None = None) -> None:
        """Write a frame as PNG of 8 bits; arguments as save_frame."""
        # Fetched here: only this thread may use OpenGL.
        _ = parameters(frame, shown), frame.display
        while len(self._open) >= WAITING:
            self._open.popleft().result()
        self._open.append(self._pool.submit(save_frame, frame, path, command, shown=shown))

    def __enter__(self) -> Writers:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._pool.shutdown(wait=True, cancel_futures=kind is not None)
        while kind is None and self._open:
            self._open.popleft().result()
