"""How a measured table is to be read: the options of every command that takes one."""

from __future__ import annotations

import argparse
from typing import Any


def add_table_options(parser: argparse.ArgumentParser) -> None:
    """Declare --quantity, --gamma-s-deg, --mirror, --angle-unit and --part."""
    from relgloss_view.measure.quantity import QUANTITIES
    from relgloss_view.measure.readers.declared import MIRRORS
    from relgloss_view.measure.readers.headings import DEGREES, RADIANS

    parser.add_argument(
        "--quantity",
        choices=QUANTITIES,
        help="Quantity that the table holds, if it does not state it",
    )
    parser.add_argument(
        "--gamma-s-deg",
        metavar="DEG",
        type=float,
        help="Tilt of the table at which the receiver sees the mirror direction",
    )
    parser.add_argument(
        "--mirror",
        choices=MIRRORS,
        help="Side on which the receiver's angles put the mirror direction: opposite to the lamp "
        "(default), or the same side (beta = +alpha, or equal azimuths)",
    )
    parser.add_argument(
        "--angle-unit",
        choices=(DEGREES, RADIANS),
        help="Unit of the table's angles, if it does not state it",
    )
    parser.add_argument(
        "--part",
        metavar="NAME",
        help="Name or number of the sample or surface to read from a file that holds several",
    )


def table_options(args: argparse.Namespace) -> dict[str, Any]:
    """What the command line declares of a table, by the names of `read_measurement`."""
    return {
        "quantity": args.quantity,
        "gamma_s_deg": args.gamma_s_deg,
        "angle_unit": args.angle_unit,
        "mirror": args.mirror,
        "part": args.part,
    }
