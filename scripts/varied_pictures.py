"""Draw many pictures that differ in everything, in one process, and log what it holds.

Usage: python scripts/varied_pictures.py [--count N] [--seed N] [--most-mb MB]

Each picture has a material, form, lamp, eye, display, grain and size of its own, all by chance over
the declared ranges; every tenth goes through all stages, a tone-mapping operator and a material
file as well. The status is 1 where the process ever held more than --most-mb.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

SMALLEST_PX, LARGEST_PX = 16, 128
GRAINS = ("screen", "surface", "eye", None)
LINES = 20  #: of the log
ALL_STAGES_EVERY = 10


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--count", type=int, default=20_000, help="of pictures (default 20000)")
    parser.add_argument("--seed", type=int, default=0, help="of the first picture (default 0)")
    parser.add_argument("--most-mb", type=float, default=300.0, help="of memory (default 300)")
    args = parser.parse_args()
    sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "stability"))
    with tempfile.TemporaryDirectory() as folder:
        return draw(args, Path(folder))


def draw(args: argparse.Namespace, folder: Path) -> int:
    """Draw them; returns the status."""
    from random_scenes import random_scene  # type: ignore[import-not-found]

    from relgloss_view.base.errors import InputError
    from relgloss_view.picture.gpu.context import open_context
    from relgloss_view.picture.gpu.renderer import Renderer
    from relgloss_view.quality.planner import MethodChooser

    renderer = Renderer(open_context(), choose=MethodChooser().method)
    rng = np.random.default_rng(args.seed)
    began_s, refused = time.monotonic(), 0
    for k in range(args.count):
        seed = args.seed + k
        width, height = (int(side) for side in rng.integers(SMALLEST_PX, LARGEST_PX + 1, 2))
        scene, look = random_scene(seed, grain=GRAINS[seed % len(GRAINS)])
        try:
            frame = renderer.render(scene, look, (width, height))
            _ = frame.display
            if k % ALL_STAGES_EVERY == 0:
                all_stages(frame, folder, k)
        except InputError:
            refused += 1
        if (k + 1) % max(args.count // LINES, 1) == 0:
            now, most = resident_mb()
            print(
                f"{k + 1} pictures, {time.monotonic() - began_s:.0f} s: {now:.0f} MB (most "
                f"{most:.0f}), programs {renderer.programs.count} of "
                f"{renderer.programs.compiled} compiled, {refused} refused",
                flush=True,
            )
    return int(resident_mb()[1] > args.most_mb)


def all_stages(frame: object, folder: Path, k: int) -> None:
    """Every stage of a picture, one by an operator, and its material through a file."""
    from typing import Any

    from relgloss_view.material.files import load_material, save_material
    from relgloss_view.operators.registry import OPERATORS, make_operator

    drawn: Any = frame
    _ = drawn.diffuse, drawn.specular, drawn.light, drawn.lab, drawn.normal, drawn.point_m
    _ = drawn.clip_count, drawn.warnings
    names = list(OPERATORS)
    _ = make_operator(names[(k // ALL_STAGES_EVERY) % len(names)]).draw(drawn).digital
    path = folder / "material.json"
    save_material(drawn.scene.material, path)
    load_material(path)


def resident_mb() -> tuple[float, float]:
    """The process's memory now, and at most so far, in MB of 10^6 bytes."""
    with open("/proc/self/status", encoding="ascii") as file:
        lines = dict(line.split(":", 1) for line in file)
    now, most = (int(lines[name].split()[0]) * 1024 / 1e6 for name in ("VmRSS", "VmHWM"))
    return now, most


if __name__ == "__main__":
    sys.exit(main())
