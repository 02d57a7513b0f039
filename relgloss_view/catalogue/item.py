"""Item: what a catalogue holds of one file."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Item:
    """One file of the tree, done or failed.

    row: values by column (columns.NAMES); missing names are null. material: the JSON object of its
    material file; None where it failed. Two items of one file under one recipe are equal, whichever
    process has made them, and hold no time.
    """

    row: dict[str, Any]
    material: dict[str, Any] | None = None

    @property
    def path(self) -> str:
        """The file, from the top of the tree."""
        return str(self.row["path"])

    @property
    def failed(self) -> bool:
        """Whether there is a fault in place of results."""
        return self.material is None
