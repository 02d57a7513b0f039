"""Samples under operators side by side: what each shows of their gloss, order and body colour.

Defined in docs/compare.md.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from relgloss_view.base.arrays import Bytes
from relgloss_view.base.terminal import ProgressReport, no_progress
from relgloss_view.gloss.meter.meter import gloss_readings
from relgloss_view.gloss.shown import ORDER_TIE_LSTAR, Measures, agreement, measure, ranks
from relgloss_view.material.material import Material
from relgloss_view.operators.operator import Operator
from relgloss_view.picture.frame import Frame
from relgloss_view.picture.output.parameters import SPLIT, warnings
from relgloss_view.picture.output.png import is_srgb
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.scene import Scene

if TYPE_CHECKING:
    from relgloss_view.quality.backends import FrameRenderer

#: Measures that pictures are put in order by: both, since one does not see narrow highlights.
ORDERED_BY = ("contrast_gloss", "peak_contrast")
GLOSSES = ("gloss-20", "gloss-60", "gloss-75", "gloss-85", "contrast-gloss")
DEFAULT_GLOSS = "gloss-75"  #: the paper's own: "75/75 for papers"
MARGIN = 0.06  #: of surround around the object in a picture, of its longer side
KEPT_DE = 1.0  #: a body colour that moved by less than this, CIEDE2000, is kept
KEPT, TIED, BROKEN, NONE = "kept", "tied", "broken", "none"


@dataclass(frozen=True)
class Case:
    """A sample and how it is to look; the label is unique in a comparison."""

    label: str
    material: Material
    look: Look


@dataclass(frozen=True)
class Cell:
    """One sample under one operator."""

    picture: Bytes  #: (H, W, 3), the object with a margin of its surround
    measures: Measures
    warnings: tuple[str, ...]


@dataclass(frozen=True)
class Order:
    """The samples as one measure of their pictures puts them, against the real materials."""

    ranks: Mapping[str, int]
    tau: float | None  #: Kendall's tau-b against the order of the materials' gloss
    verdict: str  #: KEPT; TIED: nothing exchanged, but not told apart; BROKEN; NONE: no order

    @property
    def words(self) -> str:
        """The labels, glossiest first: a > b = c."""
        text, before = "", None
        for label, rank in self.ranks.items():
            text += ("" if before is None else " = " if rank == before else " > ") + label
            before = rank
        return text


@dataclass(frozen=True)
class Row:
    """One operator: its cells by label, and the orders by measure."""

    operator: Operator
    cells: Mapping[str, Cell]
    orders: Mapping[str, Order]

    @property
    def body_difference(self) -> float | None:
        """The largest of its samples, CIEDE2000."""
        found = [cell.measures.body_difference for cell in self.cells.values()]
        return max((d for d in found if d is not None), default=None)

    @property
    def body_kept(self) -> bool | None:
        """Whether no sample's body colour moved visibly."""
        return None if self.body_difference is None else self.body_difference < KEPT_DE


@dataclass(frozen=True)
class Settled:
    """What a sample was drawn with, and its material's computed gloss."""

    case: Case
    gloss: Mapping[str, float | None]  #: by key, GLOSSES
    c: float
    c_max: float | None


@dataclass(frozen=True)
class Comparison:
    """Everything that a sheet or a table says."""

    samples: tuple[Settled, ...]
    rows: tuple[Row, ...]
    gloss: str  #: which of GLOSSES orders the real materials
    truth: Mapping[str, int]  #: their ranks, 0 the glossiest
    srgb: bool  #: whether the display, and so the pictures, are sRGB


