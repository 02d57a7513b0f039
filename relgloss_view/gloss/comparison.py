"""Samples under several operators: their displayed gloss, its order, and the body's colour.

Defined in docs/compare.md.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from relgloss_view.base.arrays import Bytes
from relgloss_view.base.interruptions import checkpoint
from relgloss_view.base.terminal import ProgressReport, no_progress
from relgloss_view.display.display import Display
from relgloss_view.gloss.pose import pose_of
from relgloss_view.gloss.samples import DEFAULT_GLOSS, SampleLook, computed_gloss
from relgloss_view.gloss.shown import ORDER_TIE_LSTAR, Measures, agreement, measure, ranks
from relgloss_view.operators.operator import Operator
from relgloss_view.picture.frame import Frame
from relgloss_view.picture.output.parameters import SPLIT, warnings
from relgloss_view.picture.pair import common_factor
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.setup import Setup

if TYPE_CHECKING:
    from relgloss_view.quality.backends import FrameRenderer

#: Measures by which pictures are ordered: first the one whose ratio a match keeps. The 99th
#: percentile does not see narrow highlights, the others do.
ORDERED_BY = ("highlight", "contrast_gloss", "peak_contrast")
MARGIN = 0.06  #: of surround around the object in a picture, of its longer side
KEPT_DE = 1.0  #: a body colour that moved by less than this, CIEDE2000, is kept
KEPT, TIED, BROKEN, NONE = "kept", "tied", "broken", "none"


@dataclass(frozen=True)
class Cell:
    """One sample under one operator."""

    picture: Bytes  #: (H, W, 3), the object with a margin of its surround
    measures: Measures
    warnings: tuple[str, ...]


@dataclass(frozen=True)
class GlossOrder:
    """The order of the samples by one measure of their pictures, against the real materials'."""

    ranks: Mapping[str, int]  #: by label, 0 the glossiest
    tau: float | None  #: Kendall's tau-b against the order of the materials' gloss
    verdict: str  #: KEPT; TIED: no pair is exchanged, but one is tied; BROKEN; NONE: no order

    @property
    def words(self) -> str:
        """The labels, glossiest first: a > b = c."""
        text, before = "", None
        for label, rank in self.ranks.items():
            text += ("" if before is None else " = " if rank == before else " > ") + label
            before = rank
        return text


@dataclass(frozen=True)
class OperatorRow:
    """One operator: its cells by label, and the orders by measure."""

    operator: Operator
    cells: Mapping[str, Cell]
    orders: Mapping[str, GlossOrder]

    @property
    def body_difference(self) -> float | None:
        """The largest of its samples, CIEDE2000."""
        differences = [cell.measures.body_difference for cell in self.cells.values()]
        return max((d for d in differences if d is not None), default=None)

    @property
    def body_kept(self) -> bool | None:
        """Whether no sample's body colour moved visibly."""
        return None if self.body_difference is None else self.body_difference < KEPT_DE


@dataclass(frozen=True)
class DrawnSample:
    """A sample with the c of its picture and its material's computed gloss."""

    sample: SampleLook
    gloss: Mapping[str, float | None]  #: by key, GLOSSES
    c: float
    c_max: float | None


@dataclass(frozen=True)
class Comparison:
    """Everything that a sheet, a page or a table shows."""

    samples: tuple[DrawnSample, ...]
    rows: tuple[OperatorRow, ...]
    gloss: str  #: which of GLOSSES orders the real materials
    real_ranks: Mapping[str, int]  #: of the materials by label, 0 the glossiest
    display: Display  #: that the pictures are for
    factor: float = 1.0  #: of all matched c in this view, so that none clips
    refused: tuple[str, ...] = ()  #: labels of samples without a highlight here: not ranked


