"""Recipe: all that decides what a catalogue holds of a file, beside the file itself."""

from __future__ import annotations

import dataclasses
import hashlib
import json
from dataclasses import dataclass
from typing import Any

from relgloss_view.base.version import __version__
from relgloss_view.gloss.samples import DEFAULT_GLOSS

THUMBNAIL_PX, MOST_THUMBNAIL_PX = 128, 4096  #: of a thumbnail's side: the usual, the most
#: Raised whenever the same file would give another row or another material.
REVISION = 3
#: The program whose results a record holds: another version's are made again, as nobody knows
#: whether its fits, meters and pictures are the same.
MADE_BY = f"{__version__}, {REVISION}"


@dataclass(frozen=True)
class Recipe:
    """How every file of a catalogue is fitted, metered, matched and drawn.

    Neither the number of processes nor the order of the files is part of it: results do not depend
    on them. reference: a built-in paper, or the JSON object of a material, whose gloss ratio the
    pictures keep; its setting is `reference_sigma_n_deg` and c_max where `reference_c` is None.
    fit: options of fit_material that are not its defaults. table: options of read_measurement.
    """

    reference: str | dict[str, Any] = "cast-coated"
    reference_sigma_n_deg: float = 0.0
    reference_c: float | None = None
    gloss: str = DEFAULT_GLOSS
    thumbnail_px: int = THUMBNAIL_PX
    fit: dict[str, Any] = dataclasses.field(default_factory=dict)
    table: dict[str, Any] = dataclasses.field(default_factory=dict)

    @property
    def of_fit(self) -> str:
        """Digest of what decides a material: another reference does not fit anything again."""
        return _digest({"made_by": MADE_BY, "fit": self.fit, "table": self.table})

    @property
    def of_look(self) -> str:
        """Digest of what decides readings, match and thumbnail of a material."""
        whole = dataclasses.asdict(self)
        del whole["fit"], whole["table"]
        return _digest({"made_by": MADE_BY, **whole})

    def as_json(self) -> dict[str, Any]:
        """The object that the table's file holds."""
        return {"revision": REVISION, **dataclasses.asdict(self)}


def _digest(content: dict[str, Any]) -> str:
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()
