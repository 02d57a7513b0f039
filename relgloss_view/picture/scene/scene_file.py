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
from relgloss_view.base.terminal import ProgressReport, no_progress
from relgloss_view.base.toml import build_part, read_toml, table_of
from relgloss_view.display.display import Display
from relgloss_view.display.model import DisplayModel
from relgloss_view.material.recolour import Colour
from relgloss_view.material.spectra import illuminant, is_lamp_name
from relgloss_view.pack.forms import mesh_of
from relgloss_view.pack.pack_file import FINISH, PACK, pack_of_tables
from relgloss_view.pack.shape import Shape
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
#: A pack within the scene, which is then the sample. Of a reference: [reference.pack].
PACK_TABLES = (PACK, FINISH)
SAMPLE_ENTRIES = ("name", "material", *PACK_TABLES, "table", *COLOUR_ENTRIES)
#: The entries of [display] that name files.
DISPLAY_FILES = tuple(f.name for f in dataclasses.fields(Display) if f.metadata.get("file"))
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
    reference_shape: Shape | None = None  #: the reference's form beside a pack; None without one

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
    path: str | os.PathLike[str],
    replacements: list[str] | None = None,
    *,
    progress: ProgressReport = no_progress,
    later: dict[str, str] | None = None,
) -> SceneFile:
    """Read a scene file; InputError names the file, the entry and what was expected.

    Tables: [sample] with `name` (built in), `material` or `pack` (a file, relative to the scene
    file), or the tables [pack] and [[finish]] of a pack file in its place; [shape], [lamp], [eye],
    [display], [look] with the fields of their classes, [[further_lamp]] with those of FurtherLamp;
    for a pair of pictures [reference] with the entries of [sample], [reference.look], [match] and
    [presentation]. A pack has its own form: a [shape] beside it is the reference's.

    replacements: a list that collects a message for each material or lamp that can't be read; the
    built-in one (for the reference, None) takes its place. Without the list that is an error.
    progress: of reading packs. later: a dictionary that collects, by "sample" and "reference", the
    names of packs, which are not read: the built-in samples take their places without a message.
    """
    content = read_toml(path, MAX_BYTES, EXPECTED)
    try:
        return _scene_file(content, Path(path).parent, replacements, progress, later)
    except InputError as error:
        raise InputError(f"{path}: {error}") from error


def _scene_file(
    content: Mapping[str, Any],
    folder: Path,
    replacements: list[str] | None,
    progress: ProgressReport,
    later: dict[str, str] | None,
) -> SceneFile:
    tables = ("sample", *PACK_TABLES, *TABLES, FURTHER_LAMP, *PAIR_TABLES)
    unknown = set(content) - set(tables)
    if unknown:
        names = ", ".join(tables)
        raise InputError(f"[{printable(min(unknown), 60)}]: no such table; expected {names}")
    parts = {name: build(name, content.get(name, {})) for name in TABLES}
    presentation = table_of("presentation", content.get("presentation", {}))
    of_reference = dict(table_of("reference", content.get("reference", {})))
    reference_look = None
    if "look" in of_reference:
        reference_look = build("look", of_reference.pop("look"), "reference.")
    elif of_reference:
        reference_look = Look()
    parts["lamp"] = lamp_beside(parts["lamp"], folder, replacements)
    parts["shape"] = shape_beside(parts["shape"], folder, replacements)
    parts["display"] = display_beside(parts["display"], folder, replacements)
    look = parts.pop("look")
    of_sample = content.get("sample", {})
    of_pack = {name: content[name] for name in PACK_TABLES if name in content}
    if of_pack:
        if of_sample:
            raise InputError("[pack]: expected no [sample] beside it: the pack is the sample")
        of_sample = of_pack
    how: dict[str, Any] = {"progress": progress, "later": later}
    sample = read_sample("sample", of_sample, folder, replacements, **how)
    if sample is None:
        sample = Sample.built_in(DEFAULT_SAMPLE)
    reference_shape = None
    if sample.pack is not None:
        reference_shape = parts["shape"] if "shape" in content else None
        if "shape" in content and "reference" not in content:
            raise InputError("[shape]: a pack has its own form; give it there, as [pack.form]")
        parts["shape"] = sample.pack.shape
    return SceneFile(
        sample,
        look,
        Setup(**parts, further_lamps=further_lamps(content)),
        reference=read_sample("reference", of_reference, folder, replacements, **how),
        reference_look=reference_look,
        presentation=presentation,
        match=build_part(Match, "match", content["match"]) if "match" in content else None,
        reference_shape=reference_shape,
    )


