"""Scene files (TOML): which sample stands where, and how it is to look. Read here."""

from __future__ import annotations

import dataclasses
import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable, text
from relgloss_view.base.toml import build_part, read_toml, table_of
from relgloss_view.material.spectra import illuminant, is_lamp_name
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.sample import DEFAULT_SAMPLE, Sample
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.setup import Lamp, Setup

#: The tables of a scene file and what they hold: the parts of the setup, and the look.
TABLES: dict[str, type[Any]] = {
    **{name: type(part) for name, part in Setup().parts().items()},
    "look": Look,
}
#: Of a pair of pictures. What [presentation] holds is the window's own business.
PAIR_TABLES = ("reference", "presentation")
SAMPLE_ENTRIES = ("name", "material", "table")
MAX_BYTES = 1024 * 1024
EXPECTED = "a scene file (TOML)"


@dataclass(frozen=True)
class SceneFile:
    """What a scene file says. Without a reference, or without its look, those are None."""

    sample: Sample
    look: Look
    setup: Setup = Setup()
    reference: Sample | None = None
    reference_look: Look | None = None
    presentation: Mapping[str, Any] = field(default_factory=dict)  #: as it stands there

    def scene(self) -> Scene:
        """What the sample's picture shows."""
        return Scene(self.sample.material, self.setup)


def load_scene(path: str | os.PathLike[str]) -> tuple[Scene, Look]:
    """Scene and look of a scene file's [sample]; InputError as read_scene_file."""
    content = read_scene_file(path)
    return content.scene(), content.look


def read_scene_file(path: str | os.PathLike[str], stood_in: list[str] | None = None) -> SceneFile:
    """Read a scene file; InputError names the file, the entry and what was expected.

    Tables: [sample] with `name` (built in) or `material` (a file, relative to the scene file), and
    [shape], [lamp], [eye], [display], [look] with the fields of the classes in scene.py; for a pair
    of pictures [reference] with the entries of [sample], [reference.look] and [presentation].

    With a list `stood_in`, a material or a lamp that can't be had is replaced by the built-in one
    (the reference by None), and the list is told; everything else is kept.
    """
    content = read_toml(path, MAX_BYTES, EXPECTED)
    try:
        return _scene_file(content, Path(path).parent, stood_in)
    except InputError as error:
        raise InputError(f"{path}: {error}") from error


def _scene_file(content: Mapping[str, Any], folder: Path, stood_in: list[str] | None) -> SceneFile:
    unknown = set(content) - set(TABLES) - set(PAIR_TABLES) - {"sample"}
    if unknown:
        known = ", ".join(["sample", *TABLES, *PAIR_TABLES])
        raise InputError(f"[{printable(min(unknown), 60)}]: no such table; expected {known}")
    parts = {name: build(name, content.get(name, {})) for name in TABLES}
    presentation = table_of("presentation", content.get("presentation", {}))
    of_reference = dict(table_of("reference", content.get("reference", {})))
    reference_look = None
    if "look" in of_reference:
        reference_look = build("look", of_reference.pop("look"), "reference.")
    elif of_reference:
        reference_look = Look()
    parts["lamp"] = lamp_beside(parts["lamp"], folder, stood_in)
    look = parts.pop("look")
    sample = read_sample("sample", content.get("sample", {}), folder, stood_in)
    if sample is None:
        sample = Sample.built_in(DEFAULT_SAMPLE)
    return SceneFile(
        sample,
        look,
        Setup(**parts),
        reference=read_sample("reference", of_reference, folder, stood_in),
        reference_look=reference_look,
        presentation=presentation,
    )


def read_sample(
    place: str, entries: object, folder: Path, stood_in: list[str] | None
) -> Sample | None:
    """The sample of a table with SAMPLE_ENTRIES; files are taken from `folder`.

    None where the table names none or, with a list `stood_in`, one that is not there. InputError.
    """
    if not isinstance(entries, dict) or {"name", "material"} <= set(entries):
        raise InputError(f"[{place}]: expected either name or material")
    for key, value in entries.items():
        if key not in SAMPLE_ENTRIES:
            known = ", ".join(SAMPLE_ENTRIES)
            raise InputError(
                f"{place}.{printable(key, 60)}: no such entry; expected one of {known}"
            )
        text(value, f"{place}.{key}")
    if not {"name", "material"} & set(entries):
        return None
    table = str(folder / entries["table"]) if "table" in entries else None
    try:
        if "material" in entries:
            return Sample.from_file(str(folder / entries["material"]), table)
        return dataclasses.replace(Sample.built_in(entries["name"]), table=table)
    except InputError as error:
        if stood_in is None:
            raise
        stood_in.append(f"{error} (a built-in sample stands in as the {place})")
        return None


def lamp_beside(lamp: Lamp, folder: Path, stood_in: list[str] | None) -> Lamp:
    """The lamp with its file, if it has one, taken from the scene's folder. InputError."""
    if is_lamp_name(lamp.illuminant):
        return lamp
    file = str(folder / lamp.illuminant)
    try:
        illuminant(file)  # a fault is told with the place of the scene
    except InputError as error:
        if stood_in is None:
            raise
        stood_in.append(f"{error} ({Lamp().illuminant} stands in as the lamp)")
        file = Lamp().illuminant
    return dataclasses.replace(lamp, illuminant=file)


def build(name: str, values: object, within: str = "") -> Any:
    """One part of a scene from a table of values; InputError names the entry.

    `within` goes before the name in messages, as in "reference.".
    """
    return build_part(TABLES[name], name, values, within)
