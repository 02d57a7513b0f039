"""OpenGL 3.3 contexts without a window: EGL first, OSMesa as the fallback.

One of the two modules that know moderngl. A window gives its own context to `attach`.
"""

from __future__ import annotations

import ctypes
import functools
import importlib.util
import os
import sys
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import moderngl
import numpy as np

from relgloss_view.base.arrays import Bytes
from relgloss_view.base.errors import GLUnavailableError, RelglossError
from relgloss_view.base.room import check_room
from relgloss_view.picture.gpu import probe
from relgloss_view.picture.gpu.home import Home, check_process
from relgloss_view.picture.model.view import Box
from relgloss_view.picture.peak import NO_ROOM, context_need

BACKENDS = ("egl", "osmesa")
REQUIRED_GL = 330
GL_READ_FRAMEBUFFER, GL_DRAW_FRAMEBUFFER = 0x8CA8, 0x8CA9
GL_COLOR, GL_NEAREST, GL_LINEAR = 0x4000, 0x2600, 0x2601
REMEDY = (
    "on Debian or Ubuntu: apt-get install libegl1 libegl-mesa0 libgl1 libgl1-mesa-dri libx11-6 "
    "(or libosmesa6); `--backend reference` draws without OpenGL"
)


def open_context(backend: str = "auto") -> moderngl.Context:
    """A headless context; `backend` is 'auto', 'egl' or 'osmesa'.

    A driver that the environment names is tried in a process of its own first; see probe.py.
    Raises GLUnavailableError, one line with the remedy, where none can be made, InputError
    where there is no memory for it, and RelglossError after a fork.
    """
    check_process()
    check_room(context_need(), "OpenGL", NO_ROOM)
    if backend == "auto":
        makers = [_egl, _osmesa] if sys.platform.startswith("linux") else [_standalone]
    else:
        makers = [{"egl": _egl, "osmesa": _osmesa}[backend]]
    faults: list[str] = []
    for make in makers:
        try:
            probe.check(make.__name__.strip("_"))
            return _checked(make())
        except GLUnavailableError as error:
            faults.append(str(error))
        except Exception as error:  # the drivers and bindings below raise whatever they like
            faults.append(f"{make.__name__.strip('_')}: {error or type(error).__name__}")
    raise GLUnavailableError(f"no OpenGL 3.3 context: {'; '.join(faults)}; {REMEDY}")


def attach(load: Callable[[str], int]) -> moderngl.Context:
    """A moderngl context on the OpenGL context that is current; `load` finds a function by name."""
    return _checked(_create(context=_Loader(load)))


def describe(ctx: moderngl.Context) -> dict[str, Any]:
    """Renderer, version and the limits that a picture meets."""
    info = ctx.info
    return {
        "renderer": info["GL_RENDERER"],
        "vendor": info["GL_VENDOR"],
        "version": info["GL_VERSION"],
        "glsl": ctx.version_code,
        "max_texture_size": max_texture_size(ctx),
    }


def make_current(ctx: moderngl.Context) -> None:
    """Direct what follows to this context; a window's own is current whenever it draws.

    It stays current: leaving moderngl's with-block would leave none, or the wrong one. Raises
    RelglossError where the context is closed, and in another thread or process than its own.
    """
    check_home(ctx)
    if isinstance(ctx.mglo, moderngl.InvalidObject):
        raise RelglossError(
            "the renderer is closed; fetch a frame's stages inside the block that opened it"
        )
    untyped: Any = ctx
    untyped.__enter__()


#: OpenGL's functions by name, as the system's libraries have them for the current context.
_LIBRARIES = ("libOpenGL.so.0", "libGL.so.1")


def drop_sources(program: moderngl.Program) -> None:
    """Free the sources and the compiler's trees of a linked program, which it does without.

    moderngl leaves its shaders attached: on a software driver they are a third of a program.
    Nothing is done where no library of OpenGL's functions is found.
    """
    functions = _shader_functions()
    if functions is None:
        return
    attached, detach = functions
    count, names = ctypes.c_int(0), (ctypes.c_uint * 2)()
    attached(program.glo, len(names), ctypes.byref(count), names)
    for name in names[: count.value]:
        detach(program.glo, name)


@functools.cache
def _shader_functions() -> tuple[Any, Any] | None:
    for name in _LIBRARIES:
        try:
            library = ctypes.CDLL(name)
            attached, detach = library.glGetAttachedShaders, library.glDetachShader
        except (OSError, AttributeError):
            continue
        attached.argtypes = [ctypes.c_uint, ctypes.c_int, ctypes.c_void_p, ctypes.c_void_p]
        detach.argtypes = [ctypes.c_uint, ctypes.c_uint]
        attached.restype = detach.restype = None
        return attached, detach
    return None


