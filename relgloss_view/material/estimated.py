"""What an estimate leaves with its material: readings, intervals, and some of the draws."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import number, refuse, text

LARGEST = 1e12
#: Names of intervals that do not depend on the diffuse part.
OF_THE_LOBES = ("s_deg", "strength", "refractive_index", "second_s_deg", "second_strength")
MOST_ENTRIES = 1000  #: of a list of readings, draws, warnings or intervals
#: Key of a reading that the estimate does not rest on.
LEFT_OUT = "left_out"


class Interval(NamedTuple):
    """A number of the most plausible material, and the ends of its interval."""

    value: float
    lower: float
    upper: float


@dataclass(frozen=True)
class EstimateRecord:
    """The evidence of a material that was estimated from a few readings (docs/estimate.md).

    readings: of gloss: `angle_deg`, `value`, `standard_error` each, and `left_out` where the
    estimate does not rest on it. colour: how it was stated.
    intervals: by name, holding `level` of the draws. draws: `names` of columns and `rows`.
    contradiction: the line that names readings which no material gives; '' where all agree.
    """

    readings: tuple[dict[str, Any], ...]
    colour: dict[str, Any]
    intervals: dict[str, Interval]
    level: float = 0.95
    draws: dict[str, Any] = field(default_factory=dict)
    seed: int = 0
    contradiction: str = ""
    warnings: tuple[str, ...] = ()

    @property
    def words(self) -> str:
        """How far the estimate can be believed, as in 'estimated' or 'estimated, poor'."""
        return "estimated, poor" if self.contradiction else "estimated"

    @property
    def reading_words(self) -> str:
        """The readings as they are typed, such as '20=12.3, 60=45, 85=80 (left out)'."""
        return ", ".join(
            f"{r['angle_deg']:g}={r['value']:g}" + " (left out)" * bool(r.get(LEFT_OUT))
            for r in self.readings
        )

    @property
    def range_words(self) -> str:
        """What it was estimated from, and how wide the answer is, in one line.

        >>> gloss = ({"angle_deg": 60.0, "value": 45.0, "standard_error": 0.2},)
        >>> EstimateRecord(gloss, {}, {"s_deg": Interval(1.5, 0.1, 1.9)}).range_words
        'estimated from gloss 60=45; lobe width 1.5 deg, 0.1 to 1.9'
        """
        text = f"{self.words} from gloss {self.reading_words}"
        width = self.intervals.get("s_deg")
        if width is not None:
            text += f"; lobe width {width.value:.3g} deg, {width.lower:.3g} to {width.upper:.3g}"
        return text

    def for_another_body(self) -> EstimateRecord:
        """What stays true of a material whose diffuse part was changed: the lobes' numbers.

        Gloss, peak and diffuse reflectance contain the body, and so do the draws. A contradiction
        is one of the lobes' evidence; other warnings are about the colour.
        """
        lobes = {k: v for k, v in self.intervals.items() if k in OF_THE_LOBES}
        warnings = tuple(text for text in self.warnings if text == self.contradiction)
        return dataclasses.replace(self, intervals=lobes, draws={}, warnings=warnings)

    def as_json(self) -> dict[str, Any]:
        """The object of a material file."""
        return {
            "readings": list(self.readings),
            "colour": self.colour,
            "level": self.level,
            "intervals": {name: entry._asdict() for name, entry in self.intervals.items()},
            "seed": self.seed,
            "contradiction": self.contradiction,
            "warnings": list(self.warnings),
            "draws": self.draws,
        }


def estimate_record(content: object) -> EstimateRecord | None:
    """The record of a JSON object; InputError names the field that is wrong."""
    if content is None:
        return None
    part = _object(content, "estimate")
    readings = tuple(
        _reading(entry, f"estimate.readings[{k}]")
        for k, entry in enumerate(_list(part, "readings"))
    )
    intervals = {}
    entries = _object(part.get("intervals", {}), "estimate.intervals")
    if len(entries) > MOST_ENTRIES:
        refuse("estimate.intervals", f"at most {MOST_ENTRIES} entries", len(entries))
    for name, value in entries.items():
        place = f"estimate.intervals.{name}"
        entry = _object(value, place)
        ends = (
            number(entry.get(k), f"{place}.{k}", "a number", -LARGEST, LARGEST)
            for k in Interval._fields
        )
        intervals[name] = Interval(*ends)
    seed: Any = part.get("seed", 0)
    if not isinstance(seed, int) or isinstance(seed, bool):
        refuse("estimate.seed", "a whole number", seed)
    warnings = tuple(
        text(line, f"estimate.warnings[{k}]") for k, line in enumerate(_list(part, "warnings"))
    )
    record = EstimateRecord(
        readings=readings,
        colour=_object(part.get("colour", {}), "estimate.colour"),
        intervals=intervals,
        level=number(part.get("level", 0.95), "estimate.level", "a share, 0 to 1", 0.0, 1.0),
        draws=_object(part.get("draws", {}), "estimate.draws"),
        seed=seed,
        contradiction=text(part.get("contradiction", ""), "estimate.contradiction"),
        warnings=warnings,
    )
    try:
        json.dumps(record.as_json(), allow_nan=False)
    except ValueError:  # 1e999 is read as infinity
        raise InputError(
            "estimate: expected finite numbers, found one beyond every float"
        ) from None
    return record


def _reading(value: object, place: str) -> dict[str, Any]:
    entry = _object(value, place)
    for name in ("angle_deg", "value", "standard_error"):
        entry[name] = number(entry.get(name), f"{place}.{name}", "a number", 0.0, LARGEST)
    return entry


def _object(value: object, place: str) -> dict[str, Any]:
    if not isinstance(value, Mapping):
        refuse(place, "an object", value)
    return dict(value)


def _list(part: dict[str, Any], name: str) -> list[Any]:
    value = part.get(name, [])
    if not isinstance(value, list) or len(value) > MOST_ENTRIES:
        refuse(f"estimate.{name}", f"a list of at most {MOST_ENTRIES} entries", value)
    return value
