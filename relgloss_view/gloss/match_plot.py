"""The curves of settings that keep the ratio of gloss, as a picture."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from relgloss_view.base.figures import INK, MUTED, drawing, new_figure, save_figure
from relgloss_view.base.writing import whole_file
from relgloss_view.gloss.match import Match, Reference
from relgloss_view.gloss.samples import gloss_words

#: They differ in lightness too (Okabe and Ito's blue, vermilion, green, purple, sky, orange).
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#8a5a8c", "#3f9fd0", "#b37a00")
SIXTHS = [f"{k}/6" for k in range(7)]
LABEL_LETTERS = 22
LABEL_GAP = 0.055  #: between the labels of curves, in shares of c_max


def write_match_plot(reference: Reference, matches: Sequence[Match], path: str | Path) -> None:
    """Write a PNG of the curves, c as a share of c_max over sigma_N.

    Proposals and the samples' own settings are marked. The file appears whole or not at all.
    """
    with drawing({"font.size": 9.0}):
        figure = new_figure(9.4, 6.0, dpi=130)
        axes = figure.add_axes((0.08, 0.18, 0.62, 0.64))
        for k, m in enumerate(matches):
            _curve(axes, m, COLOURS[k % len(COLOURS)])
        axes.set_xlabel("grain sigma_N, degrees")
        axes.set_ylabel("c / c_max")
        axes.set_yticks([k / 6 for k in range(7)], SIXTHS)
        axes.set_ylim(0.0, 1.05)
        axes.set_xlim(-0.08, max(p.sigma_n_deg for m in matches for p in m.curve) + 0.08)
        _labels(axes, matches, reference)
        _texts(figure, reference)
        with whole_file(path) as temporary:
            save_figure(figure, temporary)


def _curve(axes: Any, m: Match, colour: str) -> None:
    solved = [p for p in m.curve if p.c_fraction is not None]
    missed = [p.sigma_n_deg for p in m.curve if p.c_fraction is None]
    axes.plot([p.sigma_n_deg for p in solved], [p.c_fraction for p in solved], color=colour, lw=1.8)
    # Above c_max: no setting of this sample displays so much gloss.
    axes.plot(missed, [1.025] * len(missed), "^", color=colour, ms=4, clip_on=False)
    if m.proposed is not None:
        place = ([m.proposed.sigma_n_deg], [m.proposed.c_fraction])
        axes.plot(*place, "o", color=colour, ms=8, clip_on=False, zorder=3)
    own = m.own_setting
    if own is not None and own.c_fraction is not None:
        share = min(own.c_fraction, 1.0)
        if own.fraction_distance is not None:
            ends = [share, share - own.fraction_distance]
            axes.plot([own.sigma_n_deg] * 2, ends, ":", color=colour, lw=1.2)
        axes.plot(
            [own.sigma_n_deg], [share], "D", mfc="white", mec=colour, ms=7, clip_on=False,
            zorder=4,
        )  # fmt: skip


def _labels(axes: Any, matches: Sequence[Match], reference: Reference) -> None:
    """Each sample's name at the right end of its curve, moved apart where they would meet."""
    ends = []
    for k, m in enumerate(matches):
        last = m.curve[-1].c_fraction
        ends.append((1.02 if last is None else last, k))
    below = -1.0
    for height, k in sorted(ends):
        m, at = matches[k], max(height, below + LABEL_GAP)
        below = at
        label = m.sample.label
        label = label if len(label) <= LABEL_LETTERS else label[: LABEL_LETTERS - 3] + "..."
        text = f"{label}  x {m.gloss / reference.gloss:.3g}"
        text += "" if m.proposed is not None else ", out of reach"
        axes.annotate(
            text, (1.02, at), xycoords=("axes fraction", "data"), va="center",
            color=COLOURS[k % len(COLOURS)], annotation_clip=False, fontsize=9,
        )  # fmt: skip


def _texts(figure: Any, reference: Reference) -> None:
    sample, criterion = reference.sample, reference.criterion
    figure.text(
        0.08, 0.93, f"Settings that keep the ratio of gloss to {sample.label}",
        fontsize=13, fontweight="bold", color=INK,
    )  # fmt: skip
    figure.text(
        0.08, 0.885,
        f"x 0.5: half the reference material's {gloss_words(criterion.gloss)}, "
        f"{reference.gloss:.4g}; pictures by {criterion.measure_words}",
        color=MUTED,
    )  # fmt: skip
    figure.text(
        0.08, 0.85,
        f"reference picture: sigma_N {sample.look.sigma_n_deg:g} deg, c {reference.c:.3g}",
        color=MUTED,
    )  # fmt: skip
    figure.text(
        0.08, 0.035,
        "Filled: proposed, at the sample's own grain. Open: given or published settings. "
        "Triangles: out of reach.\nA starting point for the eye; the experiment decides.",
        color=MUTED, fontsize=8,
    )  # fmt: skip
