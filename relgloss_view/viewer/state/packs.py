"""Packs in the window's state: which finish is active, and each change of a pack as a value."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

from relgloss_view.base.arrays import Bytes
from relgloss_view.base.errors import InputError
from relgloss_view.material.material import Material
from relgloss_view.pack.artwork.artwork import Artwork
from relgloss_view.pack.finish import MAX_FINISHES, Finish
from relgloss_view.pack.masks import plate_of
from relgloss_view.pack.pack import Pack, Placement
from relgloss_view.pack.shape import Shape
from relgloss_view.picture.scene.pack_settings import PACK_AMBIENT
from relgloss_view.picture.scene.sample import SAMPLES, Sample
from relgloss_view.viewer.state.state import SIDES, State

DEFAULT_FORM = "can"
ROUND = ("can", "bottle", "cylinder", "sphere")  #: forms that show a highlight from every side
MOST_ARTWORK_BYTES = 300_000_000  #: of artworks that undo holds beside the present one's
Mm = tuple[float, float]  #: a place on the label: to the right and up from its centre


def pack_of(state: State, side: str) -> Pack | None:
    """The pack of a side; None where it shows a sample."""
    return state.side(side).sample.pack


def with_pack(state: State, side: str, pack: Pack) -> State:
    """The state with another pack on a side; its look and the match stay."""
    if pack == pack_of(state, side):
        return state
    return state.with_sample(side, Sample.of_pack(pack))


def with_finish(state: State, side: str, name: str, **entries: Any) -> State:
    """The state with entries of one finish changed; artwork and masks stay the same objects.

    Raises InputError for a value that is out of its range, or a pack that has no such finish.
    """
    pack = pack_of(state, side)
    return state if pack is None else with_pack(state, side, pack.with_finish(name, **entries))


def with_everywhere(state: State, change: Any) -> State:
    """The state with each of its packs replaced by what `change` makes of it."""
    for side in SIDES:
        pack = pack_of(state, side)
        if pack is not None:
            state = with_pack(state, side, change(pack))
    return state


def form_of(state: State) -> Shape:
    """The form of a new pack: the setup's, or a can where that is the paper's cylinder."""
    shape = state.setup.shape
    return Shape(DEFAULT_FORM) if shape == Shape() else shape


def sample_of(finish: Finish) -> Sample:
    """The material of a finish as a sample, with its origin."""
    name = finish.source if finish.source in SAMPLES else None
    is_file = finish.source.lower().endswith(".json")
    return Sample(finish.material, name=name, file=finish.source if is_file else None)


def first_lit(state: State) -> State:
    """The state whose test is a pack for the first time: ambient light, and a highlight.

    One small lamp leaves half of a pack black. New pictures of commands have the same light.
    """
    if pack_of(state, "test") is not None and state.setup.lamp.ambient == 0.0:
        state = state.with_part("lamp", ambient=PACK_AMBIENT)
    return lit(state)


def lit(state: State) -> State:
    """The state whose lamp shows a highlight on the test's form; a round form has one anyway."""
    pack = pack_of(state, "test")
    is_round = pack is not None and pack.shape.kind in ROUND
    return state if is_round else state.lit_for_gloss()


def on_form(pack: Pack, shape: Shape) -> Pack:
    """The pack on another form, without the finishes of parts that this does not have.

    Finishes that were chosen by the form alone are chosen again. Raises InputError where a mesh
    can't be read.
    """
    from relgloss_view.pack.label import label_of
    from relgloss_view.pack.quick import finishes_of_artwork

    usual, _ = finishes_of_artwork(pack.artwork, pack.shape)
    if [_origin(one) for one in usual] == [_origin(one) for one in pack.finishes]:
        looks = {one.name: one for one in pack.finishes}
        made, _ = finishes_of_artwork(pack.artwork, shape)
        same = tuple(
            old if (old := looks.get(one.name)) and _origin(old) == _origin(one) else one
            for one in made
        )
        return dataclasses.replace(pack, shape=shape, finishes=same)
    masks = {f"part:{name}" for name in label_of(shape).parts}
    kept = tuple(
        one for one in pack.finishes if not one.mask.startswith("part:") or one.mask in masks
    )
    return dataclasses.replace(pack, shape=shape, finishes=kept)


def new_on_form(pack: Pack, shape: Shape) -> Pack:
    """A pack that was just made around an artwork, on another form, its artwork placed anew."""
    from relgloss_view.pack.quick import usual_placement

    moved = on_form(pack, shape)
    if moved.artwork is None or shape == pack.shape:
        return moved
    placement, _ = usual_placement(moved.artwork, shape)
    return dataclasses.replace(moved, placement=placement)


def _origin(finish: Finish) -> tuple[object, ...]:
    return finish.name, finish.kind, finish.source, finish.mask, finish.invert


# --- finishes -------------------------------------------------------------------------------------


def active(pack: Pack, name: str) -> Finish:
    """The finish of a name; where there is none of it, the uppermost one that is on the artwork."""
    on_artwork = [one for one in pack.finishes if not one.mask.startswith("part:")]
    return next((one for one in pack.finishes if one.name == name), on_artwork[-1])


