"""`relgloss pack`: check a pack, write a pack file for an artwork, list the built-in finishes."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.base.terminal import Column, Progress, table, warn
from relgloss_view.base.writing import check_writable
from relgloss_view.commands.artwork_options import add_artwork_options, artwork_entries
from relgloss_view.commands.scene_options import DEFAULT_SIZE, size_of_text

if TYPE_CHECKING:
    from relgloss_view.pack.check import PackCheck
    from relgloss_view.pack.pack import Pack

METERS = ("gloss-20", "gloss-60", "gloss-85", "gloss-75")
NOTHING = "-"


def add(commands: Any) -> None:
    """Declare the command and its own commands."""
    parser = commands.add_parser(
        "pack",
        description="Check a pack or an artwork, write a pack file for an artwork, or list the "
        "built-in finishes. `relgloss snapshot --pack` draws a pack.",
        epilog="example: relgloss pack new can.pdf -o can.toml; relgloss pack check can.toml",
    )
    own = parser.add_subparsers(dest="pack_command", metavar="COMMAND", required=True)
    _add_check(own)
    _add_new(own)
    finishes = own.add_parser(
        "finishes",
        help="list the built-in finishes",
        description="List the built-in finishes with what gloss meters would read.",
    )
    finishes.add_argument("--json", action="store_true", help="Print the list as JSON")
    finishes.set_defaults(run=run_finishes)


def _add_check(own: Any) -> None:
    check = own.add_parser(
        "check",
        help="list plates, masks and finishes, and warn of what would surprise",
        description="List plates, masks and finishes of a pack, and warn of what would surprise in "
        "its picture: overlaps, empty masks, a coarse artwork, one that is too small for the "
        "label, colours that no display shows, fonts that a PDF lacks.",
        epilog="example: relgloss pack check can.toml",
    )
    check.add_argument(
        "file",
        metavar="FILE",
        help="Pack file, an artwork, or can or carton, which come with relgloss",
    )
    add_artwork_options(check, "an artwork")
    check.add_argument(
        "--size",
        metavar="WxH",
        type=size_of_text,
        default=DEFAULT_SIZE,
        help="Size of the picture that the artwork is wanted for (default 512x512)",
    )
    check.add_argument("--json", action="store_true", help="Print the check as JSON")
    check.set_defaults(run=run_check)


def _add_new(own: Any) -> None:
    new = own.add_parser(
        "new",
        help="write a pack file for an artwork",
        description="Write a pack file for an artwork: its form, and finishes by the names of its "
        "plates. Edit it, and draw it with `relgloss snapshot --pack`.",
        epilog="example: relgloss pack new can.pdf --form can -o can.toml",
    )
    new.add_argument("artwork", metavar="ARTWORK", help="PDF, PNG, JPEG, TIFF or PSD")
    add_artwork_options(new, "an artwork")
    new.add_argument(
        "-o", "--output", metavar="PACK.toml", required=True, help="Pack file to write"
    )
    new.set_defaults(run=run_new)


def run_check(args: argparse.Namespace) -> int:
    """Check a pack and print what it holds; the status is 0 unless it can't be read."""
    from relgloss_view.pack.check import check_pack
    from relgloss_view.picture.model.pixel_sampling import footprint_m
    from relgloss_view.picture.model.view import check_size
    from relgloss_view.picture.scene.sample import Sample

    size = check_size(args.size)
    pack = _pack(args.file, args)
    pixel_m = footprint_m(Sample.of_pack(pack).scene(), size)
    found = check_pack(pack, 1e-3 / pixel_m)
    if args.json:
        print(json.dumps({"file": args.file, "size": list(size), **found.as_json()}))
        return 0
    print(_text(found, size))
    for text in found.warnings:
        warn(text)
    return 0


def run_new(args: argparse.Namespace) -> int:
    """Write the pack file of an artwork, and print how its finishes were chosen."""
    from relgloss_view.pack.pack_file import write_pack

    if Path(args.output).suffix.lower() != ".toml":
        raise InputError(
            f"-o {args.output or repr(args.output)}: expected a name that ends in .toml"
        )
    check_writable(args.output)
    pack = _pack(args.artwork, args)
    if pack.file:
        raise InputError(f"{args.artwork}: this is a pack file already; give an artwork")
    write_pack(args.output, pack)
    names = ", ".join(printable(finish.name, 40) for finish in pack.finishes)
    print(f"{printable(args.output)}: a {pack.shape.kind} with the finishes {names}")
    for note in pack.notes:
        print(f"  {printable(note)}")
    return 0


