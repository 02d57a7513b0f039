"""Pack files (TOML): a form, an artwork and finishes. Reading, and writing without loss."""

from __future__ import annotations

import dataclasses
import os
import weakref
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import number, numbers_of, printable, refuse, text
from relgloss_view.base.terminal import ProgressReport, no_progress
from relgloss_view.base.toml import build_part, entries, plain, read_toml, table_of, write_toml
from relgloss_view.material.files import load_material
from relgloss_view.material.material import Material
from relgloss_view.pack.artwork.artwork import Artwork
from relgloss_view.pack.built_in import FINISHES, PAPERS, load_finish
from relgloss_view.pack.finish import MAX_FINISHES, Finish
from relgloss_view.pack.finish_plates import has_right_plates, named_plates, with_right_plates
from relgloss_view.pack.forms.mesh_files import MESH_SUFFIXES
from relgloss_view.pack.kinds import ARTWORK as ARTWORK_FILE
from relgloss_view.pack.kinds import kind_of_pack, pack_path
from relgloss_view.pack.mask_file import read_mask
from relgloss_view.pack.masks import ARTWORK, CHANNEL, EVERYWHERE, PART, PLATE, check_masks
from relgloss_view.pack.pack import Pack, Placement
from relgloss_view.pack.quick import finishes_of_artwork, usual_placement
from relgloss_view.pack.shape import SHAPES, Shape

MAX_BYTES = 1024 * 1024
EXPECTED = "a pack file (TOML)"
PACK, FINISH = "pack", "finish"
ARTWORK_ENTRIES = ("profile", "page", "dpi", "width_mm", "intent")  #: how the artwork is read
PACK_ENTRIES = (
    "name", "form", "artwork", *ARTWORK_ENTRIES, "colour", "measured", "placement",
)  # fmt: skip
FINISH_ENTRIES = ("name", "kind", "material", "mask", "invert", "sigma_n_deg", "k")


def read_pack(path: str | os.PathLike[str], progress: ProgressReport = no_progress) -> Pack:
    """Read a pack file, or a shipped pack by its name ("can", "carton").

    Files that it names are looked for in its folder.
    Raises InputError, one line that names the file, the entry and what was expected.

    >>> [finish.name for finish in read_pack("carton").finishes]
    ['soft touch', 'spot gloss', 'gold foil']
    """
    path = pack_path(path)
    if kind_of_pack(path) == ARTWORK_FILE:
        raise InputError(
            f"{path}: this is an artwork; draw it with --artwork, or write its pack file with "
            "`relgloss pack new`"
        )
    tables = read_toml(path, MAX_BYTES, EXPECTED)
    try:
        unknown = set(tables) - {PACK, FINISH}
        if unknown:
            raise InputError(
                f"[{printable(min(unknown), 60)}]: no such table; expected [pack] and [[finish]]"
            )
        if PACK not in tables:
            raise InputError("expected a table [pack]")
        pack = pack_of_tables(tables, Path(path).parent, progress)
    except InputError as error:
        raise InputError(f"{path}: {error}") from error
    # A file's name may hold bytes that no text can.
    name = pack.name or printable(os.fsencode(Path(path).stem).decode("utf-8", "replace"), 120)
    return dataclasses.replace(pack, file=str(path), name=name)


def pack_of_tables(
    tables: Mapping[str, Any], folder: Path, progress: ProgressReport = no_progress
) -> Pack:
    """The pack of the tables `pack` and `finish` of a pack file or a scene. Raises InputError."""
    table = table_of(PACK, tables.get(PACK, {}))
    _check_entries(table, PACK_ENTRIES, PACK)
    shape = shape_named(table.get("form", "can"), folder)
    given = {key: table[key] for key in ARTWORK_ENTRIES if key in table}
    artwork, artwork_file = None, text(table.get("artwork", ""), "pack.artwork")
    finishes: tuple[Finish, ...] = ()
    masks: dict[str, Any] = {}
    if FINISH in tables:
        finishes, masks = _finishes(tables[FINISH], folder)
    if artwork_file:
        how = {**given, "finish_plates": named_plates(finishes)}
        artwork = open_artwork(folder / artwork_file, how, folder, progress)
    elif given:
        raise InputError(f"pack.{next(iter(given))}: expected an artwork beside it")
    notes: tuple[str, ...] = ()
    if not finishes:
        finishes, notes = finishes_of_artwork(artwork, shape)
    placement = build_part(Placement, "placement", table.get("placement", {}), "pack.")
    if artwork is not None and "placement" not in table and FINISH not in tables:
        placement, more = usual_placement(artwork, shape)
        notes += more
    pack = Pack(
        text(table.get("name", ""), "pack.name"),
        shape,
        finishes,
        artwork,
        placement,
        masks=masks,
        artwork_file=artwork_file,
        artwork_entries=tuple(given.items()),
        notes=notes,
        **{key: table[key] for key in ("colour", "measured") if key in table},
    )
    check_masks(pack)
    return with_right_plates(pack, progress)


