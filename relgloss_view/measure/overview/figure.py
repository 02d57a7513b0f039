"""The page that shows a table before any fit."""

from __future__ import annotations

import textwrap
from pathlib import Path
from typing import Any

import numpy as np

from relgloss_view.base.arrays import Array, Mask
from relgloss_view.base.figures import ACCENT, INK, MUTED, drawing, new_figure, save_figure
from relgloss_view.base.reading import printable
from relgloss_view.base.writing import whole_file
from relgloss_view.measure.overview.describe import evenly, facts, ridge_words
from relgloss_view.measure.overview.directions import BODY, GRAZING, MIRROR, STEEP_MIRROR
from relgloss_view.measure.overview.overview import Overview
from relgloss_view.measure.overview.polar import IN_PLANE_DEG

WIDTH_INCHES, PANELS_INCHES, TOP_INCHES = 13.2, 6.9, 0.95
LINE_INCHES = 0.152  #: of text below the panels
TEXT_CHARACTERS = 190  #: of a line of it
MOST_FINDINGS = 8
MOST_POINTS = 20_000  #: a scatter of more is as black
MOST_INCIDENCES = 5
ACROSS_DEG = 8.0  #: half width of the panel across the mirror direction
SMALLEST_SPAN = 1.5  #: of an axis of radiance factors, from its middle up
STEP_DEG = 0.02  #: incidences within it are one
#: Colour and line of each part; two parts of one sample often have the same spectrum.
STYLES = {
    BODY: ("#2e7d4f", "-"),
    MIRROR: (ACCENT, "-"),
    STEEP_MIRROR: ("#b26a00", "--"),
    GRAZING: ("#3f51a3", "--"),
}
BESIDE = "#8e99a3"  #: what is left out
DOUBT = "#8a5200"


def write_overview(overview: Overview, path: str | Path, purpose: str) -> None:
    """Write a one-page PNG of a table; it appears whole or not at all.

    purpose: what the table can serve for, in words.
    """
    with drawing():
        notes = _notes(overview, purpose)
        below = 0.35 + LINE_INCHES * len(notes)
        height = TOP_INCHES + PANELS_INCHES + below
        figure = new_figure(WIDTH_INCHES, height, dpi=120)
        grid = figure.add_gridspec(
            2,
            3,
            left=0.06,
            right=0.98,
            top=1.0 - TOP_INCHES / height,
            bottom=(below + 0.5) / height,
            wspace=0.24,
            hspace=0.36,
        )
        _heading(figure, overview, height)
        _geometries(figure, figure.add_subplot(grid[0, 0]), overview)
        _plane(figure.add_subplot(grid[0, 1:]), overview)
        _across(figure.add_subplot(grid[1, 0]), overview)
        _spectra(figure.add_subplot(grid[1, 1]), overview)
        _exchange(figure.add_subplot(grid[1, 2]), overview)
        for k, (label, words, colour) in enumerate(notes):
            y = (below - 0.12 - LINE_INCHES * k) / height
            figure.text(0.02, y, label, fontsize=8, color=MUTED, va="top")
            figure.text(0.095, y, words, fontsize=8, color=colour, va="top")
        with whole_file(path) as temporary:
            save_figure(figure, temporary)


def _heading(figure: Any, overview: Overview, height: float) -> None:
    measured = overview.measurement
    name, source = printable(measured.name, 60), printable(measured.source, 150)
    figure.text(0.02, 1.0 - 0.36 / height, name, fontsize=16, weight="bold", color=INK)
    figure.text(0.02, 1.0 - 0.58 / height, source, fontsize=8, color=MUTED)
    if measured.synthetic:
        figure.text(
            0.98,
            1.0 - 0.34 / height,
            "SYNTHETIC, NOT MEASURED",
            ha="right",
            fontsize=9,
            weight="bold",
            color="white",
            bbox={"boxstyle": "round,pad=0.4", "facecolor": "#5b4b9a", "edgecolor": "none"},
        )


def _notes(overview: Overview, purpose: str) -> list[tuple[str, str, str]]:
    """Lines below the panels: label, words and colour; a wrapped line has no label."""
    lines = [(label, words, INK) for label, words in facts(overview)]
    lines.append(("mirror ridge", ridge_words(overview), INK))
    texts = [
        ("serious" if f.serious else "finding", f.text, ACCENT if f.serious else DOUBT)
        for f in overview.findings
    ]
    texts += [("warning", text, DOUBT) for text in overview.warnings]
    lines += texts[:MOST_FINDINGS]
    if len(texts) > MOST_FINDINGS:
        lines.append(
            ("", f"and {len(texts) - MOST_FINDINGS} more, which the command prints", MUTED)
        )
    lines.append(("serves for", purpose, INK))
    return [
        (label if k == 0 else "", part, colour)
        for label, words, colour in lines
        for k, part in enumerate(textwrap.wrap(printable(words, 500), TEXT_CHARACTERS))
    ]


