"""A study of the pair that a proof shows: its reference, its sample, its surroundings."""

from __future__ import annotations

import os
import shutil
from pathlib import Path
from typing import Any

from relgloss_view.base.reading import printable
from relgloss_view.base.toml import entries, toml_text
from relgloss_view.base.writing import fresh_file, together, whole_folder
from relgloss_view.experiment.design.study import LONGEST_LABEL
from relgloss_view.material.spectra import is_lamp_name
from relgloss_view.picture.scene.scene_file import DISPLAY_FILES, FURTHER_LAMP
from relgloss_view.proof.carry import SCENE, relative
from relgloss_view.proof.proof import Proof
from relgloss_view.proof.unpack import Opened, opened


def write_study_of_proof(path: str | os.PathLike[str], proof: Proof) -> Path:
    """Write a study file of a proof, and its files into a folder beside it; that folder.

    The reference has the newest message's setting; sigma_N and c of the sample come from the grid.
    The folder is named for the study: its files belong together. Raises InputError where the study
    file exists already, or the proof's files hold no pair.
    """
    study = Path(path)
    folder = study.with_name(f"{study.stem}-files")
    with opened(proof) as one:
        text = toml_text(_tables(one, folder.name))
        with together(), fresh_file(study) as temporary, whole_folder(folder, SCENE) as staged:
            temporary.write_text(text, encoding="utf-8")
            shutil.copytree(one.folder, staged, dirs_exist_ok=True)
    return folder


def _tables(one: Opened, folder: str) -> dict[str, Any]:
    """The tables of the study. folder: where its files will lie, beside it."""
    proof, scene, sent = one.proof, one.scene_file, one.placed(one.proof.sent)
    assert scene.reference is not None
    assert scene.reference_look is not None

    def named(file: str) -> str:
        return f"{folder}/{relative(file, one.folder)}"

    label = printable(proof.title, LONGEST_LABEL) or "design"
    sample: dict[str, Any] = {"label": label}
    if scene.sample.pack is not None:
        sample["pack"] = named(scene.sample.pack.file)
    else:
        sample["material"] = named(str(scene.sample.file))
    reference_look = scene.reference_look.with_entries(
        sigma_n_deg=sent.reference.sigma_n_deg, c=sent.reference.c
    )
    setup = sent.in_setup(scene.setup)
    shape = setup.shape if scene.sample.pack is None else scene.reference_shape
    tables: dict[str, Any] = {
        "study": {"title": label},
        "reference": {
            "material": named(str(scene.reference.file)),
            "look": entries(reference_look),
        },
        "lamp": entries(setup.lamp),
        "eye": entries(setup.eye),
        "display": entries(setup.display),
        "look": {
            name: value
            for name, value in entries(scene.look).items()
            if name not in ("sigma_n_deg", "c", "c_fraction")
        },
        "screen": dict(zip(("width_px", "height_px"), proof.content["size_px"], strict=True)),
        "samples": [sample],
    }
    if shape is not None:
        tables["shape"] = entries(shape)
        if shape.file:
            tables["shape"]["file"] = named(shape.file)
    if not is_lamp_name(setup.lamp.illuminant):
        tables["lamp"]["illuminant"] = named(setup.lamp.illuminant)
    for entry in DISPLAY_FILES:
        if file := getattr(setup.display, entry):
            tables["display"][entry] = named(file)
    if setup.further_lamps:
        tables[FURTHER_LAMP] = [entries(one) for one in setup.further_lamps]
    return tables
