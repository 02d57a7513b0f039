"""The options that say what to draw, shared by the commands that draw."""

from __future__ import annotations

import argparse
import dataclasses
import re
from collections.abc import Sequence
from typing import Any

from relgloss_view.base import shell
from relgloss_view.base.errors import InputError
from relgloss_view.base.shell import command_line
from relgloss_view.base.terminal import Progress
from relgloss_view.base.toml import AUTO
from relgloss_view.base.words import sentence_case
from relgloss_view.commands.artwork_options import (
    ARTWORK_OPTIONS,
    add_artwork_options,
    artwork_entries,
)
from relgloss_view.commands.lab_text import lab_words
from relgloss_view.material.recolour import DEFAULT_ILLUMINANT, Colour
from relgloss_view.pack.kinds import SHIPPED
from relgloss_view.pack.masks import check_masks
from relgloss_view.pack.pack_file import read_pack
from relgloss_view.pack.quick import quick_pack
from relgloss_view.picture.model.lamp_placement import lit_for_gloss
from relgloss_view.picture.model.view import check_size
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.options import (
    FURTHER,
    FURTHER_METAVAR,
    GIVEN_LAMP,
    LAMP,
    LAMP_CHOICES,
    NEW_DISPLAY,
    NO_LAMP,
    OPTIONS,
    SET,
    SETTING_ENTRIES,
    Option,
    colour_words,
    wants_auto_lamp,
    with_further_lamps,
    with_options,
    with_settings,
)
from relgloss_view.picture.scene.pack_settings import (
    PACK_AMBIENT,
    pack_settings,
    with_pack_settings,
)
from relgloss_view.picture.scene.sample import DEFAULT_SAMPLE, SAMPLES, Sample
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.scene_file import read_scene_file
from relgloss_view.picture.scene.setting import FULL_SHARE
from relgloss_view.picture.scene.setup import Setup
from relgloss_view.quality.backends import BACKENDS

DEFAULT_SIZE = (512, 512)
SOURCES = ("sample", "material", "pack", "artwork")  #: options that name the sample
MATCHED, MAX = "matched", "max"
SAMPLE_METAVAR = "SAMPLE|MATERIAL.json[=SIGMA_N,C]"
#: What a command adds to the words of an entry.
_MORE_WORDS = {
    "sigma_n_deg": ", or that of the paper's observers for a built-in paper that is matched",
    "c": f"; {MATCHED}: keeps the ratio of gloss to the reference; {MAX}: c_max of this picture "
    f"(default {MATCHED}, or what a --scene holds)",
}
GRAIN_KIND = "--grain-kind"
PAPER_LOOK = Look()  #: with the paper's grain, one a pixel


def add_scene_options(
    parser: argparse.ArgumentParser,
    *,
    tuned: bool = True,
    sourced: bool = True,
    look: Look = PAPER_LOOK,
    for_the_eye: bool = True,
) -> None:
    """Declare the options; `tuned` adds those of the look that a grid varies itself.

    `sourced` adds those that name the sample, which some commands take as words of their own.
    `look`: what the command draws where neither a scene file nor an option changes it.
    `for_the_eye`: what no option and no scene file decides is set so that the picture looks well:
    silhouettes, dither, the lamp of forms other than the cylinder. Stimuli keep the plain values.
    """
    parser.set_defaults(default_look=look, for_the_eye=for_the_eye, sourced=sourced)
    what = parser.add_argument_group("what to draw")
    if sourced:
        source = what.add_mutually_exclusive_group()
        source.add_argument(
            "--sample",
            metavar="NAME",
            help=f"Built-in synthetic paper: {', '.join(SAMPLES)} (default {DEFAULT_SAMPLE})",
        )
        source.add_argument(
            "--material", metavar="FILE.json", help="Material file that `fit` wrote"
        )
        source.add_argument(
            "--pack",
            metavar="FILE.toml|NAME",
            help="Pack file: a form, an artwork and its finishes; or one that comes with relgloss: "
            f"{', '.join(SHIPPED)}",
        )
        source.add_argument(
            "--artwork",
            metavar="FILE",
            help="Artwork (PDF, PNG, JPEG, TIFF, PSD) as a pack: --form, and finishes by the names "
            "of its plates",
        )
        add_artwork_options(what, "an --artwork")
    else:
        parser.set_defaults(**dict.fromkeys((*SOURCES, "form", *ARTWORK_OPTIONS)))
    add_colour_options(what)
    what.add_argument(
        "--scene", metavar="FILE.toml", help="Scene file to draw; the options override its entries"
    )
    what.add_argument(
        "--set",
        metavar="NAME=VALUE",
        action="append",
        default=[],
        help="Change any entry of a scene, such as lamp.azimuth_deg=80 or shape.kind=sphere",
    )
    how = parser.add_argument_group("how it looks")
    scale = how.add_mutually_exclusive_group() if tuned else how
    for option in OPTIONS:
        if not tuned and option.entry in SETTING_ENTRIES:
            continue
        forms_of_c = option.entry in ("c", "c_fraction")
        target = scale if forms_of_c else how
        target.add_argument(
            option.flag,
            metavar=f"VALUE|{MATCHED}|{MAX}" if option.entry == "c" else _metavar(option),
            type=_c_of_text
            if option.entry == "c"
            else option.read
            if option.choices is None
            else str,
            choices=option.choices,
            default=argparse.SUPPRESS,
            help=option.help_with(
                getattr(look, option.entry) if option.table == "look" else option.field.default
            )
            + _MORE_WORDS.get(option.entry, ""),
        )
    if tuned:
        how.add_argument(
            "--published",
            action="store_true",
            help="Take sigma_N and c that the paper's observers chose for this kind of paper, c as "
            "a share of this picture's c_max",
        )
    what.add_argument(
        LAMP,
        choices=LAMP_CHOICES,
        help="auto: turns the lamp, and the eye of a plane or box unless it is placed, so that a "
        "highlight lies on the form; given: leaves it where it is ("
        + (
            "default auto for forms other than the cylinder, unless --scene or --set places lamp "
            "or eye)"
            if for_the_eye
            else "default)"
        ),
    )
    what.add_argument(
        FURTHER,
        metavar=f"{FURTHER_METAVAR}|{NO_LAMP}",
        action="append",
        default=[],
        help="Add a lamp, up to three times: degrees, degrees, metres from the object, metres of "
        "radius, and intensity over the main lamp's (default 1,0,1). Write --further-lamp=-50,0 "
        "where the azimuth is negative. These lamps replace those of a --scene; none removes them",
    )
    how.add_argument(
        "--size",
        metavar="WxH",
        type=size_of_text,
        default=DEFAULT_SIZE,
        help="Size of the picture in pixels (default 512x512)",
    )
    how.add_argument(
        "--backend",
        choices=BACKENDS,
        default="auto",
        help="Renderer of the picture (default auto: EGL, then OSMesa)",
    )


