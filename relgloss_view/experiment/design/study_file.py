"""Study files (TOML), and studies as the session file keeps them: whole, with their materials.

The tables of a study file are those of a scene file, and [[samples]], [grid], [procedure],
[adaptive], [screen] and [study]. Format in docs/files.md.
"""

from __future__ import annotations

import dataclasses
import hashlib
import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import numbers_of, printable, refuse
from relgloss_view.base.resources import asset
from relgloss_view.base.toml import build_part, entries, read_toml
from relgloss_view.display.display import Display
from relgloss_view.display.kept_file import KeptFile, keep_file
from relgloss_view.display.read import monitor_of
from relgloss_view.experiment.design.grid import Grid, share_of
from relgloss_view.experiment.design.study import Adaptive, Procedure, Screen, Study, StudySample
from relgloss_view.experiment.design.study_packs import pack_from_dict, pack_to_dict, prepared
from relgloss_view.material.files import material_from_dict, material_to_dict
from relgloss_view.material.lamp_file import lamp_text
from relgloss_view.material.spectra import is_lamp_name
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.sample import DEFAULT_SAMPLE, SAMPLES, Sample
from relgloss_view.picture.scene.scene_file import (
    DISPLAY_FILES,
    FURTHER_LAMP,
    TABLES,
    build,
    display_beside,
    further_lamps,
    lamp_beside,
    read_sample,
    shape_beside,
)
from relgloss_view.picture.scene.setup import Setup

MAX_BYTES = 1024 * 1024
EXPECTED = "a study file (TOML)"
PARTS: dict[str, type[Any]] = {"procedure": Procedure, "adaptive": Adaptive, "screen": Screen}
#: Entries that earlier versions did not have. At their defaults they are no part of the digest, so
#: that a session continues with the study that it was begun with.
ADDED = {"display": ("pixel_pitch_mm", "viewing_distance_m"), "look": ("grain_arcmin",)}
WORDS = ("title", "categories", "consent", "instructions")  #: the entries of [study]
KEPT_FILES = "display_files"  #: the files that [display] names, by entry
BUILT_IN = ("paper",)  #: studies by name


def load_study(
    path: str | os.PathLike[str], changes: Mapping[str, Mapping[str, object]] | None = None
) -> Study:
    """Read a study file, or a built-in study by name; InputError names file and entry.

    changes: entries by table that count instead of the file's.
    """
    if is_built_in(path):
        path = built_in_file(os.fspath(path))
    elif os.fspath(path).lower().endswith(".html"):
        raise InputError(
            f"{path}: a proof is no study; `relgloss experiment new --proof FILE.html -o "
            "STUDY.toml` makes one of it"
        )
    content = read_toml(path, MAX_BYTES, EXPECTED)
    try:
        for table, entries_ in (changes or {}).items():
            present = content.setdefault(table, {})
            if not isinstance(present, dict):
                raise InputError(f"[{table}]: its entries can't be set from outside")
            present |= entries_
        return _study(content, Path(path).parent)
    except InputError as error:
        raise InputError(f"{path}: {error}") from error


def is_built_in(path: str | os.PathLike[str]) -> bool:
    """Whether this names a built-in study, and no file."""
    return os.fspath(path) in BUILT_IN and not os.path.lexists(path)


def built_in_file(name: str) -> Path:
    """Where the file of a built-in study lies."""
    return Path(str(asset("studies", f"{name}.toml")))


def _study(content: Mapping[str, Any], folder: Path) -> Study:
    tables = ("study", "samples", "reference", "grid", *PARTS, *TABLES, FURTHER_LAMP)
    for name in content:
        if name not in tables:
            unknown = printable(name, 60)
            raise InputError(f"[{unknown}]: no such table; expected one of {', '.join(tables)}")
    words = _entries(content, "study", WORDS)
    if "categories" in words:
        if not isinstance(words["categories"], list):
            refuse("study.categories", "a list of names", words["categories"])
        words["categories"] = tuple(words["categories"])
    parts = {name: build(name, content.get(name, {})) for name in TABLES}
    parts["lamp"] = lamp_beside(parts["lamp"], folder, None)
    parts["shape"] = shape_beside(parts["shape"], folder, None)
    parts["display"] = display_beside(parts["display"], folder, None)
    for entry in ("sigma_n_deg", "c", "c_fraction"):
        if entry in content.get("look", {}):
            raise InputError(f"look.{entry}: the settings come from [grid]; leave it out here")
    reference, reference_look = _reference(content.get("reference", {}), folder)
    setup = Setup(
        **{name: part for name, part in parts.items() if name != "look"},
        further_lamps=further_lamps(content),
    )
    return Study(
        _samples(content.get("samples"), folder, setup),
        reference,
        reference_look,
        grid=_grid(_entries(content, "grid", ("sigma_n_deg", "c_fraction"))),
        **words,
        **{name: build_part(kind, name, content.get(name, {})) for name, kind in PARTS.items()},
        look=parts["look"],
        setup=setup,
    )