def _check_entries(table: Mapping[str, Any], names: tuple[str, ...], place: str) -> None:
    for key in table:
        if key not in names:
            raise InputError(
                f"{place}.{printable(key, 60)}: no such entry; expected one of {', '.join(names)}"
            )


def shape_named(form: object, folder: Path) -> Shape:
    """The shape of `form = "can"`, of a mesh file's name, or of a table [pack.form]."""
    if isinstance(form, str):
        if form.lower().endswith(MESH_SUFFIXES):
            return Shape("mesh", file=str(folder / text(form, "pack.form")))
        if form not in SHAPES or form == "mesh":
            names = ", ".join(name for name in SHAPES if name != "mesh")
            refuse("pack.form", f"one of {names}, a mesh file, or a table [pack.form]", form)
        return Shape(form)
    values = dict(table_of("pack.form", form))
    if "profile_mm" in values:
        values["profile_mm"] = _profile(values["profile_mm"])
    if "file" in values:
        values["file"] = str(folder / text(values["file"], "pack.form.file"))
        values.setdefault("kind", "mesh")
    if not isinstance(values.get("kind", "can"), str):
        refuse("pack.form.kind", f"one of {', '.join(SHAPES)}", values["kind"])
    if (values.get("kind") == "mesh") != ("file" in values):
        raise InputError('pack.form: expected kind = "mesh" and a file together')
    try:
        shape: Shape = build_part(Shape, "form", {"kind": "can", **values}, "pack.")
    except InputError as error:
        raise InputError(str(error).replace("pack.shape.", "pack.form.", 1)) from None
    return shape


def _profile(values: object) -> list[tuple[float, ...]]:
    """Points (radius, height) of a profile, millimetres."""
    place = "pack.form.profile_mm"
    if not isinstance(values, list) or len(values) < 2:
        refuse(place, "a list of two or more [radius, height]", values)
    points = []
    for k, point in enumerate(values):
        if not isinstance(point, list) or len(point) != 2:
            refuse(f"{place}[{k}]", "[radius, height] in millimetres", point)
        points.append(numbers_of(point, f"{place}[{k}]", "millimetres, 0 to 10000", 0.0, 1e4))
    return points


#: Artworks by file, stamp, entries and plates of finishes, while a pack holds them: a scene is read
#: more than once.
_ARTWORKS: weakref.WeakValueDictionary[tuple[Any, ...], Artwork] = weakref.WeakValueDictionary()


def open_artwork(
    file: Path,
    given: Mapping[str, Any],
    folder: Path,
    progress: ProgressReport = no_progress,
    *,
    within: str = "pack.",
) -> Artwork:
    """The artwork of a file, read with the entries of a pack file; InputError names the entry.

    within: goes before the entry's name in messages.

    An artwork that is held and whose file is unchanged is the same object.
    """
    from relgloss_view.pack.artwork.options import ArtworkOptions
    from relgloss_view.pack.artwork.read import read_artwork

    values = dict(given)
    if "profile" in values:
        beside_it = folder / text(values["profile"], f"{within}profile")
        values["profile"] = str(beside_it) if _is_regular(beside_it) else values["profile"]
    try:
        options = build_part(ArtworkOptions, "pack", values)
    except InputError as error:
        raise InputError(str(error).replace("artworkoptions.", within, 1)) from None
    profile = values.get("profile")
    alike = repr(dataclasses.replace(options, finish_plates=()))
    key = (*_stamp(file), *(_stamp(Path(profile)) if profile else ()), alike)
    for (*other, _), artwork in list(_ARTWORKS.items()):
        if tuple(other) == key and has_right_plates(artwork, options.finish_plates):
            return artwork
    artwork = read_artwork(file, options, progress)
    _ARTWORKS[(*key, artwork.finish_plates)] = artwork
    return artwork