def check_home(ctx: moderngl.Context) -> None:
    """Raise RelglossError in another thread or process than the one that opened the context."""
    if ctx.extra is not None:
        ctx.extra.check()


def is_forked(ctx: moderngl.Context) -> bool:
    """Whether this process was forked from the one that opened the context."""
    return ctx.extra is not None and bool(ctx.extra.forked)


def close(ctx: moderngl.Context) -> None:
    """Close a context that open_context made; after a fork it is the other process's to close."""
    if not is_forked(ctx):
        check_home(ctx)
        ctx.release()


def texture_probe(load: Callable[[str], int]) -> Callable[[int], bool]:
    """What tells whether the current context still knows a texture, by its name."""
    probe = ctypes.CFUNCTYPE(ctypes.c_ubyte, ctypes.c_uint)(load("glIsTexture"))
    return lambda name: bool(probe(name))


class Blitter:
    """Copies rectangles between framebuffers, past moderngl, which copies whole ones only.

    Without scaling and between equal formats it is a plain copy of memory, which a software driver
    does ten times faster than it draws a textured rectangle.
    """

    def __init__(self, load: Callable[[str], int]) -> None:
        """load: finds an OpenGL function of the current context by name."""
        self._bind = ctypes.CFUNCTYPE(None, *[ctypes.c_uint] * 2)(load("glBindFramebuffer"))
        numbers = [*[ctypes.c_int] * 8, ctypes.c_uint, ctypes.c_uint]
        self._blit = ctypes.CFUNCTYPE(None, *numbers)(load("glBlitFramebuffer"))

    def copy(self, source: int, box: Box, target: int, place: Box, *, smooth: bool) -> None:
        """Copy a box of a framebuffer, by its name, to a place in another.

        Boxes are left, bottom, right, top in pixels; a box whose left is beyond its right mirrors.
        Both framebuffers stay bound: bind what comes next.
        """
        self._bind(GL_READ_FRAMEBUFFER, source)
        self._bind(GL_DRAW_FRAMEBUFFER, target)
        self._blit(*box, *place, GL_COLOR, GL_LINEAR if smooth else GL_NEAREST)


class Offscreen:
    """A surface of any size to draw on in place of a window's own, where there is no display."""

    def __init__(self, ctx: moderngl.Context) -> None:
        self._ctx = ctx
        self._texture: moderngl.Texture | None = None
        self._framebuffer: moderngl.Framebuffer | None = None
        self._size = (0, 0)

    def resize(self, size: tuple[int, int]) -> bool:
        """Make it so many pixels wide and high, at least one; returns whether that was new."""
        size = (max(size[0], 1), max(size[1], 1))
        if size == self._size:
            return False
        before = (self._framebuffer, self._texture)
        self._texture = self._ctx.texture(size, 4)
        self._framebuffer = self._ctx.framebuffer([self._texture])
        self._size = size
        self.use()
        for old in before:
            if old is not None:
                old.release()
        return True

    @property
    def glo(self) -> int:
        """OpenGL's name of its framebuffer."""
        assert self._framebuffer is not None
        return int(self._framebuffer.glo)

    def use(self) -> None:
        """Draw on it from now on."""
        assert self._framebuffer is not None
        self._framebuffer.use()

    def read(self, **options: Any) -> bytes:
        """Its pixels, as moderngl's framebuffers read theirs."""
        assert self._framebuffer is not None
        return bytes(self._framebuffer.read(**options))

    def clear(
        self,
        red: float,
        green: float,
        blue: float,
        alpha: float,
        *,
        viewport: tuple[int, int, int, int] | None = None,
    ) -> None:
        """Fill it, or a part of it (left, bottom, width, height in pixels), with a colour."""
        assert self._framebuffer is not None
        self._framebuffer.clear(red, green, blue, alpha, viewport=viewport)

    def release(self) -> None:
        """Free it on the device."""
        for held in (self._framebuffer, self._texture):
            if held is not None:
                held.release()
        self._framebuffer, self._texture, self._size = None, None, (0, 0)


