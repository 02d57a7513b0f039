"""Fields for a colour: L, a, b as a spectrophotometer reads it, and an sRGB picker."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from imgui_bundle import imgui

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.material.cielab import lab_to_srgb, srgb_to_lab
from relgloss_view.material.material import Material
from relgloss_view.material.recolour import Colour, colour_of
from relgloss_view.material.reflectance import CHROMA_MAX, LAB_LIGHTEST
from relgloss_view.viewer.panels.plot_widgets import Kept
from relgloss_view.viewer.shell import widgets
from relgloss_view.viewer.shell.theme import em
from relgloss_view.viewer.state import matching
from relgloss_view.viewer.state.model import Model

Lab = tuple[float, float, float]
SPEED = 0.25  #: units of Lab a pixel of the hand's way
PICKER = "sRGB"
LAB_MEANING = (
    "Colour of the sample under D50 for the 2 degree observer, lamp at 45 degrees and receiver "
    "along the normal, the highlight's own light included. Drag, or double-click to type."
)
PICKER_MEANING = (
    "The same colour as sRGB, which is under D65: Bradford's transform adapts it to D50."
)


@dataclass
class _Memory:
    """The own colour of the material last shown, and the colour that was refused."""

    material: Material | None = None
    lab: Lab = (0.0, 0.0, 0.0)
    wanted: Lab | None = None  #: that the material can't have
    fault: str = ""


_memory: Kept[dict[str, _Memory]] = Kept(dict)


def fields(lab: Lab, name: str = "Colour") -> Lab | None:
    """A triple for L, a, b and a picker of the same colour; the new one where a hand changed it.

    For any panel: `name` tells the fields of one window apart.
    """
    widgets.label(f"{name} (L, a, b)")
    changed, values = imgui.drag_float3(f"##{name}", list(lab), SPEED, 0.0, 0.0, "%.1f")
    widgets.tooltip(LAB_MEANING)
    if changed:
        return bounded(values)
    widgets.label(f"{name} ({PICKER})")
    srgb = np.clip(lab_to_srgb(lab), 0.0, 1.0)
    flags = imgui.ColorEditFlags_
    plain = int(flags.uint8 | flags.picker_hue_bar | flags.no_color_markers)
    changed, values = imgui.color_edit3(f"##{name} {PICKER}", srgb.tolist(), plain)
    widgets.tooltip(PICKER_MEANING)
    return bounded(srgb_to_lab(values).tolist()) if changed else None


def bounded(values: list[float]) -> Lab:
    """Three numbers as a Lab within the range that Lab has."""
    lightness, a, b = (float(value) for value in values)
    return (
        min(max(lightness, 0.0), LAB_LIGHTEST),
        min(max(a, -CHROMA_MAX), CHROMA_MAX),
        min(max(b, -CHROMA_MAX), CHROMA_MAX),
    )


def show(model: Model, side: str) -> None:
    """The colour of a side's sample, which these fields change, and a button for its own."""
    sample = model.state.side(side).sample
    memory = _memory.of(model).setdefault(side, _Memory())
    if memory.material is not sample.material:
        own = colour_of(sample.material).tolist()
        of_d50 = sample.colour is not None and sample.colour == Colour(sample.colour.lab)
        lab = sample.colour.lab if of_d50 and sample.colour is not None else bounded(own)
        _memory.of(model)[side] = memory = _Memory(sample.material, lab)
    wanted = fields(memory.wanted or memory.lab)
    if wanted is not None:
        _take(model, side, memory, wanted)
    if memory.fault:
        widgets.wrapped(f"! {memory.fault}")
    if sample.colour is None:
        return
    if widgets.button("Original colour", "brings back the sample's own colour", width=em(9.0)):
        model.attempt(lambda: model.change(matching.with_colour(model.state, side, None)))


def _take(model: Model, side: str, memory: _Memory, lab: Lab) -> None:
    """Give a side's sample a colour; the panel shows why where it can't have it."""
    try:
        state = matching.with_colour(model.state, side, Colour(lab))
    except InputError as error:
        memory.wanted, memory.fault = lab, printable(error, 300)
        return
    memory.wanted, memory.fault = None, ""
    model.change(state, gesture=f"{side} colour")
