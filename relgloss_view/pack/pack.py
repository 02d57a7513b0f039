"""Pack: a form, an artwork and finishes, as one value."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from relgloss_view.base.arrays import Bytes
from relgloss_view.base.errors import InputError
from relgloss_view.base.parameters import Checked, choice, parameter
from relgloss_view.material.material import Material
from relgloss_view.pack.artwork.artwork import Artwork
from relgloss_view.pack.finish import MAX_FINISHES, Finish
from relgloss_view.pack.shape import Shape

#: lab: the artwork's Lab is kept under every lamp. spectral: a spectrum of the artwork's RGB
#: (Mallett, Yuksel 2019) under the lamp.
COLOUR_RULES = ("lab", "spectral")
#: body: the artwork's colours are those of the print without its lobes. 45-0: they were measured
#: 45/0 on the finished surface, so the lobes' part at 45/0 is inside them and is subtracted.
MEASURED = ("body", "45-0")


class Masks(dict[str, Bytes]):
    """Gray pictures by name; two are equal where they hold the same arrays."""

    def _key(self) -> frozenset[tuple[str, int]]:
        return frozenset((name, id(mask)) for name, mask in self.items())

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Masks) and self._key() == other._key()

    def __hash__(self) -> int:  # type: ignore[override]
        return hash(self._key())


@dataclass(frozen=True)
class Placement(Checked):
    """Where the artwork lies on the label; its centre at the label's centre by default.

    offset_x_mm to the right and offset_y_mm up, as seen on the label; turn_deg counter-clockwise;
    scale of the artwork's own size. Raises InputError where a value is out of its range.

    >>> Placement(turn_deg=90.0).scale
    1.0
    """

    offset_x_mm: float = parameter(
        0.0, -1e4, 1e4, "mm", "of the artwork's centre to the right", label="Shift right"
    )
    offset_y_mm: float = parameter(
        0.0, -1e4, 1e4, "mm", "of the artwork's centre upwards", label="Shift up"
    )
    turn_deg: float = parameter(0.0, -360.0, 360.0, "deg", "counter-clockwise", label="Turn")
    scale: float = parameter(1.0, 1e-3, 1e3, "", "of the artwork's own size", label="Scale")


@dataclass(frozen=True)
class Pack(Checked):
    """A form with an artwork and finishes, of which each lies above those before it.

    name: for captions. shape: its form. artwork: None without one. colour: one of COLOUR_RULES.
    measured: one of MEASURED. masks: gray pictures by the text of a finish's mask, (h, w) uint8, of
    masks from files.
    file: the pack file that it came from, or ''. artwork_file: as the pack file names it.
    artwork_entries: (entry, value) of how the artwork is read: profile, page, dpi, width_mm.
    notes: how the pack was made, one sentence each.
    Raises InputError where the parts do not fit together.

    >>> from relgloss_view.pack.built_in import load_finish
    >>> board = Finish("board", "stock", load_finish("bare-board"), "bare-board")
    >>> Pack("plain box", Shape("carton"), (board,)).material.name
    'bare board, coated'
    """

    name: str
    shape: Shape
    finishes: tuple[Finish, ...]
    artwork: Artwork | None = None
    placement: Placement = Placement()
    colour: str = choice(
        "lab", COLOUR_RULES, "how the artwork's colours meet another lamp", label="Colours"
    )
    masks: Mapping[str, Bytes] = field(default_factory=dict)
    file: str = ""
    artwork_file: str = ""
    measured: str = choice("body", MEASURED, "what the artwork's colours were measured on")
    artwork_entries: tuple[tuple[str, Any], ...] = ()
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        super().__post_init__()
        # Arrays have no plain truth: a pack with masks that were read again could not be compared.
        object.__setattr__(self, "masks", Masks(self.masks))
        if not 1 <= len(self.finishes) <= MAX_FINISHES:
            raise InputError(
                f"pack: expected 1 to {MAX_FINISHES} finishes, found {len(self.finishes)}"
            )
        names = [finish.name for finish in self.finishes]
        if len(set(names)) < len(names):
            raise InputError("pack: two finishes have the same name")

    @property
    def base(self) -> Finish:
        """The finish that lies everywhere below the others."""
        return self.finishes[0]

    @property
    def material(self) -> Material:
        """The material of the base finish."""
        return self.base.material

    def finish(self, name: str) -> Finish:
        """The finish of a name; InputError lists the names where there is none."""
        for one in self.finishes:
            if one.name == name:
                return one
        names = ", ".join(one.name for one in self.finishes)
        raise InputError(f"finish {name!r}: expected one of {names}")

    def with_finish(self, name: str, **entries: Any) -> Pack:
        """The pack with entries of one finish changed; artwork and masks stay the same objects."""
        self.finish(name)
        changed = tuple(
            dataclasses.replace(f, **entries) if f.name == name else f for f in self.finishes
        )
        return dataclasses.replace(self, finishes=changed)
