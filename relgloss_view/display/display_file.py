"""Display files (TOML): what a monitor shows, as a fit to readings found it or as a profile has it.

A file holds a fitted model, [model], or names an ICC profile that lies beside it. [display] sets
the luminance, the black and the reflected light of the place; [fit] keeps where a model comes from.
"""

from __future__ import annotations

import dataclasses
import itertools
import os
import re
from typing import TYPE_CHECKING, Any, NoReturn

import numpy as np

from relgloss_view.base.errors import InputError
from relgloss_view.base.icc.profile import MOST_BYTES as MOST_PROFILE_BYTES
from relgloss_view.base.reading import number, numbers_of, printable, read_bytes, refuse, text
from relgloss_view.base.toml import read_toml, write_toml
from relgloss_view.display.fitted_monitor import monitor_of_numbers
from relgloss_view.display.icc_monitor import monitor_of_profile
from relgloss_view.display.monitor import Monitor, Numbers

if TYPE_CHECKING:
    from relgloss_view.display.fit import DisplayFit

FORMAT, VERSION = "relgloss-display", 1
EXPECTED = "a display file (TOML) that `relgloss display` wrote"
MOST_BYTES = 1 << 20
MOST_SAMPLES = 4097
MOST_NOTES = 100
KINDS = ("gain-offset-gamma", "curves")
_DISPLAY = {"luminance_cd_m2": (1.0, 1e4), "black_cd_m2": (0.0, 1e3), "reflected_cd_m2": (0.0, 1e4)}
_MODEL = {"kind", "xyz_from_rgb", "floor", "black_known", "offset", "gamma", "samples"}
_SIGN = re.compile(rb"^\s*format\s*=\s*[\"']relgloss-display", re.M)


def is_display_file(data: bytes) -> bool:
    """Whether a file's bytes are those of a display file.

    >>> is_display_file(b'format = "relgloss-display"\\nversion = 1')
    True
    """
    return _SIGN.search(data[:4096]) is not None


def write_display(
    path: str | os.PathLike[str],
    monitor: Monitor,
    fit: DisplayFit | None = None,
    *,
    profile: str = "",
) -> None:
    """Write a display file, whole or not at all.

    monitor: of a fit (`DisplayFit.monitor`), or of an ICC profile; its luminance, black and
    reflected light are written (`dataclasses.replace` sets them). fit: what [fit] keeps. profile:
    the name of the ICC profile, a file beside `path`. Raises InputError where there is neither a
    model nor a profile, and where the place can't be written.
    """
    tables: dict[str, Any] = {"format": FORMAT, "version": VERSION, "name": monitor.name}
    own: dict[str, Any] = {}
    if monitor.luminance_cd_m2 is not None:
        own["luminance_cd_m2"] = float(monitor.luminance_cd_m2)
    if monitor.black_cd_m2 is not None:
        own["black_cd_m2"] = float(monitor.black_cd_m2)
    if monitor.reflected_cd_m2:
        own["reflected_cd_m2"] = float(monitor.reflected_cd_m2)
    if profile:
        _check_beside("profile", profile)
        own["profile"] = profile
    elif monitor.fitted is None:
        raise InputError(
            f"{path}: a display file needs a fitted model or the name of an ICC profile beside it"
        )
    tables["display"] = own
    if monitor.fitted is not None and not profile:
        tables["model"] = _model_table(monitor.fitted, monitor.black_known)
    if fit is not None:
        tables["fit"] = _fit_table(fit)
    elif monitor.notes and not profile:
        tables["fit"] = {"verdict": monitor.verdict, "notes": list(monitor.notes)}
    write_toml(path, tables)


def read_display(path: str | os.PathLike[str]) -> Monitor:
    """The monitor of a display file. Raises InputError: one line with the entry and the remedy."""
    tables = read_toml(path, MOST_BYTES, EXPECTED)
    try:
        return _monitor(os.fspath(path), tables)
    except InputError as error:
        raise InputError(f"{path}: {error}") from None


