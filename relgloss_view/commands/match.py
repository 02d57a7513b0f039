"""`relgloss match`: settings that keep a sample's ratio of gloss to a reference picture."""

from __future__ import annotations

import argparse
import dataclasses
import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from relgloss_view.base.decoration import decoration
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.base.terminal import Column, Progress, ProgressReport, table, warn
from relgloss_view.base.writing import check_writable, together
from relgloss_view.commands.match_display import display_lines
from relgloss_view.commands.match_pack import run_pack
from relgloss_view.commands.outputs import refuse_read
from relgloss_view.commands.scene_options import (
    SAMPLE_METAVAR,
    add_scene_options,
    colour_from,
    scene_from,
)
from relgloss_view.picture.scene.look import viewed_look
from relgloss_view.picture.scene.setting import Setting, share_words

if TYPE_CHECKING:
    from relgloss_view.commands.sample_arguments import SampleArgument
    from relgloss_view.gloss.match import ComparedSetting, CurvePoint, MatchCurve, Reference
    from relgloss_view.gloss.match_check import CheckedPose
    from relgloss_view.picture.scene.scene import Scene
    from relgloss_view.quality.backends import FrameRenderer

CAVEAT = (
    "A starting point for the eye: one number can't fix two parameters; the experiment decides."
)


def add(commands: Any) -> None:
    """Declare the command."""
    from relgloss_view.gloss.samples import DEFAULT_GLOSS, GLOSSES
    from relgloss_view.picture.scene.sample import SAMPLES

    first, *others = SAMPLES
    parser = commands.add_parser(
        "match",
        description="For each sample, compute the settings (sigma_N, c) that give the same gloss "
        "ratio to the reference picture as the materials have, and propose the one at the "
        "sample's own grain. The proposal holds in every view: it is the mean over poses of the "
        "lamp. " + CAVEAT,
        epilog="example: relgloss match mine.json --grain 1.5 -o curve.png --write pair.toml",
    )
    parser.add_argument(
        "sample_words",  # --samples is another option
        metavar=SAMPLE_METAVAR,
        nargs="*",
        help="Built-in papers or material files. A setting after = (sigma_N in degrees, c as a "
        "share of c_max at the paper's geometry) is compared with the curve (default "
        f"{', '.join(others)} with the published settings)",
    )
    parser.add_argument(
        "--reference",
        metavar=SAMPLE_METAVAR,
        default=first,
        help="Reference sample and the setting of its picture. Without a setting, a built-in "
        "paper has the published one and a material file sigma_N 0 and c_max (default "
        f"{first} at sigma_N 0 and c_max)",
    )
    parser.add_argument(
        "--pack",
        metavar="PACK.toml",
        help="Match every finish of a pack in place of samples: sigma_N and the factor k of each",
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
        "--here",
        action="store_true",
        help="Match in the pose of the scene's options alone, in place of the mean over lamps from "
        "20 to 110 degrees about the paper's cylinder",
    )
    parser.add_argument("-o", "--output", metavar="OUT.png", help="Plot the curves into this file")
    parser.add_argument(
        "--write",
        metavar="SCENE.toml|PACK.toml",
        help="Write the reference and the proposal as a scene file, which `relgloss view` opens; "
        "with --pack the pack with sigma_N and k of each finish",
    )
    add_scene_options(parser, tuned=False, sourced=False, look=viewed_look())
    parser.add_argument("--json", action="store_true", help="Print the curves as JSON")
    parser.set_defaults(run=run, wrong_usage=parser.error)


