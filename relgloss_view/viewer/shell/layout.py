"""The panels' places: a dock space, its first arrangement, and hiding all without losing it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from imgui_bundle import ImVec2, imgui

from relgloss_view.viewer.shell.theme import em

internal = imgui.internal

#: The column of controls, from above: sample, gloss, light; and the strip of plots.
SAMPLE, GLOSS, LIGHT, BELOW, BELOW_RIGHT = "sample", "gloss", "light", "below", "below right"
CONTROLS = (SAMPLE, GLOSS, LIGHT)
RIGHT_EM = 25.0  #: width of the column of controls
BELOW_EM = 18.0  #: height of the strip of plots
#: Of the window's width and height: the pictures stay the largest thing in it.
LEAST_SHARE, MOST_SHARE = 0.15, (0.40, 0.42)
STAGE, STATUS, DOCK = "Pictures", "##status", "##dock"  #: windows that are no panels
_STAGE_FLAGS = (
    imgui.WindowFlags_.no_decoration
    | imgui.WindowFlags_.no_docking
    | imgui.WindowFlags_.no_background
    | imgui.WindowFlags_.no_bring_to_front_on_focus
    | imgui.WindowFlags_.no_move
    | imgui.WindowFlags_.no_saved_settings
    | imgui.WindowFlags_.no_scroll_with_mouse
)
PIXEL_SHARE = 0.4  #: of the strip below
APART_EM = 44.0  #: width of a strip with room for two groups of panels side by side
#: Least widths and heights of docked panels, and what the pictures have beside them. Where a window
#: is too small for both, the panels of that place don't show until it grows.
LEAST_EM = {
    **dict.fromkeys(CONTROLS, (16.0, 8.0)),
    BELOW: (16.0, 8.0),
    BELOW_RIGHT: (12.0, 8.0),
}
PICTURES_EM = (20.0, 9.0)
SAMPLE_SHARE = 0.46  #: of the column of controls
#: A column so high has three parts; in a lower one the light is a tab beside the gloss.
THREE_PARTS_EM = 60.0
THREE_SHARES = (0.36, 0.36)  #: of sample and gloss


@dataclass
class Panel:
    """A window of the program: its title, its place at first, and what draws it."""

    title: str
    place: str
    show: Callable[[], None]
    at_first: bool = True  #: whether it is open at the first start
    visible: bool = True
    docked: bool = False  #: whether it was in the dock space when it was last drawn
    dock_id: int = 0  #: of its place in the dock space then
    in_front: bool = False  #: whether it was no tab behind another then

    def __post_init__(self) -> None:
        self.visible = self.at_first


class Layout:
    """The panels around the stage, which fills what they leave."""

    def __init__(self, panels: list[Panel]) -> None:
        self.panels = panels
        self.hidden = False  #: all of them, by one key
        self._arrange_again = False
        self._new = True
        self._focus: list[str] = []
        self._roomless: set[str] = set()  #: places for whose panels the window is too small
        self._entering = ""  #: the window that the keyboard is about to enter
        self._entered = ""  #: the last one that had it

    def reset(self) -> None:
        """Show the panels of the first start, each in its first place."""
        self.hidden = False
        self._arrange_again = True
        for panel in self.panels:
            panel.visible = panel.at_first

    def focus(self, title: str) -> None:
        """Bring a panel to the front; a closed one opens."""
        self.hidden = False
        next(p for p in self.panels if p.title == title).visible = True
        self._focus.append(title)

    @property
    def crowded(self) -> bool:
        """Whether the window is too small for some of the panels, which therefore don't show."""
        return (
            any(p.visible and p.docked and p.place in self._roomless for p in self.panels)
            and not self.hidden
        )

    def enter(self, title: str) -> None:
        """Give a panel or the stage the keyboard, and show which of its controls has it."""
        self._entering = title

    def keep_focus(self, present: str) -> None:
        """Give the keyboard back to where it was, if a window has it that has no controls.

        present: the window that has it. When a dialog closes, ImGui gives it to the status line;
        at the start, to the panel that was drawn last, which may be a tab behind another.
        """
        shown = [STAGE, *(p.title for p in self._shown() if p.in_front)]
        bare = present in ("", STATUS, DOCK) or any(p.title == present for p in self.panels)
        if present in shown:
            self._entered = present
        elif bare and not self._focus and not self._entering and not imgui.is_any_item_active():
            # (What is pressed would be let go of: the status line has a button at times.)
            last = self._entered if self._entered in shown else shown[min(1, len(shown) - 1)]
            window = internal.find_window_by_name(last)
            if window is not None:
                internal.focus_window(window)

    def _shown(self) -> list[Panel]:
        return [] if self.hidden else [panel for panel in self.panels if panel.visible]

    def _enter(self, title: str) -> None:
        """Call it within the window."""
        if title != self._entering:
            return
        if imgui.is_window_focused(imgui.FocusedFlags_.root_and_child_windows):
            internal.nav_init_window(internal.get_current_window(), False)
            imgui.set_nav_cursor_visible(True)
            self._entering = ""

    def show(self, stage: Callable[[], None], top_px: float, bottom_px: float) -> None:
        """Draw panels and stage between the menu bar and the status line."""
        viewport = imgui.get_main_viewport()
        place = ImVec2(viewport.pos.x, viewport.pos.y + top_px)
        size = ImVec2(viewport.size.x, max(viewport.size.y - top_px - bottom_px, 1.0))
        if self._new:
            # Windows that stay at the back are in front of those of their kind that come later: the
            # mouse must find the stage before the dock space behind it.
            imgui.begin(STAGE, None, _STAGE_FLAGS)
            imgui.end()
            self._new = False
        self._roomless = _roomless(size)
        space = self._dock_space(place, size)
        if not self.hidden:
            for panel in self.panels:
                if panel.visible and not (panel.docked and panel.place in self._roomless):
                    self._show_panel(panel)
            node = internal.dock_builder_get_central_node(space)
            if node is not None and node.size.x >= 1.0 and node.size.y >= 1.0:
                place, size = node.pos, node.size
        self._show_stage(stage, place, size)

    def show_alone(self, stage: Callable[[], None]) -> None:
        """Draw the stage over the whole window; the panels are kept as they are."""
        hidden, self.hidden = self.hidden, True
        self.show(stage, 0.0, 0.0)
        self.hidden = hidden

    def _dock_space(self, place: ImVec2, size: ImVec2) -> int:
        flags = imgui.WindowFlags_
        imgui.set_next_window_pos(place)
        imgui.set_next_window_size(size)
        imgui.push_style_var(imgui.StyleVar_.window_padding, ImVec2(0.0, 0.0))
        imgui.begin(
            DOCK,
            None,
            flags.no_decoration
            | flags.no_docking
            | flags.no_background
            | flags.no_bring_to_front_on_focus
            | flags.no_nav_focus
            | flags.no_move
            | flags.no_saved_settings,
        )
        imgui.pop_style_var()
        space = int(imgui.get_id("space"))
        if self._arrange_again or internal.dock_builder_get_node(space) is None:
            self._arrange(space, size)
            self._arrange_again = False
        node_flags = imgui.DockNodeFlags_.passthru_central_node
        # Tabs are close to each other, and without a menu of their own: their names need the room.
        node_flags |= internal.DockNodeFlagsPrivate_.no_window_menu_button
        style = imgui.get_style()
        near = ImVec2(0.6 * style.frame_padding.x, style.frame_padding.y)
        imgui.push_style_var(imgui.StyleVar_.frame_padding, near)
        imgui.push_style_var(imgui.StyleVar_.item_inner_spacing, ImVec2(near.x, near.y))
        if self.hidden:
            node_flags |= imgui.DockNodeFlags_.keep_alive_only
        imgui.dock_space(space, ImVec2(0.0, 0.0), node_flags)
        imgui.pop_style_var(2)
        imgui.end()
        return space

    def _arrange(self, space: int, size: ImVec2) -> None:
        """The arrangement of the first start: controls on the right, plots below the pictures.

        Where no plot is open, the pictures have the place of the strip.
        """
        internal.dock_builder_remove_node(space)
        internal.dock_builder_add_node(space, internal.DockNodeFlagsPrivate_.dock_space)
        internal.dock_builder_set_node_size(space, size)
        right = _share(em(RIGHT_EM), size.x, MOST_SHARE[0])
        split = internal.dock_builder_split_node(space, imgui.Dir.right, right)
        nodes = self._arrange_controls(split.id_at_dir, size.y)
        below = _share(em(BELOW_EM), size.y, MOST_SHARE[1])
        split = internal.dock_builder_split_node(split.id_at_opposite_dir, imgui.Dir.down, below)
        nodes |= {BELOW: split.id_at_dir, BELOW_RIGHT: split.id_at_dir}
        if (1.0 - right) * size.x >= em(APART_EM):
            strip = internal.dock_builder_split_node(split.id_at_dir, imgui.Dir.right, PIXEL_SHARE)
            nodes |= {BELOW: strip.id_at_opposite_dir, BELOW_RIGHT: strip.id_at_dir}
        for panel in self.panels:
            internal.dock_builder_dock_window(panel.title, nodes[panel.place])
        internal.dock_builder_finish(space)
        # The first panel of each place is the one that shows.
        seen: set[int] = set()
        for panel in self.panels:
            if panel.visible and nodes[panel.place] not in seen:
                seen.add(nodes[panel.place])
                self._focus.append(panel.title)

    def _arrange_controls(self, column: int, height: float) -> dict[str, int]:
        """The parts of the column of controls, by place."""

        def above(node: int, share: float) -> tuple[int, int]:
            split = internal.dock_builder_split_node(node, imgui.Dir.up, share)
            return split.id_at_dir, split.id_at_opposite_dir

        if height < em(THREE_PARTS_EM):
            sample, rest = above(column, SAMPLE_SHARE)
            return {SAMPLE: sample, GLOSS: rest, LIGHT: rest}
        sample, rest = above(column, THREE_SHARES[0])
        gloss, light = above(rest, THREE_SHARES[1] / (1.0 - THREE_SHARES[0]))
        return {SAMPLE: sample, GLOSS: gloss, LIGHT: light}

    def _show_panel(self, panel: Panel) -> None:
        flags = imgui.WindowFlags_.no_collapse
        if panel.title in self._focus or panel.title == self._entering:
            imgui.set_next_window_focus()
        else:  # of panels that share a place, the last to appear would be the one in front
            flags |= imgui.WindowFlags_.no_focus_on_appearing
        if panel.title in self._focus:
            self._focus = [title for title in self._focus if title != panel.title]
        imgui.set_next_window_size(ImVec2(em(26.0), em(20.0)), imgui.Cond_.first_use_ever)
        # One that a kept layout does not know yet goes beside its neighbours.
        beside = next((p.dock_id for p in self.panels if p.place == panel.place and p.dock_id), 0)
        if beside:
            imgui.set_next_window_dock_id(beside, imgui.Cond_.first_use_ever)
        if panel.docked:  # the window's own colour is the panels'
            flags |= imgui.WindowFlags_.no_background
        opened, stays = imgui.begin(panel.title, True, flags)
        panel.docked, panel.in_front = imgui.is_window_docked(), bool(opened)
        panel.dock_id = int(imgui.get_window_dock_id())
        if panel.docked:
            _hold_size(LEAST_EM[panel.place])
        if opened:
            self._enter(panel.title)
            panel.show()
        imgui.end()
        panel.visible = bool(stays)

    def _show_stage(self, stage: Callable[[], None], place: ImVec2, size: ImVec2) -> None:
        imgui.set_next_window_pos(place)
        imgui.set_next_window_size(size)
        for variable in (imgui.StyleVar_.window_padding, imgui.StyleVar_.window_min_size):
            imgui.push_style_var(variable, ImVec2(0.0, 0.0))
        if self._entering == STAGE:
            imgui.set_next_window_focus()
        imgui.begin(STAGE, None, _STAGE_FLAGS)
        imgui.pop_style_var(2)
        self._enter(STAGE)
        stage()
        imgui.end()


