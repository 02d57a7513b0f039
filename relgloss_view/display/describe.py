"""An overview of a monitor as text for the terminal."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from relgloss_view.base.reading import printable
from relgloss_view.display.overview import LOAD_CALIBRATION, Overview

if TYPE_CHECKING:
    from relgloss_view.display.fit import DisplayFit

MOST_NAMED = 8  #: misread patches
LABEL = 16  #: width of the labels
LEAST_BLACK = 1e-6  #: of white, below which a number would only be rounding
LONGEST = 300  #: characters of a note
KINDS = {
    "curves": "one curve a channel, and a matrix",
    "gain-offset-gamma": "gain, offset and gamma of each channel, and a matrix",
    "table": "a look-up table",
}


def describe(overview: Overview, more: Sequence[str] = ()) -> str:
    """The overview in lines of a label and words. more: further notes."""
    notes = dict.fromkeys((*overview.notes, *more))
    lines = [printable(overview.name, 80)]
    lines += [line(label, words) for label, words in facts(overview)]
    lines += [line("missing", f"{one.what}: {one.step}") for one in overview.missing]
    lines += [line("note", printable(note, LONGEST)) for note in notes]
    return "\n".join(lines)


def facts(overview: Overview) -> list[tuple[str, str]]:
    """Label and words of each number."""
    found = [("model", f"{KINDS.get(overview.kind, overview.kind)}, from {_source(overview)}")]
    found += [("white", white_words(overview)), ("black", black_words(overview))]
    if overview.contrast is not None:
        found.append(("contrast", f"{overview.contrast:.4g} : 1"))
    if overview.reflected_cd_m2:
        words = f"{overview.reflected_cd_m2:.3g} cd/m2 of the room, added everywhere"
        found.append(("reflected light", words))
    named = zip("RGB", overview.primaries_xy, strict=True)
    found.append(("primaries (xy)", ", ".join(f"{n} {x:.4f} {y:.4f}" for n, (x, y) in named)))
    covered = (f"{100.0 * c.covered:.0f} % of {name}" for name, c in overview.gamut.items())
    found.append(("gamut", f"{', '.join(covered)} (areas in u'v')"))
    gammas = ", ".join(f"{name} {g:.2f}" for name, g in zip("RGB", overview.gamma, strict=True))
    found.append(("gamma", gammas))
    if overview.calibrated is not None:
        found.append(
            ("calibration", LOAD_CALIBRATION if overview.calibrated else "none in the profile")
        )
    return found


def white_words(overview: Overview) -> str:
    """Luminance, chromaticity and temperature of white."""
    luminance = overview.luminance_cd_m2
    x, y = overview.white_xy
    words = "" if luminance is None else f"{luminance:.4g} cd/m2, "
    words += f"xy {x:.4f} {y:.4f}"
    if overview.temperature is not None:
        kelvin, distance = overview.temperature
        words += f", {kelvin:.0f} K (Duv {distance:+.4f})"
    return words


def black_words(overview: Overview) -> str:
    """Black as a share of white and as a luminance."""
    if overview.black is None:
        return "not known"
    if overview.black < LEAST_BLACK:
        return f"less than {100.0 * LEAST_BLACK:.4f} % of white"
    share = f"{100.0 * overview.black:.3g} % of white"
    if overview.black_cd_m2 is None:
        return share
    return f"{overview.black_cd_m2:.3g} cd/m2, {share}"


def line(label: str, words: str) -> str:
    """A line of a label and words."""
    return f"  {label:<{LABEL}}{words}"


def _source(overview: Overview) -> str:
    return "an ICC profile" if overview.source == "profile" else "readings"


def describe_fit(fit: DisplayFit) -> str:
    """A fit to readings in lines of a label and words, with the candidates."""
    errors = fit.errors
    words = (
        f"dE2000 mean {errors.mean:.2f}, largest {errors.largest:.2f}; of unseen patches mean "
        f"{errors.unseen_mean:.2f}"
    )
    lines = [line("fit", f"{fit.verdict}, {fit.patches} patches: {words}")]
    for candidate in fit.candidates:
        mark = "chosen" if candidate.chosen else "candidate"
        words = f"{candidate.name}: unseen patches mean dE2000 {candidate.mean_de2000:.2f}"
        lines.append(line(mark, words))
    if fit.misread:
        count = len(fit.misread)
        named = ", ".join(fit.misread[:MOST_NAMED]) + (", ..." if count > MOST_NAMED else "")
        lines.append(line("left out", f"{count} misread: {printable(named)}"))
    return "\n".join(lines)


def fit_as_json(fit: DisplayFit) -> dict[str, Any]:
    """A fit as JSON holds it."""
    return {
        "verdict": fit.verdict,
        "patches": fit.patches,
        "mean_de2000": fit.errors.mean,
        "p95_de2000": fit.errors.p95,
        "largest_de2000": fit.errors.largest,
        "unseen_mean_de2000": fit.errors.unseen_mean,
        "chosen": fit.chosen,
        "candidates": [dataclasses.asdict(candidate) for candidate in fit.candidates],
        "misread": list(fit.misread),
        "notes": list(fit.notes),
        "seed": fit.seed,
    }
