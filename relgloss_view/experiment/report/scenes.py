"""Chosen settings as scene files that the window opens, whole: the folder may be moved."""

from __future__ import annotations

import dataclasses
from pathlib import Path

from relgloss_view.display.display import Display
from relgloss_view.display.kept_file import keep_file
from relgloss_view.experiment.design.study import Study
from relgloss_view.experiment.design.study_packs import full_c_of_pack
from relgloss_view.experiment.report.chosen_setting import chosen_setting
from relgloss_view.experiment.verdict.analysis import Analysis
from relgloss_view.gloss.match import absolute_c
from relgloss_view.material.files import save_material
from relgloss_view.material.lamp_file import lamp_bytes
from relgloss_view.material.spectra import is_lamp_name
from relgloss_view.pack.pack_file import write_pack
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.match import MOST_C, Match
from relgloss_view.picture.scene.sample import SAMPLES, Sample, load_sample
from relgloss_view.picture.scene.scene_file import DISPLAY_FILES, SceneFile
from relgloss_view.picture.scene.scene_writer import write_scene_file
from relgloss_view.picture.scene.setup import Lamp

LAMP = "lamp.csv"
MATERIAL, PACK = ".material.json", ".pack.toml"  #: after the name


def write_scenes(
    folder: Path, analysis: Analysis, names: dict[str, str], of_reference: str
) -> dict[str, str]:
    """A scene for each sample whose leading setting may be shown; by label, the file's name.

    `names` are file names by label, without an ending; `of_reference` is one for the reference.
    Materials that are not built in, a lamp's table, and a display's files are written beside them.
    """
    study = analysis.pool.study
    samples = {sample.label: sample.sample for sample in study.samples if not sample.lost}
    choices = {result.label: chosen_setting(result, study.grid) for result in analysis.samples}
    written = {
        label: choice
        for label, choice in choices.items()
        if choice.may_be_named and label in samples
    }
    if not written:
        return {}
    lamp = _lamp_in(folder, study.setup.lamp)
    display = _display_in(folder, study.setup.display, {*names.values(), of_reference})
    reference = _sample_in(folder, study.reference, of_reference)
    files = {}
    for label, choice in written.items():
        content = SceneFile(
            _sample_in(folder, samples[label], names[label]),
            study.test_look(choice.setting),
            dataclasses.replace(study.setup, lamp=lamp, display=display),
            reference,
            study.reference_look,
            match=_match(study, samples[label], study.test_look(choice.setting)),
        )
        files[label] = f"{names[label]}.toml"
        write_scene_file(folder / files[label], content)
    return files


def _match(study: Study, sample: Sample, look: Look) -> Match:
    """The observers' settings as a match; a share of c_max is that of the study's setup."""
    reference = absolute_c(study.reference_look, study.reference.material, study.setup)
    if sample.pack is not None:
        test = look.setting.c_fraction * full_c_of_pack(sample.pack, study.setup)
    else:
        test = absolute_c(look, sample.material, study.setup)
    return Match(
        reference_c=min(reference, MOST_C),
        test_c=min(test, MOST_C),
        reference_sigma_n_deg=study.reference_look.sigma_n_deg,
        test_sigma_n_deg=look.sigma_n_deg,
        made_by="experiment",
    )


def _sample_in(folder: Path, sample: Sample, name: str) -> Sample:
    """The sample as a scene in the folder names it.

    A session keeps the material that was judged: where the built-in one of today is another, that
    one counts.
    """
    if sample.pack is not None:
        file = folder / f"{name}{PACK}"
        write_pack(file, sample.pack)
        return dataclasses.replace(sample, file=str(file))
    if sample.name in SAMPLES and load_sample(sample.name) == sample.material:
        return Sample(sample.material, name=sample.name)
    file = folder / f"{name}{MATERIAL}"
    save_material(sample.material, file)
    return Sample(sample.material, file=str(file))


def _display_in(folder: Path, display: Display, taken: set[str]) -> Display:
    """The study's display as scenes in the folder name it.

    taken: names that its files can't have.
    """
    files = {}
    for entry in DISPLAY_FILES:
        if file := getattr(display, entry):
            stem = f"display-{entry}"
            while stem in taken:
                stem += "_"
            files[entry] = keep_file(file).put_into(folder, stem)
    return dataclasses.replace(display, **files)  # type: ignore[arg-type]


def _lamp_in(folder: Path, lamp: Lamp) -> Lamp:
    """The lamp as scenes in the folder name it."""
    if is_lamp_name(lamp.illuminant):
        return lamp
    (folder / LAMP).write_bytes(lamp_bytes(lamp.illuminant))
    return dataclasses.replace(lamp, illuminant=str(folder / LAMP))