def run(args: argparse.Namespace) -> int:
    """Compute the curves, check them on pictures, write the files that were asked for, print."""
    from relgloss_view.commands.sample_arguments import sample_argument, sample_arguments
    from relgloss_view.gloss.match import Reference, as_numbers, match_curve
    from relgloss_view.gloss.match_display import screen_numbers, screens_of
    from relgloss_view.gloss.match_plot import write_match_plot
    from relgloss_view.picture.scene.sample import SAMPLES
    from relgloss_view.quality.backends import open_renderer

    if args.pack is not None:
        _check_places(args)
        return run_pack(args)
    words = args.sample_words or list(SAMPLES)[1:]
    if args.write is not None and len(words) != 1:
        args.wrong_usage("argument --write: expected one sample, whose proposal is written")
    _check_places(args)
    scene, look, size = scene_from(args)
    first = sample_argument(args.reference, look)
    samples = sample_arguments(words, look, colour=colour_from(args))
    for word, argument in zip(words, samples, strict=True):
        if argument.sample.pack is not None:
            raise InputError(f"{printable(word)}: a pack; match its finishes with --pack {word}")
    if args.grain is not None:
        dataclasses.replace(look, sigma_n_deg=args.grain)  # raises where it is no sigma_N
    reference = Reference.of(first.sample_look, args.gloss, scene.setup if args.here else None)
    curves = []
    for argument in samples:
        sample = argument.sample_look
        grain = sample.look.sigma_n_deg if args.grain is None else args.grain
        compared = bool(argument.origin)
        curves.append(match_curve(reference, sample, grain_deg=grain, compare_setting=compared))
    written = [] if args.write is None else [args.write]
    status = 0
    with together():
        if args.write is not None:  # before all else that is written: there may be no proposal
            _write_scene(args.write, scene, (first, samples[0]), reference, curves[0])
        with Progress("match") as progress, open_renderer(args.backend) as renderer:
            checked = _checked(renderer, reference, curves, progress)
        if args.output is not None:
            with decoration(f"{args.output}: the plot", "the curves are printed") as drawn:
                write_match_plot(reference, curves, args.output)
                written.insert(0, args.output)
            status = 0 if drawn.done else 1  # the plot is a decoration, and what -o asks for
    if args.json:
        numbers: dict[str, Any] = {"outputs": written, "size": list(size), "note": CAVEAT}
        numbers |= as_numbers(reference, curves)
        numbers["displays"] = [
            screen_numbers(screen, reference, curves) for screen in screens_of(scene.display)
        ]
        numbers["poses"] = [_pose_numbers(pose) for pose in checked]
        print(json.dumps(numbers))
        return status
    for sample in (first.sample_look, *(m.sample for m in curves)):
        for text in sample.material.warnings:
            warn(f"{sample.label}: {text}")
    print(_reference_line(reference))
    print()
    print(_curves(curves))
    for m, argument in zip(curves, samples, strict=True):
        print()
        print("\n".join(_sample_lines(m, argument.origin, reference)))
    of_display = display_lines(scene.display, reference, curves)
    if of_display:
        print()
        print("\n".join(of_display))
    print()
    print(_order_table(checked))
    print()
    print(CAVEAT)
    for name in written:
        print(f"{printable(name)}: written")
    return status


def _checked(
    renderer: FrameRenderer,
    reference: Reference,
    curves: Sequence[MatchCurve],
    progress: ProgressReport,
) -> list[CheckedPose]:
    """The pictures at the proposals, ranked by each measure in each pose."""
    from relgloss_view.gloss.match_check import check_pose

    samples, readings = [reference.sample_at_c], {reference.sample.label: reference.reading}
    for m in curves:
        if m.proposed is not None and m.proposed.c is not None and m.sample.label not in readings:
            setting = Setting(m.proposed.sigma_n_deg, c=m.proposed.c)
            look = m.sample.look.at(setting)
            samples.append(dataclasses.replace(m.sample, look=look))
            readings[m.sample.label] = m.reading
    checked = []
    for k, setup in enumerate(reference.setups):
        progress(k / len(reference.setups), f"lamp at {setup.lamp.azimuth_deg:g} degrees")
        checked.append(check_pose(renderer, samples, readings, setup))
    return checked


def _pose_numbers(pose: CheckedPose) -> dict[str, Any]:
    """A checked pose as JSON holds it."""
    return {
        "lamp_azimuth_deg": pose.setup.lamp.azimuth_deg,
        "factor": pose.factor,
        "refused": list(pose.refused),
        "measures": {name: dict(values) for name, values in pose.values.items()},
        "orders": {name: order.verdict for name, order in pose.orders.items()},
    }


def _order_table(checked: Sequence[CheckedPose]) -> str:
    """Which measure of the pictures has the order of the materials' gloss, in which pose."""
    columns = [Column("order of the pictures by", 24, left=True)]
    columns += [Column(f"lamp {p.setup.lamp.azimuth_deg:g} deg", 12) for p in checked]
    rows = [
        (name.replace("_", " "), *(p.orders[name].verdict for p in checked))
        for name in checked[0].orders
    ]
    lines = [table(columns, rows, indent="  ")]
    lines += [
        f"  lamp {pose.setup.lamp.azimuth_deg:g} deg: {', '.join(pose.refused)}: not ranked, "
        "because no highlight is seen"
        for pose in checked
        if pose.refused
    ]
    return "\n".join(lines)


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
    if args.output is not None:
        refuse_read(args.output, [args.scene, args.pack, *(args.sample_words or [])])


