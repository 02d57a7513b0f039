"""Outlines over a picture whose material is being estimated: where its highlight might end instead.

The line of the dullest material that the readings allow is broken, that of the glossiest is whole.
"""

from __future__ import annotations

from imgui_bundle import ImVec2, imgui

from relgloss_view.viewer.drawing.arrangement import Arrangement
from relgloss_view.viewer.shell.theme import em, gray
from relgloss_view.viewer.state.model import Model
from relgloss_view.viewer.state.state import FLIP, SIDE_BY_SIDE

LINE, SHADOW = gray(1.0, 0.75), gray(0.0, 0.45)
BROKEN = "dullest"
DASH_EM = 0.5


def show(model: Model, painter: imgui.ImDrawList, origin: ImVec2, arrangement: Arrangement) -> None:
    """Draw the outlines, where the picture shows whole and nothing else lies over it."""
    presentation = model.state.presentation
    rect = arrangement.rects.get(model.ghost_side)
    alone = presentation.overlay == "none" and presentation.compare in (SIDE_BY_SIDE, FLIP)
    if rect is None or not model.ghosts or not alone or not model.ghost_outlines:
        return
    left, top, width, height = rect
    inks = imgui.get_color_u32(SHADOW), imgui.get_color_u32(LINE)
    dash = em(DASH_EM)
    for name, ghost in model.ghosts.items():
        edge = ghost.edge.copy()
        if presentation.mirror:
            edge[..., 0] = 1.0 - edge[..., 0]
        x0, y0 = origin.x + left, origin.y + top
        lines = [
            (x0 + width * a[0], y0 + height * a[1], x0 + width * b[0], y0 + height * b[1])
            for a, b in edge.tolist()
        ]
        if name == BROKEN:  # by height on the screen, since a highlight's edge mostly goes down
            lines = [one for one in lines if int((one[1] + one[0]) / dash) % 2 == 0]
        for ink, shift in zip(inks, (1.0, 0.0), strict=True):
            for ax, ay, bx, by in lines:
                painter.add_line(ImVec2(ax + shift, ay), ImVec2(bx + shift, by), ink, 1.0)