def _roomless(size: ImVec2) -> set[str]:
    """The places whose panels and the pictures don't both fit into a window of so many pixels."""
    lost = set()
    wide, tall = LEAST_EM[SAMPLE]
    if size.x < em(wide + PICTURES_EM[0]) or size.y < em(2.0 * tall):
        lost |= {*CONTROLS}
    if size.y < em(LEAST_EM[BELOW][1] + PICTURES_EM[1]) or size.x < em(LEAST_EM[BELOW][0]):
        lost |= {BELOW, BELOW_RIGHT}
    return lost


def _hold_size(least_em: tuple[float, float]) -> None:
    """Widen the present window's place in the dock space to its least size."""
    node = internal.dock_builder_get_node(imgui.get_window_dock_id())
    if node is None or node.is_root_node() or imgui.is_mouse_down(imgui.MouseButton_.left):
        return  # a hand that drags the edge is held when it lets go
    if node.size.x < 1.0 or node.size.y < 1.0:
        return  # read from a saved layout, and not laid out yet
    least = ImVec2(em(least_em[0]), em(least_em[1]))
    if node.size.x < least.x - 1.0 or node.size.y < least.y - 1.0:
        size = ImVec2(max(node.size.x, least.x), max(node.size.y, least.y))
        internal.dock_builder_set_node_size(node.id_, size)


def _share(wanted: float, whole: float, most: float) -> float:
    return min(max(wanted / max(whole, 1.0), LEAST_SHARE), most)
