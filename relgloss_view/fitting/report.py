"""The page that shows a fit: what was measured, what was fitted, why this model, what to doubt."""

from __future__ import annotations

import textwrap
from pathlib import Path
from typing import Any

import numpy as np

from relgloss_view.base.figures import ACCENT, INK, MUTED, drawing, new_figure, save_figure
from relgloss_view.base.reading import printable
from relgloss_view.base.writing import whole_file
from relgloss_view.fitting import curves, slices
from relgloss_view.fitting.describe import NOT_JUDGED, use_lines, width_error
from relgloss_view.fitting.instrument import as_fitted
from relgloss_view.fitting.observations import usable_rows
from relgloss_view.material.material import FitRecord, Material, Quality
from relgloss_view.measure.table import Measurement

GOOD = "#2e7d4f"
SMALLEST_SPAN = 1.5  #: of an axis of radiance factors, from its middle up
SMALLEST_PERCENT = 1e-4  #: of the axis of errors
PAGE_INCHES, LINE_INCHES = 9.0, 0.144  #: height of a page with two warnings, and of each further
MOST_WARNINGS = 8
MOST_RESIDUALS = 60_000  #: more hide one another
FACTS_CHARACTERS, FACTS_LINES = 66, 14  #: of a line of facts, and lines that fit widely spaced
BADGE = {Quality.GOOD: GOOD, Quality.POOR: ACCENT, Quality.UNIDENTIFIABLE: "#b26a00"}


def write_fit_report(material: Material, measurement: Measurement, path: str | Path) -> None:
    """Write a one-page PNG of a fitted material beside the measurement it was fitted to.

    Raises ValueError for a material without a fit; the file appears whole or not at all.
    """
    fit = material.fit
    if fit is None:
        raise ValueError(f"{material.name} was not fitted")
    with drawing():
        lines = _warning_lines(material, fit)
        height = PAGE_INCHES + LINE_INCHES * max(len(lines) - 2, 0)
        figure = new_figure(13.2, height, dpi=120)
        grid = figure.add_gridspec(
            3,
            6,
            left=0.055,
            right=0.98,
            top=1.0 - (1.26 + height - PAGE_INCHES) / height,
            bottom=0.54 / height,
            wspace=0.85,
            hspace=0.42,
            height_ratios=(1.15, 1.0, 0.95),
        )
        measurement = as_fitted(measurement, material)
        measured = slices.prepare(material, measurement, usable_rows(measurement), MOST_RESIDUALS)
        _heading(figure, material, lines, height)
        _plane(figure.add_subplot(grid[0, :4]), material, measured)
        _spectra(figure.add_subplot(grid[0, 4:]), material)
        _ridge(figure.add_subplot(grid[1, :2]), material, measured)
        _tilt(figure.add_subplot(grid[1, 2:4]), material, measured)
        _residuals(figure.add_subplot(grid[1, 4:]), measured)
        _candidates(figure.add_subplot(grid[2, 1:4]), fit.candidates, fit.chosen)
        _facts(figure.add_subplot(grid[2, 4:]), material)
        with whole_file(path) as temporary:
            save_figure(figure, temporary)


def _warning_lines(material: Material, fit: FitRecord) -> list[str]:
    """The warnings of a page, those that explain the quality first."""
    texts = sorted(material.warnings, key=lambda text: text not in fit.grounds)
    if len(texts) > MOST_WARNINGS:
        rest = len(texts) - MOST_WARNINGS + 1
        texts = [*texts[: MOST_WARNINGS - 1], f"and {rest} more, listed in the material file"]
    return [f"! {printable(text, 210)}" for text in texts]


def _heading(figure: Any, material: Material, lines: list[str], height: float) -> None:
    """Name, source, badges and warnings at the top of a page of that height, inches."""
    fit = material.fit
    assert fit is not None

    def below(inches: float) -> float:
        return 1.0 - inches / height

    # Names hold dollar signs too: nothing from outside is mathematics.
    name, source = printable(material.name, 60), printable(material.source, 150)
    figure.text(0.055, below(0.405), name, fontsize=16, weight="bold", color=INK, parse_math=False)
    figure.text(0.055, below(0.63), source, fontsize=8, color=MUTED, parse_math=False)
    badges = [(fit.quality.upper(), BADGE[fit.quality])]
    if material.synthetic:
        badges.append(("SYNTHETIC, NOT MEASURED", "#5b4b9a"))
    x = 0.98
    for text, colour in badges:
        drawn = figure.text(
            x,
            below(0.387),
            text,
            ha="right",
            fontsize=9,
            weight="bold",
            color="white",
            bbox={"boxstyle": "round,pad=0.4", "facecolor": colour, "edgecolor": "none"},
        )
        x -= 0.0075 * len(str(drawn.get_text())) + 0.02
    for k, line in enumerate(lines):
        y = below(0.828 + LINE_INCHES * k)
        figure.text(0.055, y, line, fontsize=8, color=ACCENT, parse_math=False)