def _is_regular(file: Path) -> bool:
    try:
        return file.is_file()
    except (OSError, ValueError):  # an impossible name
        return False


def _stamp(file: Path) -> tuple[object, ...]:
    try:
        state = os.stat(file)
    except (OSError, ValueError):
        return (str(file), None)
    return (os.path.realpath(file), state.st_mtime_ns, state.st_size)


def _finishes(tables: object, folder: Path) -> tuple[tuple[Finish, ...], dict[str, Any]]:
    """The finishes of [[finish]], and the masks that are files, by their words."""
    if not isinstance(tables, list) or not tables:
        refuse("finish", "tables [[finish]]", tables)
    if len(tables) > MAX_FINISHES:
        raise InputError(
            f"[[finish]]: expected at most {MAX_FINISHES} finishes, found {len(tables)}"
        )
    finishes: list[Finish] = []
    masks: dict[str, Any] = {}
    for k, table in enumerate(tables, 1):
        place = f"[[finish]] {k}"
        if not isinstance(table, dict):
            refuse(place, "a table", table)
        if isinstance(table.get("name"), str):
            place += f" ({printable(table['name'], 40)})"
        try:
            finish = finish_of_table(table, folder, first=k == 1)
            if _is_file(finish.mask) and finish.mask not in masks:
                if not Path(finish.mask).suffix and not (folder / finish.mask).exists():
                    refuse(
                        "mask",
                        f"a picture's file, or {PLATE}NAME of a plate, {CHANNEL}NAME, {PART}NAME, "
                        f"{ARTWORK}, {EVERYWHERE}",
                        finish.mask,
                    )
                masks[finish.mask] = read_mask(folder / finish.mask)
        except InputError as error:
            raise InputError(f"{place}: {error}") from error
        finishes.append(finish)
    return tuple(finishes), masks


def finish_of_table(table: Mapping[str, Any], folder: Path, *, first: bool) -> Finish:
    """A finish from the entries of a table [[finish]]; InputError names the entry."""
    _check_entries(table, FINISH_ENTRIES, FINISH)
    if "material" not in table:
        names = ", ".join((*FINISHES, *PAPERS))
        raise InputError(f"material: expected a material file (JSON), or one of {names}")
    source = text(table["material"], "material")
    values = {key: table[key] for key in ("kind", "invert", "sigma_n_deg", "k") if key in table}
    if not isinstance(values.get("invert", False), bool):
        refuse("invert", "true or false", values["invert"])
    if "kind" not in values:
        kind = FINISHES.get(source, "ink")
        values["kind"] = "ink" if first and kind == "varnish" else kind
    if "k" in values:
        values["keeps_k"] = True  # a match leaves a factor as the file gives it
    mask = text(table.get("mask", ""), "mask")
    source, material = finish_material(source, folder)
    name = text(table.get("name", Path(source).stem), "name")
    if not name.strip():
        refuse("name", "a text that is not empty", name)
    try:
        return Finish(name, material=material, source=source, mask=mask, **values)
    except InputError as error:
        raise InputError(str(error).removeprefix("finish.")) from None


def finish_material(name: str, folder: Path) -> tuple[str, Material]:
    """Source and material of a finish: of a built-in name, or of a file looked for in a folder."""
    if name in FINISHES or name in PAPERS:
        return name, load_finish(name)
    if not name.lower().endswith(".json") and not _is_regular(folder / name):
        load_finish(name)  # raises the list of the names
    file = str(folder / name)
    return file, load_material(file)


def _is_file(mask: str) -> bool:
    return mask not in ("", ARTWORK, EVERYWHERE) and not mask.startswith((PLATE, CHANNEL, PART))


