"""The sample of a side: which material, how far its fit can be trusted, and ready-made looks."""

from __future__ import annotations

from pathlib import Path

from imgui_bundle import imgui

from relgloss_view.base.reading import printable
from relgloss_view.picture.scene.sample import SAMPLES, Sample
from relgloss_view.viewer.files.desk import FileDesk
from relgloss_view.viewer.panels import presets
from relgloss_view.viewer.panels.look import side_tabs
from relgloss_view.viewer.shell import widgets
from relgloss_view.viewer.state.model import Model

LONGEST = 60  #: characters of a name
LONGEST_WARNING = 240


def show(model: Model, files: FileDesk) -> None:
    """Choose the sample of the active side; its evidence; presets of its look."""
    side_tabs(model)
    _choose(model, files)
    _evidence(model)
    imgui.separator_text("Presets")
    presets.show(model)


def _choose(model: Model, files: FileDesk) -> None:
    sample = model.state.side(model.active_side).sample
    shown = sample.name or printable(sample.material.name, LONGEST)
    widgets.label("sample")
    if imgui.begin_combo("##sample", shown):
        for name in SAMPLES:
            if imgui.selectable(name, name == sample.name)[0]:
                model.attempt(
                    lambda name=name: model.set_sample(  # type: ignore[misc]
                        model.active_side, Sample.built_in(name)
                    )
                )
        imgui.end_combo()
    else:
        widgets.tooltip("The built-in synthetic papers; open a file for any other.")
    if widgets.button("Open file...", "a material or a measurement, which is then fitted"):
        files.open()


def _evidence(model: Model) -> None:
    sample = model.state.side(model.active_side).sample
    material = sample.material
    imgui.separator_text("Fit")
    fit = material.fit
    if fit is None:
        widgets.wrapped("Not fitted: the file gives the reflection as it is.")
    else:
        error = fit.residuals.get("median_relative_error")
        told = f"{fit.quality}; {fit.chosen}"
        if isinstance(error, int | float):
            told += f"; median error {error:.1%}"
        widgets.wrapped(told)
    widgets.wrapped(printable(material.source, 200), dim=True)
    place = sample.table or sample.file
    if place:
        widgets.wrapped(printable(Path(place).name, LONGEST), dim=True)
        widgets.tooltip(printable(place, 400))
    for warning in material.warnings:
        widgets.wrapped(f"! {printable(warning, LONGEST_WARNING)}")
