"""The targets of the passes: made once a size, checked, cleared where a pass does not reach."""

from __future__ import annotations

from typing import Any

import moderngl
import numpy as np
from numpy.typing import NDArray

from relgloss_view.errors import InputError, RelglossError
from relgloss_view.picture.context import max_texture_size
from relgloss_view.picture.view import Size

SHADE = ("diffuse", "specular")
SPLIT = ("split",)
TONE = ("display", "flags")
LIGHT = ("light", "lab")
GEOMETRY = ("normal", "tilted_normal", "point_m")
OVERLAY = ("overlay",)
OFF_OBJECT = -1e6  #: as in tone.glsl
#: What says in pass 1 and 2 that a pixel shows nothing of the object, outside its bounds too.
CLEARED = {SHADE: (0.0, 0.0, 0.0, 0.0), SPLIT: (OFF_OBJECT, 0.0, 0.0, 0.0)}
#: Components of the targets that hold 8-bit numbers; the others hold four floats.
EIGHT_BIT = {"display": 4, "flags": 1, "overlay": 4}


class Targets:
    """The textures that passes write and read, all of one size, and framebuffers over them."""

    def __init__(self, ctx: moderngl.Context) -> None:
        self.ctx = ctx
        self.size: Size | None = None
        self._textures: dict[str, moderngl.Texture] = {}
        self._framebuffers: dict[tuple[str, ...], moderngl.Framebuffer] = {}
        # Bound while others are freed: a bound framebuffer can't be freed where no screen exists.
        self._parking = ctx.framebuffer([ctx.texture((1, 1), 4)])

    def resize(self, size: Size) -> bool:
        """Make room for pictures of a size; returns whether everything drawn so far is gone.

        Raises InputError where the device can't hold it, and holds nothing then.
        """
        if size == self.size:
            return False
        limit = max_texture_size(self.ctx)
        if max(size) > limit:
            raise InputError(
                f"size {size[0]}x{size[1]}: this device draws at most {limit} pixels a side; "
                "give a smaller --size or --backend reference"
            )
        self.release()
        self.size = size
        try:
            self.framebuffer(SHADE)
        except BaseException:  # whatever went wrong, nothing half made is kept
            self.release()
            raise
        return True

    def names(self) -> list[int]:
        """OpenGL's names of the textures."""
        return [int(texture.glo) for texture in self._textures.values()]

    def texture(self, name: str) -> moderngl.Texture:
        """The texture of a target that has been drawn."""
        return self._textures[name]

    def framebuffer(self, names: tuple[str, ...]) -> moderngl.Framebuffer:
        """What a pass that writes these targets draws into; made when first asked for."""
        if names not in self._framebuffers:
            assert self.size is not None
            made: dict[str, moderngl.Texture] = {}
            try:
                for name in names:
                    made[name] = self._texture(self.size, name)
                self._framebuffers[names] = self.ctx.framebuffer([*made.values()])
            except BaseException:
                for texture in made.values():
                    texture.release()
                raise
            self._textures |= made
        return self._framebuffers[names]

    def read(self, name: str) -> NDArray[Any]:
        """A target's contents, (H, W, components), rows from the top."""
        texture = self._textures[name]
        data = texture.read(alignment=1)
        if self.ctx.error != "GL_NO_ERROR":
            raise RelglossError(f"{name}: the device failed while the picture was read back")
        kind = np.uint8 if name in EIGHT_BIT else np.float32
        shape = (texture.height, texture.width, texture.components)
        return np.frombuffer(data, dtype=kind).reshape(shape)[::-1]

    def release(self) -> None:
        """Free everything that a size needs."""
        self._parking.use()
        for framebuffer in self._framebuffers.values():
            framebuffer.release()
        for texture in self._textures.values():
            texture.release()
        self._framebuffers.clear()
        self._textures.clear()
        self.size = None

    def _texture(self, size: Size, name: str) -> moderngl.Texture:
        refused = InputError(
            f"size {size[0]}x{size[1]}: the device has no memory for it; give a smaller --size"
        )
        dtype = "f1" if name in EIGHT_BIT else "f4"
        try:
            texture = self.ctx.texture(size, EIGHT_BIT.get(name, 4), dtype=dtype)
        except moderngl.Error as error:
            raise refused from error
        if self.ctx.error != "GL_NO_ERROR":  # moderngl itself raises on few of these
            texture.release()
            raise refused
        texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
        return texture