def _geometries(figure: Any, axis: Any, overview: Overview) -> None:
    """Lamp against receiver: where there are readings, and which are left out."""
    axis.set_title("Geometries")
    polar, used = overview.polar, overview.mask
    lamp, receiver = polar.lamp_deg, polar.signed_receiver_deg
    out = _some(np.flatnonzero(~used))
    if len(out):
        label = f"left out ({int(np.sum(~used))})"
        axis.plot(lamp[out], receiver[out], "x", ms=3.0, mew=0.7, color=BESIDE, label=label)
    at = _some(np.flatnonzero(used))
    azimuth = polar.out_of_plane_deg[at]
    several = bool(np.any(azimuth >= IN_PLANE_DEG))
    order = np.argsort(-azimuth, kind="stable")  # the plane of incidence on top
    at, azimuth = at[order], azimuth[order]
    dots = axis.scatter(
        lamp[at],
        receiver[at],
        s=9.0 if len(at) > 60 else 24.0,
        c=azimuth if several else INK,
        cmap="viridis_r" if several else None,
        vmin=0.0 if several else None,
        vmax=90.0 if several else None,
        linewidths=0.0,
        rasterized=True,
    )
    if several:
        bar = figure.colorbar(dots, ax=axis, pad=0.02, aspect=30)
        bar.set_label("receiver out of the plane of incidence (deg)")
        bar.set_ticks([0, 30, 60, 90])
        bar.outline.set_visible(False)
    axis.plot([0.0, 90.0], [0.0, 90.0], lw=0.8, ls="--", color=ACCENT, label="mirror direction")
    axis.set_xlim(-3.0, 93.0)
    axis.set_ylim(-93.0, 93.0)
    axis.set_xticks(range(0, 91, 15))
    axis.set_yticks(range(-90, 91, 30))
    axis.set_xlabel("lamp from the normal (deg)")
    axis.set_ylabel("receiver from the normal,\nmirror side positive (deg)")
    place = {"loc": "lower right", "bbox_to_anchor": (1.0, 0.995), "borderaxespad": 0.0}
    axis.legend(ncols=2, handlelength=1.6, columnspacing=1.2, **place)


def _plane(axis: Any, overview: Overview) -> None:
    axis.set_title("In the plane of incidence, mean over the bands")
    curves = _curves(overview, overview.mask)
    if not curves:
        _nothing(axis, "no lamp direction has several receivers in its plane")
        return
    for (incidence, x, y), colour in zip(curves, _colours(len(curves)), strict=True):
        axis.plot(x, y, "o-", ms=2.6, mew=0.0, lw=0.7, color=colour, label=f"{incidence:.4g}°")
    angle, _, level = _beside(overview, curves)
    axis.plot(angle, level, "x", ms=3.5, mew=0.8, color=BESIDE)
    _logarithmic(axis)
    axis.set_xlabel("receiver from the normal, mirror side positive (deg)")
    axis.set_ylabel("radiance factor")
    axis.legend(title="lamp from the normal", ncols=len(curves), loc="upper left")


def _across(axis: Any, overview: Overview) -> None:
    axis.set_title("Across the mirror direction")
    near = _curves(overview, overview.mask, ACROSS_DEG)
    if not near:
        _nothing(axis, "no lamp direction has receivers on both sides of its mirror direction")
        return
    axis.axvline(0.0, lw=0.8, ls="--", color=ACCENT)
    for (incidence, x, y), colour in zip(near, _colours(len(near)), strict=True):
        axis.plot(
            x - incidence, y, "o-", ms=2.8, mew=0.0, lw=0.7, color=colour, label=f"{incidence:.4g}°"
        )
    angle, lamp, level = _beside(overview, near)
    inside = np.abs(angle - lamp) <= ACROSS_DEG
    axis.plot(
        (angle - lamp)[inside], level[inside], "x", ms=3.5, mew=0.8, color=BESIDE,
        label="left out" if np.any(inside) else "_none",
    )  # fmt: skip
    _logarithmic(axis)
    axis.set_xlim(-ACROSS_DEG - 0.3, ACROSS_DEG + 0.3)
    axis.set_xlabel("receiver off the mirror direction (deg)")
    axis.set_ylabel("radiance factor")
    axis.legend(title="lamp", loc="upper right")


def _spectra(axis: Any, overview: Overview) -> None:
    axis.set_title("Spectra of a few directions")
    if not overview.directions:
        _nothing(axis, "no reading is used")
        return
    measured, polar = overview.measurement, overview.polar
    rgb = measured.bands.is_rgb
    x = np.arange(3) if rgb else measured.bands.centres_nm()
    for shown in overview.directions:
        value = measured.radiance_factor[shown.row]
        label = f"{shown.part}: {polar.words(shown.row)}".replace(" out of the plane", " aside")
        colour, line = STYLES[shown.part]
        axis.plot(
            x, np.where(value > 0.0, value, np.nan), line, lw=1.2, color=colour, label=label,
            marker="o" if rgb or len(x) < 12 else None, ms=3.0,
        )  # fmt: skip
    _logarithmic(axis, room=0.35 if len(overview.directions) > 2 else 0.2)
    if rgb:
        axis.set_xticks(x, list(measured.bands.labels))
    else:
        axis.set_xlabel("wavelength (nm)")
    axis.set_ylabel("radiance factor")
    axis.legend(loc="upper left", fontsize=6.5)


