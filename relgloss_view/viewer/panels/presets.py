"""Presets of a look: the paper's published optima, and the user's own."""

from __future__ import annotations

from imgui_bundle import imgui

from relgloss_view.errors import InputError
from relgloss_view.viewer import presets, widgets
from relgloss_view.viewer.model import Model
from relgloss_view.viewer.presets import Presets


class _Panel:
    """What the panel remembers between frames."""

    def __init__(self) -> None:
        self.own: Presets | None = None  #: None until they are first shown
        self.fault = ""
        self.name = ""
        self.editing: str | None = None  #: the preset being renamed; empty: a new one
        self.removing: str | None = None


_panel = _Panel()


def show(model: Model) -> None:
    """The presets of the active side's look: click one to apply it."""
    if _panel.own is None:
        _load()
    for preset in presets.built_in():
        look = preset.look
        fraction = look.c_fraction if look.c_fraction is not None else 1.0
        told = f"Published optimum: σN {look.sigma_n_deg:g} deg, c {round(6 * fraction)}/6 of c_max"
        if imgui.selectable(f"{preset.name}##built-in", False)[0]:
            model.set_look(
                model.active_side,
                sigma_n_deg=look.sigma_n_deg,
                c=None,
                c_fraction=look.c_fraction,
            )
        widgets.tooltip(told)


def _load() -> None:
    _panel.own = ()
    try:
        _panel.own = presets.load(presets.presets_file())
    except InputError as error:
        _panel.fault = str(error)
