"""A fit as text for the terminal: the candidates in a table, the chosen model, the warnings."""

from __future__ import annotations

from typing import Any

import numpy as np

from relgloss_view.base.reading import printable
from relgloss_view.base.terminal import Column, table
from relgloss_view.material.material import FitRecord, Material

NOT_JUDGED = "not judged"
CANDIDATES = (
    Column("  model", 27, left=True),
    Column("unknowns", 8),
    Column("held-out error", 20),
    Column("median", 7),
    Column("", left=True),
)


def describe_fit(material: Material) -> str:
    """The candidates, the chosen model, its unknowns with standard errors, and the warnings."""
    fit = material.fit
    if fit is None:
        return f"{printable(material.name)}: not fitted, its parameters were given"
    source = printable(material.source) + (" [synthetic]" if material.synthetic else "")
    lines = [printable(material.name), f"  source     {source}", ""]
    rows = []
    for c in fit.candidates:
        mark = "*" if c["name"] == fit.chosen else " "
        error = f"{c['cv_mean']:.2%} +- {c['cv_se']:.2%}"
        median = f"{c['median_relative_error']:.1%}"
        rows.append((f"{mark} {c['name']}", str(c["parameters"]), error, median, c["verdict"]))
    lines += [table(CANDIDATES, rows), ""]
    se = fit.standard_errors
    albedo = np.asarray(material.diffuse.albedo)
    lines.append(
        f"  diffuse    {material.diffuse.model}, albedo {albedo.min():.3f}-{albedo.max():.3f}"
    )
    if material.diffuse.sigma_deg > 0.0:
        lines.append(
            f"  sigma      {material.diffuse.sigma:.3f} rad "
            f"({material.diffuse.sigma_deg:.2f} deg, se {se.get('sigma_deg', 0.0):.2g})"
        )
    for k, lobe in enumerate(material.specular):
        strength = np.asarray(lobe.strength)
        span = f"{strength[0]:.4g}"
        if len(strength) > 1:
            span = f"{strength.min():.4g}-{strength.max():.4g} over the bands"
        error = width_error(material, k, "se ")
        lines.append(
            f"  lobe {k + 1}     s {lobe.s_deg:.3g} deg"
            + (f" ({error})" if error else "")
            + f", strength {span}, "
            + (
                f"n {lobe.refractive_index:.3g}"
                if lobe.f0 is None
                else f"metal, F0 {min(lobe.f0):.3g}-{max(lobe.f0):.3g}"
            )
        )
    r = fit.residuals
    lines.append(
        f"  residual   median {r['median_relative_error']:.1%}, p90 {r['p90_relative_error']:.1%}, "
        + str(r.get("selected") or f"{r['samples']} samples")
        + "".join(f", {count} left out ({why})" for why, count in r["left_out"].items())
    )
    lines += [f"  {label:<11}{words}" for label, words in derived_lines(fit)]
    lines += [f"  {label:<11}{words}" for label, words in use_lines(fit.judgement)]
    lines.append(f"  quality    {fit.quality} ({fit.seconds:.2f} s)")
    lines += [f"  warning    {printable(text, 300)}" for text in material.warnings]
    return "\n".join(lines)


def derived_lines(fit: FitRecord) -> list[tuple[str, str]]:
    """The peak and c_max with their errors, and the errors of the instrument that were found."""
    lines = []
    try:
        words = {
            name: _with_error(fit.derived[name])
            for name in ("peak", "c_max")
            if name in fit.derived
        }
        if "peak" in words:
            lines.append(("peak", f"radiance factor {words['peak']} at the mirror of 45 deg"))
        if "c_max" in words:
            lines.append(("c_max", f"{words['c_max']} (default cylinder and lamp)"))
        for name, error in fit.instrument.items():
            if error["value"]:
                unit = " deg" if error["unit"] == "deg" else ""
                lines.append(("instrument", f"{name} off by {_with_error(error)}{unit}"))
    except (KeyError, TypeError, ValueError, AttributeError):  # a file that someone else wrote
        return []
    return [(label, printable(words, 200)) for label, words in lines]


def _with_error(entry: dict[str, Any]) -> str:
    error = entry.get("standard_error")
    return f"{entry['value']:.3g}" + (f" +- {error:.2g}" if error else "")


def use_lines(judgement: dict[str, Any]) -> list[tuple[str, str]]:
    """The judgement of a fit by gloss and picture, label and words; none where a file has none."""
    try:
        lines = [*_gloss_lines(judgement), *_picture_lines(judgement)]
        tail = judgement.get("tail")
        if tail:
            near = tail["mirror_explained"]
            beside = "" if near is None else f", near the mirror {near:.1%}"
            words = f"{tail['explained']:.1%} explained{beside}; error p99 {tail['p99']:.1%}"
            lines.append(("light", words))
    except (KeyError, TypeError, ValueError, AttributeError):  # a file that someone else wrote
        return []
    return [(label, printable(words, 200)) for label, words in lines]


def _gloss_lines(judgement: dict[str, Any]) -> list[tuple[str, str]]:
    rows = judgement.get("gloss", ())
    lines = [
        (
            f"gloss {row['angle_deg']:g}",
            f"fit {row['fit']:.1f}, table {row['table']:.1f} +- {max(row['table_error'], 0.1):.1f}",
        )
        for row in rows
        if row["fit"] is not None
    ]
    missing = [row for row in rows if row["fit"] is None]
    if missing:
        angles = ", ".join(f"{row['angle_deg']:g}" for row in missing)
        lines.append(("gloss", f"{NOT_JUDGED} at {angles}: {missing[0]['reason']}"))
    return lines


def _picture_lines(judgement: dict[str, Any]) -> list[tuple[str, str]]:
    rows = judgement.get("pictures", ())
    compared = [
        f"{row['whole_object'] if row['highlight'] is None else row['highlight']:.1f} at lamp "
        f"{row['lamp_azimuth_deg']:g}"
        for row in rows
        if row["whole_object"] is not None
    ]
    lines = [("picture", f"dE2000 (p95) {', '.join(compared)}")] if compared else []
    missing = [row for row in rows if row["whole_object"] is None]
    if missing:
        lamps = ", ".join(f"{row['lamp_azimuth_deg']:g}" for row in missing)
        lines.append(("picture", f"{NOT_JUDGED} at lamp {lamps}: {missing[0]['reason']}"))
    return lines


def width_error(material: Material, lobe: int, sign: str) -> str:
    """The standard error of a lobe's width after `sign`; a width at its limit has none."""
    if material.specular[lobe].at_the_limit:
        return "at the limit"
    errors = material.fit.standard_errors.get("s_deg", []) if material.fit else []
    return f"{sign}{errors[lobe]:.2g}" if lobe < len(errors) else ""
