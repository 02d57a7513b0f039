"""Scene files (TOML): writing, so that reading gives back exactly the same values."""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable, text
from relgloss_view.base.toml import entries, plain, write_toml
from relgloss_view.material.recolour import DEFAULT_ILLUMINANT
from relgloss_view.material.spectra import is_lamp_name
from relgloss_view.pack.pack import Pack
from relgloss_view.pack.pack_file import PACK, pack_tables, read_pack
from relgloss_view.pack.shape import Shape
from relgloss_view.picture.scene.sample import SAMPLES, Sample
from relgloss_view.picture.scene.scene_file import DISPLAY_FILES, FURTHER_LAMP, SceneFile

_SUFFIX = re.compile(r"\.[A-Za-z]{3,5}$")


def write_scene_file(
    path: str | os.PathLike[str], content: SceneFile, *, forgiving: bool = False
) -> None:
    """Write a scene file, whole or not at all; InputError where that fails.

    Files under the scene file's folder are named relative to it, others by their absolute path.
    Errors are a sample that is in no file, one whose file is gone, and a name that is not UTF-8.
    forgiving: write the rest without them.
    """
    folder = Path(path).absolute().parent
    try:
        tables = _tables(content, folder, forgiving)
    except InputError as error:
        raise InputError(f"{path}: {error}") from error
    write_toml(path, tables)


def check_sample(sample: Sample) -> None:
    """InputError where the sample could not be read again: no name, no file, or a missing one."""
    name = printable(sample.material.name, 60)
    if sample.pack is not None:
        pack_tables(sample.pack, Path.cwd())
    elif sample.name is not None:
        if sample.name not in SAMPLES:
            raise InputError(f"sample {sample.name!r}: expected one of {', '.join(SAMPLES)}")
    elif sample.file is None:
        raise InputError(f"the sample {name!r} is in no file; save its material first")
    elif not os.path.isfile(sample.file):
        raise InputError(
            f"the material file of the sample {name!r} is gone: {printable(sample.file)}; put it "
            "back, or take another sample"
        )


def _tables(content: SceneFile, folder: Path, forgiving: bool) -> dict[str, Any]:
    tables: dict[str, Any] = {"sample": _sample("sample", content.sample, folder, forgiving)}
    tables["look"] = entries(content.look)
    of_reference: dict[str, Any] = {}
    if content.reference is not None:
        of_reference |= _sample("reference", content.reference, folder, forgiving)
    if content.reference_look is not None:
        of_reference["look"] = entries(content.reference_look)
    if of_reference:
        tables["reference"] = of_reference
    if content.sample.pack is not None and PACK not in tables["sample"]:
        tables.pop("sample")
    elif isinstance(tables["sample"].get(PACK), dict):  # the pack is the sample
        tables |= tables.pop("sample")
    tables |= {name: entries(part) for name, part in content.setup.parts().items()}
    shape: Shape | None = content.setup.shape
    if content.sample.pack is not None:  # whose own form is in the pack
        shape = None if content.reference is None else content.reference_shape
        tables.pop("shape")
        tables |= {} if shape is None else {"shape": entries(shape)}
    if content.setup.further_lamps:
        tables[FURTHER_LAMP] = [entries(lamp) for lamp in content.setup.further_lamps]
    lamp = content.setup.lamp.illuminant
    if not is_lamp_name(lamp):
        _put(tables["lamp"], "illuminant", _place(lamp, folder), "lamp", forgiving)
    if shape is not None and shape.file:
        _put(tables["shape"], "file", _place(shape.file, folder), "shape", forgiving)
    for entry in DISPLAY_FILES:
        if file := getattr(content.setup.display, entry):
            _put(tables["display"], entry, _place(file, folder), "display", forgiving)
    if content.match is not None:
        tables["match"] = entries(content.match)
    if content.presentation:
        tables["presentation"] = {k: plain(v) for k, v in content.presentation.items()}
    return tables


def _sample(place: str, sample: Sample, folder: Path, forgiving: bool) -> dict[str, Any]:
    table: dict[str, Any] = {}
    try:
        check_sample(sample)
    except InputError as error:
        if not forgiving:
            raise InputError(f"[{place}]: {error}") from error
    if sample.pack is not None:
        return _pack_entries(place, sample.pack, folder, forgiving)
    if sample.name is not None:
        table["name"] = sample.name
    elif sample.file is not None:
        _put(table, "material", _place(sample.file, folder), place, forgiving)
    if table and sample.colour is not None:
        colour = sample.colour
        table["lab"] = plain(colour.lab)
        lamp = colour.lab_illuminant
        if not is_lamp_name(lamp):
            _put(table, "lab_illuminant", _place(lamp, folder), place, forgiving)
        elif lamp != DEFAULT_ILLUMINANT:
            table["lab_illuminant"] = lamp
    if table and sample.table is not None:
        _put(table, "table", _place(sample.table, folder), place, forgiving)
    return table


def _pack_entries(place: str, pack: Pack, folder: Path, forgiving: bool) -> dict[str, Any]:
    """The pack file that holds the pack as it is, else the pack itself."""
    try:
        tables = pack_tables(pack, folder)
        if pack.file and _is_saved(pack, tables, folder):
            return {PACK: text(_place(pack.file, folder), f"{place}.{PACK}")}
        return tables
    except InputError as error:
        if not forgiving:
            raise InputError(f"[{place}]: {error}") from error
        return {}


def _is_saved(pack: Pack, tables: dict[str, Any], folder: Path) -> bool:
    """Whether the pack's file still holds what the pack is."""
    try:
        return pack_tables(read_pack(pack.file), folder) == tables
    except InputError:
        return False


def _put(table: dict[str, Any], key: str, name: str, place: str, forgiving: bool) -> None:
    """Set an entry to a file's name, if that can be text; half a name is worse than none."""
    table.pop(key, None)
    try:
        table[key] = text(name, f"{place}.{key}")
    except InputError as error:
        if not forgiving:
            raise InputError(f"{error}; its name is not UTF-8, so rename the file") from error


def _place(file: str, folder: Path) -> str:
    """A file's name as the scene file writes it: relative where it lies under its folder."""
    path = Path(file).absolute()
    inside = path.relative_to(folder) if path.is_relative_to(folder) else path
    if inside is path or ".." in inside.parts:
        return str(path)
    name = inside.as_posix()
    # A lamp file named as a lamp is. No lamp's name ends in .json or .png, and asking is dear.
    may_be_lamp = not _SUFFIX.search(name)
    return f"./{name}" if may_be_lamp and is_lamp_name(name) else name