def add_colour_options(parser: Any) -> None:
    """Declare --lab and --lab-illuminant, from the fields of Colour."""
    for f in dataclasses.fields(Colour):
        parser.add_argument(
            f.metadata["option"],
            metavar="L,a,b" if f.name == "lab" else "NAME|FILE",
            type=_lab_of_text if f.name == "lab" else str,
            help=sentence_case(f.metadata["meaning"]),
        )


def colour_from(args: argparse.Namespace) -> Colour | None:
    """The colour of parsed options; None without. InputError where it is none."""
    if args.lab is None:
        if args.lab_illuminant is not None:
            raise InputError("--lab-illuminant: expected --lab L,a,b beside it")
        return None
    return Colour(args.lab, args.lab_illuminant or DEFAULT_ILLUMINANT)


def _lab_of_text(word: str) -> tuple[float, ...]:
    """L, a, b of words such as 50,60,20."""
    try:
        values = tuple(float(part) for part in lab_words(word))
    except ValueError:
        values = ()
    if len(values) != 3:
        raise argparse.ArgumentTypeError(f"expected L,a,b such as 50,60,20, found {word!r}")
    return values


def scene_from(args: argparse.Namespace) -> tuple[Scene, Look, tuple[int, int]]:
    """Scene, look and size of parsed options; InputError where they don't fit together."""
    size = check_size(args.size)
    sample = sample_from(args)
    new = args.scene is None and args.for_the_eye
    setup, look = Setup(), args.default_look
    if args.scene is not None:
        content = read_scene_file(args.scene)
        setup, look = content.setup, content.look
        sample = content.sample if sample is None else sample
    elif sample is None:
        sample = Sample.built_in(DEFAULT_SAMPLE)
    if new:
        setup = setup.placed(display=NEW_DISPLAY)
    assert sample is not None
    colour = colour_from(args)
    if colour is not None and args.sourced:
        sample = sample.in_colour(colour)
    of_pack, others = pack_settings(args.set)
    if of_pack and sample.pack is None:
        raise InputError(f"{SET} {of_pack[0]}: the sample is no pack; give --pack or --artwork")
    pack = None if sample.pack is None else with_pack_settings(sample.pack, of_pack)
    if pack is not None:
        setup = setup.placed(shape=pack.shape)
        if args.scene is None:  # one small lamp leaves half black, and foil nothing to mirror
            setup = setup.with_entries("lamp", ambient=PACK_AMBIENT)
    setup, look = with_settings(setup, look, others)
    if getattr(args, "published", False):
        other = any(getattr(args, source) is not None for source in SOURCES[1:])
        if other or (args.scene is not None and args.sample is None):
            raise InputError(
                "--published: there are published settings for --sample "
                f"{', '.join(SAMPLES)} only; give --sigma-n and --c-fraction"
            )
        look = look.at(SAMPLES[args.sample or DEFAULT_SAMPLE])
    setup, look = with_options(setup, look, _values(args))
    setup = with_further_lamps(setup, args.further_lamp)
    if getattr(args, "c", None) == MAX:
        look = look.with_entries(c_fraction=FULL_SHARE)
    chosen = args.lamp if args.lamp is not None or new else GIVEN_LAMP
    if wants_auto_lamp(setup, args.set, chosen):
        own_eye = args.scene is not None or any(word.startswith("eye.") for word in args.set)
        setup = lit_for_gloss(setup, size, turn_eye=not own_eye)
    if pack is not None and setup.shape != pack.shape:
        pack = dataclasses.replace(pack, shape=setup.shape)
        check_masks(pack)
    return Scene(sample.material, setup, pack=pack), look, size


