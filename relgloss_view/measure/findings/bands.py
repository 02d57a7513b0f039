"""Bands that hold nothing, and bands that are out of their place."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from relgloss_view.base.arrays import Array, Mask
from relgloss_view.measure.bands import Bands
from relgloss_view.measure.findings.finding import BANDS, Finding
from relgloss_view.measure.findings.rows import Rows
from relgloss_view.measure.table import Measurement

#: A band whose readings span less than this, as a ratio, where others span SPAN_OF_OTHERS times as
#: much, shows its own floor.
FLAT_SPAN, SPAN_OF_OTHERS = 1.3, 3.0
#: ... or whose body is this small a share of both neighbours'.
DARK_SHARE = 0.02
#: A gap wider than this in what the eye sees leaves colour open (nm), and so do ends inside these.
WIDEST_GAP_NM, FIRST_NM, LAST_NM = 45.0, 430.0, 650.0
#: Spectra of inks are smooth: a band off the mean of its neighbours by this, in natural logarithms,
#: and by so many times what bands usually are, stands in another's place.
OUT_OF_PLACE, TIMES_USUAL = 0.3, 8.0
#: Bands farther apart than this may differ by as much in any ink, nm.
NEAR_NM = 26.0
FEWEST_BANDS = 7
_FLOOR = 0.005
FEWEST_ROWS = 8


def without_dead(measurement: Measurement, rows: Rows) -> tuple[Measurement, list[Finding]]:
    """The measurement without bands that read the same everywhere, and what is said of them."""
    if measurement.bands.is_rgb or len(rows) < FEWEST_ROWS or measurement.bands.count < 3:
        return measurement, []
    dead = _dead(rows.values)
    rest = np.flatnonzero(~dead)
    if not dead.any() or len(rest) < 2:
        return measurement, []
    centres = measurement.bands.centres_nm()
    labels = [
        label for label, is_dead in zip(measurement.bands.labels, dead, strict=True) if is_dead
    ]
    kept = centres[rest]
    holes = np.max(np.diff(kept)) > WIDEST_GAP_NM and _within(centres[dead], kept)
    ends = (kept[0] > FIRST_NM and centres[0] < kept[0]) or (
        kept[-1] < LAST_NM and centres[-1] > kept[-1]
    )
    text = f"no light in the band{'s' if len(labels) > 1 else ''} {', '.join(labels)}: left out"
    if holes or ends:
        text += ", and colour there is a guess: measure again, or give a table with closer bands"
    finding = Finding(BANDS, text, bool(holes or ends))
    bands = Bands(tuple(kept.tolist()))
    values = measurement.radiance_factor[:, rest]
    return replace(measurement, bands=bands, radiance_factor=values), [finding]


def _within(dead: Array, kept: Array) -> bool:
    return bool(np.any((dead > kept[0]) & (dead < kept[-1])))


def _dead(values: Array) -> Mask:
    """(B,), bands without light of their own."""
    low, high = np.percentile(values, (2.0, 98.0), axis=0)
    span = high / np.maximum(low, 1e-12)
    body = np.median(values, axis=0)
    flat = (span < FLAT_SPAN) & (float(np.median(span)) > SPAN_OF_OTHERS * FLAT_SPAN)
    neighbours = np.minimum(np.r_[np.inf, body[:-1]], np.r_[body[1:], np.inf])
    dark = (body < DARK_SHARE * neighbours) & (high < DARK_SHARE * np.median(high))
    return np.asarray((flat & (high < 0.5 * np.median(high))) | dark)


def out_of_place(measurement: Measurement, rows: Rows) -> list[Finding]:
    """Findings of bands that stand far off the line between their neighbours: none fits there."""
    bands = measurement.bands
    if bands.is_rgb or bands.count < FEWEST_BANDS or len(rows) < FEWEST_ROWS:
        return []
    centres = bands.centres_nm()
    if np.max(np.diff(centres)) > NEAR_NM:
        return []
    away = rows.delta_deg > 15.0
    values = rows.values[away] if np.sum(away) >= FEWEST_ROWS else rows.values
    log = np.log(np.median(values, axis=0) + _FLOOR)
    off = log[1:-1] - 0.5 * (log[:-2] + log[2:])
    usual = float(np.median(np.abs(off)))
    wrong = (np.abs(off) > OUT_OF_PLACE) & (np.abs(off) > TIMES_USUAL * max(usual, 1e-3))
    # The neighbours of one that is off are off by half as much to the other side.
    peaks = wrong & (
        np.abs(off) >= np.maximum(np.r_[0.0, np.abs(off[:-1])], np.r_[np.abs(off[1:]), 0.0])
    )
    if not peaks.any():
        return []
    labels = [bands.labels[k + 1] for k in np.flatnonzero(peaks)]
    return [
        Finding(
            BANDS,
            f"the band{'s' if len(labels) > 1 else ''} {', '.join(labels)} differ"
            f"{'' if len(labels) > 1 else 's'} from both neighbours by more than any ink does: are "
            "columns swapped, or is a lamp's line in there? Check the heading, or leave them out",
            True,
        )
    ]
