"""The work on one file of a catalogue: read, fitted, metered, matched, drawn; in any process.

What comes out depends on the file's bytes, its own name and the recipe alone: neither on the folder
that it lies in, nor on the time, the process or what was worked on before.
"""

from __future__ import annotations

import contextlib
import dataclasses
import json
import math
import os
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

from relgloss_view.base.decoration import OWN_FAULT, RAISE, VARIABLE
from relgloss_view.base.errors import GLUnavailableError, InputError, RelglossError
from relgloss_view.base.reading import named, printable, sha256_of
from relgloss_view.base.visible import visible
from relgloss_view.catalogue.columns import (
    BY_NAME,
    BYTES,
    DONE,
    FAILED,
    FLAG,
    MATERIAL,
    NUMBER,
    PROOF,
    TABLE,
    TEXT,
    WHOLE,
)
from relgloss_view.catalogue.item import OF_FILE, OF_LOOK, OF_MACHINE, Fitted, Item
from relgloss_view.catalogue.recipe import Recipe
from relgloss_view.material.files import load_material, material_from_dict, material_to_dict
from relgloss_view.material.material import Lobe, Material
from relgloss_view.quality.backends import FrameRenderer, open_renderer

EXPECTED = "a table, a material or a proof"
LONGEST_FAULT = 600  #: characters

_open = threading.local()


def make_item(
    file: str, path: str, kind: str, sha256: str, recipe: Recipe, fitted: Fitted | None = None
) -> Item:
    """What a catalogue holds of one file.

    file: its absolute path. path: that in the row. kind: TABLE, MATERIAL or PROOF. sha256: of the
    bytes that the item has to be made of. fitted: from a former build under another reference; the
    file is not read then. A fault of the file is a failed Item. Raises InputError where this
    machine can't read the file at all, GLUnavailableError where it can't draw.
    """
    row: dict[str, Any] = {"path": path, "kind": kind, "sha256": sha256}
    try:
        if fitted is None:
            fitted = _fitted(Path(file), kind, sha256, recipe)
        material = material_from_dict(fitted.material)
    except _Changed:
        return _failed(row, "it was changed while it was read; build again", OF_MACHINE)
    except Exception as error:
        return _failed(row, *_fault_of(error, file, OF_FILE))
    row |= facts_of(material, fitted)
    try:
        seen, driver = look_of(material, fitted, recipe)
    except GLUnavailableError:
        raise
    except Exception as error:
        if not isinstance(error, InputError):
            with contextlib.suppress(Exception):  # a driver that has failed may fail at this too
                close_renderer()  # or its context would fail for each further item
        failed = _failed(row, *_fault_of(error, file, OF_LOOK))
        return dataclasses.replace(failed, fitted=fitted)
    row = plain_row({**row, **seen, "status": DONE})
    return Item(row, fitted.material, fitted, driver=driver)


class _Changed(Exception):
    """The file has other bytes than those that were asked for."""


def _fitted(file: Path, kind: str, sha256: str, recipe: Recipe) -> Fitted:
    """The material of a file. Raises InputError, as the readers do, and _Changed."""
    _check_readable(file)
    fitted = _MAKERS[kind](file, recipe)
    if sha256_of(file, EXPECTED)[0] != sha256:
        raise _Changed
    return fitted


def _check_readable(file: Path) -> None:
    """Raise _Unusable where this process may not read the file, whatever is in it."""
    try:
        with open(file, "rb"):
            return
    except FileNotFoundError as error:
        if file.parent.is_dir():
            raise _Changed from error
        raise _Unusable(f"{named(file)}: there is no such folder here") from error
    except PermissionError as error:
        raise _Unusable(f"{named(file)}: can't be read ({error.strerror})") from error
    except OSError:
        return  # the reader has better words


class _Unusable(InputError):
    """A fault of this machine or this user, which ends the run."""


def _from_table(file: Path, recipe: Recipe) -> Fitted:
    from relgloss_view.fitting.fit import fit_material
    from relgloss_view.measure.readers import read_measurement

    measurement = read_measurement(file, **recipe.table)
    material = fit_material(measurement, **recipe.fit)
    assert material.fit is not None
    geometries = int(material.fit.residuals.get("samples", measurement.kept.sum()))
    fit = dataclasses.replace(material.fit, seconds=0.0)  # equal input gives equal bytes
    return Fitted(material_json(dataclasses.replace(material, fit=fit)), geometries)


def _from_material(file: Path, recipe: Recipe) -> Fitted:
    del recipe
    return Fitted(material_json(load_material(file)))


def _from_proof(file: Path, recipe: Recipe) -> Fitted:
    """The material of a proof's test picture; of a pack, the one that its gloss is judged by."""
    del recipe
    from relgloss_view.gloss.samples import SampleLook
    from relgloss_view.proof.unpack import open_proof

    with open_proof(file) as opened:
        pair = opened.pair()
        scene, look = pair.scenes["test"], pair.looks["test"]
        material = SampleLook("", scene.material, look, scene.pack).judged_material
    material = dataclasses.replace(material, name=opened.proof.title or material.name)
    return Fitted(material_json(material), sigma_n_deg=look.sigma_n_deg)


