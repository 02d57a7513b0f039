"""What a search reports beside its hits, in sentences."""

from __future__ import annotations

from relgloss_view.base.arrays import Array
from relgloss_view.base.words import listed
from relgloss_view.catalogue.columns import BY_NAME
from relgloss_view.catalogue.query.found import Found
from relgloss_view.catalogue.query.vocabulary import label_of

ERRORS = "Comparisons use the value itself, whatever its standard error."


def reading_note(words: str, value: float, column: str) -> str:
    """The gloss of a reference."""
    unit = BY_NAME[column].unit
    number = f"{value:.1f} {unit}" if unit else f"{value:.3g}"
    return f"The reference is {words}; its {label_of(column)} is {number}."


def exact_note(column: str, value: float) -> str:
    """What "is" means for a number that tables show rounded."""
    half = 0.5 * 10.0 ** -len(f"{value!r}.0".split(".")[1].rstrip("0"))
    label = label_of(column)
    return (
        f"Only {label} of exactly {value:.6g} counts: about {value:.6g} within {half:g} allows for "
        "rounding."
    )


def colour_note(words: str, lab: Array) -> str:
    """The colour of a reference."""
    return f"The colour is that of {words}: L* a* b* " + " ".join(f"{v:.1f}" for v in lab) + "."


def pictures_note(words: str, redrawn: int | None) -> str:
    """What pictures were compared; redrawn: how many exactly, None without a renderer."""
    how = (
        "by their thumbnails alone, which is less exact"
        if redrawn is None
        else f"the nearest {redrawn} were drawn anew for it"
    )
    return f"Pictures are compared with that of {words}: {how}."


def left_out_words(found: Found) -> str:
    """The rows that were left out for want of a value; empty without any.

    >>> from relgloss_view.catalogue.query.parse import parse
    >>> left_out_words(Found(parse("haze < 3"), (), 0, 9, left_out=2, missing={"haze": 2}))
    '2 rows were left out because a value is missing: haze in 2'
    """
    if not found.left_out:
        return ""
    were = "row was" if found.left_out == 1 else "rows were"
    each = listed(f"{label_of(name)} in {count}" for name, count in found.missing.items())
    return f"{found.left_out} {were} left out because a value is missing: {each}"
