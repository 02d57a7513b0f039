"""Matching the finishes of a pack: sigma_N and k of each, and c of the picture.

Each finish is matched to the reference as a sample is (gloss.match): its reading is that of its own
material, and its picture that of the plain finish (pack.plain_finish) on the paper's cylinder, so
that no number depends on the form. One picture has one c: it is the c of the first finish that
shines, and k_f = c_f / c. The ratio of two k is that of two c, in which the reference cancels.

A picture that is drawn has one view, and there the mean over poses is not exact. So with its setup
each k is the one at which the finish and the first one show the ratio of their readings in that
view, as if either covered the form. c stays the mean: it belongs to a pair, not to a view.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from relgloss_view.base.reading import printable
from relgloss_view.gloss.match import (
    CurvePoint,
    Reference,
    gloss_of,
    matched_point,
    own_sigma_n_deg,
)
from relgloss_view.gloss.pose import pose_of
from relgloss_view.pack.finish import MAX_K
from relgloss_view.pack.pack import Pack
from relgloss_view.pack.plain_finish import PlainFinish, plain_finishes
from relgloss_view.picture.scene.match import MOST_C, Match
from relgloss_view.picture.scene.setup import Setup

UNSEEN = "its highlight is not seen in this view"


@dataclass(frozen=True)
class FinishMatch:
    """A finish whose gloss has the right ratio to the reference and to the other finishes."""

    name: str
    reading: float  #: gloss of its material
    ratio: float  #: of it to the reference's
    sigma_n_deg: float
    point: CurvePoint  #: c of a picture that shows this finish alone
    k: float
    kept: bool  #: whether k is the pack's own, which a match keeps
    lies_somewhere: bool
    shown: float | None  #: displayed gloss over the reference's; None where no highlight is seen
    luminance: float  #: Y of what lies below its lobes, 1 the perfect diffuser
    in_view: bool = False  #: whether k is that of the view, not of the mean over the poses
    note: str = ""  #: why it is not, in a match with a view

    @property
    def warnings(self) -> tuple[str, ...]:
        """What to know of the match, one sentence each."""
        notes = []
        if not self.lies_somewhere:
            notes.append("it lies nowhere on the pack: check its mask")
        elif self.point.c is None:
            notes.append("its pictures show no highlight, so k changes nothing")
        elif not self.kept and self.k >= MAX_K:
            notes.append(f"its k is limited to {MAX_K:g}, so its picture shows too little gloss")
        if self.note:
            notes.append(self.note)
        return tuple(notes)


@dataclass(frozen=True)
class PackMatch:
    """The match of a pack. pack: with sigma_N and k of each finish set. c: of its picture."""

    reference: Reference
    pack: Pack
    finishes: tuple[FinishMatch, ...]
    anchor: FinishMatch  #: the finish whose c the picture has
    c: float

    @property
    def glossiest(self) -> FinishMatch:
        """The finish with the highest reading of those that lie anywhere."""
        seen = [finish for finish in self.finishes if finish.lies_somewhere]
        return max(seen or self.finishes, key=lambda finish: finish.reading)

    @property
    def as_kept(self) -> Pack:
        """The pack with every k its own, as a file holds it."""
        kept = tuple(dataclasses.replace(f, keeps_k=True) for f in self.pack.finishes)
        return dataclasses.replace(self.pack, finishes=kept)

    @property
    def match(self) -> Match:
        """The match of the pair as scene files hold it; its spread is the largest of a finish."""
        return Match(
            reference_c=self.reference.c,
            test_c=self.c,
            reference_sigma_n_deg=self.reference.sample.look.sigma_n_deg,
            test_sigma_n_deg=self.anchor.sigma_n_deg,
            gloss=self.reference.gloss,
            spread=max(finish.point.spread for finish in self.finishes),
        )

    @property
    def warnings(self) -> tuple[str, ...]:
        """Of all finishes, each with its name in front."""
        return tuple(
            f"finish {printable(finish.name, 60)!r}: {text}"
            for finish in self.finishes
            for text in finish.warnings
        )

    def as_numbers(self) -> dict[str, Any]:
        """The match as JSON holds it."""
        return {
            "pack": self.pack.name,
            "c": self.c,
            "anchor": self.anchor.name,
            "finishes": [
                {
                    "name": f.name,
                    "gloss": f.reading,
                    "ratio": f.ratio,
                    "sigma_n_deg": f.sigma_n_deg,
                    "k": f.k,
                    "k_kept": f.kept,
                    "k_from": "pack" if f.kept else "view" if f.in_view else "poses",
                    "c_alone": f.point.c,
                    "c_low": f.point.low,
                    "c_high": f.point.high,
                    "spread": f.point.spread,
                    "refused": list(f.point.refused),
                    "shown": f.shown,
                    "luminance_below": f.luminance,
                    "warnings": list(f.warnings),
                }
                for f in self.finishes
            ],
        }


def match_pack(
    reference: Reference,
    pack: Pack,
    sigma_n_deg: float | None = None,
    setup: Setup | None = None,
) -> PackMatch:
    """The match of every finish of a pack to a reference.

    sigma_n_deg: graininess of the finishes that have none of their own, degrees; None takes what is
    known of each, as for samples: that of the published setting of a paper, or 0. A finish that
    keeps its k keeps it. setup: of the picture, on the pack's form, whose finishes keep their
    ratios; without one these are means over the reference's poses. Without a highlight anywhere c
    is the reference's. Raises InputError where a mask fits nothing.

    >>> from relgloss_view.pack.built_in import load_finish
    >>> from relgloss_view.pack.finish import Finish
    >>> from relgloss_view.pack.shape import Shape
    >>> matt = Finish("matt", "ink", load_finish("matt-varnish"), "matt-varnish")
    >>> pack = Pack("matt box", Shape("carton"), (matt,))
    >>> match_pack(Reference.default(), pack).finishes[0].k
    1.0
    """
    plain = plain_finishes(pack, reference.setups[0].lamp.illuminant)
    found = [_alone(reference, one, sigma_n_deg) for one in plain]
    solved = [f for f in found if f.point.c]
    anchor = next((f for f in solved if f.lies_somewhere), solved[0] if solved else found[0])
    first = found.index(anchor)
    c = min(anchor.point.c or reference.c, MOST_C)
    ratios: list[float | None] = [None] * len(found)
    if setup is not None:
        ratios = _ratios_in_view(setup, plain, found, first)
        found = _noted(found, ratios, first)
    finishes = tuple(_beside(f, c, ratio) for f, ratio in zip(found, ratios, strict=True))
    changed = tuple(
        dataclasses.replace(own, sigma_n_deg=f.sigma_n_deg, k=f.k)
        for own, f in zip(pack.finishes, finishes, strict=True)
    )
    return PackMatch(
        reference, dataclasses.replace(pack, finishes=changed), finishes, finishes[first], c
    )


def _ratios_in_view(
    setup: Setup, plain: Sequence[PlainFinish], found: Sequence[FinishMatch], first: int
) -> list[float | None]:
    """k of each finish over that of the first one in a view; None where one of both is not seen."""
    pose = pose_of(setup)
    peaks = [pose.peak(p.material, f.sigma_n_deg) for p, f in zip(plain, found, strict=True)]
    own, reading = peaks[first], found[first].reading
    return [
        f.reading / reading * own / peak if own and peak and reading > 0.0 else None
        for f, peak in zip(found, peaks, strict=True)
    ]


def _noted(
    found: Sequence[FinishMatch], ratios: Sequence[float | None], first: int
) -> list[FinishMatch]:
    """The finishes, with notes where the view shows no ratio that could be kept."""
    asked = [f.lies_somewhere and not f.kept and f.point.c is not None for f in found]
    asked[first] = False
    if not any(asked):
        return list(found)
    if ratios[first] is None:
        noted = list(found)
        text = f"{UNSEEN}, so k of every finish is that of the mean over poses of the lamp"
        noted[first] = dataclasses.replace(found[first], note=text)
        return noted
    text = f"{UNSEEN}, so its k is that of the mean over poses of the lamp"
    return [
        dataclasses.replace(f, note=text) if ask and ratio is None else f
        for f, ask, ratio in zip(found, asked, ratios, strict=True)
    ]


def _alone(reference: Reference, plain: PlainFinish, sigma_n_deg: float | None) -> FinishMatch:
    """The match of a finish in a picture that shows it alone."""
    finish = plain.finish
    reading = gloss_of(finish.material, reference.gloss)
    sigma = finish.sigma_n_deg
    if sigma is None:
        sigma = own_sigma_n_deg(finish.source) if sigma_n_deg is None else sigma_n_deg
    return FinishMatch(
        name=finish.name,
        reading=reading,
        ratio=reading / reference.reading,
        sigma_n_deg=sigma,
        point=matched_point(reference, plain.material, sigma, reading),
        k=finish.k,
        kept=finish.keeps_k,
        lies_somewhere=plain.lies_somewhere,
        shown=None,
        luminance=plain.luminance,
    )


def _beside(alone: FinishMatch, c: float, ratio: float | None = None) -> FinishMatch:
    """A finish in a picture whose c is another's; ratio: k as the view has it."""
    if alone.point.c is None:
        return alone if alone.kept else dataclasses.replace(alone, k=1.0)
    wanted = alone.point.c / c if ratio is None else ratio
    k = alone.k if alone.kept else min(wanted, MAX_K)
    shown = alone.ratio * k / wanted if wanted > 0.0 else 0.0
    return dataclasses.replace(alone, k=k, shown=shown, in_view=ratio is not None)
