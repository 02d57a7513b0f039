"""The curves of settings that keep the ratio of gloss, as a picture."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from relgloss_view.base.figures import INK, MUTED, drawing, new_figure, save_figure
from relgloss_view.base.writing import whole_file
from relgloss_view.gloss.match import MatchCurve, Reference
from relgloss_view.gloss.samples import gloss_number, gloss_words

#: They differ in lightness too (Okabe and Ito's blue, vermilion, green, purple, sky, orange).
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#8a5a8c", "#3f9fd0", "#b37a00")
LABEL_LETTERS = 22
LABEL_GAP = 0.055  #: between the labels of curves, in shares of the height
ROOM = 1.15  #: above the highest curve


def write_match_plot(reference: Reference, matches: Sequence[MatchCurve], path: str | Path) -> None:
    """Write a PNG of the curves, c over sigma_N, each with the range that single poses propose.

    Proposals and the samples' own settings are marked. The file appears whole or not at all.
    """
    with drawing({"font.size": 9.0}):
        figure = new_figure(9.4, 6.0, dpi=130)
        axes = figure.add_axes((0.08, 0.18, 0.62, 0.64))
        for k, m in enumerate(matches):
            _curve(axes, m, COLOURS[k % len(COLOURS)])
        axes.axhline(reference.c, color=MUTED, lw=1.0, ls="--")
        axes.set_xlabel("grain sigma_N, degrees")
        axes.set_ylabel("contrast gloss c")
        axes.set_ylim(0.0, ROOM * _highest(reference, matches))
        axes.set_xlim(-0.08, max(p.sigma_n_deg for m in matches for p in m.curve) + 0.08)
        _labels(axes, matches, reference)
        _texts(figure, reference)
        with whole_file(path) as temporary:
            save_figure(figure, temporary)


def _highest(reference: Reference, matches: Sequence[MatchCurve]) -> float:
    """The largest c that is drawn."""
    values = [reference.c]
    for m in matches:
        values += [p.high for p in m.curve if p.high is not None]
        values += [m.own_setting.c] if m.own_setting is not None else []
    return max(values)


def _curve(axes: Any, m: MatchCurve, colour: str) -> None:
    solved = [p for p in m.curve if p.c is not None]
    sigmas = [p.sigma_n_deg for p in solved]
    axes.fill_between(
        sigmas, [p.low for p in solved], [p.high for p in solved], color=colour, alpha=0.12, lw=0
    )
    axes.plot(sigmas, [p.c for p in solved], color=colour, lw=1.8)
    if m.proposed is not None:
        place = ([m.proposed.sigma_n_deg], [m.proposed.c])
        axes.plot(*place, "o", color=colour, ms=8, clip_on=False, zorder=3)
    own = m.own_setting
    if own is not None:
        if own.c_distance is not None:
            ends = [own.c, own.c - own.c_distance]
            axes.plot([own.sigma_n_deg] * 2, ends, ":", color=colour, lw=1.2)
        axes.plot(
            [own.sigma_n_deg], [own.c], "D", mfc="white", mec=colour, ms=7, clip_on=False,
            zorder=4,
        )  # fmt: skip


def _labels(axes: Any, matches: Sequence[MatchCurve], reference: Reference) -> None:
    """Each sample's name at the right end of its curve, moved apart where they would meet."""
    top = axes.get_ylim()[1]
    ends = []
    for k, m in enumerate(matches):
        last = m.curve[-1].c
        ends.append((0.0 if last is None else last / top, k))
    below = -1.0
    for height, k in sorted(ends):
        m, at = matches[k], max(height, below + LABEL_GAP)
        below = at
        label = m.sample.label
        label = label if len(label) <= LABEL_LETTERS else label[: LABEL_LETTERS - 3] + "..."
        text = f"{label}  x {m.ratio:.3g}"
        text += "" if m.proposed is not None else ", no highlight"
        axes.annotate(
            text, (1.02, at), xycoords="axes fraction", va="center",
            color=COLOURS[k % len(COLOURS)], annotation_clip=False, fontsize=9,
        )  # fmt: skip


def _texts(figure: Any, reference: Reference) -> None:
    sample = reference.sample
    lamps = ", ".join(f"{setup.lamp.azimuth_deg:g}" for setup in reference.setups)
    figure.text(
        0.08, 0.93, f"Settings that keep the ratio of gloss to {sample.label}",
        fontsize=13, fontweight="bold", color=INK,
    )  # fmt: skip
    figure.text(
        0.08, 0.885,
        f"x 0.5: half the reference material's {gloss_words(reference.gloss)}, "
        f"{gloss_number(reference.gloss, reference.reading)}; mean over the lamp at {lamps} deg",
        color=MUTED,
    )  # fmt: skip
    figure.text(
        0.08, 0.85,
        f"reference picture (dashed): sigma_N {sample.look.sigma_n_deg:g} deg, c {reference.c:.3g}",
        color=MUTED,
    )  # fmt: skip
    figure.text(
        0.08, 0.035,
        "Filled: proposed, at the sample's own grain. Open: given or published settings. "
        "Bands: what single poses propose.\nA starting point for the eye; the experiment decides.",
        color=MUTED, fontsize=8,
    )  # fmt: skip