def new_finish(pack: Pack, material: Material, source: str) -> Finish:
    """A further finish, above the others: a varnish that lies where the artwork prints."""
    stem, names = _name_of(material, source), {one.name for one in pack.finishes}
    tried = [stem, *(f"{stem} {k}" for k in range(2, MAX_FINISHES + 2))]
    name = next(text for text in tried if text not in names)
    mask = "artwork" if pack.artwork is not None else "everywhere"
    return Finish(name, "varnish", material, source=source, mask=mask)


def free_plates(pack: Pack) -> tuple[str, ...]:
    """Plates of a pack's artwork that no finish is tied to, but for those of cutters and such."""
    if pack.artwork is None:
        return ()
    from relgloss_view.pack.quick import is_technical

    tied = {id(plate) for plate in _plates_by_mask(pack).values()}
    plates = pack.artwork.plates.items()
    return tuple(n for n, plate in plates if id(plate) not in tied and not is_technical(n))


def with_plate(pack: Pack, plate: str, source: str) -> tuple[Pack, str]:
    """The pack with a built-in finish where a plate prints, and the finish's name.

    A foil lies below the varnishes, which would lose their gloss under it. Raises InputError where
    there is no room for one more.
    """
    from relgloss_view.pack.built_in import FINISHES, load_finish

    kind, names = FINISHES[source], {one.name for one in pack.finishes}
    tried = [plate.strip() or "plate", *(f"{plate} ({k})" for k in range(2, MAX_FINISHES + 2))]
    name = next(text for text in tried if text not in names)
    finish = Finish(name, kind, load_finish(source), source=source, mask=f"plate:{plate}")
    at = len(pack.finishes)
    while kind != "varnish" and at > 1 and pack.finishes[at - 1].kind == "varnish":
        at -= 1
    finishes = (*pack.finishes[:at], finish, *pack.finishes[at:])
    return dataclasses.replace(pack, finishes=finishes), name


def added(pack: Pack, finish: Finish) -> Pack:
    """The pack with one more finish above the others; InputError where there is no room."""
    return dataclasses.replace(pack, finishes=(*pack.finishes, finish))


def removed(pack: Pack, name: str) -> Pack:
    """The pack without a finish; the base stays, for something lies below."""
    if pack.base.name == name:
        raise InputError(f"finish {name!r}: the base of a pack can't be removed")
    return dataclasses.replace(pack, finishes=tuple(f for f in pack.finishes if f.name != name))


def moved(pack: Pack, name: str, steps: int) -> Pack:
    """The pack with a finish so many places further up; the base stays below all."""
    finishes = list(pack.finishes)
    place = next(k for k, one in enumerate(finishes) if one.name == name)
    if place == 0:
        return pack
    one = finishes.pop(place)
    finishes.insert(min(max(place + steps, 1), len(finishes)), one)
    return dataclasses.replace(pack, finishes=tuple(finishes))


def renamed(pack: Pack, old: str, new: str) -> Pack:
    """The pack with a finish under another name; InputError where that is taken or empty."""
    new = new.strip()
    if not new or not new.isprintable():
        raise InputError(f"finish {old!r}: expected a name of printable characters")
    finishes = tuple(
        dataclasses.replace(one, name=new) if one.name == old else one for one in pack.finishes
    )
    return dataclasses.replace(pack, finishes=finishes)


def mask_choices(pack: Pack, parts: tuple[str, ...]) -> tuple[str, ...]:
    """The masks that a finish of this pack can have without another file.

    parts: of the form.
    """
    artwork = pack.artwork
    plates = () if artwork is None else tuple(artwork.plates)
    choices = ["everywhere", *(["artwork"] if artwork is not None else [])]
    choices += [f"plate:{name}" for name in plates]
    choices += [f"part:{name}" for name in parts] if len(parts) > 1 else []
    choices += [name for name in pack.masks if name not in choices]
    return tuple(choices)


def mask_words(mask: str) -> str:
    """A mask in words."""
    kind, colon, name = mask.partition(":")
    if not mask:
        return "everywhere below"
    if mask == "artwork":
        return "where the artwork prints"
    return f"{kind} {name}" if colon and kind in ("plate", "channel", "part") else mask


def with_artwork(pack: Pack, made: Pack) -> Pack:
    """The pack with another pack's artwork; of the same size it stays where the last one lay."""
    from relgloss_view.pack.quick import usual_placement

    old, artwork = pack.artwork, made.artwork
    assert artwork is not None
    same = old is not None and _is_close(old, artwork)
    placement = pack.placement if same else usual_placement(artwork, pack.shape)[0]
    return dataclasses.replace(pack, artwork=artwork, artwork_file=artwork.file,
                               artwork_entries=made.artwork_entries,
                               placement=placement)  # fmt: skip


def within_memory(states: list[State]) -> int:
    """How many states, from the first on, hold artworks of at most MOST_ARTWORK_BYTES together."""
    seen: set[int] = set()
    total = 0
    for k, state in enumerate(states):
        for side in SIDES:
            pack = pack_of(state, side)
            artwork = None if pack is None else pack.artwork
            if artwork is not None and id(artwork) not in seen:
                seen.add(id(artwork))
                total += artwork.xyz.nbytes + sum(p.nbytes for p in artwork.plates.values())
        if total > MOST_ARTWORK_BYTES and k > 1:
            return k
    return len(states)


