"""The sample of a side: its material, how far the fit can be trusted, and presets of the look."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from imgui_bundle import imgui

from relgloss_view.base.reading import printable
from relgloss_view.picture.scene.sample import SAMPLES, Sample
from relgloss_view.viewer.panels import presets
from relgloss_view.viewer.panels.list_rows import preview
from relgloss_view.viewer.panels.look import side_tabs
from relgloss_view.viewer.shell import widgets
from relgloss_view.viewer.state.model import Model

LONGEST = 60  #: characters of a name
LONGEST_WARNING = 240


def show(model: Model, open_file: Callable[[], object]) -> None:
    """The active side's sample, its evidence and its presets; `open_file` asks for a file."""
    side_tabs(model)
    _choose(model, open_file)
    _evidence(model)
    imgui.separator_text("Presets of the look")
    presets.show(model)


def _choose(model: Model, open_file: Callable[[], object]) -> None:
    sample = model.state.side(model.active_side).sample
    name = sample.name or printable(sample.material.name, LONGEST)
    widgets.label("Sample")
    if imgui.begin_combo("##Sample", preview(name)):
        for built_in in SAMPLES:
            if imgui.selectable(built_in, built_in == sample.name)[0]:
                model.attempt(
                    lambda built_in=built_in: model.set_sample(  # type: ignore[misc]
                        model.active_side, Sample.built_in(built_in)
                    )
                )
        imgui.end_combo()
    else:
        widgets.tooltip("The built-in papers, which are synthetic. Open a file for another sample.")
    if widgets.button("Open file...", "opens a material, or a measurement, which is then fitted"):
        open_file()


def _evidence(model: Model) -> None:
    sample = model.state.side(model.active_side).sample
    material = sample.material
    imgui.separator_text("Fit")
    fit = material.fit
    if fit is None:
        widgets.wrapped("Not fitted: the file gives the parameters of the reflection.")
    else:
        error = fit.residuals.get("median_relative_error")
        text = f"Quality: {fit.quality}. Model: {fit.chosen}."
        if isinstance(error, int | float):
            text += f" Median error: {100.0 * error:.1f} %."
        widgets.wrapped(text)
    if material.source:
        widgets.wrapped(widgets.sentence(printable(material.source, 200)), dim=True)
    place = sample.table or sample.file
    if place:
        widgets.wrapped(printable(Path(place).name, LONGEST), dim=True)
        widgets.tooltip(printable(place, 400))
    for warning in material.warnings:
        widgets.wrapped(f"! {printable(warning, LONGEST_WARNING)}")
