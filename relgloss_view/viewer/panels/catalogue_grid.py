"""The thumbnails of a catalogue: only the rows that show are laid out, however many there are."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from imgui_bundle import ImVec2, imgui

from relgloss_view.viewer.panels.drop_hand import PAYLOAD
from relgloss_view.viewer.panels.list_rows import both_ends, fitting
from relgloss_view.viewer.shell import widgets
from relgloss_view.viewer.shell.theme import POPUP, em, gray
from relgloss_view.viewer.state.catalogues import (
    is_done,
    marks_of,
    numbers_of,
    title_of,
    tooltip_of,
    view_command,
)

if TYPE_CHECKING:
    from relgloss_view.catalogue.query.found import Found, Hit
    from relgloss_view.viewer.shell.catalogue_actions import CatalogueActions

EMPTY = (
    "This catalogue is empty: the folder that it was built from has no table, material or proof. "
    "Build it from another folder."
)
NOTHING = "Nothing is found. Loosen a condition, or empty the search."
PAD_EM, GAP_EM = 0.3, 0.35  #: within a tile; between tiles
BEYOND = 1  #: rows above and below what shows, for the keyboard and for what comes next
WORDS_EM = 6.0  #: a tile as wide has room for words on its picture; a narrower one has "!"


def show(actions: CatalogueActions) -> None:
    """Draw the tiles of what was found into the rest of the present window."""
    found = actions.found
    if found is None:
        return
    if not found.hits:
        widgets.wrapped(NOTHING if found.searched else EMPTY, dim=True)
        return
    if actions.to_top:
        imgui.set_next_window_scroll(ImVec2(0.0, 0.0))
        actions.to_top = False
    imgui.begin_child("##tiles", ImVec2(0.0, 0.0))
    _Grid(actions, found).show()
    imgui.end_child()


class _Grid:
    """The tiles in one frame."""

    def __init__(self, actions: CatalogueActions, found: Found) -> None:
        self.actions, self.found = actions, found
        self.gap, self.pad = em(GAP_EM), em(PAD_EM)
        self.room = max(imgui.get_content_region_avail().x, 1.0)
        # Tiles of about the wanted width, which fill the line.
        wanted = em(actions.tile_em) + 2.0 * self.pad
        self.columns = max(1, round((self.room + self.gap) / (wanted + self.gap)))
        fill = (self.room + self.gap) / self.columns - self.gap
        self.width = math.floor(min(fill, 1.5 * wanted))
        self.picture = self.width - 2.0 * self.pad
        self.line = imgui.get_text_line_height()
        self.height = math.ceil(self.picture + 2.0 * self.line + 3.0 * self.pad)

    def show(self) -> None:
        """Lay out the rows that show."""
        pitch = self.height + self.gap
        rows = -(-len(self.found.hits) // self.columns)
        start, origin = imgui.get_scroll_y(), imgui.get_cursor_pos()
        tall = imgui.get_window_height()
        first = max(0, int(start / pitch) - BEYOND)
        last = min(rows, int((start + tall) / pitch) + 1 + BEYOND)
        for row in range(first, last):
            for k in range(self.columns):
                index = row * self.columns + k
                if index >= len(self.found.hits):
                    break
                x = origin.x + k * (self.width + self.gap)
                imgui.set_cursor_pos(ImVec2(x, origin.y + row * pitch))
                imgui.push_id(index)
                self._tile(self.found.hits[index])
                imgui.pop_id()
        # The scroll bar is that of all rows.
        imgui.set_cursor_pos(ImVec2(origin.x, origin.y + rows * pitch - self.gap - 1.0))
        imgui.dummy(ImVec2(1.0, 1.0))

    def _tile(self, hit: Hit) -> None:
        actions = self.actions
        imgui.invisible_button(
            "tile",
            ImVec2(self.width, self.height),
            imgui.ButtonFlags_.mouse_button_left | imgui.ButtonFlags_.enable_nav,
        )
        low, high = imgui.get_item_rect_min(), imgui.get_item_rect_max()
        hovered, focused = imgui.is_item_hovered(), imgui.is_item_focused()
        self._paint(hit, low, high, lit=hovered)
        self._take_hand(hit, hovered=hovered, focused=focused)
        if is_done(hit.row):
            self._drag(hit)
        if imgui.begin_popup_context_item("menu"):
            actions.selected, actions.held = hit.path, True
            self._menu(hit)
            imgui.end_popup()
        elif hovered and not imgui.is_mouse_dragging(imgui.MouseButton_.left):
            widgets.tooltip(tooltip_of(hit, self.found))

    def _take_hand(self, hit: Hit, *, hovered: bool, focused: bool) -> None:
        actions, key = self.actions, imgui.Key
        if hovered and imgui.is_mouse_clicked(imgui.MouseButton_.left):
            actions.selected = hit.path
        if hovered and imgui.is_mouse_double_clicked(imgui.MouseButton_.left):
            actions.set("test", hit)
        if focused and imgui.get_io().nav_visible:
            actions.selected = hit.path
            if imgui.is_key_pressed(key.enter, False) or imgui.is_key_pressed(
                key.keypad_enter, False
            ):
                actions.set("reference" if imgui.get_io().key_shift else "test", hit)

    def _drag(self, hit: Hit) -> None:
        if not imgui.begin_drag_drop_source(imgui.DragDropFlags_.source_no_hold_to_open_others):
            return
        self.actions.dragged, self.actions.held = hit, True
        imgui.set_drag_drop_payload_py_id(PAYLOAD, 1)
        texture = self.actions.thumbnails.texture(hit.path)
        if texture:
            side = em(5.0)
            imgui.image(imgui.ImTextureRef(texture), ImVec2(side, side), ImVec2(0, 1), ImVec2(1, 0))
        imgui.text_unformatted(title_of(hit.row))
        imgui.end_drag_drop_source()

    def _menu(self, hit: Hit) -> None:
        actions, able = self.actions, is_done(hit.row)
        if _item("As test", "Enter", able):
            actions.set("test", hit)
        if _item("As reference", "Shift+Enter", able):
            actions.set("reference", hit)
        imgui.separator()
        if _item("Nearest to this", "", able):
            actions.ask_nearest(hit)
        if _item("Write proof...", "", able):
            actions.write_proof(hit)
        imgui.separator()
        if not able:
            if _item("Copy fault", "", True):
                actions.copy_fault(hit)
            return
        if _item("Copy command", "", able):
            actions.copy(hit, view_command)
        if _item("Copy material's file", "", able):
            actions.copy(hit, str)

    # --- painting -----------------------------------------------------------------------------

    def _paint(self, hit: Hit, low: ImVec2, high: ImVec2, *, lit: bool) -> None:
        painter = imgui.get_window_draw_list()
        selected = hit.path == self.actions.selected
        if lit or selected:
            name = imgui.Col_.frame_bg_hovered if selected else imgui.Col_.frame_bg
            painter.add_rect_filled(low, high, imgui.get_color_u32(name), 3.0)
        left, top = low.x + self.pad, low.y + self.pad
        corner = ImVec2(left + self.picture, top + self.picture)
        texture = self.actions.thumbnails.texture(hit.path)
        if texture:
            painter.add_image(
                imgui.ImTextureRef(texture), ImVec2(left, top), corner, ImVec2(0, 1), ImVec2(1, 0)
            )
        else:
            ground = imgui.get_color_u32(gray(POPUP))
            painter.add_rect_filled(ImVec2(left, top), corner, ground, 2.0)
            if texture is None:
                text = fitting("no picture", self.picture)
                self._quiet(ImVec2(left + self.pad, top + self.pad), text)
        self._marks(hit, left, corner.y)
        y = corner.y + 0.5 * self.pad
        bright = imgui.get_color_u32(imgui.Col_.text)
        painter.add_text(ImVec2(left, y), bright, both_ends(title_of(hit.row), self.picture))
        numbers = numbers_of(hit, self.found)
        self._quiet(ImVec2(left, y + self.line), fitting(numbers, self.picture))
        if selected:
            ring = imgui.get_color_u32(imgui.Col_.slider_grab_active)
            painter.add_rect(low, high, ring, 3.0)

    def _quiet(self, place: ImVec2, text: str) -> None:
        colour = imgui.get_color_u32(imgui.Col_.text_disabled)
        imgui.get_window_draw_list().add_text(place, colour, text)

    def _marks(self, hit: Hit, left: float, bottom: float) -> None:
        """Words at the lower edge of the picture: what one should know before one relies on it."""
        marks = marks_of(hit.row)
        if not marks:
            return
        more = f" +{len(marks) - 1}" if len(marks) > 1 else ""  # the tooltip has all of them
        words = f"{marks[0]}{more}" if self.picture >= em(WORDS_EM) else "!"
        text = fitting(words, self.picture - 2.0 * self.pad)
        size = imgui.calc_text_size(text)
        low = ImVec2(left, bottom - size.y - 0.3 * self.pad)
        high = ImVec2(left + size.x + 2.0 * self.pad, bottom)
        painter = imgui.get_window_draw_list()
        painter.add_rect_filled(low, high, imgui.get_color_u32(gray(POPUP, 0.85)), 2.0)
        place = ImVec2(left + self.pad, low.y)
        painter.add_text(place, imgui.get_color_u32(imgui.Col_.text), text)


def _item(text: str, key: str, able: bool) -> bool:
    return bool(imgui.menu_item(text, key, False, able)[0])
