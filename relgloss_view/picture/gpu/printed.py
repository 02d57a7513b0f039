"""What is printed, as textures: a pack's layers, their mip levels side by side."""

from __future__ import annotations

from typing import Any

import moderngl
import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.errors import InputError
from relgloss_view.base.room import Need, check_room
from relgloss_view.pack.layers import Layers
from relgloss_view.picture.gpu.context import max_texture_size
from relgloss_view.picture.gpu.targets import bytes_of

MOST_LEVELS = 16  #: as in artwork.glsl
HALF = 2  #: bytes


class Printed:
    """The layers of a pack on one OpenGL context; `release` frees them.

    A picture that is larger than the device takes is drawn from the first mip level that it takes;
    `first_level` is its number. Raises InputError where the device can't hold it.
    """

    def __init__(self, ctx: moderngl.Context, layers: Layers) -> None:
        self.layers = layers
        self.first_level = first_level(layers, max_texture_size(ctx))
        sizes = [paint.shape[1::-1] for paint, _ in layers.levels]
        levels = layers.levels[self.first_level :]
        boxes, size = _placed(sizes[self.first_level :])
        count = layers.channels.shape[-1]
        self.channel_targets = -(-count // 4)
        taken = size[0] * size[1] * (4 * HALF + 4 * self.channel_targets)
        check_room(Need(1.5 * taken), "the pack's artwork on the device", "use fewer pixels")
        self._held: list[moderngl.Texture] = []
        try:
            paint = self._texture(ctx, size, "f2")
            channels = [self._texture(ctx, size, "f1") for _ in range(self.channel_targets)]
            for box, (colours, shares) in zip(boxes, levels, strict=True):
                paint.write(np.ascontiguousarray(colours), viewport=box)
                padded = np.zeros((*shares.shape[:2], 4), dtype=np.uint8)
                for k, texture in enumerate(channels):
                    part = shares[..., 4 * k : 4 * k + 4]
                    padded[..., : part.shape[-1]] = part
                    padded[..., part.shape[-1] :] = 0
                    texture.write(padded, viewport=box)
            self._check(ctx)
        except BaseException:
            self.release()
            raise
        listed = np.zeros((MOST_LEVELS, 4), dtype=np.float32)
        listed[: len(boxes)] = boxes
        table = ctx.texture((MOST_LEVELS, 1), 4, listed.tobytes(), dtype="f4")
        table.filter = (moderngl.NEAREST, moderngl.NEAREST)
        self._held.append(table)
        self.uniforms: dict[str, Any] = {
            "paint_image": paint,
            **{f"channels_{k}": texture for k, texture in enumerate(channels)},
            "per_atlas": (1.0 / size[0], 1.0 / size[1]),
            "level_table": table,
            "artwork_texels": boxes[0][2:],
            "last_level": len(boxes) - 1,
        }

    def _texture(self, ctx: moderngl.Context, size: tuple[int, int], dtype: str) -> Any:
        try:
            texture = ctx.texture(size, 4, dtype=dtype)
        except moderngl.Error as error:
            raise InputError(_NO_ROOM) from error
        self._held.append(texture)
        self._check(ctx)
        texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
        return texture

    def _check(self, ctx: moderngl.Context) -> None:
        if ctx.error != "GL_NO_ERROR":
            raise InputError(_NO_ROOM)

    def bytes(self) -> int:
        """Bytes on the device."""
        return sum(bytes_of(texture) for texture in self._held)

    def release(self) -> None:
        """Free the textures."""
        for texture in self._held:
            texture.release()
        self._held.clear()


_NO_ROOM = "the device has no memory for the pack's artwork; use one of fewer pixels"


def first_level(layers: Layers, limit: int) -> int:
    """The first mip level whose texture, with all that follow, is at most so many texels a side."""
    sizes = [paint.shape[1::-1] for paint, _ in layers.levels]
    return next(
        k
        for k in range(len(sizes))
        if max(_placed(sizes[k:])[1]) <= limit and len(sizes) - k <= MOST_LEVELS
    )


def notes_of(ctx: moderngl.Context, layers: Layers) -> tuple[str, ...]:
    """What a user should know of how a device draws layers."""
    first = first_level(layers, max_texture_size(ctx))
    if first == 0:
        return ()
    return (
        f"the artwork has more pixels than this device takes: it is drawn at 1/{2**first} of its "
        "resolution",
    )


def _placed(
    sizes: list[tuple[int, int]],
) -> tuple[list[tuple[int, int, int, int]], tuple[int, int]]:
    """Where each mip level lies in one texture (left, top, width, height), and its size.

    Level 0 at the left, level 1 beside it, the others below level 1.

    >>> _placed([(4, 4), (2, 2), (1, 1)])
    ([(0, 0, 4, 4), (4, 0, 2, 2), (4, 2, 1, 1)], (6, 4))
    """
    (width, height), rest = sizes[0], sizes[1:]
    boxes, top = [(0, 0, width, height)], 0
    for across, down in rest:
        boxes.append((width, top, across, down))
        top += down
    return boxes, (width + (rest[0][0] if rest else 0), max(height, top))


def share_defines(layers: Layers) -> dict[str, int | str]:
    """The constants of artwork.glsl that say which channel holds which share."""
    return {
        "LOBE_CHANNELS": ", ".join(map(str, layers.specular_channel)),
        "BODY_CHANNELS": ", ".join(map(str, layers.diffuse_channel)),
        "OUTSIDE_LOBES": layers.outside_finish,
        "OUTSIDE_DIFFUSE": layers.outside_diffuse,
    }


def part_rows(layers: Layers, printed: tuple[bool, ...]) -> Array:
    """(P, 4), of each part: is it printed, and what covers its lobes and its diffuse part."""
    columns = (printed, layers.part_finish, layers.part_diffuse, [0.0] * len(printed))
    return np.array(columns, dtype=np.float64).T
