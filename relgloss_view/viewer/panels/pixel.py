"""The pixel under the mouse, or the pinned one: its numbers on both sides, and its neighbours."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from imgui_bundle import ImVec2, imgui

from relgloss_view.base.errors import RelglossError
from relgloss_view.viewer.drawing.picking import Picked
from relgloss_view.viewer.panels import pixel_of_pack, plot_widgets
from relgloss_view.viewer.plots.caches import PerFrame
from relgloss_view.viewer.plots.readout import Patch, Readout, Stages
from relgloss_view.viewer.shell import widgets
from relgloss_view.viewer.shell.theme import em, gray
from relgloss_view.viewer.state.model import Model, Pixel
from relgloss_view.viewer.state.state import SIDES

RADIUS = 4  #: neighbours to each side
NARROW_EM = 46.0  #: below this width the pixels lie under the numbers
NUMBER_EM = 4.2  #: room for a number, at most
NUMBER_GAP_EM = 0.4  #: between numbers side by side
NUMBER_LEAST_EM = 2.8  #: with less, numbers are below one another
NAMES_SHARE = 0.4  #: of the table's width, for the names of quantities
LEAST_TABLE_EM = 29.0
TABLE_EM = 44.0  #: a wider table would tear its columns apart
CELL_FONT = 0.8  #: of the ordinary size
TEXT_FITS_EM = 1.45  #: a cell this wide holds a number
LIGHT_LSTAR = 55.0  #: cells lighter than this carry dark text


#: Rows that are fetched at once, so that a pointer that moves a little needs no others.
ROWS = 64


@dataclass
class _Memory:
    stages: dict[str, PerFrame[Stages]] = field(default_factory=dict)
    picks: pixel_of_pack.Picks = field(default_factory=pixel_of_pack.Picks)
    rows: range = range(0)  #: of the pictures, those that are fetched
    last: Pixel | None = None  #: the last one under the mouse

    read: Pixel | None = None  #: the last one whose numbers were shown

    def within_reach(self, place: Pixel, *, dragging: bool) -> Pixel:
        """The pixel whose numbers can be shown: during a drag no other rows are fetched."""
        row = place.row
        held = self.rows.start <= max(row - RADIUS, 0) and row + RADIUS < self.rows.stop
        if self.read is None or not (held or dragging):
            rows = self.rows = range(max(row - ROWS // 2, 0), row + ROWS // 2)
            self.stages = {name: PerFrame(lambda frame: Stages.of(frame, rows)) for name in SIDES}
            held = True
        self.read = place if held or self.read is None else self.read
        return self.read


@dataclass(frozen=True)
class _Quantity:
    name: str
    meaning: str
    texts: Callable[[Readout], list[str]]


def _number(value: float) -> str:
    """Four digits; what is too dark to be seen is 0."""
    return f"{value:.4g}" if abs(value) >= 5e-5 else "0"


def _degrees(value: float | None) -> str:
    return "-" if value is None else f"{value:.2f}"


def _state(pixel: Readout) -> list[str]:
    words = [
        word
        for word, holds in (("clipped", pixel.clipped), ("out of gamut", pixel.out_of_gamut))
        if holds
    ]
    return [", ".join(words) or "unchanged"]


QUANTITIES = (
    _Quantity(
        "Luminance (cd/m2)",
        "Diffuse and specular luminance; the perfect diffuser has Y_n.",
        lambda p: [_number(p.diffuse_cd_m2), _number(p.specular_cd_m2)],
    ),
    _Quantity(
        "Colour (X, Y, Z)",
        "Both reflections together, relative to Y_n: Y is 1 for the perfect diffuser.",
        lambda p: [_number(v) for v in p.xyz],
    ),
    _Quantity(
        "Lightness (L_d*, L_s*)",
        "Lightness of the diffuse reflection, and the increase by the specular one before scaling.",
        lambda p: [f"{p.l_d:.2f}", f"{p.l_s:.2f}"],
    ),
    _Quantity(
        "Scaled (L*, a*, b*)",
        "The colour that the display should show: L* = L_d* + c L_s*, before it is clipped at 100 "
        "and mapped into the gamut.",
        lambda p: [f"{v:.2f}" for v in p.lab],
    ),
    _Quantity(
        "Half-vector (deg)",
        "Angle between the half-vector of lamp and eye and the normal: first the smooth surface's, "
        "then the one that the grain has tilted.",
        lambda p: [_degrees(p.half_deg), _degrees(p.half_tilted_deg)],
    ),
    _Quantity(
        "Displayed",
        "Clipped: L* is above 100. Out of gamut: the chroma is reduced. Unchanged: neither.",
        _state,
    ),
)

_memory = plot_widgets.Kept(_Memory)


def show(model: Model) -> None:
    """Draw the panel into the present window."""
    imgui.push_id("pixel")
    try:
        _show(model)
    except RelglossError as error:  # a lamp's file may have gone since the picture was drawn
        widgets.wrapped(str(error), dim=True)
    finally:
        imgui.pop_id()


def _inside(place: Pixel, size: tuple[int, int]) -> bool:
    return place.column < size[0] and place.row < size[1]


def _show(model: Model) -> None:
    memory = _memory.of(model)
    if model.pointer is not None:
        memory.last = model.pointer
    if memory.last is not None and not _inside(memory.last, model.picture_size):
        memory.last = None  # the pictures have another size since
    place = model.pinned or memory.last
    if place is not None:
        place = memory.within_reach(place, dragging=model.dragging)
    _controls(model, place)
    if place is None or not model.frames:
        return
    _, column, row = place
    stages = {
        name: kept.get(model.frames.get(name), dragging=model.dragging)
        for name, kept in memory.stages.items()
    }
    plot_widgets.note_if_waiting(all(current for _, current in stages.values()))
    plot_widgets.note_split(model)
    pixels = {name: None if s is None else s.read(column, row) for name, (s, _) in stages.items()}
    picked = {
        name: memory.picks.of(name, model.frames.get(name), column, row, dragging=model.dragging)
        for name in SIDES
    }
    patches = {name: s.patch(column, row, RADIUS) for name, (s, _) in stages.items() if s}
    room = imgui.get_content_region_avail()
    if room.x < em(NARROW_EM):
        _table(pixels, picked, room.x)
        height = imgui.get_content_region_avail().y
        _patches(patches, min(0.5 * (room.x - em(1)), max(height - em(1.4), em(6))))
        return
    side = min(room.y - em(1.4), 0.5 * (room.x - em(LEAST_TABLE_EM + 2.2)))
    width = min(room.x - 2.0 * side - em(2.2), em(TABLE_EM))
    imgui.begin_group()
    _table(pixels, picked, width)
    imgui.end_group()
    imgui.same_line(0.0, em(1.1))
    _patches(patches, side)


def _controls(model: Model, place: Pixel | None) -> None:
    pinned = model.pinned is not None
    if widgets.button(
        "Release" if pinned else "Pin",
        "lets the numbers follow the mouse again"
        if pinned
        else "holds this pixel while the mouse goes elsewhere, as Alt+click on a picture does",
        width=plot_widgets.button_width("Release"),
        enabled=place is not None,
    ):
        model.pinned = None if pinned else place
    imgui.same_line(0.0, em(1.1))
    imgui.align_text_to_frame_padding()
    if place is None:
        widgets.wrapped("Point at a picture. Alt+click pins a pixel.", dim=True)
        return
    side, column, row = place
    imgui.text_unformatted(f"Column {column}, row {row}")
    widgets.tooltip(f"Pixels from the left and from the top, in the {side} picture.")


def _table(
    pixels: dict[str, Readout | None], picked: dict[str, Picked | None], width: float
) -> None:
    flags = imgui.TableFlags_.row_bg | imgui.TableFlags_.no_host_extend_x
    if not imgui.begin_table("pixel", 3, flags, ImVec2(width, 0.0)):
        return
    names = max(imgui.calc_text_size(row.name).x for row in QUANTITIES)
    names = min(names, NAMES_SHARE * width)
    imgui.table_setup_column("Pixel", imgui.TableColumnFlags_.width_fixed, names)
    for name in SIDES:
        imgui.table_setup_column(name.capitalize(), imgui.TableColumnFlags_.width_stretch)
    plot_widgets.table_headings()
    if any(one is not None for one in picked.values()):
        _pack_rows(picked)
    for k, row in enumerate(QUANTITIES):
        imgui.table_next_row()
        imgui.table_next_column()
        widgets.wrapped(row.name, dim=True)
        widgets.tooltip(row.meaning)
        for name in SIDES:
            imgui.table_next_column()
            pixel = pixels[name]
            if pixel is not None and pixel.on_object:
                _in_columns(row.texts(pixel))
            elif k == 0:
                widgets.quiet("no such pixel" if pixel is None else "off the object")
            else:
                widgets.quiet("-")
    imgui.table_next_row()
    imgui.table_next_column()
    widgets.wrapped("Digital (R, G, B)", dim=True)
    widgets.tooltip("Digital values sent to the display, 8 bits.")
    for name in SIDES:
        imgui.table_next_column()
        pixel = pixels[name]
        _in_columns(["-"] if pixel is None else [str(v) for v in pixel.display_rgb])
    imgui.end_table()


def _pack_rows(picked: dict[str, Picked | None]) -> None:
    """What a side that shows a pack has at the pixel, above the numbers of its light."""
    for row in pixel_of_pack.ROWS:
        imgui.table_next_row()
        imgui.table_next_column()
        widgets.wrapped(row.name, dim=True)
        widgets.tooltip(row.meaning)
        for name in SIDES:
            imgui.table_next_column()
            one = picked[name]
            texts = ["-"] if one is None else row.texts(one)
            if len(texts) == 1:
                widgets.wrapped(texts[0])
            else:
                _in_columns(texts)


def _in_columns(texts: list[str]) -> None:
    """Numbers below one another from row to row."""
    start = imgui.get_cursor_pos_x()
    step = min(imgui.get_content_region_avail().x / 3.0, em(NUMBER_EM))
    widest = max(imgui.calc_text_size(text).x for text in texts)
    stacked = step < max(em(NUMBER_LEAST_EM), widest + em(NUMBER_GAP_EM))
    for k, text in enumerate(texts):
        if k and not stacked:
            imgui.same_line()
            imgui.set_cursor_pos_x(start + k * step)
        imgui.text_unformatted(text)


def _patches(patches: dict[str, Patch], side: float) -> None:
    for k, name in enumerate(SIDES):
        if name not in patches:
            continue
        if k:
            imgui.same_line(0.0, em(1.1))
        imgui.begin_group()
        widgets.quiet(name.capitalize())
        _patch(patches[name], side)
        imgui.end_group()
        widgets.tooltip(
            f"The {name} picture's pixels around this one as displayed, with their L* where there "
            "is room."
        )


def _patch(patch: Patch, side: float) -> None:
    count = len(patch.lstar)
    cell = max(np.floor(side / count), 2.0)
    at = imgui.get_cursor_screen_pos()
    draw, font = imgui.get_window_draw_list(), imgui.get_font()
    rgb = patch.rgb.astype(np.int64)
    packed = rgb[..., 0] | rgb[..., 1] << 8 | rgb[..., 2] << 16 | 0xFF << 24
    with_text = cell >= em(TEXT_FITS_EM)
    dark, light = (imgui.get_color_u32(gray(v)) for v in (0.0, 1.0))
    for r, c in np.argwhere(patch.inside):
        low = ImVec2(at.x + c * cell, at.y + r * cell)
        draw.add_rect_filled(low, ImVec2(low.x + cell, low.y + cell), int(packed[r, c]))
        if with_text:
            text = f"{patch.lstar[r, c]:.0f}"
            size = imgui.calc_text_size(text)
            x, y = 0.5 * (cell - CELL_FONT * size.x), 0.5 * (cell - CELL_FONT * size.y)
            ink = dark if patch.lstar[r, c] > LIGHT_LSTAR else light
            draw.add_text(font, CELL_FONT * em(1.0), ImVec2(low.x + x, low.y + y), ink, text)
    middle = count // 2
    low = ImVec2(at.x + middle * cell, at.y + middle * cell)
    ink = dark if patch.lstar[middle, middle] > LIGHT_LSTAR else light
    high = ImVec2(low.x + cell, low.y + cell)
    draw.add_rect(low, high, ink, 0.0, thickness=max(0.1 * em(1.0), 1.0))
    imgui.dummy(ImVec2(count * cell, count * cell))
