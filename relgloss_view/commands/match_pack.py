"""`relgloss match --pack`: sigma_N and k of every finish of a pack against the reference."""

from __future__ import annotations

import argparse
import json
from typing import TYPE_CHECKING, Any

from relgloss_view.base.reading import printable
from relgloss_view.base.terminal import Column, table, warn
from relgloss_view.commands.scene_options import scene_from
from relgloss_view.picture.scene.pack_settings import PACK_AMBIENT

if TYPE_CHECKING:
    from relgloss_view.gloss.pack_match import FinishMatch, PackMatch

MEAN = (
    "k is the mean over these lamps, about the paper's cylinder. A picture that is drawn has the k "
    "of its own view: name it with --scene or --set."
)
VIEW = "k is that of this view, c that of the mean over the lamps; --here takes both from the view."
HERE = "c and k are those of this view alone."


def run_pack(args: argparse.Namespace) -> int:
    """Match the finishes of a pack, write the pack that was asked for, print."""
    from relgloss_view.commands.sample_arguments import sample_argument
    from relgloss_view.gloss.match import Reference
    from relgloss_view.gloss.pack_match import match_pack
    from relgloss_view.pack.pack_file import read_pack, write_pack
    from relgloss_view.picture.scene.scene import Scene

    if args.sample_words:
        args.wrong_usage("argument --pack: expected no samples beside it")
    if args.output is not None:
        args.wrong_usage("argument -o: a pack has no curves to plot; leave it out")
    scene, look, _ = scene_from(args)
    pack = read_pack(args.pack)
    first = sample_argument(args.reference, look)
    setup = Scene(pack.material, scene.setup, pack=pack).setup
    reference = Reference.of(first.sample_look, args.gloss, setup if args.here else None)
    viewed = args.scene is not None or bool(args.set) or args.here
    if args.scene is None and not any(word.startswith("lamp.ambient=") for word in args.set):
        setup = setup.with_entries("lamp", ambient=PACK_AMBIENT)  # as a new picture of it has
    found = match_pack(reference, pack, args.grain, setup if viewed else None)
    note = HERE if args.here else VIEW if viewed else MEAN
    if args.write is not None:
        write_pack(args.write, found.as_kept)
    if args.json:
        print(json.dumps(_numbers(found, args.write, note)))
        return 0
    for finish in pack.finishes:
        for text in finish.material.warnings:
            warn(f"finish {printable(finish.name, 60)!r}: {text}")
    for text in found.warnings:
        warn(text)
    print("\n".join(_lines(found, note)))
    if args.write is not None:
        print(f"{printable(args.write)}: written")
    return 0


def _numbers(found: PackMatch, written: str | None, note: str) -> dict[str, Any]:
    reference = found.reference
    return {
        "outputs": [] if written is None else [written],
        "gloss": reference.gloss,
        "lamp_azimuths_deg": [setup.lamp.azimuth_deg for setup in reference.setups],
        "reference": reference.as_numbers(),
        **found.as_numbers(),
        "note": note,
    }


def _lines(found: PackMatch, note: str) -> list[str]:
    """The table of the finishes, and what it means."""
    from relgloss_view.gloss.samples import gloss_number, gloss_words

    gloss = found.reference.gloss
    columns = [
        Column("finish", 24, left=True),
        Column(gloss_words(gloss), 15),
        Column("of reference", 12),
        Column("sigma_N", 7),
        Column("c alone", 9),
        Column("k", 9),
        Column("shown", 7),
        Column("spread", 6),
    ]
    rows = [
        (
            printable(f.name, 24),
            gloss_number(gloss, f.reading),
            f"{f.ratio:.3g}",
            f"{f.sigma_n_deg:g}",
            "none" if f.point.c is None else f"{f.point.c:.4g}",
            f"{f.k:.4g}" + (" *" if f.kept else ""),
            "-" if f.shown is None else f"{f.shown:.3g}",
            f"{f.point.spread:.2f}",
        )
        for f in found.finishes
    ]
    lines = [
        f"{printable(found.pack.name, 80)}: c {found.c:.4g}, that of finish "
        f"{printable(found.anchor.name, 60)!r}",
        table(columns, rows, indent="  "),
        "c alone: of a picture that shows this finish only. k: factor of its highlights beside "
        f"those of {printable(found.anchor.name, 60)!r}. shown: displayed "
        "gloss over the reference's. spread: largest over smallest c that one pose would propose.",
    ]
    if any(f.kept for f in found.finishes):
        lines.append("*: k is the pack's own and is kept.")
    lines += [_left_out(f) for f in found.finishes if f.point.refused]
    return [*lines, note]


def _left_out(finish: FinishMatch) -> str:
    lamps = ", ".join(f"{azimuth:g}" for azimuth in finish.point.refused)
    return f"{printable(finish.name, 60)}: left out, because no highlight is seen: lamp at {lamps}"
