"""The match of the window's pair: what a sample gets when it is chosen, and the sliders' unit.

A state always has an absolute c on both sides; what is turned, zoomed or resized never changes it.
The unit of the sliders is the match: 1 keeps the ratio of gloss, 0.5 shows half as much.
"""

from __future__ import annotations

import dataclasses
from functools import lru_cache

from relgloss_view.base.errors import InputError
from relgloss_view.gloss.match import Reference, absolute_c, full_c, matched, own_sigma_n_deg
from relgloss_view.gloss.pack_match import match_pack
from relgloss_view.gloss.samples import SampleLook
from relgloss_view.material.recolour import Colour
from relgloss_view.pack.finish import Finish
from relgloss_view.pack.pack import Pack
from relgloss_view.picture.frame import Frame
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.match import MOST_C, Match
from relgloss_view.picture.scene.sample import Sample
from relgloss_view.picture.scene.setting import Setting
from relgloss_view.viewer.state import packs
from relgloss_view.viewer.state.state import SIDES, State

NEAR_MATCH = 0.02  #: a share of the match that far from 1 is reported when a scene is opened


def reference_of(state: State) -> Reference | None:
    """The reference of the state's left picture; None where it has no gloss."""
    side = state.reference
    return _reference(_Key(side.sample, side.look))


class _Key:
    """A side without what its gloss does not depend on; equal materials are the same object."""

    def __init__(self, sample: Sample, look: Look) -> None:
        self.sample, self.look = sample, Look().at(look.setting)

    def __hash__(self) -> int:
        return hash((id(self.sample.material), self.look))

    def __eq__(self, other: object) -> bool:
        return (
            isinstance(other, _Key)
            and other.sample.material is self.sample.material
            and other.look == self.look
        )


@lru_cache(maxsize=16)
def _reference(key: _Key) -> Reference | None:
    label = key.sample.name or key.sample.material.name
    try:
        return Reference.of(SampleLook(label, key.sample.material, key.look))
    except InputError:
        return None


def new_match(state: State) -> Match | None:
    """What `match` proposes for the state's samples at their graininess; None without gloss."""
    reference = reference_of(state)
    if reference is None:
        return None
    pack = state.test.sample.pack
    if pack is not None:
        return match_pack(reference, pack, setup=state.scene("test").setup).match
    return matched(reference, state.test.sample.material, state.test.look.sigma_n_deg)


def rematched(state: State, share: float = 1.0) -> State:
    """The state with a new match, its test picture at a share of the matched gloss."""
    match = new_match(state)
    if match is None:
        return dataclasses.replace(state, match=None)
    state = _finishes_matched(state)
    changed = _with_c(state, "test", share * match.test_c)
    return dataclasses.replace(changed, match=match)


def _finishes_matched(state: State) -> State:
    """The state whose test pack has the sigma_N and k of each finish that a match proposes.

    The ratios of the finishes are those of the present view; turning keeps the k that it began
    with, as it keeps c.
    """
    pack, reference = state.test.sample.pack, reference_of(state)
    if pack is None or reference is None:
        return state
    found = match_pack(reference, pack, setup=state.scene("test").setup)
    return packs.with_pack(state, "test", found.pack)


def with_finish_sample(state: State, side: str, finish: str, sample: Sample) -> State:
    """The state whose pack has a sample's material as that of a finish, matched again."""
    source = sample.name or sample.file or ""
    changed = packs.with_finish(state, side, finish, material=sample.material, source=source)
    return rematched_pack(changed)


def rematched_pack(state: State) -> State:
    """The state with a new match where its test picture shows a pack; the share stays."""
    if state.test.sample.pack is None:
        return state
    return rematched(state, share_of_match(state, "test") or 1.0)


def share_of_match(state: State, side: str) -> float | None:
    """Contrast gloss of a side in units of the match: 1 as matched; None without a match.

    The test picture's is relative to the reference picture's, whose ratio is what a match keeps.
    """
    match, c = state.match, state.side(side).look.c
    reference_c = state.reference.look.c
    if match is None or c is None or not reference_c or match.ratio <= 0.0:
        return None
    if side == "reference":
        return reference_c / match.reference_c
    return c / reference_c / match.ratio


def with_share(state: State, side: str, share: float) -> State:
    """The state with a side's contrast gloss in units of the match.

    The reference's takes the test picture's along, so that their ratio stays.
    """
    match, reference_c = state.match, state.reference.look.c
    if match is None or not reference_c:
        return state
    if side == "test":
        return _with_c(state, "test", share * match.ratio * reference_c)
    changed = _with_c(state, "reference", share * match.reference_c)
    if state.test.look.c is not None:
        changed = _with_c(
            changed, "test", state.test.look.c * share * match.reference_c / reference_c
        )
    return changed


