"""Masks: where each finish of a pack lies, from the words of its entry `mask`."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from relgloss_view.base.arrays import Bytes
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.pack.artwork.plate_names import plate_named
from relgloss_view.pack.finish import Finish
from relgloss_view.pack.pack import Pack

PLATE, CHANNEL, PART = "plate:", "channel:", "part:"
ARTWORK, EVERYWHERE = "artwork", "everywhere"
VARNISH = "varnish"  #: the kind of finish that has no diffuse part
MASK_WORDS = f"{PLATE}NAME, {CHANNEL}NAME, {PART}NAME, {ARTWORK}, {EVERYWHERE}, or a picture's file"


class FinishMask(NamedTuple):
    """Where one finish lies.

    values: (h, w) uint8, 255 where it lies, of the whole artwork; a single one where it is the same
    everywhere. outside: whether it lies where no artwork is. part: of the form that it covers
    alone, or ''.
    """

    values: Bytes
    outside: bool = False
    part: str = ""


_FULL, _NONE = (np.full((1, 1), value, dtype=np.uint8) for value in (255, 0))


def mask_of(pack: Pack, finish: Finish) -> FinishMask:
    """The mask of a finish; InputError where the artwork has no such plate, or the form no part."""
    mask, inverted = finish.mask, finish.invert
    if finish is pack.finishes[0] and mask in ("", EVERYWHERE):
        return FinishMask(_FULL, outside=True)
    place = f"finish {printable(finish.name, 60)!r}: mask"
    if finish is pack.finishes[0]:
        raise InputError(
            f"{place}: the first finish lies everywhere below the others; leave its mask out"
        )
    if mask == "":
        raise InputError(f"{place}: expected {MASK_WORDS}")
    if mask.startswith(PART):
        return _part(pack, mask.removeprefix(PART), place, inverted)
    if mask == EVERYWHERE:
        return FinishMask(_NONE if inverted else _FULL, outside=not inverted)
    values = _values(pack, mask, place)
    if inverted:
        values = np.subtract(255, values, dtype=np.uint8)
    return FinishMask(values, outside=inverted)


def check_masks(pack: Pack) -> None:
    """InputError where a finish lies nowhere by its words, or the first one is a varnish."""
    if pack.base.kind == VARNISH:
        raise InputError(
            f"finish {printable(pack.base.name, 60)!r}: the first finish can't be a varnish, which "
            "needs a surface below; expected ink, foil or stock"
        )
    for finish in pack.finishes:
        mask_of(pack, finish)


def _part(pack: Pack, name: str, place: str, inverted: bool) -> FinishMask:
    from relgloss_view.pack.label import label_of

    parts = label_of(pack.shape).parts
    if inverted:
        raise InputError(f"{place}: a part can't be inverted; name the other parts instead")
    if name not in parts:
        raise InputError(
            f"{place} {PART}{printable(name, 60)}: expected a part of the {pack.shape.kind}: "
            f"{', '.join(printable(part, 40) for part in parts)}"
        )
    return FinishMask(_NONE, part=name)


def _values(pack: Pack, mask: str, place: str) -> Bytes:
    """The gray values of a mask that the artwork or a file has."""
    for prefix, word in ((PLATE, "plate"), (CHANNEL, "channel")):
        if mask.startswith(prefix):
            return plate_of(pack, mask.removeprefix(prefix), f"{place} {printable(mask, 80)}", word)
    if mask == ARTWORK:
        alpha = None if pack.artwork is None else pack.artwork.alpha
        if pack.artwork is None:
            raise InputError(f"{place} {ARTWORK}: the pack has no artwork")
        if alpha is None:
            return _FULL
        return np.asarray(np.rint(255.0 * np.clip(alpha, 0.0, 1.0)), dtype=np.uint8)
    if mask not in pack.masks:
        raise InputError(f"{place} {printable(mask, 80)!r}: expected {MASK_WORDS}")
    return pack.masks[mask]


def plate_of(pack: Pack, name: str, place: str, word: str = "plate") -> Bytes:
    """The plate of a name, or the only one whose name differs in case and blanks alone."""
    plates = {} if pack.artwork is None else pack.artwork.plates
    found = plate_named(plates, name)
    if found is not None:
        return plates[found]
    if pack.artwork is None:
        raise InputError(f"{place}: the pack has no artwork")
    if not plates:
        raise InputError(f"{place}: the artwork has no {word} beside its colours")
    names = ", ".join(printable(other, 40) for other in plates)
    raise InputError(f"{place}: no such {word}; the artwork has {names}")