def write_pack(path: str | os.PathLike[str], pack: Pack) -> None:
    """Write a pack file, whole or not at all; reading it gives the same pack.

    Files under its folder are named relative to it, others by their absolute path. Raises
    InputError where it can't be written, or a part of the pack is in no file.

    >>> from relgloss_view.pack.quick import quick_pack
    >>> from PIL import Image
    >>> Image.new("RGB", (40, 20), "white").save("label.png")
    >>> write_pack("label.toml", quick_pack("label.png", "bottle"))
    >>> read_pack("label.toml").shape.kind
    'bottle'
    """
    try:
        tables = pack_tables(pack, Path(path).absolute().parent)
    except InputError as error:
        raise InputError(f"{path}: {error}") from error
    write_toml(path, tables)


def pack_tables(pack: Pack, folder: Path) -> dict[str, Any]:
    """The tables `pack` and `finish` of a pack file in a folder. Raises InputError."""
    table: dict[str, Any] = {"name": pack.name} if pack.name else {}
    table["form"] = _form_entry(pack.shape, folder)
    if pack.artwork is not None:
        if not pack.artwork.file:
            raise InputError("pack.artwork: it is in no file; save it first")
        table["artwork"] = _place(pack.artwork.file, folder, "pack.artwork")
        given = {key: plain(value) for key, value in pack.artwork_entries}
        profile = given.get("profile")
        origin = beside(pack, str(profile))
        if profile is not None and os.path.isfile(origin):
            given["profile"] = _place(origin, folder, "pack.profile")
        table |= given
    table |= {key: getattr(pack, key) for key in ("colour", "measured")}
    if pack.placement != Placement():
        table["placement"] = entries(pack.placement)
    return {PACK: table, FINISH: [_finish_entries(pack, f, folder) for f in pack.finishes]}


def _form_entry(shape: Shape, folder: Path) -> str | dict[str, Any]:
    usual = Shape(shape.kind, file=shape.file)
    if shape == usual:
        return _place(shape.file, folder, "pack.form") if shape.file else shape.kind
    table: dict[str, Any] = {"kind": shape.kind}
    for f in dataclasses.fields(shape):
        value = getattr(shape, f.name)
        if value != getattr(usual, f.name):
            table[f.name] = plain(value)
    if shape.file:
        table["file"] = _place(shape.file, folder, "pack.form.file")
    return table


def _finish_entries(pack: Pack, finish: Finish, folder: Path) -> dict[str, Any]:
    if not finish.source:
        raise InputError(
            f"finish {printable(finish.name, 60)!r}: its material is in no file; save it first"
        )
    built_in = finish.source in FINISHES or finish.source in PAPERS
    place = f"finish {printable(finish.name, 60)!r}"
    source = finish.source if built_in else _place(finish.source, folder, place)
    table: dict[str, Any] = {"name": finish.name, "kind": finish.kind, "material": source}
    if finish.mask:
        mask = finish.mask
        table["mask"] = _place(beside(pack, mask), folder, place) if _is_file(mask) else mask
    if finish.invert:
        table["invert"] = True
    if finish.sigma_n_deg is not None:
        table["sigma_n_deg"] = plain(finish.sigma_n_deg)
    if finish.k != 1.0 or finish.keeps_k:
        table["k"] = plain(number(finish.k, place, "a number", 0.0, 1e9))
    return table


def files_of(pack: Pack) -> tuple[str, ...]:
    """The files that a pack was read from: pack file, artwork, mesh, masks."""
    artwork = () if pack.artwork is None or not pack.artwork.file else (pack.artwork.file,)
    own = (pack.file,) if pack.file else ()
    mesh = (pack.shape.file,) if pack.shape.file else ()
    return (*own, *artwork, *mesh, *(beside(pack, mask) for mask in pack.masks))


def beside(pack: Pack, name: str) -> str:
    """The path of a file that a pack names, from the folder of its pack file."""
    return str(Path(pack.file).parent / name) if pack.file else name


def _place(file: str, folder: Path, place: str) -> str:
    """A file's name as the pack file writes it: relative where it lies under its folder."""
    path = Path(os.path.abspath(file))
    inside = path.relative_to(folder) if path.is_relative_to(folder) else path
    try:
        return text(inside.as_posix() if inside is not path else str(path), place)
    except InputError as error:
        raise InputError(f"{error}; its name is not UTF-8, so rename the file") from error
