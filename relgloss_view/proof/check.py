"""check_proof: whether a proof is whole, who signed it, and whether it is drawn here as there."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from relgloss_view.base.reading import printable
from relgloss_view.base.terminal import ProgressReport, no_progress
from relgloss_view.base.words import listed
from relgloss_view.proof.content import drawing_within
from relgloss_view.proof.grid import LARGEST_DE2000, MISSED_SHARE, Comparison, compare
from relgloss_view.proof.keys import Signed, checked
from relgloss_view.proof.meter import are_close, are_same_finishes, finishes_of, meter_of
from relgloss_view.proof.page.parts import Page
from relgloss_view.proof.page.whole import PROGRAM, page_of
from relgloss_view.proof.pair import Pair
from relgloss_view.proof.pictures import is_shown
from relgloss_view.proof.proof import Proof, canonical
from relgloss_view.proof.read import AGAIN, changed_words, check_version, part_words, proof_of
from relgloss_view.proof.settings import SIDES
from relgloss_view.proof.unpack import Opened, opened
from relgloss_view.quality.backends import FrameRenderer

#: Parts of a page that are this program's own.
OWN = ("head", "style", "static", "words", "script", "shaders")


@dataclass(frozen=True)
class Checked:
    """What is known of a proof.

    changes: parts that were changed after it was made; where there are any, nothing else is looked
    at. drawn: each side beside the check grid; empty where it was not drawn. drawing: whether the
    numbers that the page draws with are those that this program derives; None where that was not
    looked at. program: that made the page. page: its parts that are not this program's own, where
    both are the same version. faults: one clause each; empty where all is well.
    """

    proof: Proof | None
    changes: tuple[str, ...] = ()
    signatures: tuple[Signed, ...] = ()
    drawn: Mapping[str, Comparison] = field(default_factory=dict)
    drawing: bool | None = None
    program: str = ""
    page: tuple[str, ...] = ()
    faults: tuple[str, ...] = ()

    @property
    def largest(self) -> float | None:
        """Largest dE2000 of both pictures; None where nothing was drawn."""
        return max((one.largest for one in self.drawn.values()), default=None)

    @property
    def is_own_version(self) -> bool:
        """Whether the page was made by this version of the program."""
        return self.program == PROGRAM

    def as_json(self) -> dict[str, Any]:
        """All of it for `--json`."""
        return {
            "digest": self.proof.digest if self.proof else None,
            "ok": not self.faults,
            "faults": list(self.faults),
            "changes": [{"part": name, "words": part_words(name)} for name in self.changes],
            "signatures": [
                {**dataclasses.asdict(one), "words": one.words} for one in self.signatures
            ],
            "largest_de2000": self.largest,
            "pictures": {side: dataclasses.asdict(one) for side, one in self.drawn.items()},
            "drawing_is_derived": self.drawing,
            "program": self.program,
            "page_differs": list(self.page),
        }


def check_page(page: Page, known: Mapping[str, str]) -> Checked:
    """The check without a picture: seal, digests, thread, fields, signatures, the page's program.

    known: names by public key. Raises InputError where a newer program has made the proof, or a
    field is wrong though nothing was changed.
    """
    check_version(page)
    if page.changes:
        return Checked(None, page.changes, faults=(f"{changed_words(page.changes)}; {AGAIN}",))
    proof = proof_of(page)
    signatures = checked(proof, known)
    faults = [f"message {one.message + 1}: {one.words}" for one in signatures if not one.is_right]
    differing: tuple[str, ...] = ()
    if page.program == PROGRAM:
        differing = foreign_parts(page, proof)
        if differing:
            names = listed(part_words(name) for name in differing)
            faults.append(
                f"{names}: not what {PROGRAM} makes, though the page names this version; open "
                "it with `relgloss view`, and in no browser"
            )
    return Checked(proof, (), signatures, program=page.program, page=differing,
                   faults=tuple(faults))  # fmt: skip


def foreign_parts(page: Page, proof: Proof) -> tuple[str, ...]:
    """The parts of a page that this program would have made otherwise."""
    own = Page(page_of(proof)).texts
    return tuple(name for name in OWN if page.texts[name] != own[name])


def check_proof(
    page: Page,
    known: Mapping[str, str],
    renderer: FrameRenderer,
    *,
    progress: ProgressReport = no_progress,
) -> Checked:
    """All that can be checked: as check_page, and both pictures drawn and compared with the grid.

    Raises InputError as check_page, and where the proof's files can't be drawn.
    """
    found = check_page(page, known)
    if found.proof is None:
        return found
    with opened(found.proof, progress=progress) as one:
        return _drawn(found, found.proof, one, renderer)


def _drawn(found: Checked, proof: Proof, one: Opened, renderer: FrameRenderer) -> Checked:
    content, faults = proof.content, list(found.faults)
    width, height = content["size_px"]
    pair = one.pair(proof.messages[0].settings)
    pictures = pair.drawn(renderer, (width, height))
    drawn = {}
    for side in SIDES:
        drawn[side] = compare(content["grid"]["sides"].get(side), pictures[side])
        faults += _faults_of(side, drawn[side])
        if not is_shown(content["pictures"][side], pictures[side].rgb):
            faults.append(
                f"the stored {side} picture: not the one that is drawn here; readers whose browser "
                "draws nothing see another one"
            )
    own = Pair.of(one.scene_file)
    derived = canonical(drawing_within(own, one.folder))
    same = derived == canonical(content["drawing"])
    if not same and found.is_own_version:
        faults.append(
            "the page's numbers: not those that its own files give; open it with `relgloss view`"
        )
    meter = meter_of(own)
    if found.is_own_version and not (
        _same_readings(content.get("meter"), meter)
        and are_same_finishes(content.get("meter_finishes"), finishes_of(own), meter)
    ):
        faults.append("the gloss meter's readings: not those of the materials that are inside")
    return dataclasses.replace(found, drawn=drawn, drawing=same, faults=tuple(faults))


def _faults_of(side: str, one: Comparison) -> list[str]:
    faults = []
    if not one.largest <= LARGEST_DE2000:  # what is no number is no small difference
        faults.append(
            f"the {side} picture: drawn here it differs by up to {one.largest:.2g} dE2000 from "
            f"what was sent (at most {LARGEST_DE2000})"
        )
    if one.missed > MISSED_SHARE * (one.points + one.missed) or not one.points:
        faults.append(f"the {side} picture: drawn here the object has another outline or size")
    return faults


def _same_readings(kept: object, own: Mapping[str, Mapping[str, Any]]) -> bool:
    """Whether a meter would show the same numbers, under the same names."""
    if not isinstance(kept, Mapping) or set(kept) != set(own):
        return False
    for key, entry in own.items():
        if {k: v for k, v in kept[key].items() if k not in SIDES} != {
            k: v for k, v in entry.items() if k not in SIDES
        }:
            return False
        for side in SIDES:
            if not are_close(kept[key].get(side), entry[side], entry["decimals"]):
                return False
    return True


def _it(count: int) -> str:
    return "it" if count == 1 else "them"


def sentences(found: Checked) -> list[str]:
    """What was found, one line each, for people."""
    if found.proof is None:
        return [f"FAULT: {printable(fault, 600)}" for fault in found.faults]
    count = len(found.proof.messages)
    lines = [
        f"whole: nothing was changed since it was made (digest {found.proof.digest})",
        "thread: 1 message"
        if count == 1
        else f"thread: {count} messages, each names the one before",
    ]
    lines += [f"message {s.message + 1}: {s.words}" for s in found.signatures if s.is_right]
    if not found.proof.signatures:
        lines.append("signatures: none; anyone could have made it")
    elif unsigned := found.proof.unsigned:
        # A stranger's message behind a signed one looks like its signer's.
        first = count - unsigned + 1
        which = f"message {first}" if unsigned == 1 else f"messages {first} to {count}"
        lines.append(f"{which}: not signed; anyone could have added {_it(unsigned)}")
    if found.is_own_version and not found.page:
        lines.append(f"page: as {PROGRAM} makes it")
    elif not found.is_own_version:
        lines.append(
            f"page: made by {printable(found.program or 'another program', 60)}, not compared with "
            f"{PROGRAM}; a stranger's is safe in `relgloss view` alone"
        )
    for side, one in found.drawn.items():
        if not _faults_of(side, one):
            lines.append(
                f"{side} picture: drawn here as it was sent (largest difference "
                f"{one.largest:.2g} dE2000 at {one.points} points)"
            )
    if found.drawing is False and not found.is_own_version:
        lines.append(f"page's numbers: {PROGRAM} derives others; the pictures are what counts")
    return [*lines, *(f"FAULT: {printable(fault, 600)}" for fault in found.faults)]