def run_finishes(args: argparse.Namespace) -> int:
    """List the built-in finishes with the readings of gloss meters."""
    from relgloss_view.gloss.meter.meter import gloss_readings
    from relgloss_view.pack.built_in import FINISHES, load_finish

    rows, numbers = [], []
    for name, kind in FINISHES.items():
        material = load_finish(name)
        readings = {r.key: r for r in gloss_readings(material) if r.key in METERS}
        rows.append((name, kind, *(readings[key].words(readings[key].value) for key in METERS)))
        numbers.append(
            {
                "name": name,
                "kind": kind,
                "synthetic": material.synthetic,
                "readings": {key: readings[key].value for key in METERS},
            }
        )
    if args.json:
        print(json.dumps({"finishes": numbers}))
        return 0
    headings = ("20 deg", "60 deg", "85 deg", "75 deg")
    columns = [Column("finish", 18, left=True), Column("usual kind", 10, left=True)]
    print(table([*columns, *(Column(heading, 8) for heading in headings)], rows))
    print("gloss units of the project's own meter; every finish is synthetic: nobody measured it")
    return 0


def _pack(file: str, args: argparse.Namespace) -> Pack:
    """The pack of a pack file, or of an artwork with the options."""
    from relgloss_view.pack.kinds import ARTWORK, PACK, kind_of_pack
    from relgloss_view.pack.pack_file import read_pack
    from relgloss_view.pack.quick import quick_pack

    kind, given = kind_of_pack(file), artwork_entries(args)
    with Progress("pack") as progress:
        if kind == ARTWORK:
            return quick_pack(file, args.form or "can", given=given, progress=progress)
        if kind != PACK:
            raise InputError(
                f"{printable(file)}: expected a pack file (TOML with a table [pack]) or an artwork "
                "(PDF, PNG, JPEG, TIFF, PSD)"
            )
        if given or args.form is not None:
            raise InputError(
                f"{printable(file)}: a pack file has its own form and artwork; change it there"
            )
        return read_pack(file, progress)


def _text(found: PackCheck, size: tuple[int, int]) -> str:
    width, height = found.label_mm
    parts = ", ".join(
        f"{printable(name, 40)}{'' if prints else ' (not printed)'}" for name, prints in found.parts
    )
    lines = [
        f"{printable(found.name, 80)}: {found.form}, label {width:.4g} x {height:.4g} mm",
        f"  parts: {parts}",
    ]
    if found.artwork_mm is not None and found.artwork_px is not None:
        (across, along), (columns, rows) = found.artwork_mm, found.artwork_px
        lines += [
            f"  artwork: {printable(found.artwork)}, {across:.4g} x {along:.4g} mm, "
            f"{columns} x {rows} pixels",
            f"  resolution: {found.artwork_px_per_mm:.3g} pixels per mm; a picture of "
            f"{size[0]}x{size[1]} has {found.picture_px_per_mm:.3g}",
            f"  colours outside sRGB: {_share(found.outside_srgb)} of the artwork",
        ]
    columns_of_finishes = (
        *(Column(heading, left=True) for heading in ("finish", "kind", "material", "mask")),
        Column("mask covers", 11),
        Column("seen on", 8),
    )
    rows_of_finishes = [
        (
            printable(f.name, 30), f.kind, printable(f.material, 40),
            printable(f.mask, 40) or "below all", _share(f.coverage), _share(f.visible),
        )
        for f in found.finishes
    ]  # fmt: skip
    lines.append(table(columns_of_finishes, rows_of_finishes, indent="  "))
    if found.plates:
        columns_of_plates = (
            Column("plate", left=True), Column("covers", 8), Column("finish", left=True)
        )  # fmt: skip
        rows_of_plates = [
            (
                printable(p.name, 40),
                _share(p.coverage),
                printable(", ".join(p.finishes), 60) or ("ink" if p.coloured else NOTHING),
            )
            for p in found.plates
        ]
        lines.append(table(columns_of_plates, rows_of_plates, indent="  "))
    lines += [
        f"  overlap: {printable(above, 40)} lies above {printable(below, 40)} on {_share(share)} "
        "of the artwork"
        for below, above, share in found.overlaps
    ]
    lines += [f"  note: {printable(note)}" for note in found.notes]
    return "\n".join(lines)


def _share(share: float | None) -> str:
    return NOTHING if share is None else f"{100.0 * share:.3g} %"