def artwork_words(pack: Pack) -> str:
    """What a line on a new artwork should hold beside its name: plates, and whether it is whole."""
    from relgloss_view.pack.artwork.artwork import REPAIRED

    artwork = pack.artwork
    if artwork is None:
        return ""
    words = f"; plates: {', '.join(artwork.plates)}" if artwork.plates else ""
    return f"{words}. {REPAIRED}" if REPAIRED in artwork.notes else words


def missing_plates(pack: Pack) -> tuple[str, ...]:
    """Names of the plates that finishes of a pack need and that its artwork does not have."""
    found = _plates_by_mask(pack)
    return tuple(name for name, plate in found.items() if plate is None)


def _plates_by_mask(pack: Pack) -> dict[str, Bytes | None]:
    """The plates that finishes of a pack name, by the names that they use; None: there is none."""
    found: dict[str, Bytes | None] = {}
    for one in pack.finishes:
        kind, _, name = one.mask.partition(":")
        if kind in ("plate", "channel"):
            try:
                found[name] = plate_of(pack, name, "mask")
            except InputError:
                found[name] = None
    return found


def _is_close(one: Artwork, other: Artwork) -> bool:
    pairs = ((one.width_mm, other.width_mm), (one.height_mm, other.height_mm))
    return all(math.isclose(a, b, rel_tol=1e-2) for a, b in pairs)


def _name_of(material: Material, source: str) -> str:
    text = source if source and "/" not in source and "\\" not in source else material.name
    text = "".join(c for c in text.replace("-", " ") if c.isprintable()).strip()[:40]
    return text[:1].upper() + text[1:] or "Finish"


# --- the place of the artwork ---------------------------------------------------------------------


def artwork_place(placement: Placement, label_mm: Mm) -> Mm:
    """The place on the artwork, mm from its centre, that lies at a place of the label.

    p = R(-turn) (label - offset) / scale.

    >>> artwork_place(Placement(offset_x_mm=10.0, scale=2.0), (14.0, 6.0))
    (2.0, 3.0)
    """
    x, y = label_mm[0] - placement.offset_x_mm, label_mm[1] - placement.offset_y_mm
    turn = math.radians(placement.turn_deg)
    cosine, sine = math.cos(turn), math.sin(turn)
    return (cosine * x + sine * y) / placement.scale, (cosine * y - sine * x) / placement.scale


def dragged(placement: Placement, start: Mm, end: Mm, girth_mm: float | None) -> Placement:
    """The placement after a hand has carried the artwork from one place of the label to another.

    girth_mm: of a form that goes around, where the way across the back's seam is the short one.
    """
    across, up = end[0] - start[0], end[1] - start[1]
    if girth_mm:
        across -= girth_mm * round(across / girth_mm)
    return nudged(placement, across, up, girth_mm)


def nudged(
    placement: Placement, right_mm: float, up_mm: float, girth_mm: float | None
) -> Placement:
    """The placement moved by millimetres; around a form it stays within one turn of it."""
    x, y = placement.offset_x_mm + right_mm, placement.offset_y_mm + up_mm
    if girth_mm:
        x -= girth_mm * round(x / girth_mm)
    return dataclasses.replace(placement, offset_x_mm=_held(x), offset_y_mm=_held(y))


def turned(placement: Placement, degrees: float, about: Mm | None = None) -> Placement:
    """The artwork turned counter-clockwise about a place of the label, or its own centre."""
    angle = (placement.turn_deg + degrees + 180.0) % 360.0 - 180.0
    return _about(placement, dataclasses.replace(placement, turn_deg=angle), about)


def scaled(placement: Placement, factor: float, about: Mm | None = None) -> Placement:
    """The artwork larger by a factor about a place of the label, or its own centre."""
    scale = min(max(placement.scale * factor, 1e-3), 1e3)
    return _about(placement, dataclasses.replace(placement, scale=scale), about)


def _about(before: Placement, after: Placement, about: Mm | None) -> Placement:
    """The later placement, moved so that what lay at a place of the label lies there again."""
    if about is None:
        return after
    x, y = artwork_place(before, about)
    turn = math.radians(after.turn_deg)
    cosine, sine = math.cos(turn), math.sin(turn)
    there = after.scale * (cosine * x - sine * y), after.scale * (sine * x + cosine * y)
    return dataclasses.replace(
        after, offset_x_mm=_held(about[0] - there[0]), offset_y_mm=_held(about[1] - there[1])
    )


def _held(value_mm: float) -> float:
    return min(max(value_mm, -1e4), 1e4)


def girth_mm(shape: Shape) -> float | None:
    """The way around a form, mm; None where its label has a left and a right end.

    Raises InputError where a mesh file can't be read.
    """
    from relgloss_view.pack.label import label_of

    label = label_of(shape)
    return 1e3 * label.size_m[0] if label.around else None