def _monitor(path: str, tables: dict[str, Any]) -> Monitor:
    if tables.get("format") != FORMAT:
        raise InputError(f'no display file; expected format = "{FORMAT}"')
    version = tables.get("version")
    if version != VERSION or isinstance(version, bool):
        raise InputError(
            f"version {printable(version, 20)}: this program reads version {VERSION}; use the "
            "program that wrote it, or a newer relgloss"
        )
    _only(tables, {"format", "version", "name", "display", "model", "fit"}, "")
    own = _table(tables, "display")
    _only(own, {*_DISPLAY, "profile"}, "display.")
    values = {
        key: number(own[key], f"display.{key}", f"a number from {low:g} to {high:g}", low, high)
        for key, (low, high) in _DISPLAY.items()
        if key in own
    }
    fit = _table(tables, "fit")
    notes = (*_texts(fit, "warnings"), *_texts(fit, "notes"))
    verdict = text(fit.get("verdict", ""), "fit.verdict")
    if verdict not in ("", "good", "poor"):
        refuse("fit.verdict", '"good" or "poor"', verdict)
    name = printable(text(tables.get("name", os.path.basename(path)), "name"), 200)
    if "profile" in own:
        if "model" in tables:
            raise InputError("[model] beside display.profile; keep one of the two")
        monitor = _of_profile(path, text(own["profile"], "display.profile"), name)
    else:
        numbers, black_known = _numbers(_table(tables, "model"))
        monitor = monitor_of_numbers(numbers, name, None, black_known, notes)
    luminance = values.get("luminance_cd_m2", monitor.luminance_cd_m2)
    black = values.get("black_cd_m2")
    if black is not None and luminance is not None and black >= luminance:
        raise InputError(f"display.black_cd_m2 {black:g}: not below the luminance {luminance:g}")
    return dataclasses.replace(
        monitor,
        luminance_cd_m2=luminance,
        black_cd_m2=black,
        black_known=monitor.black_known or black is not None,
        reflected_cd_m2=values.get("reflected_cd_m2", 0.0),
        verdict=verdict,
    )


def _of_profile(path: str, name: str, title: str) -> Monitor:
    _check_beside("display.profile", name)
    beside = os.path.join(os.path.dirname(path), name)
    data = read_bytes(beside, MOST_PROFILE_BYTES, "the ICC profile that the display file names")
    try:
        monitor = monitor_of_profile(data, title)
    except ValueError as error:
        raise InputError(f"display.profile {printable(name, 60)}: {error}") from None
    return dataclasses.replace(monitor, name=title, beside=(beside,))


def _check_beside(entry: str, name: str) -> None:
    """InputError unless a name is that of a file in the same folder."""
    if not name or os.path.basename(name) != name or name in (".", "..") or "\\" in name:
        raise InputError(
            f"{entry} {printable(name, 60)!r}: expected the name of a file beside the display file"
        )


def _numbers(model: dict[str, Any]) -> tuple[Numbers, bool]:
    """The numbers of [model], and whether the black was read."""
    if not model:
        raise InputError("neither [model] nor display.profile; one of them describes the display")
    _only(model, _MODEL, "model.")
    kind = model.get("kind")
    if kind not in KINDS:
        refuse("model.kind", " or ".join(f'"{k}"' for k in KINDS), kind)
    rows = model.get("xyz_from_rgb")
    if not (isinstance(rows, list) and len(rows) == 3):
        refuse("model.xyz_from_rgb", "three rows of three numbers", rows)
    matrix = tuple(
        _three(row, f"model.xyz_from_rgb[{k}]", -10.0, 10.0) for k, row in enumerate(rows)
    )
    floor = _three(model.get("floor"), "model.floor", -0.5, 0.999)
    _check_matrix(np.array(matrix))
    black_known = model.get("black_known", False)
    if not isinstance(black_known, bool):
        refuse("model.black_known", "true or false", black_known)
    if kind == "gain-offset-gamma":
        _absent(model, ("samples",))
        offset = _three(model.get("offset"), "model.offset", -0.5, 0.5)
        gamma = _three(model.get("gamma"), "model.gamma", 0.2, 10.0)
        return Numbers(kind, matrix, floor, offset, gamma), black_known
    _absent(model, ("offset", "gamma"))
    curves = model.get("samples")
    if not (isinstance(curves, list) and len(curves) == 3):
        refuse("model.samples", "three lists of light, 0 to 1", curves)
    samples = tuple(_curve(curve, f"model.samples[{k}]") for k, curve in enumerate(curves))
    return Numbers(str(kind), matrix, floor, samples=samples), black_known


