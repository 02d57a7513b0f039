"""`relgloss match`: settings whose gloss stands to a reference picture's as the materials' do."""

from __future__ import annotations

import argparse
import dataclasses
import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.base.terminal import Progress
from relgloss_view.base.writing import check_writable
from relgloss_view.commands.scene_options import add_scene_options, scene_from

if TYPE_CHECKING:
    from relgloss_view.commands.sample_arguments import Given
    from relgloss_view.gloss.match import Match, Point, Reference
    from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.setting import Setting

CAVEAT = (
    "A starting point for the eye: one number can't fix two parameters; the experiment decides."
)


def add(commands: Any) -> None:
    """Declare the command."""
    from relgloss_view.commands.sample_arguments import METAVAR
    from relgloss_view.gloss.comparison import DEFAULT_GLOSS, GLOSSES
    from relgloss_view.gloss.match import DEFAULT_MEASURE, MEASURES
    from relgloss_view.picture.scene.sample import SAMPLES

    first, *others = SAMPLES
    parser = commands.add_parser(
        "match",
        description="For each sample the curve of (sigma_N, c) whose displayed gloss stands to the "
        "reference picture's as the material's computed gloss stands to the reference material's, "
        "and the point on it at the sample's own grain. " + CAVEAT,
        epilog="example: relgloss match mine.json --grain 1.5 -o curve.png --write pair.toml",
    )
    parser.add_argument(
        "cases",
        metavar=METAVAR,
        nargs="*",
        help="built-in papers or materials; settings (sigma_N in degrees, c as a share of c_max) "
        f"are held against the curve (default: {', '.join(others)} with the published ones)",
    )
    parser.add_argument(
        "--reference",
        metavar=METAVAR,
        default=first,
        help=f"reference sample and its picture's settings (default {first} at sigma_N 0 and "
        "c_max; a built-in paper's are the published ones, a material's sigma_N 0 and c_max)",
    )
    parser.add_argument(
        "--grain",
        metavar="DEG",
        type=float,
        help="the sample's own grain as a sigma_N, judged by eye (default: that of its settings, "
        "or 0)",
    )
    parser.add_argument(
        "--gloss", choices=GLOSSES, default=DEFAULT_GLOSS, help=f"default {DEFAULT_GLOSS}"
    )
    parser.add_argument(
        "--measure",
        choices=list(MEASURES),
        default=DEFAULT_MEASURE,
        help=f"of the displayed gloss (default {DEFAULT_MEASURE})",
    )
    parser.add_argument("-o", "--output", metavar="OUT.png", help="plot of the curves")
    parser.add_argument(
        "--write", metavar="SCENE.toml", help="the reference and the proposal, for the window"
    )
    add_scene_options(parser, tuned=False, sourced=False)
    parser.add_argument("--json", action="store_true", help="print the curves as JSON")
    parser.set_defaults(run=run, wrong_usage=parser.error)


def run(args: argparse.Namespace) -> int:
    """Find the curves, write what was asked for, print."""
    from relgloss_view.commands.sample_arguments import given_sample, given_samples
    from relgloss_view.gloss.match import as_numbers, match, reference_of
    from relgloss_view.gloss.match_plot import write_match_plot
    from relgloss_view.picture.scene.sample import SAMPLES
    from relgloss_view.quality.backends import open_renderer

    words = args.cases or list(SAMPLES)[1:]
    if args.write is not None and len(words) != 1:
        args.wrong_usage("argument --write: expected one sample, whose proposal is written")
    _check_places(args)
    scene, look, size = scene_from(args)
    first = given_sample(args.reference, look)
    samples = given_samples(words, look)
    if args.grain is not None:
        dataclasses.replace(look, sigma_n_deg=args.grain)  # its range is a sigma_N's
    by, gloss = args.measure, args.gloss
    found: list[Match] = []
    with Progress("match") as progress, open_renderer(args.backend) as renderer:
        reference = reference_of(renderer, first.case, scene, size, gloss, by)
        for k, given in enumerate(samples):
            grain = given.case.look.sigma_n_deg if args.grain is None else args.grain

            def report(share: float, text: str, done: int = k) -> None:
                progress((done + share) / len(samples), text)

            found.append(
                match(
                    renderer, reference, given.case, scene, size, gloss=gloss, by=by,
                    grain_deg=grain, settled=bool(given.settings), progress=report,
                )
            )  # fmt: skip
    if args.output is not None:
        write_match_plot(reference, found, gloss, by, args.output)
    if args.write is not None:
        _write_scene(args.write, scene, (first, samples[0]), found[0])
    written = [name for name in (args.output, args.write) if name is not None]
    if args.json:
        told = {"outputs": written, "size": list(size), "note": CAVEAT}
        print(json.dumps(told | as_numbers(reference, found, gloss, by)))
        return 0
    for one in (first.case, *(m.case for m in found)):
        for text in one.material.warnings:
            print(f"warning: {one.label}: {printable(text, 300)}", file=sys.stderr)
    print(_told(reference, found, [given.settings for given in samples], gloss, by))
    for name in written:
        print(f"{printable(name)}: written")
    return 0


