"""`relgloss display patches`: pictures to measure by hand, and the table to fill in."""

from __future__ import annotations

import argparse
import json
import os
from pathlib import Path
from typing import Any

from relgloss_view.base.arrays import Bytes
from relgloss_view.base.csv_files import write_csv
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.base.shell import command_line
from relgloss_view.base.temporaries import is_temporary
from relgloss_view.base.terminal import Progress
from relgloss_view.base.writing import whole_folder
from relgloss_view.commands.scene_options import size_of_text
from relgloss_view.display.patches import HEADINGS, LEAST, MOST, USUAL, chart_text, patch_values

TABLE, CHART = "patches.csv", "patches.ti1"
SIZE = (1280, 720)
SMALLEST, LARGEST = 64, 8192  #: pixels of a side
SURROUND = 96  #: digital value around a patch
PATCH_SHARE = 0.7  #: of the shorter side of the picture
INK = (200, 200, 200)


def add(own: Any) -> None:
    """Declare the command among those of `relgloss display`."""
    parser = own.add_parser(
        "patches",
        help="write pictures of patches to measure by hand, and the table to fill in",
        description="Write a picture for each patch, a table (CSV) to fill in with readings, and a "
        "chart (.ti1) for Argyll's dispread. The pictures have no profile: show them in a program "
        "that changes no colours, over the whole screen, and measure the middle.",
        epilog="example: relgloss display patches -o patches; relgloss display "
        "patches/patches.csv -o monitor.toml",
    )
    parser.add_argument(
        "-o",
        "--output",
        metavar="FOLDER",
        required=True,
        help="New folder for the pictures and the table",
    )
    parser.add_argument(
        "--count",
        metavar="N",
        type=int,
        default=USUAL,
        help=f"Number of patches, {LEAST} to {MOST} (default {USUAL}). The first ones decide most",
    )
    parser.add_argument(
        "--size",
        metavar="WxH",
        type=size_of_text,
        default=SIZE,
        help="Size of the pictures in pixels (default 1280x720)",
    )
    parser.add_argument("--json", action="store_true", help="Print the patches as JSON")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Write the folder, and print what to do next."""
    if not LEAST <= args.count <= MOST:
        raise InputError(f"--count {args.count}: expected {LEAST} to {MOST}")
    if not all(SMALLEST <= side <= LARGEST for side in args.size):
        width, height = args.size
        raise InputError(f"--size {width}x{height}: expected sides of {SMALLEST} to {LARGEST}")
    folder = _new_folder(args.output)
    values = patch_values(args.count)
    names = [f"patch-{k + 1:0{len(str(len(values)))}d}.png" for k in range(len(values))]
    with Progress("patches") as progress, whole_folder(folder, TABLE) as temporary:
        for k, (name, value) in enumerate(zip(names, values, strict=True)):
            progress(k / len(values), name)
            _write_picture(temporary / name, value, f"{k + 1} of {len(values)}", args.size)
        (temporary / CHART).write_text(chart_text(values), encoding="ascii", newline="\n")
        rows = ((k + 1, names[k], *value, "", "", "") for k, value in enumerate(values))
        write_csv(temporary / TABLE, HEADINGS, rows)
    if args.json:
        print(json.dumps({"folder": str(folder), "patches": [list(v) for v in values]}))
        return 0
    table = folder / TABLE
    print(f"{printable(folder)}: {len(values)} pictures, {TABLE} to fill in, {CHART} for dispread")
    print(f"  fill in X, Y, Z in cd/m2 of each patch in {printable(table)}, then:")
    print(f"  {command_line(['relgloss', 'display', table, '-o', 'monitor.toml'])}")
    return 0


def _new_folder(name: str) -> Path:
    """A folder that is new or empty: one that was written before may hold readings."""
    folder = Path(name)
    if not name or (os.path.lexists(folder) and not folder.is_dir()):
        raise InputError(f"{name or '-o'}: expected the name of a new folder")
    if folder.is_dir() and not all(is_temporary(entry.name) for entry in folder.iterdir()):
        raise InputError(
            f"{name}: the folder holds files, maybe with readings; choose a new one with -o"
        )
    return folder


def _write_picture(file: Path, value: tuple[int, int, int], words: str, size: Any) -> None:
    """A patch in the middle of a gray surround, with its number; digital values without profile."""
    import numpy as np
    from PIL import Image, ImageDraw

    from relgloss_view.picture.output.lettering import Lettering
    from relgloss_view.picture.output.png import write_png8

    width, height = size
    image = Image.new("RGB", size, (SURROUND,) * 3)
    pen = ImageDraw.Draw(image)
    side = int(PATCH_SHARE * min(size))
    left, top = (width - side) // 2, (height - side) // 2
    pen.rectangle((left, top, left + side - 1, top + side - 1), fill=value)
    height_px = max(height // 40, 8)
    Lettering(height_px).draw(pen, (height_px, height - 2 * height_px), words, INK)
    pixels: Bytes = np.asarray(image)
    write_png8(file, pixels, {}, None)