def _check_matrix(matrix: np.ndarray[Any, np.dtype[np.float64]]) -> None:
    white = matrix.sum(axis=1)
    if not (abs(white[1] - 1.0) < 1e-3 and white.min() > 0.01 and white.max() < 100.0):
        raise InputError(
            "model.xyz_from_rgb: its rows add to white, of which Y is 1 and X and Z are above 0"
        )
    if np.linalg.cond(matrix) > 1e6:
        raise InputError("model.xyz_from_rgb: the three primaries lie on a line")


def _curve(values: object, place: str) -> tuple[float, ...]:
    if not (isinstance(values, list) and 2 <= len(values) <= MOST_SAMPLES):
        refuse(place, f"2 to {MOST_SAMPLES} numbers from 0 to 1", values)
    curve = numbers_of(values, place, "a number from 0 to 1", 0.0, 1.0)
    if any(b < a for a, b in itertools.pairwise(curve)) or curve[0] == curve[-1]:
        raise InputError(f"{place}: expected a rising curve, from black to white")
    return curve


def _three(values: object, place: str, low: float, high: float) -> tuple[float, float, float]:
    expected = f"three numbers from {low:g} to {high:g}"
    if not (isinstance(values, list) and len(values) == 3):
        refuse(place, expected, values)
    a, b, c = numbers_of(values, place, f"a number from {low:g} to {high:g}", low, high)
    return a, b, c


def _absent(model: dict[str, Any], keys: tuple[str, ...]) -> None:
    for key in keys:
        if key in model:
            raise InputError(f"model.{key}: not of this kind of model; delete the entry")


def _only(table: dict[str, Any], keys: set[str], within: str) -> None:
    for key in table:
        if key not in keys:
            raise InputError(
                f"{within}{printable(key, 60)}: no such entry; expected one of "
                f"{', '.join(sorted(keys))}"
            )


def _table(tables: dict[str, Any], name: str) -> dict[str, Any]:
    table = tables.get(name, {})
    if not isinstance(table, dict):
        _refuse_table(name, table)
    return table


def _refuse_table(name: str, found: object) -> NoReturn:
    refuse(f"[{name}]", "a table", found)


def _texts(table: dict[str, Any], key: str) -> tuple[str, ...]:
    values = table.get(key, [])
    if not (isinstance(values, list) and len(values) <= MOST_NOTES):
        refuse(f"fit.{key}", f"a list of at most {MOST_NOTES} texts", values)
    return tuple(printable(text(v, f"fit.{key}[{k}]"), 600) for k, v in enumerate(values))


def _model_table(numbers: Numbers, black_known: bool) -> dict[str, Any]:
    table: dict[str, Any] = {
        "kind": numbers.kind,
        "xyz_from_rgb": [list(row) for row in numbers.xyz_from_rgb],
        "floor": list(numbers.floor),
        "black_known": black_known,
    }
    if numbers.kind == "gain-offset-gamma":
        return table | {"offset": list(numbers.offset), "gamma": list(numbers.gamma)}
    return table | {"samples": [list(curve) for curve in numbers.samples]}


def _fit_table(fit: DisplayFit) -> dict[str, Any]:
    errors = fit.errors
    return {
        "verdict": fit.verdict,
        "source": os.path.basename(fit.source),
        "patches": fit.patches,
        "seed": fit.seed,
        "mean_de2000": round(errors.mean, 4),
        "p95_de2000": round(errors.p95, 4),
        "largest_de2000": round(errors.largest, 4),
        "unseen_mean_de2000": round(errors.unseen_mean, 4),
        "gamut_area_of_srgb": round(fit.gamut_area, 4),
        "gamut_share_of_srgb": round(fit.gamut_share, 4),
        "misread": list(fit.misread),
        "warnings": list(fit.warnings),
        "notes": list(fit.notes),
        "candidates": [
            {
                "name": c.name,
                "score": round(c.score, 4),
                "excess": round(c.excess, 4),
                "excess_se": round(c.excess_se, 4),
                "mean_de2000": round(c.mean_de2000, 4),
                "chosen": c.chosen,
            }
            for c in fit.candidates
        ],
    }
