"""CSV of the model at any directions, in the two forms that `relgloss fit` reads (docs/files.md).

Values are radiance factors pi f_r, which the file declares; 1 is the perfect diffuser. Spectral
materials keep their bands, others are R, G, B.
"""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.csv_files import read_csv
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.base.version import PROGRAM
from relgloss_view.base.visible import visible
from relgloss_view.base.writing import whole_file
from relgloss_view.exchange.channels import metal_notes
from relgloss_view.exchange.formats import Exported, ExportOptions
from relgloss_view.material.material import Material
from relgloss_view.measure.gonio import GAMMA_S_DEG, gcms4_grid, gcms_directions, spherical
from relgloss_view.measure.quantity import RADIANCE_FACTOR
from relgloss_view.measure.readers import gcms, generic
from relgloss_view.pack.pack import Pack

GCMS, IN_PLANE = "gcms", "in-plane"
DIGITS = 6
DEFAULT_STEP_DEG = 5.0
STEPS_DEG = (0.1, 30.0)
MOST_ROWS = 200_000
FARTHEST_DEG = 85.0  #: beyond, the footprints of instruments have no bound
#: Beside the mirror direction, in standard deviations of the facets: what a narrow lobe needs.
BESIDE_SD = (0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 6.0)


class Grid(NamedTuple):
    """Directions of a table: names of the angle columns, (N, A) degrees, unit vectors (N, 3)."""

    columns: tuple[str, ...]
    angles_deg: Array
    to_lamp: Array
    to_receiver: Array


def write(what: Material | Pack, path: Path, options: ExportOptions) -> Exported:
    """Write a table of a material; see exchange.formats.Writer."""
    assert isinstance(what, Material)  # Format.write refuses packs
    grid = grid_of(what, options.grid or GCMS)
    diffuse, specular = what.evaluate(grid.to_lamp, grid.to_receiver)
    values = np.pi * (diffuse + specular)
    notes = (*_notes(what, grid), *metal_notes(what))
    facts = {
        "name": what.name,
        "source": f"synthetic (computed by {PROGRAM} from a model, not measured); "
        f"model: {what.source}",
        "quantity": RADIANCE_FACTOR,
    }
    if grid.columns == tuple(gcms.COLUMNS):
        facts["gamma_s_deg"] = f"{GAMMA_S_DEG:g}"
    # A control character in a name would make the table no text, also for our own reader.
    lines = [f"# {key}: {visible(' '.join(value.split()))}" for key, value in facts.items()]
    lines += [f"# {note}" for note in notes]
    heads = (
        [f"{nm:g}" for nm in what.bands.wavelengths_nm]
        if what.bands.wavelengths_nm is not None
        else list(what.bands.labels)
    )
    lines.append(",".join([*grid.columns, *heads]))
    for angles, row in zip(grid.angles_deg, values, strict=True):
        lines.append(",".join([*(f"{x:.8g}" for x in angles), *(f"{x:.{DIGITS}g}" for x in row)]))
    with whole_file(path) as temporary:
        temporary.write_text("\n".join(lines) + "\n", encoding="utf-8", newline="\n")
    carried = (
        f"carried: radiance factors at {len(values)} pairs of directions, {what.bands.words}",
        "lost: the model between these directions, and the evidence of the fit",
    )
    return Exported((*carried, *notes), {})


def _notes(material: Material, grid: Grid) -> tuple[str, ...]:
    """A warning where too few directions lie in the narrowest lobe for a fit to find its width."""
    lobes = material.visible_lobes()
    if not lobes:
        return ()
    narrow = min(lobe.s_deg for lobe in lobes)
    half = grid.to_lamp + grid.to_receiver
    tilt = np.degrees(np.arctan2(np.hypot(half[:, 0], half[:, 1]), half[:, 2]))
    inside = np.unique(np.round(tilt[tilt < 3.0 * narrow], 3))
    if len(inside) >= 3:
        return ()
    return (
        f"lost: the width of the lobe of {narrow:.2g} deg, which the directions step over; "
        "use --grid in-plane, whose directions follow the lobe",
    )


