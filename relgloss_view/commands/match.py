"""`relgloss match`: settings that keep a sample's ratio of gloss to a reference picture."""

from __future__ import annotations

import argparse
import dataclasses
import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.base.terminal import Column, Progress, table, warn
from relgloss_view.base.writing import check_writable
from relgloss_view.commands.scene_options import add_scene_options, scene_from
from relgloss_view.picture.scene.look import viewed_look
from relgloss_view.picture.scene.setting import Setting

if TYPE_CHECKING:
    from relgloss_view.commands.sample_arguments import SampleArgument
    from relgloss_view.gloss.match import ComparedSetting, CurvePoint, Match, Reference
    from relgloss_view.picture.scene.scene import Scene

CAVEAT = (
    "A starting point for the eye: one number can't fix two parameters; the experiment decides."
)


def add(commands: Any) -> None:
    """Declare the command."""
    from relgloss_view.commands.sample_arguments import METAVAR
    from relgloss_view.gloss.match import DEFAULT_MEASURE, MEASURES
    from relgloss_view.gloss.samples import DEFAULT_GLOSS, GLOSSES
    from relgloss_view.picture.scene.sample import SAMPLES

    first, *others = SAMPLES
    parser = commands.add_parser(
        "match",
        description="For each sample, compute the settings (sigma_N, c) that give the same gloss "
        "ratio to the reference picture as the materials have, and propose the one at the "
        "sample's own grain. " + CAVEAT,
        epilog="example: relgloss match mine.json --grain 1.5 -o curve.png --write pair.toml",
    )
    parser.add_argument(
        "sample_words",  # --samples is another option
        metavar=METAVAR,
        nargs="*",
        help="Built-in papers or material files. A setting after = (sigma_N in degrees, c as a "
        f"share of c_max) is compared with the curve (default {', '.join(others)} with the "
        "published settings)",
    )
    parser.add_argument(
        "--reference",
        metavar=METAVAR,
        default=first,
        help="Reference sample and the setting of its picture. Without a setting, a built-in "
        "paper has the published one and a material file sigma_N 0 and c_max (default "
        f"{first} at sigma_N 0 and c_max)",
    )
    parser.add_argument(
        "--grain",
        metavar="DEG",
        type=float,
        help="The sigma_N, in degrees, that looks like the sample's own grain (default that of "
        "its setting, or 0)",
    )
    parser.add_argument(
        "--gloss",
        choices=GLOSSES,
        default=DEFAULT_GLOSS,
        help=f"Gloss of the materials whose ratio is kept (default {DEFAULT_GLOSS})",
    )
    parser.add_argument(
        "--measure",
        choices=list(MEASURES),
        default=DEFAULT_MEASURE,
        help=f"Measure of the gloss that a picture displays (default {DEFAULT_MEASURE})",
    )
    parser.add_argument("-o", "--output", metavar="OUT.png", help="Plot the curves into this file")
    parser.add_argument(
        "--write",
        metavar="SCENE.toml",
        help="Write the reference and the proposal as a scene file, which `relgloss view` opens",
    )
    add_scene_options(parser, tuned=False, sourced=False, look=viewed_look())
    parser.add_argument("--json", action="store_true", help="Print the curves as JSON")
    parser.set_defaults(run=run, wrong_usage=parser.error)


def run(args: argparse.Namespace) -> int:
    """Compute the curves, write the files that were asked for, print."""
    from relgloss_view.commands.sample_arguments import sample_argument, sample_arguments
    from relgloss_view.gloss.match import Criterion, as_numbers, match, reference_of
    from relgloss_view.gloss.match_plot import write_match_plot
    from relgloss_view.picture.scene.sample import SAMPLES
    from relgloss_view.quality.backends import open_renderer

    words = args.sample_words or list(SAMPLES)[1:]
    if args.write is not None and len(words) != 1:
        args.wrong_usage("argument --write: expected one sample, whose proposal is written")
    _check_places(args)
    scene, look, size = scene_from(args)
    first = sample_argument(args.reference, look)
    samples = sample_arguments(words, look)
    if args.grain is not None:
        dataclasses.replace(look, sigma_n_deg=args.grain)  # raises where it is no sigma_N
    matches: list[Match] = []
    with Progress("match") as progress, open_renderer(args.backend) as renderer:
        criterion = Criterion(args.gloss, args.measure)
        reference = reference_of(renderer, first.sample_look, scene, size, criterion)
        for k, argument in enumerate(samples):
            sample = argument.sample_look
            grain = sample.look.sigma_n_deg if args.grain is None else args.grain

            def report(share: float, text: str, done: int = k) -> None:
                progress((done + share) / len(samples), text)

            matches.append(
                match(
                    renderer, reference, sample, scene, size, grain_deg=grain,
                    compare_setting=bool(argument.origin), progress=report,
                )
            )  # fmt: skip
    if args.output is not None:
        write_match_plot(reference, matches, args.output)
    if args.write is not None:
        _write_scene(args.write, scene, (first, samples[0]), matches[0])
    written = [name for name in (args.output, args.write) if name is not None]
    if args.json:
        numbers = {"outputs": written, "size": list(size), "note": CAVEAT}
        print(json.dumps(numbers | as_numbers(reference, matches)))
        return 0
    for sample in (first.sample_look, *(m.sample for m in matches)):
        for text in sample.material.warnings:
            warn(f"{sample.label}: {text}")
    print(_reference_line(reference))
    print()
    print(_curves(matches))
    for m, argument in zip(matches, samples, strict=True):
        print()
        print("\n".join(_sample_lines(m, argument.origin, reference)))
    print()
    print(CAVEAT)
    for name in written:
        print(f"{printable(name)}: written")
    return 0


