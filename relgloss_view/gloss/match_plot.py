"""The curves of settings that keep the ratio of gloss, as a picture."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from relgloss_view.base.figures import INK, MUTED, drawing, new_figure, save_figure
from relgloss_view.base.writing import whole_file
from relgloss_view.gloss.comparison import words_of
from relgloss_view.gloss.match import Match, Reference

#: Told apart by lightness too (Okabe and Ito's blue, vermilion, green, purple, sky, orange).
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#8a5a8c", "#3f9fd0", "#b37a00")
SIXTHS = [f"{k}/6" for k in range(7)]
LABEL_LETTERS = 22
LABEL_GAP = 0.055  #: between the labels of curves, in shares of c_max


def write_match_plot(
    reference: Reference, matches: Sequence[Match], gloss: str, measure: str, path: str | Path
) -> None:
    """Write a PNG: c as a share of c_max over sigma_N, with proposals and settings found by eye.

    The file appears whole or not at all.
    """
    with drawing({"font.size": 9.0}):
        figure = new_figure(9.4, 6.0, dpi=130)
        axes = figure.add_axes((0.08, 0.18, 0.62, 0.64))
        for k, found in enumerate(matches):
            _curve(axes, found, COLOURS[k % len(COLOURS)])
        axes.set_xlabel("grain sigma_N, degrees")
        axes.set_ylabel("c / c_max")
        axes.set_yticks([k / 6 for k in range(7)], SIXTHS)
        axes.set_ylim(0.0, 1.05)
        axes.set_xlim(-0.08, max(p.sigma_n_deg for m in matches for p in m.curve) + 0.08)
        _labels(axes, matches, reference)
        _words(figure, reference, gloss, measure)
        with whole_file(path) as temporary:
            save_figure(figure, temporary)


def _curve(axes: Any, found: Match, colour: str) -> None:
    solved = [p for p in found.curve if p.c_fraction is not None]
    missed = [p.sigma_n_deg for p in found.curve if p.c_fraction is None]
    axes.plot([p.sigma_n_deg for p in solved], [p.c_fraction for p in solved], color=colour, lw=1.8)
    # Beyond c_max: no setting of this sample shows so much.
    axes.plot(missed, [1.025] * len(missed), "^", color=colour, ms=4, clip_on=False)
    if found.proposed is not None:
        place = ([found.proposed.sigma_n_deg], [found.proposed.c_fraction])
        axes.plot(*place, "o", color=colour, ms=8, clip_on=False, zorder=3)
    present = found.present
    if present is not None and present.c_fraction is not None:
        share = min(present.c_fraction, 1.0)
        if present.fraction_distance is not None:
            ends = [share, share - present.fraction_distance]
            axes.plot([present.sigma_n_deg] * 2, ends, ":", color=colour, lw=1.2)
        axes.plot(
            [present.sigma_n_deg], [share], "D", mfc="white", mec=colour, ms=7, clip_on=False,
            zorder=4,
        )  # fmt: skip


def _labels(axes: Any, matches: Sequence[Match], reference: Reference) -> None:
    """Each sample's name at the right end of its curve, moved apart where they would meet."""
    ends = []
    for k, found in enumerate(matches):
        last = found.curve[-1].c_fraction
        ends.append((1.02 if last is None else last, k))
    below = -1.0
    for height, k in sorted(ends):
        found, at = matches[k], max(height, below + LABEL_GAP)
        below = at
        label = found.case.label
        label = label if len(label) <= LABEL_LETTERS else label[: LABEL_LETTERS - 3] + "..."
        told = f"{label}  x {found.gloss / reference.gloss:.3g}"
        told += "" if found.proposed is not None else ", out of reach"
        axes.annotate(
            told, (1.02, at), xycoords=("axes fraction", "data"), va="center",
            color=COLOURS[k % len(COLOURS)], annotation_clip=False, fontsize=9,
        )  # fmt: skip


def _words(figure: Any, reference: Reference, gloss: str, measure: str) -> None:
    case = reference.case
    figure.text(
        0.08, 0.93, f"Settings that keep the ratio of gloss to {case.label}",
        fontsize=13, fontweight="bold", color=INK,
    )  # fmt: skip
    figure.text(
        0.08, 0.885,
        f"x 0.5: half the reference material's {words_of(gloss)}, {reference.gloss:.4g}; pictures "
        f"by {measure.replace('-', ' ')}",
        color=MUTED,
    )  # fmt: skip
    figure.text(
        0.08, 0.85,
        f"reference picture: sigma_N {case.look.sigma_n_deg:g} deg, c {reference.c:.3g}",
        color=MUTED,
    )  # fmt: skip
    figure.text(
        0.08, 0.035,
        "Filled: proposed, at the sample's own grain. Open: given or published settings. "
        "Triangles: out of reach.\nA starting point for the eye; the experiment decides.",
        color=MUTED, fontsize=8,
    )  # fmt: skip
