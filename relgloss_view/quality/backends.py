"""The one entry to a renderer: EGL, OSMesa, or the float64 reference.

Here the renderer is handed the planner, which chooses the method of pictures of quality "auto".
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from typing import Protocol

from relgloss_view.base.errors import RelglossError
from relgloss_view.base.terminal import ProgressReport, no_progress
from relgloss_view.picture.frame import Frame
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.scene import Scene

BACKENDS = ("auto", "egl", "osmesa", "reference")


class FrameRenderer(Protocol):
    """Draws frames: Renderer through OpenGL, ReferenceRenderer in float64."""

    def render(
        self, scene: Scene, look: Look, size: tuple[int, int], *, factor: float = 1.0
    ) -> Frame:
        """Draw a scene; `size` is width and height in pixels. Raises InputError.

        factor: of the look's c, as picture.pair gives it for pictures that belong together.
        """
        ...


@contextlib.contextmanager
def open_renderer(
    backend: str = "auto", progress: ProgressReport = no_progress
) -> Iterator[FrameRenderer]:
    """A renderer for the length of a block; fetch a frame's stages inside the block.

    Through OpenGL it works in the thread and the process that opened it, and raises RelglossError
    elsewhere. OpenGL does not work in a process that was forked after a renderer was opened.

    backend: 'egl' or 'osmesa' draw through OpenGL, 'reference' in float64 without it; 'auto' takes
    the first OpenGL that works.
    progress: called with a share from 0 to 1 and a text while the reference draws.

    Raises GLUnavailableError where no OpenGL context can be made.

    >>> from relgloss_view import Look, Scene, load_sample
    >>> with open_renderer("reference") as renderer:
    ...     frame = renderer.render(Scene(load_sample("art-coated")), Look(samples=1), (24, 24))
    >>> round(frame.c_max, 3), frame.display.shape
    (0.464, (24, 24, 3))
    """
    if backend == "reference":
        from relgloss_view.picture.reference import ReferenceRenderer

        yield ReferenceRenderer(progress)
        return
    from relgloss_view.picture.gpu.context import close, open_context
    from relgloss_view.picture.gpu.renderer import Renderer
    from relgloss_view.quality.planner import MethodChooser

    ctx = open_context(backend)
    renderer: Renderer | None = None

    def leave() -> None:
        try:
            if renderer is not None:
                renderer.release()
        finally:
            close(ctx)

    try:
        renderer = Renderer(ctx, choose=MethodChooser().method)
        yield renderer
    except GeneratorExit:  # dropped inside the block, perhaps in another thread
        with contextlib.suppress(RelglossError):
            leave()
        raise
    except BaseException:
        leave()
        raise
    else:
        leave()
