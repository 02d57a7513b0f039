"""Plates of an artwork that no finish is tied to: each with a small picture and what it may be."""

from __future__ import annotations

from imgui_bundle import ImVec2, imgui

from relgloss_view.base.reading import printable
from relgloss_view.pack.pack import Pack
from relgloss_view.viewer.panels.list_rows import fitting
from relgloss_view.viewer.shell import widgets
from relgloss_view.viewer.shell.theme import em
from relgloss_view.viewer.state import matching, packs
from relgloss_view.viewer.state.model import Model

#: What a plate can become with one click, by built-in finishes.
MEANINGS = {
    "gloss-varnish": "gloss varnish",
    "satin-varnish": "satin varnish",
    "matt-varnish": "matt varnish",
    "soft-touch": "soft-touch",
    "cold-foil-silver": "silver foil",
    "cold-foil-gold": "gold foil",
}
PICTURE_EM = (4.2, 1.5)  #: the most that a small picture is wide and high
LARGE_EM = 16.0  #: under the pointer
LONGEST = 60  #: characters of a name


def show(model: Model, side: str, pack: Pack) -> None:
    """The plates that are not drawn; none where each has a finish or prints as an ink."""
    names = packs.free_plates(pack)
    if not names:
        return
    imgui.separator_text("Plates without a finish")
    widgets.tooltip(
        "Plates of the artwork whose names mean no finish. Choose what each of them is."
    )
    for name in names:
        imgui.push_id(name)
        _plate(model, side, pack, name)
        imgui.pop_id()
    imgui.separator()


def _plate(model: Model, side: str, pack: Pack, name: str) -> None:
    picture = model.plate_pictures.get(name)
    wide, tall = em(PICTURE_EM[0]), em(PICTURE_EM[1])
    left = imgui.get_cursor_pos_x()
    if picture is not None:
        texture, ratio = picture
        size = ImVec2(min(wide, tall * ratio), min(tall, wide / ratio))
        # Row 0 of the texture is the lowest.
        imgui.image(imgui.ImTextureRef(texture), size, ImVec2(0.0, 1.0), ImVec2(1.0, 0.0))
        if imgui.is_item_hovered() and imgui.begin_tooltip():
            imgui.text_unformatted(printable(name, LONGEST))
            large = ImVec2(em(LARGE_EM) * min(1.0, ratio), em(LARGE_EM) / max(1.0, ratio))
            imgui.image(imgui.ImTextureRef(texture), large, ImVec2(0.0, 1.0), ImVec2(1.0, 0.0))
            imgui.end_tooltip()
        imgui.same_line()
    imgui.set_cursor_pos_x(left + wide + em(0.4))
    half = 0.5 * imgui.get_content_region_avail().x
    imgui.align_text_to_frame_padding()
    imgui.text_unformatted(fitting(printable(name, LONGEST), half - em(0.5)))
    imgui.same_line(left + wide + em(0.4) + half)
    imgui.set_next_item_width(-1.0)
    if imgui.begin_combo("##Make it", "make it..."):
        for source, words in MEANINGS.items():
            if imgui.selectable(words, False)[0]:
                model.attempt(lambda source=source: _make(model, side, pack, name, source))  # type: ignore[misc]
        imgui.end_combo()
    else:
        widgets.tooltip("Makes a finish that lies where this plate prints.")


def _make(model: Model, side: str, pack: Pack, plate: str, source: str) -> None:
    made, finish = packs.with_plate(pack, plate, source)
    state = packs.with_pack(model.state, side, made)
    model.change(matching.rematched_pack(state) if side == "test" else state)
    model.choose_finish(side, finish)
    model.report(f"plate {plate} is {MEANINGS[source]} now")
