"""Where the finishes of a pack lie, as tints over its picture, with their names."""

from __future__ import annotations

from imgui_bundle import ImVec2, imgui

from relgloss_view.base.reading import printable
from relgloss_view.viewer.drawing.arrangement import Arrangement
from relgloss_view.viewer.drawing.mask_tints import TINTS
from relgloss_view.viewer.panels.captions import ink_on, paper_on
from relgloss_view.viewer.shell.theme import em
from relgloss_view.viewer.state.model import Model

SWATCH_EM = 0.8


def show(model: Model, painter: imgui.ImDrawList, origin: ImVec2, arrangement: Arrangement) -> None:
    """Lay the tints over the pictures, and name them in the lower left corner of each."""
    mirrored = model.state.presentation.mirror
    for side, rect in arrangement.rects.items():
        texture = model.tints.get(side)
        pack = model.pack(side)
        if texture is None or pack is None:
            continue
        display = model.display_of(side)
        left, top = origin.x + rect[0], origin.y + rect[1]
        low, high = ImVec2(left, top), ImVec2(left + rect[2], top + rect[3])
        across = (1.0, 0.0) if mirrored else (0.0, 1.0)
        # Row 0 of a texture is the lowest.
        painter.add_image(
            imgui.ImTextureRef(texture), low, high, ImVec2(across[0], 1.0), ImVec2(across[1], 0.0)
        )
        names = [(k, one.name) for k, one in enumerate(pack.finishes) if one.name in model.masked]
        line = imgui.get_text_line_height()
        for place, (k, name) in enumerate(names):
            y = top + rect[3] - em(0.6) - (len(names) - place) * line
            x = left + em(0.6)
            size = em(SWATCH_EM)
            red, green, blue = TINTS[k % len(TINTS)]
            colour = imgui.color_convert_float4_to_u32(imgui.ImVec4(red, green, blue, 1.0))
            middle = y + 0.5 * (line - size)
            painter.add_rect_filled(ImVec2(x, middle), ImVec2(x + size, middle + size), colour)
            place_of_text = ImVec2(x + size + em(0.4), y)
            text = printable(name, 60)
            extent = imgui.calc_text_size(text)
            end = ImVec2(place_of_text.x + extent.x, place_of_text.y + extent.y)
            painter.add_rect_filled(place_of_text, end, paper_on(display))
            painter.add_text(place_of_text, ink_on(display), text)
