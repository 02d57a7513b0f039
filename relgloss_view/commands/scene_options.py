"""The options that say what to draw, shared by the commands that draw."""

from __future__ import annotations

import argparse
import ast
import dataclasses
import re
import shlex
from collections.abc import Sequence
from typing import Any

from relgloss_view.base.errors import InputError
from relgloss_view.material.files import load_material
from relgloss_view.picture.backends import BACKENDS
from relgloss_view.picture.model.view import check_size
from relgloss_view.picture.scene.look import QUALITIES, Look
from relgloss_view.picture.scene.samples import DEFAULT_SAMPLE, SAMPLES, load_sample
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.scene_file import TABLES, build, load_scene

DEFAULT_SIZE = (512, 512)
AUTO = "auto"


def add_scene_options(
    parser: argparse.ArgumentParser, *, tuned: bool = True, sourced: bool = True
) -> None:
    """Declare the options; `tuned` adds those of the look that a grid varies itself.

    `sourced` adds those that name the sample, which some commands take as words of their own.
    """
    what = parser.add_argument_group("what to draw")
    if sourced:
        source = what.add_mutually_exclusive_group()
        source.add_argument(
            "--sample",
            metavar="NAME",
            help=f"a built-in synthetic paper: {', '.join(SAMPLES)} (default {DEFAULT_SAMPLE})",
        )
        source.add_argument("--material", metavar="FILE.json", help="a material that `fit` wrote")
    else:
        parser.set_defaults(sample=None, material=None)
    what.add_argument(
        "--scene", metavar="FILE.toml", help="a scene file; options override its entries"
    )
    what.add_argument(
        "--set",
        metavar="NAME=VALUE",
        action="append",
        default=[],
        help="any entry of a scene file, such as lamp.azimuth_deg=80 or shape.kind=sphere",
    )
    how = parser.add_argument_group("how it looks")
    if tuned:
        how.add_argument("--sigma-n", metavar="DEG", type=float, help="sd of the normal's tilt")
        scale = how.add_mutually_exclusive_group()
        scale.add_argument("--c", metavar="VALUE", type=float, help="scaling of the specular L*")
        scale.add_argument(
            "--c-fraction", metavar="F", type=float, help="the same as a share of the exact c_max"
        )
        how.add_argument(
            "--matched",
            action="store_true",
            help="sigma_N and c that the paper's observers chose for this kind of paper",
        )
    how.add_argument("--seed", metavar="N", type=int, help="of the grain")
    how.add_argument(
        "--samples",
        metavar="N",
        type=_samples,
        help="samples along each side of a pixel, 1 to 16, or auto: what the highlight needs",
    )
    how.add_argument(
        "--quality",
        choices=QUALITIES,
        help="exact (default), or auto: the cheapest way of drawing that looks the same, as "
        "`relgloss plan` tells",
    )
    how.add_argument(
        "--size", metavar="WxH", type=size_of_text, default=DEFAULT_SIZE, help="in pixels"
    )
    how.add_argument(
        "--backend", choices=BACKENDS, default="auto", help="what draws (default auto: EGL, OSMesa)"
    )


def scene_from(args: argparse.Namespace) -> tuple[Scene, Look, tuple[int, int]]:
    """Scene, look and size of parsed options; InputError where they don't fit together."""
    size = check_size(args.size)
    material = None
    if args.material is not None:
        material = load_material(args.material)
    elif args.sample is not None or args.scene is None:
        material = load_sample(args.sample or DEFAULT_SAMPLE)
    if args.scene is not None:
        scene, look = load_scene(args.scene)
        scene = dataclasses.replace(scene, material=material or scene.material)
    else:
        assert material is not None
        scene, look = Scene(material), Look()
    scene, look = _with_settings(scene, look, args.set)
    if getattr(args, "matched", False):
        if args.material is not None or (args.scene is not None and args.sample is None):
            raise InputError(
                f"--matched: there are published settings for --sample {', '.join(SAMPLES)} only; "
                "give --sigma-n and --c-fraction"
            )
        matched = SAMPLES[args.sample or DEFAULT_SAMPLE]
        look = _changed(look, matched.sigma_n_deg, None, matched.c_fraction)
    look = _changed(
        look,
        getattr(args, "sigma_n", None),
        getattr(args, "c", None),
        getattr(args, "c_fraction", None),
    )
    if args.seed is not None:
        look = dataclasses.replace(look, seed=args.seed)
    if args.quality is not None:
        look = dataclasses.replace(look, quality=args.quality)
    if args.samples is not None:
        look = dataclasses.replace(look, samples=None if args.samples == AUTO else args.samples)
    return scene, look, size


def printable_command(words: Sequence[str]) -> str:
    """The command line that goes into a picture; a name that is not UTF-8 is shown escaped."""
    line = shlex.join(["relgloss", *words])
    return line.encode("utf-8", "backslashreplace").decode("utf-8")


def _changed(
    look: Look, sigma_n_deg: float | None, c: float | None, c_fraction: float | None
) -> Look:
    if sigma_n_deg is not None:
        look = dataclasses.replace(look, sigma_n_deg=sigma_n_deg)
    if c is not None or c_fraction is not None:
        look = dataclasses.replace(look, c=c, c_fraction=c_fraction)
    return look


def _with_settings(scene: Scene, look: Look, settings: list[str]) -> tuple[Scene, Look]:
    parts: dict[str, Any] = {name: getattr(scene, name) for name in TABLES if name != "look"}
    parts["look"] = look
    # All entries of a table are set together: on the way from one display to another, gain and
    # offset may not agree.
    changed: dict[str, dict[str, Any]] = {}
    for setting in settings:
        match = re.fullmatch(r"(\w+)\.(\w+)=(.*)", setting, re.DOTALL)
        if match is None or match[1] not in TABLES:
            raise InputError(
                f"--set {setting}: expected TABLE.ENTRY=VALUE with a table of {', '.join(TABLES)}"
            )
        table, entry, text = match.groups()
        present = {f.name: getattr(parts[table], f.name) for f in dataclasses.fields(parts[table])}
        changed.setdefault(table, present)[entry] = read_value(text)
    parts |= {table: build(table, values) for table, values in changed.items()}
    look = parts.pop("look")
    return dataclasses.replace(scene, **parts), look


def read_value(text: str) -> object:
    """A number, a list or a bare word."""
    try:
        return ast.literal_eval(text)
    except (ValueError, TypeError, SyntaxError, MemoryError, RecursionError):
        return text


def _samples(text: str) -> int | str:
    return AUTO if text == AUTO else int(text)


def size_of_text(text: str) -> tuple[int, int]:
    """Width and height of words such as 512x512."""
    match = re.fullmatch(r"([0-9]{1,9})[xX]([0-9]{1,9})", text)
    if match is None:
        raise argparse.ArgumentTypeError(f"expected WIDTHxHEIGHT such as 512x512, found {text!r}")
    return int(match[1]), int(match[2])