def _logarithmic(axis: Any) -> None:
    """A logarithmic radiance factor, its ticks at 1, 2 and 5 in plain numbers."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    axis.set_yscale("log")
    low, high = axis.get_ylim()
    middle, span = np.sqrt(low * high), max(np.sqrt(high / low), SMALLEST_SPAN)
    axis.set_ylim(middle / span, middle * span)  # rounding of a flat sample is no shape
    axis.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0), numticks=9))
    axis.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.yaxis.set_minor_formatter(NullFormatter())


def _colours(count: int) -> list[Any]:
    from matplotlib import colormaps

    return [colormaps["viridis"](x) for x in np.linspace(0.0, 0.85, count)]


def _nothing(axis: Any, text: str) -> None:
    """A panel whose slice the table does not have: the words instead of an empty frame."""
    axis.set_axis_off()
    axis.text(0.5, 0.5, text, ha="center", va="center", fontsize=8, color=MUTED)


def _plane(axis: Any, material: Material, measured: slices.Slices) -> None:
    axis.set_title(f"Mirror plane, {measured.label}")
    chosen = slices.some(measured.incidences(), 5)
    if not chosen:
        _nothing(axis, "no incidence has a sample near its mirror direction")
        return
    angle = slices.receiver_angles(chosen, material)
    for incidence, colour in zip(chosen, _colours(len(chosen)), strict=True):
        x, y = measured.plane(incidence)
        axis.plot(x, y, "o", ms=3.0, mew=0.0, color=colour, alpha=0.75)
        lamp, receiver = curves.in_plane(incidence, angle)
        fitted = curves.seen(material, lamp, receiver, measured.aperture_sd_deg)[:, measured.band]
        axis.plot(angle, fitted, lw=1.0, color=colour, label=f"{incidence:g}°")
    _logarithmic(axis)
    axis.set_xlabel("receiver angle, mirror side positive (deg)")
    axis.set_ylabel("radiance factor")
    axis.legend(title="incidence; points measured, lines fitted", ncols=5, loc="upper left")


def _ridge(axis: Any, material: Material, measured: slices.Slices) -> None:
    axis.set_title("Across the mirror direction")
    chosen = slices.some(measured.incidences(), 5)
    if not chosen:
        _nothing(axis, "no sample near a mirror direction")
        return
    offset = np.linspace(-6.0, 6.0, 241)
    for incidence, colour in zip(chosen, _colours(len(chosen)), strict=True):
        x, y = measured.plane(incidence)
        near = np.abs(x - incidence) <= 6.0
        axis.plot(x[near] - incidence, y[near], "o", ms=3.0, mew=0.0, color=colour, alpha=0.8)
        lamp, receiver = curves.in_plane(incidence, np.minimum(incidence + offset, 88.0))
        fitted = curves.seen(material, lamp, receiver, measured.aperture_sd_deg)[:, measured.band]
        axis.plot(offset, fitted, lw=1.0, color=colour)
    _logarithmic(axis)
    axis.set_xlabel("receiver off the mirror direction (deg)")
    axis.set_ylabel("radiance factor")


def _tilt(axis: Any, material: Material, measured: slices.Slices) -> None:
    axis.set_title("Out of the plane")
    chosen = slices.some(measured.tilt_angles(), 4)
    if not chosen:
        _nothing(axis, "all samples lie in the plane of incidence")
        return
    for theta, colour in zip(chosen, _colours(len(chosen)), strict=True):
        x, y = measured.tilt(theta)
        axis.plot(x, y, "o", ms=3.0, mew=0.0, color=colour, alpha=0.8)
        lamp, receiver = measured.tilt_directions(theta)
        fitted = curves.seen(material, lamp, receiver, measured.aperture_sd_deg)[:, measured.band]
        half = np.degrees(np.sqrt(curves.facing(lamp, receiver).delta2))
        axis.plot(half, fitted, lw=1.0, color=colour, label=f"{theta:g}°")
    _logarithmic(axis)
    axis.set_xlabel("half-vector from the normal (deg)")
    axis.legend(title=measured.tilt_label, ncols=2, loc="upper right")


def _residuals(axis: Any, measured: slices.Slices) -> None:
    x, y = measured.residuals()
    drawn, count = len(measured.compared), len(measured.value)
    part = f" ({drawn} of {count} drawn)" if drawn < count else ""
    axis.set_title(f"Residuals, all bands{part}")
    axis.axhspan(-5.0, 5.0, color=GOOD, alpha=0.08, lw=0)
    axis.plot(x, np.clip(y, -60.0, 60.0), ".", ms=1.6, color=INK, alpha=0.25, rasterized=True)
    axis.axhline(0.0, lw=0.7, color=INK)
    axis.set_ylim(-63.0, 63.0)
    axis.set_xlabel("half-vector from the normal (deg)")
    axis.set_ylabel("fitted over measured, minus 1 (%)")


def _candidates(axis: Any, candidates: tuple[dict[str, Any], ...], chosen: str) -> None:
    axis.set_title("Candidates: error on planes left out, one standard error")
    place = np.arange(len(candidates))[::-1]
    for y, c in zip(place, candidates, strict=True):
        picked = c["name"] == chosen
        mean, se = _percent(c["cv_mean"]), 100.0 * c["cv_se"]
        colour = GOOD if picked else "#aab3bb"
        axis.barh(y, mean, height=0.62, color=colour)
        axis.plot([max(mean - se, 0.3 * mean), mean + se], [y, y], color=INK, lw=0.9)
        text = f"{mean:.3g} %   {c['parameters']} unknowns   {c['verdict']}"
        axis.text(
            1.08 * (mean + se),
            y,
            text,
            va="center",
            fontsize=6.6,
            color=INK if picked else MUTED,
            weight="bold" if picked else "normal",
        )
    top = max(_percent(c["cv_mean"] + c["cv_se"]) for c in candidates)
    low = min(_percent(c["cv_mean"]) for c in candidates)
    axis.set_xscale("log")
    axis.set_xlim(0.5 * low, top * (top / (0.5 * low)) ** 0.9)
    ticks = [t for t in (0.01, 0.1, 1.0, 10.0, 100.0) if 0.5 * low <= t <= 1.2 * top]
    axis.set_xticks(ticks, [f"{t:g}" for t in ticks])
    axis.minorticks_off()
    axis.set_yticks(place, [c["name"] for c in candidates])
    axis.set_xlabel("logarithmic error, about relative error (%)")
    axis.grid(visible=False, axis="y")


def _percent(error: float) -> float:
    """An error in percent, kept on the logarithmic axis: data without noise leave none at all."""
    return max(100.0 * float(error), SMALLEST_PERCENT)


def _spectra(axis: Any, material: Material) -> None:
    axis.set_title("Diffuse albedo and lobe strengths")
    rgb = material.bands.is_rgb
    x = np.arange(3) if rgb else material.bands.centres_nm()
    style = "o-"
    axis.plot(x, material.diffuse.albedo, style, ms=3.0, lw=1.2, color=GOOD, label="albedo")
    for k, lobe in enumerate(material.specular):
        strength = lobe.parts(material.bands.count)[0].spectrum
        axis.plot(
            x,
            strength,
            lw=1.2,
            ls="--",
            color=_colours(3)[k],
            label=f"lobe {k + 1}, s = {lobe.s_deg:.3g}°" + (", metal: k F0" * lobe.is_metal),
        )
    axis.set_ylim(bottom=0.0)
    if rgb:
        axis.set_xticks(x, list(material.bands.labels))
    else:
        axis.set_xlabel("wavelength (nm)")
    axis.legend(loc="best")


def _facts(axis: Any, material: Material) -> None:
    fit = material.fit
    assert fit is not None
    axis.set_axis_off()
    r, se = fit.residuals, fit.standard_errors
    lines = [f"chosen: {fit.chosen}", f"diffuse: {material.diffuse.model}"]
    if material.diffuse.sigma_deg:
        lines[-1] += f", sigma {material.diffuse.sigma:.3f} rad"
    for k, lobe in enumerate(material.specular):
        error = width_error(material, k, "± ")
        strength = float(np.mean(lobe.strength))
        index = f"n {lobe.refractive_index:.3g}" if not lobe.is_metal else "metal"
        lines.append(f"lobe {k + 1}: s {lobe.s_deg:.3g}° {error}, strength {strength:.3g}, {index}")
    if not material.specular and "no_lobe" in fit.bounds:
        upper = fit.bounds["no_lobe"]["largest_strength_upper"]
        lines.append("no lobe" + (f"; strength at most {upper:.2g}" if upper else ""))
    lines.append(
        f"median error {r['median_relative_error']:.1%}, 90th percentile "
        f"{r['p90_relative_error']:.1%}"
    )
    near, far = (r[k]["median_relative_error"] for k in ("near_mirror", "far"))
    parts = [f"{n} {v:.1%}" for n, v in (("near mirror", near), ("elsewhere", far)) if v]
    lines.append(", ".join(parts))
    selected = r.get("selected")
    used = f"chosen by {printable(str(selected), 60)}" if selected else f"{r['samples']} samples"
    lines.append(f"{used}; aperture sd {r['aperture_sd_deg']} deg")
    lines += [f"{count} left out: {reason}" for reason, count in r["left_out"].items()]
    lines += [
        f"{label}: {words}"
        for label, words in use_lines(fit.judgement)
        if not words.startswith(NOT_JUDGED)
    ]
    if "method" in se:
        lines.append(f"±: {se['method']}")
    lines = [part for line in lines for part in textwrap.wrap(line, FACTS_CHARACTERS)]
    spacing = 1.5 * min(1.0, FACTS_LINES / len(lines))
    axis.text(0.0, 1.0, "\n".join(lines), va="top", fontsize=7.6, linespacing=spacing, color=INK)
