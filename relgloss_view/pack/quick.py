"""A pack from an artwork alone: the form's usual finish, and plates whose names mean one."""

from __future__ import annotations

import dataclasses
import math
import os
import re
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from relgloss_view.base.reading import printable
from relgloss_view.base.terminal import ProgressReport, no_progress
from relgloss_view.pack.artwork.artwork import Artwork
from relgloss_view.pack.built_in import FINISHES, load_finish
from relgloss_view.pack.finish import MAX_FINISHES, Finish
from relgloss_view.pack.label import label_of
from relgloss_view.pack.masks import PART, PLATE, VARNISH, check_masks
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
        ("cold-foil-gold", r"\bgold\b|gold[ _-]*foli|(foil|folie)[ _-]*gold|\bdor\u00e9e?\b"),
        ("cold-foil-silver", r"\bsil(ver|ber)\b|\bargent|foil|folie|hot[ _-]*stamp|alumini"),
        ("matt-varnish", r"\bmatt?e?\b|\bmatt(?=lack|foli|vernis)"),
        ("satin-varnish", r"satin|silk|seiden"),
        (
            "gloss-varnish",
            r"varnish|vernis|vernice|barniz|(?<!b)lack|\buv\b|gloss|glanz|brillan|coating",
        ),
    )
)  # fmt: skip


def _words(name: str) -> str:
    return " ".join(re.split(r"(?<=[a-z])(?=[A-Z])|_", name))


def is_technical(name: str) -> bool:
    """Whether a plate's name is that of a cut, a crease, a white or another instruction.

    >>> [is_technical(name) for name in ("CutContour", "Weiss", "White Foil", "Varnish")]
    [True, True, False, False]
    """
    words = _words(name)
    return bool(TECHNICAL.search(words)) and not re.search(r"foil|folie", words, re.IGNORECASE)


def finish_of_plate(name: str) -> str | None:
    """The built-in finish that a plate's name means; None for inks and technical plates.

    >>> [finish_of_plate(n) for n in ("Varnish", "Heissfolie Gold", "UV-Mattlack", "Black")]
    ['gloss-varnish', 'cold-foil-gold', 'matt-varnish', None]
    """
    words = _words(name)
    if is_technical(name):
        return None
    if re.search(r"seidenmatt", words, re.IGNORECASE):
        return "satin-varnish"
    return next((finish for finish, means in MEANINGS if means.search(words)), None)


def plates_without_finish(artwork: Artwork, used: Iterable[str]) -> tuple[list[str], list[str]]:
    """Plates that print no colour and are no mask: those that may mean a finish, and the others.

    used: plates that are masks. The others are technical by their names: cuts, creases, white.
    """
    taken = set(used) | artwork.coloured
    free = [name for name in artwork.plates if name not in taken]
    technical = [name for name in free if is_technical(name)]
    return [name for name in free if name not in technical], technical


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
    wanted.sort(key=lambda pair: FINISHES[pair[1]] != VARNISH)  # which would hide a foil's lobes
    room = MAX_FINISHES - len(finishes)
    for name, finish in wanted[:room]:
        kind = FINISHES[finish]
        finishes.append(Finish(name, kind, load_finish(finish), finish, f"{PLATE}{name}"))
        notes.append(f"Plate {printable(name, 40)} is drawn as the built-in finish {finish}.")
    left = [name for name, _ in wanted[room:]]
    if left:
        notes.append(
            f"More finishes than a pack holds; left out: {printable(', '.join(left), 120)}."
        )
    used = (name for name, _ in wanted)
    unknown, technical = ([], []) if artwork is None else plates_without_finish(artwork, used)
    for names, text in (
        (unknown, "No finish is tied to these plates, so they are not drawn"),
        (technical, "These plates are taken as instructions or white, and are not drawn"),
    ):
        if names:
            notes.append(f"{text}: {printable(', '.join(names), 120)}.")
    return _distinct(finishes), tuple(notes)


def _distinct(finishes: list[Finish]) -> tuple[Finish, ...]:
    """The finishes with names that differ: a plate may be called 'ink'."""
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

    form: a form's name, the name of a mesh file, or a shape. material: built-in name of the finish
    over the ink; None takes the form's usual one. given: how the artwork is read, as the entries of
    a pack file (profile, page, dpi, width_mm). Raises InputError where the artwork can't be read.

    >>> from PIL import Image
    >>> Image.new("RGB", (40, 20), "white").save("label.png")
    >>> [finish.name for finish in quick_pack("label.png", "can").finishes]
    ['ink', 'metal lid', 'metal base']
    """
    from relgloss_view.pack.finish_plates import with_right_plates
    from relgloss_view.pack.pack_file import open_artwork, shape_named

    shape = shape_named(form, Path()) if isinstance(form, str) else form
    path = Path(artwork_path)
    artwork = open_artwork(path, given or {}, Path(), progress, within="")
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
    return with_right_plates(pack, progress)
