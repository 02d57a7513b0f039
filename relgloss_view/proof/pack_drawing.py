"""What a page draws packs and forms of triangles with, beside drawing.py."""

from __future__ import annotations

from typing import Any

from relgloss_view.base.errors import InputError
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.scene import Scene


def pack_drawing(scene: Scene, look: Look, lamps: tuple[str, ...]) -> dict[str, Any]:
    """The entries of a side that its pack or its triangles need, merged over those of drawing.py.

    lamps: the illuminants that the page offers. `stages` lists further stages. Raises InputError.
    """
    raise InputError(f"{scene.name}: a proof of packs and meshes is not made yet")