def grid_of(material: Material, grid: str) -> Grid:
    """The directions that a user asks for. Raises InputError."""
    kind, colon, step = grid.partition(":")
    if grid == GCMS:
        angles = gcms4_grid()
        lamp, receiver = gcms_directions(*angles.T)
        above = (lamp[:, 2] > 0.0) & (receiver[:, 2] > 0.0)
        return Grid(tuple(gcms.COLUMNS), angles[above], lamp[above], receiver[above])
    if kind == IN_PLANE:
        if colon:
            return _in_plane(_step(step), ())
        offsets = {lobe.s_deg: BESIDE_SD for lobe in material.visible_lobes()}
        beside = [2.0 * s * k for s, each in offsets.items() for k in each]
        return _in_plane(DEFAULT_STEP_DEG, tuple(beside))
    return _own(Path(grid))


def _step(value: str) -> float:
    try:
        step = float(value)
    except ValueError:
        step = float("nan")
    low, high = STEPS_DEG
    if not low <= step <= high:
        raise InputError(
            f"--grid in-plane:{printable(value, 20)}: expected a step from {low:g} to "
            f"{high:g} degrees, as in in-plane:5"
        )
    return step


def _in_plane(step_deg: float, beside_deg: tuple[float, ...]) -> Grid:
    """Lamp and receiver in one plane: the receiver's angles in steps, and beside the mirror
    direction by further angles of its own.
    """
    count = int(FARTHEST_DEG / step_deg + 1e-9)
    thetas = step_deg * np.arange(count + 1)
    receivers = step_deg * np.arange(-count, count + 1)
    rows: list[tuple[float, float]] = []
    for theta in thetas.tolist():
        near = [theta + side * offset for offset in beside_deg for side in (-1.0, 1.0)]
        each = sorted({*(round(r, 6) for r in (*receivers.tolist(), *near))})
        rows += [(theta, r) for r in each if abs(r) <= FARTHEST_DEG]
    if len(rows) > MOST_ROWS:
        raise InputError(
            f"--grid in-plane:{step_deg:g}: {len(rows)} directions; at most {MOST_ROWS} are "
            "written: give a larger step"
        )
    theta_i, theta_r = np.array(rows).T
    # The lamp has azimuth 180, so the mirror direction is at positive angles of azimuth 0.
    angles = np.stack(
        [theta_i, np.full_like(theta_i, 180.0), np.abs(theta_r), np.where(theta_r < 0, 180.0, 0.0)],
        axis=-1,
    )
    return _generic(angles)


def _generic(angles: Array) -> Grid:
    theta_i, phi_i, theta_r, phi_r = angles.T
    return Grid(
        tuple(generic.COLUMNS), angles, spherical(theta_i, phi_i), spherical(theta_r, phi_r)
    )


def _own(path: Path) -> Grid:
    """A user's own directions: a CSV with the angle columns of either form, degrees."""
    if not path.exists() and not path.suffix:
        raise InputError(
            f"--grid {printable(str(path), 40)}: expected gcms, in-plane, in-plane:STEP or a CSV "
            "file of directions"
        )
    rows = read_csv(path)
    lines = [(k, row) for k, row in enumerate(rows, 1) if any(row) and not row[0].startswith("#")]
    heads = [name.strip().lower() for name in lines[0][1]] if lines else []
    for known in (gcms.COLUMNS, generic.COLUMNS):
        if set(known) <= set(heads):
            break
    else:
        raise InputError(
            f"{path}: the first row has {printable(', '.join(heads), 80) or 'nothing'}; expected "
            f"the columns {', '.join(generic.COLUMNS)} or {', '.join(gcms.COLUMNS)}"
        )
    if not 1 <= len(lines) - 1 <= MOST_ROWS:
        raise InputError(f"{path}: {len(lines) - 1} directions; expected 1 to {MOST_ROWS}")
    angles = np.array([_angles(path, k, row, heads, known) for k, row in lines[1:]])
    if known is generic.COLUMNS:
        grid = _generic(angles)
    else:
        grid = Grid(tuple(known), angles, *gcms_directions(*angles.T))
    if not np.any(np.minimum(grid.to_lamp[:, 2], grid.to_receiver[:, 2]) > 1e-6):
        raise InputError(f"{path}: no direction lies above the horizon")
    return grid


def _angles(
    path: Path, line: int, row: list[str], heads: list[str], known: dict[str, float]
) -> list[float]:
    found = []
    for name, largest in known.items():
        column = heads.index(name)
        text = row[column] if column < len(row) else ""
        try:
            value = float(text)
        except ValueError:
            value = float("nan")
        if not abs(value) <= largest:
            raise InputError(
                f"{path}: line {line}, {name}: {printable(text, 20)!r}; expected degrees, "
                f"-{largest:g} to {largest:g}"
            )
        found.append(value)
    return found
