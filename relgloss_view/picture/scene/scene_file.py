"""Scene files (TOML): the sample, its setup and its look. Reading; scene_writer.py writes."""

from __future__ import annotations

import dataclasses
import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable, refuse, text
from relgloss_view.base.toml import build_part, read_toml, table_of
from relgloss_view.material.recolour import Colour
from relgloss_view.material.spectra import illuminant, is_lamp_name
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.match import Match
from relgloss_view.picture.scene.sample import DEFAULT_SAMPLE, Sample
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.setup import FurtherLamp, Lamp, Setup

#: The tables of a scene file and what they hold: the parts of the setup, and the look.
TABLES: dict[str, type[Any]] = {
    **{name: type(part) for name, part in Setup().parts().items()},
    "look": Look,
}
FURTHER_LAMP = FurtherLamp.TABLE  #: a list of tables, [[further_lamp]]
#: Of a pair of pictures. What [presentation] holds is the window's own business.
PAIR_TABLES = ("reference", "match", "presentation")
COLOUR_ENTRIES = tuple(f.name for f in dataclasses.fields(Colour))
SAMPLE_ENTRIES = ("name", "material", "table", *COLOUR_ENTRIES)
MAX_BYTES = 1024 * 1024
EXPECTED = "a scene file (TOML)"


@dataclass(frozen=True)
class SceneFile:
    """The content of a scene file; reference and reference_look are None where it has none."""

    sample: Sample
    look: Look
    setup: Setup = Setup()
    reference: Sample | None = None
    reference_look: Look | None = None
    presentation: Mapping[str, Any] = field(default_factory=dict)  #: as in the file
    match: Match | None = None  #: how the two looks were found; None where the file has none

    def scene(self) -> Scene:
        """The scene of the sample's picture."""
        return self.sample.scene(self.setup)


def load_scene(path: str | os.PathLike[str]) -> tuple[Scene, Look]:
    """Scene and look of a scene file's [sample].

    path: a TOML file with the tables of docs/files.md, each optional. Files that it names are read
    from its folder. Raises InputError, one line that names the file, the entry and the values that
    are expected.

    >>> from pathlib import Path
    >>> text = '[sample]\\nname = "uncoated"\\n[look]\\nsigma_n_deg = 2.0\\n'
    >>> _ = Path("paper.toml").write_text(text)
    >>> scene, look = load_scene("paper.toml")
    >>> scene.material.name, look.setting.words
    ('uncoated, green ink', '2 deg, 6/6 c_max')
    """
    content = read_scene_file(path)
    return content.scene(), content.look


def read_scene_file(
    path: str | os.PathLike[str], replacements: list[str] | None = None
) -> SceneFile:
    """Read a scene file; InputError names the file, the entry and what was expected.

    Tables: [sample] with `name` (built in) or `material` (a file, relative to the scene file), and
    [shape], [lamp], [eye], [display], [look] with the fields of their classes, [[further_lamp]] with
    those of FurtherLamp; for a pair of pictures [reference] with the entries of [sample], [reference.look], [match] and [presentation].

    replacements: a list that collects a message for each material or lamp that can't be read; the
    built-in one (for the reference, None) takes its place. Without the list that is an error.
    """
    content = read_toml(path, MAX_BYTES, EXPECTED)
    try:
        return _scene_file(content, Path(path).parent, replacements)
    except InputError as error:
        raise InputError(f"{path}: {error}") from error


def _scene_file(
    content: Mapping[str, Any], folder: Path, replacements: list[str] | None
) -> SceneFile:
    unknown = set(content) - {"sample", *TABLES, FURTHER_LAMP, *PAIR_TABLES}
    if unknown:
        tables = ", ".join(["sample", *TABLES, FURTHER_LAMP, *PAIR_TABLES])
        raise InputError(f"[{printable(min(unknown), 60)}]: no such table; expected {tables}")
    parts = {name: build(name, content.get(name, {})) for name in TABLES}
    presentation = table_of("presentation", content.get("presentation", {}))
    of_reference = dict(table_of("reference", content.get("reference", {})))
    reference_look = None
    if "look" in of_reference:
        reference_look = build("look", of_reference.pop("look"), "reference.")
    elif of_reference:
        reference_look = Look()
    parts["lamp"] = lamp_beside(parts["lamp"], folder, replacements)
    look = parts.pop("look")
    sample = read_sample("sample", content.get("sample", {}), folder, replacements)
    if sample is None:
        sample = Sample.built_in(DEFAULT_SAMPLE)
    return SceneFile(
        sample,
        look,
        Setup(**parts, further_lamps=further_lamps(content)),
        reference=read_sample("reference", of_reference, folder, replacements),
        reference_look=reference_look,
        presentation=presentation,
        match=build_part(Match, "match", content["match"]) if "match" in content else None,
    )


