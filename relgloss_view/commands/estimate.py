"""`relgloss estimate`: a material from gloss-meter readings and a colour, with no gonio table."""

from __future__ import annotations

import argparse
import json
import math
import os
import re
from itertools import pairwise
from typing import TYPE_CHECKING, Any

from relgloss_view.base.decoration import decoration
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.base.terminal import WARNING_LENGTH
from relgloss_view.base.writing import check_writable
from relgloss_view.commands.lab_text import lab_words

if TYPE_CHECKING:
    from relgloss_view.fitting.estimate.colour import LabColour
    from relgloss_view.fitting.estimate.given import GlossReading
    from relgloss_view.measure.spectrum import ColourReading

#: A reading, with the units that people write: degrees, gloss units, or percent (JIS Z 8741).
_READING = re.compile(r"(\S+?)\s*(?:°|deg|degrees)?\s*=\s*(\S+?)\s*(?:GU|%)?", re.IGNORECASE)
#: The space before another reading.
LONGEST_GLOSS = 500  #: characters of all readings
_NEXT_READING = re.compile(r"\s+(?=[\d.]+\s*(?:°|deg|degrees)?\s*=)", re.IGNORECASE)


def add(commands: Any) -> None:
    """Declare the command."""
    from relgloss_view.measure.spectrum import GEOMETRIES

    parser = commands.add_parser(
        "estimate",
        description="Estimate a material from gloss-meter readings and a colour, where there is no "
        "goniophotometer table. Many materials give the same readings: the file holds the most "
        "plausible one, with 95 % intervals of its numbers, and is marked as estimated.",
        epilog="example: relgloss estimate --gloss 20=3.8,60=30.3,85=30.9 --lab 59,-58,45 "
        "-o art.json --report art.png",
    )
    parser.add_argument(
        "--gloss",
        metavar="ANGLE=VALUE,...",
        help="Gloss units at one or more of 20, 60, 85 degrees (ISO 2813, ASTM D523) and 75 "
        "(TAPPI T 480), such as 20=12.3,60=45",
    )
    colour = parser.add_mutually_exclusive_group()
    colour.add_argument(
        "--lab", metavar="L,a,b", help="Colour as CIELAB L*, a*, b* of the 2 degree observer"
    )
    colour.add_argument(
        "--spectrum",
        metavar="FILE",
        help="Colour as a reflectance spectrum, as a spectrophotometer exports it",
    )
    parser.add_argument(
        "--lab-illuminant",
        metavar="NAME|FILE",
        help="Lamp of --lab, a name or a file (default D50)",
    )
    parser.add_argument(
        "--part", metavar="NAME", help="Sample of a spectrum file that holds several"
    )
    parser.add_argument(
        "--measured",
        choices=GEOMETRIES,
        help="Geometry of the colour: 45-0 (default), or a sphere that includes (d-8-sci) or "
        "excludes (d-8-sce) the specular part",
    )
    parser.add_argument(
        "--gloss-error",
        metavar="UNITS",
        type=float,
        help="Standard error of each gloss reading (default 0.3 units and 1 %% of the reading)",
    )
    parser.add_argument(
        "-o", "--output", metavar="MATERIAL.json", required=True, help="File of the material"
    )
    parser.add_argument(
        "--report",
        metavar="OUT.png",
        help="Draw the dullest, the likeliest and the glossiest material into this file",
    )
    parser.add_argument("--name", help="Name of the material (default: that of the output file)")
    parser.add_argument(
        "--seed", metavar="N", type=int, default=0, help="Seed of the random draws (default 0)"
    )
    parser.add_argument("--json", action="store_true", help="Print the material as JSON")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Read, estimate, write, then draw and print."""
    if args.gloss is None:
        raise InputError(
            "--gloss is missing: give at least one reading such as 60=45. For another colour on "
            "the gloss of a built-in paper: `relgloss snapshot --sample art-coated --lab L,a,b`"
        )
    _check_places(args)
    if args.lab_illuminant is not None and args.lab is None:
        raise InputError("--lab-illuminant: belongs to --lab, which is missing")
    if args.part is not None and args.spectrum is None:
        raise InputError("--part: belongs to --spectrum, which is missing")
    readings = gloss_readings_of(args.gloss, args.gloss_error)
    colour = _colour(args)

    from relgloss_view.fitting.estimate.describe import describe_estimate
    from relgloss_view.fitting.estimate.estimate import estimate
    from relgloss_view.material.files import material_to_dict, save_material

    name = args.name or os.path.splitext(os.path.basename(args.output))[0]
    found = estimate(readings, colour, geometry=args.measured, name=name, seed=args.seed)
    save_material(found.material, args.output)
    status, drawn = 0, None
    if args.report:
        from relgloss_view.commands.scene_options import printable_command
        from relgloss_view.fitting.estimate.report import write_estimate_report

        with decoration(f"{args.report}: the report", f"{args.output} is written") as sheet:
            drawn = write_estimate_report(found, args.report, printable_command(args.argv))
        status = 0 if sheet.done else 1
    if args.json:
        report = {"report": args.report} if drawn else {}
        print(json.dumps({"output": args.output, **report, **material_to_dict(found.material)}))
        return status
    print(describe_estimate(found.material, WARNING_LENGTH))
    for text in drawn or ():
        print(f"  {text}")
    print(f"{printable(args.output)}: written")
    if drawn:
        print(f"{printable(args.report)}: written")
    return status


def gloss_readings_of(text: str, error: float | None = None) -> tuple[GlossReading, ...]:
    """Readings of words such as 20=12.3,60=45; InputError where one is wrong or comes twice.

    error: standard error in gloss units, None for the usual one. The digits as typed are a
    reading's precision: 45 may be 44.5 to 45.5.
    """
    from relgloss_view.fitting.estimate.given import last_digit, reading_of

    if len(text) > LONGEST_GLOSS:
        raise InputError(
            f"--gloss {printable(text, 60)}: is too long; give a reading for each angle"
        )
    readings: dict[float, GlossReading] = {}
    for word in _reading_words(text):
        parts = _READING.fullmatch(word)
        if parts is None or not all(_is_number(part) for part in parts.groups()):
            raise InputError(
                f"--gloss {printable(word, 60)}: expected ANGLE=VALUE such as 60=45, with a "
                "decimal point and a comma between readings: 20=12.3,60=45"
            )
        angle, value = parts.groups()
        reading = reading_of(float(angle), float(value), error=error, step=last_digit(value))
        if reading.angle_deg in readings:
            raise InputError(f"--gloss {angle}: appears twice; give each angle once")
        readings[reading.angle_deg] = reading
    if not readings:
        raise InputError("--gloss: expected at least one reading such as 60=45")
    return tuple(readings[angle] for angle in sorted(readings))


def _reading_words(text: str) -> list[str]:
    """The readings of a text, each a word. Between semicolons a comma is a decimal one."""
    if ";" in text:
        pieces = [
            piece.replace(",", ".") if piece.count("=") == 1 else piece
            for part in text.split(";")
            for piece in ([part] if part.count("=") == 1 else part.split(","))
        ]
    else:
        pieces = text.split(",")
        for before, piece in pairwise(pieces):
            if piece.strip().isdigit() and "=" in before:
                comma = f"{before.strip()},{piece.strip()}"
                raise InputError(
                    f"--gloss {printable(comma, 60)}: has no angle after the comma; write decimals "
                    f"with a point ({printable(comma.replace(',', '.'), 60)}) and a reading as "
                    "ANGLE=VALUE"
                )
    words = [word.strip() for piece in pieces for word in _NEXT_READING.split(piece)]
    return [word for word in words if word]


def _is_number(text: str) -> bool:
    try:
        return math.isfinite(float(text))
    except ValueError:
        return False


def _colour(args: argparse.Namespace) -> LabColour | ColourReading | None:
    if args.spectrum is not None:
        from relgloss_view.measure.readers.spectrum import read_spectrum

        return read_spectrum(args.spectrum, part=args.part)
    if args.lab is None:
        return None
    from relgloss_view.fitting.estimate.colour import LIGHTNESS_ERROR, LabColour
    from relgloss_view.fitting.estimate.given import last_digit

    words = lab_words(args.lab)
    if len(words) != 3 or not all(_is_number(word) for word in words):
        raise InputError(
            f"--lab {printable(args.lab, 60)}: expected three numbers L,a,b such as 46,-50,25"
        )
    lightness, a, b = (float(word) for word in words)
    error = math.hypot(LIGHTNESS_ERROR, last_digit(words[0]) / math.sqrt(12.0))
    return LabColour((lightness, a, b), args.lab_illuminant or "D50", error)


def _check_places(args: argparse.Namespace) -> None:
    """Refuse names that are wrong, the same or not writable, before any work."""
    places = {"-o": (args.output, ".json"), "--report": (args.report, ".png")}
    seen = {os.path.realpath(args.spectrum.replace("\0", ""))} if args.spectrum else set()
    for option, (path, suffix) in places.items():
        if path is None:
            continue
        if not path.lower().endswith(suffix):
            raise InputError(
                f"{option} {path or repr(path)}: expected a name that ends in {suffix}"
            )
        check_writable(path)
        real = os.path.realpath(path.replace("\0", ""))
        if real in seen:
            raise InputError(f"{option} {path}: is also another file of this command")
        seen.add(real)