def _exchange(axis: Any, overview: Overview) -> None:
    axis.set_title("Lamp and receiver exchanged")
    pairs = overview.reciprocity
    if not pairs.pairs:
        _nothing(axis, "no reading has a partner with lamp and receiver exchanged")
        return
    at = _some(np.arange(pairs.pairs))
    most = float(pairs.typical(95.0) or 0.0) * 100.0
    axis.axhspan(-most, most, color="#2e7d4f", alpha=0.10, lw=0, label="95 % of the pairs")
    axis.axhline(0.0, lw=0.7, color=INK)
    axis.plot(
        pairs.half_deg[at], 100.0 * pairs.difference[at], ".", ms=4.0 if len(at) < 1000 else 2.0,
        color=INK, alpha=0.6 if len(at) < 1000 else 0.2, mew=0.0,
        rasterized=True,
    )  # fmt: skip
    limit = max(1.25 * 100.0 * float(np.max(np.abs(pairs.difference))), 1.0)
    axis.set_ylim(-limit, limit)
    axis.set_xlim(left=0.0)
    axis.set_xlabel("half-vector from the normal (deg)")
    axis.set_ylabel("difference, lamp at the larger angle first (%)")
    axis.legend(loc="upper right")


def _curves(
    overview: Overview, used: Mask, around_deg: float | None = None
) -> list[tuple[float, Array, Array]]:
    """(incidence, receiver angles, levels) in the plane, for a few incidences with enough of them.

    around_deg: receivers within it of the mirror direction alone, some on both sides.
    """
    polar, level = overview.polar, overview.level
    planar = used & (polar.out_of_plane_deg < IN_PLANE_DEG) & (level > 0.0)
    signed = polar.signed_receiver_deg
    if around_deg is not None:
        planar &= np.abs(signed - polar.lamp_deg) <= around_deg
    at = np.flatnonzero(planar)
    names, number = np.unique(np.rint(polar.lamp_deg[at] / STEP_DEG), return_inverse=True)
    # Distinct receivers: a lamp along the normal has one azimuth for all.
    sites = np.unique(np.column_stack([number, np.rint(signed[at] / STEP_DEG)]), axis=0)
    count = np.bincount(sites[:, 0].astype(np.int64), minlength=len(names))
    enough = np.flatnonzero(count >= 3)
    # Lamps that many receivers look at; a tilted sample adds others with a few.
    enough = enough[count[enough] >= 0.3 * np.max(count, initial=0)]
    curves = []
    for k in enough:
        rows = at[number == k]
        x, inverse = np.unique(np.round(signed[rows], 3), return_inverse=True)
        y = np.exp(np.bincount(inverse, np.log(level[rows])) / np.bincount(inverse))
        incidence = float(np.mean(polar.lamp_deg[rows]))
        if around_deg is not None and (len(x) < 3 or not x[0] <= incidence <= x[-1]):
            continue
        curves.append((incidence, x, y))
    return [curves[k] for k in evenly(len(curves), MOST_INCIDENCES)] if curves else []


def _beside(
    overview: Overview, curves: list[tuple[float, Array, Array]]
) -> tuple[Array, Array, Array]:
    """Receiver angle, incidence and level of what is left out, at the drawn incidences."""
    polar, level = overview.polar, overview.level
    drawn = np.zeros(len(level), dtype=bool)
    for incidence, _, _ in curves:
        drawn |= np.abs(polar.lamp_deg - incidence) < STEP_DEG
    rows = drawn & ~overview.mask & (polar.out_of_plane_deg < IN_PLANE_DEG)
    at = _some(np.flatnonzero(rows & (np.nan_to_num(level) > 0.0)))
    return polar.signed_receiver_deg[at], polar.lamp_deg[at], level[at]


def _some(rows: Any) -> Any:
    return rows[evenly(len(rows), MOST_POINTS)] if len(rows) > MOST_POINTS else rows


def _colours(count: int) -> list[Any]:
    from matplotlib import colormaps

    return [colormaps["viridis"](x) for x in np.linspace(0.0, 0.85, count)]


def _logarithmic(axis: Any, room: float = 0.12) -> None:
    """A logarithmic radiance factor, its ticks in plain numbers.

    room: for a legend on top, as a share of the axis.
    """
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    axis.set_yscale("log")
    low, high = axis.get_ylim()
    middle, span = np.sqrt(low * high), max(np.sqrt(high / low), SMALLEST_SPAN)
    axis.set_ylim(middle / span, middle * span * span ** (2.0 * room / (1.0 - room)))
    few = span > 50.0
    axis.yaxis.set_major_locator(LogLocator(subs=(1.0,) if few else (1.0, 2.0, 5.0), numticks=9))
    axis.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:.9g}"))
    axis.yaxis.set_minor_formatter(NullFormatter())


def _nothing(axis: Any, text: str) -> None:
    axis.set_axis_off()
    axis.text(0.5, 0.5, text, ha="center", va="center", fontsize=8, color=MUTED)