def _check_places(args: argparse.Namespace) -> None:
    for option, name, suffix in (("-o", args.output, ".png"), ("--write", args.write, ".toml")):
        if name is None:
            continue
        if Path(name).suffix.lower() != suffix:
            raise InputError(
                f"{option} {name or repr(name)}: expected a name that ends in {suffix}"
            )
        check_writable(name)


def _write_scene(path: str, scene: Scene, pair: tuple[Given, Given], found: Match) -> None:
    """The reference beside the proposal; InputError where there is none."""
    from relgloss_view.picture.scene.scene_file import SceneFile
    from relgloss_view.picture.scene.scene_writer import write_scene_file

    reference, sample = pair
    at = found.proposed
    if at is None or at.c_fraction is None:
        raise InputError(f"--write {path}: no setting of {found.case.label} keeps the ratio")
    look = found.case.look.at(Setting(at.sigma_n_deg, at.c_fraction))
    content = SceneFile(sample.sample, look, scene.setup, reference.sample, reference.case.look)
    write_scene_file(path, content)


def _told(
    reference: Reference, found: list[Match], settings: list[str], gloss: str, by: str
) -> str:
    """The curves as columns, then each sample's proposal."""
    from relgloss_view.gloss.comparison import words_of

    case = reference.case
    lines = [
        f"reference {case.label}: {words_of(gloss)} {reference.gloss:.4g}; sigma_N "
        f"{case.look.sigma_n_deg:g} deg, c {reference.c:.3g} shows {by.replace('-', ' ')} "
        f"{reference.shown:.1f} L* above its body's",
        "",
    ]
    wide = [max(18, len(m.case.label) + 2) for m in found]
    heads = [f"{m.case.label:>{w}}" for m, w in zip(found, wide, strict=True)]
    lines.append("  " + "sigma_N".rjust(8) + "".join(heads))
    lines.append("  " + " " * 8 + "".join(f"{'c (of c_max)':>{w}}" for w in wide))
    sigmas = sorted({p.sigma_n_deg for m in found for p in m.curve})
    for sigma in sigmas:
        cells = [f"{_cell(m, sigma):>{w}}" for m, w in zip(found, wide, strict=True)]
        lines.append(f"  {sigma:8.2f}{''.join(cells)}")
    for m, told in zip(found, settings, strict=True):
        lines += ["", *_of_sample(m, told, reference, gloss)]
    return "\n".join([*lines, "", CAVEAT])


def _cell(found: Match, sigma: float) -> str:
    for point in found.curve:
        if point.sigma_n_deg == sigma:
            return "none" if point.c is None else f"{point.c:.4g} ({point.c_fraction:.2f})"
    return ""


def _of_sample(m: Match, settings: str, reference: Reference, gloss: str) -> list[str]:
    from relgloss_view.gloss.comparison import words_of

    lines = [
        f"{m.case.label}: {words_of(gloss)} {m.gloss:.4g}, {m.gloss / reference.gloss:.3g} of the "
        f"reference's; wanted {m.wanted:.1f} L*"
    ]
    if m.proposed is None:
        most = max(p.most for p in m.curve)
        if most > 0.0:
            lines.append(f"  no setting shows so much: c_max shows at most {most:.1f} L*")
        else:
            lines.append("  it shows no highlight, so that no setting changes it")
    else:
        own = "its own grain" if m.proposed.sigma_n_deg == m.grain_deg else "nearest its own grain"
        lines.append(f"  proposed: {_words(m.proposed)} ({own})")
    p = m.present
    if p is not None:
        shown = p.shown / reference.shown
        share = "" if p.c_fraction is None else f" = {p.c_fraction:.3g} c_max"
        lines.append(
            f"  {settings}: sigma_N {p.sigma_n_deg:g} deg, c {p.c:.4g}{share} shows {shown:.3g} "
            "of the reference's"
        )
        lines.append(f"  which is {_distance(m)}")
    return lines


def _words(point: Point) -> str:
    assert point.c is not None
    more = ", which exaggerates the contrast" if point.c > 1.0 + 1e-9 else ""
    text = f"sigma_N {point.sigma_n_deg:g} deg, c {point.c:.4g} = {point.c_fraction:.3g} c_max"
    return text + more


def _distance(m: Match) -> str:
    p = m.present
    assert p is not None
    if p.c_distance is None or p.fraction_distance is None:
        return "out of the curve's reach in c"
    side = "above" if p.c_distance >= 0.0 else "below"
    along = f"{abs(p.c_distance):.3g} ({abs(p.fraction_distance):.2f} c_max) {side} the curve in c"
    if p.sigma_n_distance_deg is None:
        return f"{along}; at no sigma_N has the curve this c"
    side = "above" if p.sigma_n_distance_deg >= 0.0 else "below"
    return f"{along}, {abs(p.sigma_n_distance_deg):.2f} deg {side} it in sigma_N"