def compare(
    renderer: FrameRenderer,
    cases: Sequence[Case],
    operators: Sequence[Operator],
    scene: Scene,
    size: tuple[int, int],
    *,
    gloss: str = DEFAULT_GLOSS,
    progress: ProgressReport = no_progress,
) -> Comparison:
    """Draw every sample once, show it with every operator; `scene` gives all but the material."""
    settled, cells = [], []
    for k, case in enumerate(cases):
        frame = renderer.render(dataclasses.replace(scene, material=case.material), case.look, size)
        rows_seen, columns_seen = _bounds(frame)
        settled.append(Settled(case, computed_gloss(case.material), frame.c, frame.c_max))
        shown = []
        for n, operator in enumerate(operators):
            progress((k + n / len(operators)) / len(cases), f"{case.label}, {operator.name}")
            picture = operator.draw(frame)
            cut = np.ascontiguousarray(picture.digital[rows_seen, columns_seen])
            told = warnings(frame, None if operator.name == SPLIT else picture)
            shown.append(Cell(cut, measure(frame, picture), told))
        cells.append(shown)
    labels = [case.label for case in cases]
    real = {s.case.label: s.gloss[gloss] or 0.0 for s in settled}
    rows = []
    for n, operator in enumerate(operators):
        of_it = {label: shown[n] for label, shown in zip(labels, cells, strict=True)}
        orders = {name: order_of(name, of_it, real) for name in ORDERED_BY}
        rows.append(Row(operator, of_it, orders))
    return Comparison(tuple(settled), tuple(rows), gloss, ranks(real), is_srgb(scene.display))


def _bounds(frame: Frame) -> tuple[slice, slice]:
    """Rows and columns that hold the object and a margin; all of them where it is not seen."""
    seen = frame.on_object
    if not np.any(seen):
        return slice(None), slice(None)
    bounds = []
    for axis in (1, 0):
        places = np.flatnonzero(np.any(seen, axis=axis))
        margin = round(MARGIN * max(frame.size))
        bounds.append(slice(max(0, places[0] - margin), places[-1] + 1 + margin))
    return bounds[0], bounds[1]


def computed_gloss(material: Material) -> dict[str, float | None]:
    """What gloss meters would read on a material, by key."""
    return {r.key: r.value for r in gloss_readings(material) if r.key in GLOSSES}


def order_of(name: str, cells: Mapping[str, Cell], real: Mapping[str, float]) -> Order:
    """The order by a measure, and how it agrees with that of the real materials."""
    values = {label: getattr(cell.measures, name) for label, cell in cells.items()}
    if any(value is None for value in values.values()):
        return Order({}, None, NONE)
    shown, truth = ranks(values, ORDER_TIE_LSTAR), ranks(real)
    found = agreement(values, real, ORDER_TIE_LSTAR)
    exchanged = any(shown[a] > shown[b] and truth[a] < truth[b] for a in real for b in real)
    if len(set(truth.values())) < 2:
        verdict = NONE
    elif found.same:
        verdict = KEPT
    else:
        verdict = BROKEN if exchanged else TIED
    return Order(shown, found.tau, verdict)


def as_numbers(comparison: Comparison) -> dict[str, Any]:
    """A comparison as JSON holds it."""
    return {
        "gloss": comparison.gloss,
        "samples": [
            {
                "label": s.case.label,
                "name": s.case.material.name,
                "source": s.case.material.source,
                "sigma_n_deg": s.case.look.sigma_n_deg,
                "c": s.c,
                "c_max": s.c_max,
                "gloss": dict(s.gloss),
                "rank": comparison.truth[s.case.label],
                "warnings": list(s.case.material.warnings),
            }
            for s in comparison.samples
        ],
        "operators": [
            {
                "name": row.operator.name,
                "parameters": dataclasses.asdict(row.operator),
                "source": row.operator.source,
                "shown": {
                    label: {**dataclasses.asdict(cell.measures), "warnings": list(cell.warnings)}
                    for label, cell in row.cells.items()
                },
                "orders": {
                    name: {
                        "ranks": dict(order.ranks),
                        "order": order.words,
                        "kendall_tau": order.tau,
                        "verdict": order.verdict,
                    }
                    for name, order in row.orders.items()
                },
                "largest_body_difference": row.body_difference,
                "body_kept": row.body_kept,
            }
            for row in comparison.rows
        ],
    }


def words_of(gloss: str) -> str:
    """A gloss in words: its angle, or what it is."""
    angle = gloss.removeprefix("gloss-")
    return f"gloss at {angle} deg" if angle != gloss else "contrast gloss c"


def title_of(operator: Operator) -> str:
    """An operator's name with the parameters that are not their defaults."""
    changed = [
        f"{f.name} {getattr(operator, f.name)}"
        for f in dataclasses.fields(operator)
        if getattr(operator, f.name) != f.default
    ]
    return f"{operator.name} ({', '.join(changed)})" if changed else operator.name
