"""Packs as samples of a study: what a session keeps of one, and how it is drawn again.

An artwork is too large for a session file. The session keeps the pack's tables with the places of
its files, and a digest of all that is drawn. Where a file has changed or is gone, answers can
still be analysed, and nothing is drawn.
"""

from __future__ import annotations

import dataclasses
import hashlib
import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable, read_bytes
from relgloss_view.base.toml import entries, plain
from relgloss_view.gloss.match import Reference
from relgloss_view.gloss.pack_match import match_pack
from relgloss_view.gloss.pose import pose_of
from relgloss_view.material.files import material_to_dict
from relgloss_view.pack import forms
from relgloss_view.pack.pack import Pack
from relgloss_view.pack.pack_file import beside, pack_of_tables, pack_tables
from relgloss_view.pack.plain_finish import plain_finishes
from relgloss_view.picture.model import tone
from relgloss_view.picture.scene.sample import Sample
from relgloss_view.picture.scene.setup import Setup

ROOT = Path("/")  #: files are named from here, so that a session may be moved
MOST_BYTES = 1 << 30  #: of a file of a pack


def prepared(sample: Sample, setup: Setup) -> Sample:
    """A pack whose finishes keep their ratios of gloss in the study's view, with every k its own.

    Graininess stays as the pack has it: finishes without any follow the grid.
    """
    if sample.pack is None:
        return sample
    on_form = dataclasses.replace(setup, shape=sample.pack.shape)
    found = match_pack(Reference.default(), sample.pack, setup=on_form)
    finishes = tuple(
        dataclasses.replace(own, k=matched.k, keeps_k=True)
        for own, matched in zip(sample.pack.finishes, found.finishes, strict=True)
    )
    return dataclasses.replace(sample, pack=dataclasses.replace(sample.pack, finishes=finishes))


def pack_to_dict(pack: Pack) -> dict[str, Any]:
    """What a session keeps; InputError where a part of the pack is in no file."""
    here = _absolute(pack)
    return {"tables": pack_tables(here, ROOT), "name": pack.name, "digest": pack_digest(pack)}


def pack_from_dict(content: Mapping[str, Any]) -> Pack:
    """The pack of pack_to_dict; InputError where it is another than then, or its files are gone."""
    made = pack_of_tables(content["tables"], ROOT)
    # Masks are named from the folder of the pack's file, which here is the root.
    made = dataclasses.replace(made, name=content["name"], file=str(ROOT / "pack.toml"))
    if pack_digest(made) != content["digest"]:
        raise InputError(
            f"the pack {printable(content['name'], 60)!r} is another than when the study began: "
            "put the former files back"
        )
    return made


def pack_digest(pack: Pack) -> str:
    """SHA-256 of what decides how a pack is drawn, wherever its files lie."""
    names = [f.name for f in dataclasses.fields(pack.shape) if f.name != "file"]
    shape = _entries(pack.shape, names)
    finishes = [
        {
            **_entries(f, ("name", "kind", "invert", "sigma_n_deg", "k")),
            "material": material_to_dict(f.material),
            "mask": None if f.mask in pack.masks else f.mask,
        }
        for f in pack.finishes
    ]
    given = {key: plain(value) for key, value in pack.artwork_entries if key != "profile"}
    rules = [shape, entries(pack.placement), pack.colour, pack.measured, finishes, given]
    digest = hashlib.sha256(json.dumps(rules, sort_keys=True).encode("utf-8"))
    if pack.shape.kind == "mesh":
        mesh = forms.mesh_of(pack.shape)
        assert mesh is not None
        digest.update(json.dumps([mesh.parts, mesh.printed]).encode("utf-8"))
        for array in (mesh.points_m, mesh.normals, mesh.triangles, mesh.label_m, mesh.part):
            digest.update(b"mesh" + array.tobytes())
    for file in _files(pack):
        data = read_bytes(file, MOST_BYTES, "a file of a pack")
        digest.update(hashlib.sha256(data).digest())
    return digest.hexdigest()


def full_c_of_pack(pack: Pack, setup: Setup) -> float:
    """c_max of a pack in a setup: that of its finishes which a picture of them has first."""
    pose = pose_of(dataclasses.replace(setup, shape=pack.shape))
    limits = [1.0]
    for one in plain_finishes(pack, setup.lamp.illuminant):
        extremes = pose.extremes(one.material)
        if one.shines and one.finish.k > 0.0 and extremes.l_s_max >= tone.NO_LOBE_LSTAR:
            limits.append(extremes.smallest_ratio / one.finish.k)
    return min(limits[1:] or limits)


def _files(pack: Pack) -> list[str]:
    """The files of artwork, profile and masks, in their order."""
    files = [] if pack.artwork is None else [pack.artwork.file]
    profile = dict(pack.artwork_entries).get("profile")
    named = [] if profile is None else [str(profile)]
    named += [f.mask for f in pack.finishes if f.mask in pack.masks]
    return files + [file for file in (beside(pack, n) for n in named) if Path(file).is_file()]


def _absolute(pack: Pack) -> Pack:
    """The pack with its own file named from the root, so that its masks are found from there."""
    return dataclasses.replace(pack, file=str(Path(pack.file).absolute()) if pack.file else "")


def _entries(part: object, names: Iterable[str]) -> dict[str, Any]:
    values = {name: getattr(part, name) for name in names}
    return {name: None if value is None else plain(value) for name, value in values.items()}
