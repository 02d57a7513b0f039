"""What is dragged from a panel and dropped on a picture: a sample for that picture's side."""

from __future__ import annotations

from collections.abc import Callable

from imgui_bundle import ImVec2, imgui

from relgloss_view.viewer.drawing.arrangement import Rect
from relgloss_view.viewer.shell.theme import POPUP, TEXT, em, gray

#: A side, the place in its picture, and the picture's rectangle in the pane.
Under = tuple[str, tuple[float, float], Rect]
PAYLOAD = "sample"
WORDS = {"reference": "Becomes the reference", "test": "Becomes the test"}
EDGE_EM = 0.2


def take_drop(under: Under | None, origin: ImVec2, drop: Callable[[str], None]) -> None:
    """Let the item before this call take what is dragged, and mark the picture that gets it.

    under: what is under the pointer. drop: called with the side when the hand lets go.
    """
    if not imgui.begin_drag_drop_target():
        return
    payload = imgui.get_drag_drop_payload_py_id()
    if under is not None and payload is not None and payload.type == PAYLOAD:
        side, _, rect = under
        _mark(side, rect, origin)
        flags = imgui.DragDropFlags_.accept_no_draw_default_rect
        if imgui.accept_drag_drop_payload_py_id(PAYLOAD, flags) is not None:
            drop(side)
    imgui.end_drag_drop_target()


def _mark(side: str, rect: Rect, origin: ImVec2) -> None:
    """A ring around the picture, and what letting go does."""
    painter, inset = imgui.get_window_draw_list(), 0.5 * em(EDGE_EM)
    low = ImVec2(origin.x + rect[0] + inset, origin.y + rect[1] + inset)
    high = ImVec2(low.x + rect[2] - 2.0 * inset, low.y + rect[3] - 2.0 * inset)
    painter.add_rect(low, high, imgui.get_color_u32(gray(TEXT)), 0.0, em(EDGE_EM))
    words = WORDS[side]
    size, pad = imgui.calc_text_size(words), em(0.5)
    x = 0.5 * (low.x + high.x - size.x)
    y = high.y - size.y - 2.0 * pad
    ground = ImVec2(x - pad, y - 0.5 * pad), ImVec2(x + size.x + pad, y + size.y + 0.5 * pad)
    painter.add_rect_filled(*ground, imgui.get_color_u32(gray(POPUP, 0.9)), 3.0)
    painter.add_text(ImVec2(x, y), imgui.get_color_u32(gray(TEXT)), words)
