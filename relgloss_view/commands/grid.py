"""`relgloss grid`: the stimuli of the subjective evaluation, 7 sigma_N x 6 c of one sample."""

from __future__ import annotations

import argparse
import dataclasses
import json
import shlex
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from relgloss_view import __version__
from relgloss_view.atomic import make_folder, whole_file
from relgloss_view.commands.progress import Progress
from relgloss_view.commands.scene_options import add_scene_options, scene_from
from relgloss_view.errors import InputError

#: Ishii et al.: sigma_N from 0 to 3 degrees by 0.5, c from c_max/6 to c_max by c_max/6.
SIGMA_N_DEG = (0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0)
C_SIXTHS = (1, 2, 3, 4, 5, 6)
THUMBNAIL_PX = 200


def add(commands: Any) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "grid",
        help="the 7 x 6 stimuli of a sample, a contact sheet and a manifest",
        description="Draw the paper's 42 stimuli of a sample: sigma_N 0 to 3 degrees by 0.5, "
        "c from c_max/6 to c_max.",
        epilog="example: relgloss grid --sample uncoated --size 512x512 -o stimuli",
    )
    parser.add_argument("-o", "--output", metavar="FOLDER", required=True)
    add_scene_options(parser, tuned=False)
    parser.add_argument("--json", action="store_true", help="print the manifest as JSON")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Draw all stimuli into the folder."""
    from relgloss_view.picture.backends import open_renderer
    from relgloss_view.picture.export import parameters, save_frame, save_rgb
    from relgloss_view.picture.sheet import contact_sheet, thumbnail

    folder = Path(args.output)
    if folder.exists() and not folder.is_dir():
        raise InputError(f"{folder}: is a file; give the name of a folder with -o")
    scene, look, size = scene_from(args)
    total = len(SIGMA_N_DEG) * len(C_SIXTHS)
    stimuli: list[dict[str, Any]] = []
    rows: list[list[NDArray[np.uint8]]] = []
    captions: list[list[str]] = []
    with open_renderer(args.backend) as renderer, Progress("grid") as progress:
        folder = make_folder(folder)
        for sigma_n_deg in SIGMA_N_DEG:
            rows.append([])
            captions.append([])
            for sixths in C_SIXTHS:
                name = f"sigma_{sigma_n_deg:.1f}_c_{sixths}of6.png"
                progress(len(stimuli) / total, name)
                variant = dataclasses.replace(
                    look, sigma_n_deg=sigma_n_deg, c=None, c_fraction=sixths / 6
                )
                frame = renderer.render(scene, variant, size)
                save_frame(frame, folder / name, _command(args, sigma_n_deg, sixths, name))
                numbers = parameters(frame)
                stimuli.append({"file": name, "c_sixths": sixths, **_varying(numbers)})
                rows[-1].append(thumbnail(frame, THUMBNAIL_PX))
                captions[-1].append(f"{sigma_n_deg:.1f} deg, {sixths}/6")
    title = f"{scene.material.name}: sigma_N down, c / c_max across"
    note = "synthetic sample" if scene.material.synthetic else ""
    save_rgb(
        contact_sheet(rows, captions, title, note),
        folder / "contact-sheet.png",
        {"Software": f"relgloss {__version__}", "Title": title},
    )
    manifest = {
        "format": "relgloss-grid",
        "version": 1,
        **{k: v for k, v in numbers.items() if k not in stimuli[0] and k != "warnings"},
        "stimuli": stimuli,
    }
    with whole_file(folder / "manifest.json") as temporary:
        temporary.write_text(json.dumps(manifest, indent=1) + "\n", encoding="utf-8")
    print(json.dumps(manifest) if args.json else f"{folder}: {total} stimuli and contact-sheet.png")
    return 0


def _varying(numbers: dict[str, Any]) -> dict[str, Any]:
    keys = (
        "sigma_n_deg",
        "c",
        "c_max",
        "c_max_eq4",
        "clip_count",
        "out_of_gamut_count",
        "warnings",
    )
    return {key: numbers[key] for key in keys}


def _command(args: argparse.Namespace, sigma_n_deg: float, sixths: int, name: str) -> str:
    """The snapshot that draws the same stimulus."""
    words = ["relgloss", "snapshot"]
    for option in ("sample", "material", "scene", "seed", "samples"):
        value = getattr(args, option)
        words += [f"--{option}", str(value)] if value is not None else []
    for setting in args.set:
        words += ["--set", setting]
    width, height = args.size
    words += ["--size", f"{width}x{height}", "--backend", args.backend]
    words += ["--sigma-n", f"{sigma_n_deg:g}", "--c-fraction", repr(sixths / 6), "-o", name]
    return shlex.join(words)
