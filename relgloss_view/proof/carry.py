"""Carry: a scene with all that it names as files in one folder, and a folder's files as JSON.

Whoever opens a proof may have another version of the program, and none of the designer's files. So
materials, built-in ones too, lamps, profiles, artwork and meshes go along whole.
"""

from __future__ import annotations

import base64
import dataclasses
import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from relgloss_view.base.terminal import ProgressReport, no_progress
from relgloss_view.display.display import Display
from relgloss_view.display.kept_file import keep_file
from relgloss_view.material.lamp_file import lamp_text
from relgloss_view.material.spectra import is_lamp_name
from relgloss_view.pack.shape import Shape
from relgloss_view.picture.scene.sample import Sample
from relgloss_view.picture.scene.scene_file import DISPLAY_FILES, SceneFile, read_scene_file
from relgloss_view.picture.scene.scene_writer import write_scene_file
from relgloss_view.picture.scene.setup import Setup
from relgloss_view.proof.carry_pack import MATERIALS, carried_mesh, carried_pack, put_material

SCENE = "scene.toml"
TEXTS = (".toml", ".json", ".csv")  #: files that are text in a proof's JSON
#: Media types of the others.
TYPES = {
    ".png": "image/png",
    ".icc": "application/vnd.iccprofile",
    ".glb": "model/gltf-binary",
    ".gltf": "model/gltf+json",
    ".obj": "model/obj",
    ".stl": "model/stl",
    ".ply": "application/octet-stream",
    ".bin": "application/octet-stream",
}


@dataclass(frozen=True)
class Carried:
    """A scene whose files lie in one folder. notes: what is not as it was, one sentence each."""

    scene: SceneFile
    notes: tuple[str, ...] = ()


def carried(
    content: SceneFile,
    folder: Path,
    *,
    artwork_px: int,
    progress: ProgressReport = no_progress,
) -> Carried:
    """A pair written into an empty folder as SCENE with all that it names, and read from there.

    content: with a reference, and absolute c on both sides. artwork_px: pixels of the longer side
    of an artwork, at most. What only a window shows ([presentation]) is left out. Raises InputError
    where a file can't be read any more.
    """
    (folder / MATERIALS).mkdir()
    assert content.reference is not None
    notes: list[str] = []
    sample = _sample(content.sample, folder, "test", artwork_px, notes, progress)
    shape = content.setup.shape if sample.pack is None else sample.pack.shape
    setup = _setup(content.setup, folder, shape if sample.pack is not None else None)
    reference_shape = None
    if sample.pack is not None:
        reference_shape = _shape(content.reference_shape or Shape(), folder, "reference-form")
    write_scene_file(
        folder / SCENE,
        SceneFile(
            sample,
            content.look,
            setup,
            _sample(content.reference, folder, "reference", artwork_px, notes, progress),
            content.reference_look,
            match=content.match,
            reference_shape=reference_shape,
        ),
    )
    return Carried(read_scene_file(folder / SCENE, progress=progress), tuple(notes))


def files_of(folder: Path) -> dict[str, dict[str, str]]:
    """The files of a folder as a proof's JSON holds them, by their names with `/`."""
    files = {}
    for path in sorted(p for p in folder.rglob("*") if p.is_file()):
        name, suffix = path.relative_to(folder).as_posix(), path.suffix.lower()
        data = path.read_bytes()
        if suffix in TEXTS:
            files[name] = {"text": data.decode("utf-8")}
        else:
            coded = base64.b64encode(data).decode("ascii")
            files[name] = {"base64": coded, "type": TYPES[suffix]}
    return files


def size_of(file: Mapping[str, str]) -> int:
    """Bytes that a file takes in a proof's JSON, about."""
    return len(file.get("base64", "")) or len(file.get("text", "").encode("utf-8"))


def _sample(
    sample: Sample,
    folder: Path,
    side: str,
    artwork_px: int,
    notes: list[str],
    progress: ProgressReport,
) -> Sample:
    """A sample whose files are in the folder. One in another colour has it as its own."""
    if sample.pack is not None:
        pack, more = carried_pack(sample.pack, folder, side, artwork_px, progress)
        notes += more
        return Sample.of_pack(pack)
    return Sample(sample.material, file=put_material(sample.material, folder, side))


def _setup(setup: Setup, folder: Path, of_pack: Shape | None) -> Setup:
    """A setup whose files are in the folder. of_pack: the form of a pack, carried already."""
    lamp = setup.lamp.illuminant
    if not is_lamp_name(lamp):
        file = folder / "lamp.csv"
        file.write_text(lamp_text(lamp), encoding="utf-8")
        setup = setup.with_entries("lamp", illuminant=str(file))
    shape = _shape(setup.shape, folder, "form") if of_pack is None else of_pack
    return setup.placed(shape=shape, display=_display(setup.display, folder))


def _display(display: Display, folder: Path) -> Display:
    """A display whose files are in the folder."""
    put: dict[str, Any] = {}
    for entry in DISPLAY_FILES:
        if file := getattr(display, entry):
            stem = "display" if entry == "profile" else entry.replace("_", "-")
            put[entry] = keep_file(file).put_into(folder, stem)
    return dataclasses.replace(display, **put)


def _shape(shape: Shape, folder: Path, stem: str) -> Shape:
    """A shape whose mesh file is in the folder."""
    if not shape.file:
        return shape
    return dataclasses.replace(shape, file=carried_mesh(shape.file, folder, stem))


def relative(path: str, folder: Path) -> str:
    """A file's name within the folder, as a proof's JSON has it."""
    return Path(os.path.relpath(path, folder)).as_posix()
