"""Whether the OpenGL driver that the environment names can draw, tried where a crash does no harm.

Mesa's libraries end the process where a driver is named whose hardware is missing, as with
GALLIUM_DRIVER=d3d12 on Debian 12. Nothing is tried, and no time spent, unless such a variable is
set: then the context is first made in a process of its own.
"""

from __future__ import annotations

import contextlib
import os
import sys

from relgloss_view.base.errors import GLUnavailableError

#: How the names of variables begin by which a driver is chosen or changed.
OF_DRIVERS = (
    "GALLIUM_", "MESA_", "LIBGL_", "LP_", "EGL_", "__EGL_", "__GLX_", "DRI_", "ZINK_", "LVP_",
)  # fmt: skip
#: Those with which Mesa's software drivers are known to draw.
HARMLESS = {
    "GALLIUM_DRIVER": ("llvmpipe", "softpipe"),
    "LIBGL_ALWAYS_SOFTWARE": ("0", "1", "true", "false"),
    "LP_NUM_THREADS": tuple(map(str, range(33))),
}
HARMLESS_NAMES = ("MESA_GL_VERSION_OVERRIDE", "MESA_GLSL_VERSION_OVERRIDE", "EGL_LOG_LEVEL")
CACHES = ("MESA_SHADER_CACHE", "MESA_GLSL_CACHE")

_crashes: dict[str, str] = {}  #: of backends that were tried, by name


def chosen_by_hand() -> list[str]:
    """Variables of the environment that choose a driver, as NAME=VALUE."""
    return [
        f"{name}={value}"
        for name, value in sorted(os.environ.items())
        if name.startswith(OF_DRIVERS)
        and value
        and name not in HARMLESS_NAMES
        and not name.startswith(CACHES)
        and value not in HARMLESS.get(name, ())
    ]


def check(backend: str) -> None:
    """Raise GLUnavailableError where this backend would end the process; at no cost usually."""
    named = chosen_by_hand()
    if not named:
        return
    if backend not in _crashes:
        from relgloss_view.base.child import run_module

        _crashes[backend] = run_module(__name__, backend).crash
    if _crashes[backend]:
        raise GLUnavailableError(
            f"{backend}: the OpenGL driver {_crashes[backend]}; unset {', '.join(named)}"
        )


def trust(backend: str) -> None:
    """Try this backend in this process, whatever comes of it: the process is there for that."""
    _crashes[backend] = ""


def _draw(backend: str) -> None:
    """Make a context and draw on it, as any picture would."""
    from relgloss_view.picture.gpu.context import open_context
    from relgloss_view.picture.gpu.renderer import Renderer
    from relgloss_view.picture.scene.look import Look
    from relgloss_view.picture.scene.sample import DEFAULT_SAMPLE, load_sample
    from relgloss_view.picture.scene.scene import Scene

    renderer = Renderer(open_context(backend))
    _ = renderer.render(Scene(load_sample(DEFAULT_SAMPLE)), Look(), (16, 16)).display


if __name__ == "__main__":
    from relgloss_view.picture.gpu import probe  # this module again, as the others know it

    probe.trust(sys.argv[1])
    # A fault that is no crash is met again, and reported, by the caller.
    with contextlib.suppress(GLUnavailableError):
        _draw(sys.argv[1])
    os._exit(0)