def compare(
    renderer: FrameRenderer,
    samples: Sequence[SampleLook],
    operators: Sequence[Operator],
    scene: Scene,
    size: tuple[int, int],
    *,
    gloss: str = DEFAULT_GLOSS,
    matched: Collection[str] = (),
    progress: ProgressReport = no_progress,
) -> Comparison:
    """Draw every sample once and show its picture with every operator.

    `scene` gives all but the material, `size` is (width, height) in pixels, and `gloss` is the one
    of GLOSSES that orders the real materials. matched: labels of samples whose c belong together,
    which one factor scales where a picture can't display its own.
    """
    drawn, cells = [], []
    factor = factor_in_view(renderer, [s for s in samples if s.label in matched], scene, size)
    for k, sample in enumerate(samples):
        of_sample = sample.scene(scene.setup)
        of_pair = factor if sample.label in matched else 1.0
        frame = renderer.render(of_sample, sample.look, size, factor=of_pair)
        rows_kept, columns_kept = _bounds(frame)
        checkpoint()
        drawn.append(
            DrawnSample(sample, computed_gloss(sample.judged_material), frame.c, frame.c_max)
        )
        by_operator = []
        for n, operator in enumerate(operators):
            progress((k + n / len(operators)) / len(samples), f"{sample.label}, {operator.name}")
            picture = operator.draw(frame)
            cut = np.ascontiguousarray(picture.digital[rows_kept, columns_kept])
            texts = warnings(frame, None if operator.name == SPLIT else picture)
            by_operator.append(Cell(cut, measure(frame, picture), texts))
        cells.append(by_operator)
    labels = [sample.label for sample in samples]
    real = {d.sample.label: d.gloss[gloss] or 0.0 for d in drawn}
    refused = without_highlight(samples, scene.setup)
    ranked = {label: reading for label, reading in real.items() if label not in refused}
    rows = []
    for n, operator in enumerate(operators):
        of_operator = {
            label: by_operator[n] for label, by_operator in zip(labels, cells, strict=True)
        }
        orders = {name: gloss_order(name, of_operator, ranked) for name in ORDERED_BY}
        rows.append(OperatorRow(operator, of_operator, orders))
    return Comparison(
        tuple(drawn),
        tuple(rows),
        gloss,
        ranks(real),
        scene.display,
        factor,
        refused,
    )


def without_highlight(samples: Sequence[SampleLook], setup: Setup) -> tuple[str, ...]:
    """Labels of glossy samples whose highlight lies beside the object in this view.

    A sample without a lobe has no highlight anywhere, and is ranked as what it is.
    """
    pose = pose_of(setup)
    return tuple(
        sample.label
        for sample in samples
        if (shining := [part for part in sample.parts(setup) if part[0].visible_lobes()])
        and all(pose.peak(material, sigma_n_deg) is None for material, sigma_n_deg in shining)
    )


def factor_in_view(
    renderer: FrameRenderer, samples: Sequence[SampleLook], scene: Scene, size: tuple[int, int]
) -> float:
    """The common factor of the samples' c with which no picture of this view clips."""
    contrasts = []
    for sample in samples:
        of_sample = sample.scene(scene.setup)
        frame = renderer.render(of_sample, sample.look, size)
        contrasts.append((frame.c, frame.c_max))
    return common_factor(contrasts)


def _bounds(frame: Frame) -> tuple[slice, slice]:
    """Rows and columns that hold the object and a margin; all of them where none of it is seen."""
    seen = frame.on_object
    if not np.any(seen):
        return slice(None), slice(None)
    bounds = []
    for axis in (1, 0):
        places = np.flatnonzero(np.any(seen, axis=axis))
        margin = round(MARGIN * max(frame.size))
        bounds.append(slice(max(0, places[0] - margin), places[-1] + 1 + margin))
    return bounds[0], bounds[1]


def gloss_order(name: str, cells: Mapping[str, Cell], real: Mapping[str, float]) -> GlossOrder:
    """The order by a measure of ORDERED_BY, and its agreement with that of the real materials."""
    values = {label: getattr(cells[label].measures, name) for label in real}
    return order_of(values, real, ORDER_TIE_LSTAR)


def order_of(
    values: Mapping[str, float | None], real: Mapping[str, float], tie: float
) -> GlossOrder:
    """The order of displayed values against the real one; values closer than `tie` are a tie."""
    displayed_values = {label: value for label, value in values.items() if value is not None}
    if len(displayed_values) < len(values):
        return GlossOrder({}, None, NONE)
    displayed, material = ranks(displayed_values, tie), ranks(real)
    agreed = agreement(displayed_values, real, tie)
    exchanged = any(
        displayed[a] > displayed[b] and material[a] < material[b] for a in real for b in real
    )
    if len(set(material.values())) < 2:
        verdict = NONE
    elif agreed.same:
        verdict = KEPT
    else:
        verdict = BROKEN if exchanged else TIED
    return GlossOrder(displayed, agreed.tau, verdict)


def as_numbers(comparison: Comparison) -> dict[str, Any]:
    """The comparison as JSON holds it."""
    return {
        "gloss": comparison.gloss,
        "factor": comparison.factor,
        "refused": list(comparison.refused),
        "samples": [
            {
                "label": d.sample.label,
                "name": d.sample.material.name,
                "source": d.sample.material.source,
                "sigma_n_deg": d.sample.look.sigma_n_deg,
                "c": d.c,
                "c_max": d.c_max,
                "gloss": dict(d.gloss),
                "rank": comparison.real_ranks[d.sample.label],
                "warnings": list(d.sample.material.warnings),
            }
            for d in comparison.samples
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