def read_sample(
    place: str, entries: object, folder: Path, replacements: list[str] | None
) -> Sample | None:
    """The sample of a table with SAMPLE_ENTRIES; files are looked for in `folder`.

    None where the table names none or, with a list of replacements, one that can't be read.
    Raises InputError.
    """
    if not isinstance(entries, dict) or {"name", "material"} <= set(entries):
        raise InputError(f"[{place}]: expected either name or material")
    for key, value in entries.items():
        if key not in SAMPLE_ENTRIES:
            names = ", ".join(SAMPLE_ENTRIES)
            raise InputError(
                f"{place}.{printable(key, 60)}: no such entry; expected one of {names}"
            )
        if key not in COLOUR_ENTRIES:
            text(value, f"{place}.{key}")
    if not {"name", "material"} & set(entries):
        return None
    table = str(folder / entries["table"]) if "table" in entries else None
    try:
        colour = read_colour(place, entries, folder)
        if "material" in entries:
            sample = Sample.from_file(str(folder / entries["material"]), table)
        else:
            sample = dataclasses.replace(Sample.built_in(entries["name"]), table=table)
        return sample if colour is None else _in_colour(place, sample, colour)
    except InputError as error:
        if replacements is None:
            raise
        replacements.append(f"{error} (a built-in sample is used as the {place})")
        return None


def read_colour(place: str, entries: Mapping[str, Any], folder: Path) -> Colour | None:
    """The colour of a sample's table, `lab` and `lab_illuminant`; None without. InputError."""
    values = {key: entries[key] for key in COLOUR_ENTRIES if key in entries}
    if not values:
        return None
    if "lab" not in values:
        raise InputError(f"{place}.lab_illuminant: expected lab = [L, a, b] beside it")
    lamp = values.get("lab_illuminant")
    if isinstance(lamp, str) and not is_lamp_name(lamp):
        values["lab_illuminant"] = str(folder / lamp)
    try:
        return Colour(**values)
    except InputError as error:
        raise InputError(f"{place}.{error}") from error


def _in_colour(place: str, sample: Sample, colour: Colour) -> Sample:
    try:
        return sample.in_colour(colour)
    except InputError as error:
        raise InputError(f"{place}.{error}") from error


def lamp_beside(lamp: Lamp, folder: Path, replacements: list[str] | None) -> Lamp:
    """The lamp with its file, if it has one, in the scene's folder. Raises InputError."""
    if is_lamp_name(lamp.illuminant):
        return lamp
    file = str(folder / lamp.illuminant)
    try:
        illuminant(file)  # a faulty file is reported with the name of the scene file
    except InputError as error:
        if replacements is None:
            raise
        replacements.append(f"{error} ({Lamp().illuminant} is used as the lamp)")
        file = Lamp().illuminant
    return dataclasses.replace(lamp, illuminant=file)


def further_lamps(content: Mapping[str, Any]) -> tuple[FurtherLamp, ...]:
    """The lamps of a file's [[further_lamp]] tables, none by default. Raises InputError."""
    tables = content.get(FURTHER_LAMP, [])
    if not isinstance(tables, list):
        refuse(FURTHER_LAMP, f"[[{FURTHER_LAMP}]], a table for each lamp", tables)
    return tuple(build_part(FurtherLamp, FURTHER_LAMP, table) for table in tables)


def build(name: str, values: object, within: str = "") -> Any:
    """One part of a scene from a table of values; InputError names the entry.

    `within` goes before the name in messages, as in "reference.".
    """
    return build_part(TABLES[name], name, values, within)
