"""The finishes of a pack as a list, the uppermost first, and the entries of the active one."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from imgui_bundle import imgui

from relgloss_view.base.reading import printable
from relgloss_view.pack.finish import KINDS, MAX_FINISHES, Finish
from relgloss_view.pack.pack import Pack
from relgloss_view.viewer.drawing.mask_tints import TINTS
from relgloss_view.viewer.files import pack_materials
from relgloss_view.viewer.panels.list_rows import preview, row
from relgloss_view.viewer.shell import widgets
from relgloss_view.viewer.shell.widgets import Reach
from relgloss_view.viewer.state import matching, packs
from relgloss_view.viewer.state.model import Model

if TYPE_CHECKING:
    from relgloss_view.viewer.shell.file_actions import FileActions

LONGEST = 60  #: characters of a name
SIGMA_REACH = Reach(high=3.0, digits="%.2f")
K_REACH = Reach(high=3.0, digits="%.3f")
FILE = "File..."
KIND_MEANING = (
    "What it replaces of the surface below.\nInk: the artwork's colours under its gloss. Varnish: "
    "its gloss above the colours. Foil: gloss and colour of its own. Stock: the material itself."
)


def show(model: Model, side: str, pack: Pack, files: FileActions) -> None:
    """The list, its buttons, and the active finish."""
    active = packs.active(pack, model.finish_names.get(side, ""))
    for one in reversed(pack.finishes):
        _row(model, side, pack, one, on=one.name == active.name)
    _buttons(model, side, pack, active)
    imgui.spacing()
    imgui.push_id(f"{side} finish")
    _entries(model, side, pack, active, files)
    imgui.pop_id()
    missing = packs.missing_plates(pack)
    if missing:
        names = ", ".join(printable(name, 40) for name in missing)
        widgets.wrapped(f"! The artwork has no plate {names}: choose another mask.")


def sigma_n_slider(model: Model, side: str, finish: Finish) -> None:
    """Graininess of a finish; one that has none of its own follows the picture's."""
    look = model.state.side(side).look
    present = look.sigma_n_deg if finish.sigma_n_deg is None else finish.sigma_n_deg
    changed, value = widgets.slider(
        Finish, "sigma_n_deg", present, SIGMA_REACH, default=look.sigma_n_deg
    )
    if changed:
        model.set_finish(side, finish.name, f"{side} finish sigma_n", sigma_n_deg=value)


def k_slider(model: Model, side: str, finish: Finish) -> None:
    """The factor of a finish's gloss beside the others; a match keeps what a hand has chosen."""
    changed, value = widgets.slider(Finish, "k", finish.k, K_REACH)
    if changed:
        model.set_finish(side, finish.name, f"{side} finish k", k=value, keeps_k=True)


def tint(pack: Pack, name: str) -> tuple[float, float, float]:
    """The colour that marks a finish in the list and over the picture, sRGB, 0 to 1."""
    place = next(k for k, one in enumerate(pack.finishes) if one.name == name)
    return TINTS[place % len(TINTS)]


def _row(model: Model, side: str, pack: Pack, one: Finish, *, on: bool) -> None:
    """A finish of the list: whether its mask shows, its name, its kind."""
    imgui.push_id(one.name)
    shown = one.name in model.masked
    red, green, blue = tint(pack, one.name)
    imgui.push_style_color(imgui.Col_.check_mark, imgui.ImVec4(red, green, blue, 1.0))
    if widgets.checkbox("##mask", shown, "shows where this finish lies, as a tint on the picture"):
        model.masked = model.masked ^ {one.name}
    imgui.pop_style_color()
    imgui.same_line()
    kind = "base, " + one.kind if one is pack.base else one.kind
    if row("choose", printable(one.name, LONGEST), on, beside=kind):
        model.choose_finish(side, one.name)
    widgets.tooltip(
        f"{printable(one.name, LONGEST)}: {one.kind}, {packs.mask_words(one.mask)}"
        f"{', inverted' if one.invert else ''}. A click on the picture chooses it too.",
        beside=True,
    )
    imgui.pop_id()


def _buttons(model: Model, side: str, pack: Pack, active: Finish) -> None:
    """Add, remove, up, down: what they change is one step of undo."""
    gap = imgui.get_style().item_spacing.x
    width = (imgui.get_content_region_avail().x - 3.0 * gap) / 4.0
    is_base, is_top = active is pack.base, active is pack.finishes[-1]

    def change(made: Callable[[], Pack]) -> None:
        model.attempt(lambda: model.set_pack(side, made()))

    if widgets.button("Add", "adds a gloss varnish above the others", width=width,
                      enabled=len(pack.finishes) < MAX_FINISHES):  # fmt: skip
        model.attempt(lambda: _add(model, side, pack))
    imgui.same_line()
    if widgets.button("Remove", "removes this finish; the base stays", width=width,
                      enabled=not is_base):  # fmt: skip
        change(lambda: packs.removed(pack, active.name))
    imgui.same_line()
    if widgets.button("Up", "puts this finish above the next one", width=width,
                      enabled=not (is_base or is_top)):  # fmt: skip
        change(lambda: packs.moved(pack, active.name, 1))
    imgui.same_line()
    is_lowest = len(pack.finishes) > 1 and active is pack.finishes[1]
    if widgets.button("Down", "puts this finish below the last one", width=width,
                      enabled=not (is_base or is_lowest)):  # fmt: skip
        change(lambda: packs.moved(pack, active.name, -1))


