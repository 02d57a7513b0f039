"""`relgloss display convert`: many colours through a display, so that others can check them."""

from __future__ import annotations

import argparse
import json
import sys
from typing import TYPE_CHECKING, Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable, read_bytes
from relgloss_view.base.terminal import warn
from relgloss_view.display.conversion import ABSOLUTE, INTENTS, RELATIVE, RGB, SPACES

if TYPE_CHECKING:
    from relgloss_view.base.arrays import Array

EXPECTED = "colours: three numbers a line"
MOST_BYTES = 64 << 20
MOST_COLOURS = 1_000_000
MOST_HEADS = 1  #: lines without numbers above the colours
STANDARD_INPUT = "-"
#: Magnitudes that no colour has; CIELAB and XYZ of white are 100 and 1.
LARGEST = {"rgb": 1.0, "xyz": 1e3, "lab": 1e4}
ROUNDING = 1e-6  #: beyond the range of digital values that other programs print


def add(own: Any) -> None:
    """Declare the command among those of `relgloss display`."""
    parser = own.add_parser(
        "convert",
        help="convert many colours between digital values, XYZ and CIELAB of a display",
        description="Convert colours, one a line, through what the display shows. Digital values "
        "are 0 to 1; XYZ are as emitted, with the display's white at Y = 1; CIELAB are relative to "
        "the display's white. A colour that the display can't show gets the digital values of the "
        "nearest one.",
        epilog='example: echo "0.5 0.5 0.5" | relgloss display convert monitor.icc --from rgb --to '
        "lab --pcs",
    )
    parser.add_argument("file", metavar="FILE", help="ICC profile or display file")
    parser.add_argument(
        "colours",
        metavar="COLOURS",
        nargs="?",
        default=STANDARD_INPUT,
        help="File with three numbers a line, separated by spaces, tabs, commas or semicolons "
        "(default: standard input)",
    )
    parser.add_argument(
        "--from", dest="given", choices=SPACES, required=True, help="What the numbers are"
    )
    parser.add_argument(
        "--to", dest="wanted", choices=SPACES, required=True, help="What to convert them to"
    )
    parser.add_argument(
        "--intent",
        choices=INTENTS,
        default=RELATIVE,
        help=f"{ABSOLUTE}: CIELAB are relative to D50, as ICC's absolute intent has them "
        f"(default {RELATIVE})",
    )
    parser.add_argument(
        "--pcs",
        action="store_true",
        help="XYZ and CIELAB are those of the profile connection space: adapted to D50",
    )
    parser.add_argument("--json", action="store_true", help="Print the colours as JSON")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Convert and print, one colour a line."""
    from relgloss_view.display.conversion import converted, outside
    from relgloss_view.display.read import monitor_of

    if args.pcs and args.intent == ABSOLUTE:
        raise InputError(f"--pcs: belongs to the intent {RELATIVE}; leave out --intent {ABSOLUTE}")
    monitor = monitor_of(args.file)
    values = _colours(args.colours, args.given)
    intent, pcs = args.intent, args.pcs
    result = converted(monitor, values, args.given, args.wanted, intent, pcs=pcs)
    beyond: list[bool] = []
    if args.given != RGB:
        beyond = outside(monitor, values, args.given, intent, pcs=pcs).tolist()
    count = sum(beyond)
    if args.json:
        numbers = {"values": result.tolist(), "outside": beyond}
        print(json.dumps({"from": args.given, "to": args.wanted, **numbers}))
        return 0
    print("\n".join(" ".join(f"{number + 0.0:.7f}" for number in row) for row in result))
    if count and args.wanted == RGB:
        warn(
            f"{count} of {len(values)} colours are beyond what the display shows; the digital "
            "values of the nearest ones are printed"
        )
    return 0


def _colours(name: str, space: str) -> Array:
    """The numbers (N, 3) of a file or of standard input. InputError with the line."""
    import numpy as np

    place, text = _text(name)
    rows: list[tuple[float, ...]] = []
    heads = 0
    for number, line in enumerate(text.splitlines(), 1):
        words = line.partition("#")[0].replace(",", " ").replace(";", " ").split()
        if not words:
            continue
        values = _numbers(words)
        if values is None and not rows and heads < MOST_HEADS:
            heads += 1
            continue
        if values is None:
            raise InputError(
                f"{place}: line {number}: found {printable(line.strip(), 60)!r}; expected three "
                "numbers with decimal points"
            )
        _check(values, space, f"{place}: line {number}")
        if len(rows) == MOST_COLOURS:
            raise InputError(f"{place}: more than {MOST_COLOURS} colours; split the file")
        rows.append(values)
    if not rows:
        raise InputError(f"{place}: no colours; give three numbers a line")
    colours = np.array(rows)
    return np.clip(colours, 0.0, 1.0) if space == RGB else colours


def _numbers(words: list[str]) -> tuple[float, ...] | None:
    """Three finite numbers of words; None where they are none."""
    try:
        values = tuple(float(word) for word in words)
    except ValueError:
        return None
    finite = all(abs(value) < float("inf") for value in values)
    return values if len(values) == 3 and finite else None


def _check(values: tuple[float, ...], space: str, place: str) -> None:
    largest = LARGEST[space]
    low = -ROUNDING if space == RGB else -largest
    wrong = next((v for v in values if not low <= v <= largest + ROUNDING), None)
    if wrong is None:
        return
    if space == RGB:
        raise InputError(
            f"{place}: a digital value of {wrong:g}; expected 0 to 1 (divide 8-bit values by 255)"
        )
    raise InputError(f"{place}: found {wrong:g}; expected numbers of {space}, white at Y = 1")


def _text(name: str) -> tuple[str, str]:
    """What the colours are read from, for messages, and its text."""
    if name == STANDARD_INPUT:
        place = "standard input"
        if sys.stdin is None:
            raise InputError(f"{place}: is closed; give a file with {EXPECTED}")
        source = getattr(sys.stdin, "buffer", sys.stdin)
        data = source.read(MOST_BYTES + 1)
        if len(data) > MOST_BYTES:
            raise InputError(f"{place}: more than {MOST_BYTES} bytes; give fewer colours")
        if isinstance(data, str):
            return place, data
    else:
        place = printable(name)
        data = read_bytes(name, MOST_BYTES, EXPECTED)
    try:
        return place, data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(f"{place}: byte {error.start}: not UTF-8 text; give {EXPECTED}") from None
