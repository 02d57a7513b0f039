"""Pictures that were made in numpy, uploaded to textures from which the window copies."""

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


class TextureUploads:
    """One picture a side; uploaded again only where it is another."""

    def __init__(self, ctx: Any) -> None:
        self._ctx = ctx
        self._of: dict[str, _Upload] = {}

    def framebuffer(self, side: str, displayed: Displayed) -> int:
        """The name of a framebuffer that holds a picture."""
        upload = self._of.get(side)
        if upload is None or upload.of is not displayed:
            if upload is not None:
                upload.release()
            self._of[side] = upload = _Upload(self._ctx, displayed)
        return int(upload.framebuffer.glo)

    def names(self) -> list[int]:
        """The textures' names on the device."""
        return [upload.texture.glo for upload in self._of.values()]

    def release(self) -> None:
        """Free everything on the device."""
        for upload in self._of.values():
            upload.release()
        self._of.clear()
