"""Many small pictures as textures: few are uploaded in a frame, and few are kept.

A panel asks for those that it is about to show. What no panel has asked for lately makes room.
"""

from __future__ import annotations

import time
from collections import OrderedDict
from typing import Any

import numpy as np

from relgloss_view.base.arrays import Bytes

MOST_KEPT = 600  #: textures; 128 x 128 pixels with their smaller copies take 87 kB each
MOST_IN_A_FRAME = 12
BUDGET_S = 0.004  #: for uploads in a frame


class Thumbnails:
    """Textures by name; `texture` notes what is wanted, `upload` puts pictures on the device."""

    def __init__(self, most: int = MOST_KEPT) -> None:
        self.most = most
        self._kept: OrderedDict[str, Any] = OrderedDict()  # the last used at the end
        self._waiting: dict[str, Bytes] = {}
        self._bare: set[str] = set()  # names that have no picture
        self._wanted: list[str] = []
        self._asked = 0  #: names that were asked for since the last upload

    def texture(self, name: str) -> int | None:
        """The texture of a picture; 0 where it is still to come, None where there is none."""
        self._asked += 1
        texture = self._kept.get(name)
        if texture is not None:
            self._kept.move_to_end(name)
            return int(texture.glo)
        if name in self._bare:
            return None
        self._wanted.append(name)
        return 0

    def take_wanted(self) -> list[str]:
        """The names that were asked for since the last call, and are not here."""
        wanted, self._wanted = self._wanted, []
        return [name for name in wanted if name not in self._waiting]

    def give(self, pictures: dict[str, Bytes | None]) -> None:
        """Take pictures (H, W, 3), to be uploaded; None for names that have none."""
        for name, digital in pictures.items():
            if digital is None:
                self._bare.add(name)
            else:
                self._waiting[name] = digital

    @property
    def waiting(self) -> bool:
        """Whether pictures wait for the next frames, or are wanted."""
        return bool(self._waiting or self._wanted)

    def upload(self, ctx: Any) -> int:
        """Put some of the pictures on the device; returns how many."""
        began_s, count = time.perf_counter(), 0
        while self._waiting and count < MOST_IN_A_FRAME:
            name = next(iter(self._waiting))
            digital = self._waiting.pop(name)
            if name not in self._kept:
                self._kept[name] = _texture(ctx, digital)
                count += 1
            if time.perf_counter() - began_s > BUDGET_S:
                break
        # What shows now is never thrown away, however much a large window shows.
        most, self._asked = max(self.most, 2 * self._asked), 0
        while len(self._kept) > most:
            self._kept.popitem(last=False)[1].release()
        return count

    @property
    def count(self) -> int:
        """How many textures are on the device."""
        return len(self._kept)

    def release(self) -> None:
        """Free all textures; pictures have to be given again."""
        for texture in self._kept.values():
            texture.release()
        self.abandon()

    def abandon(self) -> None:
        """Forget all textures, which the device has lost."""
        self._kept.clear()
        self._waiting.clear()
        self._bare.clear()
        self._wanted.clear()


def _texture(ctx: Any, digital: Bytes) -> Any:
    height, width = digital.shape[:2]
    pixels = np.full((height, width, 4), 255, dtype=np.uint8)
    pixels[..., :3] = digital[::-1]  # row 0 of a texture is the lowest
    texture = ctx.texture((width, height), 4, pixels)
    texture.build_mipmaps()  # a small tile shows the mean of its pixels, not one of four
    return texture
