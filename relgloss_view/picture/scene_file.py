"""Scene files (TOML): which sample stands where, and how it is to look."""

from __future__ import annotations

import dataclasses
import os
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from relgloss_view.errors import InputError
from relgloss_view.material.files import load_material
from relgloss_view.material.spectra import illuminant, is_lamp_name
from relgloss_view.picture.samples import DEFAULT_SAMPLE, load_sample
from relgloss_view.picture.scene import Display, Eye, Lamp, Look, Scene, Shape
from relgloss_view.text_input import read_text

TABLES: dict[str, type[Any]] = {
    "shape": Shape,
    "lamp": Lamp,
    "eye": Eye,
    "display": Display,
    "look": Look,
}
MAX_BYTES = 1024 * 1024


def load_scene(path: str | os.PathLike[str]) -> tuple[Scene, Look]:
    """Read a scene file; InputError names the file, the entry and what was expected.

    Tables: [sample] with `name` (built in) or `material` (a file, relative to the scene file), and
    [shape], [lamp], [eye], [display], [look] with the fields of the classes in scene.py.
    """
    text = read_text(path, MAX_BYTES, "a scene file (TOML)")
    try:
        return _scene(tomllib.loads(text), Path(path).parent)
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{path}: not TOML: {error}") from error
    except RecursionError as error:
        raise InputError(f"{path}: lists or tables are nested too deeply") from error
    except ValueError as error:  # a whole number longer than Python reads
        raise InputError(f"{path}: a number has too many digits") from error
    except InputError as error:
        raise InputError(f"{path}: {error}") from error


def _scene(content: Mapping[str, Any], folder: Path) -> tuple[Scene, Look]:
    unknown = set(content) - set(TABLES) - {"sample"}
    if unknown:
        known = ", ".join(["sample", *TABLES])
        raise InputError(f"[{sorted(unknown)[0]}]: no such table; expected {known}")
    sample = content.get("sample", {})
    if not isinstance(sample, dict) or set(sample) - {"name", "material"} or len(sample) > 1:
        raise InputError("[sample]: expected either name or material")
    if "material" in sample:
        material = load_material(folder / str(sample["material"]))
    else:
        material = load_sample(str(sample.get("name", DEFAULT_SAMPLE)))
    parts = {name: build(name, content.get(name, {})) for name in TABLES}
    parts["lamp"] = _beside(parts["lamp"], folder)
    look = parts.pop("look")
    return Scene(material, **parts), look


def _beside(lamp: Lamp, folder: Path) -> Lamp:
    """The lamp with its file, if it has one, taken from the scene's folder."""
    if is_lamp_name(lamp.illuminant):
        return lamp
    file = str(folder / lamp.illuminant)
    illuminant(file)  # a fault is told with the place of the scene
    return dataclasses.replace(lamp, illuminant=file)


def build(name: str, values: object) -> Any:
    """One part of a scene from a table of values; InputError names the entry."""
    kind = TABLES[name]
    if not isinstance(values, dict):
        raise InputError(f"[{name}]: expected a table")
    for key in values:
        if key not in {f.name for f in dataclasses.fields(kind)}:
            known = ", ".join(f.name for f in dataclasses.fields(kind))
            raise InputError(f"{name}.{key}: no such entry; expected one of {known}")
    try:
        return kind(**{key: _frozen(value) for key, value in values.items()})
    except (OverflowError, ValueError) as error:  # a whole number beyond every float
        raise InputError(f"[{name}]: a number is too large") from error


def _frozen(value: object) -> object:
    return tuple(_frozen(v) for v in value) if isinstance(value, list) else value