def _check_places(args: argparse.Namespace) -> None:
    """Raise InputError for a name with the wrong ending or a place that can't be written."""
    for option, name, suffix in (("-o", args.output, ".png"), ("--write", args.write, ".toml")):
        if name is None:
            continue
        if Path(name).suffix.lower() != suffix:
            raise InputError(
                f"{option} {name or repr(name)}: expected a name that ends in {suffix}"
            )
        check_writable(name)


def _write_scene(
    path: str, scene: Scene, pair: tuple[SampleArgument, SampleArgument], m: Match
) -> None:
    """Write the reference beside the proposal; InputError where there is no proposal."""
    from relgloss_view.picture.scene.scene_file import SceneFile
    from relgloss_view.picture.scene.scene_writer import write_scene_file

    reference, test = pair
    at = m.proposed
    if at is None or at.c_fraction is None:
        raise InputError(f"--write {path}: no setting of {m.sample.label} keeps the ratio")
    look = m.sample.look.at(Setting(at.sigma_n_deg, at.c_fraction))
    content = SceneFile(
        test.sample, look, scene.setup, reference.sample, reference.sample_look.look
    )
    write_scene_file(path, content)


def _reference_line(reference: Reference) -> str:
    from relgloss_view.gloss.samples import gloss_words

    sample, criterion = reference.sample, reference.criterion
    return (
        f"reference {sample.label}: {gloss_words(criterion.gloss)} {reference.gloss:.4g}; sigma_N "
        f"{sample.look.sigma_n_deg:g} deg, c {reference.c:.3g} shows {criterion.measure_words} "
        f"{reference.displayed_gloss:.1f} L* above its body's"
    )


def _curves(matches: Sequence[Match]) -> str:
    """The curves as a table: a row for each sigma_N, a column for each sample."""
    columns = [Column("sigma_N", 8)]
    columns += [Column(f"{m.sample.label}\nc (of c_max)", 16) for m in matches]
    sigmas = sorted({p.sigma_n_deg for m in matches for p in m.curve})
    rows = [(f"{sigma:.2f}", *(_cell(m, sigma) for m in matches)) for sigma in sigmas]
    return table(columns, rows, indent="  ")


def _cell(m: Match, sigma: float) -> str:
    for point in m.curve:
        if point.sigma_n_deg == sigma:
            return "none" if point.c is None else f"{point.c:.4g} ({point.c_fraction:.2f})"
    return ""


def _sample_lines(m: Match, origin: str, reference: Reference) -> list[str]:
    """The wanted gloss of a sample, its proposal, and its own setting beside the curve."""
    from relgloss_view.gloss.samples import gloss_words

    lines = [
        f"{m.sample.label}: {gloss_words(reference.criterion.gloss)} {m.gloss:.4g}, "
        f"{m.gloss / reference.gloss:.3g} of the reference's; wanted {m.wanted:.1f} L*"
    ]
    if m.proposed is None:
        most = max(p.most for p in m.curve)
        if most > 0.0:
            lines.append(f"  no setting shows so much: c_max shows at most {most:.1f} L*")
        else:
            lines.append("  its pictures show no highlight, so no setting changes their gloss")
    else:
        own = "its own grain" if m.proposed.sigma_n_deg == m.grain_deg else "nearest its own grain"
        lines.append(f"  proposed: {_point_words(m.proposed)} ({own})")
    setting = m.own_setting
    if setting is not None:
        ratio = setting.displayed_gloss / reference.displayed_gloss
        share = "" if setting.c_fraction is None else f" = {setting.c_fraction:.3g} c_max"
        lines.append(
            f"  {origin}: sigma_N {setting.sigma_n_deg:g} deg, c {setting.c:.4g}{share} shows "
            f"{ratio:.3g} of the reference's"
        )
        lines.append(f"  which is {_distance(setting)}")
    return lines


def _point_words(point: CurvePoint) -> str:
    assert point.c is not None
    more = ", which exaggerates the contrast" if point.c > 1.0 + 1e-9 else ""
    text = f"sigma_N {point.sigma_n_deg:g} deg, c {point.c:.4g} = {point.c_fraction:.3g} c_max"
    return text + more


def _distance(setting: ComparedSetting) -> str:
    """A setting's distance from the curve in words."""
    if setting.c_distance is None or setting.fraction_distance is None:
        return "at a sigma_N where no c keeps the ratio"
    side = "above" if setting.c_distance >= 0.0 else "below"
    along = (
        f"{abs(setting.c_distance):.3g} ({abs(setting.fraction_distance):.2f} c_max) {side} the "
        "curve in c"
    )
    across = setting.sigma_n_distance_deg
    if across is None:
        return f"{along}; the curve has this c at no sigma_N"
    side = "above" if across >= 0.0 else "below"
    return f"{along}, {abs(across):.2f} deg {side} it in sigma_N"
