"""An overview of a monitor as text for the terminal."""

from __future__ import annotations

from relgloss_view.base.reading import printable
from relgloss_view.display.overview import LOAD_CALIBRATION, Overview

LABEL = 16  #: width of the labels
LONGEST = 300  #: characters of a note
KINDS = {
    "curves": "one curve a channel, and a matrix",
    "gain-offset-gamma": "gain, offset and gamma of each channel, and a matrix",
    "table": "a look-up table",
}


def describe(overview: Overview) -> str:
    """The overview in lines of a label and words."""
    lines = [printable(overview.name, 80)]
    lines += [line(label, words) for label, words in facts(overview)]
    lines += [line("missing", f"{one.what}: {one.step}") for one in overview.missing]
    lines += [line("note", printable(note, LONGEST)) for note in overview.notes]
    return "\n".join(lines)


def facts(overview: Overview) -> list[tuple[str, str]]:
    """Label and words of each number."""
    found = [("model", f"{KINDS.get(overview.kind, overview.kind)}, from {_source(overview)}")]
    found += [("white", white_words(overview)), ("black", black_words(overview))]
    if overview.contrast is not None:
        found.append(("contrast", f"{overview.contrast:.4g} : 1"))
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
    share = f"{100.0 * overview.black:.3g} % of white"
    if overview.black_cd_m2 is None:
        return share
    return f"{overview.black_cd_m2:.3g} cd/m2, {share}"


def line(label: str, words: str) -> str:
    """A line of a label and words."""
    return f"  {label:<{LABEL}}{words}"


def _source(overview: Overview) -> str:
    return "an ICC profile" if overview.source == "profile" else "readings"
