"""Presets of a look: the paper's published optima, and the user's own, kept in a file."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from imgui_bundle import imgui

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.gloss.match import absolute_c
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.setting import share_words
from relgloss_view.viewer.panels.list_rows import fitting, row, small_width
from relgloss_view.viewer.shell import widgets
from relgloss_view.viewer.shell.theme import em
from relgloss_view.viewer.state import presets
from relgloss_view.viewer.state.model import Model
from relgloss_view.viewer.state.presets import Preset, Presets

NEW = ""  #: in place of a new preset's name; no preset is called so


@dataclass
class Memory:
    """The panel's memory between frames."""

    own: Presets | None = None  #: None until the panel is first drawn
    fault: str = ""
    naming: str | None = None  #: the preset that gets a name, or NEW
    name: str = ""
    removing: str | None = None  #: the preset that may be deleted
    focus: bool = False  #: whether the field takes the keyboard


memory = Memory()


def show(model: Model) -> None:
    """The presets of the active side's look: click one to apply it."""
    if memory.own is None:
        _attempt(lambda: presets.load(presets.presets_file()))
    for preset in presets.built_in():
        _built_in(model, preset)
    for preset in memory.own or ():
        _own(model, preset)
    if memory.naming == NEW:
        _name_field(lambda name: _add(model, name), "Save")
    elif widgets.button(
        "Save as preset...", "keeps the whole look of the active side under a name"
    ):
        _name(NEW)
    if memory.fault:
        widgets.wrapped(f"! {memory.fault}")


def _built_in(model: Model, preset: Preset) -> None:
    published = preset.look
    look = model.state.side(model.active_side).look
    c = absolute_c(published, model.sample(model.active_side).material)
    active = look.sigma_n_deg == published.sigma_n_deg and look.c == c
    if row(preset.name, preset.name, active, beside=_short_words(published)):
        model.set_setting(model.active_side, published.setting)
    widgets.tooltip(
        "The setting that the observers of the published study chose for this kind of paper: "
        f"{_words(published)} at the paper's geometry. The sample and the rest of the look stay.",
        beside=True,
    )


def _own(model: Model, preset: Preset) -> None:
    imgui.push_id(preset.name)
    if memory.naming == preset.name:
        _name_field(lambda name: _rename(preset.name, name), "Rename")
    elif memory.removing == preset.name:
        _confirm(preset.name)
    else:
        on = model.state.side(model.active_side).look == preset.look
        space = imgui.get_style().item_spacing.x
        right = small_width("Rename") + small_width("Delete") + space
        width = max(imgui.get_content_region_avail().x - right - space, em(3.0))
        if row("apply", preset.name, on, width=width):
            model.set_whole_look(model.active_side, preset.look)
        look = preset.look
        cells = {
            "screen": f"{look.grain_px:g} px",
            "surface": f"{look.grain_mm:g} mm",
            "eye": f"{look.grain_arcmin:g} arcmin",
        }
        grain = f"grain fixed to the {look.grain}, {cells[look.grain]}, seed {look.seed}"
        widgets.tooltip(f"{preset.name}: {_words(look)}; {grain}.", beside=True)
        imgui.same_line()
        if widgets.small_button("Rename", "gives the preset another name"):
            _name(preset.name)
        imgui.same_line()
        if widgets.small_button("Delete", "removes the preset; asks first"):
            memory.removing, memory.naming = preset.name, None
    imgui.pop_id()


def _name(naming: str) -> None:
    """Ask for a name and suggest the present one."""
    memory.naming, memory.name, memory.removing = naming, naming, None
    memory.fault, memory.focus = "", True


def _name_field(done: Callable[[str], None], word: str) -> None:
    if memory.focus:
        imgui.set_keyboard_focus_here()
        memory.focus = False
    space = imgui.get_style().item_spacing.x
    imgui.set_next_item_width(-small_width(word) - small_width("Cancel") - 2.0 * space)
    flags = imgui.InputTextFlags_.enter_returns_true | imgui.InputTextFlags_.auto_select_all
    entered, memory.name = imgui.input_text_with_hint("##name", "name", memory.name, flags)
    left = imgui.is_item_deactivated() and imgui.is_key_pressed(imgui.Key.escape)
    imgui.same_line()
    pressed = widgets.small_button(word, "keeps the preset under this name")
    imgui.same_line()
    if widgets.small_button("Cancel", "changes nothing") or left:
        memory.naming, memory.fault = None, ""
    elif pressed or entered:
        done(memory.name)


def _confirm(name: str) -> None:
    space = imgui.get_style().item_spacing.x
    right = small_width("Delete") + small_width("Keep") + 2.0 * space
    width = max(imgui.get_content_region_avail().x - right, em(3.0))
    start = imgui.get_cursor_pos_x()
    imgui.text_unformatted(fitting(f"Delete {name}?", width))
    imgui.same_line(start + width + space)
    if widgets.small_button("Delete", "removes the preset for good"):
        _attempt(lambda: _changed(lambda present: presets.remove(present, name)))
        memory.removing = None
    imgui.same_line()
    if widgets.small_button("Keep", "keeps the preset"):
        memory.removing = None


def _add(model: Model, name: str) -> None:
    look = model.state.side(model.active_side).look
    if _attempt(lambda: _changed(lambda present: presets.add(present, name, look))):
        memory.naming = None


def _rename(old: str, new: str) -> None:
    if _attempt(lambda: _changed(lambda present: presets.rename(present, old, new))):
        memory.naming = None


def _changed(change: Callable[[Presets], Presets]) -> Presets:
    """Load, change and save in one go: another window may have saved meanwhile."""
    file = presets.presets_file()
    changed = change(presets.load(file))
    presets.save(file, changed)
    return changed


def _attempt(action: Callable[[], Presets]) -> bool:
    """Take the presets that the action returns; a fault shows below the list, which stays."""
    try:
        memory.own, memory.fault = action(), ""
    except InputError as error:
        memory.own, memory.fault = memory.own or (), printable(str(error), 400)
        return False
    return True


def _short_words(look: Look) -> str:
    """The setting beside a preset's name."""
    return f"graininess {look.sigma_n_deg:.3g}°, gloss {_contrast_gloss(look)}"


def _words(look: Look) -> str:
    """The setting with its symbols."""
    symbol = "c" if look.c is not None else "c / c_max"
    return (
        f"graininess (sigma_N) {look.sigma_n_deg:.3g}°, "
        f"contrast gloss ({symbol}) {_contrast_gloss(look)}"
    )


def _contrast_gloss(look: Look) -> str:
    return f"{look.c:.3g}" if look.c is not None else share_words(look.setting.c_fraction)