def with_sample(state: State, side: str, sample: Sample, *, keep: bool = False) -> State:
    """The state with another sample on a side, matched, at the sample's own graininess.

    keep: the graininess and the share of the match stay, as while a slider changes the sample.
    """
    share = share_of_match(state, "test")
    changed = state.with_sample(side, sample)
    if not keep:
        sigma_n_deg = own_sigma_n_deg(sample.name)
        changed = changed.with_look(side, sigma_n_deg=sigma_n_deg)
        if side == "reference":
            changed = _with_c(changed, side, full_c(sample.material))
    return rematched(changed, share if keep and share is not None else 1.0)


def with_colour(state: State, side: str, colour: Colour | None) -> State:
    """The state with a side's sample in a colour, or in its own; the share of the match stays.

    Raises InputError where the sample can't have the colour.
    """
    return with_sample(state, side, state.side(side).sample.in_colour(colour), keep=True)


def with_sigma_n(state: State, side: str, sigma_n_deg: float) -> State:
    """The state with another graininess on a side; the share of the match stays."""
    share = share_of_match(state, "test")
    changed = state.with_look(side, sigma_n_deg=sigma_n_deg)
    return changed if share is None else rematched(changed, share)


def with_setting(state: State, side: str, setting: Setting, made_by: str = "paper") -> State:
    """The state with a setting that others found; a share is of c_max at the paper's geometry.

    On the test side it becomes the match.
    """
    c = absolute_c(Look().at(setting), state.side(side).sample.material)
    changed = state.with_setting(side, Setting(setting.sigma_n_deg, c=c))
    if side == "reference":
        return rematched(changed, share_of_match(state, "test") or 1.0)
    return taken_as_match(changed, made_by)


def taken_as_match(state: State, made_by: str = "hand") -> State:
    """The state whose present settings are the match."""
    reference, test = state.reference.look, state.test.look
    if reference.c is None or test.c is None or reference.c <= 0.0:
        return state
    match = Match(
        reference_c=reference.c,
        test_c=test.c,
        reference_sigma_n_deg=reference.sigma_n_deg,
        test_sigma_n_deg=test.sigma_n_deg,
        made_by=made_by,
    )
    return dataclasses.replace(state, match=match)


def swapped(state: State) -> State:
    """The state with reference and test exchanged, and the match seen from the other side."""
    match = state.match
    if match is not None:
        match = dataclasses.replace(
            match,
            reference_c=match.test_c,
            test_c=match.reference_c,
            reference_sigma_n_deg=match.test_sigma_n_deg,
            test_sigma_n_deg=match.reference_sigma_n_deg,
        )
    return dataclasses.replace(state, reference=state.test, test=state.reference, match=match)


def with_plain_pack(state: State, side: str) -> State:
    """The state with a can of a side's present sample in its place."""
    sample = state.side(side).sample
    source = sample.name or sample.file or ""
    base = Finish("Base", "stock", sample.material, source=source)
    pack = Pack("Plain pack", packs.form_of(state), (base,))
    state = with_sample(state, side, Sample.of_pack(pack), keep=True)
    return packs.first_lit(state) if side == "test" else state


def as_displayed(state: State, factor: float) -> State:
    """The state whose c are those that the pictures show, for whoever draws one of them alone."""
    for side in SIDES:
        c = state.side(side).look.c
        if factor != 1.0 and c is not None:
            state = _with_c(state, side, factor * c)
    return state


def pinned(state: State, frames: dict[str, Frame]) -> State:
    """The state with each c that was a share of c_max as the number that its picture has.

    Files of old versions hold shares. Pinned, they draw the same pixels, and keep c from then on.
    A picture without a highlight has no c_max: its share is of that at the paper's geometry.
    """
    for side in SIDES:
        look, frame = state.side(side).look, frames.get(side)
        if look.c is not None or frame is None or frame.look != look:
            continue
        shown = frame.c if frame.c_max is not None else None
        state = _with_c(
            state,
            side,
            absolute_c(look, state.side(side).sample.material) if shown is None else shown,
        )
    if any(state.side(side).look.c is None for side in SIDES):
        return state
    if state.match is None:
        return dataclasses.replace(state, match=new_match(state))
    # The file's own numbers of a match are those of the pictures that were judged.
    return taken_as_match(state, state.match.made_by)


def far_from_match(state: State) -> str:
    """What to know of a scene whose c was a share of c_max; empty where it shows the match."""
    share = share_of_match(state, "test")
    if share is None or abs(share - 1.0) <= NEAR_MATCH:
        return ""
    return (
        f"this scene shows {share:.2g} times the matched gloss, since its c is a share of c_max; "
        "Match again (panel Look) keeps the ratio to the reference"
    )


def _with_c(state: State, side: str, c: float) -> State:
    look = state.side(side).look.with_entries(c=min(max(c, 0.0), MOST_C))
    return state.with_setting(side, look.setting)
