"""Pictures that were made in numpy, uploaded to textures from which the window copies."""

from __future__ import annotations

from typing import Any

import numpy as np

from relgloss_view.base.arrays import Bytes
from relgloss_view.picture.displayed import Displayed


class _Upload:
    def __init__(self, ctx: Any, of: object, digital: Bytes) -> None:
        height, width = digital.shape[:2]
        pixels = np.full((height, width, 4), 255, dtype=np.uint8)
        pixels[..., : digital.shape[2]] = digital[::-1]  # row 0 of a texture is the lowest
        self.of = of
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
        return int(self._upload(side, displayed, displayed.digital).framebuffer.glo)

    def texture(self, name: str, digital: Bytes) -> int:
        """The name of a texture that holds digital values (H, W, 3), or with alpha (H, W, 4)."""
        return int(self._upload(name, digital, digital).texture.glo)

    def _upload(self, name: str, of: object, digital: Bytes) -> _Upload:
        upload = self._of.get(name)
        if upload is None or upload.of is not of:
            if upload is not None:
                upload.release()
            self._of[name] = upload = _Upload(self._ctx, of, digital)
        return upload

    def names(self) -> list[int]:
        """The textures' names on the device."""
        return [upload.texture.glo for upload in self._of.values()]

    def release(self) -> None:
        """Free everything on the device."""
        for upload in self._of.values():
            upload.release()
        self._of.clear()
