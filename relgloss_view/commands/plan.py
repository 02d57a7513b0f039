"""`relgloss plan`: how little of the model a scene needs, and what less would cost in accuracy."""

from __future__ import annotations

import argparse
import dataclasses
import json
from typing import TYPE_CHECKING, Any

from relgloss_view.base.reading import printable
from relgloss_view.base.terminal import Column, table
from relgloss_view.commands.matched import add_reference_option, matched_finishes, matched_picture
from relgloss_view.commands.scene_options import add_scene_options, scene_from
from relgloss_view.picture.scene.look import viewed_look

if TYPE_CHECKING:
    from relgloss_view.quality.planner import Advice, StageChoice
    from relgloss_view.quality.proxy import Deviation

#: The stages as people read them.
STAGES = {
    "noise": "grain",
    "lobes": "specular lobes, at most",
    "gamut": "out of gamut",
    "targets": "numbers",
    "diffuse": "diffuse reflection",
    "fresnel": "Fresnel's factor",
    "shadowing": "shadowing G",
    "lamp": "lamp",
}


def add(commands: Any) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "plan",
        description="Choose for each stage the cheapest way of drawing whose error on this scene "
        "is within a tolerance, as `--quality auto` does. Errors are CIEDE2000 differences from "
        "the whole model, measured on a thousand pixels of the picture.",
        epilog="example: relgloss plan --sample uncoated --set lamp.azimuth_deg=110",
    )
    add_scene_options(parser, look=viewed_look())
    add_reference_option(parser)
    parser.add_argument(
        "--p95", metavar="DE", type=float, help="Largest 95th percentile of the error (default 0.5)"
    )
    parser.add_argument(
        "--largest", metavar="DE", type=float, help="Largest error at any pixel (default 2)"
    )
    parser.add_argument("--json", action="store_true", help="Print the plan as JSON")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Plan, and print the plan."""
    from relgloss_view.quality.planner import Tolerance, advise

    scene, look, size = scene_from(args)
    scene, look = matched_finishes(args, scene, look)
    picture = matched_picture(args, scene, look)
    look = look if picture is None else picture.look
    limits = {"p95": args.p95, "largest": args.largest}
    tolerance = Tolerance(**{name: value for name, value in limits.items() if value is not None})
    advice = advise(scene, look, size, tolerance)
    if args.json:
        print(json.dumps(_numbers(advice, tolerance)))
        return 0
    width, height = size
    print(f"{printable(scene.name, 80)}, {width}x{height}, sigma_N {look.sigma_n_deg:g} deg")
    if advice.note:
        print(advice.note)
        return 0
    headings = ("stage", "drawn", "its own error", "saves", "the next simpler")
    columns = [Column(heading, left=True) for heading in headings]
    print(table(columns, [_row(choice) for choice in advice.choices]))
    print(
        f"together: {_error(advice.error)} (allowed {tolerance.p95:g} and {tolerance.largest:g}), "
        f"about {advice.saved_percent:.0f} % of a frame's time saved"
    )
    print("errors: CIEDE2000, 95th percentile over the object / over the highlight / largest")
    return 0


def _row(choice: StageChoice) -> tuple[str, str, str, str, str]:
    simpler = ""
    if choice.simpler is not None and choice.simpler_error is not None:
        simpler = f"{choice.simpler}: {_error(choice.simpler_error)}"
        simpler += f" ({choice.reason})" if choice.reason else ""
    elif choice.reason:
        simpler = choice.reason
    saved = f"{choice.saved_percent:g} %" if choice.saved_percent else "-"
    error = _error(choice.error) if choice.saved_percent else "exact"
    return STAGES[choice.stage], str(choice.chosen), error, saved, simpler


def _error(error: Deviation) -> str:
    return f"{error.object_p95:.2f} / {error.highlight_p95:.2f} / {error.largest:.2f}"


def _numbers(advice: Advice, tolerance: object) -> dict[str, Any]:
    return {
        "method": dataclasses.asdict(advice.method),
        "simplified": advice.method.differences(),
        "choices": [dataclasses.asdict(choice) for choice in advice.choices],
        "error": dataclasses.asdict(advice.error),
        "tolerance": dataclasses.asdict(tolerance),  # type: ignore[call-overload]
        "saved_percent": advice.saved_percent,
        "note": advice.note,
    }
