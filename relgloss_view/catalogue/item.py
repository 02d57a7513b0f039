"""Item: what a catalogue holds of one file."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

#: What has failed: the file itself, its readings and picture, or the machine (memory, permissions).
OF_FILE, OF_LOOK, OF_MACHINE = "file", "look", "machine"


@dataclass(frozen=True)
class Fitted:
    """What the first half of the work has made of a file; another reference does not change it.

    material: the JSON object of its material file. sigma_n_deg: graininess, 0 where it is unknown.
    """

    material: dict[str, Any]
    geometries: int | None = None  #: that were fitted
    sigma_n_deg: float = 0.0


@dataclass(frozen=True)
class Item:
    """One file of the tree, done or failed.

    row: values by column (columns.NAMES); missing names are null. material: the JSON object of its
    material file; None where it failed. Two items of one file under one recipe are equal, whichever
    process has made them, and hold no time. fitted: also where readings or picture have failed.
    failed_in: OF_FILE, OF_LOOK or OF_MACHINE; "" where nothing has. driver: that has drawn it.
    """

    row: dict[str, Any]
    material: dict[str, Any] | None = None
    fitted: Fitted | None = None
    failed_in: str = ""
    driver: str = ""

    @property
    def path(self) -> str:
        """The file, from the top of the tree."""
        return str(self.row["path"])

    @property
    def failed(self) -> bool:
        """Whether there is a fault in place of results."""
        return self.material is None
