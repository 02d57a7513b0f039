"""How a measured table is fitted: the options of every command that fits some."""

from __future__ import annotations

import argparse
from typing import Any

from relgloss_view.base.errors import InputError


def add_fit_options(parser: argparse.ArgumentParser) -> None:
    """Declare --model and --refractive-index."""
    from relgloss_view.fitting.fit import MODELS

    parser.add_argument(
        "--model",
        choices=MODELS,
        default="auto",
        help="Model to fit, or auto: the smallest that is enough (default auto)",
    )
    parser.add_argument(
        "--refractive-index",
        metavar="N",
        type=float,
        help="Refractive index of the lobes, held fixed in the fit (default: 1.5, fitted where the "
        "samples show another)",
    )


def fit_options(args: argparse.Namespace) -> dict[str, Any]:
    """What the command line asks of a fit, by the names of `fit_material`.

    Raises InputError for a refractive index that no lobe has.
    """
    from relgloss_view.material.material import INDEX_RANGE

    index = args.refractive_index
    if index is not None and not INDEX_RANGE[0] < index <= INDEX_RANGE[1]:
        raise InputError(
            f"--refractive-index {index:g}: expected above {INDEX_RANGE[0]:g}, at most "
            f"{INDEX_RANGE[1]:g}"
        )
    return {"model": args.model, "refractive_index": index}