def _entries(content: Mapping[str, Any], table: str, names: tuple[str, ...]) -> dict[str, Any]:
    values = content.get(table, {})
    if not isinstance(values, dict):
        refuse(f"[{table}]", "a table", values)
    for key in values:
        if key not in names:
            unknown = printable(key, 60)
            raise InputError(
                f"{table}.{unknown}: no such entry; expected one of {', '.join(names)}"
            )
    return dict(values)


def _study_sample(place: str, entries: dict[str, Any], folder: Path) -> Sample:
    """The sample of a table; InputError where it names none."""
    sample = read_sample(place, entries, folder, None)
    if sample is None:
        raise InputError(f"{place}: expected a name, a material or a pack")
    return sample


def _reference(values: object, folder: Path) -> tuple[Sample, Look]:
    """The sample and look of the reference picture: those of the paper where the file has none."""
    if not isinstance(values, dict):
        refuse("[reference]", "a table", values)
    of_sample = dict(values)
    look = build("look", of_sample.pop("look", {}), "reference.")
    if look.c is None and look.c_fraction is None:
        look = dataclasses.replace(look, c_fraction=1.0)
    of_sample = of_sample or {"name": next(iter(SAMPLES))}
    sample = _study_sample("[reference]", of_sample, folder)
    if sample.pack is not None:
        raise InputError(
            "[reference]: a pack has several finishes, so it can't be the reference; name a "
            "material"
        )
    return sample, look


def _samples(values: object, folder: Path, setup: Setup) -> tuple[StudySample, ...]:
    if values is None:  # the paper's three
        values = [{"name": name} for name in list(SAMPLES)[1:]]
    if not isinstance(values, list):
        refuse("samples", f"[[samples]], each with a name such as {DEFAULT_SAMPLE!r}", values)
    made = []
    for k, value in enumerate(values):
        place = f"samples[{k}]"
        if not isinstance(value, dict):
            refuse(place, "a table", value)
        of_sample = dict(value)
        label = of_sample.pop("label", None)
        sample = _study_sample(place, of_sample, folder)
        if label is None:
            named = sample.material.name if sample.pack is None else sample.pack.name
            label = sample.name or printable(named, 60)
        made.append(_judged(place, label, sample, setup))
    return tuple(made)


def _judged(place: str, label: str, sample: Sample, setup: Setup) -> StudySample:
    if sample.pack is None:
        return StudySample(label, sample)
    made = prepared(sample, setup)
    assert made.pack is not None
    try:
        digest = pack_to_dict(made.pack)["digest"]
    except InputError as error:
        raise InputError(f"{place}: {error}") from error
    return StudySample(label, made, digest)


def _grid(values: Mapping[str, Any]) -> Grid:
    made: dict[str, tuple[float, ...]] = {}
    if "sigma_n_deg" in values:
        made["sigma_n_deg"] = numbers_of(
            values["sigma_n_deg"], "grid.sigma_n_deg", "0 to 10 deg", 0.0, 10.0
        )
    if "c_fraction" in values:
        shares = values["c_fraction"]
        if not isinstance(shares, list):
            refuse("grid.c_fraction", "a list of shares of c_max, such as ['1/6', 0.5, 1]", shares)
        made["c_fraction"] = tuple(
            share_of(value, f"grid.c_fraction[{k}]") for k, value in enumerate(shares)
        )
    return Grid(**made)


def study_to_dict(study: Study) -> dict[str, Any]:
    """The study as JSON holds it, whole: materials, a lamp's table, a display's files are inside.

    Raises InputError where a display's file can't be read any more.
    """
    lamp, lamps = study.setup.lamp.illuminant, study.setup.further_lamps
    return {
        "study": {name: _plain(getattr(study, name)) for name in WORDS},
        "samples": [
            {"label": s.label, **_sample_to_dict(s.sample), **_pack_part(s)} for s in study.samples
        ],
        "reference": {
            **_sample_to_dict(study.reference), "look": entries(study.reference_look)
        },
        "grid": {name: list(getattr(study.grid, name)) for name in ("sigma_n_deg", "c_fraction")},
        **{name: entries(getattr(study, name)) for name in PARTS},
        **{name: entries(part) for name, part in study.setup.parts().items()},
        **({FURTHER_LAMP: [entries(k) for k in lamps]} if lamps else {}),
        "look": entries(study.look),
        "lamp_table": None if is_lamp_name(lamp) else lamp_text(lamp),
        **_kept_files(study.setup.display),
    }  # fmt: skip


