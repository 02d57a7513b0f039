"""An overview as text for the terminal."""

from __future__ import annotations

import numpy as np

from relgloss_view.base.notebook import span
from relgloss_view.base.reading import printable
from relgloss_view.base.terminal import Column, table
from relgloss_view.measure.findings.finding import FLOOR, PLATEAU
from relgloss_view.measure.overview.overview import Overview
from relgloss_view.measure.overview.polar import IN_PLANE_DEG
from relgloss_view.measure.table import SATURATED

LABEL = 14  #: width of the labels
MOST_SUMMITS, MOST_BANDS = 6, 5
LONGEST = 300  #: characters of a warning


def describe(overview: Overview) -> str:
    """The overview in lines of a label and words, with small tables below some."""
    measured = overview.measurement
    source = printable(measured.source, 200) + (" [synthetic]" if measured.synthetic else "")
    lines = [printable(measured.name), _line("source", source)]
    lines += [_line(label, words) for label, words in facts(overview)]
    lines += [_line("ridge", ridge_words(overview)), *_indented(_summits(overview))]
    lines += [_line("spectra", "radiance factor"), *_indented(_spectra(overview))]
    lines += [
        _line("serious" if finding.serious else "finding", printable(finding.text, LONGEST))
        for finding in overview.findings
    ]
    lines += [_line("warning", printable(text, LONGEST)) for text in overview.warnings]
    return "\n".join(lines)


def facts(overview: Overview) -> list[tuple[str, str]]:
    """Label and words of what was read, left out, and how good it is; a label may be empty."""
    measured, polar = overview.measurement, overview.polar
    used = overview.mask
    quantity = measured.quantity or "radiance factor"
    read = f"{measured.format}, which holds {quantity}" if measured.format else quantity
    out = polar.out_of_plane_deg[used] >= IN_PLANE_DEG
    where = f"{int(out.sum())} out of the plane" if out.any() else "all in the plane of incidence"
    total = len(measured.reasons)
    lines = [
        ("read as", read),
        ("bands", measured.bands.words),
        (
            "geometries",
            f"{overview.used} of {total} used: lamp {span(polar.lamp_deg[used], 'deg')}, receiver "
            f"{span(polar.receiver_deg[used], 'deg')} from the normal; {where}",
        ),
        ("readings", f"radiance factor {span(measured.radiance_factor[used])}"),
    ]
    for left in overview.left_out:
        first = "; ".join(f"row {row + 1} ({polar.words(row)})" for row in left.first[:2])
        more = ", ..." if left.count > 2 else ""
        lines.append(("left out", f"{left.count} {left.reason}: {first}{more}"))
    if not overview.left_out:
        lines.append(("left out", "nothing"))
    lines.append(("saturation", _saturation(overview)))
    lines.append(("repeatability", repeat_words(overview)))
    lines.append(("reciprocity", reciprocity_words(overview)))
    return lines


def ridge_words(overview: Overview) -> str:
    """Where the mirror ridge lies."""
    count, offset = len(overview.summits), overview.ridge_offset_deg
    if not count:
        return "none: no reading near a mirror direction stands out above the body"
    lamps = f"{count} lamp direction{'' if count == 1 else 's'}"
    if offset is None:
        return f"at the mirror direction, as far as the receivers of {lamps} resolve it"
    return f"{offset:+.2f} deg from the mirror direction (receiver; median over {lamps})"


def repeat_words(overview: Overview) -> str:
    """How much repeated readings differ."""
    repeated = overview.repeats
    if repeated.relative_sd is None:
        return "not known: no geometry is repeated"
    several = "geometries are" if repeated.geometries > 1 else "geometry is"
    count = f"{repeated.geometries} {several} repeated"
    if repeated.copies:
        return f"not known: {count}, but the readings are copies of one another"
    at = overview.polar.words(repeated.rows[0])
    return (
        f"standard deviation {repeated.relative_sd:.2%} ({count}, {repeated.readings} readings); "
        f"largest range {repeated.largest:.1%} at {at}"
    )


def reciprocity_words(overview: Overview) -> str:
    """How much readings with lamp and receiver exchanged differ."""
    pairs = overview.reciprocity
    middle, most, bias = pairs.typical(), pairs.typical(95.0), pairs.bias
    if middle is None or most is None or bias is None:
        return "not known: no reading has a partner with lamp and receiver exchanged"
    parts = [
        f"{name} {value:.1%}"
        for name, where in (("near the mirror", pairs.near_mirror), ("body", ~pairs.near_mirror))
        if (value := pairs.typical(where=where)) is not None
    ]
    interpolated = f", {pairs.interpolated} of them interpolated" if pairs.interpolated else ""
    noun = "pair" if pairs.pairs == 1 else "pairs"
    return (
        f"{pairs.pairs} {noun} with lamp and receiver exchanged{interpolated}: they differ by "
        f"{middle:.1%} (median; {', '.join(parts)}), 95 % of them by at most {most:.1%}; "
        f"{bias:+.1%} with the lamp at the larger angle"
    )


def _saturation(overview: Overview) -> str:
    marked = sum(left.count for left in overview.left_out if left.reason == SATURATED)
    kinds = {finding.kind for finding in overview.findings}
    words = f"{marked} readings on a plateau or at the declared level" if marked else "none seen"
    if PLATEAU in kinds:
        words += " (see the finding)"
    return words + ("; the smallest readings are cut off" if FLOOR in kinds else "")


def _line(label: str, words: str) -> str:
    return f"  {label:<{LABEL}}{words}"


def _indented(text: str) -> list[str]:
    return [" " * (LABEL + 2) + line for line in text.splitlines()]


def _summits(overview: Overview) -> str:
    columns = (Column("incidence"), Column("receiver"), Column("offset"), Column("radiance factor"))
    some = overview.summits
    if len(some) > MOST_SUMMITS:
        some = tuple(some[k] for k in evenly(len(some), MOST_SUMMITS))
    rows = [
        (
            f"{s.incidence_deg:.4g}",
            f"{s.receiver_deg:.4g}",
            "-" if s.offset_deg is None else f"{s.offset_deg:+.2f}",
            f"{s.radiance_factor:.4g}",
        )
        for s in some
    ]
    return table(columns, rows) if rows else ""


def _spectra(overview: Overview) -> str:
    bands = overview.measurement.bands
    shown = evenly(bands.count, MOST_BANDS)
    columns = (
        Column("part", left=True),
        Column("geometry", left=True),
        *(Column(bands.labels[k], 7) for k in shown),
    )
    rows = [
        (
            d.part,
            f"row {d.row + 1}: {overview.polar.words(d.row)}",
            *(f"{overview.measurement.radiance_factor[d.row, k]:.4g}" for k in shown),
        )
        for d in overview.directions
    ]
    return table(columns, rows) if rows else "none"


def evenly(count: int, most: int) -> list[int]:
    """At most so many of `count` places, the ends included.

    >>> evenly(35, 5), evenly(3, 5)
    ([0, 8, 17, 26, 34], [0, 1, 2])
    """
    places = np.linspace(0, count - 1, min(count, most)).round().astype(int)
    return [int(place) for place in np.unique(places)]
