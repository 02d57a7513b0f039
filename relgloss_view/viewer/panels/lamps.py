"""The lamps beside the main one: at most three, each behind a fold."""

from __future__ import annotations

import dataclasses

from imgui_bundle import imgui

from relgloss_view.picture.scene.setup import MOST_FURTHER_LAMPS, FurtherLamp
from relgloss_view.viewer.shell import widgets
from relgloss_view.viewer.shell.widgets import Reach
from relgloss_view.viewer.state.model import Model

_ANGLE = Reach(digits="%.1f")
RADIUS = Reach(0.0, 0.5, digits="%.3f")
SLIDERS = {
    "azimuth_deg": _ANGLE,
    "elevation_deg": _ANGLE,
    "distance_m": Reach(0.1, 10.0, logarithmic=True),
    "radius_m": RADIUS,
    "share": Reach(0.0, 4.0, digits="%.2f"),
}
#: Azimuths that further lamps begin with: from the other side, from behind on either side.
BEGINNINGS_DEG = (-50.0, 140.0, -140.0)
Lamps = tuple[FurtherLamp, ...]


def show(model: Model) -> None:
    """Each further lamp, and a button for one more."""
    lamps = model.state.setup.further_lamps
    for number, lamp in enumerate(lamps):
        imgui.push_id(f"further lamp {number}")
        if imgui.tree_node_ex(f"Lamp {number + 2}", imgui.TreeNodeFlags_.framed):
            _lamp(model, lamps, number, lamp)
            imgui.tree_pop()
        imgui.pop_id()
    if widgets.button(
        "Add lamp",
        "adds a lamp of the same spectrum; the light on the perfect diffuser stays as much",
        enabled=len(lamps) < MOST_FURTHER_LAMPS,
    ):
        added = FurtherLamp(azimuth_deg=BEGINNINGS_DEG[len(lamps)])
        _set(model, (*lamps, added))


def _lamp(model: Model, lamps: Lamps, number: int, lamp: FurtherLamp) -> None:
    for name, reach in SLIDERS.items():
        changed, value = widgets.slider(FurtherLamp, name, getattr(lamp, name), reach)
        if changed:
            moved = dataclasses.replace(lamp, **{name: value})
            _set(model, (*lamps[:number], moved, *lamps[number + 1 :]), f"lamp {number} {name}")
    if widgets.button("Remove lamp", "takes this lamp away"):
        _set(model, (*lamps[:number], *lamps[number + 1 :]))


def _set(model: Model, lamps: Lamps, gesture: str | None = None) -> None:
    setup = dataclasses.replace(model.state.setup, further_lamps=lamps)
    model.change(dataclasses.replace(model.state, setup=setup), gesture)