def _add(model: Model, side: str, pack: Pack) -> None:
    source = pack_materials.NEW
    finish = packs.new_finish(pack, pack_materials.material(source), source)
    model.set_pack(side, packs.added(pack, finish))
    model.choose_finish(side, finish.name)


def _entries(model: Model, side: str, pack: Pack, one: Finish, files: FileActions) -> None:
    _name(model, side, pack, one)
    _kind(model, side, pack, one)
    _material(model, side, one, files)
    if one is not pack.base:
        _mask(model, side, pack, one, files)
    sigma_n_slider(model, side, one)
    k_slider(model, side, one)
    _match(model, side, one)


def _name(model: Model, side: str, pack: Pack, one: Finish) -> None:
    widgets.label("Name")
    flags = imgui.InputTextFlags_.enter_returns_true | imgui.InputTextFlags_.auto_select_all
    entered, text = imgui.input_text("##Name", one.name, flags)
    if (entered or imgui.is_item_deactivated_after_edit()) and text != one.name:

        def rename() -> None:
            model.set_pack(side, packs.renamed(pack, one.name, text))
            model.choose_finish(side, text.strip())

        model.attempt(rename)


def _kind(model: Model, side: str, pack: Pack, one: Finish) -> None:
    kinds = tuple(kind for kind in KINDS if not (one is pack.base and kind == "varnish"))
    text = widgets.label_of(Finish, "kind")
    changed, kind = widgets.combo(text, kinds, one.kind, KIND_MEANING)
    if changed:
        model.set_finish(side, one.name, kind=kind)


def _material(model: Model, side: str, one: Finish, files: FileActions) -> None:
    """Built-in finishes and papers, which are synthetic, and files."""
    widgets.label("Material")
    name = one.source if one.source in pack_materials.names() else one.material.name
    if imgui.begin_combo("##Material", preview(printable(name, LONGEST))):
        for choice in pack_materials.names():
            if imgui.selectable(choice, choice == one.source)[0]:
                model.attempt(lambda choice=choice: _take(model, side, one, choice))  # type: ignore[misc]
        imgui.separator()
        if imgui.selectable(FILE, False)[0]:
            files.ask_finish_material(side, one.name)
        imgui.end_combo()
    else:
        widgets.tooltip("The surface: built-in finishes and papers are synthetic. A measured file "
                        "can take their place.")  # fmt: skip
    if one.material.synthetic:
        widgets.label("")
        widgets.quiet("synthetic")
        widgets.tooltip("Computed for this program, and not measured on a print.")


def _take(model: Model, side: str, one: Finish, source: str) -> None:
    entries = {"material": pack_materials.material(source), "source": source}
    state = packs.with_finish(model.state, side, one.name, **entries)
    model.change(matching.rematched_pack(state) if side == "test" else state)


def _mask(model: Model, side: str, pack: Pack, one: Finish, files: FileActions) -> None:
    choices = packs.mask_choices(pack, pack_materials.parts(pack.shape))
    choices = choices if one.mask in choices else (*choices, one.mask)
    words = {mask: printable(_mask_name(mask), LONGEST) for mask in choices}
    meaning = "Where the finish lies: plates and channels of the artwork, parts of the form, files."
    changed, mask = widgets.combo("Mask", (*choices, FILE), one.mask, meaning, words=words)
    if changed and mask == FILE:
        files.ask_mask(side, one.name)
    elif changed:
        invert = one.invert and not mask.startswith("part:")
        model.set_finish(side, one.name, mask=mask, invert=invert)
    if one.mask.startswith("part:"):
        return
    widgets.label("")
    if widgets.checkbox("Invert", one.invert, "the finish lies where its mask is not"):
        model.set_finish(side, one.name, invert=not one.invert)


def _mask_name(mask: str) -> str:
    words = packs.mask_words(mask)
    return words if words != mask else Path(mask).name


def _match(model: Model, side: str, one: Finish) -> None:
    if side != "test":
        return
    text, meaning = "Keep k in a match", "a match leaves this finish's k as it is"
    if widgets.checkbox(text, one.keeps_k, meaning):
        model.set_finish(side, one.name, keeps_k=not one.keeps_k)
    if widgets.button(
        "Match", "gives every finish the gloss that keeps its ratio to the reference"
    ):
        model.attempt(lambda: model.change(matching.rematched(model.state)))