def read_sample(
    place: str,
    entries: object,
    folder: Path,
    replacements: list[str] | None,
    *,
    progress: ProgressReport = no_progress,
    later: dict[str, str] | None = None,
) -> Sample | None:
    """The sample of a table with SAMPLE_ENTRIES; files are looked for in `folder`.

    progress, later: as read_scene_file's. None where the table names none or, with a list of
    replacements, one that can't be read. Raises InputError.
    """
    if not isinstance(entries, dict) or len({"name", "material", PACK} & set(entries)) > 1:
        raise InputError(f"[{place}]: expected either name or material or pack")
    for key, value in entries.items():
        if key not in SAMPLE_ENTRIES:
            names = ", ".join(SAMPLE_ENTRIES)
            raise InputError(
                f"{place}.{printable(key, 60)}: no such entry; expected one of {names}"
            )
        if key not in COLOUR_ENTRIES and not (key in PACK_TABLES and not isinstance(value, str)):
            text(value, f"{place}.{key}")
    if not {"name", "material", *PACK_TABLES} & set(entries):
        return None
    table = str(folder / entries["table"]) if "table" in entries else None
    try:
        colour = read_colour(place, entries, folder)
        if set(PACK_TABLES) & set(entries):
            if later is not None:
                later[place] = _pack_name(entries)
                return None
            sample = _pack_sample(place, entries, folder, progress)
        elif "material" in entries:
            sample = Sample.from_file(str(folder / entries["material"]), table)
        else:
            sample = dataclasses.replace(Sample.built_in(entries["name"]), table=table)
        return sample if colour is None else _in_colour(place, sample, colour)
    except InputError as error:
        if replacements is None:
            raise
        replacements.append(f"{error} (a built-in sample is used as the {place})")
        return None


def _pack_name(entries: Mapping[str, Any]) -> str:
    """What a pack that was not read is called: by its artwork, its own name or its file."""
    pack = entries.get(PACK)
    if isinstance(pack, str):
        return Path(pack).name
    table = pack if isinstance(pack, dict) else {}
    return Path(str(table.get("artwork") or table.get("name") or PACK)).name


def _pack_sample(
    place: str, entries: Mapping[str, Any], folder: Path, progress: ProgressReport
) -> Sample:
    """The sample of `pack = "FILE"`, or of the tables of a pack within the scene."""
    if "table" in entries:
        raise InputError(f"{place}.table: a pack is fitted to no table; leave it out")
    if not isinstance(entries.get(PACK), str):
        return Sample.of_pack(pack_of_tables(entries, folder, progress))
    if FINISH in entries:
        raise InputError(f"{place}.{FINISH}: expected none beside a pack file, which holds them")
    sample = Sample.from_file(str(folder / entries[PACK]), progress=progress)
    if sample.pack is None:
        file = printable(entries[PACK])
        raise InputError(f"{place}.{PACK}: {file} is a material; give a pack file")
    return sample


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


def shape_beside(shape: Shape, folder: Path, replacements: list[str] | None) -> Shape:
    """The shape with its mesh file, if it has one, in the scene's folder. Raises InputError."""
    if shape.file:
        shape = dataclasses.replace(shape, file=str(folder / shape.file))
    try:
        mesh_of(shape)  # a faulty file or profile is reported with the name of the scene file
    except InputError as error:
        if replacements is None:
            raise
        replacements.append(f"{error} (a {Shape().kind} is used as the form)")
        return Shape()
    return shape


def display_beside(display: Display, folder: Path, replacements: list[str] | None) -> Display:
    """The display with its files, if it has any, in the scene's folder. Raises InputError."""
    for entry in DISPLAY_FILES:
        name = getattr(display, entry)
        if not name:
            continue
        of_entry: dict[str, Any] = {entry: str(folder / name)}
        try:
            # A faulty file is reported with the name of the scene file, and so are numbers of the
            # scene that contradict it.
            later = dict.fromkeys(DISPLAY_FILES[DISPLAY_FILES.index(entry) + 1 :], "")
            DisplayModel.of(dataclasses.replace(display, **(later | of_entry)))
        except InputError as error:
            if replacements is None:
                raise
            replacements.append(f"{error} (the display is taken without it)")
            of_entry = {entry: "", "black_cd_m2": None}
        display = dataclasses.replace(display, **of_entry)
    return display


def build(name: str, values: object, within: str = "") -> Any:
    """One part of a scene from a table of values; InputError names the entry.

    `within` goes before the name in messages, as in "reference.".
    """
    return build_part(TABLES[name], name, values, within)