def study_from_dict(content: Mapping[str, Any], lamp_folder: Path) -> Study:
    """The study of study_to_dict. Files of lamp and display are put into a folder for drawing."""
    reference = content["reference"]
    parts = {name: build(name, content[name]) for name in TABLES}
    if content["lamp_table"] is not None:
        data = content["lamp_table"].encode("utf-8")
        file = lamp_folder / f"lamp-{hashlib.sha256(data).hexdigest()[:16]}.csv"
        if not file.exists():
            file.write_bytes(data)
        parts["lamp"] = dataclasses.replace(parts["lamp"], illuminant=str(file))
    parts["display"] = _with_files(parts["display"], content.get(KEPT_FILES, {}), lamp_folder)
    words = dict(content["study"])
    words["categories"] = tuple(words["categories"])
    return Study(
        tuple(_judged_from_dict(s) for s in content["samples"]),
        _sample_from_dict(reference),
        build("look", reference["look"], "reference."),
        grid=Grid(**{name: tuple(values) for name, values in content["grid"].items()}),
        **words,
        **{name: build_part(kind, name, content[name]) for name, kind in PARTS.items()},
        look=parts.pop("look"),
        setup=Setup(**parts, further_lamps=further_lamps(content)),
    )


def study_digest(content: Mapping[str, Any]) -> str:
    """What tells one study from another: the same for all that is drawn and asked alike."""
    seen = json.loads(json.dumps(content))
    for sample in (*seen["samples"], seen["reference"]):
        sample.pop("file")
        if "pack" in sample:  # its files may lie elsewhere
            sample["pack"] = sample["pack"]["digest"]
    for table, names in ADDED.items():
        for part in (seen[table], seen["reference"].get(table, {})):
            for name in names:
                if part.get(name) == TABLES[table].__dataclass_fields__[name].default:
                    part.pop(name)
    if seen["lamp_table"] is not None:
        seen["lamp"].pop("illuminant")  # where the table lies
    for entry, kept in seen.get(KEPT_FILES, {}).items():
        seen["display"].pop(entry)  # where the file lies
        seen[KEPT_FILES][entry] = KeptFile.from_dict(kept).digest
    return hashlib.sha256(json.dumps(seen, sort_keys=True).encode("utf-8")).hexdigest()


def _kept_files(display: Display) -> dict[str, Any]:
    files = {entry: keep_file(file) for entry in DISPLAY_FILES if (file := getattr(display, entry))}
    return {KEPT_FILES: {entry: file.to_dict() for entry, file in files.items()}} if files else {}


def _with_files(display: Display, kept: Mapping[str, Any], folder: Path) -> Display:
    """The display with its kept files in a folder; never with one that lies elsewhere."""
    if set(kept) != {entry for entry in DISPLAY_FILES if getattr(display, entry)}:
        raise InputError("display: its files are not those that are kept")
    put = {entry: KeptFile.from_dict(file).put_into(folder) for entry, file in kept.items()}
    for file in put.values():
        monitor_of(file)  # a damaged one is reported here
    return dataclasses.replace(display, **put)  # type: ignore[arg-type]


def _sample_to_dict(sample: Sample) -> dict[str, Any]:
    file = None if sample.file is None else str(Path(sample.file).absolute())
    return {"name": sample.name, "file": file, "material": material_to_dict(sample.material)}


def _sample_from_dict(content: Mapping[str, Any]) -> Sample:
    material = material_from_dict(content["material"])
    return Sample(material, name=content["name"], file=content["file"])


def _pack_part(sample: StudySample) -> dict[str, Any]:
    pack = sample.sample.pack
    return {} if pack is None else {"pack": pack_to_dict(pack)}


def _judged_from_dict(content: Mapping[str, Any]) -> StudySample:
    sample = _sample_from_dict(content)
    if "pack" not in content:
        return StudySample(content["label"], sample)
    digest = content["pack"]["digest"]
    try:
        made = dataclasses.replace(sample, pack=pack_from_dict(content["pack"]))
    except InputError as error:
        return StudySample(content["label"], sample, digest, str(error))
    return StudySample(content["label"], made, digest)


def _plain(value: object) -> object:
    return list(value) if isinstance(value, tuple) else value