def material_json(material: Material) -> dict[str, Any]:
    """The JSON object of a material, of lists and plain numbers as a file holds them."""
    try:
        content: dict[str, Any] = json.loads(
            json.dumps(material_to_dict(material), allow_nan=False)
        )
    except (ValueError, TypeError) as error:
        raise InputError(f"its evidence can't be written ({error})") from error
    return content


_MAKERS: dict[str, Callable[[Path, Recipe], Fitted]] = {
    TABLE: _from_table,
    MATERIAL: _from_material,
    PROOF: _from_proof,
}


def facts_of(material: Material, fitted: Fitted) -> dict[str, Any]:
    """What a row holds of a material before it is metered, by column."""
    lobes = _brightest_first(material)
    widths = [lobe.s_deg for lobe in lobes]
    marks = [material.marks] if material.marks else []
    marks += ["hypothetical"] if material.hypothetical else []
    return {
        "name": material.name,
        "source": material.source,
        "marks": ", ".join(marks),
        "quality": str(material.fit.quality) if material.fit else None,
        "model": material.fit.chosen if material.fit else None,
        "geometries": fitted.geometries,
        "bands": material.bands.count,
        "diffuse_model": material.diffuse.model,
        "sigma_deg": material.diffuse.sigma_deg,
        "lobes": len(lobes),
        "s_deg_1": widths[0] if widths else None,
        "s_deg_2": widths[1] if len(widths) > 1 else None,
        "warnings": "\n".join(printable(text, 1000) for text in material.warnings),
    }


def _brightest_first(material: Material) -> list[Lobe]:
    """The lobes that reflect, that one first of which the row's distinctness is."""
    from relgloss_view.gloss.meter.meter import main_lobe

    main = main_lobe(material)
    first = None if main is None else material.specular[main]
    lobes = material.visible_lobes()
    return sorted(lobes, key=lambda one: (one is not first, -max(one.height) / one.s**2))


def look_of(material: Material, fitted: Fitted, recipe: Recipe) -> tuple[dict[str, Any], str]:
    """Readings, match and thumbnail by column, and the driver that has drawn it."""
    from relgloss_view.catalogue.look import draw, match_of, numbers_of, setting_of
    from relgloss_view.picture.output.png import png_bytes

    sigma = fitted.sigma_n_deg
    row = numbers_of(material, recipe)
    matched = match_of(material, recipe, sigma)
    frame = draw(material, recipe, renderer(), sigma_n_deg=sigma, matched=matched)
    row |= setting_of(matched, frame, sigma)
    row["thumbnail"] = png_bytes(frame)
    return row, frame.device


def plain_row(row: dict[str, Any]) -> dict[str, Any]:
    """A row of Python's own types, by the kinds of the columns; what is no finite number is null.

    >>> plain_row({"lobes": 1.0, "haze": math.nan, "name": "paper"})
    {'lobes': 1, 'haze': None, 'name': 'paper'}
    """
    return {name: _plain(BY_NAME[name].kind, value) for name, value in row.items()}


def _plain(kind: str, value: Any) -> Any:
    if value is None:
        return None
    if kind == NUMBER:
        return float(value) if math.isfinite(value) else None
    return {WHOLE: int, FLAG: bool, BYTES: bytes, TEXT: str}[kind](value)


def renderer() -> FrameRenderer:
    """The one renderer of this thread in this process, made when it is first asked for.

    An OpenGL context belongs to a thread, and does not outlive a fork. Raises GLUnavailableError.
    """
    if getattr(_open, "pid", None) != os.getpid():
        stack = contextlib.ExitStack()
        _open.renderer = stack.enter_context(open_renderer())
        _open.stack, _open.pid = stack, os.getpid()
    made: FrameRenderer = _open.renderer
    return made


def close_renderer() -> None:
    """Give this thread's renderer back."""
    if getattr(_open, "pid", None) == os.getpid():
        _open.pid = None
        _open.stack.close()


def _failed(row: dict[str, Any], fault: str, failed_in: str) -> Item:
    return Item({**row, "status": FAILED, "fault": fault}, failed_in=failed_in)


def _fault_of(error: Exception, file: str, failed_in: str) -> tuple[str, str]:
    """A fault in one line without the file's folder, and what is at fault."""
    if isinstance(error, _Unusable):
        raise error
    if isinstance(error, MemoryError):
        return "out of memory; thin out the table, or build with fewer --workers", OF_MACHINE
    if isinstance(error, OSError):
        return f"can't be read ({error.strerror or error}); build again", OF_MACHINE
    if not isinstance(error, RelglossError):
        if os.environ.get(VARIABLE) == RAISE:
            raise error
        fault = printable(f"{type(error).__name__}: {error}; {OWN_FAULT}", LONGEST_FAULT)
        # What draws fails with the machine, whose next build may do better; readers fail alike.
        return fault, OF_MACHINE if failed_in == OF_LOOK else failed_in
    text = str(error)
    for name in (file, named(file)):
        for spelt in {name, visible(" ".join(name.split()))}:
            text = text.replace(f"{spelt}: ", "").replace(spelt, _base_of(name))
    return printable(text, LONGEST_FAULT), failed_in


def _base_of(name: str) -> str:
    return visible(os.path.basename(name))
