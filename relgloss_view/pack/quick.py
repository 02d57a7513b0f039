"""A pack from an artwork alone: the form's usual finish, and plates whose names mean one."""

from __future__ import annotations

import math
import os
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from relgloss_view.base.reading import printable
from relgloss_view.base.terminal import ProgressReport, no_progress
from relgloss_view.pack.artwork.artwork import Artwork
from relgloss_view.pack.built_in import FINISHES, load_finish
from relgloss_view.pack.finish import MAX_FINISHES, Finish
from relgloss_view.pack.label import label_of
from relgloss_view.pack.masks import PART, PLATE, check_masks
from relgloss_view.pack.pack import Pack, Placement
from relgloss_view.pack.shape import Shape

#: The finish over the ink of a form: cans and films are glossy, boards have a dispersion varnish.
USUAL_FINISH = {"carton": "satin-varnish", "box": "satin-varnish", "plane": "satin-varnish"}
OTHER_FINISH = "gloss-varnish"
#: Parts of bare metal that a form has beside its label.
METAL_PARTS = {"can": ("lid", "base")}
#: Plates that are instructions to a machine, and print nothing.
TECHNICAL = re.compile(
    r"cut|die\b|die ?line|dielines|crease|fold|stanz|rill|perfor|dimension|bemass|bema\u00df|legend"
    r"|braille|technical|technik|glue|klebe|bleed|guide|register|white|wei(ss|\u00df)|emboss|praeg|pr\u00e4g",
    re.IGNORECASE,
)
#: Built-in finishes by words in a plate's name; the first that fits.
MEANINGS = tuple(
    (finish, re.compile(words, re.IGNORECASE))
    for finish, words in (
        ("soft-touch", r"soft[ _-]*touch|soft[ _-]*feel|velvet|samt"),
        ("cold-foil-gold", r"\bgold\b|gold[ _-]*foli|foil[ _-]*gold|folie[ _-]*gold|\bdor\u00e9e?\b"),
        ("cold-foil-silver", r"\bsil(ver|ber)\b|\bargent|foil|folie|hot[ _-]*stamp|alumini"),
        ("matt-varnish", r"\bmatt?e?\b|\bmatt(?=lack|foli|vernis)"),
        ("satin-varnish", r"satin|silk|seiden"),
        ("gloss-varnish", r"varnish|vernis|vernice|barniz|(?<!b)lack|\buv\b|uv[ _-]|gloss|glanz|brillan|coating"),
    )
)  # fmt: skip


def finish_of_plate(name: str) -> str | None:
    """The built-in finish that a plate's name means; None for inks and technical plates.

    >>> [finish_of_plate(n) for n in ("Varnish", "Heissfolie Gold", "UV-Mattlack", "Black")]
    ['gloss-varnish', 'cold-foil-gold', 'matt-varnish', None]
    """
    words = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", name).replace("_", " ")
    foil = re.search(r"foil|folie", words, re.IGNORECASE)
    if TECHNICAL.search(words) and not foil:
        return None
    if re.search(r"seidenmatt", words, re.IGNORECASE):
        return "satin-varnish"
    return next((finish for finish, means in MEANINGS if means.search(words)), None)


def finishes_of_artwork(
    artwork: Artwork | None, shape: Shape, material: str | None = None
) -> tuple[tuple[Finish, ...], tuple[str, ...]]:
    """The finishes of a pack that names none, and notes on how they were chosen.

    material: built-in name of the finish over the ink; None takes the form's usual one.
    """
    base = material or USUAL_FINISH.get(shape.kind, OTHER_FINISH)
    finishes = [Finish("ink", "ink", load_finish(base), base)]
    notes = [f"No finish is given, so the ink has the built-in finish {base}."]
    parts = label_of(shape).parts if shape.kind in METAL_PARTS else ()
    for part in METAL_PARTS.get(shape.kind, ()):
        if part in parts:
            metal = "cold-foil-silver"
            finishes.append(
                Finish(f"metal {part}", "foil", load_finish(metal), metal, f"{PART}{part}")
            )
    named = [(name, finish_of_plate(name)) for name in (artwork.plates if artwork else ())]
    wanted = [(name, finish) for name, finish in named if finish is not None]
    wanted.sort(key=lambda pair: list(FINISHES.values())[0] == FINISHES[pair[1]])  # foil below
    room = MAX_FINISHES - len(finishes)
    for name, finish in wanted[:room]:
        kind = FINISHES[finish]
        finishes.append(Finish(name, kind, load_finish(finish), finish, f"{PLATE}{name}"))
        notes.append(f"Plate {printable(name, 40)} is drawn as the built-in finish {finish}.")
    left = [name for name, _ in wanted[room:]]
    left += [name for name, finish in named if finish is None]
    if left:
        names = printable(", ".join(left), 120)
        notes.append(f"No finish is tied to these plates, so they are not drawn: {names}.")
    return _distinct(finishes), tuple(notes)


def _distinct(finishes: list[Finish]) -> tuple[Finish, ...]:
    """The finishes with names that differ: a plate may be called 'ink'."""
    import dataclasses

    made: list[Finish] = []
    for finish in finishes:
        name, n = finish.name.strip() or "finish", 1
        taken = {other.name for other in made}
        label = name
        while label in taken:
            n += 1
            label = f"{name} ({n})"
        made.append(dataclasses.replace(finish, name=label))
    return tuple(made)


#: An artwork that differs more than this from the label's size is scaled to it.
MOST_MISFIT = 1.5


def usual_placement(artwork: Artwork, shape: Shape) -> tuple[Placement, tuple[str, ...]]:
    """Where an artwork lies that nobody has placed: at its own size if that is near the label's."""
    width_mm, height_mm = (1e3 * size for size in label_of(shape).size_m)
    ratio = width_mm / artwork.width_mm
    if abs(math.log(ratio)) <= math.log(MOST_MISFIT):
        return Placement(), ()
    scale = min(max(ratio, 1e-3), 1e3)
    return Placement(scale=scale), (
        f"The artwork is {artwork.width_mm:.4g} x {artwork.height_mm:.4g} mm and the label "
        f"{width_mm:.4g} x {height_mm:.4g} mm, so it is scaled to the label's width; give its "
        "width_mm where its size is another.",
    )


def quick_pack(
    artwork_path: str | os.PathLike[str],
    form: str | Shape = "can",
    *,
    material: str | None = None,
    given: Mapping[str, Any] | None = None,
    progress: ProgressReport = no_progress,
) -> Pack:
    """A pack from an artwork alone.

    form: a form's name, or a shape. material: built-in name of the finish over the ink; None takes
    the form's usual one. given: how the artwork is read, as the entries of a pack file (profile,
    page, dpi, width_mm). Raises InputError where the artwork can't be read.
    """
    from relgloss_view.pack.pack_file import open_artwork

    shape = Shape(form) if isinstance(form, str) else form
    path = Path(artwork_path)
    artwork = open_artwork(path, given or {}, Path(), progress)
    finishes, notes = finishes_of_artwork(artwork, shape, material)
    placement, more = usual_placement(artwork, shape)
    pack = Pack(
        path.stem,
        shape,
        finishes,
        artwork,
        placement,
        artwork_file=str(artwork_path),
        artwork_entries=tuple((given or {}).items()),
        notes=(*notes, *more),
    )
    check_masks(pack)
    return pack
