"""A fit judged by its use: does it give the gloss and the picture that its table gives?

A fit is for a picture and for gloss numbers. Both are computed from the fit and from the table
itself, and each plane's light is counted. What differs by more than the table's noise explains is a
warning that makes the fit poor. What the table is too coarse for is reported as that.
"""

from __future__ import annotations

from dataclasses import asdict, replace
from typing import Any

from relgloss_view.base.arrays import Array
from relgloss_view.fitting.departure import TOO_COARSE, departures
from relgloss_view.fitting.results import GlossUse, PictureUse, PlaneUse, TailUse, UseJudgement
from relgloss_view.fitting.use_gloss import gloss_uses, poor_gloss
from relgloss_view.fitting.use_picture import picture_uses, poor_picture
from relgloss_view.fitting.use_planes import (
    POOR_MIRROR,
    POOR_PLANE,
    POOR_PLANE_MIRROR,
    plane_uses,
    plane_words,
    tail_use,
)
from relgloss_view.material.material import FitRecord, Material, Quality
from relgloss_view.measure.table import Measurement


def judge_by_use(
    measurement: Measurement, material: Material, predicted: Array | None = None
) -> UseJudgement:
    """Gloss and picture of a fitted material against those of its table, and its light by planes.

    measurement: with directions and apertures as they were fitted. material: the fit.
    predicted: (N, B), radiance factors of the fit at all rows of the measurement through the
    instrument as it was fitted; without it, through the apertures that the measurement declares.

    Returns a UseJudgement, whose `poor` holds a line for each failure. Sources: docs/method.md.

    >>> from relgloss_view import read_measurement
    >>> from relgloss_view.base.resources import asset
    >>> from relgloss_view.picture.scene.sample import load_sample
    >>> paper = read_measurement(asset("papers", "art-coated.csv"))
    >>> judged = judge_by_use(paper, load_sample("art-coated"))
    >>> [(row.angle_deg, round(row.fit), round(row.table)) for row in judged.gloss if row.fit]
    [(20, 4, 4), (60, 30, 30)]
    >>> judged.poor
    ()
    """
    samples = departures(measurement, material, predicted)
    gloss, pictures = gloss_uses(material, samples), picture_uses(material, samples)
    if isinstance(samples, str):
        return UseJudgement(gloss, pictures, None, (), samples, (), ())
    tail, planes = tail_use(samples), plane_uses(samples)
    words = plane_words(planes)
    off = any(use.named and abs(use.offset) > POOR_PLANE for use in planes)
    reasons = [row.reason for row in gloss] + [row.reason for row in pictures]
    poor = (
        *(_gloss_words(row) for row in gloss if poor_gloss(row)),
        *(_picture_words(row) for row in pictures if poor_picture(row)),
        *(words if off else ()),
        *_mirror_words(tail, planes, any(TOO_COARSE in reason for reason in reasons)),
    )
    return UseJudgement(gloss, pictures, tail, planes, "", () if off else words, poor)


def _gloss_words(row: GlossUse) -> str:
    return (
        f"gloss at {row.angle_deg:g} degrees is {row.fit or 0.0:.1f} from the fit and "
        f"{row.table or 0.0:.1f} from the table: take the table's own (`relgloss gloss TABLE`)"
    )


def _picture_words(row: PictureUse) -> str:
    parts = {"highlight": row.highlight, "object": row.whole_object}
    where = max(parts, key=lambda name: parts[name] or 0.0)
    return (
        f"pictures of this fit differ from its table by dE2000 {parts[where] or 0.0:.0f} (95th "
        f"percentile over the {where}, lamp at {row.lamp_azimuth_deg:g} degrees): judge no "
        "highlight by them"
    )


def _mirror_words(tail: TailUse, planes: tuple[PlaneUse, ...], coarse: bool) -> tuple[str, ...]:
    """One line where light near the mirror direction is off, over all or in the worst plane."""
    missed = None if tail.mirror_explained is None else 1.0 - tail.mirror_explained
    if missed is not None and missed > POOR_MIRROR:
        place, share = "", missed
    else:
        worst = max(planes, key=lambda use: use.mirror_error or 0.0, default=None)
        if worst is None or (worst.mirror_error or 0.0) <= POOR_PLANE_MIRROR:
            return ()
        place, share = f" at incidence {worst.incidence_deg:.0f} deg", worst.mirror_error or 0.0
    step = (
        "measure in finer steps across the mirror direction"
        if coarse
        else "take gloss from the table itself (`relgloss gloss TABLE`)"
    )
    return (
        f"near the mirror direction{place} the fit is off by {share:.0%} of the light, so its "
        f"gloss and its highlights are uncertain: {step}",
    )


def with_use(
    material: Material, measurement: Measurement, predicted: Array | None = None
) -> Material:
    """The fitted material with the judgement in its record; poor where the judgement is."""
    if material.fit is None:
        return material
    judged = judge_by_use(measurement, material, predicted)
    return replace(material, fit=_recorded(material.fit, judged))


def _recorded(fit: FitRecord, judged: UseJudgement) -> FitRecord:
    new = tuple(line for line in (*judged.poor, *judged.notes) if line not in fit.warnings)
    quality = Quality.POOR if judged.poor else fit.quality
    grounds = fit.grounds if quality == fit.quality else ()
    return replace(
        fit,
        judgement=_rounded(asdict(judged)),
        quality=quality,
        warnings=(*fit.warnings, *new),
        grounds=(*grounds, *judged.poor),
    )


def _rounded(value: Any) -> Any:
    """Floats with four digits; tuples as lists, as a file gives them back."""
    if isinstance(value, float):
        return float(f"{value:.4g}")
    if isinstance(value, dict):
        return {name: _rounded(entry) for name, entry in value.items()}
    if isinstance(value, list | tuple):
        return [_rounded(entry) for entry in value]
    return value
