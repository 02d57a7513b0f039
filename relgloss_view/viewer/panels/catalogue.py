"""The panel "Catalogue": a search over many samples, whose thumbnails become the pair's samples."""

from __future__ import annotations

from typing import TYPE_CHECKING

from imgui_bundle import ImVec2, imgui

from relgloss_view.base.reading import printable
from relgloss_view.viewer.panels import catalogue_grid
from relgloss_view.viewer.panels.list_rows import fitting, preview
from relgloss_view.viewer.shell import sliders, widgets
from relgloss_view.viewer.shell.theme import em
from relgloss_view.viewer.state.catalogues import (
    LEAST_TILE_EM,
    MOST_TILE_EM,
    SORTS,
    TILE_EM,
    OpenCatalogue,
    found_words,
)

if TYPE_CHECKING:
    from relgloss_view.viewer.shell.catalogue_actions import CatalogueActions
    from relgloss_view.viewer.shell.file_actions import FileActions

EMPTY = (
    "A catalogue holds many samples with their readings and pictures. Make one from a folder of "
    "tables with `relgloss catalogue build FOLDER -o CATALOGUE`, then open it or drop its folder "
    "on the window."
)
HINT = "gloss 60 between 40 and 50, nearest to NAME, ..."
SEARCH_HELP = (
    "Conditions on readings, colour, names and quality, joined by and, or, not: "
    '"gloss 60 between 40 and 50 and colour within dE 3 of 50 20 10", '
    '"looks 0.7 x as glossy as cast-coated", "nearest to art-coated", "quality poor". '
    "docs/catalogue.md has all of it."
)
MOST_TEXT = 400  #: characters of a message under the field
SIZE_EM, SORT_EM = 6.5, 12.0  #: widths of the slider and of the list of orders
APART_EM = 40.0  #: a panel as wide has search, order and size in one line


def show(files: FileActions) -> None:
    """Draw the panel into the present window."""
    actions = files.catalogue
    actions.shown()
    opened = actions.opened
    if opened is None:
        widgets.wrapped("Opening the catalogue..." if actions.coming else EMPTY, dim=True)
        if widgets.button("Open catalogue...", "opens the folder of a catalogue, by its table"):
            files.open_catalogue()
        return
    _controls(actions)
    _line(actions, opened)
    catalogue_grid.show(actions)


def _controls(actions: CatalogueActions) -> None:
    room, gap = imgui.get_content_region_avail().x, imgui.get_style().item_spacing.x
    beside = room >= em(APART_EM)
    imgui.set_next_item_width(room - em(SIZE_EM + SORT_EM) - 2.0 * gap if beside else -1.0)
    changed, text = imgui.input_text_with_hint("##Search", HINT, actions.asked.text)
    low, high = imgui.get_item_rect_min(), imgui.get_item_rect_max()
    widgets.tooltip(SEARCH_HELP)
    if changed:
        actions.ask(text=text)
    _mark_fault(actions, low, high)
    if beside:
        imgui.same_line()
        imgui.set_next_item_width(em(SORT_EM))
    else:
        imgui.set_next_item_width(max(room - em(SIZE_EM) - gap, em(4.0)))
    _order(actions)
    imgui.same_line()
    imgui.set_next_item_width(-1.0)
    _, size = sliders.float_slider(
        "##Size", actions.tile_em, LEAST_TILE_EM, MOST_TILE_EM, "size %.1f", 0
    )
    actions.tile_em = TILE_EM if sliders.resetting() else size
    actions.tile_em = min(max(actions.tile_em, LEAST_TILE_EM), MOST_TILE_EM)
    widgets.tooltip("Size of the thumbnails. A double click brings the first size back.")


def _order(actions: CatalogueActions) -> None:
    if imgui.begin_combo("##Order", preview(actions.asked.sort)):
        for name in SORTS:
            if imgui.selectable(name, name == actions.asked.sort)[0]:
                actions.ask(sort=name)
            if name == actions.asked.sort:
                imgui.set_item_default_focus()
        imgui.end_combo()
    else:
        widgets.tooltip('The order of the items; "sort by" in the search itself has precedence.')


def _mark_fault(actions: CatalogueActions, low: ImVec2, high: ImVec2) -> None:
    """Underline the part of the text that nobody understands, where all of the text shows."""
    fault, text = actions.fault, actions.asked.text
    padding = imgui.get_style().frame_padding
    if fault is None or not text or fault.at >= len(text):
        return
    if imgui.calc_text_size(text).x > high.x - low.x - 2.0 * padding.x:
        return  # the field shows some part of it
    start = low.x + padding.x + imgui.calc_text_size(text[: fault.at]).x
    end = low.x + padding.x + imgui.calc_text_size(text[: max(fault.end, fault.at + 1)]).x
    y, colour = high.y - 0.5 * padding.y, imgui.get_color_u32(imgui.Col_.text)
    imgui.get_window_draw_list().add_line(ImVec2(start, y), ImVec2(end, y), colour, em(0.1))


def _line(actions: CatalogueActions, opened: OpenCatalogue) -> None:
    """One line on what shows; above it the fault of a query, or that there is a newer catalogue."""
    if actions.changed:
        widgets.wrapped("! This catalogue was built again since it was read.")
        if widgets.button("Reload", "reads the catalogue again; the search stays"):
            actions.reload()
    if actions.fault is not None:
        fault = actions.fault
        words = printable(f"{fault.fault}; {fault.remedy}", MOST_TEXT)
        widgets.wrapped(f"! {widgets.sentence(words)}")
    words = found_words(actions.found, opened)
    if actions.searching:
        words = f"{words}; {actions.progress or 'searching'} ..."
    elif actions.refining:
        words = f"preliminary order, drawing the nearest anew {actions.progress}: {words}"
    shown = printable(words, MOST_TEXT)
    widgets.quiet(fitting(shown, imgui.get_content_region_avail().x))
    notes = () if actions.found is None else actions.found.notes
    widgets.tooltip("\n".join([words, *(printable(note, MOST_TEXT) for note in notes)]))
