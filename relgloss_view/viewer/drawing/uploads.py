"""Pictures that were made in numpy, on the device, where the window copies its pictures from."""

from __future__ import annotations

from typing import Any

import numpy as np

from relgloss_view.picture.displayed import Displayed


class _Upload:
    def __init__(self, ctx: Any, displayed: Displayed) -> None:
        height, width = displayed.digital.shape[:2]
        pixels = np.full((height, width, 4), 255, dtype=np.uint8)
        pixels[..., :3] = displayed.digital[::-1]  # row 0 of a texture is the lowest
        self.of = displayed
        self.texture = ctx.texture((width, height), 4, pixels)
        self.framebuffer = ctx.framebuffer([self.texture])

    def release(self) -> None:
        self.framebuffer.release()
        self.texture.release()


class Uploads:
    """One picture a side; put there again only where it is another."""

    def __init__(self, ctx: Any) -> None:
        self._ctx = ctx
        self._of: dict[str, _Upload] = {}

    def framebuffer(self, side: str, displayed: Displayed) -> int:
        """The name of a framebuffer that holds a picture."""
        held = self._of.get(side)
        if held is None or held.of is not displayed:
            if held is not None:
                held.release()
            self._of[side] = held = _Upload(self._ctx, displayed)
        return int(held.framebuffer.glo)

    def names(self) -> list[int]:
        """The textures' names on the device."""
        return [held.texture.glo for held in self._of.values()]

    def release(self) -> None:
        """Free everything on the device."""
        for held in self._of.values():
            held.release()
        self._of.clear()
