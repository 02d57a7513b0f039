"""What a frame is asked to be."""

from __future__ import annotations

from dataclasses import dataclass

from relgloss_view.picture.scene import Look, Scene
from relgloss_view.picture.view import Size


@dataclass(frozen=True)
class Request:
    """What a frame was asked to be."""

    scene: Scene
    look: Look
    size: Size