def sample_from(args: argparse.Namespace) -> Sample | None:
    """The sample that an option names; None without one. Raises InputError."""
    if args.form is not None and args.artwork is None:
        raise InputError(
            f"--form {args.form}: is that of an --artwork; a pack file has its own, and another "
            f"sample takes {SET} shape.kind={args.form}"
        )
    given = artwork_entries(args)
    if given and args.artwork is None:
        flag = f"--{next(iter(given)).replace('_', '-')}"
        raise InputError(f"{flag}: belongs to an --artwork; a pack file has an entry for it")
    if args.sample is not None:
        return Sample.built_in(args.sample)
    if args.material is not None:
        return Sample.from_file(args.material)
    if args.pack is not None:
        with Progress("pack") as progress:
            return Sample.of_pack(read_pack(args.pack, progress))
    if args.artwork is not None:
        with Progress("artwork") as progress:
            form = args.form or "can"
            return Sample.of_pack(quick_pack(args.artwork, form, given=given, progress=progress))
    return None


def scene_words_of(args: argparse.Namespace) -> list[str]:
    """The options that name and describe the scene, as they were given.

    The kind of grain is stated too, since commands begin with different kinds, and the plain values
    of a command whose pictures are not for the eye: `snapshot`, which draws the same again, has
    others.
    """
    plain = args.scene is None and not args.for_the_eye
    words = []
    for source in (*SOURCES, "form", *ARTWORK_OPTIONS, "scene"):
        value = getattr(args, source)
        words += [f"--{source.replace('_', '-')}", str(value)] if value is not None else []
    words += colour_words(colour_from(args))
    for setting in args.set:
        words += [SET, setting]
    for lamp in args.further_lamp:
        words += shell.option(FURTHER, lamp)
    values = _values(args)
    if args.scene is None and not any(s.startswith("look.grain=") for s in args.set):
        values = {GRAIN_KIND: args.default_look.grain, **values}
    if plain:
        own = {o.flag: o.field.default for o in OPTIONS if o.table == "display"}
        values = own | values
    for option in OPTIONS:
        words += option.words(values[option.flag]) if option.flag in values else []
    lamp = GIVEN_LAMP if plain and args.lamp is None else args.lamp
    words += [LAMP, lamp] if lamp is not None else []
    width, height = args.size
    return [*words, "--size", f"{width}x{height}", "--backend", args.backend]


def _values(args: argparse.Namespace) -> dict[str, Any]:
    """The values of the options that were given, by flag."""
    values = {o.flag: getattr(args, o.name) for o in OPTIONS if hasattr(args, o.name)}
    return {f: value for f, value in values.items() if f != "--c" or value not in (MATCHED, MAX)}


def wants_match(args: argparse.Namespace, look: Look) -> bool:
    """Whether c is to keep the ratio of gloss to a reference: asked for, or nothing else given.

    A scene file without c draws c_max, as such files always have.
    """
    if getattr(args, "c", None) is not None:
        return bool(args.c == MATCHED)
    given = look.c is not None or look.c_fraction is not None
    return not given and args.scene is None


def graininess_is_given(args: argparse.Namespace) -> bool:
    """Whether the words of the command line or a scene file decide on sigma_N."""
    named = any(setting.startswith("look.sigma_n_deg") for setting in args.set)
    return hasattr(args, "sigma_n") or named or args.scene is not None


def _c_of_text(text: str) -> float | str:
    """c from its word: a number, or one of MATCHED and MAX."""
    return text if text in (MATCHED, MAX) else float(text)


def _metavar(option: Option) -> str | None:
    """The name of the value in help: its unit, or N for a whole number."""
    if option.choices is not None:
        return None
    if option.is_file:
        return "FILE"
    limits = option.field.metadata["range"]
    name = "N" if option.field.metadata.get("whole") else limits.unit.upper() or "VALUE"
    return f"{name}|{AUTO}" if option.takes_auto else name


def printable_command(words: Sequence[str]) -> str:
    """The command line that goes into a picture; it can be pasted whatever the names in it."""
    return command_line(["relgloss", *words])


def size_of_text(text: str) -> tuple[int, int]:
    """Width and height of words such as 512x512."""
    match = re.fullmatch(r"([0-9]{1,9})[xX]([0-9]{1,9})", text)
    if match is None:
        raise argparse.ArgumentTypeError(f"expected WIDTHxHEIGHT such as 512x512, found {text!r}")
    return int(match[1]), int(match[2])
