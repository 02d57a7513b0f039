"""An estimate in words: what a terminal prints."""

from __future__ import annotations

from relgloss_view.base.reading import printable
from relgloss_view.base.terminal import Column, table
from relgloss_view.material.estimated import LEFT_OUT, EstimateRecord, Interval
from relgloss_view.material.material import Material

#: Rows of the table: key of an interval, its name and unit, and the digits after the point.
ROWS = (
    ("s_deg", "lobe width s, deg", 3),
    ("strength", "strength", 2),
    ("refractive_index", "refractive index", 3),
    ("second_s_deg", "second lobe: width, deg", 1),
    ("second_strength", "second lobe: strength", 3),
    ("diffuse_y", "diffuse reflectance Y", 3),
    ("peak", "peak at 45 deg, x white", 2),
    ("gloss-20", "gloss at 20 deg", 1),
    ("gloss-60", "gloss at 60 deg", 1),
    ("gloss-75", "gloss at 75 deg", 1),
    ("gloss-85", "gloss at 85 deg", 1),
)
COLUMNS = (
    Column("", 26, left=True),
    Column("likeliest", 10),
    Column("from", 10),
    Column("to", 10),
    Column("", left=True),
)


def describe_estimate(material: Material, warning_length: int) -> str:
    """The estimate of a material in columns, with its warnings."""
    record = material.estimate
    assert record is not None
    lines = [f"{printable(material.name)} [{record.words}]", f"  {printable(material.source)}"]
    rows = [
        (words, *_numbers(record.intervals[key], digits), _given(record, key))
        for key, words, digits in ROWS
        if key in record.intervals
    ]
    lines.append(table(COLUMNS, rows, indent="  "))
    lines.append(f"  'from' and 'to' hold {100.0 * record.level:.0f} % of the materials that agree")
    lines += [f"  warning: {printable(text, warning_length)}" for text in material.warnings]
    return "\n".join(lines)


def _numbers(interval: Interval, digits: int) -> tuple[str, str, str]:
    value, low, high = (f"{number:.{digits}f}" for number in interval)
    return value, low, high


def _given(record: EstimateRecord, key: str) -> str:
    for reading in record.readings:
        if key == f"gloss-{reading['angle_deg']:g}":
            return f"read as {reading['value']:g}" + ", left out" * bool(reading.get(LEFT_OUT))
    return ""
