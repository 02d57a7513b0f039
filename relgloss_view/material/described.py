"""What a description by another program leaves with its material: its parameters and what is lost.

A MaterialX document or a glTF file states a surface by the parameters of another model. The
material that is made from it was never measured, and this record keeps what it was made from.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import refuse, text

MOST_ENTRIES = 1000  #: of the parameters, or of what is not carried
PLACE = "described"


@dataclass(frozen=True)
class DescribedRecord:
    """The description that a material was made from (docs/exchange.md).

    model: of the description, such as 'OpenPBR surface'. parameters: by name, as the file states
    them. not_carried: a line for each thing that the material does not hold. losses: how far the
    material is from the description: `de2000_p95`, `de2000_max` and `gloss_units`, as
    exchange/loss.py writes them.
    """

    model: str
    parameters: dict[str, Any] = field(default_factory=dict)
    not_carried: tuple[str, ...] = ()
    losses: dict[str, Any] = field(default_factory=dict)

    @property
    def warnings(self) -> tuple[str, ...]:
        """The warnings that go with every picture of the material."""
        return tuple(f"not carried over from {self.model}: {line}" for line in self.not_carried)

    def as_json(self) -> dict[str, Any]:
        """The object of a material file."""
        return {
            "model": self.model,
            "parameters": self.parameters,
            "not_carried": list(self.not_carried),
            "losses": self.losses,
        }


def described_record(content: object) -> DescribedRecord | None:
    """The record of a JSON object; InputError names the field that is wrong."""
    if content is None:
        return None
    part = _object(content, PLACE)
    lines = part.get("not_carried", [])
    if not isinstance(lines, list) or len(lines) > MOST_ENTRIES:
        refuse(f"{PLACE}.not_carried", f"a list of at most {MOST_ENTRIES} texts", lines)
    record = DescribedRecord(
        model=text(part.get("model"), f"{PLACE}.model"),
        parameters=_object(part.get("parameters", {}), f"{PLACE}.parameters"),
        not_carried=tuple(text(line, f"{PLACE}.not_carried[{k}]") for k, line in enumerate(lines)),
        losses=_object(part.get("losses", {}), f"{PLACE}.losses"),
    )
    try:
        json.dumps(record.as_json(), allow_nan=False)
    except ValueError:  # 1e999 is read as infinity
        raise InputError(
            f"{PLACE}: expected finite numbers, found one beyond every float"
        ) from None
    return record


def _object(value: object, place: str) -> dict[str, Any]:
    if not isinstance(value, Mapping):
        refuse(place, "an object", value)
    if len(value) > MOST_ENTRIES:
        refuse(place, f"at most {MOST_ENTRIES} entries", len(value))
    return dict(value)
