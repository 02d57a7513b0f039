"""Whether measures of the pictures at proposed settings have the order of the real materials.

Gloss is no single number to the eye: Marlow, Kim and Anderson 2012 found it to follow contrast,
sharpness and coverage of highlights. So each pose is drawn, and each measure ranks the pictures.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from relgloss_view.gloss.comparison import (
    GlossOrder,
    factor_in_view,
    order_of,
    without_highlight,
)
from relgloss_view.gloss.samples import SampleLook
from relgloss_view.gloss.shown import ORDER_TIE_LSTAR, measure
from relgloss_view.operators.split import Split
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.setup import Setup

if TYPE_CHECKING:
    from relgloss_view.quality.backends import FrameRenderer

SIZE = (256, 256)
#: Measures by which pictures are ranked, and the difference below which two are a tie.
TIES = {
    "highlight": ORDER_TIE_LSTAR,
    "peak_contrast": ORDER_TIE_LSTAR,
    "contrast_gloss": ORDER_TIE_LSTAR,
    "sharpness": 0.0,
    "coverage": 0.0,
}


@dataclass(frozen=True)
class CheckedPose:
    """The pictures of one pose, ranked by each measure."""

    setup: Setup
    factor: float  #: of all c, so that none clips
    values: Mapping[str, Mapping[str, float | None]]  #: by measure and label
    orders: Mapping[str, GlossOrder]  #: by measure
    refused: tuple[str, ...]  #: labels of samples that show no highlight here, which are not ranked


def check_pose(
    renderer: FrameRenderer,
    samples: Sequence[SampleLook],
    readings: Mapping[str, float],
    setup: Setup,
) -> CheckedPose:
    """Draw samples with an absolute c each in one pose, and rank the pictures.

    readings: gloss of the materials by label. A sample without a highlight here is not ranked.
    """
    refused = without_highlight(samples, setup)
    seen = [sample for sample in samples if sample.label not in refused]
    values: dict[str, dict[str, float | None]] = {name: {} for name in TIES}
    factor = 1.0
    if seen:
        factor = factor_in_view(renderer, seen, Scene(seen[0].material, setup), SIZE)
        for sample in seen:
            frame = renderer.render(sample.scene(setup), sample.look, SIZE, factor=factor)
            measures = measure(frame, Split().draw(frame))
            for name in TIES:
                values[name][sample.label] = getattr(measures, name)
    real = {label: reading for label, reading in readings.items() if label not in refused}
    orders = {name: order_of(of_samples, real, TIES[name]) for name, of_samples in values.items()}
    return CheckedPose(setup, factor, values, orders, refused)
