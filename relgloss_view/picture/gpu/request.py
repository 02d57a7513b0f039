"""What a frame is asked to be."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

from relgloss_view.picture.method import EXACT, Method
from relgloss_view.picture.model.view import Size
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.setting import Setting


@dataclass(frozen=True)
class Request:
    """What a frame was asked to be."""

    scene: Scene
    look: Look
    size: Size
    method: Method = EXACT
    factor: float = 1.0  #: of c, so that a pair of pictures is scaled alike

    def without_grain(self) -> Request:
        """The same, its surface smooth, whatever c."""
        look = self.look.at(Setting())
        return dataclasses.replace(self, look=look)
