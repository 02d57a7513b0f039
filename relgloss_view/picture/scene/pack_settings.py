"""Settings of a pack as words of a command line: `--set finish.NAME.k=2`, and back."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable, text
from relgloss_view.base.toml import AUTO, build_part, plain
from relgloss_view.pack.built_in import FINISHES, PAPERS
from relgloss_view.pack.finish_plates import with_right_plates
from relgloss_view.pack.masks import check_masks
from relgloss_view.pack.pack import Pack, Placement
from relgloss_view.pack.pack_file import finish_material, read_pack
from relgloss_view.pack.quick import quick_pack
from relgloss_view.pack.shape import Shape

FINISH_SETTINGS = ("kind", "material", "mask", "invert", "sigma_n_deg", "k")
PACK_SETTINGS = ("colour", "measured")
#: Share of ambient light in a new picture of a pack; and the word that takes it away, which copied
#: commands begin with.
PACK_AMBIENT = 0.3
NO_AMBIENT = "lamp.ambient=0.0"
_OF_FINISH = re.compile(r"finish\.(.+)\.(\w+)=(.*)", re.DOTALL)
_OF_PACK = re.compile(r"(pack|placement)\.(\w+)=(.*)", re.DOTALL)


def pack_settings(settings: Sequence[str]) -> tuple[list[str], list[str]]:
    """Settings of a pack, and the others."""
    of_pack = [one for one in settings if _OF_FINISH.fullmatch(one) or _OF_PACK.fullmatch(one)]
    return of_pack, [one for one in settings if one not in of_pack]


def with_pack_settings(pack: Pack, settings: Sequence[str]) -> Pack:
    """The pack after words such as finish.ink.k=2, placement.turn_deg=90 and pack.colour=spectral.

    Raises InputError, which names the wrong word.
    """
    from relgloss_view.picture.scene.options import read_value

    for setting in settings:
        of_finish, of_pack = _OF_FINISH.fullmatch(setting), _OF_PACK.fullmatch(setting)
        try:
            if of_finish is not None:
                name, entry, written = of_finish.groups()
                pack = pack.with_finish(name, **_finish_entries(entry, read_value(written)))
            elif of_pack is not None and of_pack[1] == "placement":
                values = {**dataclasses.asdict(pack.placement), of_pack[2]: read_value(of_pack[3])}
                placement = build_part(Placement, "placement", values)
                pack = dataclasses.replace(pack, placement=placement)
            elif of_pack is not None:
                if of_pack[2] not in PACK_SETTINGS:
                    raise InputError(f"expected pack.ENTRY with one of {', '.join(PACK_SETTINGS)}")
                changed: dict[str, Any] = {of_pack[2]: read_value(of_pack[3])}
                pack = dataclasses.replace(pack, **changed)
        except InputError as error:
            raise InputError(f"--set {printable(setting, 80)}: {error}") from error
    if settings:
        check_masks(pack)
        pack = with_right_plates(pack)
    return pack


def _finish_entries(entry: str, value: object) -> dict[str, Any]:
    if entry not in FINISH_SETTINGS:
        raise InputError(f"expected finish.NAME.ENTRY with one of {', '.join(FINISH_SETTINGS)}")
    if entry == "material":
        source, material = finish_material(text(value, entry), Path())
        return {"source": source, "material": material}
    if entry == "sigma_n_deg" and value == AUTO:
        return {entry: None}
    if entry == "invert":
        if str(value).lower() not in ("true", "false"):
            raise InputError(f"invert: expected true or false, found {printable(value, 40)}")
        return {entry: str(value).lower() == "true"}
    if entry == "k":
        return {entry: value, "keeps_k": True}
    return {entry: value}


def pack_words(pack: Pack) -> list[str]:
    """Words of a command line that give this pack: its file, and what is changed since.

    Raises InputError where no file holds it, or a change has no word.
    """
    from relgloss_view.base import shell
    from relgloss_view.picture.scene.options import SET, pasted_name, written_value

    if pack.file:
        words = shell.option("--pack", pasted_name(str(Path(pack.file).absolute())))
        saved = read_pack(pack.file)
    elif pack.artwork is not None and pack.artwork.file and pack.shape.kind != "mesh":
        file = pasted_name(str(Path(pack.artwork.file).absolute()))
        words = [*shell.option("--artwork", file), "--form", pack.shape.kind]
        for entry, value in pack.artwork_entries:
            words += shell.option(f"--{entry.replace('_', '-')}", written_value(value, entry))
        given = dict(pack.artwork_entries)
        saved = quick_pack(pack.artwork.file, pack.shape.kind, given=given)
    else:
        raise InputError(f"the pack {printable(pack.name, 60)!r} is in no file; save it first")
    kept = pack.artwork_entries == saved.artwork_entries
    if not kept or [f.name for f in pack.finishes] != [f.name for f in saved.finishes]:
        raise InputError(
            f"the pack {printable(pack.name, 60)!r} has changed since it was saved; save it again"
        )
    settings = _differences(pack, saved)
    for setting in (NO_AMBIENT, *settings):
        words += [SET, setting]
    return words


def _differences(pack: Pack, saved: Pack) -> list[str]:
    from relgloss_view.picture.scene.options import written_value

    changed = []
    for now, before in zip(pack.finishes, saved.finishes, strict=True):
        for entry in FINISH_SETTINGS:
            name = "source" if entry == "material" else entry
            value = getattr(now, name)
            if value == getattr(before, name):
                continue
            if entry == "material":
                if not value:
                    raise InputError(
                        f"finish {printable(now.name, 60)!r}: its material is in no file; "
                        "save it first"
                    )
                if value not in FINISHES and value not in PAPERS:
                    value = str(Path(value).absolute())
            if isinstance(value, bool):
                changed.append(f"finish.{now.name}.{entry}={str(value).lower()}")
            else:
                changed.append(f"finish.{now.name}.{entry}={written_value(value)}")
    for f in dataclasses.fields(Placement):
        value = getattr(pack.placement, f.name)
        if value != getattr(saved.placement, f.name):
            changed.append(f"placement.{f.name}={written_value(plain(value))}")
    changed += [
        f"pack.{entry}={getattr(pack, entry)}"
        for entry in PACK_SETTINGS
        if getattr(pack, entry) != getattr(saved, entry)
    ]
    for f in dataclasses.fields(Shape):
        value = getattr(pack.shape, f.name)
        if value != getattr(saved.shape, f.name):
            changed.append(f"shape.{f.name}={written_value(plain(value))}")
    return changed
