"""One way to a renderer, whatever draws: EGL, OSMesa, or the float64 reference."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from typing import Protocol

from relgloss_view.base.terminal import ProgressReport, no_progress
from relgloss_view.picture.frame import Frame
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.scene import Scene

BACKENDS = ("auto", "egl", "osmesa", "reference")


class FrameRenderer(Protocol):
    """What draws frames: Renderer on a GPU, ReferenceRenderer in float64."""

    def render(self, scene: Scene, look: Look, size: tuple[int, int]) -> Frame:
        """Draw a scene; `size` is width and height in pixels."""
        ...


@contextlib.contextmanager
def open_renderer(
    backend: str = "auto", progress: ProgressReport = no_progress
) -> Iterator[FrameRenderer]:
    """A renderer for the length of a block; fetch a frame's stages inside it.

    `progress(share, text)` is called while the reference draws; a GPU is done too soon.
    Raises GLUnavailableError where no context can be made.
    """
    if backend == "reference":
        from relgloss_view.picture.reference import ReferenceRenderer

        yield ReferenceRenderer(progress)
        return
    from relgloss_view.picture.gpu.context import open_context
    from relgloss_view.picture.gpu.passes import Renderer

    ctx = open_context(backend)
    try:
        renderer = Renderer(ctx)
        try:
            yield renderer
        finally:
            renderer.release()
    finally:
        ctx.release()