def _write_scene(
    path: str,
    scene: Scene,
    pair: tuple[SampleArgument, SampleArgument],
    reference: Reference,
    m: MatchCurve,
) -> None:
    """Write the reference beside the proposal; InputError where there is no proposal."""
    from relgloss_view.picture.scene.match import Match
    from relgloss_view.picture.scene.scene_file import SceneFile
    from relgloss_view.picture.scene.scene_writer import write_scene_file

    first, test = pair
    at = m.proposed
    if at is None or at.c is None:
        raise InputError(f"--write {path}: no setting of {m.sample.label} keeps the ratio")
    look = m.sample.look.at(Setting(at.sigma_n_deg, c=at.c))
    match = Match(
        reference.c, at.c, first.sample_look.look.sigma_n_deg, at.sigma_n_deg, reference.gloss,
        at.spread,
    )  # fmt: skip
    content = SceneFile(
        test.sample, look, scene.setup, first.sample, reference.sample_at_c.look, match=match
    )
    write_scene_file(path, content)


def _reference_line(reference: Reference) -> str:
    from relgloss_view.gloss.samples import gloss_number, gloss_words

    sample = reference.sample
    lamps = ", ".join(f"{setup.lamp.azimuth_deg:g}" for setup in reference.setups)
    return (
        f"reference {sample.label}: {gloss_words(reference.gloss)} "
        f"{gloss_number(reference.gloss, reference.reading)}; "
        f"sigma_N {sample.look.sigma_n_deg:g} deg, c {reference.c:.4g}: its highlight adds "
        f"{reference.displayed_gloss:.1f} L*\nmean over the lamp at {lamps} degrees"
    )


def _curves(curves: Sequence[MatchCurve]) -> str:
    """The curves as a table: a row for each sigma_N, a column for each sample."""
    columns = [Column("sigma_N", 8)]
    columns += [Column(f"{m.sample.label}\nc", 16) for m in curves]
    sigmas = sorted({p.sigma_n_deg for m in curves for p in m.curve})
    rows = [(f"{sigma:.2f}", *(_cell(m, sigma) for m in curves)) for sigma in sigmas]
    return table(columns, rows, indent="  ")


def _cell(m: MatchCurve, sigma: float) -> str:
    for point in m.curve:
        if point.sigma_n_deg == sigma:
            return "none" if point.c is None else f"{point.c:.4g}"
    return ""


def _sample_lines(m: MatchCurve, origin: str, reference: Reference) -> list[str]:
    """The wanted gloss of a sample, its proposal, and its own setting beside the curve."""
    from relgloss_view.gloss.samples import gloss_number, gloss_words

    wanted = m.ratio * reference.displayed_gloss
    lines = [
        f"{m.sample.label}: {gloss_words(reference.gloss)} "
        f"{gloss_number(reference.gloss, m.reading)}, {m.ratio:.3g} of the "
        f"reference's; its highlight should add {wanted:.1f} L*"
    ]
    if m.proposed is None:
        lines.append("  its pictures show no highlight, so no setting changes their gloss")
    else:
        own = "its own grain" if m.proposed.sigma_n_deg == m.grain_deg else "nearest its own grain"
        lines.append(f"  proposed: {_point_words(m.proposed)} ({own})")
        lines += _spread_lines(m.proposed)
    setting = m.own_setting
    if setting is not None:
        shows = "" if setting.ratio is None else f" shows {setting.ratio:.3g} of the reference's"
        lines.append(
            f"  {origin}: sigma_N {setting.sigma_n_deg:g} deg, c {setting.c:.4g} = "
            f"{share_words(setting.c / m.full_c)} c_max at the paper's geometry{shows}"
        )
        lines.append(f"  which is {_distance(setting)}")
    return lines


def _spread_lines(point: CurvePoint) -> list[str]:
    """How far the poses differ in what they propose by themselves."""
    lines = []
    if point.low is not None and point.high is not None and point.spread > 1.0:
        lines.append(
            f"  one pose alone would propose c {point.low:.4g} to {point.high:.4g}, a spread of "
            f"{point.spread:.2f} times"
        )
    if point.refused:
        lamps = ", ".join(f"{azimuth:g}" for azimuth in point.refused)
        lines.append(f"  left out, because no highlight is seen: lamp at {lamps} degrees")
    return lines


def _point_words(point: CurvePoint) -> str:
    assert point.c is not None
    more = ", which exaggerates the contrast" if point.c > 1.0 + 1e-9 else ""
    return f"sigma_N {point.sigma_n_deg:g} deg, c {point.c:.4g}{more}"


def _distance(setting: ComparedSetting) -> str:
    """A setting's distance from the curve in words."""
    if setting.c_distance is None:
        return "at a sigma_N where no c keeps the ratio"
    side = "above" if setting.c_distance >= 0.0 else "below"
    along = f"{abs(setting.c_distance):.3g} {side} the curve in c"
    across = setting.sigma_n_distance_deg
    if across is None:
        return f"{along}; the curve has this c at no sigma_N"
    side = "above" if across >= 0.0 else "below"
    return f"{along}, {abs(across):.2f} deg {side} it in sigma_N"
