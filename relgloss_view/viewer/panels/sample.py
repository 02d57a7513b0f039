"""The sample of a side: its material, how far the fit can be trusted, and presets of the look."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from imgui_bundle import imgui

from relgloss_view.base.reading import printable
from relgloss_view.picture.scene.sample import SAMPLES, Sample
from relgloss_view.viewer.panels import (
    colour_fields,
    estimate_table,
    plot_widgets,
    presets,
)
from relgloss_view.viewer.panels.list_rows import preview
from relgloss_view.viewer.panels.look import side_tabs
from relgloss_view.viewer.shell import widgets
from relgloss_view.viewer.state.model import Model

if TYPE_CHECKING:
    from relgloss_view.viewer.shell.file_actions import FileActions

LONGEST = 60  #: characters of a name
LONGEST_WARNING = 240


REPLACING = "Replace reference"


def show(model: Model, files: FileActions) -> None:
    """The active side's sample, its evidence and its presets; `files` asks for files."""
    side_tabs(model)
    if model.active_side == "reference":
        _locked(model, files)
    else:
        _choose(model, files)
    if model.pack(model.active_side) is None:
        colour_fields.show(model, model.active_side)
    _evidence(model)
    imgui.separator_text("Presets of the look")
    presets.show(model)


def _name(sample: Sample) -> str:
    if sample.pack is not None:
        return printable(f"Pack: {sample.pack.name}", LONGEST)
    return sample.name or printable(sample.own_material.name, LONGEST)


def _choose(model: Model, files: FileActions) -> None:
    """The list of built-in papers, and a button for a file: what becomes the test sample."""
    sample = model.state.test.sample
    widgets.label("Sample")
    if imgui.begin_combo("##Sample", preview(_name(sample))):
        _built_in(model, "test")
        imgui.end_combo()
    else:
        widgets.tooltip("The built-in papers, which are synthetic. Open a file for another sample.")
    if widgets.button("Open file...", "opens a material, or a measurement, which is then fitted"):
        files.open()
    _new_material(files)


def _new_material(files: FileActions) -> None:
    text = "New material..."
    plot_widgets.beside(plot_widgets.button_width(text), gap_em=0.5)
    if widgets.button(text, "makes a material from gloss readings and a colour"):
        files.make_material()


def _locked(model: Model, files: FileActions) -> None:
    """The reference's name, and the one button that replaces it."""
    widgets.label("Sample")
    imgui.text_unformatted(_name(model.state.reference.sample))
    if widgets.button(
        f"{REPLACING}...",
        "chooses another reference; files that you open or drop become the test sample",
    ):
        imgui.open_popup(REPLACING)
    _new_material(files)
    if imgui.begin_popup(REPLACING):
        _built_in(model, "reference")
        imgui.separator()
        if imgui.selectable("File...", False)[0]:
            files.replace_reference()
        imgui.end_popup()


def _built_in(model: Model, side: str) -> None:
    """The built-in papers as a list; a click puts one on a side."""
    present = model.state.side(side).sample.name
    for name in SAMPLES:
        if imgui.selectable(name, name == present)[0]:
            model.attempt(
                lambda name=name: model.set_sample(  # type: ignore[misc]
                    side, Sample.built_in(name)
                )
            )
        if name == present:
            imgui.set_item_default_focus()


def _evidence(model: Model) -> None:
    sample, finish = model.sample(model.active_side), model.active_finish(model.active_side)
    material = sample.material
    imgui.separator_text("Fit" if finish is None else "Fit of the finish")
    if finish is not None:
        widgets.wrapped(f"{printable(finish.name, LONGEST)}: {printable(material.name, LONGEST)}")
    fit = material.fit
    if material.estimate is not None:
        widgets.wrapped(widgets.sentence(material.estimate.range_words))
        estimate_table.show(material.estimate)
    elif fit is None:
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