def copied_pixels(ctx: moderngl.Context, blitter: Blitter, source: int, box: Box) -> Bytes:
    """Pixels of a box of a framebuffer, (H, W, 3), the uppermost row first.

    source: OpenGL's name of the framebuffer. box: left, bottom, right, top in pixels. moderngl
    reads a window's own framebuffer by a colour buffer that only framebuffers with textures have:
    the pixels come, but so does GL_INVALID_OPERATION, by which a window seems to have lost its
    objects. A copy on a texture is read without that.
    """
    width, height = box[2] - box[0], box[3] - box[1]
    copy = Offscreen(ctx)
    try:
        copy.resize((width, height))
        blitter.copy(source, box, copy.glo, (0, 0, width, height), smooth=False)
        data = copy.read(components=3, alignment=1)
    finally:
        copy.release()
    return np.frombuffer(data, dtype=np.uint8).reshape(height, width, 3)[::-1]


def collect(ctx: moderngl.Context) -> None:
    """Free what was dropped without being released; call it while the context is current.

    moderngl's own gc() fails on objects that were released before they were dropped.
    """
    while ctx.objects:
        release = getattr(ctx.objects.popleft(), "release", None)
        if release is not None:
            release()


def max_texture_size(ctx: moderngl.Context) -> int:
    """Largest side of a picture on this device, pixels."""
    return int(ctx.info["GL_MAX_TEXTURE_SIZE"])


class _Loader:
    """What moderngl asks of a context that it did not make (glcontext's four methods)."""

    def __init__(
        self,
        load: Callable[[str], int],
        close: Callable[[], None] | None = None,
        current: Callable[[], object] = lambda: None,
    ) -> None:
        self._load = load
        self._close = close
        self._current = current

    def load_opengl_function(self, name: str) -> int:
        return self._load(name) or 0

    def load(self, name: str) -> int:
        return self.load_opengl_function(name)

    def release(self) -> None:
        if self._close is not None:
            self._close()
            self._close = None

    def __enter__(self) -> _Loader:
        self._current()
        return self

    def __exit__(self, *_: object) -> None:
        pass


def _create(**options: Any) -> moderngl.Context:
    """moderngl.create_context; its annotation admits only dictionaries, its code these options."""
    return moderngl.create_context(**options)


def _checked(ctx: moderngl.Context) -> moderngl.Context:
    if ctx.version_code < REQUIRED_GL:
        raise GLUnavailableError(
            f"{ctx.info['GL_RENDERER']} offers OpenGL {ctx.version_code / 100:.1f}, 3.3 is needed"
        )
    ctx.extra = Home()
    ctx.gc_mode = "context_gc"  # what is dropped is freed by `collect`, on the context's thread
    return ctx


def _egl() -> moderngl.Context:
    return _create(standalone=True, backend="egl", require=REQUIRED_GL)


def _standalone() -> moderngl.Context:
    return _create(standalone=True, require=REQUIRED_GL)


def _share_glfw() -> None:
    """Point the glfw module to the GLFW that a window of this process would bring, if one could.

    Two copies of GLFW in one process do not know of each other's state.
    """
    spec = importlib.util.find_spec("imgui_bundle")
    if spec is None or spec.origin is None or os.environ.get("PYGLFW_LIBRARY"):
        return
    for library in sorted(Path(spec.origin).parent.glob("*glfw*.so.3")):
        os.environ["PYGLFW_LIBRARY"] = str(library)


def _osmesa() -> moderngl.Context:
    """OSMesa by way of GLFW's null platform; glcontext has no OSMesa backend of its own."""
    _share_glfw()
    import glfw

    glfw.init_hint(glfw.PLATFORM, glfw.PLATFORM_NULL)
    if not glfw.init():
        raise GLUnavailableError("osmesa: GLFW's null platform does not start")
    glfw.default_window_hints()
    for hint, value in (
        (glfw.VISIBLE, glfw.FALSE),
        (glfw.CONTEXT_CREATION_API, glfw.OSMESA_CONTEXT_API),
        (glfw.CONTEXT_VERSION_MAJOR, 3),
        (glfw.CONTEXT_VERSION_MINOR, 3),
        (glfw.OPENGL_PROFILE, glfw.OPENGL_CORE_PROFILE),
        (glfw.OPENGL_FORWARD_COMPAT, glfw.FALSE),
    ):
        glfw.window_hint(hint, value)
    with warnings.catch_warnings():  # GLFW's words come with the fault below
        warnings.simplefilter("ignore")
        window = glfw.create_window(16, 16, "relgloss", None, None)
    if not window:
        raise GLUnavailableError("osmesa: the library libOSMesa is missing or has no OpenGL 3.3")
    glfw.make_context_current(window)

    def load(name: str) -> int:
        return ctypes.cast(glfw.get_proc_address(name), ctypes.c_void_p).value or 0

    def use() -> None:
        glfw.make_context_current(window)

    loader = _Loader(load, lambda: glfw.destroy_window(window), use)
    return _create(context=loader, require=REQUIRED_GL)
